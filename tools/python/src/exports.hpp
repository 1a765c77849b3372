// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "frac/digital/arduino_library.hpp"
#include "frac/digital/c_header.hpp"
#include "frac/digital/fixed_point.hpp"
#include "frac/fmu.hpp"

namespace python {

[[nodiscard]] inline pybind11::list list_of(const std::vector<frac::NamedText>& files) {
  pybind11::list list;
  for (const auto& file : files) list.append(pybind11::make_tuple(file.path, file.text));
  return list;
}

[[nodiscard]] inline pybind11::tuple tuple_of(const frac::Fmu& unit) {
  return pybind11::make_tuple(list_of(unit.files), unit.main_source, unit.linux_library, unit.windows_library);
}

/// @param how  keys name, precision, comment, and fmi, the version
[[nodiscard]] inline frac::FmuOptions fmu_options(const pybind11::dict& how) {
  return {how["name"].cast<std::string>(), frac::precision_from_string(how["precision"].cast<std::string>()),
          how["comment"].cast<std::string>(), "fracfit " FRACFIT_VERSION,
          frac::fmi_version_from_string(how["fmi"].cast<std::string>())};
}

/// A recursion in the samples, a PID or a filter, in the form "c99" (a text), "arduino" (paths and texts) or "fmu"
/// (paths and texts, the path that is compiled, and those of the libraries for Linux and Windows).
/// @param how  besides: fixed_point, the ranges of input and output, or None
template <class Design>
[[nodiscard]] pybind11::object exported(const Design& design, const std::string& form, const pybind11::dict& how) {
  if (form == "fmu") return tuple_of(frac::fmu(design, fmu_options(how)));
  const frac::CHeaderOptions options{how["name"].cast<std::string>(),
                                     frac::precision_from_string(how["precision"].cast<std::string>()),
                                     how["comment"].cast<std::string>()};
  if (form == "arduino") return list_of(frac::arduino_library(design, options));
  if (how["fixed_point"].is_none()) return pybind11::str(frac::c_header(design, options));
  const auto [input, output] = how["fixed_point"].cast<std::pair<double, double>>();
  return pybind11::str(frac::fixed_point_header(design, {input, output}, options).text);
}

}  // namespace python
