// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <charconv>
#include <fstream>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace support {

/// Rows of numbers of data/reference/<name>, a CSV file with one header line.
inline std::vector<std::vector<double>> reference_table(const std::string& name) {
  const std::string path = std::string(FRACFIT_SOURCE_DIR) + "/data/reference/" + name;
  std::ifstream file(path);
  if (!file) throw std::runtime_error("cannot read " + path);
  std::vector<std::vector<double>> rows;
  std::string line;
  std::getline(file, line);
  while (std::getline(file, line)) {
    std::vector<double> row;
    const char* at = line.data();
    const char* const end = line.data() + line.size();
    while (at < end) {
      double value = 0;
      const auto result = std::from_chars(at, end, value);
      if (result.ec != std::errc{}) throw std::runtime_error(path + ": no number in \"" + line + "\"");
      row.push_back(value);
      at = result.ptr + (result.ptr < end ? 1 : 0);
    }
    rows.push_back(row);
  }
  return rows;
}

}  // namespace support
