// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <atomic>
#include <exception>

namespace frac {

/// Thrown by a computation that was cancelled.  Its results so far are lost.  No runtime_error, so that code which
/// turns failures into remarks lets it pass.
class Cancelled : public std::exception {
 public:
  [[nodiscard]] const char* what() const noexcept override { return "the computation was cancelled"; }
};

/// While it lives, the computations of this thread, and of the threads that parallel_for() starts for them, watch
/// `flag`: once another thread or a signal handler has set it, a long one throws Cancelled, usually within a few
/// milliseconds, after all threads it started have ended.  A short one may return as if nothing had happened.  The
/// flag outlives the scope.  Of several scopes in a thread the innermost counts.
class CancellationScope {
 public:
  explicit CancellationScope(const std::atomic<bool>& flag) noexcept : CancellationScope(&flag) {}
  /// With the flag that another thread watches; none if null, for a stretch through which nothing may be thrown.
  explicit CancellationScope(const std::atomic<bool>* flag) noexcept;
  ~CancellationScope();
  CancellationScope(const CancellationScope&) = delete;
  CancellationScope& operator=(const CancellationScope&) = delete;

 private:
  const std::atomic<bool>* outer_;
};

/// The flag this thread watches; null outside of all scopes.
[[nodiscard]] const std::atomic<bool>* cancellation_flag() noexcept;

/// Whether it is set: for code that cannot throw, such as the callbacks of a solver in C.
[[nodiscard]] bool is_cancelled() noexcept;

/// For every turn of a loop that takes microseconds or more; costs some nanoseconds.
/// @throws Cancelled  the flag is set.
void throw_if_cancelled();

}  // namespace frac
