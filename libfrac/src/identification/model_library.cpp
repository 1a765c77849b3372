// SPDX-License-Identifier: BSD-3-Clause
#include "frac/identification/model_library.hpp"

#include <cmath>
#include <limits>

#include "frac/structure.hpp"

namespace frac {

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

ParameterConstraint sign_free(std::string name) {
  return {std::move(name), {}, -infinity, {}, {}};
}
ParameterConstraint within(std::string name, double lower, double upper) {
  return {std::move(name), {}, lower, upper, {}};
}

}  // namespace

std::string_view to_string(ModelClass model_class) {
  switch (model_class) {
    case ModelClass::fractional:
      return "fractional";
    case ModelClass::integer_order:
      return "integer-order";
    case ModelClass::fixed_curve:
      return "fixed-curve";
  }
  return "unknown";
}

const std::vector<NamedModel>& model_library() {
  using enum ModelClass;
  static const std::vector<NamedModel> models = {
      {"power-law", "K s^a", fractional, "constant-phase element", {sign_free("K")}},
      {"two-power-laws",
       "K1 s^a1 + K2 s^a2",
       fractional,
       "sum of two constant-phase elements",
       {sign_free("K1"), sign_free("K2"), within("a1", -4, 4), within("a2", -4, 4)}},
      {"fractional-lag", "K/(T s^a + 1)", fractional, "first-order lag with a fractional order", {sign_free("K")}},
      {"fractional-lag-delay",
       "K exp(-L s)/(T s^a + 1)",
       fractional,
       "fractional lag with dead time",
       {sign_free("K")}},
      {"fractional-oscillator",
       "K/(b2 s^a2 + b1 s^a1 + 1)",
       fractional,
       "second-order system with two fractional orders",
       {sign_free("K"), within("a1", 0, 2), within("a2", 0, 4)}},
      {"inertia-and-power-law",
       "1/(M s^2) + d + c s^q",
       fractional,
       "free mass, constant and constant-phase element",
       {sign_free("M"), sign_free("d"), sign_free("c"), within("q", -4, 4)}},
      {"cole-cole",
       "K/(1 + (T s)^a)",
       fractional,
       "symmetric relaxation (Cole, Cole 1941)",
       {sign_free("K"), within("a", 0, 1)}},
      {"cole-davidson",
       "K/(1 + T s)^b",
       fractional,
       "skewed relaxation (Davidson, Cole 1951)",
       {sign_free("K"), within("b", 0, 1)}},
      {"havriliak-negami",
       "K/(1 + (T s)^a)^b",
       fractional,
       "general relaxation (Havriliak, Negami 1967)",
       {sign_free("K"), within("a", 0, 1), within("b", 0, 1)}},
      {"zarc",
       "R0 + R1/(1 + R1 Q1 s^n1)",
       fractional,
       "resistance and constant-phase element in parallel",
       {within("n1", 0, 1)}},
      {"two-zarc",
       "R0 + R1/(1 + R1 Q1 s^n1) + R2/(1 + R2 Q2 s^n2)",
       fractional,
       "two such arcs",
       {within("n1", 0, 1), within("n2", 0, 1)}},
      {"fractional-zener",
       "E0 + E1 (T s)^a/(1 + (T s)^a)",
       fractional,
       "solid with one spring-pot (Bagley, Torvik 1983)",
       {within("a", 0, 1)}},
      {"havriliak-negami-modulus",
       "E0 + E1 (1 - 1/(1 + (T s)^a)^b)",
       fractional,
       "solid with a skewed relaxation",
       {within("a", 0, 1), within("b", 0, 1)}},

      {"gain", "K", integer_order, "constant", {sign_free("K")}},
      {"differentiator", "K s", integer_order, "power law of order 1", {sign_free("K")}},
      {"integrator", "K/s", integer_order, "power law of order -1", {sign_free("K")}},
      {"double-integrator", "K/s^2", integer_order, "power law of order -2: a free mass", {sign_free("K")}},
      {"two-differentiators", "K1 s + K3 s^3", integer_order, "odd whole powers", {sign_free("K1"), sign_free("K3")}},
      {"integrator-and-differentiator",
       "K1/s + K2 s",
       integer_order,
       "sum of two whole powers",
       {sign_free("K1"), sign_free("K2")}},
      {"lag", "K/(T s + 1)", integer_order, "first-order lag", {sign_free("K")}},
      {"lag-delay", "K exp(-L s)/(T s + 1)", integer_order, "first-order lag with dead time", {sign_free("K")}},
      {"oscillator", "K/(b2 s^2 + b1 s + 1)", integer_order, "second-order system", {sign_free("K")}},
      {"inertia-and-damper",
       "1/(M s^2) + d + c s",
       integer_order,
       "free mass, constant and differentiator",
       {sign_free("M"), sign_free("d"), sign_free("c")}},
      {"inertia-and-integrator",
       "1/(M s^2) + d + c/s",
       integer_order,
       "free mass, constant and integrator",
       {sign_free("M"), sign_free("d"), sign_free("c")}},
      {"zener", "E0 + E1 T s/(1 + T s)", integer_order, "standard linear solid", {}},
      {"r-rc", "R0 + R1/(1 + R1 C1 s)", integer_order, "resistance and capacitance in parallel", {}},
      {"two-rc", "R0 + R1/(1 + R1 C1 s) + R2/(1 + R2 C2 s)", integer_order, "two such arcs", {}},
  };
  return models;
}

NamedModel find_model(std::string_view name_or_formula) {
  for (const NamedModel& model : model_library()) {
    // A preset written out is the preset, with its limits.
    if (model.name == name_or_formula || model.formula == name_or_formula) return model;
  }
  const Structure structure(name_or_formula);
  return {structure.formula(),
          structure.formula(),
          structure.has_fractional_order() ? ModelClass::fractional : ModelClass::integer_order,
          "written formula",
          {}};
}

}  // namespace frac
