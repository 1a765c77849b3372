// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <complex>
#include <span>
#include <vector>

#include "frac/model/fractional_transfer_function.hpp"
#include "frac/time_response/reference_response.hpp"
#include "guarded.hpp"
#include "model_handle.hpp"

using namespace c_interface;

namespace {

thread_local std::string last_error;

std::span<const double> parameters_of(const double* parameters, size_t count) {
  if (count > 0) (void)given(parameters, "parameters");
  return {parameters, count};
}

}  // namespace

void c_interface::set_error(const char* sentence) noexcept {
  try {
    last_error = sentence;
  } catch (...) {
    last_error.clear();
  }
}

const char* fracfit_error(void) {
  return last_error.c_str();
}
const char* fracfit_version(void) {
  return FRACFIT_VERSION;
}

fracfit_model* fracfit_model_create(const char* formula) {
  return handle_of<fracfit_model>([&] { return new fracfit_model{frac::Structure(text(formula, "formula"))}; });
}
void fracfit_model_destroy(fracfit_model* model) {
  delete model;
}

size_t fracfit_model_parameter_count(const fracfit_model* model) {
  return model ? model->structure.parameter_names().size() : 0;
}
const char* fracfit_model_parameter_name(const fracfit_model* model, size_t index) {
  return index < fracfit_model_parameter_count(model) ? model->structure.parameter_names()[index].c_str() : nullptr;
}

int fracfit_model_response(const fracfit_model* model, const double* parameters, size_t parameter_count,
                           const double* omega, size_t count, double* re, double* im) {
  return status_of([&] {
    const frac::Structure& structure = given(model, "model").structure;
    const auto values = parameters_of(parameters, parameter_count);
    if (count == 0) return FRACFIT_OK;
    (void)given(omega, "omega"), (void)given(re, "re"), (void)given(im, "im");
    std::vector<std::complex<double>> response(count);
    structure.response(values, std::span(omega, count), frac::ExactRealisation{}, response);
    for (size_t i = 0; i < count; ++i) re[i] = response[i].real(), im[i] = response[i].imag();
    return FRACFIT_OK;
  });
}

int fracfit_model_step(const fracfit_model* model, const double* parameters, size_t parameter_count, const double* time,
                       size_t count, double* output) {
  return status_of([&] {
    const frac::Structure& structure = given(model, "model").structure;
    const auto values = parameters_of(parameters, parameter_count);
    const frac::ReferenceResponse response(frac::to_transfer_function(structure, {values.begin(), values.end()}));
    if (count == 0) return FRACFIT_OK;
    (void)given(time, "time"), (void)given(output, "output");
    auto worst = frac::ResponseStatus::exact;
    for (size_t i = 0; i < count; ++i) {
      const frac::ReferenceValue value = response(time[i]);
      output[i] = value.value;
      worst = std::max(worst, value.status);
    }
    if (worst == frac::ResponseStatus::exact) return FRACFIT_OK;
    set_error(std::string(explanation(worst)).c_str());
    return FRACFIT_NO_RESULT;
  });
}
