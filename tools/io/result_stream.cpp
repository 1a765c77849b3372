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

#include "io/fingerprint.hpp"
#include "io/line_reader.hpp"
#include "io/output_file.hpp"
#include "io/readable_file.hpp"

namespace io {
namespace {

// Opens the file and locks it against other runs.
Descriptor locked(const std::string& path) {
  Descriptor file(::open(path.c_str(), O_RDWR | O_APPEND | O_CLOEXEC));
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

// The file as an interrupted run has left it, or with the header alone.
Descriptor resumed(const std::string& path, const std::string& header) {
  if (!std::filesystem::is_regular_file(path) || std::filesystem::file_size(path) == 0) return opened(path, header);
  return locked(path);
}

std::string text_of(const std::string& header, const std::map<std::string, std::string>& pieces) {
  std::string text = header;
  for (const auto& [key, piece] : pieces) text += piece;
  return text;
}

constexpr std::string_view mark_start = "# piece: ";

// The fingerprint is that of the piece and of what stands before it.
std::string mark(const std::string& key, const std::string& remark, Fingerprint piece) {
  const std::string start = std::string(mark_start) + key + (remark.empty() ? "" : " " + remark);
  piece.add(start);
  return start + " " + piece.text();
}

}  // namespace

ResultStream::ResultStream(std::string path, const std::string& header, const std::map<std::string, std::string>& kept)
    : path_(std::move(path)), has_marks_(false), file_(opened(path_, text_of(header, kept))), size_(header.size()) {
  for (const auto& [key, piece] : kept) {
    pieces_.emplace(key, Place{size_, piece.size(), ""});
    size_ += piece.size();
  }
}

ResultStream::ResultStream(std::string path, const std::string& header)
    : path_(std::move(path)), has_marks_(true), file_(resumed(path_, header)) {
  scan(header);
  if (::ftruncate(file_.number(), static_cast<off_t>(size_)) != 0)
    throw std::runtime_error("cannot write " + path_ + ": " + std::strerror(errno));
}

// Finds the pieces that are whole, up to the first that is not.
void ResultStream::scan(const std::string& header) {
  FileLines lines(file_.number(), path_);
  std::string found;
  while (found.size() < header.size()) {
    const auto line = lines.next();
    if (!line) break;
    found += std::string(*line) + "\n";
  }
  if (found != header)
    throw std::invalid_argument(path_ +
                                " belongs to another command or version than this one; finish that one, remove the "
                                "file, or choose another --out");
  size_ = header.size();
  Fingerprint piece;
  while (const auto line = lines.next()) {
    if (!line->starts_with(mark_start)) {
      piece.add(*line);
      piece.add("\n");
      continue;
    }
    const std::string words(line->substr(mark_start.size(), line->rfind(' ') - mark_start.size()));
    const std::string key = words.substr(0, words.find(' '));
    const std::string remark = words.size() > key.size() ? words.substr(key.size() + 1) : "";
    const std::string expected = mark(key, remark, piece);
    if (*line != expected) return;
    const std::size_t end = lines.position() - expected.size() - 1;
    pieces_.emplace(key, Place{size_, end - size_, remark});
    size_ = lines.position();
    piece = Fingerprint();
  }
}

bool ResultStream::contains(const std::string& key) const {
  const std::lock_guard guard(mutex_);
  return pieces_.contains(key);
}

std::size_t ResultStream::size() const {
  const std::lock_guard guard(mutex_);
  return pieces_.size();
}

std::string ResultStream::text(const std::string& key) const {
  const std::lock_guard guard(mutex_);
  const Place place = pieces_.at(key);
  return read_at(file_.number(), place.begin, place.size, path_);
}

std::string ResultStream::remark(const std::string& key) const {
  const std::lock_guard guard(mutex_);
  return pieces_.at(key).remark;
}

void ResultStream::append(const std::string& key, const std::string& text, const std::string& remark) {
  const std::string written = has_marks_ ? text + mark(key, remark, Fingerprint(text)) + "\n" : text;
  const std::lock_guard guard(mutex_);
  if (!failure_.empty()) throw std::runtime_error(failure_);
  try {
    write_all(file_.number(), written, path_);
  } catch (const std::runtime_error& error) {
    // Part of the piece may have been written, so nothing further may follow it.
    failure_ = error.what();
    static_cast<void>(::ftruncate(file_.number(), static_cast<off_t>(size_)));
    throw;
  }
  pieces_.insert_or_assign(key, Place{size_, text.size(), remark});
  size_ += written.size();
}

void ResultStream::finish(const std::string& content) {
  const std::lock_guard guard(mutex_);
  OutputFile(path_).write(content);
}

void ResultStream::remove() {
  const std::lock_guard guard(mutex_);
  std::filesystem::remove(path_);
}

}  // namespace io
