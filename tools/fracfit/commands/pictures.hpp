// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "options/command.hpp"
#include "report/figure.hpp"

namespace fracfit {

/// Scripts, SVG and PNG into the folder of --pictures.
/// @return false with a message where gnuplot is missing or fails.
[[nodiscard]] bool draw_pictures(const Command& command, const std::string& folder,
                                 const std::vector<report::Figure>& figures);

/// @throws std::invalid_argument  it cannot be made.
void make_picture_folder(const std::string& path);

}  // namespace fracfit
