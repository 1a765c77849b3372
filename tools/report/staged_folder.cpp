// SPDX-License-Identifier: BSD-3-Clause
#include "report/staged_folder.hpp"

#include <stdlib.h>

#include <cerrno>
#include <stdexcept>
#include <string>
#include <system_error>
#include <vector>

#include "io/output_file.hpp"

namespace report {

namespace fs = std::filesystem;

namespace {

[[noreturn]] void refuse(const fs::path& folder, const std::error_code& cause) {
  if (io::is_state_of_system(cause.value()))
    throw std::runtime_error("cannot write folder \"" + folder.string() + "\": " + cause.message());
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
  int failure = 0;
  io::uninterrupted([&] {
    if (mkdtemp(name.data()) == nullptr) {
      failure = errno;
      return;
    }
    staging_ = name;
    clean_up_.emplace([this] { remove(); });
  });
  if (failure == 0) return;
  if (created_) fs::remove(target_, error);
  refuse(target_, std::error_code(failure, std::generic_category()));
}

StagedFolder::~StagedFolder() {
  io::uninterrupted([&] { remove(); });
}

void StagedFolder::remove() const {
  std::error_code ignored;
  // A gnuplot that is being ended may still add a file while the folder is emptied.
  constexpr int tries = 10;
  for (int i = 0; i < tries && fs::exists(staging_, ignored); ++i) fs::remove_all(staging_, ignored);
  // Removes the folder made for a report that failed, if it is empty.
  if (created_) fs::remove(target_, ignored);
}

void StagedFolder::write(const fs::path& relative, std::string_view content) const {
  const fs::path path = staging_ / relative;
  std::error_code error;
  fs::create_directories(path.parent_path(), error);
  if (error) throw std::runtime_error("cannot write " + (target_ / relative).string() + ": " + error.message());
  io::write_new_file(path.string(), content, (target_ / relative).string());
}

void StagedFolder::publish(const fs::path& last) {
  std::vector<fs::path> files;
  for (const auto& entry : fs::recursive_directory_iterator(staging_)) {
    if (entry.is_regular_file()) files.push_back(entry.path().lexically_relative(staging_));
  }
  const auto move = [&](const fs::path& file) {
    std::error_code error;
    fs::create_directories((target_ / file).parent_path(), error);
    if (!error) fs::rename(staging_ / file, target_ / file, error);
    if (error) throw std::runtime_error("cannot write " + (target_ / file).string() + ": " + error.message());
  };
  io::uninterrupted([&] {
    for (const fs::path& file : files)
      if (file != last) move(file);
    move(last);
  });
}

}  // namespace report
