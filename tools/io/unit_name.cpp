// SPDX-License-Identifier: BSD-3-Clause
#include "io/unit_name.hpp"

#include <utility>

namespace io {
namespace {

// As names of columns spell units, and as people write them; of two that end alike the longer one stands first.
constexpr std::pair<std::string_view, std::string_view> spelled_units[] = {
    {"m_per_n", "m/N"}, {"m_per_N", "m/N"}, {"n_per_m", "N/m"}, {"N_per_m", "N/m"},
    {"m_per_s", "m/s"}, {"rad_s", "rad/s"}, {"m_s", "m/s"},     {"n_s", "N s"},
    {"kg", "kg"},       {"hz", "Hz"},       {"ohm", "ohm"},     {"deg", "deg"},
    {"db", "dB"},       {"n", "N"},         {"m", "m"},         {"s", "s"}};

}  // namespace

NameAndUnit unit_apart(std::string_view column) {
  for (const auto& [spelled, written] : spelled_units) {
    if (!column.ends_with(spelled) || column.size() < spelled.size() + 2) continue;
    const std::string_view name = column.substr(0, column.size() - spelled.size());
    if (name.ends_with('_')) return {name.substr(0, name.size() - 1), written};
  }
  return {column, {}};
}

std::string written_unit(const std::string& unit) {
  for (const auto& [spelled, written] : spelled_units)
    if (unit == spelled) return std::string(written);
  return unit;
}

std::string inverse_unit(const std::string& unit) {
  if (unit.empty()) return unit;
  for (const std::string_view per : {std::string_view("_per_"), std::string_view("/")}) {
    const auto at = unit.find(per);
    if (at == std::string::npos || unit.find(per, at + per.size()) != std::string::npos) continue;
    const std::string above = unit.substr(0, at), below = unit.substr(at + per.size());
    return above == "1" ? below : below + std::string(per) + above;
  }
  return "1/" + unit;
}

}  // namespace io
