// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <fcntl.h>
#include <pty.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstdlib>
#include <iterator>
#include <sstream>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "temporary_folder.hpp"

/// How a child process ended.
struct ProgramResult {
  int code;  // exit code, or -signal
  std::string output;
  std::string error;
};

struct ProgramSetting {
  std::string search_path = {};                                       // PATH of the child; empty: as it is here
  std::string input = {};                                             // its standard input
  bool terminal_output = false;                                       // standard output is a terminal
  std::vector<std::pair<std::string, std::string>> environment = {};  // variables added
};

namespace detail {

inline std::string drained(int descriptor) {
  std::string text;
  std::array<char, 4096> buffer;
  for (;;) {
    const auto got = ::read(descriptor, buffer.data(), buffer.size());
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) return text;  // a terminal whose other end has closed gives EIO
    text.append(buffer.data(), static_cast<std::size_t>(got));
  }
}

}  // namespace detail

/// Whether this machine can open a pseudo-terminal; bare containers may not.
inline bool has_terminals() {
  int terminal = -1;
  int terminal_end = -1;
  if (::openpty(&terminal, &terminal_end, nullptr, nullptr, nullptr) != 0) return false;
  ::close(terminal);
  ::close(terminal_end);
  return true;
}

/// Runs a program with these arguments and waits for its end.
inline ProgramResult run_program(std::string program, const std::vector<std::string>& arguments,
                                 const ProgramSetting& setting = {}) {
  const TemporaryFolder folder;
  folder.write("input", setting.input);
  int terminal = -1;
  int terminal_end = -1;
  if (setting.terminal_output && ::openpty(&terminal, &terminal_end, nullptr, nullptr, nullptr) != 0)
    throw std::runtime_error("no pseudo-terminal");
  const auto child = ::fork();
  if (child < 0) throw std::runtime_error("cannot fork");
  if (child == 0) {
    const int input = ::open(folder.path("input").c_str(), O_RDONLY);
    const int output =
        setting.terminal_output ? terminal_end : ::open(folder.path("output").c_str(), O_WRONLY | O_CREAT, 0600);
    const int error = ::open(folder.path("error").c_str(), O_WRONLY | O_CREAT, 0600);
    ::dup2(input, STDIN_FILENO);
    ::dup2(output, STDOUT_FILENO);
    ::dup2(error, STDERR_FILENO);
    if (!setting.search_path.empty()) ::setenv("PATH", setting.search_path.c_str(), 1);
    for (const auto& [name, value] : setting.environment) ::setenv(name.c_str(), value.c_str(), 1);
    std::vector<char*> pointers;
    pointers.push_back(program.data());
    std::vector<std::string> copies = arguments;
    for (auto& copy : copies) pointers.push_back(copy.data());
    pointers.push_back(nullptr);
    ::execv(program.c_str(), pointers.data());
    ::_exit(127);
  }
  std::string terminal_text;
  if (setting.terminal_output) {
    ::close(terminal_end);
    terminal_text = detail::drained(terminal);
    ::close(terminal);
  }
  int status = 0;
  while (::waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  return {WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status),
          setting.terminal_output ? terminal_text : content_of(folder.path("output")),
          content_of(folder.path("error"))};
}

inline ProgramResult run_fracfit(const std::vector<std::string>& arguments, const ProgramSetting& setting = {}) {
  return run_program(FRACFIT_PROGRAM, arguments, setting);
}

/// Runs a shell script in which $fracfit is the program.
inline ProgramResult run_shell(const std::string& script) {
  return run_program("/bin/bash", {"-c", script}, {.environment = {{"fracfit", FRACFIT_PROGRAM}}});
}

inline std::vector<std::string> lines_of(const std::string& text) {
  std::istringstream stream(text);
  std::vector<std::string> lines;
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

/// Words of a text, such as the two of the subcommand "export spice".
inline std::vector<std::string> words_of(const std::string& text) {
  std::istringstream stream(text);
  return {std::istream_iterator<std::string>(stream), {}};
}
