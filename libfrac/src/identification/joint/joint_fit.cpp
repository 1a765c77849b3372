// SPDX-License-Identifier: BSD-3-Clause
#include "frac/identification/joint_fit.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <limits>
#include <optional>
#include <stdexcept>

#include "base/counted.hpp"
#include "curves_alone.hpp"
#include "frac/identification/constraints.hpp"
#include "identification/data/fit_data.hpp"
#include "identification/data/formula_checks.hpp"
#include "identification/search/robust.hpp"
#include "identification/statistics/definition.hpp"
#include "joint_confidence.hpp"
#include "joint_result.hpp"
#include "noise_levels.hpp"
#include "shift.hpp"
#include "special/distributions.hpp"

namespace frac {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

using Alone = std::vector<std::optional<FitResult>>;

/// Standard deviations as far as their levels differ no more than chance makes them.
std::vector<double> moderated(const std::vector<detail::CurveVariance>& told) {
  std::vector<double> deviation = detail::moderated_variances(told);
  for (double& each : deviation) each = std::sqrt(each);
  return deviation;
}

/// Standard deviation of a residual of each curve, of the well-behaved ones under a loss.
std::vector<double> noise_of(const std::vector<JointCurve>& curves, const std::vector<detail::ResidualRule>& rules,
                             const Alone& alone, const FitOptions& options) {
  if (options.weight == Weight::given || options.weight == Weight::repeats)
    return std::vector<double>(curves.size(), 1.0);
  std::vector<detail::CurveVariance> told(curves.size(), {0, 0});
  for (std::size_t c = 0; c < curves.size(); ++c) {
    if (!alone[c]) continue;
    const double degrees = static_cast<double>(alone[c]->residuals) - static_cast<double>(alone[c]->free_parameters);
    // An exact fit leaves rounding, of which no less than this is meant.
    const double rounding = 1e-14 * rules[c].unit;
    if (!(degrees > 0)) continue;
    const double spread = alone[c]->loss_scale / detail::tuning_constant(options.loss);
    const double variance = options.loss == Loss::none ? alone[c]->cost / degrees : spread * spread;
    told[c] = {std::max(variance, rounding * rounding), degrees};
  }
  return moderated(told);
}

/// The loss of each curve at the scale of its fit alone, or at that of its noise.
void set_losses(std::vector<detail::CurveResiduals>& curves, const Alone& alone, const FitOptions& options) {
  for (std::size_t c = 0; c < curves.size() && options.loss != Loss::none; ++c) {
    const double scale = options.loss_scale ? *options.loss_scale
                         : alone[c]         ? alone[c]->loss_scale
                                            : detail::tuning_constant(options.loss) * curves[c].noise();
    curves[c].set_loss(options.loss, scale / curves[c].noise());
  }
}

/// Values of every variable in the fits alone, one list per curve that has one; the user's starts where none has.
struct StartValues {
  std::vector<std::vector<double>> parameters;  // of each curve
  std::vector<bool> from_curve;
};

StartValues start_values(const Structure& structure, const JointFitOptions& options, const Alone& alone) {
  std::vector<double> otherwise;
  const auto best = std::min_element(alone.begin(), alone.end(), [](const auto& a, const auto& b) {
    return a.has_value() && (!b.has_value() || a->rms < b->rms);
  });
  if (best->has_value()) {
    for (const ParameterEstimate& each : (*best)->parameters) otherwise.push_back(each.value);
  } else {
    for (const std::string& name : structure.parameter_names()) {
      const auto known = std::find_if(options.fit.constraints.begin(), options.fit.constraints.end(),
                                      [&](const ParameterConstraint& each) { return each.name == name; });
      if (known == options.fit.constraints.end() || !(known->start || known->fixed || known->prior))
        throw std::invalid_argument("no curve alone determines all parameters of " + structure.formula() +
                                    "; give a start value for '" + name + "'");
      otherwise.push_back(known->start ? *known->start : known->fixed ? *known->fixed : known->prior->value);
    }
  }
  StartValues result;
  for (const auto& fit : alone) {
    result.from_curve.push_back(fit.has_value());
    std::vector<double>& values = result.parameters.emplace_back(otherwise);
    for (std::size_t i = 0; fit && i < values.size(); ++i) values[i] = fit->parameters[i].value;
  }
  return result;
}

/// Constraints on parameters of the laws, which the fits of single curves do not know.
std::vector<ParameterConstraint> taken_out(std::vector<ParameterConstraint>& constraints, const detail::Laws& laws) {
  std::vector<ParameterConstraint> of_laws;
  for (const ParameterConstraint& each : constraints) {
    if (!laws.has(each.name)) continue;
    if (each.fixed)
      throw std::invalid_argument("parameter '" + each.name + "' of a law is fixed; write the number into the law");
    of_laws.push_back(each);
  }
  std::erase_if(constraints, [&](const ParameterConstraint& each) { return laws.has(each.name); });
  return of_laws;
}

/// Returns the variables that stand for the parameters of the laws, and where they start.
std::vector<detail::JointVariable> variables_of(const detail::Laws& laws,
                                                const std::vector<ParameterConstraint>& constraints,
                                                const StartValues& values, std::vector<double>& starts) {
  std::vector<detail::JointVariable> variables;
  if (laws.count() == 0) return variables;
  constexpr double widest = 1e300, widest_logarithm = 350;
  std::vector<double> given;
  for (const std::string& name : laws.names()) {
    const auto known = std::find_if(constraints.begin(), constraints.end(),
                                    [&](const ParameterConstraint& each) { return each.name == name; });
    const bool any = known != constraints.end();
    if (any && !known->above.empty())
      throw std::invalid_argument("parameter '" + name + "' is of a law, and stands in no order of parameters");
    given.push_back(!any ? nan : known->start ? *known->start : known->prior ? known->prior->value : nan);
    variables.push_back({name, false, any && known->lower ? std::max(*known->lower, -widest) : -widest,
                         any && known->upper ? std::min(*known->upper, widest) : widest});
  }
  starts = laws.starts(values.parameters, values.from_curve, given);
  for (std::size_t k = 0; k < variables.size(); ++k) {
    detail::JointVariable& each = variables[k];
    if (!(starts[k] > 0) || (each.lower < 0 && each.lower > -widest) || !laws.scales(k, starts)) continue;
    each.logarithmic = true;
    each.lower = each.lower > 0 ? std::log(each.lower) : -widest_logarithm;
    each.upper = each.upper < widest ? std::log(each.upper) : widest_logarithm;
  }
  return variables;
}

/// Starts of the shared variables: means of the fits alone by their errors, medians, and the values of the curve that
/// tells most of them together.
/// @param law_starts  of the parameters of the laws
std::vector<std::vector<double>> shared_starts(const detail::JointLayout& layout, const StartValues& values,
                                               const Alone& alone, const std::vector<double>& law_starts) {
  std::vector<double> mean(layout.shared.size()), median(mean), best(mean);
  std::size_t sharpest = 0;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t c = 0; c < alone.size(); ++c) {
    double sum = 0;
    for (const auto& place : layout.free) {
      if (!place.shared || !alone[c]) continue;
      const ParameterEstimate& estimate = alone[c]->parameters[place.parameter];
      sum += std::abs(estimate.standard_error / estimate.value);
    }
    if (alone[c] && sum < least) {
      least = sum;
      sharpest = c;
    }
  }
  for (const auto& place : layout.free) {
    if (!place.shared) continue;
    const detail::JointVariable& variable = layout.variable(place);
    std::vector<double> all;
    double sum = 0, weights = 0;
    for (std::size_t c = 0; c < alone.size(); ++c) {
      if (!values.from_curve[c]) continue;
      const double here = variable.variable(values.parameters[c][place.parameter]);
      all.push_back(here);
      const ParameterEstimate& estimate = alone[c]->parameters[place.parameter];
      const double error = estimate.standard_error / std::abs(variable.derivative(here));
      if (!estimate.identified || !(error > 0)) continue;
      sum += here / (error * error);
      weights += 1 / (error * error);
    }
    if (all.empty()) all.push_back(variable.variable(values.parameters[0][place.parameter]));
    std::nth_element(all.begin(), all.begin() + static_cast<std::ptrdiff_t>(all.size() / 2), all.end());
    median[place.index] = all[all.size() / 2];
    mean[place.index] = weights > 0 && std::isfinite(weights) ? sum / weights : median[place.index];
    best[place.index] = variable.variable(values.parameters[sharpest][place.parameter]);
  }
  const std::size_t first = layout.shared.size() - law_starts.size();
  for (std::size_t k = 0; k < law_starts.size(); ++k)
    for (auto* start : {&mean, &median, &best}) (*start)[first + k] = layout.shared[first + k].variable(law_starts[k]);
  // What is known beforehand is a start as well.
  std::vector<double> known = mean;
  for (const detail::JointPrior& prior : layout.shared_priors) {
    for (const auto& place : layout.free) {
      if (place.shared && place.parameter == prior.parameter)
        known[place.index] = layout.variable(place).variable(prior.prior.value);
    }
    if (prior.law_variable != detail::JointLayout::no_place)
      known[prior.law_variable] = layout.shared[prior.law_variable].variable(prior.prior.value);
  }
  std::vector<std::vector<double>> starts{mean};
  for (const auto& each : {median, best, known})
    if (std::find(starts.begin(), starts.end(), each) == starts.end()) starts.push_back(each);
  return starts;
}

std::vector<std::vector<double>> own_starts(const detail::JointLayout& layout, const StartValues& values) {
  std::vector<std::vector<double>> own(values.parameters.size(), std::vector<double>(layout.own.size()));
  for (std::size_t c = 0; c < own.size(); ++c)
    for (const auto& place : layout.free)
      if (!place.shared) own[c][place.index] = layout.own[place.index].variable(values.parameters[c][place.parameter]);
  return own;
}

/// The best of the searches from all starts, and how many ended there.
detail::JointPoint search(std::vector<detail::CurveResiduals>& curves, const detail::JointLayout& layout,
                          const std::vector<std::vector<double>>& shared, const std::vector<std::vector<double>>& own,
                          JointFitResult& result) {
  constexpr double coarse = 1e-7, settled = 1e-14, alike = 1e-5;
  std::vector<double> costs;
  detail::JointPoint best;
  best.cost = std::numeric_limits<double>::infinity();
  for (const std::vector<double>& start : shared) {
    detail::JointPoint at{start, own, 0, false};
    for (std::vector<double>& values : at.own) {
      at.shared = start;
      layout.take_order(at.shared, values);
    }
    const detail::JointPoint point = joint_solve(curves, layout, std::move(at), coarse);
    costs.push_back(point.cost);
    if (point.cost < best.cost) best = point;
  }
  result.starts = costs.size();
  if (!std::isfinite(best.cost)) return best;
  const auto count =
      std::count_if(costs.begin(), costs.end(), [&](double each) { return each <= best.cost * (1 + alike); });
  result.starts_at_best = static_cast<std::size_t>(count);
  return joint_solve(curves, layout, std::move(best), settled);
}

/// What is known before the curves are fitted together.
struct Preparation {
  Alone alone;
  StartValues values;
  std::vector<detail::ResidualRule> rules;
  std::vector<double> noise;
};

Preparation from_fits_alone(const std::vector<JointCurve>& curves, const Structure& structure,
                            const JointFitOptions& options) {
  JointFitOptions without_priors = options;
  for (ParameterConstraint& each : without_priors.fit.constraints) each.prior = std::nullopt;
  Preparation result{detail::fit_alone(curves, structure, without_priors), {}, {}, {}};
  result.values = start_values(structure, options, result.alone);
  for (std::size_t c = 0; c < curves.size(); ++c)
    result.rules.push_back(detail::residual_rule(
        curves[c].data, result.alone[c] ? detail::settled(options.fit, *result.alone[c]) : options.fit));
  result.noise = noise_of(curves, result.rules, result.alone, options.fit);
  return result;
}

/// Standard deviations of the residuals of each curve as a joint solution leaves them, which has taken its share of
/// the shared variables from each.
std::vector<double> noise_left(std::vector<detail::CurveResiduals>& curves, const detail::JointLayout& layout,
                               const detail::JointPoint& point, Loss loss) {
  std::size_t total = 0;
  for (const detail::CurveResiduals& curve : curves) total += curve.count();
  std::vector<detail::CurveVariance> told;
  for (std::size_t c = 0; c < curves.size(); ++c) {
    std::vector<double> residual(curves[c].rows());
    curves[c].evaluate(point.shared, point.own[c], residual.data(), nullptr);
    residual.resize(curves[c].count());
    const auto count = static_cast<double>(residual.size());
    const double degrees = count - static_cast<double>(layout.own.size()) -
                           static_cast<double>(layout.shared.size()) * count / static_cast<double>(total);
    double square = 0;
    for (const double each : residual) square += each * each;
    const double spread = detail::robust_spread(residual);
    const double variance = loss == Loss::none ? square / degrees : spread * spread;
    constexpr double rounding = 1e-14;
    if (degrees > 0)
      told.push_back({std::max(variance, rounding * rounding) * curves[c].noise() * curves[c].noise(), degrees});
    else
      told.push_back({0, 0});
  }
  return moderated(told);
}

/// What the options say of parameters of the structure itself, without shift factors and laws.
FitOptions options_of_master(const Structure& master, const JointFitOptions& options) {
  FitOptions of_master = options.fit;
  const auto& names = master.parameter_names();
  std::erase_if(of_master.constraints, [&](const ParameterConstraint& each) {
    return std::find(names.begin(), names.end(), each.name) == names.end();
  });
  return of_master;
}

Preparation from_superposition(const std::vector<JointCurve>& curves, const Structure& master,
                               const Structure& structure, const CurveShift& shift, const FitOptions& of_master) {
  const detail::Superposition found = detail::superposed(curves, master, shift, of_master);
  if (!found.master.usable())
    throw std::invalid_argument("no fit of " + master.formula() + " to all curves as one: " + found.master.message);
  Preparation result{Alone(curves.size()), {}, {}, std::vector<double>(curves.size(), found.master.rms)};
  if (!(found.master.rms > 0) || of_master.weight == Weight::given) result.noise.assign(curves.size(), 1.0);
  for (std::size_t c = 0; c < curves.size(); ++c) {
    std::vector<double>& values = result.values.parameters.emplace_back();
    for (const std::string& name : structure.parameter_names()) {
      const auto& known = found.master.parameters;
      const auto of = std::find_if(known.begin(), known.end(), [&](const auto& each) { return each.name == name; });
      values.push_back(name == horizontal_shift ? found.horizontal[c]
                       : name == vertical_shift ? found.vertical[c]
                                                : of->value);
    }
    result.values.from_curve.push_back(false);
    result.rules.push_back(detail::residual_rule(curves[c].data, detail::settled(of_master, found.master)));
  }
  return result;
}

/// Shift factors are positive, whatever else is known of them.
void keep_shifts_positive(std::vector<ParameterConstraint>& constraints, const CurveShift& shift) {
  for (const char* name : {horizontal_shift, vertical_shift}) {
    if (name == vertical_shift && !shift.vertical) continue;
    ParameterConstraint& each = constraint_of(constraints, name);
    constexpr double largest = 1e150;
    if (!each.fixed && !each.upper) each.upper = largest;
  }
}

/// Priors weigh against the residuals by the noise that these tell, so that the solution moves until that stays.
detail::JointConfidence weighed_confidence(std::vector<detail::CurveResiduals>& curves,
                                           const detail::JointLayout& layout, detail::JointPoint& point) {
  constexpr double least = 1e-9;  // of the noise of the fits alone
  constexpr double settled = 1e-4;
  constexpr int most_rounds = 20;
  detail::JointConfidence found = joint_confidence(curves, layout, point);
  if (layout.shared_priors.empty() && layout.own_priors.empty()) return found;
  for (int round = 0; round < most_rounds && found.loss_unit >= 0; ++round) {
    const double noise = std::max(std::sqrt(found.loss_unit), least);
    if (std::abs(noise - curves.front().prior_weight()) <= settled * noise) break;
    for (detail::CurveResiduals& curve : curves) curve.set_prior_weight(noise);
    constexpr double cost_tolerance = 1e-14;
    point = joint_solve(curves, layout, std::move(point), cost_tolerance);
    found = joint_confidence(curves, layout, point);
  }
  return found;
}

/// The residuals of each curve, weighed as the fits alone say.
std::vector<detail::CurveResiduals> problem_of(const std::vector<JointCurve>& curves, const Structure& structure,
                                               const FitOptions& options, const detail::JointLayout& layout,
                                               const Preparation& known) {
  std::vector<detail::CurveResiduals> problem;
  for (std::size_t c = 0; c < curves.size(); ++c)
    problem.emplace_back(curves[c].data, structure, options.realisation, layout, c, known.rules[c], known.noise[c]);
  set_losses(problem, known.alone, options);
  return problem;
}

/// @throws std::invalid_argument  there are more free parameters than residuals
void count(const std::vector<detail::CurveResiduals>& problem, const detail::JointLayout& layout,
           JointFitResult& result) {
  std::size_t held = 0;
  for (std::size_t c = 0; c < problem.size(); ++c) {
    result.residuals += problem[c].count();
    for (std::size_t k = 0; k < layout.own.size(); ++k) held += layout.is_held(c, k) ? 1 : 0;
  }
  result.free_parameters = layout.shared.size() + problem.size() * layout.own.size() - held;
  if (result.residuals < result.free_parameters)
    throw std::invalid_argument(detail::counted(result.residuals, "residual") + " cannot determine " +
                                detail::counted(result.free_parameters, "free parameter"));
}

/// Limits of parameters that a law drives are those of the law.
void free_driven(std::vector<ParameterConstraint>& constraints, const Structure& structure, const detail::Laws& laws) {
  for (ParameterConstraint& each : constraints)
    if (laws.drives(structure.parameter_index(each.name)) && !each.fixed) each.lower = each.upper = std::nullopt;
}

struct OmegaRange {
  double lower = std::numeric_limits<double>::infinity(), upper = 0;
};
OmegaRange range_of(const std::vector<JointCurve>& curves) {
  OmegaRange range;
  for (const JointCurve& curve : curves) {
    range.lower = std::min(range.lower, curve.data.omega().front());
    range.upper = std::max(range.upper, curve.data.omega().back());
  }
  return range;
}

/// A search of all variables from what is known before: of the problem, its laws, and where it ended.
class Search {
 public:
  Search(const std::vector<JointCurve>& curves, const Structure& structure, JointFitOptions options,
         const Preparation& known, const detail::Laws& laws) {
    const std::vector<ParameterConstraint> of_laws = taken_out(options.fit.constraints, laws);
    free_driven(options.fit.constraints, structure, laws);
    std::vector<double> law_starts;
    const std::vector<detail::JointVariable> variables = variables_of(laws, of_laws, known.values, law_starts);
    const OmegaRange range = range_of(curves);
    layout_.emplace(structure, options, laws, variables, of_laws, range.lower, range.upper);
    problem_ = problem_of(curves, structure, options.fit, *layout_, known);
    shared_ = shared_starts(*layout_, known.values, known.alone, law_starts);
    own_ = own_starts(*layout_, known.values);
  }
  Search(const Search&) = delete;
  Search& operator=(const Search&) = delete;

  /// @throws std::invalid_argument  there are more free parameters than residuals
  void run(const JointFitOptions& options, const Preparation& known, JointFitResult& result) {
    count(problem_, *layout_, result);
    point = search(problem_, *layout_, shared_, own_, result);
    if (!std::isfinite(point.cost)) return;
    squares_at_known_noise = detail::cost_of_data(problem_, point).squares;
    if (!options.shift || options.fit.weight == Weight::given) return;
    noise = noise_left(problem_, *layout_, point, options.fit.loss);
    for (std::size_t c = 0; c < problem_.size(); ++c) problem_[c].set_noise(noise[c]);
    set_losses(problem_, known.alone, options.fit);
    point = search(problem_, *layout_, shared_, own_, result);
  }

  [[nodiscard]] std::vector<double> parameters(std::size_t curve) const {
    return layout_->parameters(point.shared, point.own[curve], curve);
  }
  [[nodiscard]] const detail::JointLayout& layout() const { return *layout_; }
  [[nodiscard]] std::vector<detail::CurveResiduals>& problem() { return problem_; }

  detail::JointPoint point;
  std::vector<double> noise;          // that the search left, where it is not given
  double squares_at_known_noise = 0;  // cost with the noise it began with

 private:
  std::optional<detail::JointLayout> layout_;
  std::vector<detail::CurveResiduals> problem_;
  std::vector<std::vector<double>> shared_, own_;
};

/// Shift factors of each curve in a list of values by the structure.
struct ShiftFactors {
  std::vector<double> horizontal, vertical;
};
ShiftFactors factors_in(const std::vector<std::vector<double>>& values, const Structure& structure) {
  ShiftFactors result;
  const std::size_t along = structure.parameter_index(horizontal_shift);
  const auto& names = structure.parameter_names();
  const auto up = std::find(names.begin(), names.end(), vertical_shift);
  for (const std::vector<double>& each : values) {
    result.horizontal.push_back(each[along]);
    result.vertical.push_back(up == names.end() ? 1 : each[static_cast<std::size_t>(up - names.begin())]);
  }
  return result;
}

/// A fit to all curves as one, taken as the start of each.
void start_at(const FitResult& master, const Structure& structure, Preparation& known) {
  for (const ParameterEstimate& each : master.parameters) {
    const std::size_t place = structure.parameter_index(each.name);
    for (std::vector<double>& values : known.values.parameters) values[place] = each.value;
  }
}

/// The options without the laws of shift factors, and without what is said of parameters of these laws alone.
JointFitOptions with_free_shifts(const JointFitOptions& options, const Structure& structure,
                                 const std::vector<JointCurve>& curves, const detail::Laws& laws) {
  JointFitOptions free = options;
  std::erase_if(free.laws, [&](const std::string& law) {
    const auto [driven, right] = detail::split_definition(law);
    return driven == horizontal_shift || driven == vertical_shift;
  });
  const detail::Laws left(structure, free, curves);
  std::erase_if(free.fit.constraints,
                [&](const ParameterConstraint& each) { return laws.has(each.name) && !left.has(each.name); });
  return free;
}

/// What a fit with a shift factor of each curve leaves.
struct FreeShifts {
  double squares;  // each residual by the noise of its curve
  std::size_t residuals, free_parameters;
};

/// Fits the curves with free shift factors, which then stand in what is known, with the noise they leave.  Where the
/// weight is learned it is learned anew with the curves where that fit lays them, until they stay: where neighbours
/// lay them first depends on the order of the curves.
/// @return  none where free factors are more than the residuals tell, or nothing was found
std::optional<FreeShifts> fit_free_shifts(const std::vector<JointCurve>& curves, const Structure& master,
                                          const Structure& structure, const JointFitOptions& options,
                                          const FitOptions& of_master, Preparation& known) {
  const detail::Laws laws(structure, options, curves);
  const bool learns = options.fit.weight == Weight::learned && !options.fit.noise_floor;
  constexpr int most_rounds = 8;
  constexpr double stays = 1e-6;  // change of a factor, far below its interval
  for (int round = 0; round < most_rounds; ++round) {
    Search search(curves, structure, options, known, laws);
    JointFitResult counts{};
    search.run(options, known, counts);
    if (!std::isfinite(search.point.cost)) return std::nullopt;
    const ShiftFactors before = factors_in(known.values.parameters, structure);
    for (std::size_t c = 0; c < curves.size(); ++c) known.values.parameters[c] = search.parameters(c);
    if (!search.noise.empty()) known.noise = search.noise;
    const ShiftFactors now = factors_in(known.values.parameters, structure);
    double moved = 0;
    for (std::size_t c = 0; c < curves.size(); ++c)
      moved = std::max({moved, std::abs(std::log(now.horizontal[c] / before.horizontal[c])),
                        std::abs(std::log(now.vertical[c] / before.vertical[c]))});
    if (!learns || (round > 0 && moved < stays) || round + 1 == most_rounds)
      return FreeShifts{detail::cost_of_data(search.problem(), search.point).squares, counts.residuals,
                        counts.free_parameters};
    const FitResult all = detail::fit_laid(curves, now.horizontal, now.vertical, master, of_master);
    if (!all.usable()) return std::nullopt;
    for (std::size_t c = 0; c < curves.size(); ++c)
      known.rules[c] = detail::residual_rule(curves[c].data, detail::settled(options.fit, all));
  }
  return std::nullopt;
}

/// Laws of shift factors say where the master curve itself stands, which need not be the reference: the structure is
/// fitted to all curves where the laws lay them.
void lay_by_laws(const std::vector<JointCurve>& curves, const Structure& master, const Structure& structure,
                 JointFitOptions options, const FitOptions& of_master, const detail::Laws& laws, Preparation& known) {
  const std::vector<ParameterConstraint> of_laws = taken_out(options.fit.constraints, laws);
  std::vector<double> values;
  static_cast<void>(variables_of(laws, of_laws, known.values, values));
  std::vector<double> gradient(values.size());
  for (std::size_t l = 0; l < laws.count(); ++l)
    for (std::size_t c = 0; c < curves.size(); ++c)
      known.values.parameters[c][laws.parameter(l)] = laws.at(l, c, values, gradient);
  const ShiftFactors laid = factors_in(known.values.parameters, structure);
  const FitResult all = detail::fit_laid(curves, laid.horizontal, laid.vertical, master, of_master);
  if (all.usable()) start_at(all, structure, known);
}

/// Laws of shift factors against factors of each curve (F test): see JointFitResult::sharing_p_value.
/// @param squares  of the fit with the laws, by the noise of the free factors
void compare_with_free(const FreeShifts& free, double squares, JointFitResult& result) {
  const double saved = static_cast<double>(free.free_parameters) - static_cast<double>(result.free_parameters);
  const double degrees = static_cast<double>(free.residuals) - static_cast<double>(free.free_parameters);
  if (!(saved > 0) || !(degrees > 0) || !(free.squares > 0)) return;
  const double ratio = std::max(0.0, squares - free.squares) / saved / (free.squares / degrees);
  result.sharing_p_value = detail::fisher_f_above(ratio, saved, degrees);
  constexpr double doubtful = 0.01;
  if (!(result.sharing_p_value < doubtful) || !result.usable()) return;
  char text[240];
  std::snprintf(text, sizeof text,
                " The shift factors do not follow their law: by it residuals are %.3g times those with free factors, "
                "which chance explains with probability %.1e.",
                std::sqrt(squares / free.squares), result.sharing_p_value);
  result.message += text;
}

JointFitResult fitted(const std::vector<JointCurve>& curves, const Structure& master, const JointFitOptions& given) {
  JointFitOptions options = given;
  if (given.shift) keep_shifts_positive(options.fit.constraints, *given.shift);
  const Structure structure = given.shift ? shifted(master, *given.shift) : master;
  const detail::Laws laws(structure, given, curves);

  JointFitOptions without_laws = options;
  static_cast<void>(taken_out(without_laws.fit.constraints, laws));
  free_driven(without_laws.fit.constraints, structure, laws);

  Preparation known;
  std::optional<FreeShifts> free;
  if (given.shift) {
    const FitOptions of_master = options_of_master(master, without_laws);
    known = from_superposition(curves, master, structure, *given.shift, of_master);
    free = fit_free_shifts(curves, master, structure, with_free_shifts(options, structure, curves, laws), of_master,
                           known);
    if (laws.drive_shifts()) lay_by_laws(curves, master, structure, options, of_master, laws, known);
  } else {
    known = from_fits_alone(curves, structure, without_laws);
  }
  Search search(curves, structure, options, known, laws);
  JointFitResult result{};
  result.model = structure.formula();
  search.run(options, known, result);
  if (!std::isfinite(search.point.cost)) {
    detail::describe_failure(search.point.cost, result);
    return result;
  }
  const detail::JointConfidence found = weighed_confidence(search.problem(), search.layout(), search.point);
  for (const JointCurve& curve : curves) result.curves.emplace_back().name = curve.name;
  detail::describe({structure, search.layout(), laws, search.point, found, known.alone}, search.problem(), result);
  const bool has_priors = !search.layout().shared_priors.empty() || !search.layout().own_priors.empty();
  if (free && laws.drive_shifts() && given.fit.loss == Loss::none && !has_priors)
    compare_with_free(*free, search.squares_at_known_noise, result);
  return result;
}

}  // namespace

JointFitResult joint_fit(const std::vector<JointCurve>& curves, const Structure& master, const JointFitOptions& given) {
  const auto begin = std::chrono::steady_clock::now();
  if (curves.empty()) throw std::invalid_argument("there is no curve to fit");
  detail::require_function_of_s(master);
  validate(given.fit.realisation);
  JointFitResult result = fitted(curves, master, given);
  result.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  return result;
}

}  // namespace frac
