// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

namespace io {

struct ArchivedFile {
  std::string path;  // with / between folders
  std::string content;
};

/// The bytes of a zip archive, in builds with FRACFIT_EXPORTS.  They depend on the files alone: every entry has the
/// same date.
/// @throws std::runtime_error  the archive cannot be made; the text gives the cause.
[[nodiscard]] std::string zip_archive(const std::vector<ArchivedFile>& files);

}  // namespace io
