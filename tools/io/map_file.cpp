#include "io/map_file.hpp"

#include <charconv>
#include <fstream>
#include <optional>

#include "io/data_error.hpp"
#include "io/number.hpp"
#include "io/result_stream.hpp"
#include "io/sweep_file.hpp"

namespace io {
namespace {

constexpr std::string_view map_command = "# command: fracfit map ";
constexpr std::string_view shard_key = "# shard: ";

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

// The lines of one shard; the rows in blocks of one restitution each.
struct Part {
  std::string header;  // without the line of the shard
  Shard shard;
  std::vector<std::string> blocks;
};

Part read_part(const std::string& file) {
  const std::vector<std::string> lines = whole_lines(file);
  Part part;
  std::size_t i = 0;
  bool has_columns = false;
  for (; i < lines.size() && !has_columns; ++i) {
    if (lines[i].starts_with(shard_key)) {
      const auto shard = shard_of(std::string_view(lines[i]).substr(shard_key.size()));
      if (!shard) throw DataError(file, i + 1, 1, "found " + quoted(lines[i]) + "; expected '# shard: i/n'");
      part.shard = *shard;
      continue;
    }
    has_columns = !lines[i].starts_with("#");
    part.header += lines[i] + "\n";
  }
  std::string_view last;
  for (; i < lines.size(); ++i) {
    const std::string_view restitution = std::string_view(lines[i]).substr(0, lines[i].find(','));
    if (part.blocks.empty() || restitution != last) part.blocks.emplace_back();
    part.blocks.back() += lines[i] + "\n";
    last = restitution;
  }
  return part;
}

}  // namespace

std::string map_csv(const backlash::RegimeMap& map, const std::string& command, const Shard& shard) {
  Metadata scene{{"mass1_kg", format_number(map.scene.mass1)},
                 {"mass2_kg", format_number(map.scene.mass2)},
                 {"clearance_m", format_number(map.scene.clearance)},
                 {"force_n", format_number(map.scene.force_amplitude)},
                 {"output", std::string(backlash::to_string(map.options.output))},
                 {"protocol", std::string(backlash::to_string(map.options.protocol))},
                 {"tolerance", format_number(map.options.tolerance)},
                 {"mean_tolerance", format_number(map.options.mean_tolerance)}};
  if (shard.count > 1) scene.emplace_back("shard", std::to_string(shard.index) + "/" + std::to_string(shard.count));
  std::string text = header_lines(scene, command);
  text += "restitution," + std::string(point_columns(PointColumns::with_diagnostics)) + "\n";
  for (std::size_t i = 0; i < map.restitution.size(); ++i) {
    const std::string restitution = format_number(map.restitution[i]) + ",";
    for (std::size_t j = 0; j < map.omega.size(); ++j) {
      text += restitution;
      append_point(text, map.at(i, j), PointColumns::with_diagnostics);
      text += '\n';
    }
  }
  return text;
}

bool is_map_file(const std::string& file) {
  std::ifstream stream(file);
  std::string line;
  for (int i = 0; i < 2 && std::getline(stream, line); ++i) {
    if (line.starts_with(map_command)) return true;
  }
  return false;
}

std::string joined_map_csv(const std::vector<std::string>& files) {
  std::vector<std::optional<Part>> parts;
  std::string header;
  for (const std::string& file : files) {
    if (!is_map_file(file)) throw DataError(file, 0, 0, "is no map; expected a file written by fracfit map --shard");
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
