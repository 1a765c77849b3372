// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <atomic>

namespace support {

/// Calls of the global operator new since the program began, of a program that links count_allocations.cpp.
extern std::atomic<long> allocations;

}  // namespace support
