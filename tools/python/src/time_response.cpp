// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <stdexcept>
#include <string>

#include "arrays.hpp"
#include "frac/cancellation.hpp"
#include "frac/fractional_derivative.hpp"
#include "frac/model/delayed_loop.hpp"
#include "frac/time_response/loop_response.hpp"
#include "frac/time_response/response_methods.hpp"
#include "parts.hpp"
#include "run.hpp"

namespace python {
namespace {

frac::ResponseInput named_input(const std::string& name, double omega) {
  using Kind = frac::ResponseInput::Kind;
  if (name == "step") return {Kind::step};
  if (name == "impulse") return {Kind::impulse};
  if (name == "ramp") return {Kind::ramp};
  if (name == "sine") return {Kind::sine, omega};
  throw std::invalid_argument("input is '" + name + "'; expected step, impulse, ramp, sine or samples");
}

py::dict response(const frac::FractionalTransferFunction& model, const frac::TimeInput& input, const Reals& time,
                  double tolerance, const std::string& method) {
  const frac::ResponseMethod chosen = frac::response_method_from_string(method);
  const auto at = span_of(time);
  auto found = result_of([&](frac::Progress&) { return frac::respond(model, input, at, tolerance, chosen); });
  py::dict result;
  result["method"] = std::string(frac::to_string(found.method));
  result["error_estimate"] = found.error_estimate;
  result["meets_tolerance"] = found.meets_tolerance;
  result["summary"] = found.summary();
  result["output"] = array_of(std::move(found.output));
  return result;
}

py::dict loop_response(const frac::DelayedLoop& closed, const frac::TimeInput& input, const Reals& time,
                       double tolerance, const std::string& method) {
  if (frac::response_method_from_string(method) != frac::ResponseMethod::automatic) {
    throw std::invalid_argument("method is '" + method + "'; a closed loop with dead time has one method, auto");
  }
  const auto at = span_of(time);
  auto found = result_of(
      [&](frac::Progress&) { return frac::respond_closed_loop(closed.forward, closed.loop, input, at, tolerance); });
  py::dict result;
  result["method"] = "closed-loop";
  result["error_estimate"] = found.error_estimate;
  result["meets_tolerance"] = found.meets_tolerance;
  result["summary"] = found.summary();
  result["output"] = array_of(std::move(found.output));
  return result;
}

py::array_t<double> derivative(const Reals& samples, double order, double sample_time, double tolerance) {
  const auto from = span_of(samples);
  std::vector<double> output(from.size());
  run([&](frac::Progress&) {
    constexpr std::size_t block = 8192;
    frac::FractionalDerivative<double> stream(order, sample_time, tolerance,
                                              std::max<double>(1, static_cast<double>(from.size())));
    for (std::size_t i = 0; i < from.size(); i += block) {
      frac::throw_if_cancelled();
      const std::size_t count = std::min(block, from.size() - i);
      stream.run(from.subspan(i, count), std::span(output).subspan(i, count));
    }
  });
  return array_of(std::move(output));
}

}  // namespace

void add_time_response(py::module_& module) {
  module.def("respond_named", [](const frac::FractionalTransferFunction& model, const std::string& input, double omega,
                                 const Reals& time, double tolerance, const std::string& method) {
    return response(model, named_input(input, omega), time, tolerance, method);
  });
  module.def("respond_sampled",
             [](const frac::FractionalTransferFunction& model, const Reals& input_time, const Reals& input,
                const std::string& hold, const Reals& time, double tolerance, const std::string& method) {
               const frac::SampledInput samples{vector_of(input_time), vector_of(input), frac::hold_from_string(hold)};
               return response(model, samples, time, tolerance, method);
             });
  module.def("respond_named", [](const frac::DelayedLoop& closed, const std::string& input, double omega,
                                 const Reals& time, double tolerance, const std::string& method) {
    return loop_response(closed, named_input(input, omega), time, tolerance, method);
  });
  module.def("respond_sampled",
             [](const frac::DelayedLoop& closed, const Reals& input_time, const Reals& input, const std::string& hold,
                const Reals& time, double tolerance, const std::string& method) {
               const frac::SampledInput samples{vector_of(input_time), vector_of(input), frac::hold_from_string(hold)};
               return loop_response(closed, samples, time, tolerance, method);
             });
  module.def("derivative", &derivative);
}

}  // namespace python
