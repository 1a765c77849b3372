// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <string_view>

namespace report {

/// A folder under construction inside its final place, hidden.  Removed with all it holds unless published.
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

  /// @throws std::filesystem::filesystem_error  the file cannot be written in full.
  void write(const std::filesystem::path& relative, std::string_view content) const;

  /// Moves every file onto its place in the target, `last` at the end; other files there stay.
  /// @throws std::filesystem::filesystem_error
  void publish(const std::filesystem::path& last);

 private:
  std::filesystem::path target_;
  std::filesystem::path staging_;
  bool created_ = false;
};

}  // namespace report
