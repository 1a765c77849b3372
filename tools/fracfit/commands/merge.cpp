// SPDX-License-Identifier: BSD-3-Clause
#include <cstdint>
#include <filesystem>
#include <map>
#include <set>
#include <stdexcept>

#include "batch/batch_power_law.hpp"
#include "batch/batch_table.hpp"
#include "commands/subcommand.hpp"
#include "io/data_error.hpp"
#include "io/shard_file.hpp"
#include "output/document.hpp"

namespace fracfit {
namespace {

void check_agreement(const BatchTable& first, const std::string& first_file, const BatchTable& other,
                     const std::string& other_file) {
  const auto refuse = [&](const std::string& what, const std::string& a, const std::string& b) {
    throw io::DataError(other_file, 0, 0, "has " + what + " " + b + "; expected, as in " + first_file + ", " + a);
  };
  const auto format = [](const BatchTable& table) { return table.format == BatchFormat::csv ? "csv" : "jsonl"; };
  if (first.format != other.format) refuse("format", format(first), format(other));
  if (first.manifest.version != other.manifest.version)
    refuse("version", first.manifest.version, other.manifest.version);
  if (first.manifest.command != other.manifest.command)
    refuse("command", first.manifest.command, other.manifest.command);
  if (first.manifest.inputs != other.manifest.inputs)
    refuse("a list of input files that differs:", std::to_string(first.manifest.inputs.size()) + " files",
           std::to_string(other.manifest.inputs.size()) + " files");
  if (first.manifest.columns != other.manifest.columns)
    throw io::DataError(other_file, 0, 0, "has other columns than " + first_file);
}

class Merge : public Command {
 public:
  Merge() : Command("merge", "Joins the shards of a batch, a sweep or a map") {
    options()
        .texts("IN", in_, "Tables written with --shard by fracfit batch, simulate or map", "FILE")
        .required()
        .names_input();
    options().flag("--status", status_,
                   "Say how far each shard of a sweep or a map is and which are missing; join nothing");
    add_common({"csv", "json", "table"});
    options()["--out"].default_is("none for a joined table, where - is standard output");
    set_footer(
        "All must stem from the same command, on the same files.  The result is that of the command without --shard.\n"
        "Those of a map or a sweep are copied from file to file, so that memory does not grow with them.\n"
        "Examples:\n"
        "  fracfit merge part1.csv part2.csv part3.csv part4.csv --out all.csv\n"
        "  fracfit merge part-*.csv* --status");
  }

 private:
  // A joined table is CSV, or lines of JSON as its shards are; the state of shards can be anything.
  [[nodiscard]] std::string format() const override { return status_ ? Command::format() : "csv"; }

  void check() override {
    if (status_) return;
    if (options()["--format"].is_given() && Command::format() != "csv")
      throw std::invalid_argument("--format " + Command::format() + " has no meaning without --status");
    if (out().empty()) take_old_form();
  }

  int write_states() {
    const std::vector<io::ShardState> states = io::shard_states(in_);
    std::set<std::size_t> finished;
    std::vector<std::size_t> again;
    std::size_t rows = 0;
    for (const auto& state : states) {
      if (state.fault.empty()) finished.insert(state.shard.index);
      rows += state.rows;
    }
    const std::size_t count = states.front().shard.count;
    for (std::size_t i = 1; i <= count; ++i)
      if (!finished.contains(i)) again.push_back(i);
    io::Metadata head{{"finished_shards", std::to_string(finished.size()) + " of " + std::to_string(count)},
                      {"rows", std::to_string(rows)},
                      {"shards_to_do", io::list_of(again)}};
    const Document document{
        std::move(head),
        {{"file", "shard", "rows", "expected_rows", "state"},
         states.size(),
         [&](std::size_t i, std::vector<Cell>& cells) {
           const io::ShardState& state = states[i];
           cells.insert(cells.end(), {state.file, static_cast<std::int64_t>(state.shard.index),
                                      static_cast<std::int64_t>(state.rows), static_cast<std::int64_t>(state.expected),
                                      state.fault.empty() ? "finished" : state.fault});
         }}};
    write(text_of(document, format(), command_line()));
    return again.empty() ? usable_result : no_usable_result;
  }

  // `merge OUT IN...`, where it can be told from inputs alone.
  void take_old_form() {
    if (in_.size() < 2 || (in_.front() != "-" && std::filesystem::exists(in_.front())))
      throw std::invalid_argument(
          "--out is required: the joined table, - for standard output; the arguments are inputs");
    add_note("merge OUT IN... is now merge IN... --out OUT; the old form works in this version for the last time");
    set_out(in_.front());
    in_.erase(in_.begin());
  }

  int run() override {
    const bool is_sweep = io::is_block_table(in_.front());
    if (status_) {
      if (!is_sweep)
        throw std::invalid_argument(
            "--status is for shards of a map or a sweep; of a batch, merge itself says what is missing");
      return write_states();
    }
    if (is_sweep) {
      output().write([&](const io::OutputFile::Sink& sink) { io::join_block_tables(in_, sink); });
      return usable_result;
    }
    BatchTable merged;
    std::vector<std::string> unfinished;
    std::map<std::string, std::pair<std::string, std::string>> rows;  // file: line and where it is from
    for (const auto& name : in_) {
      auto table = read_batch_table(name);
      if (&name == &in_.front())
        merged = table;
      else
        check_agreement(merged, in_.front(), table, name);
      if (!table.manifest.shard.empty() && !table.has_end) {
        if (is_whole(table))
          throw io::DataError(name, 0, 0,
                              "holds all rows of its shard, but not their checksum as the last line: its end was cut "
                              "off or changed; the same command, run again, restores it");
        unfinished.push_back(name);
      }
      for (const auto& [file, line] : table.rows) {
        const auto [found, is_new] = rows.try_emplace(file, line, name);
        if (!is_new)
          throw io::DataError(
              name, 0, 0,
              "holds a row for " + file + ", which " + found->second.second + " holds too; expected each file once");
      }
    }
    merged.manifest.shard.clear();
    std::vector<std::string> lines, missing;
    for (const auto& file : merged.manifest.inputs) {
      const auto found = rows.find(file);
      if (found == rows.end())
        missing.push_back(file);
      else
        lines.push_back(found->second.first);
    }
    std::string text = header_text(merged.format, merged.manifest);
    for (const auto& line : lines) text += line + "\n";
    if (missing.empty()) {
      const auto laws = power_law_remarks(merged.format, merged.manifest, lines);
      text += laws.text;
      for (const auto& note : laws.notes) say(note);
    }
    write(text);
    if (missing.empty()) return usable_result;
    say(std::to_string(missing.size()) + " of " + std::to_string(merged.manifest.inputs.size()) +
        " files are missing: " + io::shortened_list(missing) +
        (unfinished.empty() ? "" : "; cut off or unfinished: " + io::shortened_list(unfinished)) +
        "; the batch without --shard and with this --out does the rest");
    return no_usable_result;
  }

  static bool is_whole(const BatchTable& table) {
    const auto& manifest = table.manifest;
    return table.rows.size() == io::part_of(manifest.inputs, *io::shard_from(manifest.shard)).size();
  }

  std::vector<std::string> in_;
  bool status_ = false;
};

}  // namespace

std::unique_ptr<Command> make_merge() {
  return std::make_unique<Merge>();
}

}  // namespace fracfit
