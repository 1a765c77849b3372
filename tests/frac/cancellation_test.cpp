// SPDX-License-Identifier: BSD-3-Clause
#include "frac/cancellation.hpp"

#include <gtest/gtest.h>

#include <vector>

#include "frac/mittag_leffler.hpp"
#include "frac/parallel_for.hpp"
#include "frac/time_response/reference_response.hpp"

namespace {

TEST(Cancellation, ThrowsNothingOutsideOfScopesAndBeforeTheFlagIsSet) {
  EXPECT_EQ(frac::cancellation_flag(), nullptr);
  frac::throw_if_cancelled();
  std::atomic<bool> flag = false;
  const frac::CancellationScope scope(flag);
  frac::throw_if_cancelled();
  flag = true;
  EXPECT_TRUE(frac::is_cancelled());
  EXPECT_THROW(frac::throw_if_cancelled(), frac::Cancelled);
}

TEST(Cancellation, TheInnermostScopeCountsAndTheOuterOneReturns) {
  std::atomic<bool> outer = true, inner = false;
  const frac::CancellationScope outer_scope(outer);
  {
    const frac::CancellationScope inner_scope(inner);
    EXPECT_FALSE(frac::is_cancelled());
  }
  EXPECT_TRUE(frac::is_cancelled());
}

// The flag is set by the body of index 10 of 10 000: what has begun ends, nothing more begins.
TEST(Cancellation, ReachesTheThreadsOfParallelFor) {
  std::atomic<bool> flag = false;
  std::atomic<int> bodies = 0, unwatched = 0;
  const frac::CancellationScope scope(flag);
  const auto body = [&](std::size_t i) {
    ++bodies;
    if (frac::cancellation_flag() != &flag) ++unwatched;
    if (i == 10) flag = true;
  };
  EXPECT_THROW(frac::parallel_for(10'000, 4, body), frac::Cancelled);
  EXPECT_EQ(unwatched, 0);
  // Indices 0 to 10, and at most the ones that three other threads were given before they saw the flag; a thread may
  // be given several while the body of index 10 is being begun, but not as many as are left.
  EXPECT_LT(bodies, 10'000);
}

TEST(Cancellation, EndsTableFunctions) {
  const std::atomic<bool> flag = true;
  const frac::CancellationScope scope(flag);
  const std::vector<double> t{1, 2, 3};
  EXPECT_THROW(static_cast<void>(frac::mittag_leffler(0.5, 1, t)), frac::Cancelled);
  const auto model = frac::FractionalTransferFunction::parse("1/(s^0.5 + 1)");
  EXPECT_THROW(static_cast<void>(frac::reference_response(model, {}, t)), frac::Cancelled);
}

}  // namespace
