// SPDX-License-Identifier: BSD-3-Clause
#include "io/c_compiler.hpp"

#include <fcntl.h>
#include <spawn.h>
#include <stdlib.h>
#include <sys/wait.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <optional>
#include <stdexcept>

#include "io/output_file.hpp"
#include "io/termination.hpp"

extern char** environ;

namespace io {
namespace {

namespace fs = std::filesystem;

// A folder that is removed with all it holds, also where a signal ends the program.
class WorkFolder {
 public:
  WorkFolder() {
    std::string name = (fs::temp_directory_path() / "fracfit-XXXXXX").string();
    uninterrupted([&] {
      if (mkdtemp(name.data()) == nullptr) return;
      path_ = name;
      clean_up_.emplace([this] { remove(); });
    });
    if (path_.empty())
      throw std::runtime_error("cannot write a temporary folder: " + std::string(std::strerror(errno)));
  }
  WorkFolder(const WorkFolder&) = delete;
  WorkFolder& operator=(const WorkFolder&) = delete;
  ~WorkFolder() {
    uninterrupted([&] { remove(); });
  }
  [[nodiscard]] const fs::path& path() const { return path_; }

 private:
  void remove() const {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }
  fs::path path_;
  std::optional<CleanUp> clean_up_;
};

std::string content_of(const fs::path& path) {
  std::ifstream stream(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

}  // namespace

CompiledLibrary compile_shared_library(const std::vector<std::pair<std::string, std::string>>& files,
                                       const std::string& main) {
  const WorkFolder folder;
  for (const auto& [name, content] : files) {
    const fs::path path = folder.path() / name;
    fs::create_directories(path.parent_path());
    write_new_file(path.string(), content, path.string());
  }
  const std::string library = (folder.path() / "library.so").string();
  const std::string messages = (folder.path() / "messages").string();
  std::vector<std::string> words{"cc",
                                 "-std=c99",
                                 "-O2",
                                 "-fPIC",
                                 "-shared",
                                 "-fvisibility=hidden",
                                 "-ffp-contract=off",
                                 "-o",
                                 library,
                                 (folder.path() / main).string(),
                                 "-lm"};
  std::vector<char*> arguments;
  for (std::string& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  posix_spawn_file_actions_t redirected;
  posix_spawn_file_actions_init(&redirected);
  constexpr mode_t own = 0600;
  posix_spawn_file_actions_addopen(&redirected, 2, messages.c_str(), O_WRONLY | O_CREAT, own);
  posix_spawn_file_actions_addopen(&redirected, 1, "/dev/null", O_WRONLY, 0);
  pid_t child = 0;
  const int failure = posix_spawnp(&child, "cc", &redirected, nullptr, arguments.data(), environ);
  posix_spawn_file_actions_destroy(&redirected);
  if (failure != 0) return {{}, "the C compiler 'cc' cannot be run: " + std::string(std::strerror(failure))};
  int status = 0;
  while (waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  if (!WIFEXITED(status) || WEXITSTATUS(status) != 0) return {{}, "the C compiler failed:\n" + content_of(messages)};
  return {content_of(library), {}};
}

}  // namespace io
