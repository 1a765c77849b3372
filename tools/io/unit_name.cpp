// SPDX-License-Identifier: BSD-3-Clause
#include "io/unit_name.hpp"

#include <utility>

namespace io {
namespace {

// As names of columns spell units, and as people write them; of two that end alike the longer one stands first.
constexpr std::pair<std::string_view, std::string_view> spelled_units[] = {
    {"m_per_n", "m/N"}, {"m_per_N", "m/N"}, {"m_per_s", "m/s"}, {"rad_s", "rad/s"}, {"m_s", "m/s"},
    {"n_s", "N s"},     {"kg", "kg"},       {"hz", "Hz"},       {"ohm", "ohm"},     {"deg", "deg"},
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

}  // namespace io
