// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <boost/multiprecision/cpp_bin_float.hpp>
#include <cstddef>
#include <vector>

namespace frac::detail {

/// Digits enough for the inverse differences of 121 points, which lose two thirds of a digit each, and for roots over
/// tens of decades of polynomials in powers of s.
using Multiprecision =
    boost::multiprecision::number<boost::multiprecision::cpp_bin_float<150>, boost::multiprecision::et_off>;

/// Coefficients of powers of s, rising.
using Polynomial = std::vector<Multiprecision>;

}  // namespace frac::detail
