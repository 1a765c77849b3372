// SPDX-License-Identifier: BSD-3-Clause
#include "io/shard_file.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <fstream>
#include <optional>
#include <string_view>

#include "io/data_error.hpp"
#include "io/result_stream.hpp"
#include "io/shard.hpp"

namespace io {
namespace {

constexpr std::array<std::string_view, 2> commands{"# command: fracfit map ", "# command: fracfit simulate "};

std::optional<Shard> shard_of(std::string_view text) {
  Shard shard;
  const char* const end = text.data() + text.size();
  const auto index = std::from_chars(text.data(), end, shard.index);
  if (index.ec != std::errc{} || index.ptr == end || *index.ptr != '/') return std::nullopt;
  const auto count = std::from_chars(index.ptr + 1, end, shard.count);
  if (count.ec != std::errc{} || count.ptr != end) return std::nullopt;
  if (shard.index < 1 || shard.index > shard.count) return std::nullopt;
  return shard;
}

// Beginning of a line up to the comma that follows `fields` fields.
std::string_view leading_fields(std::string_view line, std::size_t fields) {
  std::size_t end = 0;
  for (; fields > 0; --fields) end = line.find(',', end) + 1;
  return line.substr(0, end);
}

struct Part {
  std::string header;  // without the line of the shard
  Shard shard;
  std::vector<std::string> blocks;
};

Part read_part(const std::string& file) {
  const std::string shard_line = "# " + std::string(shard_key) + ": ";
  const std::vector<std::string> lines = whole_lines(file);
  Part part;
  std::size_t i = 0;
  bool has_columns = false;
  for (; i < lines.size() && !has_columns; ++i) {
    if (lines[i].starts_with(shard_line)) {
      const auto shard = shard_of(std::string_view(lines[i]).substr(shard_line.size()));
      if (!shard) throw DataError(file, i + 1, 1, "found " + quoted(lines[i]) + "; expected '# shard: i/n'");
      part.shard = *shard;
      continue;
    }
    has_columns = !lines[i].starts_with("#");
    part.header += lines[i] + "\n";
  }
  const std::string_view columns = i > 0 ? std::string_view(lines[i - 1]) : std::string_view();
  const auto frequency = columns.find("omega_rad_s");
  if (!has_columns || frequency == std::string_view::npos || frequency == 0)
    throw DataError(file, i, 1, "holds a single curve; expected a table written with --shard");
  const auto key_fields = static_cast<std::size_t>(
      std::count(columns.begin(), columns.begin() + static_cast<std::ptrdiff_t>(frequency), ','));
  std::string_view last;
  for (; i < lines.size(); ++i) {
    const std::string_view key = leading_fields(lines[i], key_fields);
    if (part.blocks.empty() || key != last) part.blocks.emplace_back();
    part.blocks.back() += lines[i] + "\n";
    last = key;
  }
  return part;
}

}  // namespace

bool is_block_table(const std::string& file) {
  std::ifstream stream(file);
  std::string line;
  for (int i = 0; i < 2 && std::getline(stream, line); ++i) {
    if (std::ranges::any_of(commands, [&](std::string_view command) { return line.starts_with(command); })) return true;
  }
  return false;
}

std::string joined_block_table(const std::vector<std::string>& files) {
  std::vector<std::optional<Part>> parts;
  std::string header;
  for (const std::string& file : files) {
    if (!is_block_table(file))
      throw DataError(file, 0, 0, "is no map or sweep; expected a table written with --shard, as " + files.front());
    Part part = read_part(file);
    if (parts.empty()) {
      header = part.header;
      parts.resize(part.shard.count);
    }
    if (part.header != header)
      throw DataError(file, 0, 0, "stems from another command or version than " + files.front());
    if (part.shard.count != parts.size())
      throw DataError(file, 0, 0,
                      "is one of " + std::to_string(part.shard.count) + " shards; expected, as in " + files.front() +
                          ", one of " + std::to_string(parts.size()));
    auto& place = parts[part.shard.index - 1];
    if (place)
      throw DataError(file, 0, 0, "is shard " + std::to_string(part.shard.index) + ", which another file holds too");
    place = std::move(part);
  }
  std::string text = header;
  std::size_t most = 0;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    if (!parts[i])
      throw DataError(files.front(), 0, 0,
                      "shard " + std::to_string(i + 1) + "/" + std::to_string(parts.size()) + " is missing");
    most = std::max(most, parts[i]->blocks.size());
  }
  for (std::size_t block = 0; block < most; ++block) {
    for (const auto& part : parts) {
      if (block < part->blocks.size()) text += part->blocks[block];
    }
  }
  return text;
}

}  // namespace io
