// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "io/measurement.hpp"
#include "io/text_table.hpp"

namespace io {

// Columns that tell apart the scenes of a table as simulate and map write it.
[[nodiscard]] std::vector<std::size_t> scene_columns_of(const TextTable& table);

// Rows in which some columns have given values.
class Selection {
 public:
  Selection(const TextTable& table, const Metadata& wanted);
  [[nodiscard]] bool operator()(const TextTable::Row& row) const;

 private:
  std::vector<std::pair<std::size_t, std::string>> wanted_;
};

// Refuses points of several scenes, which are no single curve.
class OneScene {
 public:
  explicit OneScene(const TextTable& table) : table_(table), columns_(scene_columns_of(table)) {}

  void check(const TextTable::Row& row);
  [[nodiscard]] Metadata entries() const;

 private:
  const TextTable& table_;
  std::vector<std::size_t> columns_;
  std::vector<std::string> first_;  // texts of these columns in the first row
};

// A column that tells sweeps apart whose rows repeat the frequencies, and its values in order; empty where there is
// none.
struct SweepColumn {
  std::string name;
  std::vector<std::string> values;
};

[[nodiscard]] SweepColumn sweep_column(const TextTable& table, const MeasurementOptions& how);

}  // namespace io
