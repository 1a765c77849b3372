// SPDX-License-Identifier: BSD-3-Clause
#include "batch/batch_table.hpp"

#include <utility>

#include "io/csv_line.hpp"
#include "io/fingerprint.hpp"
#include "io/number.hpp"
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

}  // namespace

HeaderParts header_parts(BatchFormat format, const BatchManifest& manifest) {
  if (format == BatchFormat::jsonl) {
    Json json{{"fracfit", manifest.version}, {"command", manifest.command}};
    if (!manifest.shard.empty()) json["shard"] = manifest.shard;
    json["laws"] = manifest.laws;
    const std::string before = json.dump(-1), columns = Json(manifest.columns).dump(-1);
    return {before.substr(0, before.size() - 1) + R"(,"inputs":[)", R"(],"columns":)" + columns + "}\n"};
  }
  HeaderParts parts;
  parts.before = "# fracfit: " + manifest.version + "\n# command: " + manifest.command + "\n";
  if (!manifest.shard.empty()) parts.before += "# shard: " + manifest.shard + "\n";
  for (const auto& law : manifest.laws) parts.before += "# law: " + law + "\n";
  for (std::size_t i = 0; i < manifest.columns.size(); ++i)
    parts.behind += (i > 0 ? "," : "") + io::csv_field(manifest.columns[i]);
  parts.behind += "\n";
  return parts;
}

std::string header_text(BatchFormat format, const BatchManifest& manifest) {
  const HeaderParts parts = header_parts(format, manifest);
  std::string text = parts.before;
  if (format == BatchFormat::jsonl) {
    const std::string list = Json(manifest.inputs).dump(-1);
    text += list.substr(1, list.size() - 2);
  } else {
    for (const auto& input : manifest.inputs) text += "# input: " + input + "\n";
  }
  return text + parts.behind;
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

std::string shard_end(BatchFormat format, const io::Fingerprint& above) {
  if (format == BatchFormat::csv) return io::checksum_line(above);
  return Json{{"remark", "checksum"}, {"checksum", above.text()}}.dump(-1) + "\n";
}

}  // namespace fracfit
