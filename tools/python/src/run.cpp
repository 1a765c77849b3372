// SPDX-License-Identifier: BSD-3-Clause
#include "run.hpp"

#include <pthread.h>

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <exception>
#include <mutex>
#include <thread>
#include <utility>
#include <vector>

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

// Work for a thread of `Workers`.
struct Job {
  std::function<void()> work;
  std::condition_variable ended;
  bool has_ended = false;
  std::exception_ptr failure;
};

// Threads that stay for a moment after their work: starting one takes longer than a small fit.
class Workers {
 public:
  // Never destroyed, as a thread may still wait when the process ends.
  static Workers& all() {
    static auto* const workers = new Workers;
    return *workers;
  }

  void start(Job& job) {
    const std::lock_guard lock(mutex_);
    if (idle_.empty()) {
      std::thread([this, &job] { serve(job); }).detach();
      return;
    }
    Seat& seat = *idle_.back();
    idle_.pop_back();
    seat.job = &job;
    seat.called.notify_one();
  }

  // True once the job has ended, false after a time without that.
  bool wait(Job& job, std::chrono::milliseconds time) {
    std::unique_lock lock(mutex_);
    return job.ended.wait_for(lock, time, [&] { return job.has_ended; });
  }

 private:
  // Where a thread without work waits.
  struct Seat {
    std::condition_variable called;
    Job* job = nullptr;
  };
  static constexpr auto patience = 50ms;

  // The child of a fork has none of these threads.
  Workers() {
    ::pthread_atfork([] { all().mutex_.lock(); }, [] { all().mutex_.unlock(); },
                     [] {
                       all().idle_.clear();
                       all().mutex_.unlock();
                     });
  }

  void serve(Job& first) {
    Seat seat;
    for (Job* job = &first; job != nullptr; job = std::exchange(seat.job, nullptr)) {
      try {
        job->work();
      } catch (...) {
        job->failure = std::current_exception();
      }
      std::unique_lock lock(mutex_);
      // Before the caller goes on, so that its next job finds this thread.
      idle_.push_back(&seat);
      job->has_ended = true;
      job->ended.notify_one();
      if (!seat.called.wait_for(lock, patience, [&] { return seat.job != nullptr; })) std::erase(idle_, &seat);
    }
  }

  std::mutex mutex_;
  std::vector<Seat*> idle_;
};

}  // namespace

void run(const std::function<void(frac::Progress&)>& work, const py::object& report) {
  std::atomic<bool> cancelled = false;
  frac::Progress progress;
  Reporter reporter(report, progress);
  std::exception_ptr interruption;
  Job job;
  job.work = [&] {
    const frac::CancellationScope scope(cancelled);
    work(progress);
  };
  {
    const py::gil_scoped_release without_lock;
    Workers& workers = Workers::all();
    workers.start(job);
    while (!workers.wait(job, between_looks)) {
      if (interruption) continue;
      const py::gil_scoped_acquire with_lock;
      try {
        if (PyErr_CheckSignals() != 0) throw py::error_already_set();
        reporter.tell(false);
      } catch (...) {
        interruption = std::current_exception();
        cancelled = true;
      }
    }
  }
  if (interruption) std::rethrow_exception(interruption);
  if (job.failure) std::rethrow_exception(job.failure);
  reporter.tell(true);
}

}  // namespace python
