#pragma once

#include <cstddef>

namespace io {

/// Part of a list of pieces of work: those from index - 1 on in steps of count.
struct Shard {
  std::size_t index = 1;  // 1 .. count
  std::size_t count = 1;  // 1: all
};

}  // namespace io
