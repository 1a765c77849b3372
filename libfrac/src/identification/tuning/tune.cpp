// SPDX-License-Identifier: BSD-3-Clause
#include "frac/identification/tune.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <optional>
#include <stdexcept>
#include <string>

#include "base/number_text.hpp"
#include "base/short_text.hpp"
#include "base/spelling.hpp"
#include "loop_description.hpp"
#include "search.hpp"
#include "specification.hpp"

namespace frac {
namespace {

// What the search may leave between mu and its limit.
constexpr double at_limit = 1e-3;

constexpr detail::Spellings<TuningCriterion, 3> criterion_names = {{
    {TuningCriterion::sensitivity, "sensitivity"},
    {TuningCriterion::iae, "iae"},
    {TuningCriterion::itae, "itae"},
}};
constexpr detail::Spellings<ControllerStructure, 4> structure_names = {{
    {ControllerStructure::pid, "pid"},
    {ControllerStructure::pi, "pi"},
    {ControllerStructure::pd, "pd"},
    {ControllerStructure::series, "series"},
}};

}  // namespace

FractionalTransferFunction controller_transfer_function(const FractionalPidGains& gains,
                                                        double derivative_filter_time) {
  const double time = derivative_filter_time;
  if (!(time >= 0 && std::isfinite(time))) {
    throw std::invalid_argument("controller_transfer_function: derivative_filter_time = " + detail::number_text(time) +
                                " s; allowed is 0 or more, finite");
  }
  std::vector<PowerTerm> numerator{{gains.kp, 0}, {gains.ki, -gains.lambda}, {gains.kd, gains.mu}};
  if (time == 0) return {numerator, {{1, 0}}};
  numerator.push_back({gains.kp * time, 1});
  numerator.push_back({gains.ki * time, 1 - gains.lambda});
  return {numerator, {{time, 1}, {1, 0}}};
}

std::string_view to_string(TuningCriterion criterion) {
  return detail::spelling(criterion_names, criterion);
}

std::span<const TuningCriterion> tuning_criteria() {
  static constexpr auto all = detail::enumerators(criterion_names);
  return all;
}

TuningCriterion tuning_criterion_from_string(std::string_view name) {
  return detail::from_spelling(criterion_names, "tuning criterion", name);
}

std::string_view to_string(ControllerStructure structure) {
  return detail::spelling(structure_names, structure);
}

std::span<const ControllerStructure> controller_structures() {
  static constexpr auto all = detail::enumerators(structure_names);
  return all;
}

ControllerStructure controller_structure_from_string(std::string_view name) {
  return detail::from_spelling(structure_names, "controller structure", name);
}

std::string_view to_string(TuningStatus status) {
  return status == TuningStatus::met ? "met" : "not-met";
}

namespace {

// @param searched  what the search keeps on its grid, the specification or something stricter
TuningResult tuned(const FractionalTransferFunction& plant, const LoopSpecification& specification,
                   const TuningOptions& options, const LoopSpecification& searched) {
  const detail::FoundController found = detail::search_controller(plant, searched, options);
  TuningResult result;
  result.gains = found.gains;
  result.derivative_filter_time = options.derivative_filter_time;
  result.evaluations = found.evaluations;
  result.mu_limit = detail::highest_mu(plant, options);
  result.mu_at_limit = options.structure != ControllerStructure::pi && result.mu_limit < options.mu.upper &&
                       result.gains.kd != 0 && result.gains.mu > result.mu_limit - at_limit;
  const FractionalPidGains& gains = result.gains;
  if (!(std::isfinite(gains.kp) && std::isfinite(gains.ki) && std::isfinite(gains.kd))) {
    result.message = "The equations for the gains have no solution.";
    return result;
  }
  try {
    detail::describe_loop(plant, specification, options, result);
  } catch (const std::invalid_argument&) {
    // analyse_closed_loop() judges no loop whose gain stays above 1.
    result.message = "No loop with this specification was found whose gain falls below 1 at high frequency.";
    return result;
  }
  std::string failed;
  for (const ReachedSpecification& line : result.specification) {
    if (line.met) continue;
    failed += (failed.empty() ? "" : "; ") + line.name + " (asked " + detail::four_digits(line.asked) + ", reached " +
              detail::four_digits(line.reached) + ")";
  }
  if (std::min({gains.kp, gains.ki, gains.kd}) < 0)
    failed += (failed.empty() ? "" : "; ") + std::string("gains not negative");
  const double product = 4 * gains.ki * gains.kd, square = gains.kp * gains.kp;
  if (options.structure == ControllerStructure::series && product > square)
    failed += (failed.empty() ? "" : "; ") + std::string("real zeros (4 ki kd over kp^2 at most 1, reached ") +
              detail::four_digits(product / square) + ")";
  if (result.closed_loop != Stability::stable) {
    result.message = "No stable loop with this specification was found; the closed loop is " +
                     std::string(to_string(result.closed_loop)) + ".";
  } else if (!failed.empty()) {
    result.message = "No controller was found that keeps everything; the nearest one misses: " + failed + ".";
  } else {
    result.status = TuningStatus::met;
    result.message = "The closed loop is stable and keeps the specification.";
    if (options.criterion != TuningCriterion::sensitivity && found.searches > 0)
      result.message += " " + std::to_string(found.alike) + " of " + std::to_string(found.searches) +
                        " searches ended within 1 % of its integral.";
  }
  for (const Crossover& each : result.other_crossovers) {
    result.message += " |L| is 1 at " + detail::four_digits(each.omega) + " rad/s too";
    // Far up a dead time has turned L so often that rounding leaves no phase.
    if (std::isfinite(each.margin))
      result.message +=
          ", with a phase margin of " + detail::four_digits(each.margin * 180 / std::numbers::pi) + " degrees";
    result.message += ".";
  }
  if (result.mu_at_limit) {
    result.message += " mu stands at its limit, " + detail::four_digits(result.mu_limit) +
                      ": above it the loop would fall more slowly than s^-0.2 at high frequency.";
  }
  return result;
}

// Whether some controller keeps the specification, and with which the objective of the options is least.
std::optional<TuningResult> kept(const FractionalTransferFunction& plant, const LoopSpecification& asked,
                                 const TuningOptions& options) {
  TuningResult result = tuned(plant, asked, options, asked);
  return result.usable() ? std::optional(std::move(result)) : std::nullopt;
}

// The feasible crossover next to the one asked for on one side: steps that double, then halving in the logarithm.
std::optional<double> next_crossover(const FractionalTransferFunction& plant, LoopSpecification asked,
                                     const TuningOptions& options, double direction) {
  constexpr double first_step = 0.05, farthest = 4;  // e-folds
  constexpr int halvings = 6;
  const double from = *asked.crossover;
  const auto is_kept = [&](double way) {
    asked.crossover = from * std::exp(direction * way);
    return kept(plant, asked, options).has_value();
  };
  double infeasible = 0, feasible = first_step;
  while (!is_kept(feasible)) {
    infeasible = feasible;
    feasible *= 2;
    if (feasible > farthest) return {};
  }
  for (int i = 0; i < halvings; ++i) {
    const double middle = (infeasible + feasible) / 2;
    (is_kept(middle) ? feasible : infeasible) = middle;
  }
  return from * std::exp(direction * feasible);
}

FeasibleNearby feasible_nearby(const FractionalTransferFunction& plant, const LoopSpecification& asked,
                               TuningOptions options) {
  options.criterion = TuningCriterion::sensitivity;
  options.horizon = 0;
  options.objective = {};
  FeasibleNearby nearby{{}, next_crossover(plant, asked, options, -1), next_crossover(plant, asked, options, 1)};
  LoopSpecification any_margin = asked;
  any_margin.phase_margin.reset();
  const std::complex<double> value = plant.response(*asked.crossover);
  options.objective = [&](const FractionalPidGains& gains, double) {
    const auto loop =
        value * controller_transfer_function(gains, options.derivative_filter_time).response(*asked.crossover);
    return std::abs(std::arg(-loop) - *asked.phase_margin);
  };
  if (const auto nearest = kept(plant, any_margin, options)) nearby.phase_margin = nearest->phase_margin;
  return nearby;
}

std::string text_of(const FeasibleNearby& nearby) {
  std::string text;
  if (nearby.phase_margin) {
    text += " At this crossover the nearest phase margin within reach is " +
            detail::four_digits(*nearby.phase_margin * 180 / std::numbers::pi) + " degrees.";
  }
  if (nearby.lower_crossover || nearby.higher_crossover) {
    text += " At this phase margin the nearest crossover within reach is " +
            (nearby.lower_crossover ? detail::four_digits(*nearby.lower_crossover) : std::string()) +
            (nearby.lower_crossover && nearby.higher_crossover ? " or " : "") +
            (nearby.higher_crossover ? detail::four_digits(*nearby.higher_crossover) : std::string()) + " rad/s.";
  }
  return text.empty() ? " Nothing near by was found either." : text;
}

}  // namespace

TuningResult tune(const FractionalTransferFunction& plant, const LoopSpecification& specification,
                  const TuningOptions& asked_options) {
  TuningOptions options = asked_options;
  if (options.structure == ControllerStructure::series) options.lambda = options.mu = {1, 1};
  detail::require_valid(plant, specification, options);
  TuningResult result = tuned(plant, specification, options, specification);
  // A peak between the frequencies of the search is missed by a little: again with that to spare.
  constexpr double little = 1.01;
  const bool is_near = result.closed_loop == Stability::stable &&
                       std::ranges::all_of(result.specification, [](const ReachedSpecification& line) {
                         return line.met || line.reached <= little * line.asked;
                       });
  if (!result.usable() && is_near) {
    LoopSpecification stricter = specification;
    stricter.max_sensitivity /= little;
    stricter.max_complementary_sensitivity /= little;
    if (stricter.high_frequency) stricter.high_frequency->gain /= little;
    if (stricter.low_frequency) stricter.low_frequency->gain /= little;
    TuningResult again = tuned(plant, specification, options, stricter);
    if (again.usable()) return again;
  }
  if (result.usable() || !specification.crossover || !specification.phase_margin) return result;
  result.nearby = feasible_nearby(plant, specification, options);
  result.message += text_of(result.nearby);
  return result;
}

}  // namespace frac
