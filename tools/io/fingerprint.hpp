// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

namespace io {

/// Size and hash of 64 bits of a text that comes in parts, however it is cut: equal for equal texts, and different for
/// texts that differ by accident.
class Fingerprint {
 public:
  explicit Fingerprint(std::string_view text = {}) { add(text); }
  void add(std::string_view part);
  /// "<bytes>-<16 hexadecimal digits>" of all parts so far.
  [[nodiscard]] std::string text() const;

 private:
  std::uint64_t hash_ = 0xcbf29ce484222325U;
  std::uint64_t word_ = 0;  // the bytes since the last whole eight, the first one lowest
  std::size_t size_ = 0;
};

}  // namespace io
