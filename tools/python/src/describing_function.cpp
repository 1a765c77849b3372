// SPDX-License-Identifier: BSD-3-Clause
#include "backlash/describing_function.hpp"

#include <algorithm>
#include <array>
#include <optional>
#include <string>

#include "arrays.hpp"
#include "backlash/jump_frequency.hpp"
#include "backlash/regime_map.hpp"
#include "backlash/static_backlash.hpp"
#include "parts.hpp"
#include "run.hpp"

namespace python {
namespace {

using Point = backlash::DescribingFunctionPoint;
using Points = std::vector<const std::vector<Point>*>;

constexpr std::array regimes = {backlash::Regime::rigid,    backlash::Regime::free,    backlash::Regime::symmetric,
                                backlash::Regime::periodic, backlash::Regime::chatter, backlash::Regime::averaged};

// One array per number of a point, over all curves.
py::dict columns_of(const Points& curves, const std::vector<py::ssize_t>& shape) {
  const auto column = [&]<typename T>(T, auto get) {
    py::array_t<T> numbers(shape);
    T* out = numbers.mutable_data();
    for (const auto* curve : curves)
      for (const Point& point : *curve) *out++ = static_cast<T>(get(point));
    return numbers;
  };
  py::dict result;
  result["response"] = column(std::complex<double>(), [](const Point& point) { return point.value; });
  result["regime"] = column(std::int8_t(), [](const Point& point) {
    return std::find(regimes.begin(), regimes.end(), point.regime) - regimes.begin();
  });
  result["period"] = column(std::int32_t(), [](const Point& point) { return point.period; });
  result["impacts_per_period"] = column(double(), [](const Point& point) { return point.impacts_per_period; });
  result["uncertainty"] = column(double(), [](const Point& point) { return point.uncertainty; });
  result["third_harmonic_ratio"] = column(double(), [](const Point& point) { return point.third_harmonic_ratio; });
  result["even_harmonic_ratio"] = column(double(), [](const Point& point) { return point.even_harmonic_ratio; });
  result["energy_defect"] = column(double(), [](const Point& point) { return point.energy_defect; });
  result["lyapunov_exponent"] = column(double(), [](const Point& point) { return point.lyapunov_exponent; });
  result["transient_possible"] = column(bool(), [](const Point& point) { return point.transient_possible; });
  return result;
}

backlash::SweepOptions options_of(const py::dict& given) {
  backlash::SweepOptions options;
  options.protocol = backlash::protocol_from_string(given["protocol"].cast<std::string>());
  options.output = backlash::output_from_string(given["body"].cast<std::string>());
  options.tolerance = given["tolerance"].cast<double>();
  options.mean_tolerance = given["mean_tolerance"].cast<double>();
  options.threads = given["threads"].cast<int>();
  return options;
}

// Scenes given by four lists of one length and the forces.
py::dict sweeps(const Reals& mass1, const Reals& mass2, const Reals& clearance, const Reals& restitution,
                const Reals& force, const Reals& omega, const py::dict& given, const py::object& report) {
  const backlash::SweepOptions options = options_of(given);
  std::vector<backlash::SweepScene> scenes;
  for (py::ssize_t i = 0; i < force.size(); ++i) {
    const auto at = [i](const Reals& array) { return array.data()[i]; };
    scenes.push_back({{at(mass1), at(mass2), at(clearance), at(restitution)}, at(force)});
  }
  const std::vector<double> grid = vector_of(omega);
  const auto found = result_of(
      [&](frac::Progress& progress) { return backlash::describing_function_sweeps(scenes, grid, options, &progress); },
      report);
  Points curves;
  for (const auto& sweep : found) curves.push_back(&sweep.points);
  return columns_of(curves, {force.size(), omega.size()});
}

py::dict map(double mass1, double mass2, double clearance, double force, const Reals& restitution, const Reals& omega,
             const py::dict& given, const py::object& report) {
  const backlash::SweepOptions options = options_of(given);
  const std::vector<double> losses = vector_of(restitution), grid = vector_of(omega);
  const auto found = result_of(
      [&](frac::Progress& progress) {
        return backlash::regime_map({mass1, mass2, clearance, force}, losses, grid, options, &progress);
      },
      report);
  return columns_of({&found.points}, {restitution.size(), omega.size()});
}

}  // namespace

void add_describing_function(py::module_& module) {
  py::list names;
  for (const auto regime : regimes) names.append(std::string(backlash::to_string(regime)));
  module.attr("regimes") = py::tuple(names);
  module.def("describing_functions", &sweeps);
  module.def("regime_map", &map);
  module.def("static_describing_function",
             [](double mass1, double mass2, double clearance, double force, const Reals& omega) {
               return array_of(backlash::static_describing_function(mass1, mass2, clearance, force, vector_of(omega)));
             });
  module.def("jump_frequency", [](double mass1, double mass2, double clearance, double restitution, double force,
                                  const std::string& criterion) {
    const auto chosen = backlash::jump_criterion_from_string(criterion);
    const backlash::TwoMassSystem system(mass1, mass2, clearance, restitution);
    return result_of([&](frac::Progress&) { return backlash::jump_frequency(system, force, chosen); });
  });
}

}  // namespace python
