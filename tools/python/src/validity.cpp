// SPDX-License-Identifier: BSD-3-Clause
#include <optional>
#include <string>
#include <vector>

#include "arrays.hpp"
#include "described.hpp"
#include "fit_request.hpp"
#include "frac/identification/describe.hpp"
#include "frac/identification/relaxation_times.hpp"
#include "frac/identification/validate.hpp"
#include "parts.hpp"
#include "run.hpp"

namespace python {
namespace {

py::dict validated(const py::dict& data, double level, double accuracy, double tolerance) {
  const frac::FrequencyResponseData points = spectrum_of(data);
  const auto found = result_of([&](frac::Progress&) { return frac::validate(points, {level, accuracy, tolerance}); });
  py::dict dict = dict_of(found);
  dict["usable"] = found.usable();
  dict["summary"] = found.summary();
  return dict;
}

frac::TimesKernel kernel_of(const std::string& text) {
  for (const auto kernel : {frac::TimesKernel::falling, frac::TimesKernel::rising})
    if (text == frac::to_string(kernel)) return kernel;
  throw std::invalid_argument("kernel \"" + text + "\": expected one of falling, rising");
}

py::dict dict_of_times(const frac::TimesDistribution& times) {
  py::dict dict = dict_of(times);
  dict["follows_data"] = times.follows_data();
  return dict;
}

py::dict times_of_data(const py::dict& data, const std::string& kernel, std::uint64_t seed) {
  const frac::FrequencyResponseData points = spectrum_of(data);
  const frac::TimesKernel chosen = kernel_of(kernel);
  return dict_of_times(result_of([&](frac::Progress&) { return frac::relaxation_times(points, chosen, seed); }));
}

py::dict times_of_fit(const py::dict& fit, const Reals& tau, const std::string& kernel) {
  const frac::FitResult result = fit_result_from(fit);
  const frac::TimesKernel chosen = kernel_of(kernel);
  const std::vector<double> times = vector_of(tau);
  return dict_of_times(result_of([&](frac::Progress&) { return frac::relaxation_times(result, times, chosen); }));
}

py::dict times_of_model(const frac::Structure& structure, const std::vector<double>& values, const Reals& tau,
                        const std::string& kernel) {
  const frac::TimesKernel chosen = kernel_of(kernel);
  const std::vector<double> times = vector_of(tau);
  return dict_of_times(
      result_of([&](frac::Progress&) { return frac::relaxation_times(structure, values, times, chosen); }));
}

}  // namespace

void add_validity(py::module_& module) {
  module.attr("described")["Validation"] = attributes_of<frac::ValidationResult>();
  module.attr("described")["RelaxationTimes"] = attributes_of<frac::TimesDistribution>();
  module.def("validate", &validated);
  module.def("times_of_data", &times_of_data);
  module.def("times_of_fit", &times_of_fit);
  module.def("times_of_model", &times_of_model);
}

}  // namespace python
