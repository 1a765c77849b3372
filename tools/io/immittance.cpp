// SPDX-License-Identifier: BSD-3-Clause
#include "io/immittance.hpp"

#include <array>
#include <utility>

#include "io/unit_name.hpp"

namespace io {
namespace {

constexpr std::array all_immittances{Immittance::impedance, Immittance::admittance};
constexpr std::array<std::string_view, 2> immittance_names{"impedance", "admittance"};

// Each prefix beside that of the inverse.
constexpr std::pair<std::string_view, std::string_view> inverse_prefixes[] = {
    {"", ""}, {"n", "G"}, {"u", "M"}, {"µ", "M"}, {"m", "k"}, {"k", "m"}, {"M", "u"}, {"G", "n"}};

constexpr std::string_view ohms[] = {"ohm", "ohms", "Ohm", "Ohms", "\xCE\xA9", "\xE2\x84\xA6"};
constexpr std::string_view siemens[] = {"S", "siemens", "Siemens"};

struct SimpleUnit {
  Immittance of;
  std::string_view inverse_prefix;
};

// "kohm", "S".
std::optional<SimpleUnit> simple_unit(std::string_view unit) {
  for (const auto& [prefix, inverse] : inverse_prefixes) {
    if (!unit.starts_with(prefix)) continue;
    const std::string_view base = unit.substr(prefix.size());
    for (const auto name : ohms)
      if (base == name) return SimpleUnit{Immittance::impedance, inverse};
    for (const auto name : siemens)
      if (base == name) return SimpleUnit{Immittance::admittance, inverse};
  }
  return std::nullopt;
}

Immittance other(Immittance of) {
  return of == Immittance::impedance ? Immittance::admittance : Immittance::impedance;
}

}  // namespace

std::string_view to_string(Immittance immittance) {
  return immittance_names.at(static_cast<std::size_t>(immittance));
}

std::optional<Immittance> immittance_from_string(std::string_view text) {
  for (const auto each : all_immittances)
    if (to_string(each) == text) return each;
  return std::nullopt;
}

std::span<const Immittance> immittances() {
  return all_immittances;
}

std::optional<Immittance> immittance_of_unit(const std::string& unit) {
  const std::string written = written_unit(unit);
  std::string_view rest(written);
  bool inverse = false;
  if (rest.starts_with("1/")) {
    inverse = true;
    rest.remove_prefix(2);
    if (rest.starts_with('(')) rest.remove_prefix(1);
  }
  // What follows the first factor is an area or a length.
  std::string_view first = rest.substr(0, rest.find_first_of(" ./*)"));
  first = first.substr(0, first.find("·"));
  for (const std::string_view power : {"^-1", "-1", "⁻¹"}) {
    if (!first.ends_with(power)) continue;
    inverse = !inverse;
    first.remove_suffix(power.size());
    break;
  }
  const auto found = simple_unit(first);
  if (!found) return std::nullopt;
  return inverse ? other(found->of) : found->of;
}

std::string inverse_immittance_unit(const std::string& unit) {
  const std::string written = written_unit(unit);
  if (const auto simple = simple_unit(written))
    return std::string(simple->inverse_prefix) + (simple->of == Immittance::impedance ? "S" : "ohm");
  if (written.find_first_of(" .*") == std::string::npos) return inverse_unit(written);
  if (written.starts_with("1/(") && written.ends_with(')')) return written.substr(3, written.size() - 4);
  return "1/(" + written + ")";
}

}  // namespace io
