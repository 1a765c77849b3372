// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <map>
#include <mutex>
#include <string>
#include <string_view>
#include <vector>

namespace io {

/// Whole lines of a file without their line ends.  A last line without one was cut off while it was written and is left
/// out.  A file that does not exist has none.
/// @throws DataError  it cannot be read.
[[nodiscard]] std::vector<std::string> whole_lines(const std::string& file);

/// A file that grows by one line per finished piece of work, so that nothing is lost when the program is interrupted,
/// and is put in order at the end.  Safe to use from several threads.
class ResultStream {
 public:
  /// Writes header and the lines kept from an earlier run, then leaves the file open for more.
  /// @param header  whole lines
  /// @param kept    finished lines by key, without line ends
  /// @throws std::invalid_argument  the file cannot be written, is no regular file, or another program has it open.
  ResultStream(std::string path, std::string header, std::map<std::string, std::string> kept);
  ResultStream(const ResultStream&) = delete;
  ResultStream& operator=(const ResultStream&) = delete;
  ~ResultStream();

  [[nodiscard]] bool contains(const std::string& key) const;
  /// The line reaches the file before this returns.
  /// @throws std::runtime_error  the disk is full or the like.
  void append(const std::string& key, const std::string& line);
  /// Line of a key. @throws std::out_of_range
  [[nodiscard]] std::string line(const std::string& key) const;
  /// Replaces the file by header, the lines in the order of `keys`, and trailer, whole or not at all.
  void finish(const std::vector<std::string>& keys, const std::string& trailer);

 private:
  std::string path_;
  std::string header_;
  std::map<std::string, std::string> lines_;
  mutable std::mutex mutex_;
  int descriptor_ = -1;
};

}  // namespace io
