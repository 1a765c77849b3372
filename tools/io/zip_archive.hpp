// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

namespace io {

struct ArchivedFile {
  std::string path;  // with / between folders
  std::string content;
};

/// Whether this build can write archives, i.e. has found libzip.
[[nodiscard]] bool can_write_archives();

/// The bytes of a zip archive.  They depend on the files alone: every entry has the same date.
/// @throws std::runtime_error  the archive cannot be made; the text gives the cause.
[[nodiscard]] std::string zip_archive(const std::vector<ArchivedFile>& files);

}  // namespace io
