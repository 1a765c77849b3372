// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <map>
#include <mutex>
#include <string>
#include <string_view>
#include <vector>

#include "io/descriptor.hpp"

namespace io {

/// A file that grows by one line per finished piece of work, so that nothing is lost when the program is interrupted,
/// and is put in order at the end.  Safe to use from several threads.
class ResultStream {
 public:
  /// Writes header and the lines kept from an earlier run, then leaves the file open for more.
  /// @param header  whole lines
  /// @param kept    finished lines by key, without line ends
  /// @throws std::invalid_argument  the file cannot be written, is no regular file, or another program has it open.
  ResultStream(std::string path, const std::string& header, std::map<std::string, std::string> kept);
  ResultStream(const ResultStream&) = delete;
  ResultStream& operator=(const ResultStream&) = delete;

  [[nodiscard]] bool contains(const std::string& key) const;
  /// The line reaches the file before this returns.
  /// @throws std::runtime_error  the disk is full or the like; the file then holds whole lines all the same, and takes
  ///                             no more.
  void append(const std::string& key, const std::string& line);
  /// Line of a key. @throws std::out_of_range
  [[nodiscard]] std::string line(const std::string& key) const;
  /// Replaces the file by its final content, whole or not at all.
  void finish(const std::string& content);

 private:
  std::string path_;
  std::map<std::string, std::string> lines_;
  mutable std::mutex mutex_;
  Descriptor file_;
  std::size_t size_ = 0;  // bytes of the whole lines in the file
  std::string failure_;   // why nothing more is written; empty: it is
};

}  // namespace io
