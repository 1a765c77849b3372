// SPDX-License-Identifier: BSD-3-Clause
#include "io/fmu_archive.hpp"

#include <stdexcept>

#include "io/c_compiler.hpp"
#include "io/zip_archive.hpp"

namespace io {

FmuArchive fmu_archive(const std::vector<std::pair<std::string, std::string>>& files, const std::string& main_source,
                       const FmuLibraries& libraries) {
  std::vector<ArchivedFile> archive;
  for (const auto& [path, text] : files) archive.push_back({path, text});
#if defined(__linux__) && defined(__x86_64__)
  CompiledLibrary library = compile_shared_library(
      "cc", files, main_source, {{"-fPIC", "-DFMU_HAS_AVX512"}, {"-fPIC", "-mavx512f", "-DFMU_FOR_AVX512"}});
  std::string no_library = library.failure;
  if (no_library.empty()) archive.push_back({libraries.linux_path, std::move(library.bytes)});
#else
  std::string no_library = "this machine is not 64-bit Linux";
#endif
  if (!libraries.windows_path.empty()) {
    CompiledLibrary of_windows = compile_shared_library("x86_64-w64-mingw32-gcc", files, main_source, {{}});
    if (!of_windows.failure.empty()) throw std::runtime_error("no library for Windows: " + of_windows.failure);
    archive.push_back({libraries.windows_path, std::move(of_windows.bytes)});
    no_library.clear();
  }
  return {zip_archive(archive), no_library};
}

}  // namespace io
