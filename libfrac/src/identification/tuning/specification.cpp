// SPDX-License-Identifier: BSD-3-Clause
#include "specification.hpp"

#include <cmath>
#include <numbers>
#include <stdexcept>
#include <string>

#include "base/number_text.hpp"

namespace frac::detail {
namespace {

constexpr double pi = std::numbers::pi;

[[noreturn]] void refuse(const std::string& what) {
  throw std::invalid_argument("tune: " + what);
}

// The powers of a loop at a frequency that a search tries beside it are numbers too.
void check_positive(const char* name, double value, const char* unit) {
  if (!(value >= 1e-100 && value <= 1e100)) {
    refuse(std::string(name) + " = " + number_text(value) + unit + "; allowed is 1e-100 to 1e100");
  }
}

}  // namespace

double highest_mu(const FractionalTransferFunction& plant, const TuningOptions& options) {
  constexpr double least_fall = 0.2;
  const double order = plant.numerator().front().order - plant.denominator().front().order;
  return -order - least_fall + (options.derivative_filter_time > 0 ? 1 : 0);
}

void require_valid(const FractionalTransferFunction& plant, const LoopSpecification& asked,
                   const TuningOptions& options) {
  const double growth = plant.numerator().front().order - plant.denominator().front().order;
  if (growth > 0) {
    refuse("the plant grows as s^" + number_text(growth) + " at high frequency; allowed is a proper plant");
  }
  if (asked.crossover) check_positive("crossover", *asked.crossover, " rad/s");
  if (asked.phase_margin && !(*asked.phase_margin > 0 && *asked.phase_margin < pi)) {
    refuse("phase_margin = " + number_text(*asked.phase_margin) + " rad; allowed is within (0, pi)");
  }
  if (!asked.crossover && (asked.phase_margin || asked.flat_phase)) {
    refuse("a phase margin or flat phase needs the crossover at which it holds");
  }
  const auto check_peak = [](const char* name, double value) {
    if (!(value > 1)) refuse(std::string(name) + " = " + number_text(value) + "; allowed is above 1");
  };
  check_peak("max_sensitivity", asked.max_sensitivity);
  // |T| may stay below 1 where there is no integral term.
  if (!(asked.max_complementary_sensitivity > 0)) {
    refuse("max_complementary_sensitivity = " + number_text(asked.max_complementary_sensitivity) +
           "; allowed is above 0");
  }
  for (const auto& [name, bound] :
       {std::pair{"high_frequency", asked.high_frequency}, std::pair{"low_frequency", asked.low_frequency}}) {
    if (!bound) continue;
    check_positive((std::string(name) + ".omega").c_str(), bound->omega, " rad/s");
    check_positive((std::string(name) + ".gain").c_str(), bound->gain, "");
  }
  for (const auto& [name, range] : {std::pair{"lambda", options.lambda}, std::pair{"mu", options.mu}}) {
    if (!(range.lower >= least_controller_order && range.lower <= range.upper &&
          range.upper <= largest_controller_order)) {
      refuse(std::string(name) + " = " + (range.lower == range.upper ? "" : number_text(range.lower) + " to ") +
             number_text(range.upper) + "; allowed are orders of " + number_text(least_controller_order) + " to " +
             number_text(largest_controller_order) + ", the lower one first");
    }
  }
  if (!(options.derivative_filter_time >= 0 && std::isfinite(options.derivative_filter_time))) {
    refuse("derivative_filter_time = " + number_text(options.derivative_filter_time) +
           " s; allowed is 0 or more, finite");
  }
  if (options.horizon != 0) check_positive("horizon", options.horizon, " s");
  if (options.criterion != TuningCriterion::sensitivity && options.horizon == 0) {
    refuse("the criterion " + std::string(to_string(options.criterion)) + " needs a horizon");
  }
  const double most = highest_mu(plant, options);
  if (options.structure != ControllerStructure::pi && options.mu.lower > most) {
    refuse("mu = " + number_text(options.mu.lower) + " and above: the loop would not fall at high frequency; " +
           "allowed is " + (most > 0 ? "up to " + number_text(most) + ", or " : "") +
           "a derivative filter, or the structure pi");
  }
  const bool empty = !asked.crossover && !std::isfinite(asked.max_sensitivity) &&
                     !std::isfinite(asked.max_complementary_sensitivity) && !asked.high_frequency &&
                     !asked.low_frequency;
  if (empty && options.criterion == TuningCriterion::sensitivity) {
    refuse("nothing is asked for: give a crossover, a bound, or the criterion iae or itae");
  }
  if (!asked.crossover && !asked.low_frequency && options.criterion == TuningCriterion::sensitivity) {
    refuse("without control |S| is 1: give a crossover, a low-frequency bound, or the criterion iae or itae");
  }
}

}  // namespace frac::detail
