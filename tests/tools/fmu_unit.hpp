// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dlfcn.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <regex>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "run_program.hpp"

// Value reference, as both versions of the standard word it.
using Reference = unsigned;

// A unit that the program has written and `unzip` has unpacked.
class Unit {
 public:
  // @param compiled_anew  what is run in the folder of the unit before its library is loaded
  explicit Unit(std::vector<std::string> arguments, const std::string& compiled_anew = "true") {
    arguments.insert(arguments.begin(), {"export", "fmu"});
    arguments.insert(arguments.end(), {"--name", "unit", "--out", folder_.path("unit.fmu")});
    const auto result = run_fracfit(arguments);
    EXPECT_EQ(result.code, 0) << result.error;
    EXPECT_EQ(result.error, "");
    EXPECT_EQ(run_shell("cd '" + folder_.path() + "' && unzip -q unit.fmu").code, 0);
    const auto compiled = run_shell("cd '" + folder_.path() + "' && " + compiled_anew);
    EXPECT_EQ(compiled.code, 0) << compiled.error;
    description_ = content_of(folder_.path("modelDescription.xml"));
    library_ = ::dlopen(folder_.path(is_3() ? "binaries/x86_64-linux/unit.so" : "binaries/linux64/unit.so").c_str(),
                        RTLD_NOW | RTLD_LOCAL);
    if (library_ == nullptr) throw std::runtime_error(::dlerror());
  }
  Unit(const Unit&) = delete;
  Unit& operator=(const Unit&) = delete;
  ~Unit() { ::dlclose(library_); }

  template <typename... Arguments>
  int call(const char* function, Arguments... arguments) const {
    return reinterpret_cast<int (*)(Arguments...)>(symbol(function))(arguments...);
  }
  [[nodiscard]] void* symbol(const char* name) const {
    void* found = ::dlsym(library_, name);
    if (found == nullptr) throw std::runtime_error(std::string("no function ") + name);
    return found;
  }
  [[nodiscard]] const std::string& description() const { return description_; }
  [[nodiscard]] std::string path(const std::string& name) const { return folder_.path(name); }
  // Of FMI 3.0, not 2.0.
  [[nodiscard]] bool is_3() const { return description_.find("fmiVersion=\"3.0\"") != std::string::npos; }
  // The guid or instantiation token.
  [[nodiscard]] std::string token() const {
    std::smatch match;
    const std::regex token("(guid|instantiationToken)=\"([^\"]*)\"");
    return std::regex_search(description_, match, token) ? match[2].str() : "";
  }
  // Value reference of a variable.
  [[nodiscard]] Reference operator[](const std::string& name) const {
    std::smatch match;
    const bool is_there =
        std::regex_search(description_, match, std::regex("name=\"" + name + "\" valueReference=\"([0-9]+)\""));
    EXPECT_TRUE(is_there) << name;
    return is_there ? static_cast<Reference>(std::stoul(match[1])) : 0;
  }

 private:
  TemporaryFolder folder_;
  std::string description_;
  void* library_ = nullptr;
};

// Texts that the first group of a pattern matches.
inline std::vector<std::string> matches(const std::string& text, const std::string& pattern) {
  const std::regex expression(pattern);
  std::vector<std::string> found;
  for (std::sregex_iterator at(text.begin(), text.end(), expression), end; at != end; ++at) found.push_back((*at)[1]);
  return found;
}

inline bool has_tool(const char* tool) {
  return std::system((std::string(tool) + " >/dev/null 2>&1").c_str()) == 0;
}

class FmuTest : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!has_tool("cc --version")) GTEST_SKIP() << "no C compiler";
    if (!has_tool("unzip -v")) GTEST_SKIP() << "unzip is not installed";
#if !defined(__linux__) || !defined(__x86_64__)
    GTEST_SKIP() << "units hold libraries for 64-bit Linux only";
#endif
    if (run_fracfit({"export", "fmu", "--kp", "1", "--sample-time", "1", "--out", "/dev/null"}).error.find("libzip") !=
        std::string::npos)
      GTEST_SKIP() << "built without libzip";
  }
};
