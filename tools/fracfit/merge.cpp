// SPDX-License-Identifier: BSD-3-Clause
#include <CLI/CLI.hpp>
#include <map>
#include <memory>
#include <stdexcept>

#include "batch_power_law.hpp"
#include "batch_table.hpp"
#include "common_options.hpp"
#include "exit_code.hpp"
#include "io/data_error.hpp"
#include "io/shard_file.hpp"
#include "subcommand.hpp"

namespace fracfit {
namespace {

struct MergeArguments {
  std::string out;
  std::vector<std::string> in;
};

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

int run_merge(const MergeArguments& given) {
  const io::OutputFile out(given.out, given.in);
  if (io::is_block_table(given.in.front())) {
    out.write(io::joined_block_table(given.in));
    return usable_result;
  }
  BatchTable merged;
  std::vector<std::string> unfinished;
  std::map<std::string, std::pair<std::string, std::string>> rows;  // file: line and where it is from
  for (const auto& name : given.in) {
    auto table = read_batch_table(name);
    if (&name == &given.in.front())
      merged = table;
    else
      check_agreement(merged, given.in.front(), table, name);
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
    for (const auto& note : laws.notes) say({}, note);
  }
  out.write(text);
  if (missing.empty()) return usable_result;
  say({}, std::to_string(missing.size()) + " of " + std::to_string(merged.manifest.inputs.size()) +
              " files are missing: " + io::shortened_list(missing) +
              (unfinished.empty() ? "" : "; cut off or unfinished: " + io::shortened_list(unfinished)) +
              "; the batch without --shard and with this --out does the rest");
  return no_usable_result;
}

}  // namespace

void add_merge(CLI::App& program, Run& run) {
  const auto given = std::make_shared<MergeArguments>();
  auto* merge = program.add_subcommand("merge", "Joins the shards of a batch, a sweep or a map");
  merge->add_option("OUT", given->out, "Joined table; - for standard output")->required()->type_name("FILE");
  merge->add_option("IN", given->in, "Tables written with --shard by fracfit batch, simulate or map")
      ->required()
      ->type_name("FILE");
  merge->footer(
      "All must stem from the same command, on the same files.  The result is that of the command without --shard.\n"
      "Example:\n"
      "  fracfit merge all.csv part1.csv part2.csv part3.csv part4.csv");
  merge->callback([given, &run] { run = [given] { return run_merge(*given); }; });
}

}  // namespace fracfit
