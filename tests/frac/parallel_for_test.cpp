// SPDX-License-Identifier: BSD-3-Clause
#include "frac/parallel_for.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "support/expect_invalid_argument.hpp"

namespace {

class ParallelForOnThreads : public testing::TestWithParam<int> {};

TEST_P(ParallelForOnThreads, RunsEachIndexOnce) {
  for (const std::size_t count : {0u, 1u, 2u, 1000u}) {
    std::vector<std::atomic<int>> calls(count);
    frac::parallel_for(count, GetParam(), [&](std::size_t i) { ++calls[i]; });
    for (const auto& each : calls) EXPECT_EQ(each, 1);
  }
}

// 20 is the lowest of the indices that fail, but waits so that others fail before it where there are other threads.
TEST_P(ParallelForOnThreads, RethrowsTheFailureOfTheLowestIndex) {
  const auto body = [](std::size_t i) {
    if (i == 20) std::this_thread::sleep_for(std::chrono::milliseconds(20));
    if (i >= 20) throw std::runtime_error(std::to_string(i));
  };
  try {
    frac::parallel_for(100, GetParam(), body);
    FAIL() << "nothing was thrown";
  } catch (const std::runtime_error& error) {
    EXPECT_STREQ(error.what(), "20");
  }
}

TEST_P(ParallelForOnThreads, BeginsNothingAfterAFailure) {
  std::atomic<std::size_t> calls = 0;
  const auto body = [&](std::size_t) {
    ++calls;
    throw std::runtime_error("at once");
  };
  EXPECT_THROW(frac::parallel_for(100'000, GetParam(), body), std::runtime_error);
  // Each thread can have begun one index when the first failure is recorded.
  EXPECT_LE(calls, 2 * std::max(std::thread::hardware_concurrency(), 7u));
}

INSTANTIATE_TEST_SUITE_P(ThreadCounts, ParallelForOnThreads, testing::Values(0, 1, 2, 7));

TEST(ParallelFor, UsesAsManyThreadsAsAskedFor) {
  // Each index waits for the others, which only ends when three run at the same time.
  std::atomic<int> running = 0;
  frac::parallel_for(3, 3, [&](std::size_t) {
    ++running;
    const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(20);
    while (running < 3 && std::chrono::steady_clock::now() < deadline) std::this_thread::yield();
    EXPECT_EQ(running, 3);
  });
}

TEST(ParallelFor, RefusesANegativeNumberOfThreads) {
  support::expect_invalid_argument([] { frac::parallel_for(1, -1, [](std::size_t) {}); }, {"threads = -1"});
}

}  // namespace
