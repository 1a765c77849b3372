// SPDX-License-Identifier: BSD-3-Clause
#include "run.hpp"

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <exception>
#include <mutex>
#include <thread>

#include "frac/cancellation.hpp"

namespace python {
namespace {

namespace py = pybind11;
using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;

constexpr auto between_looks = 20ms;
constexpr auto between_reports = 100ms;

// What a caller who draws a bar is told, whenever it has changed.
class Reporter {
 public:
  Reporter(const py::object& report, const frac::Progress& progress) : report_(report), progress_(progress) {}

  void tell(bool at_once) {
    const std::size_t total = progress_.total, done = progress_.done;
    const Clock::time_point now = Clock::now();
    if (report_.is_none() || total == 0 || (done == told_ && total == told_total_)) return;
    if (!at_once && now - last_ < between_reports) return;
    last_ = now;
    told_ = done;
    told_total_ = total;
    report_(done, total);
  }

 private:
  const py::object& report_;
  const frac::Progress& progress_;
  Clock::time_point last_ = Clock::now();
  std::size_t told_ = 0, told_total_ = 0;
};

}  // namespace

void run(const std::function<void(frac::Progress&)>& work, const py::object& report) {
  std::atomic<bool> cancelled = false;
  frac::Progress progress;
  Reporter reporter(report, progress);
  std::mutex mutex;
  std::condition_variable ended;
  bool has_ended = false;
  std::exception_ptr failure, interruption;
  {
    const py::gil_scoped_release without_lock;
    std::thread worker([&] {
      try {
        const frac::CancellationScope scope(cancelled);
        work(progress);
      } catch (...) {
        failure = std::current_exception();
      }
      const std::lock_guard lock(mutex);
      has_ended = true;
      ended.notify_one();
    });
    std::unique_lock lock(mutex);
    while (!ended.wait_for(lock, between_looks, [&] { return has_ended; })) {
      if (interruption) continue;
      lock.unlock();
      {
        const py::gil_scoped_acquire with_lock;
        try {
          if (PyErr_CheckSignals() != 0) throw py::error_already_set();
          reporter.tell(false);
        } catch (...) {
          interruption = std::current_exception();
          cancelled = true;
        }
      }
      lock.lock();
    }
    lock.unlock();
    worker.join();
  }
  if (interruption) std::rethrow_exception(interruption);
  if (failure) std::rethrow_exception(failure);
  reporter.tell(true);
}

}  // namespace python
