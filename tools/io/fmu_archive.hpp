// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <utility>
#include <vector>

namespace io {

struct FmuArchive {
  /// The file *.fmu.
  std::string bytes;
  /// Why it holds no library for this machine but its sources only; else empty.
  std::string no_library;
};

/// Archive of a functional mock-up unit: its files and, compiled of them by `cc`, a library for 64-bit Linux.
/// @param name         of the unit and its library
/// @param files        path and text each
/// @param main_source  path of the one that is compiled
/// @throws std::runtime_error  as compile_shared_library() and zip_archive().
[[nodiscard]] FmuArchive fmu_archive(const std::string& name,
                                     const std::vector<std::pair<std::string, std::string>>& files,
                                     const std::string& main_source);

}  // namespace io
