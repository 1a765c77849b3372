// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string_view>
#include <utility>

#include "expression.hpp"

namespace frac::detail {

/// Functions of a formula as they are spelled; of two spellings the first is the one that is written.
constexpr std::pair<std::string_view, Operation> function_names[] = {
    {"exp", Operation::exp},   {"sqrt", Operation::sqrt}, {"tanh", Operation::tanh},
    {"coth", Operation::coth}, {"sinh", Operation::sinh}, {"cosh", Operation::cosh},
    {"sech", Operation::sech}, {"log", Operation::log},   {"ln", Operation::log}};

}  // namespace frac::detail
