// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <vector>

#include "backlash/basins.hpp"
#include "backlash/describing_function.hpp"
#include "backlash/orbit_continuation.hpp"
#include "backlash/regime_map.hpp"
#include "frac/cancellation.hpp"

namespace {

TEST(CancelledSweeps, EndAsCancelled) {
  const backlash::TwoMassSystem system(1, 1, 1, 0.6);
  const std::atomic<bool> flag = true;
  const frac::CancellationScope scope(flag);
  for (const auto protocol : backlash::protocols()) {
    backlash::SweepOptions options;
    options.protocol = protocol;
    EXPECT_THROW(static_cast<void>(backlash::describing_function_sweep(system, 1, {1, 2}, options)), frac::Cancelled);
  }
  EXPECT_THROW(static_cast<void>(backlash::regime_map({}, {0.5}, {1, 2})), frac::Cancelled);
  EXPECT_THROW(static_cast<void>(backlash::orbit_diagram(system, 1, 1.9, 2.2)), frac::Cancelled);
  EXPECT_THROW(static_cast<void>(backlash::basins(system, 1, 1.6, {0.5}, {0})), frac::Cancelled);
}

}  // namespace
