// SPDX-License-Identifier: BSD-3-Clause
// Preloaded into fracfit, makes one of its calls that write files fail.  The calls counted are opening a file to write,
// write, fchmod, ftruncate, close, linkat, rename and mkdir; standard streams are left alone.
//
// FRACFIT_FAULT      KIND@N: the N-th of these calls, from 1.  KIND is ENOSPC, EIO or EDQUOT (the call fails so, on
// every
//                    later write too), short (write takes half), EINTR (interrupted once), or kill (SIGKILL, after half
//                    of a write).
//                    threads@N: from the N-th thread on that the program asks for it gets none (EAGAIN).
// FRACFIT_FAULT_LOG  a file made when the fault happens
// FRACFIT_NAMED      if set, files without a name are not to be had, as on some file systems
#include <dlfcn.h>
#include <fcntl.h>
#include <pthread.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <atomic>
#include <bitset>
#include <cerrno>
#include <csignal>
#include <cstdarg>
#include <cstdlib>
#include <cstring>
#include <string_view>

namespace {

enum class Kind { none, error, partial, interrupt, kill, threads };

struct Plan {
  Kind kind = Kind::none;
  int error = 0;
  long call = 0;
};

Plan plan_of_environment() {
  const char* const text = std::getenv("FRACFIT_FAULT");
  // Programs that fracfit starts are spared.
  if (text == nullptr || std::string_view(program_invocation_short_name) != "fracfit") return {};
  const std::string_view whole(text);
  const std::string_view kind = whole.substr(0, whole.find('@'));
  const long call = std::atol(text + kind.size() + 1);
  if (kind == "ENOSPC") return {Kind::error, ENOSPC, call};
  if (kind == "EIO") return {Kind::error, EIO, call};
  if (kind == "EDQUOT") return {Kind::error, EDQUOT, call};
  if (kind == "short") return {Kind::partial, 0, call};
  if (kind == "threads") return {Kind::threads, EAGAIN, call};
  if (kind == "EINTR") return {Kind::interrupt, EINTR, call};
  return {Kind::kill, 0, call};
}

const Plan& plan() {
  static const Plan only = plan_of_environment();
  return only;
}

constexpr int most_files = 1024;
std::bitset<most_files> written;  // descriptors that were opened to write
std::atomic<long> calls = 0;

bool is_written(int descriptor) {
  return descriptor > STDERR_FILENO && descriptor < most_files && written[static_cast<std::size_t>(descriptor)];
}

void log_fault() {
  const char* const path = std::getenv("FRACFIT_FAULT_LOG");
  if (path == nullptr) return;
  const long descriptor = ::syscall(SYS_openat, AT_FDCWD, path, O_CREAT | O_WRONLY, 0600);
  ::syscall(SYS_close, descriptor);
}

// Whether this is the call concerned.
bool is_due() {
  if (plan().kind == Kind::none || plan().kind == Kind::threads || ++calls != plan().call) return false;
  log_fault();
  return true;
}

// True where the call has to fail; errno is set.  Writing goes on to fail, as a full disk stays full.
bool fails(bool is_write) {
  const bool due = is_due();
  if (due && plan().kind == Kind::kill && !is_write) ::raise(SIGKILL);
  const bool stays = is_write && plan().kind == Kind::error && plan().error != EIO && calls > plan().call;
  if ((due || stays) && plan().kind == Kind::error) {
    errno = plan().error;
    return true;
  }
  return false;
}

template <typename Function>
Function real(const char* name) {
  return reinterpret_cast<Function>(::dlsym(RTLD_NEXT, name));
}

int opened(const char* path, int flags, mode_t mode) {
  const bool unnamed = (flags & O_TMPFILE) == O_TMPFILE;
  const bool writes = unnamed || (flags & O_ACCMODE) != O_RDONLY;
  if (unnamed && std::getenv("FRACFIT_NAMED") != nullptr) {
    errno = EOPNOTSUPP;
    return -1;
  }
  if (writes && std::strncmp(path, "/dev/", 5) != 0 && fails(false)) return -1;
  const int descriptor = static_cast<int>(::syscall(SYS_openat, AT_FDCWD, path, flags, mode));
  if (writes && descriptor >= 0 && descriptor < most_files) written.set(static_cast<std::size_t>(descriptor));
  return descriptor;
}

}  // namespace

extern "C" {

int open(const char* path, int flags, ...) {
  std::va_list arguments;
  va_start(arguments, flags);
  const auto mode = static_cast<mode_t>(va_arg(arguments, unsigned));
  va_end(arguments);
  return opened(path, flags, mode);
}

int open64(const char* path, int flags, ...) {
  std::va_list arguments;
  va_start(arguments, flags);
  const auto mode = static_cast<mode_t>(va_arg(arguments, unsigned));
  va_end(arguments);
  return opened(path, flags, mode);
}

ssize_t write(int descriptor, const void* bytes, size_t count) {
  const auto pass = [&](size_t length) { return ::syscall(SYS_write, descriptor, bytes, length); };
  if (!is_written(descriptor)) return pass(count);
  const long before = calls;
  if (fails(true)) {
    // A disk runs full in the middle of a line.
    if (calls == plan().call && before < plan().call && count > 1 && plan().error == ENOSPC) return pass(count / 2);
    return -1;
  }
  if (plan().kind == Kind::none || plan().kind == Kind::threads || calls != plan().call) return pass(count);
  if (plan().kind == Kind::interrupt) {
    errno = EINTR;
    return -1;
  }
  const ssize_t half = pass((count + 1) / 2);
  if (plan().kind == Kind::kill) ::raise(SIGKILL);
  return half;
}

int close(int descriptor) {
  const bool counted = is_written(descriptor);
  if (counted) written.reset(static_cast<std::size_t>(descriptor));
  const bool failing = counted && fails(false);
  const int error = errno;
  const bool interrupted = counted && plan().kind == Kind::interrupt && calls == plan().call;
  const int result = static_cast<int>(::syscall(SYS_close, descriptor));
  if (!failing && !interrupted) return result;
  errno = failing ? error : EINTR;
  return -1;
}

int fchmod(int descriptor, mode_t mode) noexcept {
  return fails(false) ? -1 : static_cast<int>(::syscall(SYS_fchmod, descriptor, mode));
}

int ftruncate(int descriptor, off_t length) noexcept {
  return fails(false) ? -1 : static_cast<int>(::syscall(SYS_ftruncate, descriptor, length));
}

int linkat(int from_folder, const char* from, int to_folder, const char* to, int flags) noexcept {
  return fails(false) ? -1 : static_cast<int>(::syscall(SYS_linkat, from_folder, from, to_folder, to, flags));
}

int pthread_create(pthread_t* thread, const pthread_attr_t* attributes, void* (*run)(void*), void* argument) noexcept {
  if (plan().kind == Kind::threads && ++calls >= plan().call) {
    log_fault();
    return plan().error;
  }
  using Create = int (*)(pthread_t*, const pthread_attr_t*, void* (*)(void*), void*);
  return real<Create>("pthread_create")(thread, attributes, run, argument);
}

int rename(const char* from, const char* to) noexcept {
  return fails(false) ? -1 : real<int (*)(const char*, const char*)>("rename")(from, to);
}

int mkdir(const char* path, mode_t mode) noexcept {
  return fails(false) ? -1 : real<int (*)(const char*, mode_t)>("mkdir")(path, mode);
}

}  // extern "C"
