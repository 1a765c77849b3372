// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <string>

#include "io/descriptor.hpp"

namespace io {

/// A file that is open for reading from any place; "-" is standard input.  What can be read only once, such as a pipe,
/// is kept in memory.
/// @throws DataError  missing, a folder, or unreadable.
[[nodiscard]] Descriptor readable(const std::string& file);

/// Lets so many files stay open at once, as far as the system allows.
void allow_open_files(std::size_t count);

/// Bytes of an open file from a place on, so many or as many as there are.
/// @param path  of the file, for messages
/// @throws std::runtime_error  it cannot be read.
[[nodiscard]] std::string bytes_at(int descriptor, std::size_t begin, std::size_t most, const std::string& path);

/// `size` bytes of an open file, from the byte `begin` on.
/// @param path  of the file, for messages
/// @throws std::runtime_error  it cannot be read, or ends before.
[[nodiscard]] std::string read_at(int descriptor, std::size_t begin, std::size_t size, const std::string& path);

}  // namespace io
