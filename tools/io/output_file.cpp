// SPDX-License-Identifier: BSD-3-Clause
#include "io/output_file.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <optional>
#include <random>
#include <stdexcept>
#include <utility>

#include "io/descriptor.hpp"
#include "io/termination.hpp"

namespace io {
namespace {

namespace fs = std::filesystem;

constexpr mode_t usual_rights = 0666;  // less the umask

[[noreturn]] void fail_opening(const std::string& path, const std::string& cause) {
  throw std::invalid_argument("--out " + path + " cannot be written: " + cause);
}

[[noreturn]] void fail_writing(const std::string& path, int error) {
  throw std::runtime_error("cannot write " + path + ": " + std::strerror(error));
}

// Reports a bad name as wrong usage and a state of the system, such as a full disk, as a failure.
[[noreturn]] void fail_creating(const std::string& path, int error) {
  if (is_state_of_system(error)) fail_writing(path, error);
  fail_opening(path, std::strerror(error));
}

std::string folder_of(const std::string& path) {
  const fs::path parent = fs::path(path).parent_path();
  return parent.empty() ? "." : parent.string();
}

// A hidden name beside the target that no other run has.
std::string name_beside(const std::string& path) {
  static constexpr std::string_view letters = "abcdefghijklmnopqrstuvwxyz0123456789";
  thread_local std::random_device random;
  std::string name = "." + fs::path(path).filename().string() + ".";
  for (int i = 0; i < 10; ++i) name += letters[random() % letters.size()];
  return (fs::path(path).parent_path() / name).string();
}

// Replaces the file that a symbolic link points to, not the link.  That file may not exist yet.
std::string link_target(std::string path) {
  std::error_code none;
  while (fs::is_symlink(fs::symlink_status(path, none))) {
    const fs::path next = fs::read_symlink(path, none);
    if (none) fail_opening(path, none.message());
    path = (fs::path(path).parent_path() / next).string();
  }
  return path;
}

std::optional<struct stat> status_of(const std::string& file) {
  struct stat status {};
  if ((file == "-" ? ::fstat(STDIN_FILENO, &status) : ::stat(file.c_str(), &status)) != 0) return std::nullopt;
  return status;
}

void refuse_inputs(const std::string& path, const std::vector<std::string>& inputs) {
  const auto target = status_of(path);
  if (!target || !S_ISREG(target->st_mode)) return;
  for (const auto& input : inputs) {
    const auto status = status_of(input);
    if (status && status->st_dev == target->st_dev && status->st_ino == target->st_ino)
      throw std::invalid_argument("--out " + path + " is also the input " +
                                  (input == "-" ? std::string("(standard input)") : input) +
                                  ", which would be replaced; give the output another name");
  }
}

// A file without a name cannot be left behind.  Not every file system has them.
Descriptor unnamed_file(const std::string& folder) {
  return Descriptor(::open(folder.c_str(), O_TMPFILE | O_WRONLY | O_CLOEXEC, usual_rights));
}

Descriptor new_file(const std::string& path) {
  return Descriptor(::open(path.c_str(), O_CREAT | O_EXCL | O_WRONLY | O_CLOEXEC, usual_rights));
}

// A result that replaces a file keeps the access rights of that file.
void take_rights(int descriptor, const std::string& path) {
  const auto existing = status_of(path);
  if (existing && ::fchmod(descriptor, existing->st_mode & 07777U) != 0)
    throw std::runtime_error("cannot set the access rights of " + path + ": " + std::strerror(errno));
}

void rename_onto(const std::string& name, const std::string& path) {
  if (::rename(name.c_str(), path.c_str()) == 0) return;
  const int error = errno;
  ::unlink(name.c_str());
  fail_writing(path, error);
}

// Gives the complete file its name.  Returns false if this system cannot name an unnamed file.
bool named(int descriptor, const std::string& path) {
  bool done = false;
  uninterrupted([&] {
    const std::string unnamed = "/proc/self/fd/" + std::to_string(descriptor);
    const auto link_as = [&](const std::string& name) {
      return ::linkat(AT_FDCWD, unnamed.c_str(), AT_FDCWD, name.c_str(), AT_SYMLINK_FOLLOW) == 0;
    };
    done = link_as(path);
    if (done || errno != EEXIST) return;
    const std::string name = name_beside(path);
    done = link_as(name);
    if (done) rename_onto(name, path);
  });
  return done;
}

using Produce = std::function<void(const OutputFile::Sink&)>;

void write_parts(int descriptor, const Produce& produce, const std::string& path) {
  produce([&](std::string_view part) { write_all(descriptor, part, path); });
}

void write_with_name(const std::string& path, const Produce& produce) {
  const std::string name = name_beside(path);
  std::optional<Descriptor> file;
  std::optional<CleanUp> clean_up;
  uninterrupted([&] {
    file.emplace(new_file(name));
    if (file->number() < 0) fail_writing(path, errno);
    clean_up.emplace([name] { ::unlink(name.c_str()); });
  });
  try {
    take_rights(file->number(), path);
    write_parts(file->number(), produce, path);
    if (!file->close()) fail_writing(path, errno);
  } catch (...) {
    ::unlink(name.c_str());
    throw;
  }
  rename_onto(name, path);
}

}  // namespace

bool is_state_of_system(int error) {
  for (const int state : {ENOSPC, EDQUOT, EIO, ENOMEM, EMFILE, ENFILE})
    if (error == state) return true;
  return false;
}

void write_all(int descriptor, std::string_view content, const std::string& path) {
  while (!content.empty()) {
    const auto written = ::write(descriptor, content.data(), content.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0 && errno == EPIPE) throw OutputClosed{};
    if (written < 0) fail_writing(path, errno);
    content.remove_prefix(static_cast<std::size_t>(written));
  }
}

void write_new_file(const std::string& path, std::string_view content, const std::string& shown) {
  Descriptor file = new_file(path);
  if (file.number() < 0) fail_writing(shown, errno);
  write_all(file.number(), content, shown);
  if (!file.close()) fail_writing(shown, errno);
}

OutputFile::OutputFile(std::string path, const std::vector<std::string>& inputs) : path_(std::move(path)) {
  if (path_ == "-") path_.clear();
  if (path_.empty()) return;
  std::error_code error;
  const auto status = fs::status(path_, error);
  if (fs::is_directory(status)) fail_opening(path_, "it is a folder");
  if (fs::path(path_).filename().empty()) fail_opening(path_, "there is no folder of that name");
  // A loop of links, or a folder that may not be searched.
  if (error && status.type() == fs::file_type::none) fail_opening(path_, error.message());
  direct_ = fs::exists(status) && !fs::is_regular_file(status);
  if (fs::exists(status) && ::access(path_.c_str(), W_OK) != 0) fail_opening(path_, std::strerror(errno));
  if (direct_) return;
  refuse_inputs(path_, inputs);
  path_ = link_target(path_);
  if (unnamed_file(folder_of(path_)).number() >= 0) return;
  const std::string probe = name_beside(path_);
  uninterrupted([&] {
    const Descriptor file = new_file(probe);
    if (file.number() < 0) fail_creating(path_, errno);
    ::unlink(probe.c_str());
  });
}

void OutputFile::write(std::string_view content) const {
  write([content](const Sink& sink) { sink(content); });
}

void OutputFile::write(const Produce& produce) const {
  if (path_.empty()) {
    write_parts(STDOUT_FILENO, produce, "standard output");
    return;
  }
  if (direct_) {
    Descriptor descriptor(::open(path_.c_str(), O_WRONLY | O_CLOEXEC));
    if (descriptor.number() < 0) fail_writing(path_, errno);
    write_parts(descriptor.number(), produce, path_);
    if (!descriptor.close()) fail_writing(path_, errno);
    return;
  }
  {
    const Descriptor file = unnamed_file(folder_of(path_));
    if (file.number() >= 0) {
      take_rights(file.number(), path_);
      write_parts(file.number(), produce, path_);
      if (named(file.number(), path_)) return;
    }
  }
  write_with_name(path_, produce);
}

}  // namespace io
