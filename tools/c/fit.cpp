// SPDX-License-Identifier: BSD-3-Clause
#include <complex>
#include <optional>
#include <span>
#include <vector>

#include "guarded.hpp"
#include "model_handle.hpp"

#ifdef FRACFIT_HAS_FITTING
#include <glog/logging.h>

#include "frac/identification/fit.hpp"

using namespace c_interface;

struct fracfit_fit_options {
  frac::FitOptions options;
  bool chooses_weight = false;
};

struct fracfit_fit {
  frac::FitResult result;
  std::string summary;
};

namespace {

// What the solver would print of steps that fail stands in the result.
void be_quiet() {
  static const int level = FLAGS_minloglevel = google::GLOG_FATAL;
  (void)level;
}

frac::ParameterConstraint& constraint_of(fracfit_fit_options* options, const char* parameter) {
  auto& constraints = given(options, "options").options.constraints;
  const std::string_view name = text(parameter, "parameter");
  for (auto& each : constraints)
    if (each.name == name) return each;
  constraints.emplace_back().name = name;
  return constraints.back();
}

}  // namespace

fracfit_fit_options* fracfit_fit_options_create(void) {
  return handle_of<fracfit_fit_options>([] { return new fracfit_fit_options; });
}
void fracfit_fit_options_destroy(fracfit_fit_options* options) {
  delete options;
}

int fracfit_fit_options_choose(fracfit_fit_options* options, const char* name, const char* word) {
  return status_of([&] {
    auto& chosen = given(options, "options");
    const std::string_view what = text(name, "name"), how = text(word, "word");
    if (what == "component") {
      chosen.options.component = frac::component_from_string(how);
    } else if (what == "weight") {
      chosen.options.weight = frac::weight_from_string(how);
      chosen.chooses_weight = true;
    } else if (what == "loss") {
      chosen.options.loss = frac::loss_from_string(how);
    } else {
      throw std::invalid_argument("there is no choice \"" + std::string(what) +
                                  "\" of a fit; there are component, weight and loss");
    }
    return FRACFIT_OK;
  });
}

int fracfit_fit_options_fix(fracfit_fit_options* options, const char* parameter, double value) {
  return status_of([&] {
    constraint_of(options, parameter).fixed = value;
    return FRACFIT_OK;
  });
}
int fracfit_fit_options_bound(fracfit_fit_options* options, const char* parameter, double lower, double upper) {
  return status_of([&] {
    frac::ParameterConstraint& constraint = constraint_of(options, parameter);
    constraint.lower = lower;
    constraint.upper = upper;
    return FRACFIT_OK;
  });
}
int fracfit_fit_options_start(fracfit_fit_options* options, const char* parameter, double value) {
  return status_of([&] {
    constraint_of(options, parameter).start = value;
    return FRACFIT_OK;
  });
}

fracfit_fit* fracfit_fit_create(const fracfit_model* model, const double* omega, const double* re, const double* im,
                                const double* sigma, size_t count, const fracfit_fit_options* options) {
  return handle_of<fracfit_fit>([&] {
    be_quiet();
    const frac::Structure& structure = given(model, "model").structure;
    if (count > 0) (void)given(omega, "omega"), (void)given(re, "re"), (void)given(im, "im");
    std::vector<std::complex<double>> value(count);
    for (size_t i = 0; i < count; ++i) value[i] = {re[i], im[i]};
    std::vector<double> deviation;
    if (sigma) deviation.assign(sigma, sigma + count);
    const frac::FrequencyResponseData data({omega, omega + count}, std::move(value), std::move(deviation));
    frac::FitOptions how = options ? options->options : frac::FitOptions{};
    if (sigma && !(options && options->chooses_weight)) how.weight = frac::Weight::given;
    frac::FitResult result = frac::fit(data, structure, how);
    std::string summary = result.summary();
    return new fracfit_fit{std::move(result), std::move(summary)};
  });
}
void fracfit_fit_destroy(fracfit_fit* fit) {
  delete fit;
}

int fracfit_fit_usable(const fracfit_fit* fit) {
  return fit && fit->result.usable() ? 1 : 0;
}
const char* fracfit_fit_summary(const fracfit_fit* fit) {
  return fit ? fit->summary.c_str() : "";
}
size_t fracfit_fit_parameter_count(const fracfit_fit* fit) {
  return fit ? fit->result.parameters.size() : 0;
}
const char* fracfit_fit_parameter_name(const fracfit_fit* fit, size_t index) {
  return index < fracfit_fit_parameter_count(fit) ? fit->result.parameters[index].name.c_str() : nullptr;
}

int fracfit_fit_parameter(const fracfit_fit* fit, size_t index, double* value, double* standard_error,
                          double* ci95_lower, double* ci95_upper) {
  return status_of([&] {
    const auto& parameters = given(fit, "fit").result.parameters;
    if (index >= parameters.size())
      throw std::invalid_argument("there is no parameter " + std::to_string(index) + ", counted from 0; there are " +
                                  std::to_string(parameters.size()));
    const frac::ParameterEstimate& estimate = parameters[index];
    if (value) *value = estimate.value;
    if (standard_error) *standard_error = estimate.standard_error;
    if (ci95_lower) *ci95_lower = estimate.ci95_lower;
    if (ci95_upper) *ci95_upper = estimate.ci95_upper;
    return FRACFIT_OK;
  });
}

double fracfit_fit_rms(const fracfit_fit* fit) {
  return number_of(fit, "fit", [](const auto& each) { return each.result.rms; });
}
double fracfit_fit_cost(const fracfit_fit* fit) {
  return number_of(fit, "fit", [](const auto& each) { return each.result.cost; });
}

#else  // The same functions where the library is built without what fits.

namespace {

int refuse() noexcept {
  c_interface::set_error("this library is built without what fits: -DFRAC_BUILD_FITTING=OFF");
  return FRACFIT_WRONG_USE;
}
template <typename Value>
Value refuse(Value value) noexcept {
  (void)refuse();
  return value;
}

}  // namespace

fracfit_fit_options* fracfit_fit_options_create(void) {
  return refuse<fracfit_fit_options*>(nullptr);
}
void fracfit_fit_options_destroy(fracfit_fit_options*) {}
int fracfit_fit_options_choose(fracfit_fit_options*, const char*, const char*) {
  return refuse();
}
int fracfit_fit_options_fix(fracfit_fit_options*, const char*, double) {
  return refuse();
}
int fracfit_fit_options_bound(fracfit_fit_options*, const char*, double, double) {
  return refuse();
}
int fracfit_fit_options_start(fracfit_fit_options*, const char*, double) {
  return refuse();
}
fracfit_fit* fracfit_fit_create(const fracfit_model*, const double*, const double*, const double*, const double*,
                                size_t, const fracfit_fit_options*) {
  return refuse<fracfit_fit*>(nullptr);
}
void fracfit_fit_destroy(fracfit_fit*) {}
int fracfit_fit_usable(const fracfit_fit*) {
  return 0;
}
const char* fracfit_fit_summary(const fracfit_fit*) {
  return "";
}
size_t fracfit_fit_parameter_count(const fracfit_fit*) {
  return 0;
}
const char* fracfit_fit_parameter_name(const fracfit_fit*, size_t) {
  return nullptr;
}
int fracfit_fit_parameter(const fracfit_fit*, size_t, double*, double*, double*, double*) {
  return refuse();
}
double fracfit_fit_rms(const fracfit_fit*) {
  return refuse(std::numeric_limits<double>::quiet_NaN());
}
double fracfit_fit_cost(const fracfit_fit*) {
  return refuse(std::numeric_limits<double>::quiet_NaN());
}
#endif
