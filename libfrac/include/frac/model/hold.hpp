// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace frac {

/// How an input runs between its samples.
enum class Hold {
  zero_order,   // constant until the next sample
  first_order,  // straight to the next sample
};

}  // namespace frac
