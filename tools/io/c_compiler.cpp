// SPDX-License-Identifier: BSD-3-Clause
#include "io/c_compiler.hpp"

#include <fcntl.h>
#include <spawn.h>
#include <stdlib.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <optional>
#include <stdexcept>

#include "io/output_file.hpp"
#include "io/termination.hpp"

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

// @param words  the compiler and its options
// @return why it failed; empty: it did not
std::string compile(const fs::path& folder, std::vector<std::string> words) {
  const std::string messages = (folder / "messages").string();
  std::vector<char*> arguments;
  for (std::string& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  posix_spawn_file_actions_t redirected;
  posix_spawn_file_actions_init(&redirected);
  constexpr mode_t own = 0600;
  posix_spawn_file_actions_addopen(&redirected, 2, messages.c_str(), O_WRONLY | O_CREAT | O_TRUNC, own);
  posix_spawn_file_actions_addopen(&redirected, 1, "/dev/null", O_WRONLY, 0);
  pid_t child = 0;
  const int failure = posix_spawnp(&child, words.front().c_str(), &redirected, nullptr, arguments.data(), environ);
  posix_spawn_file_actions_destroy(&redirected);
  if (failure != 0)
    return "the C compiler '" + words.front() + "' cannot be run: " + std::string(std::strerror(failure));
  int status = 0;
  while (waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  if (!WIFEXITED(status) || WEXITSTATUS(status) != 0) return "the C compiler failed:\n" + content_of(messages);
  return {};
}

}  // namespace

CompiledLibrary compile_shared_library(const std::string& compiler,
                                       const std::vector<std::pair<std::string, std::string>>& files,
                                       const std::string& main, const std::vector<std::vector<std::string>>& variants) {
  const WorkFolder folder;
  for (const auto& [name, content] : files) {
    const fs::path path = folder.path() / name;
    fs::create_directories(path.parent_path());
    write_new_file(path.string(), content, path.string());
  }
  const std::string library = (folder.path() / "library.so").string();
  std::vector<std::string> linked{compiler, "-shared", "-o", library};
  for (const std::vector<std::string>& variant : variants) {
    linked.push_back((folder.path() / (std::to_string(linked.size()) + ".o")).string());
    std::vector<std::string> words{compiler, "-std=c99", "-O2", "-fvisibility=hidden", "-ffp-contract=off"};
    words.insert(words.end(), variant.begin(), variant.end());
    words.insert(words.end(), {"-c", "-o", linked.back(), (folder.path() / main).string()});
    if (std::string failure = compile(folder.path(), std::move(words)); !failure.empty()) return {{}, failure};
  }
  linked.emplace_back("-lm");
  if (std::string failure = compile(folder.path(), std::move(linked)); !failure.empty()) return {{}, failure};
  return {content_of(library), {}};
}

}  // namespace io
