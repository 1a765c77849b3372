// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <utility>
#include <vector>

namespace io {

struct FmuArchive {
  /// The file *.fmu.
  std::string bytes;
  /// Why it holds no library but its sources only; else empty.
  std::string no_library;
};

/// A library of a unit: its path in the archive, empty where it shall have none.
struct FmuLibraries {
  std::string linux_path, windows_path;
};

/// Archive of a functional mock-up unit: its files and what is compiled of them, a library for 64-bit Linux by `cc`,
/// where this program runs on it, and one for 64-bit Windows by `x86_64-w64-mingw32-gcc`.
/// @param files        path and text each
/// @param main_source  path of the one that is compiled
/// @throws std::runtime_error  the library for Windows cannot be made; as compile_shared_library() and zip_archive().
[[nodiscard]] FmuArchive fmu_archive(const std::vector<std::pair<std::string, std::string>>& files,
                                     const std::string& main_source, const FmuLibraries& libraries);

}  // namespace io
