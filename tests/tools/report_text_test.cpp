// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <map>
#include <regex>
#include <set>
#include <stdexcept>
#include <string>
#include <vector>

#include "io/number.hpp"
#include "io/text_table.hpp"
#include "report/html.hpp"
#include "report/prose.hpp"
#include "report/table.hpp"
#include "report_support.hpp"
#include "temporary_folder.hpp"

namespace {

using namespace report;
namespace fs = std::filesystem;

TEST(EscapeHtml, LeavesNoCharacterThatEndsTextOrAnAttribute) {
  EXPECT_EQ(escape_html("a<b>&\"c\"'d'"), "a&lt;b&gt;&amp;&quot;c&quot;&#39;d&#39;");
  EXPECT_EQ(escape_html("Δ = 0.3 m"), "Δ = 0.3 m");
}

TEST(HtmlNumber, WritesWhatReadersExpect) {
  EXPECT_EQ(html_number(0), "0");
  EXPECT_EQ(html_number(3.14159, 3), "3.14");
  EXPECT_EQ(html_number(380.4, 2), "380");
  EXPECT_EQ(html_number(-0.5, 4), "−0.5");
  EXPECT_EQ(html_number(99.996, 4), "100");
  EXPECT_EQ(html_number(1.5e-7, 3), "1.5·10<sup>−7</sup>");
  EXPECT_EQ(html_number(2e9, 3), "2·10<sup>9</sup>");
  EXPECT_EQ(html_number(std::nan("")), "–");
  EXPECT_EQ(html_number(-INFINITY), "−∞");
}

TEST(HtmlSeconds, PicksTheUnit) {
  EXPECT_EQ(html_seconds(1.5e-6), "1.5 µs");
  EXPECT_EQ(html_seconds(0.0132), "13 ms");
  EXPECT_EQ(html_seconds(2.5e-8), "25 ns");
  EXPECT_EQ(html_seconds(12), "12 s");
}

TEST(HtmlFormula, RaisesPowersAndEscapes) {
  EXPECT_EQ(html_formula("K s^a1/(T s^0.5 + 1)"),
            "<span class=\"formula\">K s<sup>a1</sup>/(T s<sup>0.5</sup> + 1)</span>");
  EXPECT_EQ(html_formula("a<b"), "<span class=\"formula\">a&lt;b</span>");
  EXPECT_EQ(html_formula("c s^(2 q_1)/((T s)^(q_1 + (1 - p)) + s^-0.5)"),
            "<span class=\"formula\">c s<sup>2 q_1</sup>/((T s)<sup>q_1 + (1 - p)</sup> + s<sup>-0.5</sup>)</span>");
  EXPECT_EQ(html_formula("s^2^(a)"), "<span class=\"formula\">s<sup>2</sup><sup>a</sup></span>");
}

TEST(HtmlSentence, BeginsLargeAndEndsWithAStop) {
  EXPECT_EQ(html_sentence("rows < 3 have been sorted"), "Rows &lt; 3 have been sorted.");
  EXPECT_EQ(html_sentence("Table, 2 points."), "Table, 2 points.");
  EXPECT_EQ(html_sentence("\u00e4 stays"), "\u00e4 stays.");
  EXPECT_EQ(html_sentence(""), "");
}

TEST(Prose, JoinsTheLinesOfAPassageAndFillsItsPlaces) {
  const auto passages = passages_of({"words", "# one\nfirst line\nsecond {x} and {x}\n\n# two\n{y}\n"});
  ASSERT_EQ(passages.size(), 2U);
  EXPECT_EQ(passages.at("one"), "first line second {x} and {x}");
  EXPECT_EQ(filled(passages.at("one"), {{"x", "{y}"}}), "first line second {y} and {y}");
}

TEST(Prose, RefusesWhatDoesNotFitTogether) {
  EXPECT_THROW((void)filled("{x} and {y}", {{"x", "1"}}), std::logic_error) << "a place without a value";
  EXPECT_THROW((void)filled("{x}", {{"x", "1"}, {"y", "2"}}), std::logic_error) << "a value without a place";
  EXPECT_THROW((void)filled("{x", {{"x", "1"}}), std::logic_error);
  EXPECT_THROW((void)prose("no such chapter", "title"), std::logic_error);
  EXPECT_THROW((void)prose("jumps", "no such passage"), std::logic_error);
  EXPECT_THROW((void)passages_of({"words", "text\n# one\ntext\n"}), std::logic_error) << "text before a passage";
  EXPECT_THROW((void)passages_of({"words", "# one\ntext\n# one\ntext\n"}), std::logic_error) << "defined twice";
  EXPECT_THROW((void)passages_of({"words", "# one\n\n# two\ntext\n"}), std::logic_error) << "empty";
}

/// The text of a call from its opening parenthesis to the closing one.
std::string call_at(const std::string& source, std::size_t open) {
  int depth = 0;
  bool quoted = false;
  for (std::size_t i = open; i < source.size(); ++i) {
    if (source[i] == '"' && source[i - 1] != '\\') quoted = !quoted;
    if (quoted) continue;
    depth += source[i] == '(' ? 1 : source[i] == ')' ? -1 : 0;
    if (depth == 0) return source.substr(open, i - open + 1);
  }
  return source.substr(open);
}

TEST(Prose, EveryPassageIsUsedWithExactlyTheValuesItHasPlacesFor) {
  std::map<std::pair<std::string, std::string>, std::set<std::string>> used;
  const std::regex call(R"re((prose|paragraph|open_section|open_measured)(\()\s*"([^"]+)"(?:,\s*"([^"]+)")?)re");
  for (const auto& entry : fs::directory_iterator(fs::path(FRACFIT_SOURCE_DIR) / "tools/report")) {
    if (entry.path().extension() != ".cpp") continue;
    const std::string source = content_of(entry.path().string());
    for (std::sregex_iterator it(source.begin(), source.end(), call), end; it != end; ++it) {
      const std::string function = (*it)[1];
      const std::string chapter = (*it)[3];
      if (function == "open_section") used[{chapter, "title"}];
      if (function.starts_with("open_")) {
        used[{chapter, "reading"}];
      } else {
        const auto open = static_cast<std::size_t>(it->position(2));
        used[{chapter, (*it)[4]}] = all_matches(call_at(source, open), R"re(\{\s*"(\w+)",)re");
      }
    }
  }
  ASSERT_GT(used.size(), 50U) << "the sources were not understood";
  std::set<std::pair<std::string, std::string>> written;
  for (const ProseText& text : prose_texts()) {
    for (const auto& [name, passage] : passages_of(text)) {
      const std::pair<std::string, std::string> key{text.name, name};
      written.insert(key);
      ASSERT_TRUE(used.contains(key)) << "text/" << text.name << ".txt: nobody uses \"" << name << '"';
      EXPECT_EQ(all_matches(passage, R"(\{([^}]*)\})"), used.at(key)) << "text/" << text.name << ".txt: " << name;
    }
  }
  for (const auto& [key, values] : used) {
    EXPECT_TRUE(written.contains(key)) << "text/" << key.first << ".txt has no passage \"" << key.second << '"';
  }
}

TEST(CsvText, ReadsBackWithTheSameValues) {
  const double third = 1.0 / 3;
  const Table table{"t",
                    "caption",
                    {{"name", "n"}, {"value", "v"}},
                    {{std::string("a, b; c"), third}, {std::string("d"), std::nan("")}}};
  const TemporaryFolder folder;
  const std::string file = folder.write("t.csv", csv_text(table, {{"command", "fracfit report\n--out x"}}));
  const io::TextTable read(file);
  ASSERT_EQ(read.header().size(), 2U);
  EXPECT_EQ(read.header()[1].text, "value");
  EXPECT_EQ(io::find_value(read.metadata(), "command"), "fracfit report --out x");
  std::vector<double> values;
  read.for_each_row([&](const io::TextTable::Row& row) { values.push_back(io::parse_number(row.fields[1]).value()); });
  ASSERT_EQ(values.size(), 2U);
  EXPECT_EQ(values[0], third);
  EXPECT_TRUE(std::isnan(values[1]));
}

}  // namespace
