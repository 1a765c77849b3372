// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <stdexcept>

namespace frac {

/// A formula that can be evaluated was asked for as a ratio of sums of powers of s, which it is not.
class NoRatio : public std::invalid_argument {
 public:
  using std::invalid_argument::invalid_argument;
};

}  // namespace frac
