// SPDX-License-Identifier: BSD-3-Clause
#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <fstream>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>
#include <thread>
#include <vector>

#include "io/termination.hpp"
#include "report/figure.hpp"

extern char** environ;

namespace report {

namespace {

std::string first_lines(const std::filesystem::path& path) {
  std::ifstream file(path);
  std::string text;
  std::string line;
  for (int lines = 0; lines < 6 && std::getline(file, line); ++lines) {
    if (line.empty()) continue;
    text += (text.empty() ? "" : " | ") + line;
  }
  return text;
}

// A full disk leaves pictures that stop in the middle.
bool is_whole(const std::filesystem::path& path, std::string_view end) {
  std::ifstream file(path, std::ios::binary | std::ios::ate);
  const auto size = file.tellg();
  constexpr std::streamoff longest = 32;
  if (!file || size <= 0) return false;
  const std::streamoff length = std::min<std::streamoff>(size, longest);
  std::string tail(static_cast<std::size_t>(length), '\0');
  file.seekg(-length, std::ios::end).read(tail.data(), length);
  return file && tail.find(end) != std::string::npos;
}

// The error of the disk, if the picture is not complete.
std::string disk_words(const std::filesystem::path& folder) {
  std::error_code error;
  const auto space = std::filesystem::space(folder, error);
  return !error && space.available == 0 ? std::generic_category().message(ENOSPC) : std::string();
}

// Waits for a child at most so long and ends it then, with all it has started.  False where that was necessary or the
// child was lost.
bool ended_in_time(pid_t child, std::chrono::milliseconds limit, int& status) {
  const auto end = std::chrono::steady_clock::now() + limit;
  auto pause = std::chrono::microseconds(500);
  constexpr auto longest_pause = std::chrono::microseconds(20'000);
  for (;;) {
    const pid_t ended = waitpid(child, &status, WNOHANG);
    if (ended == child) return true;
    if (ended < 0 && errno != EINTR) return false;
    if (std::chrono::steady_clock::now() >= end) break;
    std::this_thread::sleep_for(pause);
    pause = std::min(pause * 2, longest_pause);
  }
  ::kill(-child, SIGKILL);
  while (waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  return false;
}

// The child gets the usual signals back, which this program waits for in a thread, and a process group of its own.
class SpawnAttributes {
 public:
  SpawnAttributes() {
    posix_spawnattr_init(&attributes_);
    sigset_t none;
    sigemptyset(&none);
    posix_spawnattr_setsigmask(&attributes_, &none);
    posix_spawnattr_setpgroup(&attributes_, 0);
    posix_spawnattr_setflags(&attributes_, POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETPGROUP);
  }
  ~SpawnAttributes() { posix_spawnattr_destroy(&attributes_); }
  SpawnAttributes(const SpawnAttributes&) = delete;
  SpawnAttributes& operator=(const SpawnAttributes&) = delete;
  posix_spawnattr_t* get() { return &attributes_; }

 private:
  posix_spawnattr_t attributes_{};
};

class SpawnActions {
 public:
  SpawnActions() { posix_spawn_file_actions_init(&actions_); }
  ~SpawnActions() { posix_spawn_file_actions_destroy(&actions_); }
  SpawnActions(const SpawnActions&) = delete;
  SpawnActions& operator=(const SpawnActions&) = delete;
  posix_spawn_file_actions_t* get() { return &actions_; }

 private:
  posix_spawn_file_actions_t actions_;
};

}  // namespace

std::string gnuplot_missing() {
  return "gnuplot was not found; install it with \"apt-get install gnuplot-nox\"";
}

std::optional<std::filesystem::path> find_gnuplot() {
  const char* search_path = std::getenv("PATH");
  if (search_path == nullptr) return std::nullopt;
  const std::string folders = search_path;
  for (std::size_t begin = 0; begin <= folders.size();) {
    const std::size_t end = std::min(folders.find(':', begin), folders.size());
    if (end > begin) {
      const auto candidate = std::filesystem::path(folders.substr(begin, end - begin)) / "gnuplot";
      std::error_code error;
      if (std::filesystem::is_regular_file(candidate, error) && access(candidate.c_str(), X_OK) == 0) {
        return std::filesystem::absolute(candidate);
      }
    }
    begin = end + 1;
  }
  return std::nullopt;
}

std::string draw(const std::filesystem::path& gnuplot, const std::filesystem::path& folder,
                 const std::vector<std::string>& names, std::chrono::milliseconds limit) {
  if (names.empty()) return {};
  const auto log = folder / (names.front() + ".log");
  SpawnActions actions;
  posix_spawn_file_actions_addopen(actions.get(), STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_addopen(actions.get(), STDOUT_FILENO, log.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0644);
  posix_spawn_file_actions_adddup2(actions.get(), STDOUT_FILENO, STDERR_FILENO);
  posix_spawn_file_actions_addchdir_np(actions.get(), folder.c_str());
  // Without -d a gnuplotrc of the user would change the pictures; what one script sets is no matter of the next.
  std::vector<std::string> words = {gnuplot.string(), "-d"};
  for (const std::string& name : names) words.insert(words.end(), {name + ".gp", "-e", "reset"});
  std::vector<char*> arguments;
  for (std::string& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  const std::string scripts = names.front() + ".gp" + (names.size() > 1 ? " to " + names.back() + ".gp" : "");
  pid_t child = 0;
  int error = 0;
  SpawnAttributes attributes;
  std::optional<io::CleanUp> clean_up;
  io::uninterrupted([&] {
    error = posix_spawn(&child, words.front().c_str(), actions.get(), attributes.get(), arguments.data(), environ);
    if (error == 0) clean_up.emplace([child] { ::kill(-child, SIGKILL); });
  });
  if (error != 0) {
    return "gnuplot cannot be started for " + scripts + ": " + std::generic_category().message(error);
  }
  int status = 0;
  limit *= static_cast<int>(names.size());
  const bool in_time = ended_in_time(child, limit, status);
  clean_up.reset();
  const std::string said = first_lines(log);
  std::error_code ignored;
  std::filesystem::remove(log, ignored);
  if (!in_time) {
    return "gnuplot did not finish " + scripts + " within " +
           std::to_string(std::chrono::duration_cast<std::chrono::seconds>(limit).count()) + " s and was ended";
  }
  if (!WIFEXITED(status) || WEXITSTATUS(status) != 0) return "gnuplot failed on " + scripts + ": " + said;
  for (const std::string& name : names) {
    if (!is_whole(folder / (name + ".svg"), "</svg>") || !is_whole(folder / (name + ".png"), "IEND")) {
      return "gnuplot made no whole picture from " + name + ".gp: " + said + disk_words(folder);
    }
  }
  return {};
}

}  // namespace report
