// SPDX-License-Identifier: BSD-3-Clause
#include "io/result_stream.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "frac/parallel_for.hpp"
#include "io/csv_line.hpp"
#include "io/input_files.hpp"
#include "io/input_text.hpp"
#include "temporary_folder.hpp"

namespace {

TEST(ResultStream, PiecesAreOnDiskBeforeTheEndAndInOrderAfterIt) {
  const TemporaryFolder folder;
  const auto path = folder.path("out.csv");
  io::ResultStream stream(path, "# header\n", {{"b", "b,2\n"}});
  stream.append("c", "c,3\n");
  EXPECT_EQ(content_of(path), "# header\nb,2\nc,3\n");
  EXPECT_EQ(stream.text("b"), "b,2\n");
  EXPECT_EQ(stream.text("c"), "c,3\n");
  EXPECT_THROW(static_cast<void>(stream.text("a")), std::out_of_range);
  stream.append("a", "a,1\n");
  stream.finish("# header\na,1\nb,2\nc,3\n# end\n");
  EXPECT_EQ(content_of(path), "# header\na,1\nb,2\nc,3\n# end\n");
  EXPECT_EQ(folder.entries(), 1U);
}

// A run that is killed leaves the file at any length.  What is resumed must be the pieces whose mark is whole, however
// the last one was cut, and the file must take more.
TEST(ResultStream, GoesOnFromAFileThatWasCutAtAnyByte) {
  const TemporaryFolder folder;
  const auto path = folder.path("out.csv.partial");
  const std::string header = "# unfinished\n# command: x\nname,value\n";
  const std::vector<std::pair<std::string, std::string>> pieces{{"7", "a,1\nb,2\n"}, {"0", "c,3\n"}, {"31", ""}};
  std::vector<std::size_t> ends{header.size()};
  {
    io::ResultStream stream(path, header);
    for (const auto& [key, text] : pieces) {
      stream.append(key, text);
      ends.push_back(content_of(path).size());
    }
  }
  const std::string whole = content_of(path);
  for (std::size_t cut = header.size(); cut <= whole.size(); ++cut) {
    folder.write("out.csv.partial", whole.substr(0, cut));
    io::ResultStream stream(path, header);
    std::size_t expected = 0;
    while (expected + 1 < ends.size() && ends[expected + 1] <= cut) ++expected;
    ASSERT_EQ(stream.size(), expected) << "cut at " << cut;
    for (std::size_t i = 0; i < expected; ++i) EXPECT_EQ(stream.text(pieces[i].first), pieces[i].second);
    for (std::size_t i = expected; i < pieces.size(); ++i) stream.append(pieces[i].first, pieces[i].second);
    ASSERT_EQ(content_of(path), whole) << "cut at " << cut;
  }
}

TEST(ResultStream, APieceThatWasChangedOnDiskIsMadeAgain) {
  const TemporaryFolder folder;
  const auto path = folder.path("out.csv.partial");
  {
    io::ResultStream stream(path, "h\n");
    stream.append("0", "a,1\n");
    stream.append("1", "b,2\n");
  }
  std::string text = content_of(path);
  text[text.find("b,2")] = 'x';
  folder.write("out.csv.partial", text);
  const io::ResultStream stream(path, "h\n");
  EXPECT_TRUE(stream.contains("0"));
  EXPECT_FALSE(stream.contains("1"));
}

// What is said of a piece comes back with it, and a piece of which it was changed is made again.
TEST(ResultStream, RemarksComeBackAndAreGuarded) {
  const TemporaryFolder folder;
  const auto path = folder.path("out.csv.partial");
  {
    io::ResultStream stream(path, "h\n");
    stream.append("0", "a,1\n", "3,0");
    stream.append("1", "b,2\n");
    stream.append("2", "c,3\n", "0,7");
  }
  {
    const io::ResultStream stream(path, "h\n");
    EXPECT_EQ(stream.remark("0"), "3,0");
    EXPECT_EQ(stream.remark("1"), "");
    EXPECT_EQ(stream.remark("2"), "0,7");
    EXPECT_EQ(stream.text("2"), "c,3\n");
  }
  std::string text = content_of(path);
  text[text.find("0,7")] = '1';
  folder.write("out.csv.partial", text);
  const io::ResultStream stream(path, "h\n");
  EXPECT_TRUE(stream.contains("1"));
  EXPECT_FALSE(stream.contains("2"));
}

TEST(ResultStream, AnotherRequestIsRefusedAndItsFileUntouched) {
  const TemporaryFolder folder;
  const auto path = folder.path("out.csv.partial");
  for (const std::string content : {"# command: y\nrows\n", "# comm", "# command: x\nother columns\n"}) {
    folder.write("out.csv.partial", content);
    EXPECT_THROW(io::ResultStream(path, "# command: x\ncolumns\n"), std::invalid_argument);
    EXPECT_EQ(content_of(path), content);
  }
}

TEST(ResultStream, LinesFromManyThreadsStayWhole) {
  const TemporaryFolder folder;
  const auto path = folder.path("out.csv");
  io::ResultStream stream(path, "", {});
  frac::parallel_for(200, 4, [&](std::size_t i) { stream.append(std::to_string(i), std::string(1000, 'x') + "\n"); });
  const auto lines = io::whole_lines(content_of(path));
  EXPECT_EQ(lines.size(), 200U);
  for (const auto& line : lines) EXPECT_EQ(line, std::string(1000, 'x'));
}

TEST(ResultStream, ASecondRunOnTheSameFileIsRefused) {
  const TemporaryFolder folder;
  const auto path = folder.path("out.csv");
  io::ResultStream first(path, "# header\n", {});
  first.append("a", "a,1\n");
  EXPECT_THROW(io::ResultStream(path, "# other\n", {}), std::invalid_argument);
  EXPECT_EQ(content_of(path), "# header\na,1\n");
}

TEST(ResultStream, WhatCannotHoldResultsIsRefused) {
  const TemporaryFolder folder;
  EXPECT_THROW(io::ResultStream("/dev/null", "", {}), std::invalid_argument);
  EXPECT_THROW(io::ResultStream(folder.path(), "", {}), std::invalid_argument);
  EXPECT_THROW(io::ResultStream(folder.path("no/such/file"), "", {}), std::invalid_argument);
}

TEST(WholeLines, ALineCutOffIsLeftOut) {
  EXPECT_EQ(io::whole_lines("1\n\n2\n3"), (std::vector<std::string>{"1", "", "2"}));
  EXPECT_TRUE(io::whole_lines("").empty());
}

TEST(CsvLine, FieldsComeBackAsTheyWere) {
  const std::vector<std::string> fields{"plain", "a,b", "say \"x\"", "\"", "", "# no comment", ","};
  std::string line;
  for (const auto& field : fields) line += (line.empty() ? "" : ",") + io::csv_field(field);
  EXPECT_EQ(io::split_csv_line(line), fields);
  EXPECT_EQ(io::csv_field("two\nlines"), "two lines");
  EXPECT_FALSE(io::split_csv_line("a,\"open"));
  EXPECT_FALSE(io::split_csv_line("\"a\"b,c"));
  EXPECT_EQ(io::split_csv_line(""), std::vector<std::string>{""});
  EXPECT_EQ(io::split_csv_line("a,"), (std::vector<std::string>{"a", ""}));
}

TEST(InputFiles, AFolderGivesItsDataFilesByName) {
  const TemporaryFolder folder;
  for (const char* name : {"b.CSV", "a.txt", "c.png", ".hidden.csv", "out.csv"}) folder.write(name, "x");
  std::filesystem::create_directory(folder.path("sub.csv"));
  EXPECT_EQ(io::input_files({"z.csv", folder.path()}, folder.path("out.csv")),
            (std::vector<std::string>{"z.csv", folder.path("a.txt"), folder.path("b.CSV")}));
  EXPECT_THROW(static_cast<void>(io::input_files({folder.path("a.txt"), folder.path()}, "")), std::invalid_argument);
  EXPECT_THROW(static_cast<void>(io::input_files({"a\nb"}, "")), std::invalid_argument);
}

}  // namespace
