// SPDX-License-Identifier: BSD-3-Clause
#include <optional>
#include <stdexcept>
#include <string>

#include "arrays.hpp"
#include "frac/approximation/approximate.hpp"
#include "frac/digital/discretise.hpp"
#include "frac/state_space.hpp"
#include "parts.hpp"
#include "run.hpp"

namespace python {
namespace {

py::dict realised(const frac::FractionalTransferFunction& model, double lower, double upper, double tolerance,
                  const std::string& method) {
  const auto chosen = frac::realisation_method_from_string(method);
  const auto found = result_of([&](frac::Progress&) {
    return frac::realise(model, {lower, upper}, tolerance, chosen);
  });
  frac::StateSpace form = frac::modal_form(found);
  const auto states = static_cast<py::ssize_t>(form.states);
  py::dict result;
  result["A"] = array_of(std::move(form.a), {states, states});
  result["B"] = array_of(std::move(form.b), {states, 1});
  result["C"] = array_of(std::move(form.c), {1, states});
  result["D"] = array_of(std::vector{form.d}, {1, 1});
  result["delay"] = found.delay;
  result["method"] = std::string(frac::to_string(found.method));
  result["stable"] = found.stable;
  result["max_relative_error"] = found.max_relative_error;
  result["omega_at_maximum"] = found.omega_at_maximum;
  result["usable"] = found.usable();
  result["message"] = found.message;
  result["summary"] = found.summary();
  return result;
}

// Both members of a conjugate pair.
py::array_t<std::complex<double>> roots_of(const std::vector<double>& real,
                                           const std::vector<std::complex<double>>& pairs) {
  std::vector<std::complex<double>> all(real.begin(), real.end());
  for (const auto& each : pairs) all.insert(all.end(), {each, std::conj(each)});
  return array_of(std::move(all));
}

frac::ApproximationGoal goal_of(std::optional<double> tolerance, std::optional<int> poles) {
  if (tolerance.has_value() == poles.has_value())
    throw std::invalid_argument("give either the tolerance to keep or the number of poles");
  return tolerance ? frac::ApproximationGoal(frac::Tolerance{*tolerance})
                   : frac::ApproximationGoal(frac::PoleCount{*poles});
}

py::dict approximated(double order, double lower, double upper, std::optional<double> tolerance,
                      std::optional<int> poles, const std::string& method) {
  const frac::ApproximationGoal goal = goal_of(tolerance, poles);
  const auto chosen = frac::approximation_method_from_string(method);
  const auto found = result_of([&](frac::Progress&) { return frac::approximate(order, {lower, upper}, goal, chosen); });
  py::dict result;
  result["zeros"] = roots_of(found.system.zeros, found.system.zero_pairs);
  result["poles"] = roots_of(found.system.poles, found.system.pole_pairs);
  result["gain"] = found.system.gain;
  result["integer_order"] = found.system.integer_order;
  result["max_relative_error"] = found.error.max_relative;
  result["omega_at_maximum"] = found.error.omega_at_maximum;
  result["max_decibels"] = found.error.max_decibels;
  result["max_degrees"] = found.error.max_degrees;
  result["usable"] = found.usable();
  result["message"] = found.message;
  result["summary"] = found.summary();
  return result;
}

// The recursion in the samples that stands for the power.
py::dict digital(double order, double lower, double upper, std::optional<double> tolerance, std::optional<int> poles,
                 const std::string& method, double sample_time, const std::string& discretisation, std::size_t taps,
                 double amplification) {
  const frac::ApproximationGoal goal = goal_of(tolerance, poles);
  const auto chosen = frac::approximation_method_from_string(method);
  const auto rule = frac::discretisation_from_string(discretisation);
  const auto found = result_of([&](frac::Progress&) {
    return frac::digital_power(order, {lower, upper}, goal, sample_time, rule, chosen, taps, amplification);
  });
  py::dict result;
  result["sample_time"] = found.sample_time;
  result["discretisation"] = std::string(frac::to_string(found.method));
  result["taps"] = array_of(found.taps);
  result["gain"] = found.cascade.gain;
  result["rates"] = column_of<double>(found.cascade.sections, [](const auto& section) { return section.rate; });
  result["feeds"] = column_of<double>(found.cascade.sections, [](const auto& section) { return section.feed; });
  result["differences"] = found.differences;
  result["integrators"] = found.integrators;
  result["max_relative_error"] = found.error.max_relative;
  result["omega_at_maximum"] = found.error.omega_at_maximum;
  result["most_amplification"] = found.most_amplification;
  result["usable"] = found.usable();
  result["message"] = found.message;
  result["summary"] = found.summary();
  return result;
}

}  // namespace

void add_realisation(py::module_& module) {
  module.def("realise", &realised);
  module.def("approximate", &approximated);
  module.def("digital_power", &digital);
}

}  // namespace python
