// SPDX-License-Identifier: BSD-3-Clause
#include "io/termination.hpp"

#include <pthread.h>

#include <csignal>
#include <cstdlib>
#include <mutex>
#include <system_error>
#include <thread>
#include <utility>

namespace io {
namespace {

struct Registry {
  // Recursive, as an uninterrupted body may construct CleanUp objects.
  std::recursive_mutex mutex;
  std::list<std::function<void()>> actions;
};

// Never destroyed: the thread that waits for signals outlives main().
Registry& registry() {
  static auto* const only = new Registry;
  return *only;
}

sigset_t ending_signals() {
  sigset_t set;
  sigemptyset(&set);
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
    struct sigaction present {};
    if (sigaction(signal, nullptr, &present) == 0 && present.sa_handler != SIG_IGN) sigaddset(&set, signal);
  }
  return set;
}

[[noreturn]] void end_by(int signal) {
  std::signal(signal, SIG_DFL);
  sigset_t set;
  sigemptyset(&set);
  sigaddset(&set, signal);
  pthread_sigmask(SIG_UNBLOCK, &set, nullptr);
  static_cast<void>(std::raise(signal));
  std::abort();
}

void clean_up() {
  Registry& all = registry();
  // Keeps the lock until the program ends, so that nothing is created after the cleaning.
  all.mutex.lock();
  for (auto action = all.actions.rbegin(); action != all.actions.rend(); ++action) (*action)();
}

void wait_for_signal(const sigset_t& set) {
  int signal = 0;
  if (sigwait(&set, &signal) != 0) return;
  clean_up();
  end_by(signal);
}

}  // namespace

void end_at_once(int code) {
  clean_up();
  std::_Exit(code);
}

void clean_up_on_signals() {
  const sigset_t set = ending_signals();
  sigset_t before;
  static_cast<void>(registry());
  if (pthread_sigmask(SIG_BLOCK, &set, &before) != 0) return;
  try {
    std::thread(wait_for_signal, set).detach();
  } catch (const std::system_error&) {
    pthread_sigmask(SIG_SETMASK, &before, nullptr);
  }
}

CleanUp::CleanUp(std::function<void()> action) {
  Registry& all = registry();
  const std::lock_guard guard(all.mutex);
  place_ = all.actions.insert(all.actions.end(), std::move(action));
}

CleanUp::~CleanUp() {
  Registry& all = registry();
  const std::lock_guard guard(all.mutex);
  all.actions.erase(place_);
}

void uninterrupted(const std::function<void()>& body) {
  const std::lock_guard guard(registry().mutex);
  body();
}

}  // namespace io
