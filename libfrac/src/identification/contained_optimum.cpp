// SPDX-License-Identifier: BSD-3-Clause
#include "identification/contained_optimum.hpp"

#include <algorithm>
#include <string>

#include "frac/identification/model_library.hpp"
#include "identification/data/fit_data.hpp"

namespace frac::detail {
namespace {

/// A parameter of the richer preset: a multiple of one of the simpler or of the gain of the data, or a number.
struct Value {
  std::string_view parameter;
  double factor;
  std::string_view of = {};
};
struct Row {
  Containment pair;
  std::vector<Value> differs;  // parameters of other names keep theirs
};

// Gains that only a limit brings to nothing start at a millionth.
constexpr double little = 1e-6;
constexpr std::string_view gain = "of the data";

const std::vector<Row>& rows() {
  static const std::vector<Row> all = {
      {{"lag-delay", "lag"}, {{"L", 0}}},
      {{"oscillator", "lag"}, {{"b1", 1, "T"}, {"b2", little}}},
      {{"oscillator-delay", "lag-delay"}, {{"b1", 1, "T"}, {"b2", little}}},
      {{"oscillator-delay", "oscillator"}, {{"L", 0}}},
      {{"two-rc", "r-rc"}, {{"R2", little, gain}, {"C2", 1, "C1"}}},
      {{"two-power-laws", "power-law"}, {{"K1", 1, "K"}, {"a1", 1, "a"}, {"K2", 0}, {"a2", 0}}},
      {{"fractional-lag", "lag"}, {{"a", 1}}},
      {{"cole-cole", "lag"}, {{"a", 1}}},
      {{"cole-davidson", "lag"}, {{"b", 1}}},
      {{"havriliak-negami", "cole-cole"}, {{"b", 1}}},
      {{"havriliak-negami", "cole-davidson"}, {{"a", 1}}},
      {{"fractional-lag-delay", "lag-delay"}, {{"a", 1}}},
      {{"fractional-lag-delay", "fractional-lag"}, {{"L", 0}}},
      {{"fractional-oscillator", "oscillator"}, {{"a1", 1}, {"a2", 2}}},
      {{"inertia-and-power-law", "inertia-and-damper"}, {{"q", 1}}},
      {{"inertia-and-power-law", "inertia-and-integrator"}, {{"q", -1}}},
      {{"zarc", "r-rc"}, {{"Q1", 1, "C1"}, {"n1", 1}}},
      {{"arc-and-cpe", "zarc"}, {{"A", little, gain}, {"n2", -0.5}}},
      {{"two-zarc", "two-rc"}, {{"Q1", 1, "C1"}, {"n1", 1}, {"Q2", 1, "C2"}, {"n2", 1}}},
      {{"two-zarc", "zarc"}, {{"R2", little, gain}, {"Q2", 1, "Q1"}, {"n2", 1, "n1"}}},
      {{"fractional-zener", "zener"}, {{"a", 1}}},
      {{"havriliak-negami-modulus", "fractional-zener"}, {{"b", 1}}},
  };
  return all;
}

}  // namespace

std::vector<Containment> containments() {
  std::vector<Containment> result;
  for (const Row& row : rows()) result.push_back(row.pair);
  return result;
}

std::vector<ParameterConstraint> start_of_contained(const Containment& pair, const FitResult& fit,
                                                    double gain_of_data) {
  const auto row = std::find_if(rows().begin(), rows().end(), [&](const Row& each) {
    return each.pair.rich == pair.rich && each.pair.simple == pair.simple;
  });
  std::vector<ParameterConstraint> starts;
  const auto set = [&](std::string_view name, double value) {
    starts.push_back({std::string(name), {}, {}, {}, value});
  };
  for (const Value& value : row->differs) {
    const auto of = std::find_if(fit.parameters.begin(), fit.parameters.end(),
                                 [&](const ParameterEstimate& estimate) { return estimate.name == value.of; });
    const double unit = value.of == gain ? gain_of_data : of == fit.parameters.end() ? 1 : of->value;
    set(value.parameter, value.factor * unit);
  }
  const Structure rich(find_model(pair.rich).formula);
  for (const ParameterEstimate& estimate : fit.parameters) {
    const auto& names = rich.parameter_names();
    const bool shared =
        estimate.name == offset_name || std::find(names.begin(), names.end(), estimate.name) != names.end();
    const bool given = std::any_of(row->differs.begin(), row->differs.end(),
                                   [&](const Value& value) { return value.parameter == estimate.name; });
    if (shared && !given) set(estimate.name, estimate.value);
  }
  return starts;
}

}  // namespace frac::detail
