// SPDX-License-Identifier: BSD-3-Clause
#include "io/progress_bar.hpp"

#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstdio>
#include <mutex>
#include <new>
#include <stop_token>
#include <system_error>
#include <utility>

namespace io {
namespace {

using Clock = std::chrono::steady_clock;

std::atomic<int> bars = 0;  // that are shown

struct State {
  std::size_t done, total;
  double seconds;  // since the beginning

  [[nodiscard]] double share() const { return static_cast<double>(done) / static_cast<double>(total); }
  [[nodiscard]] double rate() const { return static_cast<double>(done) / seconds; }
  [[nodiscard]] double seconds_left() const { return seconds * (1 - share()) / share(); }
};

void draw(const std::string& label, const State& state) {
  constexpr int width = 30;
  const int filled = static_cast<int>(state.share() * width);
  std::string bar(static_cast<std::size_t>(filled), '#');
  bar.resize(width, '.');
  std::string left;
  // Shows no remaining time before 2 % are done, because the estimate would jump.
  if (state.share() >= 0.02) {
    char text[64];
    std::snprintf(text, sizeof text, ", %.3g/s, %.0f s left", state.rate(), state.seconds_left());
    left = text;
  }
  std::fprintf(stderr, "\r\033[K%s [%s] %3.0f %%%s", label.c_str(), bar.c_str(), 100 * state.share(), left.c_str());
  std::fflush(stderr);
}

void write_line(const std::string& label, const State& state) {
  char left[32] = "null";
  if (state.done > 0) std::snprintf(left, sizeof left, "%.3f", state.seconds_left());
  std::fprintf(stderr,
               R"({"progress":"%s","done":%zu,"total":%zu,"seconds":%.3f,"per_second":%.6g,"seconds_left":%s})"
               "\n",
               label.c_str(), state.done, state.total, state.seconds, state.rate(), left);
  std::fflush(stderr);
}

void watch(const std::stop_token& stop, const std::string& label, const frac::Progress& progress, ProgressStyle style,
           int place) {
  using std::chrono::milliseconds;
  const milliseconds pause(style == ProgressStyle::bar ? 100 : 1000);
  std::mutex mutex;
  std::condition_variable_any wakeup;
  std::unique_lock lock(mutex);
  const auto begin = Clock::now();
  const auto state = [&] {
    const std::size_t total = progress.total.load();
    return State{std::min(progress.done.load(), total), total,
                 std::chrono::duration<double>(Clock::now() - begin).count()};
  };
  bool shown = false;
  while (!wakeup.wait_for(lock, stop, pause, [&] { return stop.stop_requested(); })) {
    if (bars > place) continue;
    if (progress.total.load() == 0) {
      constexpr double soon = 2;  // s
      const double seconds = state().seconds;
      if (style != ProgressStyle::bar || seconds < soon) continue;
      std::fprintf(stderr, "\r\033[K%s: at work for %.0f s", label.c_str(), seconds);
      std::fflush(stderr);
      shown = true;
      continue;
    }
    (style == ProgressStyle::bar ? draw : write_line)(label, state());
    shown = true;
  }
  if (style == ProgressStyle::bar && shown) std::fputs("\r\033[K", stderr);
  if (style == ProgressStyle::lines && progress.total.load() > 0) write_line(label, state());
}

}  // namespace

ProgressBar::ProgressBar(std::string label, const frac::Progress& progress, ProgressStyle style) {
  if (style == ProgressStyle::none || (style == ProgressStyle::bar && ::isatty(STDERR_FILENO) == 0)) return;
  try {
    thread_ = std::jthread([label = std::move(label), &progress, style, place = bars + 1](const std::stop_token& stop) {
      try {
        watch(stop, label, progress, style, place);
      } catch (const std::bad_alloc&) {  // the work goes on without a picture of it
      }
    });
    ++bars;
  } catch (const std::system_error&) {  // no further thread is to be had
  }
}

ProgressBar::~ProgressBar() {
  if (!thread_.joinable()) return;
  thread_.request_stop();
  thread_.join();
  --bars;
}

}  // namespace io
