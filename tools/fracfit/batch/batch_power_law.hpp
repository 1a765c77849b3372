// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "batch/batch_table.hpp"

namespace fracfit {

/// A parameter of the fits as a power of an entry of the file headers.
struct PowerLawRequest {
  std::string parameter, variable;
};
/// From PARAMETER:VARIABLE. @throws std::invalid_argument
[[nodiscard]] PowerLawRequest power_law_request(const std::string& text);

struct PowerLawRemarks {
  std::string text;                // lines below the rows
  std::vector<std::string> notes;  // of rows left out, laws through two points or none; one sentence each
};

/// The laws of a manifest, each over the rows that converged, identified the parameter, and know the variable, both
/// positive.
class PowerLaws {
 public:
  PowerLaws(BatchFormat format, const BatchManifest& manifest);
  /// Takes a row into account.
  void add(std::string_view line);
  [[nodiscard]] PowerLawRemarks remarks() const;

 private:
  // Points of a law, and why rows gave none: reason and number of rows.
  struct Law {
    PowerLawRequest request;
    std::vector<double> x, y;
    std::map<std::string, int> left_out;
  };
  [[nodiscard]] static BatchRow remark_of(const Law& law);

  BatchFormat format_;
  std::vector<std::string> columns_;
  std::vector<Law> laws_;
  std::size_t rows_ = 0;
};

}  // namespace fracfit
