// SPDX-License-Identifier: BSD-3-Clause
#include "io/input_files.hpp"

#include <algorithm>
#include <array>
#include <filesystem>
#include <set>
#include <stdexcept>
#include <string_view>

#include "io/data_error.hpp"

namespace io {
namespace {

namespace fs = std::filesystem;

constexpr std::array<std::string_view, 17> endings{".csv", ".tsv", ".txt", ".dat", ".dta", ".mpt",
                                                   ".z",   ".par", ".s1p", ".s2p", ".s3p", ".s4p",
                                                   ".unv", ".uff", ".58",  ".asc", ".data"};

bool is_data_file(const fs::directory_entry& entry) {
  std::string extension = entry.path().extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; });
  return entry.is_regular_file() && !entry.path().filename().string().starts_with('.') &&
         std::find(endings.begin(), endings.end(), extension) != endings.end();
}

}  // namespace

std::vector<std::string> input_files(const std::vector<std::string>& given, const std::string& except) {
  std::vector<std::string> files;
  for (const auto& path : given) {
    if (path == "-") throw std::invalid_argument("'-': a batch reads files, not standard input");
    std::error_code ignored;
    if (!fs::is_directory(path, ignored)) {
      files.push_back(path);
      continue;
    }
    std::vector<std::string> inside;
    std::error_code error;
    const fs::directory_iterator entries(path, error);
    if (error) throw DataError(path, 0, 0, "cannot be read: " + error.message());
    for (const auto& entry : entries)
      if (is_data_file(entry) && (except.empty() || !fs::equivalent(entry.path(), except, ignored)))
        inside.push_back(entry.path().string());
    if (inside.empty())
      throw std::invalid_argument("folder " + path +
                                  " holds no file ending in .csv, .tsv, .txt, .dat or as instruments name them");
    std::sort(inside.begin(), inside.end());
    files.insert(files.end(), inside.begin(), inside.end());
  }
  std::set<std::string> seen;
  for (const auto& file : files) {
    if (file.find_first_of("\r\n") != std::string::npos)
      throw std::invalid_argument("file name " + file + " holds a line break");
    if (!seen.insert(file).second) throw std::invalid_argument("file " + file + " is given twice");
  }
  return files;
}

}  // namespace io
