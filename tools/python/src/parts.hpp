// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pybind11/pybind11.h>

namespace python {

// Parts of the core module, one file each.
void add_model(pybind11::module_& module);
void add_time_response(pybind11::module_& module);
void add_realisation(pybind11::module_& module);
void add_special(pybind11::module_& module);
void add_controller(pybind11::module_& module);
void add_describing_function(pybind11::module_& module);
void add_orbits(pybind11::module_& module);
void add_loops(pybind11::module_& module);
void add_motions(pybind11::module_& module);
void add_records(pybind11::module_& module);
void add_exports(pybind11::module_& module);

// Parts of the fitting module.
void add_economy(pybind11::module_& module);
void add_fit(pybind11::module_& module);
void add_identify(pybind11::module_& module);
void add_tune(pybind11::module_& module);
void add_scene(pybind11::module_& module);
void add_validity(pybind11::module_& module);
void add_joint_fit(pybind11::module_& module);
void add_jump_law(pybind11::module_& module);

}  // namespace python
