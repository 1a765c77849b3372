// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "frac/digital/digital_filter.hpp"
#include "frac/digital/fractional_pid.hpp"

namespace fracfit {

// JSON texts; a number that is not finite is written as null.
[[nodiscard]] std::string controller_json(const frac::FractionalPidDesign& design, const std::string& command);
[[nodiscard]] std::string filter_json(const frac::DigitalFilterDesign& design, const std::string& model, double error,
                                      const std::string& command);
/// For people: what is asked, what it takes, what it leaves.
[[nodiscard]] std::string controller_table(const frac::FractionalPidDesign& design);
[[nodiscard]] std::string filter_table(const frac::DigitalFilterDesign& design, const std::string& model, double error);
/// What stands at the head of the C code.
[[nodiscard]] std::string controller_comment(const frac::FractionalPidDesign& design, const std::string& command);
[[nodiscard]] std::string filter_comment(const frac::DigitalFilterDesign& design, const std::string& model,
                                         const std::string& command);

}  // namespace fracfit
