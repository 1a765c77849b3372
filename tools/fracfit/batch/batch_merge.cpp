// SPDX-License-Identifier: BSD-3-Clause
#include "batch/batch_merge.hpp"

#include <set>
#include <utility>

#include "batch/batch_power_law.hpp"
#include "io/data_error.hpp"
#include "io/readable_file.hpp"
#include "io/shard.hpp"

namespace fracfit {
namespace {

bool have_the_same_inputs(const BatchReader& one, const BatchReader& other) {
  for (std::size_t from = 0;;) {
    const std::string text = one.text_of_inputs(from);
    if (text != other.text_of_inputs(from)) return false;
    if (text.empty()) return true;
    from += text.size();
  }
}

void check_agreement(const BatchReader& first, const BatchReader& other) {
  const auto refuse = [&](const std::string& what, const std::string& a, const std::string& b) {
    throw io::DataError(other.file(), 0, 0, "has " + what + " " + b + "; expected, as in " + first.file() + ", " + a);
  };
  const auto name = [](BatchFormat format) { return format == BatchFormat::csv ? "csv" : "jsonl"; };
  const BatchManifest &expected = first.manifest(), &found = other.manifest();
  if (first.format() != other.format()) refuse("format", name(first.format()), name(other.format()));
  if (expected.version != found.version) refuse("version", expected.version, found.version);
  if (expected.command != found.command) refuse("command", expected.command, found.command);
  if (!have_the_same_inputs(first, other))
    refuse("a list of input files that differs:", std::to_string(first.inputs()) + " files",
           std::to_string(other.inputs()) + " files");
  if (expected.columns != found.columns)
    throw io::DataError(other.file(), 0, 0, "has other columns than " + first.file());
}

constexpr std::size_t most_text = 1U << 16U;  // bytes that are handed on at once

void write_head(const BatchReader& table, const BatchManifest& manifest, const io::OutputFile::Sink& sink) {
  const HeaderParts parts = header_parts(table.format(), manifest);
  sink(parts.before);
  for (std::size_t from = 0;;) {
    const std::string inputs = table.text_of_inputs(from);
    if (inputs.empty()) break;
    sink(inputs);
    from += inputs.size();
  }
  sink(parts.behind);
}

// Where the row of an input stands; in no table: nowhere.
struct Source {
  BatchRows* rows = nullptr;
  std::size_t begin = 0, size = 0;
};

std::vector<Source> sources_of(const InputPart& part, std::vector<BatchRows>& rows) {
  std::vector<Source> sources(part.names.size());
  for (BatchRows& each : rows)
    each.take(part, [&](std::size_t i, const PlacedRow& row) {
      if (sources[i].rows != nullptr)
        throw io::DataError(each.table().file(), row.place.number, 0,
                            "holds a row for " + part.names[i] + ", which " + sources[i].rows->table().file() +
                                " holds too; expected each file once");
      sources[i] = {&each, row.place.begin, row.line.size()};
    });
  return sources;
}

void require_known_inputs(const BatchReader& table) {
  BatchRows rows(table);
  table.each_part([&](const InputPart& part) { rows.take(part, [](std::size_t, const PlacedRow&) {}); });
  rows.require_end();
}

// Opens tables of one batch.
void open_tables(const std::vector<std::string>& files, std::vector<io::Descriptor>& descriptors,
                 std::vector<BatchReader>& tables) {
  io::allow_open_files(files.size());
  for (const std::string& file : files) {
    tables.emplace_back(file, descriptors.emplace_back(io::readable(file)).number());
    check_agreement(tables.front(), tables.back());
  }
}

// Why a table that has been checked is no finished shard; empty: it is one, or no shard at all.
std::string fault_of(const BatchReader& table) {
  if (table.manifest().shard.empty()) return "";
  if (table.rows() < table.expected_rows()) return "unfinished";
  if (table.has_end()) return "";
  return "holds all rows of its shard, but not their checksum as the last line: its end was cut off or changed; the "
         "same command, run again, restores it";
}

}  // namespace

BatchMerge::BatchMerge(const std::vector<std::string>& files) {
  open_tables(files, descriptors_, tables_);
  std::set<std::size_t> counts, finished;  // of shards
  for (BatchReader& table : tables_) {
    table.check();
    const std::string fault = fault_of(table);
    if (fault.empty())
      finished.insert(table.shard().index);
    else if (table.rows() < table.expected_rows())
      unfinished_.push_back(table.file());
    else
      throw io::DataError(table.file(), 0, 0, fault);
    counts.insert(table.shard().count);
  }
  if (counts.size() > 1) return;
  for (std::size_t i = 1; i <= *counts.begin(); ++i)
    if (!finished.contains(i)) shards_to_do_.push_back(i);
}

BatchMerge::Outcome BatchMerge::write(const io::OutputFile::Sink& sink) const {
  const BatchReader& first = tables_.front();
  BatchManifest manifest = first.manifest();
  manifest.shard.clear();
  write_head(first, manifest, sink);
  PowerLaws laws(first.format(), manifest);
  std::vector<BatchRows> rows(tables_.begin(), tables_.end());
  Missing missing;
  first.each_part([&](const InputPart& part) {
    const std::vector<Source> sources = sources_of(part, rows);
    std::string text;
    for (std::size_t i = 0; i < sources.size(); ++i) {
      const auto& [from, begin, size] = sources[i];
      if (from == nullptr) {
        if (++missing.count <= io::names_shown) missing.first.push_back(part.names[i]);
        continue;
      }
      const std::string_view line = from->line(begin, size);
      laws.add(line);
      text += line;
      text += '\n';
      if (text.size() < most_text) continue;
      sink(text);
      text.clear();
    }
    sink(text);
  });
  for (const BatchRows& each : rows) each.require_end();
  if (missing.count > 0) return {{}, missing_text(missing)};
  PowerLawRemarks remarks = laws.remarks();
  sink(remarks.text);
  return {std::move(remarks.notes), ""};
}

std::string BatchMerge::missing_text(const Missing& missing) const {
  return std::to_string(missing.count) + " of " + std::to_string(tables_.front().inputs()) +
         " files are missing: " + io::shortened_list(missing.first, missing.count) +
         (unfinished_.empty() ? "" : "; cut off or unfinished: " + io::shortened_list(unfinished_)) +
         "; the batch without --shard and with this --out does the rest" +
         (shards_to_do_.empty() ? "" : ", or its shards do; for sbatch: --array=" + io::list_of(shards_to_do_));
}

std::vector<io::ShardState> batch_shard_states(const std::vector<std::string>& files) {
  std::vector<io::Descriptor> descriptors;
  std::vector<BatchReader> tables;
  open_tables(files, descriptors, tables);
  std::vector<io::ShardState> states;
  for (BatchReader& table : tables) {
    if (table.manifest().shard.empty())
      throw io::DataError(table.file(), 0, 0, "is the table of all files; expected shards, written with --shard");
    io::require_shard_count(tables.front().shard().count, table.shard().count, files.front(), table.file());
    std::string fault;
    try {
      table.check();
      if (!table.has_end()) require_known_inputs(table);
      fault = fault_of(table);
    } catch (const io::DataError& error) {
      fault = error.what();
    }
    states.push_back({table.file(), table.shard(), table.rows(), table.expected_rows(), fault});
  }
  return states;
}

}  // namespace fracfit
