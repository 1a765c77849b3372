// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>

#include "c_text.hpp"
#include "fixed_point_operator.hpp"
#include "frac/digital/fixed_point.hpp"

/// The C text of filters in whole numbers.
namespace frac::detail::fixed_point {

/// @throws std::invalid_argument  a range that is not positive and finite
void check(const FixedPointRanges& ranges);

/// A number as an operand.
[[nodiscard]] std::string in_brackets(std::int64_t number);

/// What the C text needs of an operator, under its prefix in capitals or as PREFIX.
void describe(const Operator& from, const std::string& prefix, CWords& words, CConditions& conditions);

/// Arrays and functions of taps and sections.
/// @param tap_bits  input of the taps over what they give, in bits, and 30
[[nodiscard]] std::string functions_of(const Operator& from, const CText& c, const std::string& name,
                                       const std::string& prefix, int tap_bits);
[[nodiscard]] std::string pair_arrays(const Operator& from, const std::string& name);

/// The sum of direct term and sections for an input of that name.
[[nodiscard]] std::string output_of(const Operator& from, const std::string& name, const std::string& prefix,
                                    const std::string& input);

/// The options with a comment that states ranges and error.
[[nodiscard]] CHeaderOptions described(const CHeaderOptions& options, const FixedPointRanges& ranges,
                                       const FixedPointHeader& header);

}  // namespace frac::detail::fixed_point
