// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <optional>
#include <string_view>

#include "io/termination.hpp"

namespace report {

/// A folder under construction inside its final place, hidden.  Removed with all it holds unless published, also where
/// a signal ends the program.
class StagedFolder {
 public:
  /// @param target  made if missing
  /// @throws std::invalid_argument  it is a file, or cannot be made or written; the text gives path and cause.
  explicit StagedFolder(const std::filesystem::path& target);
  ~StagedFolder();
  StagedFolder(const StagedFolder&) = delete;
  StagedFolder& operator=(const StagedFolder&) = delete;

  [[nodiscard]] const std::filesystem::path& path() const noexcept { return staging_; }
  [[nodiscard]] const std::filesystem::path& target() const noexcept { return target_; }

  /// @throws std::runtime_error  the file cannot be written in full; the text gives path and cause.
  void write(const std::filesystem::path& relative, std::string_view content) const;

  /// Moves every file onto its place in the target, `last` at the end; other files there stay.
  /// @throws std::runtime_error  a file cannot be moved; the text gives path and cause.
  void publish(const std::filesystem::path& last);

 private:
  void remove() const;

  std::filesystem::path target_;
  std::filesystem::path staging_;
  bool created_ = false;
  std::optional<io::CleanUp> clean_up_;
};

}  // namespace report
