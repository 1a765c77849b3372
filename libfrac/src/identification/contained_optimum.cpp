// SPDX-License-Identifier: BSD-3-Clause
#include "identification/contained_optimum.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>

#include "frac/identification/constraints.hpp"
#include "frac/identification/model_library.hpp"
#include "frac/identification/outliers.hpp"
#include "identification/data/fit_data.hpp"
#include "identification/recognised_preset.hpp"
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

/// Start values of the richer structure where it is the simpler one.
/// @param smallness  for what is little
std::vector<ParameterConstraint> start_of_contained(const Row& row, const RecognisedPreset& rich, const FitResult& fit,
                                                    double gain_of_data, double smallness) {
  const RecognisedPreset simple = recognised_preset(Structure(fit.model)).value();
  std::vector<ParameterConstraint> starts;
  const auto value_of = [&](std::string_view preset_name) {
    for (std::size_t i = 0; i < simple.preset_names.size(); ++i) {
      if (simple.preset_names[i] != preset_name) continue;
      for (const ParameterEstimate& estimate : fit.parameters)
        if (estimate.name == simple.structure_names[i]) return std::optional(estimate.value);
    }
    return std::optional<double>();
  };
  for (std::size_t i = 0; i < rich.preset_names.size(); ++i) {
    const auto differs = std::find_if(row.differs.begin(), row.differs.end(),
                                      [&](const Value& value) { return value.parameter == rich.preset_names[i]; });
    std::optional<double> start;
    if (differs == row.differs.end()) {
      start = value_of(rich.preset_names[i]);
    } else {
      const double unit = differs->of == gain ? gain_of_data : value_of(differs->of).value_or(1);
      start = (differs->factor == little ? smallness : differs->factor) * std::pow(unit, differs->power);
    }
    if (start) starts.push_back({rich.structure_names[i], {}, {}, {}, start});
  }
  return starts;
}

constexpr double rounding = 1e-9;  // of costs

template <class Data, class Options>
std::optional<FitResult> fitted_from(const Data& data, const Row& row, const Structure& structure,
                                     const RecognisedPreset& rich, const FitResult& simple, const Options& options) {
  const bool has_limit =
      std::any_of(row.differs.begin(), row.differs.end(), [](const Value& value) { return value.factor == little; });
  std::optional<FitResult> best;
  for (const double smallness : {little, next_to_nothing}) {
    Options warm = options;
    warm.global_start = false;
    for (const ParameterConstraint& start : start_of_contained(row, rich, simple, least_gain(data), smallness)) {
      ParameterConstraint& own = constraint_of(warm.constraints, start.name);
      if (!own.fixed) own.start = start.start;
    }
    try {
      FitResult fit = frac::fit(data, structure, warm);
      if (!best || fit.cost < best->cost) best = std::move(fit);
    } catch (const std::invalid_argument&) {
      // The simpler structure has its optimum where the richer one is not allowed to be, or at infinity.
    }
    if (!has_limit || (best && best->cost <= simple.cost * (1 + rounding))) break;
  }
  return best;
}

template <class Data, class Options>
std::optional<FitResult> fitted_from(const Data& data, const Containment& pair, const NamedModel& model,
                                     const FitResult& simple, const Options& options) {
  const auto row = std::find_if(rows().begin(), rows().end(), [&](const Row& each) {
    return each.pair.rich == pair.rich && each.pair.simple == pair.simple;
  });
  const Structure structure(model.formula);
  Options of_model = options;
  of_model.constraints.insert(of_model.constraints.end(), model.constraints.begin(), model.constraints.end());
  return fitted_from(data, *row, structure, recognised_preset(structure).value(), simple, of_model);
}

/// Whether the contained structure leaves so much more than a fit of the richer one that its optimum on all points
/// cannot be the lower one.  Of many points some thousand are asked: what the contained structure leaves of them at its
/// best there is no more than it leaves of them anywhere.
bool is_left_behind(const FrequencyResponseData& data, const FitResult& fit, const FitOptions& options,
                    const Structure& contained, const FitOptions& of_contained) {
  // Mean squares of so many residuals are known to some 3 %, and to three times that where outliers are among them.
  constexpr std::size_t enough = 4000;
  constexpr double clearly = 1.5;
  const std::size_t every = data.size() / enough;
  if (every < 2) return false;
  std::vector<std::size_t> others;
  for (std::size_t i = 0; i < data.size(); ++i) {
    if (i % every != 0) others.push_back(i);
  }
  const FrequencyResponseData some = without_points(data, others);
  const auto square = [&](const FitOptions& own, const FitResult& of) {
    double sum = 0;
    for (const double each : weighted_residuals(some, own, of)) sum += each * each;
    return sum;
  };
  const FitResult best = frac::fit(some, contained, of_contained);
  return best.usable() && square(of_contained, best) > clearly * square(options, fit);
}
/// Simulations of records grow with their length alone; they are all compared.
bool is_left_behind(const TimeResponseData&, const FitResult&, const TimeFitOptions&, const Structure&,
                    const TimeFitOptions&) {
  return false;
}

template <class Data, class Options>
FitResult no_worse(const Data& data, const Structure& structure, const Options& options, FitResult fit) {
  if (options.loss != Loss::none || !(fit.cost > 0) || fit.termination == FitTermination::no_usable_start) return fit;
  const std::optional<RecognisedPreset> rich = recognised_preset(structure);
  if (!rich) return fit;
  for (const Row& row : rows()) {
    if (row.pair.rich != rich->preset->name) continue;
    const NamedModel& simple = find_model(row.pair.simple);
    const Structure contained(simple.formula);
    Options of_contained = options;
    // The same names of presets have the same meaning in both; what the user says of them holds in both.
    of_contained.constraints = renamed(options.constraints, rich->structure_names, rich->preset_names);
    std::erase_if(of_contained.constraints, [&](const ParameterConstraint& each) {
      const auto& names = contained.parameter_names();
      const auto is_known = [&](const std::string& name) {
        return std::find(names.begin(), names.end(), name) != names.end();
      };
      return !is_known(each.name) || (!each.above.empty() && !is_known(each.above));
    });
    for (const ParameterConstraint& own : simple.constraints) {
      const bool said = std::any_of(of_contained.constraints.begin(), of_contained.constraints.end(),
                                    [&](const ParameterConstraint& each) { return each.name == own.name; });
      if (!said) of_contained.constraints.push_back(own);
    }
    FitResult optimum;
    try {
      if (is_left_behind(data, fit, options, contained, of_contained)) continue;
      optimum = frac::fit(data, contained, of_contained);
    } catch (const std::invalid_argument&) {
      continue;  // it is not allowed where the user wants the richer one
    }
    fit.seconds += optimum.seconds;
    if (!(optimum.cost < fit.cost * (1 - rounding))) continue;
    std::optional<FitResult> from = fitted_from(data, row, structure, *rich, optimum, options);
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
                                            const NamedModel& rich, const FitResult& simple,
                                            const FitOptions& options) {
  return fitted_from(data, pair, rich, simple, options);
}
std::optional<FitResult> fit_from_contained(const TimeResponseData& data, const Containment& pair,
                                            const NamedModel& rich, const FitResult& simple,
                                            const TimeFitOptions& options) {
  return fitted_from(data, pair, rich, simple, options);
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
