// SPDX-License-Identifier: BSD-3-Clause
#include "io/result_stream.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <optional>
#include <stdexcept>
#include <utility>

#include "io/output_file.hpp"

namespace io {
namespace {

// Opens the file and locks it against other runs.
Descriptor locked(const std::string& path) {
  Descriptor file(::open(path.c_str(), O_WRONLY | O_APPEND | O_CLOEXEC));
  if (file.number() < 0) {
    const int error = errno;
    if (is_state_of_system(error)) throw std::runtime_error("cannot write " + path + ": " + std::strerror(error));
    throw std::invalid_argument(path + " cannot be written: " + std::strerror(error));
  }
  // Some network folders have no locks; they are used without one.
  if (::flock(file.number(), LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK)
    throw std::invalid_argument(path + " is being written by another run; wait for its end or choose another --out");
  return file;
}

// Checks the place, writes what is kept, and opens it for more.
Descriptor opened(const std::string& path, const std::string& content) {
  const OutputFile out(path);
  std::optional<Descriptor> earlier;
  if (std::filesystem::exists(path)) {
    if (!std::filesystem::is_regular_file(path))
      throw std::invalid_argument(path + " is no regular file; results are added to it one by one");
    earlier.emplace(locked(path));
  }
  out.write(content);
  return locked(path);
}

std::string text_of(const std::string& header, const std::map<std::string, std::string>& lines) {
  std::string text = header;
  for (const auto& [key, line] : lines) text += line + "\n";
  return text;
}

}  // namespace

ResultStream::ResultStream(std::string path, const std::string& header, std::map<std::string, std::string> kept)
    : path_(std::move(path)),
      lines_(std::move(kept)),
      file_(opened(path_, text_of(header, lines_))),
      size_(text_of(header, lines_).size()) {}

bool ResultStream::contains(const std::string& key) const {
  const std::lock_guard guard(mutex_);
  return lines_.contains(key);
}

void ResultStream::append(const std::string& key, const std::string& line) {
  const std::lock_guard guard(mutex_);
  if (!failure_.empty()) throw std::runtime_error(failure_);
  const std::string text = line + "\n";
  try {
    write_all(file_.number(), text, path_);
  } catch (const std::runtime_error& error) {
    // Part of the line may have been written, so no further line may follow it.
    failure_ = error.what();
    static_cast<void>(::ftruncate(file_.number(), static_cast<off_t>(size_)));
    throw;
  }
  size_ += text.size();
  lines_.insert_or_assign(key, line);
}

std::string ResultStream::line(const std::string& key) const {
  const std::lock_guard guard(mutex_);
  return lines_.at(key);
}

void ResultStream::finish(const std::string& content) {
  const std::lock_guard guard(mutex_);
  OutputFile(path_).write(content);
}

}  // namespace io
