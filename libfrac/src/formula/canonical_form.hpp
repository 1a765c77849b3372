// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "expression.hpp"

namespace frac::detail {

/// The expression in a notation that does not depend on the order of terms and factors, with a text in the place of
/// each parameter.  A sum is the list of its terms, each with its number in front, a product the list of its factors,
/// each with its exponent as far as that is a number; both lists are sorted.
[[nodiscard]] std::string canonical_text(const Expression& expression, std::span<const std::string> labels);

/// canonical_text() with one text in the place of all parameters: equal structures have equal shapes.
[[nodiscard]] std::string shape_of(const Expression& expression);

/// See Structure::correspondence().
[[nodiscard]] std::optional<std::vector<std::size_t>> matched_parameters(const Expression& expression,
                                                                         const Expression& other);

/// The formula as it is written, with other names for its parameters.
[[nodiscard]] std::string with_names(const Expression& expression, std::span<const std::string> names);

/// Names by their letters, then by their numbers: R2 before R10.
[[nodiscard]] bool named_before(const std::string& a, const std::string& b);

}  // namespace frac::detail
