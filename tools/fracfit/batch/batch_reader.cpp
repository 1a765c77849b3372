// SPDX-License-Identifier: BSD-3-Clause
#include "batch/batch_reader.hpp"

#include <algorithm>
#include <map>
#include <set>
#include <utility>

#include "io/csv_line.hpp"
#include "io/data_error.hpp"
#include "io/fingerprint.hpp"
#include "io/number.hpp"
#include "io/readable_file.hpp"
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
std::optional<std::string_view> value_of(std::string_view line, std::string_view key) {
  if (!line.starts_with("# ") || !line.substr(2).starts_with(key)) return std::nullopt;
  line.remove_prefix(2 + key.size());
  return line.starts_with(": ") ? std::optional(line.substr(2)) : std::nullopt;
}

constexpr const char* no_lists = "found no lists 'laws', 'inputs' and 'columns'";

// The manifest in the first line of a table of JSON, whose inputs are left out.
BatchManifest json_manifest(const std::string& file, const std::string& line) {
  const auto json = Json::parse(line);
  const auto laws = json ? list_entry(*json, "laws") : std::nullopt,
             columns = json ? list_entry(*json, "columns") : std::nullopt;
  if (!laws || !columns) refuse(file, 1, no_lists);
  return {string_entry(*json, "fracfit"),
          string_entry(*json, "command"),
          string_entry(*json, "shard"),
          *laws,
          {},
          *columns};
}

// Takes a line of the manifest of a CSV that is no input; true at the names of the columns, which are the last.
bool take_csv_line(const std::string& file, std::size_t number, std::string_view line, BatchManifest& manifest) {
  if (const auto law = value_of(line, "law")) {
    manifest.laws.emplace_back(*law);
  } else if (const auto shard = value_of(line, "shard")) {
    manifest.shard = *shard;
  } else if (const auto command = value_of(line, "command")) {
    manifest.command = *command;
  } else if (const auto version = value_of(line, "fracfit")) {
    manifest.version = *version;
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

void check_row(const std::string& file, std::size_t number, BatchFormat format, const std::vector<std::string>& columns,
               std::string_view line) {
  const auto row = read_row(format, columns, std::string(line));
  if (!row || !row->contains("file")) refuse(file, number, "found " + io::quoted(line));
  for (const auto& [column, value] : *row)
    if (!holds_text(column) && !io::parse_number(value))
      throw io::DataError(file, number, 0,
                          "found " + io::quoted(value) + " in column " + io::quoted(column) + "; expected a number");
}

// Whether a mark behind the text is part of it: an odd number of backslashes stands before.
bool goes_on(std::string_view text) {
  const auto last = text.find_last_not_of('\\');
  return (text.size() - (last == std::string_view::npos ? 0 : last + 1)) % 2 == 1;
}

constexpr std::size_t buffer = 1U << 16U;         // bytes read at once
constexpr std::size_t names_at_once = 1U << 16U;  // some 200 bytes each

}  // namespace

InputNames::InputNames(BatchFormat format, int descriptor, const std::string& file, std::size_t begin)
    : format_(format),
      pieces_(descriptor, file, buffer, begin, format == BatchFormat::csv ? '\n' : '"'),
      begin_(begin),
      end_(begin) {}

std::optional<std::string_view> InputNames::next() {
  const auto piece = pieces_.next();
  if (!piece) return std::nullopt;
  if (format_ == BatchFormat::csv) {
    const auto name = value_of(*piece, "input");
    if (name) end_ = pieces_.position();
    return name;
  }
  // What stands before the mark with which a name begins.
  if (*piece != (end_ == begin_ ? "" : ",")) return std::nullopt;
  text_ = '"';
  for (bool is_whole = false; !is_whole;) {
    const auto part = pieces_.next();
    if (!part) return std::nullopt;
    is_whole = !goes_on(*part);
    text_ += *part;
    text_ += '"';
  }
  const bool is_plain = text_.find('\\') == std::string::npos;
  const auto parsed = is_plain ? std::nullopt : Json::parse(text_);
  if (!is_plain && (!parsed || parsed->text() == nullptr)) return std::nullopt;
  end_ = pieces_.position();
  if (is_plain) return std::string_view(text_).substr(1, text_.size() - 2);
  text_ = *parsed->text();
  return text_;
}

BatchReader::BatchReader(std::string file, int descriptor) : file_(std::move(file)), descriptor_(descriptor) {
  if (io::bytes_at(descriptor_, 0, 1, file_) == "{")
    read_json_head();
  else
    read_csv_head();
  if (const auto shard = manifest_.shard.empty() ? io::Shard{} : io::shard_from(manifest_.shard))
    shard_ = *shard;
  else
    refuse(file_, 0, "found the shard " + io::quoted(manifest_.shard));
}

void BatchReader::take_inputs(std::size_t begin) {
  InputNames names(format_, descriptor_, file_, begin);
  while (names.next()) ++inputs_;
  inputs_begin_ = begin;
  inputs_end_ = names.end();
}

void BatchReader::read_csv_head() {
  io::FileLines lines(descriptor_, file_, buffer);
  std::size_t& number = first_row_.number;  // of the next line
  for (bool is_whole = false; !is_whole; ++number) {
    const std::size_t begin = lines.position();
    const auto line = lines.next();
    if (!line) refuse(file_, 0, number == 1 ? "holds no whole line" : "holds no row of column names");
    if (inputs_ == 0 && value_of(*line, "input")) {
      take_inputs(begin);
      number += inputs_ - 1;
      lines = io::FileLines(descriptor_, file_, buffer, inputs_end_);
    } else {
      is_whole = take_csv_line(file_, number, *line, manifest_);
    }
  }
  first_row_.begin = lines.position();
}

void BatchReader::read_json_head() {
  format_ = BatchFormat::jsonl;
  // Up to the mark with which the first input begins.
  io::FileLines pieces(descriptor_, file_, buffer, 0, '"');
  std::string head, key;
  for (;;) {
    const auto piece = pieces.next();
    if (!piece || piece->find('\n') != std::string_view::npos) refuse(file_, 1, no_lists);
    head += *piece;
    if (key == "inputs" && *piece == ":[") break;
    head += '"';
    key = *piece;
  }
  take_inputs(pieces.position() - 1);
  io::FileLines rest(descriptor_, file_, buffer, inputs_end_);
  const auto behind = rest.next();
  if (!behind) refuse(file_, 1, no_lists);
  head += *behind;
  manifest_ = json_manifest(file_, head);
  first_row_ = {rest.position(), 2};
}

std::string BatchReader::text_of_inputs(std::size_t from) const {
  const std::size_t begin = inputs_begin_ + from;
  return io::read_at(descriptor_, begin, std::min(buffer, inputs_end_ - begin), file_);
}

void BatchReader::each_part(const std::function<void(const InputPart&)>& use) const {
  InputNames names(format_, descriptor_, file_, inputs_begin_);
  InputPart part;
  for (std::size_t next = 0; next < inputs_; part.first = next) {
    part.indices.clear();
    part.names.clear();
    for (; next < inputs_ && part.names.size() < names_at_once; ++next) part.names.emplace_back(names.next().value());
    for (std::size_t i = 0; i < part.names.size(); ++i) part.indices.emplace(part.names[i], i);
    use(part);
  }
}

void BatchReader::check() {
  const std::string nothing = shard_end(format_, io::Fingerprint()), name = "checksum";
  const std::string start = nothing.substr(0, nothing.find(name) + name.size());
  io::Fingerprint above;
  for (std::size_t at = 0; at < first_row_.begin; at += buffer)
    above.add(io::read_at(descriptor_, at, std::min(buffer, first_row_.begin - at), file_));
  io::FileLines lines(descriptor_, file_, buffer, first_row_.begin);
  std::size_t checksum = 0;  // the last line that holds one
  for (std::size_t number = first_row_.number; const auto line = lines.next(); ++number) {
    has_end_ = false;
    if (line->starts_with(start)) {
      checksum = number;
      has_end_ = std::string(*line) + "\n" == shard_end(format_, above);
    }
    if (!is_remark(format_, *line)) ++rows_;
    above.add(*line);
    above.add("\n");
  }
  if (has_end_) return;
  each_row(first_row_, [&](const PlacedRow& row) {
    check_row(file_, row.place.number, format_, manifest_.columns, row.line);
    return true;
  });
  if (checksum > 0)
    throw io::DataError(file_, checksum, 0,
                        "found a checksum that is not that of all lines but itself: something was changed or lost");
}

LinePlace BatchReader::each_row(LinePlace from, const std::function<bool(const PlacedRow&)>& take) const {
  io::FileLines lines(descriptor_, file_, buffer, from.begin);
  for (; const auto line = lines.next(); from = {lines.position(), from.number + 1})
    if (!is_remark(format_, *line) && !take({*line, from})) break;
  return from;
}

std::string BatchReader::curve_of(const PlacedRow& row) const {
  const std::string_view line = row.line, start = format_ == BatchFormat::csv ? "" : R"({"file":")";
  const auto end = line.find(format_ == BatchFormat::csv ? ',' : '"', start.size());
  const std::string_view name = line.substr(start.size(), end - start.size());
  if (end != std::string_view::npos && name.find_first_of(R"("\)") == std::string_view::npos) return std::string(name);
  return read_row(format_, manifest_.columns, std::string(line)).value().at("file");
}

std::size_t BatchReader::expected_rows() const {
  return (inputs_ + shard_.count - shard_.index) / shard_.count;
}

BatchRows::BatchRows(const BatchReader& table)
    : table_(&table), next_(table.first_row()), taken_(table.has_end() ? 0 : table.rows()) {}

void BatchRows::take(const InputPart& part, const std::function<void(std::size_t, const PlacedRow&)>& use) {
  const io::Shard& shard = table_->shard();
  const auto is_of_part = [&](const PlacedRow& row) {
    const auto found = part.indices.find(table_->curve_of(row));
    if (found == part.indices.end() || (part.first + found->second) % shard.count != shard.index - 1) return false;
    use(found->second, row);
    return true;
  };
  if (table_->has_end()) {
    next_ = table_->each_row(next_, is_of_part);
    return;
  }
  std::size_t number = 0;
  table_->each_row(next_, [&](const PlacedRow& row) {
    if (is_of_part(row)) taken_[number] = true;
    ++number;
    return true;
  });
}

std::string_view BatchRows::line(std::size_t begin, std::size_t size) {
  if (begin < text_begin_ || begin + size > text_begin_ + text_.size()) {
    constexpr std::size_t some_rows = 1U << 14U;
    text_ = io::bytes_at(table_->descriptor(), begin, std::max(size, some_rows), table_->file());
    text_begin_ = begin;
    if (text_.size() < size) throw std::runtime_error("cannot read " + table_->file() + ": another program has cut it");
  }
  return std::string_view(text_).substr(begin - text_begin_, size);
}

void BatchRows::require_end() const {
  std::size_t number = 0;
  table_->each_row(next_, [&](const PlacedRow& row) {
    if (number < taken_.size() && taken_[number++]) return true;
    throw io::DataError(table_->file(), row.place.number, 0,
                        "holds a row for " + table_->curve_of(row) + ", which is none of its inputs");
  });
}

}  // namespace fracfit
