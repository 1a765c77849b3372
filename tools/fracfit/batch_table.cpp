// SPDX-License-Identifier: BSD-3-Clause
#include "batch_table.hpp"

#include <cmath>
#include <nlohmann/json.hpp>
#include <set>
#include <stdexcept>

#include "common_options.hpp"
#include "io/csv_line.hpp"
#include "io/data_error.hpp"
#include "io/input_text.hpp"
#include "io/number.hpp"
#include "io/shard.hpp"
#include "io/shard_file.hpp"

namespace fracfit {
namespace {

using Json = nlohmann::ordered_json;

std::string text_of(const Json& json) {
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

std::string csv_cell(const BatchCell& cell) {
  if (cell.number) return io::format_number(*cell.number);
  return cell.text ? io::csv_field(*cell.text) : std::string();
}

Json json_row(const BatchRow& row) {
  Json json = Json::object();
  for (const auto& cell : row) {
    if (cell.number && std::isfinite(*cell.number))
      json[cell.column] = *cell.number;
    else if (cell.text)
      json[cell.column] = *cell.text;
    else
      json[cell.column] = nullptr;
  }
  return json;
}

std::optional<Json> parsed(const std::string& line) {
  auto json = Json::parse(line, nullptr, false);
  if (!json.is_object()) return std::nullopt;
  return json;
}

[[noreturn]] void refuse(const std::string& file, std::size_t line, const std::string& what) {
  throw io::DataError(file, line, 0, what + "; expected a table written by fracfit batch");
}

std::string string_entry(const Json& json, const char* key) {
  const auto found = json.find(key);
  return found != json.end() && found->is_string() ? found->get<std::string>() : std::string();
}

// Reads the manifest; returns the number of lines it takes.
std::size_t read_manifest(const std::string& file, const std::vector<std::string>& lines, BatchTable& table) {
  auto& manifest = table.manifest;
  if (const auto json = lines.front().starts_with('{') ? parsed(lines.front()) : std::nullopt) {
    table.format = BatchFormat::jsonl;
    manifest.version = string_entry(*json, "fracfit");
    manifest.command = string_entry(*json, "command");
    manifest.shard = string_entry(*json, "shard");
    try {
      manifest.laws = json->at("laws").get<std::vector<std::string>>();
      manifest.inputs = json->at("inputs").get<std::vector<std::string>>();
      manifest.columns = json->at("columns").get<std::vector<std::string>>();
    } catch (const Json::exception&) {
      refuse(file, 1, "found no lists 'laws', 'inputs' and 'columns'");
    }
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
    return text_of(json) + "\n";
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
  if (format == BatchFormat::jsonl) return text_of(json_row(row));
  std::string line;
  for (std::size_t i = 0; i < row.size(); ++i) line += (i > 0 ? "," : "") + csv_cell(row[i]);
  return line;
}

std::string remark_line(BatchFormat format, const BatchRow& remark) {
  if (format == BatchFormat::jsonl) {
    Json json{{"remark", remark.front().column}};
    json.update(json_row(remark));
    return text_of(json) + "\n";
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
      const auto found = json->find(column);
      if (found == json->end()) return std::nullopt;
      if (found->is_string()) row[column] = found->get<std::string>();
      if (found->is_number()) row[column] = io::format_number(found->get<double>());
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
  if (format == BatchFormat::csv) return io::checksum_line(text);
  return text_of(Json{{"remark", "checksum"}, {"checksum", io::fingerprint(text)}}) + "\n";
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
      if (lines[i] + "\n" == end)
        table.has_end = true;
      else if (lines[i].starts_with(end.substr(0, end.find("checksum") + 8)))
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
