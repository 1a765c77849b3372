// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>

namespace support {

/// What a simulator gives to a functional mock-up unit, fmi2CallbackFunctions as the standard FMI 2.0 words it, apart
/// from the header that units carry.
struct Fmi2Callbacks {
  void (*logger)(void*, const char*, int, const char*, const char*, ...);
  void* (*allocate)(std::size_t, std::size_t);
  void (*release)(void*);
  void (*finished)(void*, int);
  void* environment;
};

}  // namespace support
