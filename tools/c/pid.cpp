// SPDX-License-Identifier: BSD-3-Clause
#include <string_view>
#include <utility>

#include "frac/digital/fractional_pid.hpp"
#include "guarded.hpp"

using namespace c_interface;

struct fracfit_pid_settings {
  frac::FractionalPidConfig config;
  double tolerance = 1e-3;
};

struct fracfit_pid {
  frac::FractionalPidDesign design;
  frac::FractionalPid<double> controller;
};

fracfit_pid_settings* fracfit_pid_settings_create(void) {
  return handle_of<fracfit_pid_settings>([] { return new fracfit_pid_settings; });
}
void fracfit_pid_settings_destroy(fracfit_pid_settings* settings) {
  delete settings;
}

int fracfit_pid_settings_set(fracfit_pid_settings* settings, const char* name, double value) {
  return status_of([&] {
    auto& [config, tolerance] = given(settings, "settings");
    const std::pair<std::string_view, double*> places[] = {
        {"kp", &config.gains.kp},
        {"ki", &config.gains.ki},
        {"kd", &config.gains.kd},
        {"lambda", &config.gains.lambda},
        {"mu", &config.gains.mu},
        {"sample_time", &config.sample_time},
        {"band_lower", &config.band.lower},
        {"band_upper", &config.band.upper},
        {"tolerance", &tolerance},
        {"minimum", &config.minimum},
        {"maximum", &config.maximum},
        {"tracking_time", &config.tracking_time},
        {"derivative_filter_time", &config.derivative_filter_time},
        {"setpoint_weight", &config.setpoint_weight},
        {"derivative_setpoint_weight", &config.derivative_setpoint_weight}};
    const std::string_view wanted = text(name, "name");
    std::string known;
    for (const auto& [each, place] : places) {
      if (each == wanted) {
        *place = value;
        return FRACFIT_OK;
      }
      known += (known.empty() ? "" : ", ") + std::string(each);
    }
    throw std::invalid_argument("there is no number \"" + std::string(wanted) + "\" of a PID; there are " + known);
  });
}

int fracfit_pid_settings_choose(fracfit_pid_settings* settings, const char* name, const char* word) {
  return status_of([&] {
    frac::FractionalPidConfig& config = given(settings, "settings").config;
    const std::string_view what = text(name, "name"), how = text(word, "word");
    if (what == "anti_windup")
      config.anti_windup = frac::anti_windup_from_string(how);
    else if (what == "discretisation")
      config.discretisation = frac::discretisation_from_string(how);
    else
      throw std::invalid_argument("there is no choice \"" + std::string(what) +
                                  "\" of a PID; there are anti_windup and discretisation");
    return FRACFIT_OK;
  });
}

fracfit_pid* fracfit_pid_create(const fracfit_pid_settings* settings) {
  return handle_of<fracfit_pid>([&] {
    frac::FractionalPidConfig config = given(settings, "settings").config;
    config.goal = frac::Tolerance{settings->tolerance};
    const frac::FractionalPidDesign design(config);
    return new fracfit_pid{design, frac::FractionalPid<double>(design)};
  });
}
void fracfit_pid_destroy(fracfit_pid* pid) {
  delete pid;
}

const char* fracfit_pid_note(const fracfit_pid* pid) {
  return pid ? pid->design.note().c_str() : "";
}
double fracfit_pid_error(const fracfit_pid* pid) {
  return number_of(pid, "pid", [](const auto& each) { return each.design.error(); });
}
double fracfit_pid_step(fracfit_pid* pid, double setpoint, double measured) {
  return pid ? pid->controller.step(setpoint, measured) : std::numeric_limits<double>::quiet_NaN();
}
void fracfit_pid_track(fracfit_pid* pid, double output) {
  if (pid) pid->controller.track(output);
}
void fracfit_pid_reset(fracfit_pid* pid, double setpoint, double measured) {
  if (pid) pid->controller.reset(setpoint, measured);
}
int fracfit_pid_saturated(const fracfit_pid* pid) {
  return pid && pid->controller.saturated() ? 1 : 0;
}
int fracfit_pid_refused(const fracfit_pid* pid) {
  return pid && pid->controller.bad_input() ? 1 : 0;
}
