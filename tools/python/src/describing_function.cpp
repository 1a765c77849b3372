// SPDX-License-Identifier: BSD-3-Clause
#include "backlash/describing_function.hpp"

#include <algorithm>
#include <array>
#include <complex>
#include <limits>
#include <optional>
#include <string>
#include <utility>

#include "arrays.hpp"
#include "backlash/compliant/compliant_bodies.hpp"
#include "backlash/jump_frequency.hpp"
#include "backlash/loops/forced_bodies.hpp"
#include "backlash/loss_factor.hpp"
#include "backlash/minus_inverse.hpp"
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

// One array per number of a point, over all curves, in one pass through the points.
py::dict columns_of(const Points& curves, const std::vector<py::ssize_t>& shape) {
  py::dict result;
  const auto column = [&]<typename T>(const char* name, T) {
    py::array_t<T> numbers(shape);
    result[name] = numbers;
    return numbers.mutable_data();
  };
  auto* value = column("response", std::complex<double>());
  auto* regime = column("regime", std::int8_t());
  auto* period = column("period", std::int32_t());
  auto* impacts = column("impacts_per_period", double());
  auto* uncertainty = column("uncertainty", double());
  auto* third = column("third_harmonic_ratio", double());
  auto* even = column("even_harmonic_ratio", double());
  auto* defect = column("energy_defect", double());
  auto* lyapunov = column("lyapunov_exponent", double());
  auto* transient = column("transient_possible", bool());
  for (const auto* curve : curves) {
    for (const Point& point : *curve) {
      *value++ = point.value;
      *regime++ = static_cast<std::int8_t>(std::find(regimes.begin(), regimes.end(), point.regime) - regimes.begin());
      *period++ = point.period;
      *impacts++ = point.impacts_per_period;
      *uncertainty++ = point.uncertainty;
      *third++ = point.third_harmonic_ratio;
      *even++ = point.even_harmonic_ratio;
      *defect++ = point.energy_defect;
      *lyapunov++ = point.lyapunov_exponent;
      *transient++ = point.transient_possible;
    }
  }
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

using Receptance = std::optional<frac::FractionalTransferFunction>;

// Bodies with receptances, free masses where there is none, given by lists of one length.
py::dict bodies_sweeps(const std::vector<Reals>& scene, const Receptance& load, const Receptance& drive,
                       const Reals& omega, const py::dict& given) {
  enum : std::size_t { mass1, mass2, clearance, restitution, force };
  const backlash::SweepOptions options = options_of(given);
  const std::vector<double> grid = vector_of(omega);
  std::vector<backlash::DescribingFunctionSweep> found;
  for (py::ssize_t i = 0; i < scene.at(force).size(); ++i) {
    const auto at = [&](std::size_t which) { return scene.at(which).data()[i]; };
    const backlash::LinearBodies bodies(load ? *load : backlash::free_mass(at(mass1)),
                                        drive ? *drive : backlash::free_mass(at(mass2)), at(clearance),
                                        at(restitution));
    const double amplitude = at(force);
    found.push_back(result_of(
        [&](frac::Progress&) { return backlash::bodies_describing_function(bodies, amplitude, grid, options); }));
  }
  Points curves;
  for (const auto& sweep : found) curves.push_back(&sweep.points);
  return columns_of(curves, {scene.at(force).size(), omega.size()});
}

// Scenes whose contacts take time, given by lists of one length.
py::dict compliant_sweeps(const std::vector<Reals>& scene, const Receptance& load, const Receptance& drive,
                          const Reals& omega, const py::dict& given, const py::object& report) {
  enum : std::size_t { mass1, mass2, clearance, stiffness, damping, friction1, friction2, force };
  const backlash::SweepOptions options = options_of(given);
  std::vector<backlash::CompliantScene> scenes;
  for (py::ssize_t i = 0; i < scene.at(force).size(); ++i) {
    const auto at = [&](std::size_t which) { return scene.at(which).data()[i]; };
    const backlash::CompliantContact contact(at(stiffness), at(damping));
    scenes.push_back({{load ? *load : backlash::free_mass(at(mass1)),
                       drive ? *drive : backlash::free_mass(at(mass2)),
                       at(clearance),
                       contact,
                       {at(friction1), at(friction2)}},
                      at(force)});
  }
  const std::vector<double> grid = vector_of(omega);
  const auto found = result_of(
      [&](frac::Progress& progress) { return backlash::bodies_describing_functions(scenes, grid, options, &progress); },
      report);
  Points curves;
  for (const auto& sweep : found) curves.push_back(&sweep.points);
  return columns_of(curves, {scene.at(force).size(), omega.size()});
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

// nan where there is none.
py::tuple minus_inverse(const Complexes& response, const Reals& uncertainty) {
  py::array_t<std::complex<double>> values(response.size());
  py::array_t<double> spread(response.size());
  constexpr double none = std::numeric_limits<double>::quiet_NaN();
  for (py::ssize_t i = 0; i < response.size(); ++i) {
    const auto inverse = backlash::minus_inverse(response.data()[i], uncertainty.data()[i]);
    values.mutable_data()[i] = inverse ? inverse->value : std::complex<double>(none, none);
    spread.mutable_data()[i] = inverse ? inverse->uncertainty : none;
  }
  return py::make_tuple(values, spread);
}

}  // namespace

void add_describing_function(py::module_& module) {
  py::list names;
  for (const auto regime : regimes) names.append(std::string(backlash::to_string(regime)));
  module.attr("regimes") = py::tuple(names);
  module.def("describing_functions", &sweeps);
  module.def("bodies_describing_functions", &bodies_sweeps);
  module.def("compliant_describing_functions", &compliant_sweeps);
  module.def("free_contact", [](double stiffness, double damping, double mass1, double mass2) {
    const auto free = backlash::free_contact(backlash::CompliantContact(stiffness, damping), mass1, mass2);
    py::dict result;
    result["frequency"] = free.frequency;
    result["damping_ratio"] = free.damping_ratio;
    result["restitution"] = free.restitution;
    result["duration"] = free.duration;
    return result;
  });
  module.def("damping_ratio_of_restitution", &backlash::damping_ratio_of_restitution);
  module.def("regime_map", &map);
  module.def("minus_inverse", &minus_inverse);
  module.def("symmetric_loss_factor", &backlash::symmetric_loss_factor);
  module.def("restitution_from_loss_factor", &backlash::restitution_from_loss_factor);
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
