// SPDX-License-Identifier: BSD-3-Clause
#include "report/table.hpp"

#include <cassert>

#include "io/number.hpp"

namespace report {

namespace {

// Replaces the separators in a word, so that it is not read as two columns.  Quotes would not do: readers of CSV differ
// on them.
std::string plain_word(const std::string& word) {
  std::string plain;
  for (const char c : word)
    plain += c == ',' || c == ';' ? '/' : c == '\n' || c == '\r' || c == '\t' || c == '"' ? ' ' : c;
  return plain;
}

}  // namespace

std::string csv_text(const Table& table, const Metadata& metadata) {
  std::string text;
  for (const auto& [key, value] : metadata) {
    text += "# " + key + ": ";
    for (const char c : value) text += c == '\n' || c == '\r' ? ' ' : c;
    text += '\n';
  }
  for (std::size_t c = 0; c < table.columns.size(); ++c) text += (c == 0 ? "" : ",") + table.columns[c].name;
  text += '\n';
  for (const auto& row : table.rows) {
    assert(row.size() == table.columns.size());
    for (std::size_t c = 0; c < row.size(); ++c) {
      if (c > 0) text += ',';
      if (const double* number = std::get_if<double>(&row[c])) {
        io::append_number(text, *number);
      } else {
        text += plain_word(std::get<std::string>(row[c]));
      }
    }
    text += '\n';
  }
  return text;
}

}  // namespace report
