// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "report/figure.hpp"

namespace report {

/// A picture in a file of its own, beside the result of a command.
class PictureFile {
 public:
  /// @param path  ends in .svg or .png
  /// @param inputs  files that it must not replace
  /// @throws std::invalid_argument  another ending, no gnuplot, or as io::OutputFile; before any work
  PictureFile(std::filesystem::path path, const std::vector<std::string>& inputs);

  /// Draws figure and writes the file whole or not at all.
  /// @throws std::runtime_error  gnuplot failed or the disk is full
  void write(Figure figure) const;

 private:
  std::filesystem::path path_, gnuplot_;
  std::vector<std::string> inputs_;
};

}  // namespace report
