// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <list>

namespace io {

/// Makes SIGINT, SIGTERM and SIGHUP run the actions of all living CleanUp objects before they end the program.  To be
/// called once, before other threads start: they inherit the signal mask.  A signal that is ignored stays ignored.
/// If the system grants no further thread, signals end the program without cleaning.
void clean_up_on_signals();

/// Runs the actions of all living CleanUp objects and ends the program with this exit code, whatever its other threads
/// are doing.
[[noreturn]] void end_at_once(int code);

/// An action for the case that the program is ended while the object lives, such as removing a file under construction.
/// Actions run in reverse order of construction, in a thread of their own, and must not throw.
class CleanUp {
 public:
  explicit CleanUp(std::function<void()> action);
  ~CleanUp();
  CleanUp(const CleanUp&) = delete;
  CleanUp& operator=(const CleanUp&) = delete;

 private:
  std::list<std::function<void()>>::iterator place_;
};

/// Runs the body such that a signal waits for its end.
void uninterrupted(const std::function<void()>& body);

}  // namespace io
