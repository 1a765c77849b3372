// SPDX-License-Identifier: BSD-3-Clause
#include "batch/batch_reader.hpp"

#include <optional>
#include <set>
#include <unordered_map>
#include <utility>
#include <vector>

#include "io/csv_line.hpp"
#include "io/data_error.hpp"
#include "io/fingerprint.hpp"
#include "io/line_reader.hpp"
#include "io/number.hpp"
#include "output/json.hpp"

namespace fracfit {
namespace {

[[noreturn]] void refuse(const std::string& file, std::size_t line, const std::string& what) {
  throw io::DataError(file, line, 0, what + "; expected a table written by fracfit batch");
}

std::string string_entry(const Json& json, const char* key) {
  const Json* found = json.find(key);
  return found != nullptr && found->text() != nullptr ? *found->text() : std::string();
}

// Empty where it is no list of texts.
std::optional<std::vector<std::string>> list_entry(const Json& json, const char* key) {
  const Json* found = json.find(key);
  if (found == nullptr || found->entries() == nullptr) return std::nullopt;
  std::vector<std::string> list;
  for (const Json& each : *found->entries()) {
    if (each.text() == nullptr) return std::nullopt;
    list.push_back(*each.text());
  }
  return list;
}

// What stands behind "# KEY: ".
std::optional<std::string> value_of(std::string_view line, std::string_view key) {
  if (!line.starts_with("# ") || !line.substr(2).starts_with(key)) return std::nullopt;
  line.remove_prefix(2 + key.size());
  return line.starts_with(": ") ? std::optional(std::string(line.substr(2))) : std::nullopt;
}

// The manifest in the first line of a table of JSON.
BatchManifest json_manifest(const std::string& file, const Json& json) {
  const auto laws = list_entry(json, "laws"), inputs = list_entry(json, "inputs"),
             columns = list_entry(json, "columns");
  if (!laws || !inputs || !columns) refuse(file, 1, "found no lists 'laws', 'inputs' and 'columns'");
  return {string_entry(json, "fracfit"),
          string_entry(json, "command"),
          string_entry(json, "shard"),
          *laws,
          *inputs,
          *columns};
}

// Takes a line of the manifest of a CSV; true at the names of the columns, which are the last.
bool take_csv_line(const std::string& file, std::size_t number, std::string_view line, BatchManifest& manifest) {
  if (auto input = value_of(line, "input")) {
    manifest.inputs.push_back(*std::move(input));
  } else if (auto law = value_of(line, "law")) {
    manifest.laws.push_back(*std::move(law));
  } else if (auto shard = value_of(line, "shard")) {
    manifest.shard = *std::move(shard);
  } else if (auto command = value_of(line, "command")) {
    manifest.command = *std::move(command);
  } else if (auto version = value_of(line, "fracfit")) {
    manifest.version = *std::move(version);
  } else if (auto columns = io::split_csv_line(line); columns && columns->front() == "file") {
    manifest.columns = *std::move(columns);
    return true;
  } else {
    refuse(file, number, "found " + io::quoted(line));
  }
  return false;
}

bool is_remark(BatchFormat format, std::string_view line) {
  return line.starts_with(format == BatchFormat::csv ? "# " : R"({"remark":)");
}

// All other columns hold numbers.
bool holds_text(const std::string& column) {
  static const std::set<std::string> columns{
      "file", "status", "chosen", "verdict", "model", "message", std::string(fingerprint_column)};
  return columns.contains(column) || column.ends_with("_state");
}

// The file a row is of, where its line is as it was written.
std::string curve_of(BatchFormat format, const std::vector<std::string>& columns, std::string_view line) {
  const std::string_view start = format == BatchFormat::csv ? "" : R"({"file":")";
  const auto end = line.find(format == BatchFormat::csv ? ',' : '"', start.size());
  const std::string_view name = line.substr(start.size(), end - start.size());
  if (end != std::string_view::npos && name.find_first_of(R"("\)") == std::string_view::npos) return std::string(name);
  return read_row(format, columns, std::string(line)).value().at("file");
}

void check_row(const std::string& file, std::size_t number, BatchFormat format, const std::vector<std::string>& columns,
               std::string_view line) {
  const auto row = read_row(format, columns, std::string(line));
  if (!row || !row->contains("file")) refuse(file, number, "found " + io::quoted(line));
  for (const auto& [column, value] : *row)
    if (!holds_text(column) && !io::parse_number(value))
      throw io::DataError(file, number, 0,
                          "found " + io::quoted(value) + " in column " + io::quoted(column) + "; expected a number");
}

// The last line that holds a checksum.
struct Ending {
  std::size_t line = 0;   // from 1; 0: there is none
  bool is_right = false;  // it is the last line, and the checksum that of the text above it
};

Ending ending_of(const std::string& file, int descriptor, BatchFormat format) {
  const std::string nothing = shard_end(format, io::Fingerprint()), name = "checksum";
  const std::string start = nothing.substr(0, nothing.find(name) + name.size());
  io::FileLines lines(descriptor, file);
  io::Fingerprint above;
  Ending ending;
  for (std::size_t number = 1; const auto line = lines.next(); ++number) {
    ending.is_right = false;
    if (line->starts_with(start)) ending = {number, std::string(*line) + "\n" == shard_end(format, above)};
    above.add(*line);
    above.add("\n");
  }
  return ending;
}

}  // namespace

BatchReader::BatchReader(std::string file, int descriptor) : file_(std::move(file)), descriptor_(descriptor) {
  io::FileLines lines(descriptor_, file_);
  bool is_whole = false;
  while (!is_whole) {
    const auto line = lines.next();
    if (!line) refuse(file_, 0, head_lines_ == 0 ? "holds no whole line" : "holds no row of column names");
    ++head_lines_;
    const auto json = head_lines_ == 1 && line->starts_with('{') ? Json::parse(std::string(*line)) : std::nullopt;
    if (json) {
      format_ = BatchFormat::jsonl;
      manifest_ = json_manifest(file_, *json);
    }
    is_whole = json || take_csv_line(file_, head_lines_, *line, manifest_);
  }
  if (const auto shard = manifest_.shard.empty() ? io::Shard{} : io::shard_from(manifest_.shard))
    shard_ = *shard;
  else
    refuse(file_, 0, "found the shard " + io::quoted(manifest_.shard));
  expected_ = io::part_of(manifest_.inputs.size(), shard_).size();
}

void BatchReader::read_rows(const std::function<void(const PlacedRow&)>& take) {
  const Ending ending = ending_of(file_, descriptor_, format_);
  std::unordered_map<std::string_view, std::size_t> places;
  for (const std::size_t i : io::part_of(manifest_.inputs.size(), shard_)) places.emplace(manifest_.inputs[i], i);
  io::FileLines lines(descriptor_, file_);
  std::size_t number = 0, begin = 0;
  for (; const auto line = lines.next(); begin = lines.position()) {
    if (++number <= head_lines_ || is_remark(format_, *line)) continue;
    if (!ending.is_right) check_row(file_, number, format_, manifest_.columns, *line);
    const std::string curve = curve_of(format_, manifest_.columns, *line);
    const auto place = places.find(curve);
    if (place == places.end())
      throw io::DataError(file_, number, 0, "holds a row for " + curve + ", which is none of its inputs");
    take({place->second, *line, begin});
    ++rows_;
  }
  if (ending.line > 0 && !ending.is_right)
    throw io::DataError(file_, ending.line, 0,
                        "found a checksum that is not that of all lines but itself: something was changed or lost");
  has_end_ = ending.is_right;
}

}  // namespace fracfit
