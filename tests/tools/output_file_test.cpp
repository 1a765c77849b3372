// SPDX-License-Identifier: BSD-3-Clause
#include "io/output_file.hpp"

#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <filesystem>
#include <stdexcept>

#include "temporary_folder.hpp"

namespace {

namespace fs = std::filesystem;

std::string refusal_of(const std::string& path) {
  try {
    const io::OutputFile file(path);
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "no error";
}

TEST(OutputFile, AppearsWholeAndLeavesNothingElse) {
  const TemporaryFolder folder;
  const io::OutputFile file(folder.path("result.csv"));
  EXPECT_EQ(folder.entries(), 0U);
  file.write("first");
  EXPECT_EQ(content_of(folder.path("result.csv")), "first");
  file.write("second");
  EXPECT_EQ(content_of(folder.path("result.csv")), "second");
  EXPECT_EQ(folder.entries(), 1U);
}

TEST(OutputFile, KeepsAccessRightsOfWhatItReplaces) {
  const TemporaryFolder folder;
  const auto path = folder.write("result.csv", "old");
  fs::permissions(path, fs::perms::owner_read | fs::perms::owner_write);
  io::OutputFile(path).write("new");
  EXPECT_EQ(fs::status(path).permissions(), fs::perms::owner_read | fs::perms::owner_write);
}

TEST(OutputFile, NewFilesGetTheUsualAccessRights) {
  const TemporaryFolder folder;
  io::OutputFile(folder.path("result.csv")).write("new");
  const mode_t mask = ::umask(0);
  ::umask(mask);
  struct stat status {};
  ASSERT_EQ(::stat(folder.path("result.csv").c_str(), &status), 0);
  EXPECT_EQ(status.st_mode & 0777U, 0666U & ~mask);
}

TEST(OutputFile, UnwritablePlacesAreFoundBeforeWriting) {
  const TemporaryFolder folder;
  folder.write("file", "");
  EXPECT_NE(refusal_of(folder.path("absent/result.csv")).find("No such file or directory"), std::string::npos);
  EXPECT_NE(refusal_of(folder.path("file/result.csv")).find("cannot be written"), std::string::npos);
  EXPECT_NE(refusal_of(folder.path()).find("is a folder"), std::string::npos);
  EXPECT_NE(refusal_of(folder.path("absent/")).find("no folder of that name"), std::string::npos);
  // Not even the superuser makes files here.
  EXPECT_NE(refusal_of("/proc/result.csv").find("cannot be written"), std::string::npos);
}

TEST(OutputFile, ReadOnlyFoldersAreRefused) {
  if (::geteuid() == 0) GTEST_SKIP() << "the superuser writes anywhere";
  const TemporaryFolder folder;
  fs::permissions(folder.path(), fs::perms::owner_read | fs::perms::owner_exec);
  EXPECT_NE(refusal_of(folder.path("result.csv")).find("Permission denied"), std::string::npos);
}

TEST(OutputFile, DevicesAreWrittenNotReplaced) {
  io::OutputFile("/dev/null").write("gone");
  EXPECT_TRUE(fs::is_character_file("/dev/null"));
}

TEST(OutputFile, AFullDiskIsAnError) {
  if (!fs::exists("/dev/full")) GTEST_SKIP() << "no /dev/full here";
  EXPECT_THROW(io::OutputFile("/dev/full").write("content"), std::runtime_error);
}

TEST(OutputFile, LinksAreFollowed) {
  const TemporaryFolder folder;
  folder.write("target.csv", "old");
  fs::create_symlink("target.csv", folder.path("link.csv"));
  io::OutputFile(folder.path("link.csv")).write("new");
  EXPECT_TRUE(fs::is_symlink(folder.path("link.csv")));
  EXPECT_EQ(content_of(folder.path("target.csv")), "new");
}

}  // namespace
