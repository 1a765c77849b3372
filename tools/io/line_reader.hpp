// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

namespace io {

/// Lines of a regular file one after the other, or what else a character ends, read through a buffer, so that memory
/// does not grow with the file.
class FileLines {
 public:
  /// @param descriptor  open for reading; its position is neither used nor moved
  /// @param path        for messages
  /// @param buffer      bytes to read at once
  /// @param begin       first byte to read
  /// @param end         character that ends a line
  FileLines(int descriptor, std::string path, std::size_t buffer = 1U << 18U, std::size_t begin = 0, char end = '\n')
      : descriptor_(descriptor), path_(std::move(path)), wanted_(buffer), begin_(begin), end_(end) {}

  /// The next line without its end, valid until the next call; nothing at the end.  A last line without an end was
  /// cut off while it was written and is left out.
  /// @throws std::runtime_error  the file cannot be read.
  [[nodiscard]] std::optional<std::string_view> next();
  /// First byte behind the lines given so far and their ends.
  [[nodiscard]] std::size_t position() const noexcept { return begin_ + at_; }

 private:
  bool read_more();

  int descriptor_;
  std::string path_;
  std::size_t wanted_;
  std::string buffer_;
  std::size_t begin_;   // of the buffer in the file
  std::size_t at_ = 0;  // of the next line in the buffer
  char end_;
};

}  // namespace io
