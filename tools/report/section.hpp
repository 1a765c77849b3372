// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "report/figure.hpp"
#include "report/table.hpp"

namespace report {

struct Html {
  std::string text;
};
using Block = std::variant<Html, Figure, Table>;

/// One chapter of the page.
struct Section {
  std::string id;       // anchor
  std::string title;    // HTML
  std::string reading;  // "how to read this", HTML
  std::vector<Block> blocks;
  std::vector<std::string> findings;                // HTML sentences for the summary
  std::vector<std::pair<std::string, Cell>> facts;  // headline numbers for results.json

  void add(Block block) { blocks.push_back(std::move(block)); }
  void finding(std::string sentence) { findings.push_back(std::move(sentence)); }
  void fact(std::string name, Cell value) { facts.emplace_back(std::move(name), std::move(value)); }
};

}  // namespace report
