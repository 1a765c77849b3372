// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <cstddef>
#include <stdexcept>
#include <string>
#include <utility>

#include "frac/realisation.hpp"

namespace python {

/// A realisation as Python names it: "name", and what that takes of "band" (rad/s), "poles", "sample_time" (s) and
/// "memory".
/// @throws std::invalid_argument  another name, or something missing.
[[nodiscard]] inline frac::Realisation realisation_of(const pybind11::dict& choice) {
  const auto has = [&](const char* key) { return choice.contains(key) && !choice[key].is_none(); };
  const auto name = choice["name"].cast<std::string>();
  const auto make = [&]() -> frac::Realisation {
    if (name == "exact") return frac::ExactRealisation{};
    if (name == "grunwald-letnikov") {
      if (!has("sample_time")) throw std::invalid_argument("realisation grunwald-letnikov needs sample_time");
      return frac::GrunwaldLetnikovRealisation{choice["sample_time"].cast<double>(),
                                               has("memory") ? choice["memory"].cast<std::size_t>() : 0};
    }
    if (name != "oustaloup" && name != "ladder")
      throw std::invalid_argument("realisation is '" + name +
                                  "'; expected exact, oustaloup, ladder or grunwald-letnikov");
    if (!has("band") || !has("poles")) throw std::invalid_argument("realisation " + name + " needs band and poles");
    const auto [lower, upper] = choice["band"].cast<std::pair<double, double>>();
    const auto poles = choice["poles"].cast<int>();
    if (name == "ladder") return frac::LadderRealisation({lower, upper}, poles);
    return frac::OustaloupRealisation{{lower, upper}, poles};
  };
  frac::Realisation realisation = make();
  frac::validate(realisation);
  return realisation;
}

}  // namespace python
