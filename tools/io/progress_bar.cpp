// SPDX-License-Identifier: BSD-3-Clause
#include "io/progress_bar.hpp"

#include <unistd.h>

#include <algorithm>
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

void draw(const std::string& label, double share, double elapsed_seconds) {
  constexpr int width = 30;
  const int filled = static_cast<int>(share * width);
  std::string bar(static_cast<std::size_t>(filled), '#');
  bar.resize(width, '.');
  std::string left;
  // Shows no remaining time before 2 % are done, because the estimate would jump.
  if (share >= 0.02) {
    char text[32];
    std::snprintf(text, sizeof text, ", %.0f s left", elapsed_seconds * (1 - share) / share);
    left = text;
  }
  std::fprintf(stderr, "\r\033[K%s [%s] %3.0f %%%s", label.c_str(), bar.c_str(), 100 * share, left.c_str());
  std::fflush(stderr);
}

void watch(const std::stop_token& stop, const std::string& label, const frac::Progress& progress) {
  constexpr std::chrono::milliseconds pause(100);
  std::mutex mutex;
  std::condition_variable_any wakeup;
  std::unique_lock lock(mutex);
  const auto begin = Clock::now();
  bool drawn = false;
  while (!wakeup.wait_for(lock, stop, pause, [&] { return stop.stop_requested(); })) {
    const auto total = progress.total.load();
    if (total == 0) continue;
    const double share = static_cast<double>(std::min(progress.done.load(), total)) / static_cast<double>(total);
    draw(label, share, std::chrono::duration<double>(Clock::now() - begin).count());
    drawn = true;
  }
  if (drawn) std::fputs("\r\033[K", stderr);
}

}  // namespace

ProgressBar::ProgressBar(std::string label, const frac::Progress& progress, bool wanted) {
  if (!wanted || ::isatty(STDERR_FILENO) == 0) return;
  try {
    thread_ = std::jthread([label = std::move(label), &progress](const std::stop_token& stop) {
      try {
        watch(stop, label, progress);
      } catch (const std::bad_alloc&) {  // the work goes on without a picture of it
      }
    });
  } catch (const std::system_error&) {  // no further thread is to be had
  }
}

}  // namespace io
