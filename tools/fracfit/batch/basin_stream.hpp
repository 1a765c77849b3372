// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "backlash/basins.hpp"
#include "io/result_stream.hpp"

namespace fracfit {

/// Outcomes of a search for basins in a file, which an interrupted run leaves to the next one.
class BasinStream : public backlash::OutcomeStore {
 public:
  /// @param header  whole lines, by which a search is known again
  /// @throws std::invalid_argument  as io::ResultStream.
  BasinStream(const std::string& path, const std::string& header);

  [[nodiscard]] bool contains(const std::string& key) const override;
  [[nodiscard]] std::vector<backlash::StartOutcome> outcomes(const std::string& key) const override;
  void keep(const std::string& key, const std::vector<backlash::StartOutcome>& outcomes) override;

  /// Nothing has been kept yet.
  [[nodiscard]] bool is_new() const { return stream_.size() == 0; }
  /// Removes the file, as the result stands elsewhere.
  void remove() { stream_.remove(); }

 private:
  io::ResultStream stream_;
};

}  // namespace fracfit
