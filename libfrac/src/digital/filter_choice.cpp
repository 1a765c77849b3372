// SPDX-License-Identifier: BSD-3-Clause
#include <stdexcept>
#include <string>

#include "frac/digital/digital_filter.hpp"

namespace frac {

FilterChoice power_filter(const FractionalTransferFunction& model, FrequencyBand band, ApproximationGoal goal,
                          double sample_time, Discretisation discretisation) {
  if (model.numerator().size() != 1 || model.denominator().size() != 1 || model.delay() != 0) {
    throw std::invalid_argument("power_filter: " + model.formula() + " is no power of s; needed is c s^order");
  }
  const double order = model.numerator()[0].order - model.denominator()[0].order;
  const DigitalPower power = digital_power(order, band, goal, sample_time, discretisation);
  FilterChoice choice{filter_design(power), power.error.max_relative, {}};
  const double factor = model.numerator()[0].coefficient / model.denominator()[0].coefficient;
  for (double& tap : choice.design.taps) tap *= factor;
  if (power.status == ApproximationStatus::not_attainable) choice.note = power.message;
  return choice;
}

FilterChoice model_filter(const FractionalTransferFunction& model, std::optional<FrequencyBand> band,
                          double sample_time, double tolerance, double horizon) {
  const auto for_all = [&] { return FilterChoice{filter_design(model, sample_time, tolerance, horizon)}; };
  // A model that grows would answer each step of the held input by a jump that depends on the band's upper end.
  const bool grows = model.numerator().front().order > model.denominator().front().order;
  if (!band || grows) return for_all();
  const RationalModel system = realise(model, *band, tolerance);
  FilterChoice on_band;
  try {
    on_band = {filter_design(system, sample_time), system.max_relative_error,
               system.status == RationalModelStatus::met ? "" : system.message};
  } catch (const std::invalid_argument& failure) {
    FilterChoice all = for_all();
    all.note =
        std::string("A filter for all frequencies is written, because one for the band alone is not possible: ") +
        failure.what() + ".";
    return all;
  }
  FilterChoice all = for_all();
  return all.design.states() <= on_band.design.states() ? all : on_band;
}

}  // namespace frac
