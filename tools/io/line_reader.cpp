// SPDX-License-Identifier: BSD-3-Clause
#include "io/line_reader.hpp"

#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <stdexcept>

namespace io {

// Drops what was given and reads on behind the rest; false at the end of the file.
bool FileLines::read_more() {
  buffer_.erase(0, at_);
  begin_ += at_;
  at_ = 0;
  const std::size_t rest = buffer_.size();
  buffer_.resize(rest + wanted_);
  for (;;) {
    const auto got = ::pread(descriptor_, buffer_.data() + rest, wanted_, static_cast<off_t>(begin_ + rest));
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) throw std::runtime_error("cannot read " + path_ + ": " + std::strerror(errno));
    buffer_.resize(rest + static_cast<std::size_t>(got));
    return got > 0;
  }
}

std::optional<std::string_view> FileLines::next() {
  for (std::size_t searched = at_;;) {
    const auto end = buffer_.find(end_, searched);
    if (end != std::string::npos) {
      const std::string_view line = std::string_view(buffer_).substr(at_, end - at_);
      at_ = end + 1;
      return line;
    }
    searched = buffer_.size() - at_;
    if (!read_more()) return std::nullopt;
  }
}

}  // namespace io
