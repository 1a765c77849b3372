// SPDX-License-Identifier: BSD-3-Clause
#include "io/shard_file.hpp"

#include <algorithm>
#include <array>
#include <map>
#include <optional>
#include <sstream>
#include <stdexcept>
#include <utility>

#include "backlash/describing_function.hpp"
#include "backlash/sweep_pieces.hpp"
#include "io/data_error.hpp"
#include "io/descriptor.hpp"
#include "io/fingerprint.hpp"
#include "io/line_reader.hpp"
#include "io/number.hpp"
#include "io/number_list.hpp"
#include "io/readable_file.hpp"
#include "io/shard.hpp"

namespace io {
namespace {

constexpr std::string_view command_start = "# command: ";
constexpr std::array<std::string_view, 2> commands{"# command: fracfit map ", "# command: fracfit simulate "};
constexpr std::string_view checksum_start = "# checksum: ";
constexpr std::size_t most_text = 1U << 16U;  // bytes of rows that are handed on at once
constexpr std::string_view frequency_column = "omega_rad_s";

// Columns that tell the blocks apart, and the option of the command that holds their values.
constexpr std::array<std::pair<std::string_view, const char*>, 9> options{
    {{"force_n", "--force"},
     {"clearance_m", "--clearance"},
     {"restitution", "--restitution"},
     {"contact_stiffness_n_m", "--contact-stiffness"},
     {"contact_damping_n_s_m", "--contact-damping"},
     {"contact_frequency_rad_s", "--contact-frequency"},
     {"contact_ratio", "--contact-ratio"},
     {"contact_restitution", "--contact-restitution"},
     {frequency_column, "--omega"}}};

// The lines above the rows.
struct Head {
  std::string text;  // without the lines of the shard and of an unfinished table
  Shard shard;
  bool has_shard = false;
  bool is_unfinished = false;
  std::string command;
  std::string columns;
};

// The rows that the command of a head asks for.
struct Grid {
  std::vector<std::string> blocks;  // beginnings of their rows, "20,0.3,0.6,": every combination, first column slowest
  std::vector<std::size_t> owner;   // shard of each block
  std::vector<std::string> omega;
  std::vector<bool> is_regime;  // by column
};

// A shard that is read from its beginning to its end; messages name its lines.
class ShardReader {
 public:
  ShardReader(std::string file, std::size_t buffer)
      : file_(std::move(file)), descriptor_(readable(file_)), lines_(descriptor_.number(), file_, buffer) {
    read_head();
  }

  [[nodiscard]] const std::string& file() const { return file_; }
  [[nodiscard]] const Head& head() const { return head_; }
  [[nodiscard]] std::size_t rows() const { return rows_; }

  [[nodiscard]] Grid grid() const;
  /// Reads a block of rows, checks it against the grid, and hands it on.
  void read_block(const Grid& grid, std::size_t block, const OutputFile::Sink& sink);
  /// Checks what stands below the rows.
  void read_end();
  /// Counts the rows that are left, of whatever kind.
  void count_rows();

 private:
  [[noreturn]] void fail(const std::string& message) const { throw DataError(file_, number_, 1, message); }
  // The next line, valid until the one after it; nothing at the end.
  std::optional<std::string_view> next();
  void take(std::string_view line);  // into the fingerprint
  void read_head();
  [[nodiscard]] std::vector<double> values_of(std::string_view column) const;
  void check_row(const Grid& grid, std::size_t block, std::size_t point, std::string_view row);

  std::string file_;
  Descriptor descriptor_;
  FileLines lines_;
  Head head_;
  Fingerprint fingerprint_;
  std::size_t number_ = 0;  // of the line, from 1
  std::size_t rows_ = 0;
  std::vector<std::string_view> fields_;
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

void split(std::string_view line, std::vector<std::string_view>& fields) {
  fields.clear();
  for (;;) {
    const auto end = line.find(',');
    fields.push_back(line.substr(0, end));
    if (end == std::string_view::npos) return;
    line.remove_prefix(end + 1);
  }
}

std::optional<std::string_view> ShardReader::next() {
  const auto line = lines_.next();
  if (line) ++number_;
  return line;
}

void ShardReader::take(std::string_view line) {
  fingerprint_.add(line);
  fingerprint_.add("\n");
}

void ShardReader::read_head() {
  const std::string shard_start = "# " + std::string(shard_key) + ": ";
  while (const auto line = next()) {
    take(*line);
    if (*line == unfinished_line) {
      head_.is_unfinished = true;
      continue;
    }
    if (line->starts_with(shard_start)) {
      const auto shard = shard_from(line->substr(shard_start.size()));
      if (!shard) fail("found " + quoted(*line) + "; expected '# shard: i/n'");
      head_.shard = *shard;
      head_.has_shard = true;
      continue;
    }
    head_.text += std::string(*line) + "\n";
    if (line->starts_with(command_start)) head_.command = *line;
    if (line->starts_with('#')) continue;
    if (head_.command.empty()) fail("found no line '# command: ...' above the names of the columns");
    head_.columns = *line;
    return;
  }
  fail("found no row with the names of the columns; the file is cut off");
}

// The values of a column as the grid in the command says.
std::vector<double> ShardReader::values_of(std::string_view column) const {
  const auto* const option =
      std::find_if(options.begin(), options.end(), [&](const auto& each) { return each.first == column; });
  if (option == options.end())
    fail("found column " + quoted(column) +
         " before the frequency; expected force_n, clearance_m, restitution or those of a contact");
  const auto value = option_value(head_.command, option->second);
  if (!value) fail("found no " + std::string(option->second) + " in the command");
  try {
    return parse_grid(*value, option->second);
  } catch (const std::invalid_argument& error) {
    fail(error.what());
  }
}

Grid ShardReader::grid() const {
  std::vector<std::string_view> columns;
  split(head_.columns, columns);
  const auto frequency = std::find(columns.begin(), columns.end(), frequency_column);
  if (frequency == columns.begin() || frequency == columns.end())
    fail("holds a single curve; expected a table written with --shard");
  Grid grid{{""}, {}, {}, {}};
  for (const double omega : values_of(frequency_column)) grid.omega.push_back(format_number(omega));
  std::vector<double> cost{1};  // of each block
  for (auto column = columns.begin(); column != frequency; ++column) {
    const auto values = values_of(*column);
    std::vector<std::string> longer;
    std::vector<double> of_longer;
    for (std::size_t block = 0; block < grid.blocks.size(); ++block) {
      for (const double value : values) {
        longer.push_back(grid.blocks[block] + format_number(value) + ",");
        of_longer.push_back(*column == "restitution" ? backlash::expected_cost(value) : cost[block]);
      }
    }
    grid.blocks = std::move(longer);
    cost = std::move(of_longer);
  }
  grid.owner = shards_of(cost, head_.shard.count);
  for (const auto column : columns) grid.is_regime.push_back(column == "regime");
  return grid;
}

void ShardReader::check_row(const Grid& grid, std::size_t block, std::size_t point, std::string_view row) {
  const std::string &start = grid.blocks[block], &omega = grid.omega[point];
  const std::string_view rest = row.substr(std::min(row.size(), start.size()));
  if (!row.starts_with(start) || !rest.starts_with(omega) || rest.size() == omega.size() || rest[omega.size()] != ',')
    fail("found " + quoted(row) + "; expected a row that begins with " + quoted(start + omega + ",") +
         ", as the grid of the command says");
  split(row, fields_);
  if (fields_.size() != grid.is_regime.size())
    fail("found " + std::to_string(fields_.size()) + " fields; expected " + std::to_string(grid.is_regime.size()) +
         " as the names of the columns say");
  for (std::size_t i = 0; i < fields_.size(); ++i) {
    if (!grid.is_regime[i]) {
      if (!is_number(fields_[i]))
        fail("found " + quoted(fields_[i]) + " in column " + std::to_string(i + 1) + "; expected a number");
      continue;
    }
    try {
      static_cast<void>(backlash::regime_from_string(fields_[i]));
    } catch (const std::invalid_argument& error) {
      fail(error.what());
    }
  }
}

void ShardReader::read_block(const Grid& grid, std::size_t block, const OutputFile::Sink& sink) {
  std::string text;
  for (std::size_t point = 0; point < grid.omega.size(); ++point) {
    const auto row = next();
    if (!row || row->starts_with('#'))
      fail("ends after " + std::to_string(rows_) + " rows; expected the next one to begin with " +
           quoted(grid.blocks[block] + grid.omega[point] + ",") + ", as the grid of the command says");
    check_row(grid, block, point, *row);
    take(*row);
    text += *row;
    text += '\n';
    ++rows_;
    if (text.size() < most_text) continue;
    sink(text);
    text.clear();
  }
  sink(text);
}

void ShardReader::read_end() {
  const std::string expected = std::string(checksum_start) + fingerprint_.text();
  const auto line = next();
  if (!line) {
    if (head_.has_shard) fail("expected '# checksum: ...' as the last line of a shard; the end of the file is missing");
    return;
  }
  if (!line->starts_with(checksum_start)) fail("found " + quoted(*line) + " below the last row of the grid");
  if (*line != expected)
    fail("found " + quoted(*line) + "; the text above has " + quoted(fingerprint_.text()) +
         ": something in it was changed or lost");
  if (next()) fail("found a line below the checksum");
}

void ShardReader::count_rows() {
  while (const auto line = next()) rows_ += line->starts_with('#') ? 0U : 1U;
}

// Each shard is read through a buffer of its own; together they stay small.
std::size_t buffer_for(std::size_t files) {
  constexpr std::size_t all = 16U << 20U, least = 1U << 12U, most = 1U << 18U;
  return std::clamp(all / std::max<std::size_t>(files, 1), least, most);
}

void require_same_table(const ShardReader& first, const ShardReader& other) {
  if (other.head().text != first.head().text)
    throw DataError(other.file(), 0, 0, "stems from another command or version than " + first.file());
  require_shard_count(first.head().shard.count, other.head().shard.count, first.file(), other.file());
}

void require_block_table(const std::string& file, const std::string& first) {
  if (!is_block_table(file))
    throw DataError(file, 0, 0, "is no map or sweep; expected a table written with --shard, as " + first);
}

}  // namespace

std::string checksum_line(const Fingerprint& text) {
  return std::string(checksum_start) + text.text() + "\n";
}

void require_shard_count(std::size_t of_first, std::size_t count, const std::string& first, const std::string& file) {
  if (count == of_first) return;
  throw DataError(file, 0, 0,
                  "is one of " + std::to_string(count) + " shards; expected, as in " + first + ", one of " +
                      std::to_string(of_first));
}

bool is_block_table(const std::string& file) {
  const Descriptor descriptor = readable(file);
  constexpr std::size_t some_lines = 1U << 12U;
  std::istringstream lines(bytes_at(descriptor.number(), 0, some_lines, file));
  // The command stands behind the version, and behind the line of an unfinished table.
  std::string line;
  for (int i = 0; i < 3 && std::getline(lines, line); ++i)
    if (std::ranges::any_of(commands, [&](std::string_view command) { return line.starts_with(command); })) return true;
  return false;
}

void join_block_tables(const std::vector<std::string>& files, const OutputFile::Sink& sink) {
  allow_open_files(files.size());
  std::map<std::size_t, ShardReader> shards;  // by index
  const ShardReader* first = nullptr;
  for (const std::string& file : files) {
    require_block_table(file, files.front());
    ShardReader reader(file, buffer_for(files.size()));
    if (reader.head().is_unfinished)
      throw DataError(file, 0, 0, "is not finished; the command of its shard, given again, goes on with what is left");
    const std::size_t index = reader.head().shard.index;
    if (first != nullptr) require_same_table(*first, reader);
    const auto [at, is_new] = shards.try_emplace(index, std::move(reader));
    if (!is_new) throw DataError(file, 0, 0, "is shard " + std::to_string(index) + ", which another file holds too");
    if (first == nullptr) first = &at->second;
  }
  const Head& head = first->head();
  std::vector<std::size_t> missing;
  for (std::size_t i = 1; i <= head.shard.count; ++i)
    if (!shards.contains(i)) missing.push_back(i);
  if (!missing.empty())
    throw DataError(files.front(), 0, 0,
                    (missing.size() == 1
                         ? "shard " + text_of(Shard{missing.front(), head.shard.count}) + " is missing"
                         : "shards " + list_of(missing) + " of " + std::to_string(head.shard.count) + " are missing") +
                        "; for sbatch: --array=" + list_of(missing));
  const Grid grid = first->grid();
  sink(head.text);
  for (std::size_t block = 0; block < grid.blocks.size(); ++block)
    shards.at(grid.owner[block]).read_block(grid, block, sink);
  for (auto& [index, shard] : shards) shard.read_end();
}

std::vector<ShardState> shard_states(const std::vector<std::string>& files) {
  std::vector<ShardState> states;
  std::optional<ShardReader> first;
  std::optional<Grid> grid;
  for (const std::string& file : files) {
    require_block_table(file, files.front());
    ShardReader reader(file, buffer_for(1));
    if (first)
      require_same_table(*first, reader);
    else
      grid = reader.grid();
    const Shard shard = reader.head().shard;
    ShardState& state = states.emplace_back(ShardState{file, shard, 0, 0, ""});
    std::vector<std::size_t> blocks;
    for (std::size_t block = 0; block < grid->blocks.size(); ++block)
      if (grid->owner[block] == shard.index) blocks.push_back(block);
    state.expected = blocks.size() * grid->omega.size();
    if (reader.head().is_unfinished) {
      reader.count_rows();
      state.fault = "unfinished";
    } else {
      try {
        for (const std::size_t block : blocks) reader.read_block(*grid, block, [](std::string_view) {});
        reader.read_end();
      } catch (const DataError& error) {
        state.fault = error.what();
      }
    }
    state.rows = reader.rows();
    if (!first) first.emplace(std::move(reader));
  }
  return states;
}

}  // namespace io
