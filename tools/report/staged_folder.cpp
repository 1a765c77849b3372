// SPDX-License-Identifier: BSD-3-Clause
#include "report/staged_folder.hpp"

#include <stdlib.h>

#include <cerrno>
#include <fstream>
#include <stdexcept>
#include <string>
#include <system_error>
#include <vector>

namespace report {

namespace fs = std::filesystem;

namespace {

[[noreturn]] void refuse(const fs::path& folder, const std::error_code& cause) {
  throw std::invalid_argument("folder \"" + folder.string() + "\" cannot be written: " + cause.message());
}

}  // namespace

StagedFolder::StagedFolder(const fs::path& target) : target_(fs::absolute(target).lexically_normal()) {
  if (!target_.has_filename()) target_ = target_.parent_path();
  std::error_code error;
  created_ = fs::create_directories(target_, error);
  if (error) refuse(target_, error);
  // Inside the target, so that every later move is a rename and the parent folder need not be writable.
  std::string name = (target_ / ".report-XXXXXX").string();
  if (mkdtemp(name.data()) == nullptr) refuse(target_, std::error_code(errno, std::generic_category()));
  staging_ = name;
}

StagedFolder::~StagedFolder() {
  std::error_code ignored;
  fs::remove_all(staging_, ignored);
  // Removes the folder made for a report that failed, if it is empty.
  if (created_) fs::remove(target_, ignored);
}

void StagedFolder::write(const fs::path& relative, std::string_view content) const {
  const fs::path path = staging_ / relative;
  fs::create_directories(path.parent_path());
  std::ofstream file(path, std::ios::binary);
  file.write(content.data(), static_cast<std::streamsize>(content.size()));
  file.close();
  if (!file) throw fs::filesystem_error("cannot write", target_ / relative, std::make_error_code(std::errc::io_error));
}

void StagedFolder::publish(const fs::path& last) {
  std::vector<fs::path> files;
  for (const auto& entry : fs::recursive_directory_iterator(staging_)) {
    if (entry.is_regular_file()) files.push_back(entry.path().lexically_relative(staging_));
  }
  for (const fs::path& file : files) {
    if (file == last) continue;
    fs::create_directories((target_ / file).parent_path());
    fs::rename(staging_ / file, target_ / file);
  }
  fs::rename(staging_ / last, target_ / last);
}

}  // namespace report
