// SPDX-License-Identifier: BSD-3-Clause
#include "io/input_text.hpp"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <map>
#include <memory>
#include <mutex>
#include <utility>

#include "io/data_error.hpp"
#include "io/descriptor.hpp"

namespace io {
namespace {

using Text = std::shared_ptr<const std::string>;
using Identity = std::pair<dev_t, ino_t>;

// Of a device such as /dev/zero, which never ends; a terminal is one too.
constexpr std::size_t most_of_a_device = std::size_t{1} << 26U;

[[noreturn]] void fail(const std::string& file, const std::string& message) {
  throw DataError(file == "-" ? "standard input" : file, 0, 0, message);
}

[[noreturn]] void fail(const std::string& file, int error) {
  fail(file, std::string("cannot be read: ") + std::strerror(error));
}

// A file of many megabytes is filled in a third of the time where its memory comes in pages of megabytes.  This is a
// hint: it may fail.
void reserve_on_large_pages(std::string& content, std::size_t size) {
  constexpr std::size_t page = std::size_t{1} << 21U;
  content.reserve(size);
  void* begin = content.data();
  std::size_t space = content.capacity();
  if (std::align(page, page, begin, space) != nullptr) ::madvise(begin, space / page * page, MADV_HUGEPAGE);
}

std::string read_to_end(int descriptor, const struct stat& status, const std::string& file) {
  const std::size_t expected = S_ISREG(status.st_mode) ? static_cast<std::size_t>(status.st_size) : 0;
  std::string content;
  reserve_on_large_pages(content, expected + 1);
  for (std::size_t used = 0;;) {
    // One byte more than expected, so that a short read shows the end of the file without a copy.
    if (used == content.size())
      content.resize(used + (used == 0 && expected > 0 ? expected + 1 : std::size_t{1} << 16U));
    const auto got = ::read(descriptor, content.data() + used, content.size() - used);
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) fail(file, errno);
    used += static_cast<std::size_t>(got);
    if (used > most_of_a_device && S_ISCHR(status.st_mode))
      fail(file, "is a device that does not end; expected a text file of columns");
    if (got > 0) continue;
    content.resize(used);
    return content;
  }
}

Text read_file(const std::string& file, const struct stat& status) {
  if (file == "-") return std::make_shared<const std::string>(read_to_end(STDIN_FILENO, status, file));
  const Descriptor descriptor(::open(file.c_str(), O_RDONLY | O_CLOEXEC));
  if (descriptor.number() < 0) fail(file, errno);
  return std::make_shared<const std::string>(read_to_end(descriptor.number(), status, file));
}

}  // namespace

Text input_text(const std::string& file) {
  struct stat status {};
  if ((file == "-" ? ::fstat(STDIN_FILENO, &status) : ::stat(file.c_str(), &status)) != 0) fail(file, errno);
  if (S_ISDIR(status.st_mode)) throw DataError(file, 0, 0, "is a folder; expected a text file of columns");
  if (file != "-" && S_ISREG(status.st_mode)) return read_file(file, status);
  static std::mutex mutex;
  static std::map<Identity, Text> kept;
  const std::lock_guard guard(mutex);
  Text& text = kept[{status.st_dev, status.st_ino}];
  if (!text) text = read_file(file, status);
  return text;
}

std::vector<std::string> whole_lines(std::string_view text) {
  std::vector<std::string> lines;
  for (std::size_t begin = 0;;) {
    const auto end = text.find('\n', begin);
    if (end == std::string_view::npos) return lines;
    lines.emplace_back(text.substr(begin, end - begin));
    begin = end + 1;
  }
}

}  // namespace io
