// SPDX-License-Identifier: BSD-3-Clause
#include "exports.hpp"

#include <optional>
#include <stdexcept>
#include <string>

#include "arrays.hpp"
#include "backlash/fmu.hpp"
#include "frac/circuit.hpp"
#include "frac/digital/digital_filter.hpp"
#include "frac/model/algebra.hpp"
#include "frac/no_ratio.hpp"
#include "frac/state_space.hpp"
#include "frac/structure.hpp"
#include "parts.hpp"
#include "run.hpp"

namespace python {
namespace {

using Transfer = frac::FractionalTransferFunction;
using Band = std::pair<double, double>;

template <class Circuit>
py::dict dict_of_circuit(const Circuit& circuit, const std::string& name) {
  py::dict result;
  result["netlist"] = frac::spice_netlist(circuit, {name, circuit.summary() + "\nWritten by fracfit " FRACFIT_VERSION});
  result["max_relative_error"] = circuit.max_relative_error;
  result["omega_at_maximum"] = circuit.omega_at_maximum;
  result["usable"] = circuit.usable();
  result["message"] = circuit.message;
  return result;
}

// A ratio of sums of powers; a formula with functions too where it is a one-port.
py::dict circuit(const std::string& formula, const std::string& kind, const Band& band, double tolerance,
                 const std::string& name) {
  if (kind != "impedance" && kind != "admittance" && kind != "transfer")
    throw std::invalid_argument("kind \"" + kind + "\": expected one of impedance, admittance, transfer");
  const frac::FrequencyBand on{band.first, band.second};
  const frac::Structure structure(formula);
  std::optional<Transfer> powers;
  try {
    powers = frac::to_transfer_function(structure, {});
  } catch (const frac::NoRatio&) {
    if (kind == "transfer") throw;
  }
  if (kind == "transfer")
    return dict_of_circuit(result_of([&](frac::Progress&) { return frac::transfer_circuit(*powers, on, tolerance); }),
                           name);
  const bool inverse = kind == "admittance";
  const auto made = result_of([&](frac::Progress&) {
    if (powers) {
      const Transfer one({{1, 0}}, {{1, 0}});
      return frac::passive_one_port(inverse ? one / *powers : *powers, on, tolerance);
    }
    return frac::passive_one_port(inverse ? frac::Structure("1/(" + formula + ")") : structure, on, tolerance);
  });
  return dict_of_circuit(made, name);
}

bool is_power(const Transfer& model) {
  return model.numerator().size() == 1 && model.denominator().size() == 1 && model.delay() == 0;
}

// A model that runs as a filter in the samples, in one of the forms.
// @return  the form, and what differs from what was asked
py::tuple filter(const Transfer& model, double sample_time, const std::optional<Band>& band,
                 const std::optional<double>& tolerance, const std::string& form, const py::dict& how) {
  const double kept = tolerance.value_or(band ? 1e-3 : 1e-9);
  std::optional<frac::FrequencyBand> on;
  if (band) on = frac::FrequencyBand{band->first, band->second};
  const auto made = result_of([&](frac::Progress&) {
    return on && is_power(model) ? frac::power_filter(model, *on, frac::Tolerance{kept}, sample_time)
                                 : frac::model_filter(model, on, sample_time, kept);
  });
  return py::make_tuple(exported(made.design, form, how), made.note);
}

// A model in continuous time, on a band.
py::tuple plant(const Transfer& model, const Band& band, double tolerance, const py::dict& how) {
  const auto made = result_of([&](frac::Progress&) {
    return frac::realise(model, {band.first, band.second}, tolerance);
  });
  return py::make_tuple(tuple_of(frac::fmu(made, fmu_options(how))), made.usable() ? "" : made.message);
}

}  // namespace

void add_exports(py::module_& module) {
  module.def("spice", &circuit);
  module.def("export_filter", &filter);
  module.def("export_plant", &plant);
  module.def("export_masses",
             [](double mass1, double mass2, double clearance, double restitution, const py::dict& how) {
               return tuple_of(backlash::fmu({mass1, mass2, clearance, restitution}, {}, fmu_options(how)));
             });
}

}  // namespace python
