// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

namespace io {

/// Files as given, and for each folder the files directly in it that end in .csv, .tsv, .txt, .dat or as instruments
/// name them (.dta, .mpt, .z, .par, .s1p, .unv ...), by name; hidden files and `except` are left out.
/// @throws DataError  a folder that cannot be read.
/// @throws std::invalid_argument  a folder without such files, a file met twice, a name with a line break, or "-".
[[nodiscard]] std::vector<std::string> input_files(const std::vector<std::string>& given, const std::string& except);

}  // namespace io
