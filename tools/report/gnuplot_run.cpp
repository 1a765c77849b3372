// SPDX-License-Identifier: BSD-3-Clause
#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <fstream>
#include <string>
#include <system_error>

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

bool is_filled(const std::filesystem::path& path) {
  std::error_code error;
  const auto size = std::filesystem::file_size(path, error);
  return !error && size > 0;
}

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

std::string draw(const std::filesystem::path& gnuplot, const std::filesystem::path& folder, const std::string& name) {
  const std::filesystem::path log = folder / (name + ".log");
  SpawnActions actions;
  posix_spawn_file_actions_addopen(actions.get(), STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_addopen(actions.get(), STDOUT_FILENO, log.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0644);
  posix_spawn_file_actions_adddup2(actions.get(), STDOUT_FILENO, STDERR_FILENO);
  posix_spawn_file_actions_addchdir_np(actions.get(), folder.c_str());
  std::string program = gnuplot.string();
  // Without -d a gnuplotrc of the user would change the pictures.
  std::string defaults = "-d";
  std::string script = name + ".gp";
  char* const arguments[] = {program.data(), defaults.data(), script.data(), nullptr};
  pid_t child = 0;
  if (const int error = posix_spawn(&child, program.c_str(), actions.get(), nullptr, arguments, environ); error != 0) {
    return "gnuplot cannot be started for " + script + ": " + std::generic_category().message(error);
  }
  int status = 0;
  while (waitpid(child, &status, 0) < 0) {
    if (errno != EINTR) return "gnuplot was lost while drawing " + script + ".";
  }
  const std::string words = first_lines(log);
  std::error_code ignored;
  std::filesystem::remove(log, ignored);
  if (!WIFEXITED(status) || WEXITSTATUS(status) != 0) return "gnuplot failed on " + script + ": " + words;
  if (!is_filled(folder / (name + ".svg")) || !is_filled(folder / (name + ".png"))) {
    return "gnuplot made no picture from " + script + ": " + words;
  }
  return {};
}

}  // namespace report
