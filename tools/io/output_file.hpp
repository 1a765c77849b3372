// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <vector>

namespace io {

/// An output that is written whole or not at all: the complete content takes the place of the target at one stroke,
/// and neither an error nor a signal leaves anything else behind.  Devices and pipes are written directly.
class OutputFile {
 public:
  /// Takes the next part of a content.
  using Sink = std::function<void(std::string_view)>;

  /// @param path    "" or "-" for standard output.  Whether it can be written is found out here, before any work.
  /// @param inputs  files the command reads; "-" is standard input
  /// @throws std::invalid_argument  it cannot be written, or is one of the inputs under whatever name; the text gives
  ///                                path and cause.
  explicit OutputFile(std::string path, const std::vector<std::string>& inputs = {});

  /// @throws std::runtime_error  the disk is full or the like; the target is then untouched.
  void write(std::string_view content) const;
  /// The same for a content that never stands in memory as a whole.
  /// @param produce  hands the parts over one after the other, and again from the start where the file system makes
  ///                 that necessary; where it throws, the target is untouched as well.
  void write(const std::function<void(const Sink&)>& produce) const;

  [[nodiscard]] bool is_standard_output() const noexcept { return path_.empty(); }

 private:
  std::string path_;
  bool direct_ = false;
};

/// Standard output was closed by its reader, e.g. by `head`.
struct OutputClosed {};

/// True if an error number reports the state of the system, such as a full disk, and not a wrong name.
[[nodiscard]] bool is_state_of_system(int error);

/// Writes all of the content to an open file, however many steps the system takes.
/// @param path  of the file, for messages
/// @throws std::runtime_error  with the cause;  OutputClosed
void write_all(int descriptor, std::string_view content, const std::string& path);

/// Writes a file of a folder under construction, directly.
/// @param shown  path for messages
/// @throws std::runtime_error  with the cause.
void write_new_file(const std::string& path, std::string_view content, const std::string& shown);

}  // namespace io
