// SPDX-License-Identifier: BSD-3-Clause
#include "frac/parallel_for.hpp"

#include <algorithm>
#include <exception>
#include <mutex>
#include <stdexcept>
#include <string>
#include <system_error>
#include <thread>
#include <vector>

#include "frac/cancellation.hpp"

namespace frac {
namespace {

// Keeps the failure that a serial loop would have met first.
class LowestFailure {
 public:
  void record(std::size_t index, std::exception_ptr failure) {
    const std::lock_guard lock(mutex_);
    if (!failure_ || index < index_) {
      index_ = index;
      failure_ = std::move(failure);
    }
  }
  void rethrow_if_any() const {
    if (failure_) std::rethrow_exception(failure_);
  }

 private:
  std::mutex mutex_;
  std::size_t index_ = 0;
  std::exception_ptr failure_;
};

}  // namespace

void parallel_for(std::size_t count, int threads, const std::function<void(std::size_t)>& body) {
  if (threads < 0) {
    throw std::invalid_argument("parallel_for: threads = " + std::to_string(threads) +
                                " is negative; allowed are 0 (one per core) and more");
  }
  const std::size_t wanted =
      threads > 0 ? static_cast<std::size_t>(threads) : std::max<std::size_t>(1, std::thread::hardware_concurrency());
  LowestFailure failure;
  std::atomic<std::size_t> next = 0;
  const auto work = [&, flag = cancellation_flag()] {
    const CancellationScope scope(flag);
    for (std::size_t i = next.fetch_add(1); i < count; i = next.fetch_add(1)) {
      try {
        throw_if_cancelled();
        body(i);
      } catch (...) {
        failure.record(i, std::current_exception());
        next = count;  // indices are handed out in order: all below i have run or are running
      }
    }
  };
  {
    // The calling thread works too.  Where the system grants fewer threads than asked for, those granted do all the
    // work.
    std::vector<std::jthread> helpers;
    const std::size_t helper_count = std::min(wanted, count) - std::min<std::size_t>(1, count);
    helpers.reserve(helper_count);
    try {
      while (helpers.size() < helper_count) helpers.emplace_back(work);
    } catch (const std::system_error&) {
    }
    work();
  }
  failure.rethrow_if_any();
}

}  // namespace frac
