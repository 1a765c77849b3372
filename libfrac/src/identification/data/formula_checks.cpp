// SPDX-License-Identifier: BSD-3-Clause
#include "formula_checks.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <stdexcept>
#include <string>
#include <string_view>

namespace frac::detail {
namespace {

constexpr std::array<std::string_view, 2> imaginary_units{"j", "i"};
constexpr std::array<std::string_view, 5> frequencies{"w", "omega", "jw", "iw", "jomega"};
constexpr std::array<std::string_view, 4> other_variables{"p", "S", "x", "z"};

template <std::size_t count>
std::string named_of(const Structure& structure, const std::array<std::string_view, count>& names) {
  for (const std::string& name : structure.parameter_names()) {
    if (std::find(names.begin(), names.end(), name) != names.end()) return name;
  }
  return {};
}

[[noreturn]] void refuse(const Structure& structure, const std::string& why) {
  throw std::invalid_argument("formula \"" + structure.formula() + "\": " + why);
}

}  // namespace

void require_function_of_s(const Structure& structure) {
  const std::string unit = named_of(structure, imaginary_units), frequency = named_of(structure, frequencies);
  if (!frequency.empty() && (!unit.empty() || frequency.front() == 'j' || frequency.front() == 'i')) {
    refuse(structure, (unit.empty() ? "" : "'" + unit + "' and ") + std::string("'") + frequency +
                          "' would be parameters; for j omega write s, as in K/(1 + (T s)^a)");
  }
  if (structure.depends_on_s()) return;
  for (const std::string& name : {unit, frequency, named_of(structure, other_variables)}) {
    if (name.empty()) continue;
    refuse(structure, "there is no s in it, and '" + name + "' would be a parameter; the variable is s");
  }
  const auto& roles = structure.parameter_roles();
  if (std::find(roles.begin(), roles.end(), ParameterRole::order) != roles.end()) {
    refuse(structure, "there is no s in it, so that it is a constant, and an order has no meaning; the variable is s");
  }
  const std::size_t count = structure.parameter_names().size();
  // A sum of resistances is meant; a product of two names is mostly that of a preset, misspelt.
  if (count > 1 && structure.formula().find('+') == std::string::npos) {
    refuse(structure, "there is no s in it, so that its " + std::to_string(count) +
                          " parameters make one constant, which does not tell them apart; the variable is s");
  }
}

}  // namespace frac::detail
