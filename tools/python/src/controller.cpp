// SPDX-License-Identifier: BSD-3-Clause
#include <cstring>
#include <limits>
#include <optional>
#include <stdexcept>
#include <string>
#include <type_traits>

#include "arrays.hpp"
#include "exports.hpp"
#include "frac/digital/fractional_pid.hpp"
#include "parts.hpp"
#include "run.hpp"

namespace python {
namespace {

// A controller with the design it came from.
struct Controller {
  frac::FractionalPidDesign design;
  frac::FractionalPid<double> pid;
};

frac::FractionalPidConfig config_of(const py::dict& given) {
  const auto number = [&](const char* key) { return given[key].cast<double>(); };
  frac::FractionalPidConfig config;
  config.gains = {number("kp"), number("ki"), number("kd"), number("lambda_"), number("mu")};
  config.sample_time = number("sample_time");
  if (!given["band"].is_none()) {
    const auto [lower, upper] = given["band"].cast<std::pair<double, double>>();
    config.band = {lower, upper};
  }
  if (given["poles"].is_none())
    config.goal = frac::Tolerance{number("tolerance")};
  else
    config.goal = frac::PoleCount{given["poles"].cast<int>()};
  config.minimum = number("minimum");
  config.maximum = number("maximum");
  config.anti_windup = frac::anti_windup_from_string(given["anti_windup"].cast<std::string>());
  config.tracking_time = number("tracking_time");
  config.derivative_filter_time = number("derivative_filter_time");
  config.setpoint_weight = number("setpoint_weight");
  config.derivative_setpoint_weight = number("derivative_setpoint_weight");
  config.discretisation = frac::discretisation_from_string(given["discretisation"].cast<std::string>());
  config.most_swing = number("most_swing");
  return config;
}

Controller controller_of(const py::dict& given) {
  const frac::FractionalPidConfig config = config_of(given);
  const auto design = result_of([&](frac::Progress&) { return frac::FractionalPidDesign(config); });
  return {design, frac::FractionalPid<double>(design)};
}

py::array_t<double> run_samples(Controller& controller, const Reals& setpoint, const Reals& measured) {
  const auto r = span_of(setpoint), y = span_of(measured);
  std::vector<double> output(y.size());
  {
    const py::gil_scoped_release without_lock;
    for (std::size_t i = 0; i < y.size(); ++i) output[i] = controller.pid.step(r[r.size() == 1 ? 0 : i], y[i]);
  }
  return array_of(std::move(output));
}

// What changes from sample to sample, as bytes for a pickle that the same build reads.
using Pid = frac::FractionalPid<double>;
static_assert(std::is_trivially_copyable_v<Pid>);
py::bytes state_of(const Controller& controller) {
  return {reinterpret_cast<const char*>(&controller.pid), sizeof(Pid)};
}
void set_state(Controller& controller, const std::string& bytes) {
  if (bytes.size() != sizeof(Pid)) throw std::invalid_argument("the pickle is of another version of fracfit");
  std::memcpy(&controller.pid, bytes.data(), sizeof(Pid));
}

Complexes response(const Controller& controller, const Reals& omega) {
  Complexes result(omega.size());
  const auto at = span_of(omega);
  for (std::size_t i = 0; i < at.size(); ++i) result.mutable_data()[i] = controller.design.response(at[i]);
  return result;
}

}  // namespace

void add_controller(py::module_& module) {
  py::class_<Controller>(module, "Controller")
      .def(py::init(&controller_of))
      .def("step", [](Controller& c, double setpoint, double measured) { return c.pid.step(setpoint, measured); })
      .def("run", &run_samples)
      .def("track", [](Controller& c, double output) { c.pid.track(output); })
      .def("reset", [](Controller& c) { c.pid.reset(); })
      .def("reset_at", [](Controller& c, double setpoint, double measured) { c.pid.reset(setpoint, measured); })
      .def("response", &response)
      .def("exported", [](const Controller& c, const std::string& form,
                          const py::dict& how) { return exported(c.design, form, how); })
      .def("state", &state_of)
      .def("set_state", &set_state)
      .def("copy", [](const Controller& c) { return c; })
      .def_property_readonly("output", [](const Controller& c) { return c.pid.output(); })
      .def_property_readonly("saturated", [](const Controller& c) { return c.pid.saturated(); })
      .def_property_readonly("bad_input", [](const Controller& c) { return c.pid.bad_input(); })
      .def_property_readonly("note", [](const Controller& c) { return c.design.note(); })
      .def_property_readonly("error", [](const Controller& c) { return c.design.error(); })
      .def_property_readonly("omega_at_error", [](const Controller& c) { return c.design.omega_at_error(); });
}

}  // namespace python
