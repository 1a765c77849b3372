// SPDX-License-Identifier: BSD-3-Clause
#include "io/shard_file.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <map>
#include <optional>
#include <stdexcept>
#include <utility>

#include "backlash/describing_function.hpp"
#include "io/data_error.hpp"
#include "io/input_text.hpp"
#include "io/number.hpp"
#include "io/number_list.hpp"
#include "io/shard.hpp"

namespace io {
namespace {

constexpr std::string_view command_start = "# command: ";
constexpr std::array<std::string_view, 2> commands{"# command: fracfit map ", "# command: fracfit simulate "};
constexpr std::string_view checksum_start = "# checksum: ";
constexpr std::string_view frequency_column = "omega_rad_s";

// Columns that tell the blocks apart, and the option of the command that holds their values.
constexpr std::array<std::pair<std::string_view, const char*>, 4> options{{{"force_n", "--force"},
                                                                           {"clearance_m", "--clearance"},
                                                                           {"restitution", "--restitution"},
                                                                           {frequency_column, "--omega"}}};

// A file under inspection.
struct Inspected {
  std::string file;
  std::vector<std::string> lines;
  std::size_t command = 0;  // numbers of lines, from 0
  std::size_t columns = 0;

  [[noreturn]] void fail(std::size_t line, const std::string& message) const {
    throw DataError(file, line + 1, 1, message);
  }
};

// Value of an option in a command line that CommandLine has written; blanks stand in quotes.
std::optional<std::string> option_value(std::string_view command, std::string_view option) {
  const std::string wanted = " " + std::string(option) + " ";
  const auto at = command.find(wanted);
  if (at == std::string_view::npos) return std::nullopt;
  const std::string_view rest = command.substr(at + wanted.size());
  if (rest.starts_with('\'')) return std::string(rest.substr(1, rest.find('\'', 1) - 1));
  return std::string(rest.substr(0, rest.find(' ')));
}

// The values of a column as the grid in the command says, as they stand in the rows.
std::vector<std::string> grid_texts(const Inspected& table, std::string_view column) {
  const auto* const option =
      std::find_if(options.begin(), options.end(), [&](const auto& each) { return each.first == column; });
  if (option == options.end())
    table.fail(table.columns, "found column " + quoted(column) +
                                  " before the frequency; expected force_n, clearance_m or restitution");
  const auto value = option_value(table.lines[table.command], option->second);
  if (!value) table.fail(table.command, "found no " + std::string(option->second) + " in the command");
  std::vector<std::string> texts;
  try {
    for (const double number : parse_grid(*value, option->second)) texts.push_back(format_number(number));
  } catch (const std::invalid_argument& error) {
    table.fail(table.command, error.what());
  }
  return texts;
}

std::vector<std::string_view> fields_of(std::string_view line) {
  std::vector<std::string_view> fields;
  for (;;) {
    const auto end = line.find(',');
    fields.push_back(line.substr(0, end));
    if (end == std::string_view::npos) return fields;
    line.remove_prefix(end + 1);
  }
}

// Beginnings of the blocks, "20,0.3,0.6,": every combination of the values, the first column slowest.
std::vector<std::string> block_keys(const Inspected& table, const std::vector<std::string_view>& columns) {
  std::vector<std::string> keys{""};
  for (const auto column : columns) {
    const auto values = grid_texts(table, column);
    std::vector<std::string> longer;
    for (const auto& key : keys)
      for (const auto& value : values) longer.push_back(key + value + ",");
    keys = std::move(longer);
  }
  return keys;
}

struct Part {
  std::string header;  // without the line of the shard
  Shard shard;
  std::vector<std::string> blocks;
};

// Finds the lines of the header, and in them the shard; true where a line names one.
bool read_header(Inspected& table, Part& part) {
  const std::string shard_start = "# " + std::string(shard_key) + ": ";
  bool has_shard = false, has_command = false;
  for (std::size_t i = 0; i < table.lines.size(); ++i) {
    const std::string& line = table.lines[i];
    if (line.starts_with(shard_start)) {
      const auto shard = shard_from(std::string_view(line).substr(shard_start.size()));
      if (!shard) table.fail(i, "found " + quoted(line) + "; expected '# shard: i/n'");
      part.shard = *shard;
      has_shard = true;
      continue;
    }
    part.header += line + "\n";
    if (line.starts_with(command_start)) {
      table.command = i;
      has_command = true;
    }
    if (line.starts_with('#')) continue;
    table.columns = i;
    if (!has_command) table.fail(0, "found no line '# command: ...' above the names of the columns");
    return has_shard;
  }
  table.fail(table.lines.size(), "found no row with the names of the columns; the file is cut off");
}

void check_row(const Inspected& table, std::size_t line, const std::string& expected_start,
               const std::vector<std::string_view>& columns) {
  const std::string& row = table.lines[line];
  if (!row.starts_with(expected_start))
    table.fail(line, "found " + quoted(row) + "; expected a row that begins with " + quoted(expected_start) +
                         ", as the grid of the command says");
  const auto fields = fields_of(row);
  if (fields.size() != columns.size())
    table.fail(line, "found " + std::to_string(fields.size()) + " fields; expected " + std::to_string(columns.size()) +
                         " as in line " + std::to_string(table.columns + 1));
  for (std::size_t i = 0; i < fields.size(); ++i) {
    if (columns[i] != "regime") {
      if (!parse_number(fields[i]))
        table.fail(line, "found " + quoted(fields[i]) + " in column " + quoted(columns[i]) + "; expected a number");
      continue;
    }
    try {
      static_cast<void>(backlash::regime_from_string(fields[i]));
    } catch (const std::invalid_argument& error) {
      table.fail(line, error.what());
    }
  }
}

// Checks the checksum line and removes it from the lines.
void check_checksum(Inspected& table, std::string_view text, bool required) {
  if (!table.lines.empty() && table.lines.back().starts_with(checksum_start)) {
    const std::string_view above = text.substr(0, text.size() - table.lines.back().size() - 1);
    if (table.lines.back() + "\n" != checksum_line(above))
      table.fail(table.lines.size() - 1, "found " + quoted(table.lines.back()) + "; the text above has " +
                                             quoted(fingerprint(above)) + ": something in it was changed or lost");
    table.lines.pop_back();
  } else if (required) {
    table.fail(table.lines.size(),
               "expected '# checksum: ...' as the last line of a shard; the end of the file is missing");
  }
}

Part read_part(const std::string& file) {
  const auto text = input_text(file);
  Inspected table{file, whole_lines(*text)};
  if (!text->ends_with('\n')) table.fail(table.lines.size(), "ends within a line; the file is cut off");
  Part part;
  const bool has_shard = read_header(table, part);
  const auto columns = fields_of(table.lines[table.columns]);
  const auto frequency = std::find(columns.begin(), columns.end(), frequency_column);
  if (frequency == columns.begin() || frequency == columns.end())
    table.fail(table.columns, "holds a single curve; expected a table written with --shard");
  const auto keys = part_of(block_keys(table, {columns.begin(), frequency}), part.shard);
  const auto omega = grid_texts(table, frequency_column);

  const std::size_t begin = table.columns + 1;
  const bool has_checksum = table.lines.back().starts_with(checksum_start);
  const std::size_t end = table.lines.size() - (has_checksum ? 1 : 0);
  const std::size_t expected = keys.size() * omega.size();
  for (std::size_t i = 0; i < std::min(expected, end - begin); ++i)
    check_row(table, begin + i, keys[i / omega.size()] + omega[i % omega.size()] + ",", columns);
  if (end - begin != expected)
    table.fail(std::min(end, begin + expected), "found " + std::to_string(end - begin) + " rows; expected " +
                                                    std::to_string(expected) + ", " + std::to_string(keys.size()) +
                                                    " times the " + std::to_string(omega.size()) +
                                                    " frequencies of the command");
  check_checksum(table, *text, has_shard);
  for (std::size_t block = 0; block < keys.size(); ++block) {
    part.blocks.emplace_back();
    for (std::size_t i = 0; i < omega.size(); ++i)
      part.blocks.back() += table.lines[begin + block * omega.size() + i] + "\n";
  }
  return part;
}

}  // namespace

std::optional<Shard> shard_from(std::string_view text) {
  Shard shard;
  const char* const end = text.data() + text.size();
  const auto index = std::from_chars(text.data(), end, shard.index);
  if (index.ec != std::errc{} || index.ptr == end || *index.ptr != '/') return std::nullopt;
  const auto count = std::from_chars(index.ptr + 1, end, shard.count);
  if (count.ec != std::errc{} || count.ptr != end) return std::nullopt;
  if (shard.index < 1 || shard.index > shard.count) return std::nullopt;
  return shard;
}

std::string checksum_line(std::string_view text) {
  return std::string(checksum_start) + fingerprint(text) + "\n";
}

bool is_block_table(const std::string& file) {
  const auto text = input_text(file);
  std::string_view rest = *text;
  for (int i = 0; i < 2; ++i) {
    if (std::ranges::any_of(commands, [&](std::string_view command) { return rest.starts_with(command); })) return true;
    rest.remove_prefix(std::min(rest.find('\n'), rest.size() - 1) + 1);
    if (rest.empty()) break;
  }
  return false;
}

std::string joined_block_table(const std::vector<std::string>& files) {
  std::map<std::size_t, Part> parts;  // by index
  std::size_t count = 0;
  std::string header;
  for (const std::string& file : files) {
    if (!is_block_table(file))
      throw DataError(file, 0, 0, "is no map or sweep; expected a table written with --shard, as " + files.front());
    Part part = read_part(file);
    if (parts.empty()) {
      header = part.header;
      count = part.shard.count;
    }
    if (part.header != header)
      throw DataError(file, 0, 0, "stems from another command or version than " + files.front());
    if (part.shard.count != count)
      throw DataError(file, 0, 0,
                      "is one of " + std::to_string(part.shard.count) + " shards; expected, as in " + files.front() +
                          ", one of " + std::to_string(count));
    const std::size_t index = part.shard.index;
    if (!parts.emplace(index, std::move(part)).second)
      throw DataError(file, 0, 0, "is shard " + std::to_string(index) + ", which another file holds too");
  }
  for (std::size_t i = 1; i <= count; ++i)
    if (!parts.contains(i)) throw DataError(files.front(), 0, 0, "shard " + text_of(Shard{i, count}) + " is missing");
  std::string text = header;
  for (std::size_t block = 0; block < parts.at(1).blocks.size(); ++block) {
    for (const auto& [index, part] : parts)
      if (block < part.blocks.size()) text += part.blocks[block];
  }
  return text;
}

}  // namespace io
