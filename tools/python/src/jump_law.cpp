// SPDX-License-Identifier: BSD-3-Clause
#include "backlash/identification/jump_law.hpp"

#include <string>

#include "arrays.hpp"
#include "backlash/identification/describe.hpp"
#include "described.hpp"
#include "frac/identification/describe.hpp"
#include "parts.hpp"
#include "run.hpp"

namespace python {
namespace {

py::dict law(double mass1, double mass2, const Reals& force, const Reals& clearance, const Reals& restitution,
             const std::string& criterion, int threads, const py::object& report) {
  const auto chosen = backlash::jump_criterion_from_string(criterion);
  const auto forces = vector_of(force), clearances = vector_of(clearance), restitutions = vector_of(restitution);
  const auto found = result_of(
      [&](frac::Progress& progress) {
        return backlash::fit_jump_law(mass1, mass2, forces, clearances, restitutions, chosen, threads, &progress);
      },
      report);
  py::dict dict = dict_of(found);
  dict["usable"] = found.usable();
  dict["summary"] = found.summary();
  return dict;
}

}  // namespace

void add_jump_law(py::module_& module) {
  module.attr("described")["JumpLaw"] = attributes_of<backlash::JumpLaw>();
  module.def("jump_law", &law);
}

}  // namespace python
