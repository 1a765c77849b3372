// SPDX-License-Identifier: BSD-3-Clause
#include "io/progress_bar.hpp"

#include <gtest/gtest.h>
#include <pty.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <optional>
#include <string>
#include <thread>

namespace {

/// What a bar at 5 of 10 writes to standard error within half a second, standard error being a terminal or a pipe.
/// Empty optional: there are no pseudo-terminals here.
/// @param total  0: nothing is counted
std::optional<std::string> drawn(bool terminal, io::ProgressStyle style, std::size_t total = 10,
                                 std::chrono::milliseconds wait = std::chrono::milliseconds(500)) {
  std::array<int, 2> ends{};
  if (terminal && ::openpty(&ends[0], &ends[1], nullptr, nullptr, nullptr) != 0) return std::nullopt;
  if (!terminal && ::pipe(ends.data()) != 0) return std::nullopt;
  const int saved = ::dup(STDERR_FILENO);
  ::dup2(ends[1], STDERR_FILENO);
  {
    frac::Progress progress;
    progress.total = total;
    progress.done = 5;
    const io::ProgressBar bar("sweep", progress, style);
    std::this_thread::sleep_for(wait);
  }
  // An end mark, so that reading never waits.
  EXPECT_EQ(::write(STDERR_FILENO, "\x04\n", 2), 2);
  ::dup2(saved, STDERR_FILENO);
  ::close(saved);
  std::string text;
  for (char c = 0; ::read(ends[0], &c, 1) == 1 && c != '\x04';) text += c;
  ::close(ends[0]);
  ::close(ends[1]);
  return text;
}

TEST(ProgressBar, DrawsShareAndTimeLeftOnATerminal) {
  const auto drawing = drawn(true, io::ProgressStyle::bar);
  if (!drawing) GTEST_SKIP() << "no pseudo-terminals here";
  const std::string& text = *drawing;
  EXPECT_NE(text.find("sweep [###############...............]  50 %, "), std::string::npos) << text;
  EXPECT_NE(text.find("s left"), std::string::npos) << text;
  EXPECT_TRUE(text.ends_with("\r\033[K")) << "the line is cleared at the end";
}

TEST(ProgressBar, TellsFromTwoSecondsOnForHowLongUncountedWorkGoesOn) {
  const auto drawing = drawn(true, io::ProgressStyle::bar, 0, std::chrono::milliseconds(2600));
  if (!drawing) GTEST_SKIP() << "no pseudo-terminals here";
  EXPECT_NE(drawing->find("sweep: at work for 2 s"), std::string::npos) << *drawing;
  EXPECT_TRUE(drawing->ends_with("\r\033[K"));
  EXPECT_EQ(drawn(true, io::ProgressStyle::bar, 0).value_or(""), "");
  EXPECT_EQ(drawn(false, io::ProgressStyle::lines, 0).value_or(""), "");
}

// The outer bar has counted nothing for longer than two seconds, but says so only when it is alone again.
TEST(ProgressBar, OfTwoTheInnerOneIsDrawn) {
  std::array<int, 2> ends{};
  if (::openpty(&ends[0], &ends[1], nullptr, nullptr, nullptr) != 0) GTEST_SKIP() << "no pseudo-terminals here";
  const int saved = ::dup(STDERR_FILENO);
  ::dup2(ends[1], STDERR_FILENO);
  {
    const frac::Progress nothing;
    const io::ProgressBar outer("outer", nothing, io::ProgressStyle::bar);
    {
      frac::Progress progress;
      progress.total = 10;
      const io::ProgressBar inner("inner", progress, io::ProgressStyle::bar);
      std::this_thread::sleep_for(std::chrono::milliseconds(2600));
    }
    EXPECT_EQ(::write(STDERR_FILENO, "\x03", 1), 1);
    std::this_thread::sleep_for(std::chrono::milliseconds(500));
  }
  EXPECT_EQ(::write(STDERR_FILENO, "\x04\n", 2), 2);
  ::dup2(saved, STDERR_FILENO);
  ::close(saved);
  std::string text;
  for (char c = 0; ::read(ends[0], &c, 1) == 1 && c != '\x04';) text += c;
  for (const int end : ends) ::close(end);
  const std::size_t turn = text.find('\x03');
  EXPECT_LT(text.find("inner ["), turn) << text;
  EXPECT_GT(text.find("outer"), turn) << text;
  EXPECT_NE(text.find("outer: at work for", turn), std::string::npos) << text;
}

TEST(ProgressBar, IsSilentElsewhere) {
  EXPECT_EQ(drawn(false, io::ProgressStyle::bar), "");
  EXPECT_EQ(drawn(true, io::ProgressStyle::none).value_or(""), "");
}

TEST(ProgressBar, WritesALineOfJsonForPrograms) {
  const std::string text = drawn(false, io::ProgressStyle::lines).value();
  EXPECT_TRUE(text.starts_with(R"({"progress":"sweep","done":5,"total":10,"seconds":0.)")) << text;
  EXPECT_NE(text.find(R"("per_second":)"), std::string::npos) << text;
  EXPECT_TRUE(text.ends_with("}\n")) << text;
}

}  // namespace
