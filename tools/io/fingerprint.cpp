// SPDX-License-Identifier: BSD-3-Clause
#include "io/fingerprint.hpp"

namespace io {

void Fingerprint::add(std::string_view part) {
  constexpr std::uint64_t prime = 0x100000001b3U;
  std::uint64_t hash = hash_;
  for (const char c : part) hash = (hash ^ static_cast<unsigned char>(c)) * prime;
  hash_ = hash;
  size_ += part.size();
}

std::string Fingerprint::text() const {
  std::string digits;
  for (int shift = 60; shift >= 0; shift -= 4)
    digits += "0123456789abcdef"[(hash_ >> static_cast<unsigned>(shift)) & 15U];
  return std::to_string(size_) + "-" + digits;
}

}  // namespace io
