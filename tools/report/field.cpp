// SPDX-License-Identifier: BSD-3-Clause
#include "report/field.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include "io/unit_name.hpp"

namespace report {

namespace {

constexpr std::array<std::string_view, 9> names{
    "auto",         "impedance",         "admittance", "shear-modulus", "tensile-modulus",
    "permittivity", "transfer-function", "n",          "minus-inverse"};
constexpr std::array all{Field::automatic,       Field::impedance,    Field::admittance,        Field::shear_modulus,
                         Field::tensile_modulus, Field::permittivity, Field::transfer_function, Field::n,
                         Field::minus_inverse};

// A unit and its prefix apart; both empty where the unit is none of those known.
struct Unit {
  std::string base, prefix;
};

constexpr std::string_view prefixes[] = {"", "n", "u", "µ", "m", "k", "M", "G"};

Unit taken_apart(const std::string& unit) {
  static constexpr std::pair<std::string_view, std::string_view> bases[] = {
      {"ohm", "Ω"},
      {"ohms", "Ω"},
      {"Ohm", "Ω"},
      {"Ohms", "Ω"},
      {"\xCE\xA9", "Ω"},      // the letter
      {"\xE2\x84\xA6", "Ω"},  // the sign of the unit
      {"S", "S"},
      {"siemens", "S"},
      {"Pa", "Pa"},
      {"pa", "Pa"}};
  for (const std::string_view prefix : prefixes) {
    if (!unit.starts_with(prefix)) continue;
    const std::string_view rest = std::string_view(unit).substr(prefix.size());
    for (const auto& [written, base] : bases) {
      if (rest == written) return {std::string(base), std::string(prefix == "u" ? "µ" : prefix)};
    }
  }
  return {};
}

}  // namespace

std::string_view to_string(Field field) {
  return names.at(static_cast<std::size_t>(field));
}

std::span<const Field> fields() {
  return all;
}

std::optional<backlash::Quantity> quantity_of(Field field) {
  if (field == Field::n) return backlash::Quantity::n;
  if (field == Field::minus_inverse) return backlash::Quantity::minus_inverse;
  return std::nullopt;
}

Field field_of(const io::FrequencyResponseFile& file) {
  if (io::find_value(file.metadata, io::quantity_key) == to_string(backlash::Quantity::minus_inverse))
    return Field::minus_inverse;
  static constexpr std::pair<std::string_view, Field> symbols[] = {{"z", Field::impedance},
                                                                   {"y", Field::admittance},
                                                                   {"g", Field::shear_modulus},
                                                                   {"e", Field::tensile_modulus},
                                                                   {"eps", Field::permittivity}};
  for (const auto& [symbol, field] : symbols) {
    if (file.symbol == symbol) return field;
  }
  const std::string base = taken_apart(file.value_unit).base;
  if (base == "Ω") return Field::impedance;
  if (base == "S") return Field::admittance;
  if (base == "Pa") return Field::shear_modulus;
  return Field::transfer_function;
}

Notation notation_of(Field field, const std::string& unit, frac::FrequencyUnit axis) {
  const Unit apart = taken_apart(unit);
  const std::string shown = apart.base.empty() ? io::written_unit(unit) : apart.prefix + apart.base;
  constexpr auto hertz = frac::FrequencyUnit::hertz;
  switch (field) {
    case Field::impedance:
      return {"Z", "Z′", "−Z″", -1, shown, hertz};
    case Field::admittance:
      return {"Y", "Y′", "Y″", 1, shown, hertz};
    case Field::shear_modulus:
      return {"G", "G′", "G″", 1, shown, axis};
    case Field::tensile_modulus:
      return {"E", "E′", "E″", 1, shown, axis};
    case Field::permittivity:
      return {"ε", "ε′", "ε″", -1, shown, hertz};
    case Field::n:
      return {"N", "Re N", "Im N", 1, shown, axis};
    case Field::minus_inverse:
      return {"−1/N", "Re(−1/N)", "Im(−1/N)", 1, shown, axis};
    case Field::automatic:
    case Field::transfer_function:
      break;
  }
  return {"H", "Re", "Im", 1, shown, axis};
}

std::string Notation::axis_name() const {
  return axis == frac::FrequencyUnit::hertz ? "f_hz" : "omega_rad_s";
}
std::string Notation::axis_label() const {
  return axis == frac::FrequencyUnit::hertz ? "f in Hz" : "ω in rad/s";
}

std::string with_unit(const std::string& quantity, const std::string& unit) {
  return unit.empty() || unit == "1" ? quantity : quantity + " in " + unit;
}

std::vector<double> axis_values(const Notation& notation, const std::vector<double>& omega) {
  std::vector<double> axis(omega.size());
  std::transform(omega.begin(), omega.end(), axis.begin(), [&](double each) { return in_unit(each, notation.axis); });
  return axis;
}

}  // namespace report
