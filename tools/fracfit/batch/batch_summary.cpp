// SPDX-License-Identifier: BSD-3-Clause
#include "batch/batch_summary.hpp"

#include <algorithm>
#include <map>
#include <utility>

#include "io/number.hpp"
#include "output/aligned_table.hpp"

namespace fracfit {
namespace {

using Row = std::map<std::string, std::string>;

constexpr std::string_view state_ending = "_state";

std::string entry(const Row& row, const std::string& column) {
  const auto found = row.find(column);
  return found == row.end() ? "" : found->second;
}

std::string rounded(const Row& row, const std::string& column, int digits) {
  const auto number = io::parse_number(entry(row, column));
  return number ? short_number(*number, digits) : "";
}

/// Names of the parameters that any row has: the columns with a state beside them.
std::vector<std::string> parameters_of(const BatchManifest& manifest, const std::vector<Row>& rows) {
  std::vector<std::string> names;
  for (const std::string& column : manifest.columns) {
    const bool is_filled = std::any_of(rows.begin(), rows.end(), [&](const Row& row) { return row.contains(column); });
    if (column.ends_with(state_ending) && is_filled)
      names.push_back(column.substr(0, column.size() - state_ending.size()));
  }
  return names;
}

/// E.g. "0.313 +- 0.094"; with a question mark where the data do not determine it.
std::string parameter_text(const Row& row, const std::string& name) {
  const std::string state = entry(row, name + std::string(state_ending));
  const auto value = io::parse_number(entry(row, name));
  const auto lower = io::parse_number(entry(row, name + "_ci95_lower")),
             upper = io::parse_number(entry(row, name + "_ci95_upper"));
  std::string text = rounded(row, name, 5);
  if (value && lower && upper) {
    // A cell among many has five digits at most.
    const std::string warranted = shown_interval(*value, *lower, *upper).value;
    if (warranted.size() < text.size()) text = warranted;
    text += " +- " + short_number((*upper - *lower) / 2, 2);
  }
  if (state == "at-bound" || state == "not-identified") text += " ?";
  return text;
}

std::vector<std::string> columns_of(const BatchManifest& manifest) {
  std::vector<std::string> shown{"file", "status"};
  for (const char* column : {"chosen", "verdict"})
    if (std::find(manifest.columns.begin(), manifest.columns.end(), column) != manifest.columns.end())
      shown.emplace_back(column);
  shown.emplace_back("rms");
  return shown;
}

}  // namespace

std::string summary_of_rows(const BatchManifest& manifest, const std::vector<std::string>& lines) {
  std::vector<Row> rows;
  for (const std::string& line : lines) rows.push_back(read_row(BatchFormat::csv, manifest.columns, line).value());
  const std::vector<std::string> columns = columns_of(manifest), parameters = parameters_of(manifest, rows);
  std::vector<std::string> heading = columns;
  heading.insert(heading.end(), parameters.begin(), parameters.end());
  AlignedTable table(heading);
  std::string messages;
  bool is_unsure = false;
  for (const Row& row : rows) {
    std::vector<std::string> cells;
    for (const std::string& column : columns)
      cells.push_back(column == "rms" ? rounded(row, column, 3) : entry(row, column));
    for (const std::string& name : parameters) {
      cells.push_back(parameter_text(row, name));
      is_unsure = is_unsure || cells.back().ends_with("?");
    }
    table.add(std::move(cells));
    if (entry(row, "status") != "converged")
      messages += paragraph(entry(row, "file") + ": " + entry(row, "message"), 2);
  }
  std::string text = table.text();
  if (!messages.empty()) text += "\n" + messages;
  text += "\n" + paragraph(std::string("+-: half of the 95 % interval") +
                           (is_unsure ? "; ?: at a bound, or not determined by the data" : "") +
                           ". More of each fit is in the CSV (--format csv, --out FILE).");
  return text;
}

}  // namespace fracfit
