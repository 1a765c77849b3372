// SPDX-License-Identifier: BSD-3-Clause
#include <glog/logging.h>

#include "parts.hpp"

PYBIND11_MODULE(_fitting, module) {
  module.doc() = "Compiled part of fracfit that fits; needs Ceres and NLopt.";
  pybind11::module_::import("fracfit._core");  // has the classes
  // What the solver would print of steps that fail stands in the results.
  FLAGS_minloglevel = google::GLOG_FATAL;
  module.attr("described") = pybind11::dict();
  python::add_economy(module);
  python::add_fit(module);
  python::add_identify(module);
  python::add_tune(module);
  python::add_scene(module);
  python::add_validity(module);
  python::add_joint_fit(module);
  python::add_jump_law(module);
}
