// SPDX-License-Identifier: BSD-3-Clause
#include "identification/contained_optimum.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>

#include "frac/identification/model_library.hpp"
#include "identification/search/global_search.hpp"

namespace frac::detail {
namespace {

/// A parameter of the richer preset: a multiple of a power of one of the simpler, of the gain of the data, or a number.
struct Value {
  std::string_view parameter;
  double factor;
  std::string_view of = {};
  int power = 1;
};
struct Row {
  Containment pair;
  std::vector<Value> differs;  // parameters of other names keep theirs
};

// What only a limit brings to nothing starts at a millionth, where it still has a slope to go down, and, if that ends
// above the simpler optimum, at what changes no cost.
constexpr double little = 1e-6, next_to_nothing = 1e-14;
constexpr std::string_view gain = "of the data";

const std::vector<Row>& rows() {
  static const std::vector<Row> all = {
      {{"lag-delay", "lag"}, {{"L", 0}}},
      {{"oscillator", "lag"}, {{"b1", 1, "T"}, {"b2", little, "T", 2}}},
      {{"oscillator-delay", "lag-delay"}, {{"b1", 1, "T"}, {"b2", little, "T", 2}}},
      {{"oscillator-delay", "oscillator"}, {{"L", 0}}},
      {{"two-rc", "r-rc"}, {{"R2", little, gain}, {"C2", 1, "C1"}}},
      {{"integrator-and-differentiator", "integrator"}, {{"K1", 1, "K"}, {"K2", 0}}},
      {{"integrator-and-differentiator", "differentiator"}, {{"K2", 1, "K"}, {"K1", 0}}},
      {{"two-differentiators", "differentiator"}, {{"K1", 1, "K"}, {"K3", 0}}},
      {{"inertia-and-damper", "double-integrator"}, {{"M", 1, "K", -1}, {"d", 0}, {"c", 0}}},
      {{"inertia-and-integrator", "double-integrator"}, {{"M", 1, "K", -1}, {"d", 0}, {"c", 0}}},
      {{"power-law", "gain"}, {{"a", 0}}},
      {{"power-law", "differentiator"}, {{"a", 1}}},
      {{"power-law", "integrator"}, {{"a", -1}}},
      {{"power-law", "double-integrator"}, {{"a", -2}}},
      {{"two-power-laws", "integrator-and-differentiator"}, {{"a1", -1}, {"a2", 1}}},
      {{"two-power-laws", "two-differentiators"}, {{"K2", 1, "K3"}, {"a1", 1}, {"a2", 3}}},
      {{"two-power-laws", "power-law"}, {{"K1", 1, "K"}, {"a1", 1, "a"}, {"K2", 0}, {"a2", 0}}},
      {{"fractional-lag", "lag"}, {{"a", 1}}},
      {{"cole-cole", "lag"}, {{"a", 1}}},
      {{"cole-davidson", "lag"}, {{"b", 1}}},
      {{"havriliak-negami", "cole-cole"}, {{"b", 1}}},
      {{"havriliak-negami", "cole-davidson"}, {{"a", 1}}},
      {{"fractional-lag-delay", "lag-delay"}, {{"a", 1}}},
      {{"fractional-lag-delay", "fractional-lag"}, {{"L", 0}}},
      {{"fractional-oscillator", "oscillator"}, {{"a1", 1}, {"a2", 2}}},
      {{"fractional-oscillator", "fractional-lag"},
       {{"b1", 1, "T"}, {"a1", 1, "a"}, {"b2", little, "T", 2}, {"a2", 2}}},
      {{"inertia-and-power-law", "inertia-and-damper"}, {{"q", 1}}},
      {{"inertia-and-power-law", "inertia-and-integrator"}, {{"q", -1}}},
      {{"zarc", "r-rc"}, {{"Q1", 1, "C1"}, {"n1", 1}}},
      {{"arc-and-cpe", "zarc"}, {{"A", little, gain}, {"n2", -0.5}}},
      {{"two-zarc", "two-rc"}, {{"Q1", 1, "C1"}, {"n1", 1}, {"Q2", 1, "C2"}, {"n2", 1}}},
      {{"two-zarc", "zarc"}, {{"R2", little, gain}, {"Q2", 1, "Q1"}, {"n2", 1, "n1"}}},
      {{"fractional-zener", "zener"}, {{"a", 1}}},
      {{"fractional-zener", "fractional-maxwell"}, {{"E0", little, gain}}},
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

namespace {

double least_gain(const FrequencyResponseData& data) {
  double least = std::abs(data.value().front());
  for (const std::complex<double>& value : data.value()) least = std::min(least, std::abs(value));
  return least;
}
/// Largest output over largest input of a record.
double least_gain(const TimeResponseData& data) {
  double output = 0, input = 0;
  for (const double value : data.output()) output = std::max(output, std::abs(value));
  for (const double value : data.input()) input = std::max(input, std::abs(value));
  return input > 0 ? output / input : 1;
}

/// @param smallness  for what is little
std::vector<ParameterConstraint> start_of_contained(const Row& row, const FitResult& fit, double gain_of_data,
                                                    double smallness) {
  std::vector<ParameterConstraint> starts;
  const auto set = [&](std::string_view name, double value) {
    starts.push_back({std::string(name), {}, {}, {}, value});
  };
  for (const Value& value : row.differs) {
    const auto of = std::find_if(fit.parameters.begin(), fit.parameters.end(),
                                 [&](const ParameterEstimate& estimate) { return estimate.name == value.of; });
    const double unit = value.of == gain ? gain_of_data : of == fit.parameters.end() ? 1 : of->value;
    set(value.parameter, (value.factor == little ? smallness : value.factor) * std::pow(unit, value.power));
  }
  const Structure rich(find_model(row.pair.rich).formula);
  for (const ParameterEstimate& estimate : fit.parameters) {
    const auto& names = rich.parameter_names();
    const bool shared = std::find(names.begin(), names.end(), estimate.name) != names.end();
    const bool given = std::any_of(row.differs.begin(), row.differs.end(),
                                   [&](const Value& value) { return value.parameter == estimate.name; });
    if (shared && !given) set(estimate.name, estimate.value);
  }
  return starts;
}

constexpr double rounding = 1e-9;  // of costs

template <class Data, class Options>
std::optional<FitResult> fitted_from(const Data& data, const Containment& pair,
                                     const std::vector<ParameterConstraint>& constraints, const FitResult& simple,
                                     const Options& options) {
  const auto row = std::find_if(rows().begin(), rows().end(), [&](const Row& each) {
    return each.pair.rich == pair.rich && each.pair.simple == pair.simple;
  });
  const bool has_limit =
      std::any_of(row->differs.begin(), row->differs.end(), [](const Value& value) { return value.factor == little; });
  std::optional<FitResult> best;
  for (const double smallness : {little, next_to_nothing}) {
    Options warm = options;
    warm.global_start = false;
    warm.constraints = constraints;
    for (const ParameterConstraint& start : start_of_contained(*row, simple, least_gain(data), smallness)) {
      const auto own = std::find_if(warm.constraints.begin(), warm.constraints.end(),
                                    [&](const ParameterConstraint& each) { return each.name == start.name; });
      if (own == warm.constraints.end()) {
        warm.constraints.push_back(start);
      } else if (!own->fixed) {
        own->start = start.start;
      }
    }
    try {
      FitResult fit = frac::fit(data, Structure(find_model(pair.rich).formula), warm);
      if (!best || fit.cost < best->cost) best = std::move(fit);
    } catch (const std::invalid_argument&) {
      // The simpler structure has its optimum where the richer one is not allowed to be, or at infinity.
    }
    if (!has_limit || (best && best->cost <= simple.cost * (1 + rounding))) break;
  }
  return best;
}

template <class Data, class Options>
FitResult no_worse(const Data& data, const Structure& structure, const Options& options, FitResult fit) {
  if (options.loss != Loss::none || !(fit.cost > 0) || fit.termination == FitTermination::no_usable_start) return fit;
  const auto preset = std::find_if(model_library().begin(), model_library().end(),
                                   [&](const NamedModel& each) { return each.formula == structure.formula(); });
  if (preset == model_library().end()) return fit;
  for (const Row& row : rows()) {
    if (row.pair.rich != preset->name) continue;
    const NamedModel& simple = find_model(row.pair.simple);
    const Structure contained(simple.formula);
    Options of_contained = options;
    // The same names have the same meaning in both; what the user says of them holds in both.
    std::erase_if(of_contained.constraints, [&](const ParameterConstraint& each) {
      const auto& names = contained.parameter_names();
      return std::find(names.begin(), names.end(), each.name) == names.end();
    });
    for (const ParameterConstraint& own : simple.constraints) {
      const bool said = std::any_of(of_contained.constraints.begin(), of_contained.constraints.end(),
                                    [&](const ParameterConstraint& each) { return each.name == own.name; });
      if (!said) of_contained.constraints.push_back(own);
    }
    FitResult optimum;
    try {
      optimum = frac::fit(data, contained, of_contained);
    } catch (const std::invalid_argument&) {
      continue;  // it is not allowed where the user wants the richer one
    }
    fit.seconds += optimum.seconds;
    if (!(optimum.cost < fit.cost * (1 - rounding))) continue;
    std::optional<FitResult> from = fitted_from(data, row.pair, options.constraints, optimum, options);
    if (!from || !(from->cost < fit.cost)) continue;
    // A minimum that the search has not seen.
    from->starts = fit.starts + 1;
    from->starts_at_best = 1;
    from->distinct_minima = fit.distinct_minima + 1;
    from->confidence_of_optimum = confidence_of_optimum(from->starts, from->distinct_minima);
    from->seconds += fit.seconds;
    fit = std::move(*from);
  }
  return fit;
}

/// Takes over the noise floor of a fit, so that all structures compared have the same weights.
FitOptions with_floor_of(FitOptions options, const FitResult& fit) {
  if (options.weight == Weight::learned && !options.noise_floor) options.noise_floor = fit.noise_floor;
  return options;
}

}  // namespace

std::optional<FitResult> fit_from_contained(const FrequencyResponseData& data, const Containment& pair,
                                            const std::vector<ParameterConstraint>& constraints,
                                            const FitResult& simple, const FitOptions& options) {
  return fitted_from(data, pair, constraints, simple, options);
}
std::optional<FitResult> fit_from_contained(const TimeResponseData& data, const Containment& pair,
                                            const std::vector<ParameterConstraint>& constraints,
                                            const FitResult& simple, const TimeFitOptions& options) {
  return fitted_from(data, pair, constraints, simple, options);
}

FitResult no_worse_than_contained(const FrequencyResponseData& data, const Structure& structure,
                                  const FitOptions& options, FitResult fit) {
  return no_worse(data, structure, with_floor_of(options, fit), std::move(fit));
}
FitResult no_worse_than_contained(const TimeResponseData& data, const Structure& structure,
                                  const TimeFitOptions& options, FitResult fit) {
  return no_worse(data, structure, options, std::move(fit));
}

}  // namespace frac::detail
