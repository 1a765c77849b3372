// SPDX-License-Identifier: BSD-3-Clause
#include "io/fmu_archive.hpp"

#include "io/c_compiler.hpp"
#include "io/zip_archive.hpp"

namespace io {
namespace {

// Where FMI 2.0 expects the library for the machine this program runs on; empty where it has no name for it.
constexpr const char* binaries_folder() {
#if defined(__linux__) && defined(__x86_64__)
  return "binaries/linux64/";
#else
  return "";
#endif
}

}  // namespace

FmuArchive fmu_archive(const std::string& name, const std::vector<std::pair<std::string, std::string>>& files,
                       const std::string& main_source) {
  std::vector<ArchivedFile> archive;
  for (const auto& [path, text] : files) archive.push_back({path, text});
  std::string no_library = "this machine is not 64-bit Linux";
  if (const std::string folder = binaries_folder(); !folder.empty()) {
    CompiledLibrary library = compile_shared_library(
        files, main_source,
        {{"-DFMU_HAS_AVX512"}, {"-mavx512f", "-DFMU_FOR_AVX512", "-DFMI2_FUNCTION_PREFIX=avx512_"}});
    no_library = library.failure;
    if (no_library.empty()) archive.push_back({folder + name + ".so", std::move(library.bytes)});
  }
  return {zip_archive(archive), no_library};
}

}  // namespace io
