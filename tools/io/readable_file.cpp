// SPDX-License-Identifier: BSD-3-Clause
#include "io/readable_file.hpp"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <stdexcept>

#include "io/data_error.hpp"
#include "io/input_text.hpp"
#include "io/output_file.hpp"

namespace io {
Descriptor readable(const std::string& file) {
  struct stat status {};
  if (file != "-" && ::stat(file.c_str(), &status) == 0 && S_ISREG(status.st_mode)) {
    Descriptor descriptor(::open(file.c_str(), O_RDONLY | O_CLOEXEC));
    if (descriptor.number() >= 0) return descriptor;
    throw DataError(file, 0, 0, std::string("cannot be read: ") + std::strerror(errno));
  }
  Descriptor descriptor(::memfd_create("fracfit", MFD_CLOEXEC));
  if (descriptor.number() < 0) throw std::runtime_error(std::string("cannot keep an input: ") + std::strerror(errno));
  write_all(descriptor.number(), *input_text(file), file);
  return descriptor;
}

void allow_open_files(std::size_t count) {
  rlimit limit{};
  constexpr rlim_t others = 32;
  if (::getrlimit(RLIMIT_NOFILE, &limit) != 0 || limit.rlim_cur >= count + others) return;
  limit.rlim_cur = std::min<rlim_t>(limit.rlim_max, count + others);
  static_cast<void>(::setrlimit(RLIMIT_NOFILE, &limit));
}

std::string bytes_at(int descriptor, std::size_t begin, std::size_t most, const std::string& path) {
  std::string text(most, '\0');
  std::size_t done = 0;
  while (done < most) {
    const auto got = ::pread(descriptor, text.data() + done, most - done, static_cast<off_t>(begin + done));
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) throw std::runtime_error("cannot read " + path + ": " + std::strerror(errno));
    if (got == 0) break;
    done += static_cast<std::size_t>(got);
  }
  text.resize(done);
  return text;
}

std::string read_at(int descriptor, std::size_t begin, std::size_t size, const std::string& path) {
  std::string text = bytes_at(descriptor, begin, size, path);
  if (text.size() < size) throw std::runtime_error("cannot read " + path + ": another program has cut it");
  return text;
}

}  // namespace io
