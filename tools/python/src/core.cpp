// SPDX-License-Identifier: BSD-3-Clause
#include "parts.hpp"

PYBIND11_MODULE(_core, module) {
  module.doc() = "Compiled part of fracfit that needs no solver: numbers in, numbers out.";
  module.attr("version") = FRACFIT_VERSION;
  python::add_model(module);
  python::add_time_response(module);
  python::add_realisation(module);
  python::add_special(module);
  python::add_controller(module);
  python::add_describing_function(module);
  python::add_orbits(module);
  python::add_loops(module);
  python::add_motions(module);
  python::add_records(module);
  python::add_exports(module);
}
