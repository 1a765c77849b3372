// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <string_view>

#include "report/figure.hpp"

namespace report {

/// The data that the script of the page draws a picture from, as JSON that can stand inside a script element.
[[nodiscard]] std::string figure_data(const Figure& figure);

/// The script that makes pictures answer, page/figures.js.
[[nodiscard]] std::string_view figure_script();

}  // namespace report
