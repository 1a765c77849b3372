// SPDX-License-Identifier: BSD-3-Clause
#include "frac/identification/model_library.hpp"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <utility>

#include "formula/canonical_form.hpp"
#include "frac/structure.hpp"
#include "identification/rational/family_members.hpp"
#include "identification/rational/rational_growth.hpp"
#include "identification/recognised_preset.hpp"

namespace frac {

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

ParameterConstraint sign_free(std::string name) {
  return {std::move(name), {}, -infinity, {}, {}};
}
/// A gain that is one of a passive element, or a modulus.
ParameterConstraint positive(std::string name) {
  return {std::move(name), {}, {}, {}, {}, {}, {}, true};
}
ParameterConstraint within(std::string name, double lower, double upper) {
  return {std::move(name), {}, lower, upper, {}};
}

/// A whole number at the front of the text, which it is taken from.
std::optional<std::size_t> take_count(std::string_view& text) {
  std::size_t value = 0;
  const auto [stop, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{}) return std::nullopt;
  text.remove_prefix(static_cast<std::size_t>(stop - text.data()));
  return value;
}

bool take(std::string_view& text, std::string_view what) {
  if (!text.starts_with(what)) return false;
  text.remove_prefix(what.size());
  return true;
}

constexpr std::size_t most_poles = 12;

/// The family a text names; none where it does not start like one.
std::optional<RationalFamily> rational_family(std::string_view name) {
  std::string_view text = name;
  RationalFamily family;
  family.free_order = take(text, "commensurate");
  if (!family.free_order && !take(text, "rational")) return std::nullopt;
  const auto refuse = [&](const std::string& reason) {
    const std::string kind = family.free_order ? "commensurate" : "rational";
    throw std::invalid_argument("model '" + std::string(name) + "': " + reason + "; expected " + kind + ", " + kind +
                                ":POLES, " + kind + ":ZEROS/POLES or " + kind +
                                ":FROM..TO, and +delay behind it for a dead time");
  };
  if (family.free_order) family.fewest_poles = 1;
  if (text.ends_with("+delay")) {
    family.dead_time = true;
    text.remove_suffix(std::string_view("+delay").size());
  }
  if (text.empty()) return family;
  if (!take(text, ":")) return std::nullopt;
  const std::optional<std::size_t> first = take_count(text);
  if (!first) refuse("no number of poles");
  family.fewest_poles = family.most_poles = *first;
  if (take(text, "..") || take(text, "/")) {
    const bool range = name.find("..") != std::string_view::npos;
    const std::optional<std::size_t> second = take_count(text);
    if (!second) refuse("no number of poles behind " + std::string(range ? ".." : "/"));
    family.most_poles = *second;
    if (!range) {
      family.zeros = *first;
      family.fewest_poles = *second;
    }
  }
  if (!text.empty()) refuse("'" + std::string(text) + "' has no meaning here");
  if (family.most_poles > most_poles) refuse("more than " + std::to_string(most_poles) + " poles");
  if (family.fewest_poles > family.most_poles) refuse("the range is empty");
  if (family.zeros && *family.zeros > family.most_poles + 1) refuse("more than one zero more than poles");
  return family;
}

NamedModel named_family(std::string_view name, const RationalFamily& family) {
  return {std::string(name),
          std::string(name),
          family.free_order ? ModelClass::fractional : ModelClass::integer_order,
          family.free_order ? "ratio of polynomials in s^a, factored" : "ratio of polynomials in s, factored",
          {},
          family};
}

constexpr std::size_t most_terms = 20;

/// "terms:4": the count behind the name of a family of sums, `count` where there is none; empty for another name.
std::optional<std::size_t> count_in_sum(std::string_view name, const std::string& family, std::size_t count) {
  std::string_view text = name;
  if (!take(text, family)) return std::nullopt;
  if (text.empty()) return count;
  if (!take(text, ":")) return std::nullopt;
  const std::optional<std::size_t> given = take_count(text);
  if (!given || !text.empty() || *given < 1 || *given > most_terms) {
    throw std::invalid_argument("model '" + std::string(name) + "': expected " + family + " or " + family +
                                ":COUNT with a count of 1 to " + std::to_string(most_terms));
  }
  return given;
}

std::optional<NamedModel> sum_family(std::string_view name) {
  NamedModel model{std::string(name), std::string(name), ModelClass::fractional, "sum of powers, arcs and modes", {}};
  if (const auto terms = count_in_sum(name, "terms", TermFamily{}.most_terms)) {
    model.terms = TermFamily{*terms};
    return model;
  }
  if (const auto elements = count_in_sum(name, "elements", ElementFamily{}.most_elements)) {
    model.elements = ElementFamily{*elements};
    model.description = "sum of passive elements";
    return model;
  }
  return std::nullopt;
}

}  // namespace

const std::vector<NamedModel>& model_library() {
  using enum ModelClass;
  // Name, formula, class, meaning, limits.
  // clang-format off
  static const std::vector<NamedModel> models = {
    {"power-law", "K s^a", fractional, "constant-phase element", {sign_free("K")}},
    {"two-power-laws", "K1 s^a1 + K2 s^a2", fractional, "sum of two constant-phase elements",
     {sign_free("K1"), sign_free("K2"), within("a1", -4, 4), within("a2", -4, 4)}},
    {"fractional-lag", "K/(T s^a + 1)", fractional, "first-order lag with a fractional order", {sign_free("K")}},
    {"fractional-lag-delay", "K exp(-L s)/(T s^a + 1)", fractional, "fractional lag with dead time", {sign_free("K")}},
    {"fractional-oscillator", "K/(b2 s^a2 + b1 s^a1 + 1)", fractional, "second-order system with two fractional orders",
     {sign_free("K"), within("a1", 0, 2), within("a2", 0, 4)}},
    {"inertia-and-power-law", "1/(M s^2) + d + c s^q", fractional, "free mass, constant and constant-phase element",
     {sign_free("M"), sign_free("d"), sign_free("c"), within("q", -4, 4)}},
    {"cole-cole", "K/(1 + (T s)^a)", fractional, "symmetric relaxation (Cole, Cole 1941)",
     {sign_free("K"), within("a", 0, 1)}},
    {"cole-davidson", "K/(1 + T s)^b", fractional, "skewed relaxation (Davidson, Cole 1951)",
     {sign_free("K"), within("b", 0, 1)}},
    {"havriliak-negami", "K/(1 + (T s)^a)^b", fractional, "general relaxation (Havriliak, Negami 1967)",
     {sign_free("K"), within("a", 0, 1), within("b", 0, 1)}},
    {"zarc", "R0 + R1/(1 + R1 Q1 s^n1)", fractional, "resistance and constant-phase element in parallel",
     {positive("R0"), within("n1", 0, 1)}},
    {"two-zarc", "R0 + R1/(1 + R1 Q1 s^n1) + R2/(1 + R2 Q2 s^n2)", fractional, "two such arcs",
     {positive("R0"), within("n1", 0, 1), within("n2", 0, 1)}},
    {"fractional-zener", "E0 + E1 (T s)^a/(1 + (T s)^a)", fractional, "solid with one spring-pot (Bagley, Torvik 1983)",
     {positive("E0"), positive("E1"), within("a", 0, 1)}},
    {"havriliak-negami-modulus", "E0 + E1 (1 - 1/(1 + (T s)^a)^b)", fractional, "solid with a skewed relaxation",
     {positive("E0"), positive("E1"), within("a", 0, 1), within("b", 0, 1)}},
    {"arc-and-cpe", "R0 + R1/(1 + R1 Q1 s^n1) + A s^n2", fractional,
     "arc in series with diffusion or a blocking electrode",
     {positive("R0"), positive("A"), within("n1", 0, 1), within("n2", -1, 0)}},
    {"r-l-cpe", "R0 + L s + A s^n1", fractional, "resistance, inductance and constant-phase element in series",
     {positive("R0"), positive("L"), positive("A"), within("n1", -1, 0)}},
    {"finite-warburg-short", "R0 + R1 tanh(sqrt(T s))/sqrt(T s)", fractional,
     "diffusion through a layer, held at its far side", {positive("R0"), positive("R1")}},
    {"finite-warburg-open", "R0 + R1 coth(sqrt(T s))/sqrt(T s)", fractional,
     "diffusion into a layer, blocked at its far side", {positive("R0"), positive("R1")}},
    {"rc-and-warburg-short", "R0 + R1/(1 + R1 C1 s) + R2 tanh(sqrt(T s))/sqrt(T s)", fractional,
     "cell: an arc and diffusion through a layer", {positive("R0"), positive("R2")}},
    {"rc-and-warburg-open", "R0 + R1/(1 + R1 C1 s) + R2 coth(sqrt(T s))/sqrt(T s)", fractional,
     "battery: an arc and diffusion into a layer", {positive("R0"), positive("R2")}},
    {"diffusion-through", "K/cosh(sqrt(T s))", fractional, "diffusion through a layer, seen at its far side",
     {sign_free("K")}},
    {"diffusion-through-lag", "K/((T2 s + 1) cosh(sqrt(T s)))", fractional, "the same behind a sensor's lag",
     {sign_free("K")}},
    {"fractional-lead-lag", "K ((T1 s + 1)/(T2 s + 1))^a", fractional,
     "lead or lag compensator to a power (Monje et al. 2008)", {sign_free("K"), within("a", 0, 2)}},
    {"two-order-zener", "K (1 + (T1 s)^a1)/(1 + (T2 s)^a2)", fractional, "solid or lead with two orders (Pritz 2003)",
     {sign_free("K"), within("a1", 0, 1), within("a2", 0, 1)}},
    {"fractional-maxwell", "E1 (T s)^a/(1 + (T s)^a)", fractional, "liquid with one spring-pot", {within("a", 0, 1)}},

    {"gain", "K", integer_order, "constant", {sign_free("K")}},
    {"differentiator", "K s", integer_order, "power law of order 1", {sign_free("K")}},
    {"integrator", "K/s", integer_order, "power law of order -1", {sign_free("K")}},
    {"double-integrator", "K/s^2", integer_order, "power law of order -2: a free mass", {sign_free("K")}},
    {"two-differentiators", "K1 s + K3 s^3", integer_order, "odd whole powers", {sign_free("K1"), sign_free("K3")}},
    {"integrator-and-differentiator", "K1/s + K2 s", integer_order, "sum of two whole powers",
     {sign_free("K1"), sign_free("K2")}},
    {"lag", "K/(T s + 1)", integer_order, "first-order lag", {sign_free("K")}},
    {"lag-delay", "K exp(-L s)/(T s + 1)", integer_order, "first-order lag with dead time", {sign_free("K")}},
    {"oscillator", "K/(b2 s^2 + b1 s + 1)", integer_order, "second-order system", {sign_free("K")}},
    {"oscillator-delay", "K exp(-L s)/(b2 s^2 + b1 s + 1)", integer_order, "second-order system with dead time",
     {sign_free("K")}},
    {"three-lags", "K/(T s + 1)^3", integer_order, "three equal lags", {sign_free("K")}},
    {"inertia-and-damper", "1/(M s^2) + d + c s", integer_order, "free mass, constant and differentiator",
     {sign_free("M"), sign_free("d"), sign_free("c")}},
    {"inertia-and-integrator", "1/(M s^2) + d + c/s", integer_order, "free mass, constant and integrator",
     {sign_free("M"), sign_free("d"), sign_free("c")}},
    {"zener", "E0 + E1 T s/(1 + T s)", integer_order, "standard linear solid", {positive("E0"), positive("E1")}},
    {"r-rc", "R0 + R1/(1 + R1 C1 s)", integer_order, "resistance and capacitance in parallel",
     {positive("R0")}},
    {"two-rc", "R0 + R1/(1 + R1 C1 s) + R2/(1 + R2 C2 s)", integer_order, "two such arcs",
     {positive("R0")}},
  };
  // clang-format on
  return models;
}

std::vector<NamedModel> default_candidates() {
  std::vector<NamedModel> candidates = model_library();
  for (const char* name : {"rational", "rational+delay", "commensurate", "commensurate+delay", "terms", "elements"})
    candidates.push_back(find_model(name));
  return candidates;
}

std::vector<NamedModel> default_candidates_over_time() {
  std::vector<NamedModel> candidates = default_candidates();
  std::erase_if(candidates, [](const NamedModel& model) { return model.is_family() && !model.rational; });
  return candidates;
}

NamedModel resolved_model(const FrequencyResponseData& data, const NamedModel& model, const FitOptions& options) {
  detail::RatioGrowths ratios;
  return model.is_family() ? detail::best_member(data, model, options, ratios).models.front() : model;
}

NamedModel resolved_model(const TimeResponseData& data, const NamedModel& model, const TimeFitOptions& options) {
  detail::RatioGrowths ratios;
  return model.is_family() ? detail::best_member(data, model, options, ratios).models.front() : model;
}

namespace {

/// A name in small letters without what words are joined with.
std::string letters_of(std::string_view name) {
  std::string letters;
  for (const char c : name)
    if (c != '_' && c != '-' && c != ' ') letters += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return letters;
}

/// A preset's name in capitals, or with _ or a blank for -, parses as a formula of parameters alone, which nobody
/// means.
void refuse_letters_of_preset(std::string_view text) {
  std::vector<std::string> names{"rational", "commensurate", "terms", "elements"};
  for (const NamedModel& model : model_library()) names.push_back(model.name);
  for (const std::string& name : names) {
    if (letters_of(name) != letters_of(text) || name == text) continue;
    throw std::invalid_argument("model '" + std::string(text) + "' is a formula without s; did you mean " + name + "?");
  }
}

struct ReadPreset {
  const NamedModel* preset;
  Structure structure;
  std::string shape;
};
const std::vector<ReadPreset>& read_presets() {
  static const auto presets = [] {
    std::vector<ReadPreset> read;
    for (const NamedModel& model : model_library()) {
      const Structure structure(model.formula);
      read.push_back({&model, structure, detail::shape_of(structure.expression())});
    }
    return read;
  }();
  return presets;
}

}  // namespace

std::optional<detail::RecognisedPreset> detail::recognised_preset(const Structure& structure) {
  const std::string shape = shape_of(structure.expression());
  for (const auto& [preset, read, its_shape] : read_presets()) {
    if (its_shape != shape) continue;
    const auto matched = read.correspondence(structure);
    if (!matched) continue;
    RecognisedPreset found{preset, read.parameter_names(), {}};
    for (const std::size_t i : *matched) found.structure_names.push_back(structure.parameter_names()[i]);
    return found;
  }
  return std::nullopt;
}

std::vector<ParameterConstraint> detail::renamed(const std::vector<ParameterConstraint>& constraints,
                                                 const std::vector<std::string>& names,
                                                 const std::vector<std::string>& new_names) {
  const auto place = [&](const std::string& name) { return std::find(names.begin(), names.end(), name); };
  const auto new_name = [&](const std::string& name) {
    return name.empty() ? name : new_names[static_cast<std::size_t>(place(name) - names.begin())];
  };
  std::vector<ParameterConstraint> result;
  for (ParameterConstraint each : constraints) {
    if (place(each.name) == names.end() || (!each.above.empty() && place(each.above) == names.end())) continue;
    each.name = new_name(each.name);
    each.above = new_name(each.above);
    result.push_back(std::move(each));
  }
  return result;
}

NamedModel find_model(std::string_view name_or_formula) {
  if (const auto family = rational_family(name_or_formula)) return named_family(name_or_formula, *family);
  if (const auto family = sum_family(name_or_formula)) return *family;
  for (const NamedModel& model : model_library()) {
    if (model.name == name_or_formula) return model;
  }
  refuse_letters_of_preset(name_or_formula);
  const Structure structure(name_or_formula);
  if (const auto found = detail::recognised_preset(structure)) {
    // The preset in the names of the formula: terms and parameters in its order, so that fits are the same.
    NamedModel model = *found->preset;
    model.formula = Structure(model.formula).renamed(found->structure_names).formula();
    model.constraints = detail::renamed(model.constraints, found->preset_names, found->structure_names);
    return model;
  }
  return {structure.formula(),
          structure.formula(),
          structure.has_fractional_order() ? ModelClass::fractional : ModelClass::integer_order,
          "written formula",
          {}};
}

}  // namespace frac
