// SPDX-License-Identifier: BSD-3-Clause
#include "io/output_file.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <stdexcept>
#include <utility>

namespace io {
namespace {

namespace fs = std::filesystem;

class Descriptor {
 public:
  explicit Descriptor(int number) : number_(number) {}
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  ~Descriptor() {
    if (number_ > STDERR_FILENO) ::close(number_);
  }

  [[nodiscard]] int number() const { return number_; }

  // Closing reports what delayed writing found, such as a full disk on a network folder.
  [[nodiscard]] bool close() { return ::close(std::exchange(number_, -1)) == 0; }

 private:
  int number_;
};

void write_all(int descriptor, std::string_view content, const std::string& path) {
  while (!content.empty()) {
    const auto written = ::write(descriptor, content.data(), content.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0 && errno == EPIPE) throw OutputClosed{};
    if (written < 0) throw std::runtime_error("cannot write " + path + ": " + std::strerror(errno));
    content.remove_prefix(static_cast<std::size_t>(written));
  }
}

[[noreturn]] void fail_opening(const std::string& path, const std::string& cause) {
  throw std::invalid_argument("--out " + path + " cannot be written: " + cause);
}

std::string temporary_pattern(const std::string& path) {
  const fs::path target(path);
  return (target.parent_path() / ("." + target.filename().string() + ".XXXXXX")).string();
}

}  // namespace

OutputFile::OutputFile(std::string path) : path_(std::move(path)) {
  if (path_ == "-") path_.clear();
  if (path_.empty()) return;
  std::error_code error;
  const auto status = fs::status(path_, error);
  if (fs::is_directory(status)) fail_opening(path_, "it is a folder");
  if (fs::path(path_).filename().empty()) fail_opening(path_, "there is no folder of that name");
  direct_ = fs::exists(status) && !fs::is_regular_file(status);
  if (fs::exists(status) && ::access(path_.c_str(), W_OK) != 0) fail_opening(path_, std::strerror(errno));
  if (direct_) return;
  // Behind a symbolic link the file it points to is replaced, not the link.
  if (fs::is_symlink(path_, error)) path_ = fs::weakly_canonical(path_, error).string();
  std::string probe = temporary_pattern(path_);
  const Descriptor descriptor(::mkstemp(probe.data()));
  if (descriptor.number() < 0) fail_opening(path_, std::strerror(errno));
  ::unlink(probe.c_str());
}

void OutputFile::write(std::string_view content) const {
  if (path_.empty()) {
    write_all(STDOUT_FILENO, content, "standard output");
    return;
  }
  if (direct_) {
    Descriptor descriptor(::open(path_.c_str(), O_WRONLY | O_CLOEXEC));
    if (descriptor.number() < 0) throw std::runtime_error("cannot write " + path_ + ": " + std::strerror(errno));
    write_all(descriptor.number(), content, path_);
    return;
  }
  std::string temporary = temporary_pattern(path_);
  Descriptor descriptor(::mkstemp(temporary.data()));
  if (descriptor.number() < 0) throw std::runtime_error("cannot write " + path_ + ": " + std::strerror(errno));
  try {
    struct stat existing {};
    mode_t mode = 0;
    if (::stat(path_.c_str(), &existing) == 0) {
      mode = existing.st_mode & 07777U;
    } else {
      const mode_t mask = ::umask(0);
      ::umask(mask);
      mode = 0666U & ~mask;
    }
    // mkstemp makes a private file; the result gets the access rights an ordinary new file would have.
    if (::fchmod(descriptor.number(), mode) != 0)
      throw std::runtime_error("cannot set the access rights of " + path_ + ": " + std::strerror(errno));
    write_all(descriptor.number(), content, path_);
    if (!descriptor.close()) throw std::runtime_error("cannot write " + path_ + ": " + std::strerror(errno));
    fs::rename(temporary, path_);
  } catch (...) {
    ::unlink(temporary.c_str());
    throw;
  }
}

}  // namespace io
