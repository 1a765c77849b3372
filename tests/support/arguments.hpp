// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string>
#include <vector>

namespace support {

/// Arguments of a benchmark: flags that begin with --, and whole numbers.
class Arguments {
 public:
  Arguments(int argc, char** argv) {
    for (int i = 1; i < argc; ++i) {
      const std::string text = argv[i];
      if (text.starts_with("--"))
        flags_.push_back(text);
      else
        numbers_.push_back(std::strtoull(argv[i], nullptr, 10));
    }
  }
  [[nodiscard]] bool has(const std::string& flag) const {
    return std::find(flags_.begin(), flags_.end(), flag) != flags_.end();
  }
  [[nodiscard]] std::uint64_t number(std::size_t i, std::uint64_t otherwise) const {
    return i < numbers_.size() ? numbers_[i] : otherwise;
  }

 private:
  std::vector<std::string> flags_;
  std::vector<std::uint64_t> numbers_;
};

}  // namespace support
