// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <string_view>

namespace io {

/// An output that is written whole or not at all: a temporary file beside the target is renamed onto it.
/// Devices and pipes are written directly.
class OutputFile {
 public:
  /// @param path  "" or "-" for standard output.  Whether it can be written is found out here, before any work.
  /// @throws std::invalid_argument  it cannot; the text gives path and cause.
  explicit OutputFile(std::string path);

  /// @throws std::runtime_error  the disk is full or the like; the target is then untouched.
  void write(std::string_view content) const;

  [[nodiscard]] bool is_standard_output() const noexcept { return path_.empty(); }

 private:
  std::string path_;
  bool direct_ = false;
};

/// Standard output was closed by its reader, e.g. by `head`.
struct OutputClosed {};

}  // namespace io
