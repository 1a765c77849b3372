// SPDX-License-Identifier: BSD-3-Clause
#include "output/sweep_json.hpp"

#include "output/json.hpp"

namespace fracfit {
namespace {

void append_sweep(Json& json, const backlash::DescribingFunctionSweep& sweep) {
  json["scene"] = object_of(io::scene_of(sweep));
  Json& points = json["points"] = Json::array();
  for (const auto& point : sweep.points)
    points.push_back({{"omega_rad_s", point.omega},
                      {"re_m_per_n", point.value.real()},
                      {"im_m_per_n", point.value.imag()},
                      {"regime", backlash::to_string(point.regime)},
                      {"period", point.period},
                      {"impacts_per_period", point.impacts_per_period},
                      {"uncertainty_m_per_n", point.uncertainty},
                      {"third_harmonic_ratio", point.third_harmonic_ratio},
                      {"even_harmonic_ratio", point.even_harmonic_ratio},
                      {"energy_defect", point.energy_defect},
                      {"lyapunov_exponent", point.lyapunov_exponent},
                      {"periods_followed", point.periods_followed},
                      {"transient_possible", point.transient_possible},
                      {"force_sensitivity", point.force_sensitivity}});
}

}  // namespace

std::string sweep_json(const backlash::DescribingFunctionSweep& sweep, const std::string& command) {
  Json json = origin(command);
  append_sweep(json, sweep);
  return json.dump() + "\n";
}

std::string sweeps_json(const std::vector<backlash::DescribingFunctionSweep>& sweeps, const std::string& command) {
  Json json = origin(command);
  json["sweeps"] = Json::array();
  for (const auto& sweep : sweeps) append_sweep(json["sweeps"].push_back(Json::object()), sweep);
  return json.dump() + "\n";
}

std::string static_curve_json(const io::StaticCurve& curve, const std::string& command) {
  Json json = origin(command);
  json["scene"] = object_of(io::scene_of(curve));
  Json& points = json["points"] = Json::array();
  for (std::size_t i = 0; i < curve.omega.size(); ++i)
    points.push_back({{"omega_rad_s", curve.omega[i]},
                      {"re_m_per_n", curve.value[i].real()},
                      {"im_m_per_n", curve.value[i].imag()},
                      {"regime", "static"}});
  return json.dump() + "\n";
}

}  // namespace fracfit
