// SPDX-License-Identifier: BSD-3-Clause
#include "batch/batch_merge.hpp"

#include <algorithm>
#include <set>

#include "batch/batch_power_law.hpp"
#include "io/data_error.hpp"
#include "io/readable_file.hpp"
#include "io/shard.hpp"

namespace fracfit {
namespace {

void check_agreement(BatchFormat first_format, const BatchManifest& first, const std::string& first_file,
                     const BatchReader& other, const std::string& other_file) {
  const auto refuse = [&](const std::string& what, const std::string& a, const std::string& b) {
    throw io::DataError(other_file, 0, 0, "has " + what + " " + b + "; expected, as in " + first_file + ", " + a);
  };
  const auto name = [](BatchFormat format) { return format == BatchFormat::csv ? "csv" : "jsonl"; };
  const BatchManifest& found = other.manifest();
  if (first_format != other.format()) refuse("format", name(first_format), name(other.format()));
  if (first.version != found.version) refuse("version", first.version, found.version);
  if (first.command != found.command) refuse("command", first.command, found.command);
  if (first.inputs != found.inputs)
    refuse("a list of input files that differs:", std::to_string(first.inputs.size()) + " files",
           std::to_string(found.inputs.size()) + " files");
  if (first.columns != found.columns) throw io::DataError(other_file, 0, 0, "has other columns than " + first_file);
}

// Why a table that has been read is no finished shard; empty: it is one, or no shard at all.
std::string fault_of(const BatchReader& table) {
  if (table.manifest().shard.empty()) return "";
  if (table.rows() < table.expected_rows()) return "unfinished";
  if (table.has_end()) return "";
  return "holds all rows of its shard, but not their checksum as the last line: its end was cut off or changed; the "
         "same command, run again, restores it";
}

}  // namespace

BatchMerge::BatchMerge(const std::vector<std::string>& files) : files_(files) {
  io::allow_open_files(files.size());
  std::set<std::size_t> counts, finished;  // of shards
  for (const std::string& file : files) {
    descriptors_.push_back(io::readable(file));
    BatchReader table(file, descriptors_.back().number());
    if (&file == &files.front()) {
      format_ = table.format();
      manifest_ = table.manifest();
      places_.resize(manifest_.inputs.size());
    } else {
      check_agreement(format_, manifest_, files.front(), table, file);
    }
    table.read_rows([&](const PlacedRow& row) {
      Place& place = places_[row.curve];
      if (place.size > 0)
        throw io::DataError(file, 0, 0,
                            "holds a row for " + manifest_.inputs[row.curve] + ", which " + files_[place.file] +
                                " holds too; expected each file once");
      place = {static_cast<std::uint32_t>(descriptors_.size() - 1), static_cast<std::uint32_t>(row.line.size()),
               row.begin};
    });
    const std::string fault = fault_of(table);
    if (fault.empty())
      finished.insert(table.shard().index);
    else if (table.rows() < table.expected_rows())
      unfinished_.push_back(file);
    else
      throw io::DataError(file, 0, 0, fault);
    counts.insert(table.shard().count);
  }
  manifest_.shard.clear();
  if (counts.size() > 1) return;
  for (std::size_t i = 1; i <= *counts.begin(); ++i)
    if (!finished.contains(i)) shards_to_do_.push_back(i);
}

std::vector<std::string> BatchMerge::write(const io::OutputFile::Sink& sink) const {
  PowerLaws laws(format_, manifest_);
  constexpr std::size_t most_text = 1U << 16U;  // bytes that are handed on at once
  std::string text = header_text(format_, manifest_);
  for (const Place& place : places_) {
    if (place.size == 0) continue;
    const std::string line =
        io::read_at(descriptors_[place.file].number(), place.begin, place.size, files_[place.file]);
    laws.add(line);
    text += line;
    text += '\n';
    if (text.size() < most_text) continue;
    sink(text);
    text.clear();
  }
  const bool is_whole = std::ranges::all_of(places_, [](const Place& place) { return place.size > 0; });
  const PowerLawRemarks remarks = is_whole ? laws.remarks() : PowerLawRemarks{};
  sink(text + remarks.text);
  return remarks.notes;
}

std::string BatchMerge::missing_text() const {
  std::vector<std::string> missing;
  for (std::size_t i = 0; i < places_.size(); ++i)
    if (places_[i].size == 0) missing.push_back(manifest_.inputs[i]);
  if (missing.empty()) return "";
  return std::to_string(missing.size()) + " of " + std::to_string(places_.size()) +
         " files are missing: " + io::shortened_list(missing) +
         (unfinished_.empty() ? "" : "; cut off or unfinished: " + io::shortened_list(unfinished_)) +
         "; the batch without --shard and with this --out does the rest" +
         (shards_to_do_.empty() ? "" : ", or its shards do; for sbatch: --array=" + io::list_of(shards_to_do_));
}

std::vector<io::ShardState> batch_shard_states(const std::vector<std::string>& files) {
  std::vector<io::ShardState> states;
  BatchFormat format = BatchFormat::csv;
  BatchManifest first;
  for (const std::string& file : files) {
    const io::Descriptor descriptor = io::readable(file);
    BatchReader table(file, descriptor.number());
    if (states.empty()) {
      format = table.format();
      first = table.manifest();
    } else {
      check_agreement(format, first, files.front(), table, file);
    }
    if (table.manifest().shard.empty())
      throw io::DataError(file, 0, 0, "is the table of all files; expected shards, written with --shard");
    io::require_shard_count(states.empty() ? table.shard().count : states.front().shard.count, table.shard().count,
                            files.front(), file);
    std::string fault;
    try {
      table.read_rows([](const PlacedRow&) {});
      fault = fault_of(table);
    } catch (const io::DataError& error) {
      fault = error.what();
    }
    states.push_back({file, table.shard(), table.rows(), table.expected_rows(), fault});
  }
  return states;
}

}  // namespace fracfit
