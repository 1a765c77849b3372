#include <array>
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

// In the order of the enumerators.
constexpr std::array<std::string_view, 5> components = {"imaginary", "real", "both", "magnitude", "phase"};
constexpr std::array<std::string_view, 6> weights = {"relative",          "absolute",    "given",
                                                     "smoothed-relative", "log-complex", "repeats"};
constexpr std::array<std::string_view, 3> losses = {"none", "huber", "cauchy"};
constexpr std::array<std::string_view, 3> terminations = {"converged", "not-converged", "no-usable-start"};
constexpr std::array<std::string_view, 2> interval_kinds = {"curvature", "profile"};
constexpr std::array<std::string_view, 3> growth_families = {"powers", "denominator", "arcs"};

}  // namespace

std::string_view to_string(Component component) {
  return name_of(component, components);
}
std::string_view to_string(Weight weight) {
  return name_of(weight, weights);
}
std::string_view to_string(Loss loss) {
  return name_of(loss, losses);
}
std::string_view to_string(FitTermination termination) {
  return name_of(termination, terminations);
}
std::string_view to_string(IntervalKind kind) {
  return name_of(kind, interval_kinds);
}
std::string_view to_string(GrowthFamily family) {
  return name_of(family, growth_families);
}
Component component_from_string(std::string_view text) {
  return value_of<Component>(text, "component", components);
}
Weight weight_from_string(std::string_view text) {
  return value_of<Weight>(text, "weight", weights);
}
Loss loss_from_string(std::string_view text) {
  return value_of<Loss>(text, "loss", losses);
}
GrowthFamily growth_family_from_string(std::string_view text) {
  return value_of<GrowthFamily>(text, "growth family", growth_families);
}

}  // namespace frac
