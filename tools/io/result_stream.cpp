// SPDX-License-Identifier: BSD-3-Clause
#include "io/result_stream.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <utility>

#include "io/data_error.hpp"
#include "io/output_file.hpp"

namespace io {
namespace {

[[noreturn]] void fail(const std::string& path, const std::string& cause) {
  throw std::runtime_error("cannot write " + path + ": " + cause);
}

// An open file that no other run may add to.
int locked(const std::string& path) {
  const int descriptor = ::open(path.c_str(), O_WRONLY | O_APPEND | O_CLOEXEC);
  if (descriptor < 0) throw std::invalid_argument(path + " cannot be written: " + std::strerror(errno));
  // A folder that knows no locks, such as some network folders, is used without.
  if (::flock(descriptor, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK) {
    ::close(descriptor);
    throw std::invalid_argument(path + " is being written by another run; wait for its end or choose another --out");
  }
  return descriptor;
}

}  // namespace

std::vector<std::string> whole_lines(const std::string& file) {
  std::vector<std::string> lines;
  if (!std::filesystem::exists(file)) return lines;
  std::ifstream stream(file, std::ios::binary);
  const std::string content{std::istreambuf_iterator<char>(stream), {}};
  if (!stream) throw DataError(file, 0, 0, "cannot be read");
  for (std::size_t begin = 0;;) {
    const auto end = content.find('\n', begin);
    if (end == std::string::npos) return lines;
    lines.push_back(content.substr(begin, end - begin));
    begin = end + 1;
  }
}

ResultStream::ResultStream(std::string path, std::string header, std::map<std::string, std::string> kept)
    : path_(std::move(path)), header_(std::move(header)), lines_(std::move(kept)) {
  const OutputFile out(path_);
  const bool existed = std::filesystem::exists(path_);
  if (existed && !std::filesystem::is_regular_file(path_))
    throw std::invalid_argument(path_ + " is no regular file; results are added to it one by one");
  const int earlier = existed ? locked(path_) : -1;
  std::string content = header_;
  for (const auto& [key, line] : lines_) content += line + "\n";
  try {
    out.write(content);
    descriptor_ = locked(path_);
  } catch (...) {
    if (earlier >= 0) ::close(earlier);
    throw;
  }
  if (earlier >= 0) ::close(earlier);
}

ResultStream::~ResultStream() {
  ::close(descriptor_);
}

bool ResultStream::contains(const std::string& key) const {
  const std::lock_guard guard(mutex_);
  return lines_.contains(key);
}

void ResultStream::append(const std::string& key, const std::string& line) {
  const std::lock_guard guard(mutex_);
  const std::string text = line + "\n";
  for (std::string_view rest = text; !rest.empty();) {
    const auto written = ::write(descriptor_, rest.data(), rest.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) fail(path_, std::strerror(errno));
    rest.remove_prefix(static_cast<std::size_t>(written));
  }
  lines_.insert_or_assign(key, line);
}

std::string ResultStream::line(const std::string& key) const {
  const std::lock_guard guard(mutex_);
  return lines_.at(key);
}

void ResultStream::finish(const std::vector<std::string>& keys, const std::string& trailer) {
  const std::lock_guard guard(mutex_);
  std::string content = header_;
  for (const auto& key : keys) content += lines_.at(key) + "\n";
  OutputFile(path_).write(content + trailer);
}

}  // namespace io
