// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <utility>
#include <vector>

namespace io {

struct CompiledLibrary {
  /// Bytes of the shared library; empty where there is none.
  std::string bytes;
  /// Why there is none, one line or what the compiler said; else empty.
  std::string failure;
};

/// Compiles a C99 file, and what it includes, to a shared library.  Products are not fused into sums, and only what
/// asks for it is visible.
/// @param compiler  program, with the options of GCC
/// @param files  path and content each, in folders of their own
/// @param main   path of the one that is compiled
/// @param variants  options, in addition, of each time it is compiled; the library holds what comes out of all
/// @throws std::runtime_error  a temporary folder cannot be written; the text gives the cause.
[[nodiscard]] CompiledLibrary compile_shared_library(const std::string& compiler,
                                                     const std::vector<std::pair<std::string, std::string>>& files,
                                                     const std::string& main,
                                                     const std::vector<std::vector<std::string>>& variants);

}  // namespace io
