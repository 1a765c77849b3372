// SPDX-License-Identifier: BSD-3-Clause
#include <array>
#include <span>
#include <stdexcept>
#include <string>

#include "frac/identification/fit.hpp"
#include "frac/identification/model_choice.hpp"

namespace frac {

namespace {

template <class Enum, std::size_t count>
std::string_view name_of(Enum value, const std::array<std::string_view, count>& names) {
  return names[static_cast<std::size_t>(value)];
}

template <class Enum, std::size_t count>
Enum value_of(std::string_view text, const char* what, const std::array<std::string_view, count>& names) {
  std::string known;
  for (std::size_t i = 0; i < count; ++i) {
    if (names[i] == text) return static_cast<Enum>(i);
    known += (i ? ", " : "") + std::string(names[i]);
  }
  throw std::invalid_argument(std::string(what) + " '" + std::string(text) + "' is not one of: " + known);
}

// The enumerators with these names.
template <class Enum, std::size_t count>
constexpr std::array<Enum, count> enumerators(const std::array<std::string_view, count>&) {
  std::array<Enum, count> all{};
  for (std::size_t i = 0; i < count; ++i) all[i] = static_cast<Enum>(i);
  return all;
}

// In the order of the enumerators.
constexpr std::array<std::string_view, 5> component_names = {"imaginary", "real", "both", "magnitude", "phase"};
constexpr std::array<std::string_view, 7> weight_names = {"relative",    "absolute", "given",  "smoothed-relative",
                                                          "log-complex", "repeats",  "learned"};
constexpr std::array<std::string_view, 3> loss_names = {"none", "huber", "cauchy"};
constexpr std::array<std::string_view, 3> termination_names = {"converged", "not-converged", "no-usable-start"};
constexpr std::array<std::string_view, 2> interval_names = {"curvature", "profile"};
constexpr std::array<std::string_view, 6> family_names = {"powers",   "denominator",  "arcs",
                                                          "rational", "commensurate", "terms"};

}  // namespace

std::string_view to_string(Component component) {
  return name_of(component, component_names);
}
std::string_view to_string(Weight weight) {
  return name_of(weight, weight_names);
}
std::string_view to_string(Loss loss) {
  return name_of(loss, loss_names);
}
std::string_view to_string(FitTermination termination) {
  return name_of(termination, termination_names);
}
std::string_view to_string(IntervalKind kind) {
  return name_of(kind, interval_names);
}
std::string_view to_string(GrowthFamily family) {
  return name_of(family, family_names);
}
Component component_from_string(std::string_view text) {
  return value_of<Component>(text, "component", component_names);
}
Weight weight_from_string(std::string_view text) {
  return value_of<Weight>(text, "weight", weight_names);
}
Loss loss_from_string(std::string_view text) {
  return value_of<Loss>(text, "loss", loss_names);
}
GrowthFamily growth_family_from_string(std::string_view text) {
  return value_of<GrowthFamily>(text, "growth family", family_names);
}
std::span<const Component> components() {
  static constexpr auto all = enumerators<Component>(component_names);
  return all;
}
std::span<const Weight> weights() {
  static constexpr auto all = enumerators<Weight>(weight_names);
  return all;
}
std::span<const Loss> losses() {
  static constexpr auto all = enumerators<Loss>(loss_names);
  return all;
}
std::span<const GrowthFamily> growth_families() {
  static constexpr auto all = enumerators<GrowthFamily>(family_names);
  return all;
}

}  // namespace frac
