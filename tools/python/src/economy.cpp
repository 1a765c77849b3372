// SPDX-License-Identifier: BSD-3-Clause
#include "frac/identification/economy.hpp"

#include <string>
#include <vector>

#include "arrays.hpp"
#include "described.hpp"
#include "fit_request.hpp"
#include "frac/identification/describe.hpp"
#include "parts.hpp"
#include "run.hpp"

namespace python {
namespace {

// Named as in the JSON of the command line.
py::dict economy(const py::dict& data, const py::dict& curves, const std::string& component, std::size_t most,
                 int largest_power, int threads) {
  const frac::FrequencyResponseData points = spectrum_of(data);
  const std::vector<frac::FixedCurve> given = fixed_curves(curves, points.size());
  const frac::EconomyOptions options{frac::component_from_string(component), most, largest_power};
  return dict_of(result_of([&](frac::Progress&) { return frac::economy(points, given, options, threads); }));
}

}  // namespace

void add_economy(py::module_& module) {
  module.attr("described")["Economy"] = attributes_of<frac::Economy>();
  module.def("economy", &economy);
}

}  // namespace python
