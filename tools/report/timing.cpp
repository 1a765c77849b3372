// SPDX-License-Identifier: BSD-3-Clause
#include "report/timing.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <ctime>

namespace report {
namespace {

// Processor time of the calling thread, s.
double processor_time() {
  timespec now{};
  ::clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

double seconds_of(const std::function<void()>& call, std::size_t count) {
  const double start = processor_time();
  for (std::size_t i = 0; i < count; ++i) call();
  return processor_time() - start;
}

}  // namespace

double median_seconds(const std::function<void()>& call) {
  constexpr double long_enough = 1e-3;
  constexpr std::size_t most = 1'000'000;
  std::size_t inner = 1;
  double elapsed = seconds_of(call, inner);
  while (elapsed < long_enough && inner <= most) {
    inner *=
        elapsed > 0 ? std::clamp<std::size_t>(static_cast<std::size_t>(long_enough / elapsed * 1.5), 2, 1000) : 1000;
    elapsed = seconds_of(call, inner);
  }
  std::array<double, 3> times{elapsed, seconds_of(call, inner), seconds_of(call, inner)};
  std::sort(times.begin(), times.end());
  return times[1] / static_cast<double>(inner);
}

}  // namespace report
