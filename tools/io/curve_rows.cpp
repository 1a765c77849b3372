// SPDX-License-Identifier: BSD-3-Clause
#include "io/curve_rows.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <optional>
#include <set>
#include <stdexcept>
#include <string_view>

#include "io/column_plan.hpp"
#include "io/fields.hpp"
#include "io/number.hpp"

namespace io {
namespace {

constexpr std::array<std::string_view, 8> scene_columns{"force_n",
                                                        "clearance_m",
                                                        "restitution",
                                                        "contact_stiffness_n_m",
                                                        "contact_damping_n_s_m",
                                                        "contact_frequency_rad_s",
                                                        "contact_ratio",
                                                        "contact_restitution"};

class SweepSearch {
 public:
  SweepSearch(const TextTable& table, std::size_t frequency) : table_(table), frequency_(frequency) {}

  // Sweeps begin where the frequency turns back.  A column tells them apart that is constant in each and never the same
  // in two.
  [[nodiscard]] SweepColumn find() {
    const std::size_t width = table_.header().size();
    std::vector<bool> is_constant(width, true);
    std::vector<std::vector<std::string>> values(width);
    double previous = 0, direction = 0;
    bool is_first = true;
    table_.for_each_row([&](const TextTable::Row& row) {
      const auto frequency = parse_number(row.fields[frequency_]);
      if (!frequency || !(*frequency > 0)) return;
      const double step = *frequency - previous;
      const bool turns = is_first || (direction != 0 && step * direction < 0);
      if (turns) {
        for (std::size_t i = 0; i < width; ++i) values[i].emplace_back(row.fields[i]);
        direction = 0;
      } else {
        if (direction == 0) direction = step;
        for (std::size_t i = 0; i < width; ++i)
          if (is_constant[i] && row.fields[i] != values[i].back()) is_constant[i] = false;
      }
      previous = *frequency;
      is_first = false;
    });
    if (is_first || values.front().size() < 2) return {};
    std::optional<std::size_t> best;
    for (std::size_t i = 0; i < width; ++i) {
      if (i == frequency_ || !is_constant[i]) continue;
      if (std::set<std::string>(values[i].begin(), values[i].end()).size() != values[i].size()) continue;
      if (!best || (names_a_sweep(i) && !names_a_sweep(*best))) best = i;
    }
    if (!best) return {};
    SweepColumn found{std::string(table_.header()[*best].text), {}};
    for (const auto& value : values[*best]) found.values.push_back(key_label(value));
    return found;
  }

 private:
  [[nodiscard]] bool names_a_sweep(std::size_t column) const {
    std::string name(table_.header()[column].text);
    std::transform(name.begin(), name.end(), name.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    constexpr std::array<std::string_view, 7> words{"set", "cycle", "sweep", "segment", "run", "loop", "curve"};
    return std::any_of(words.begin(), words.end(),
                       [&](std::string_view word) { return name.find(word) != std::string::npos; });
  }

  const TextTable& table_;
  std::size_t frequency_;
};

}  // namespace

std::vector<std::size_t> scene_columns_of(const TextTable& table) {
  std::vector<std::size_t> columns;
  for (const auto name : scene_columns)
    if (const auto column = position_of(table, std::string(name))) columns.push_back(*column);
  return columns;
}

Selection::Selection(const TextTable& table, const Metadata& wanted) {
  for (const auto& [name, value] : wanted) {
    const auto column = position_of(table, name);
    if (!column)
      throw DataError(table.file(), table.header().front().line, table.header().front().column,
                      "no column " + quoted(name) + " among " + column_list(table));
    wanted_.emplace_back(*column, value);
  }
}

bool Selection::operator()(const TextTable::Row& row) const {
  return std::all_of(wanted_.begin(), wanted_.end(),
                     [&](const auto& each) { return key_label(row.fields[each.first]) == each.second; });
}

void OneScene::check(const TextTable::Row& row) {
  if (first_.empty()) {
    for (const auto column : columns_) first_.emplace_back(row.fields[column]);
    return;
  }
  for (std::size_t i = 0; i < columns_.size(); ++i) {
    const auto field = row.fields[columns_[i]];
    if (field == first_[i] || key_label(field) == key_label(first_[i])) continue;
    const std::string name(table_.header()[columns_[i]].text);
    throw std::invalid_argument(table_.file() + " holds several curves, told apart by column " + name + " (" +
                                first_[i] + ", " + std::string(field) + ", ...); take one by --where '" + name +
                                "==" + std::string(field) + "', or each on its own by fracfit batch --by " + name);
  }
}

Metadata OneScene::entries() const {
  Metadata entries;
  for (std::size_t i = 0; i < first_.size(); ++i)
    entries.emplace_back(table_.header()[columns_[i]].text, key_label(first_[i]));
  return entries;
}

SweepColumn sweep_column(const TextTable& table, const MeasurementOptions& how) {
  if (!scene_columns_of(table).empty()) return {};
  std::vector<std::string> ignored;
  const Planner planner(table, "", how, ignored);
  const auto frequency = planner.frequency();
  return frequency ? SweepSearch(table, *frequency).find() : SweepColumn{};
}

}  // namespace io
