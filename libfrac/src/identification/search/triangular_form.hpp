// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>

namespace frac::detail {

/// The upper triangle R, row by row with zeros below, of (width + 1) x (width + 1) entries, with
/// ||residual + jacobian x|| = ||R (x, 1)|| for every x: all that least squares needs to know of any number of rows.
/// The Jacobian comes column by column.  The last column of R holds the residual's components within the column space
/// and, at the end, the length of the rest. By Householder reflections of blocks of rows, so that no squares of the
/// condition arise.
void triangular_form(std::span<const double> jacobian, std::span<const double> residual, std::span<double> triangle);

}  // namespace frac::detail
