// SPDX-License-Identifier: BSD-3-Clause
#include <filesystem>
#include <map>
#include <stdexcept>

#include "batch/batch_power_law.hpp"
#include "batch/batch_table.hpp"
#include "commands/subcommand.hpp"
#include "io/data_error.hpp"
#include "io/shard_file.hpp"

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
    options().texts("IN", in_, "Tables written with --shard by fracfit batch, simulate or map", "FILE").required();
    add_common({"csv"});
    set_footer(
        "All must stem from the same command, on the same files.  The result is that of the command without --shard.\n"
        "Example:\n"
        "  fracfit merge part1.csv part2.csv part3.csv part4.csv --out all.csv");
  }

 private:
  void check() override {
    if (out().empty()) take_old_form();
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

  [[nodiscard]] std::vector<std::string> inputs() const override { return in_; }

  int run() override {
    if (io::is_block_table(in_.front())) {
      write(io::joined_block_table(in_));
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
      if (!table.manifest.shard.empty() && !table.has_end) unfinished.push_back(name);
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

  std::vector<std::string> in_;
};

}  // namespace

std::unique_ptr<Command> make_merge() {
  return std::make_unique<Merge>();
}

}  // namespace fracfit
