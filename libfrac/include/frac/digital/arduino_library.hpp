// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "frac/digital/c_header.hpp"

namespace frac {

/// A file of a folder, path from the folder on.
struct NamedText {
  std::string path;
  std::string text;
};

/// Files of an Arduino library: library.properties, keywords.txt, the C header in src/ and a sketch in examples/ that
/// calls it at its sample time.
/// @throws std::invalid_argument  as c_header(); a sample time that is not between 1 microsecond and 2000 s, which is
/// how far the microseconds of a board count.
[[nodiscard]] std::vector<NamedText> arduino_library(const FractionalPidDesign& design, const CHeaderOptions& options);
[[nodiscard]] std::vector<NamedText> arduino_library(const DigitalFilterDesign& design, const CHeaderOptions& options);

}  // namespace frac
