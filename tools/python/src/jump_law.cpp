// SPDX-License-Identifier: BSD-3-Clause
#include "backlash/identification/jump_law.hpp"

#include <string>
#include <vector>

#include "arrays.hpp"
#include "backlash/compliant/compliant_jump.hpp"
#include "backlash/identification/describe.hpp"
#include "described.hpp"
#include "frac/identification/describe.hpp"
#include "parts.hpp"
#include "run.hpp"

namespace python {
namespace {

py::dict dict_of_law(const backlash::JumpLaw& found) {
  py::dict dict = dict_of(found);
  dict["usable"] = found.usable();
  dict["summary"] = found.summary();
  return dict;
}

py::dict law(double mass1, double mass2, const Reals& force, const Reals& clearance, const Reals& restitution,
             const std::string& criterion, int threads, const py::object& report) {
  const auto chosen = backlash::jump_criterion_from_string(criterion);
  const auto forces = vector_of(force), clearances = vector_of(clearance), restitutions = vector_of(restitution);
  const auto found = result_of(
      [&](frac::Progress& progress) {
        return backlash::fit_jump_law(mass1, mass2, forces, clearances, restitutions, chosen, threads, &progress);
      },
      report);
  return dict_of_law(found);
}

// Of contacts that take time, given by two lists of one length.
py::dict contact_law(double mass1, double mass2, const Reals& force, const Reals& clearance, const Reals& stiffness,
                     const Reals& damping, const std::string& criterion, double friction1, double friction2,
                     int threads, const py::object& report) {
  const auto chosen = backlash::jump_criterion_from_string(criterion);
  const auto forces = vector_of(force), clearances = vector_of(clearance);
  std::vector<backlash::CompliantContact> contacts;
  for (py::ssize_t i = 0; i < stiffness.size(); ++i) contacts.emplace_back(stiffness.data()[i], damping.data()[i]);
  const auto found = result_of(
      [&](frac::Progress& progress) {
        return backlash::fit_contact_jump_law(mass1, mass2, forces, clearances, contacts, chosen, threads, &progress,
                                              {friction1, friction2});
      },
      report);
  return dict_of_law(found);
}

// The constants over restitution, instead of the laws.
py::list constants(double mass1, double mass2, const Reals& force, const Reals& clearance, const Reals& restitution,
                   const std::string& criterion, int threads, const py::object& report) {
  const auto chosen = backlash::jump_criterion_from_string(criterion);
  const auto forces = vector_of(force), clearances = vector_of(clearance), restitutions = vector_of(restitution);
  const auto found = result_of(
      [&](frac::Progress& progress) {
        return backlash::jump_grid(mass1, mass2, forces, clearances, restitutions, chosen, threads, &progress);
      },
      report);
  return object_of(found.constants).cast<py::list>();
}

// Of contacts that take time: stiffness_group, similarity_constant, exponents and message of each force, clearance and
// contact, the first slowest.
py::list contact_constants(double mass1, double mass2, const Reals& force, const Reals& clearance,
                           const Reals& stiffness, const Reals& damping, const std::string& criterion, double friction1,
                           double friction2) {
  const auto chosen = backlash::jump_criterion_from_string(criterion);
  const auto forces = vector_of(force), clearances = vector_of(clearance);
  std::vector<backlash::CompliantContact> contacts;
  for (py::ssize_t i = 0; i < stiffness.size(); ++i) contacts.emplace_back(stiffness.data()[i], damping.data()[i]);
  py::list rows;
  for (const double gap : clearances) {
    for (const double amplitude : forces) {
      for (const auto& contact : contacts) {
        const auto jump = result_of([&](frac::Progress&) {
          return backlash::compliant_jump(
              {backlash::free_mass(mass1), backlash::free_mass(mass2), gap, contact, {friction1, friction2}}, amplitude,
              chosen);
        });
        rows.append(
            py::dict(py::arg("force") = amplitude, py::arg("clearance") = gap,
                     py::arg("contact_stiffness") = contact.stiffness(), py::arg("contact_damping") = contact.damping(),
                     py::arg("stiffness_group") = jump.stiffness_group,
                     py::arg("similarity_constant") = jump.similarity_constant, py::arg("exponent") = jump.exponent,
                     py::arg("clearance_exponent") = jump.clearance_exponent, py::arg("message") = jump.message));
      }
    }
  }
  return rows;
}

}  // namespace

void add_jump_law(py::module_& module) {
  module.attr("described")["JumpLaw"] = attributes_of<backlash::JumpLaw>();
  module.def("jump_law", &law);
  module.def("contact_jump_law", &contact_law);
  module.def("jump_constants", &constants);
  module.def("contact_jump_constants", &contact_constants);
}

}  // namespace python
