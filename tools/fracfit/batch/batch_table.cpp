// SPDX-License-Identifier: BSD-3-Clause
#include "batch/batch_table.hpp"

#include <set>

#include "io/csv_line.hpp"
#include "io/data_error.hpp"
#include "io/fingerprint.hpp"
#include "io/input_text.hpp"
#include "io/number.hpp"
#include "io/shard.hpp"
#include "io/shard_file.hpp"
#include "output/json.hpp"

namespace fracfit {
namespace {

std::string csv_cell(const BatchCell& cell) {
  if (cell.number) return io::format_number(*cell.number);
  return cell.text ? io::csv_field(*cell.text) : std::string();
}

Json json_row(const BatchRow& row) {
  Json json = Json::object();
  for (const auto& cell : row) json[cell.column] = cell.number ? Json(cell.number) : Json(cell.text);
  return json;
}

std::optional<Json> parsed(const std::string& line) {
  auto json = Json::parse(line);
  return json && json->is_object() ? json : std::nullopt;
}

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

// Reads the manifest; returns the number of lines it takes.
std::size_t read_manifest(const std::string& file, const std::vector<std::string>& lines, BatchTable& table) {
  auto& manifest = table.manifest;
  if (const auto json = lines.front().starts_with('{') ? parsed(lines.front()) : std::nullopt) {
    table.format = BatchFormat::jsonl;
    manifest.version = string_entry(*json, "fracfit");
    manifest.command = string_entry(*json, "command");
    manifest.shard = string_entry(*json, "shard");
    const auto laws = list_entry(*json, "laws"), inputs = list_entry(*json, "inputs"),
               columns = list_entry(*json, "columns");
    if (!laws || !inputs || !columns) refuse(file, 1, "found no lists 'laws', 'inputs' and 'columns'");
    manifest.laws = *laws;
    manifest.inputs = *inputs;
    manifest.columns = *columns;
    return 1;
  }
  table.format = BatchFormat::csv;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    const auto& line = lines[i];
    const auto value_of = [&](const char* key) -> std::optional<std::string> {
      const std::string start = std::string("# ") + key + ": ";
      return line.starts_with(start) ? std::optional(line.substr(start.size())) : std::nullopt;
    };
    if (const auto version = value_of("fracfit")) {
      manifest.version = *version;
    } else if (const auto command = value_of("command")) {
      manifest.command = *command;
    } else if (const auto shard = value_of("shard")) {
      manifest.shard = *shard;
    } else if (const auto law = value_of("law")) {
      manifest.laws.push_back(*law);
    } else if (const auto input = value_of("input")) {
      manifest.inputs.push_back(*input);
    } else if (const auto columns = io::split_csv_line(line); columns && columns->front() == "file") {
      manifest.columns = *columns;
      return i + 1;
    } else {
      refuse(file, i + 1, "found " + io::quoted(line));
    }
  }
  refuse(file, 0, "holds no row of column names");
}

bool is_remark(BatchFormat format, const std::string& line) {
  return line.starts_with(format == BatchFormat::csv ? "# " : R"({"remark":)");
}

// All other columns hold numbers.
bool holds_text(const std::string& column) {
  static const std::set<std::string> columns{
      "file", "status", "chosen", "verdict", "model", "message", std::string(fingerprint_column)};
  return columns.contains(column) || column.ends_with("_state");
}

}  // namespace

std::string header_text(BatchFormat format, const BatchManifest& manifest) {
  if (format == BatchFormat::jsonl) {
    Json json{{"fracfit", manifest.version}, {"command", manifest.command}};
    if (!manifest.shard.empty()) json["shard"] = manifest.shard;
    json["laws"] = manifest.laws;
    json["inputs"] = manifest.inputs;
    json["columns"] = manifest.columns;
    return json.dump(-1) + "\n";
  }
  std::string text = "# fracfit: " + manifest.version + "\n# command: " + manifest.command + "\n";
  if (!manifest.shard.empty()) text += "# shard: " + manifest.shard + "\n";
  for (const auto& law : manifest.laws) text += "# law: " + law + "\n";
  for (const auto& input : manifest.inputs) text += "# input: " + input + "\n";
  for (std::size_t i = 0; i < manifest.columns.size(); ++i)
    text += (i > 0 ? "," : "") + io::csv_field(manifest.columns[i]);
  return text + "\n";
}

std::string row_line(BatchFormat format, const BatchRow& row) {
  if (format == BatchFormat::jsonl) return json_row(row).dump(-1);
  std::string line;
  for (std::size_t i = 0; i < row.size(); ++i) line += (i > 0 ? "," : "") + csv_cell(row[i]);
  return line;
}

std::string remark_line(BatchFormat format, const BatchRow& remark) {
  if (format == BatchFormat::jsonl) {
    Json json{{"remark", remark.front().column}};
    json.update(json_row(remark));
    return json.dump(-1) + "\n";
  }
  std::string line = "# " + remark.front().column + ": " + csv_cell(remark.front());
  for (std::size_t i = 1; i < remark.size(); ++i) line += " " + remark[i].column + "=" + csv_cell(remark[i]);
  return line + "\n";
}

std::optional<std::map<std::string, std::string>> read_row(BatchFormat format, const std::vector<std::string>& columns,
                                                           const std::string& line) {
  std::map<std::string, std::string> row;
  if (format == BatchFormat::jsonl) {
    const auto json = parsed(line);
    if (!json || json->size() != columns.size()) return std::nullopt;
    for (const auto& column : columns) {
      const Json* found = json->find(column);
      if (found == nullptr) return std::nullopt;
      if (found->text() != nullptr) row[column] = *found->text();
      if (const auto number = found->number()) row[column] = io::format_number(*number);
    }
    return row;
  }
  const auto fields = io::split_csv_line(line);
  if (!fields || fields->size() != columns.size()) return std::nullopt;
  for (std::size_t i = 0; i < columns.size(); ++i)
    if (!(*fields)[i].empty()) row[columns[i]] = (*fields)[i];
  return row;
}

std::string shard_end(BatchFormat format, const std::string& text) {
  if (format == BatchFormat::csv) return io::checksum_line(io::Fingerprint(text));
  return Json{{"remark", "checksum"}, {"checksum", io::Fingerprint(text).text()}}.dump(-1) + "\n";
}

BatchTable read_batch_table(const std::string& file) {
  const auto text = io::input_text(file);
  const auto lines = io::whole_lines(*text);
  if (lines.empty()) refuse(file, 0, "holds no whole line");
  BatchTable table;
  const std::size_t begin = read_manifest(file, lines, table);
  const auto& manifest = table.manifest;
  const auto shard = manifest.shard.empty() ? io::Shard{} : io::shard_from(manifest.shard);
  if (!shard) refuse(file, 0, "found the shard " + io::quoted(manifest.shard));
  const auto inputs = io::part_of(manifest.inputs, *shard);
  const std::set<std::string> known(inputs.begin(), inputs.end());
  std::size_t above = 0;  // bytes
  for (std::size_t i = 0; i < lines.size(); above += lines[i].size() + 1, ++i) {
    if (i < begin) continue;
    if (is_remark(table.format, lines[i])) {
      const std::string end = shard_end(table.format, text->substr(0, above));
      const std::string_view checksum = "checksum";
      if (lines[i] + "\n" == end)
        table.has_end = true;
      else if (lines[i].starts_with(end.substr(0, end.find(checksum) + checksum.size())))
        throw io::DataError(file, i + 1, 0,
                            "found a checksum that the text above does not have: something in it was changed or lost");
      continue;
    }
    const auto row = read_row(table.format, manifest.columns, lines[i]);
    if (!row || !row->contains("file")) refuse(file, i + 1, "found " + io::quoted(lines[i]));
    for (const auto& [column, value] : *row)
      if (!holds_text(column) && !io::parse_number(value))
        throw io::DataError(file, i + 1, 0,
                            "found " + io::quoted(value) + " in column " + io::quoted(column) + "; expected a number");
    if (!known.contains(row->at("file")))
      throw io::DataError(file, i + 1, 0, "holds a row for " + row->at("file") + ", which is none of its inputs");
    table.rows.emplace_back(row->at("file"), lines[i]);
  }
  return table;
}

}  // namespace fracfit
