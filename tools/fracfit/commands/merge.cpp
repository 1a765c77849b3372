// SPDX-License-Identifier: BSD-3-Clause
#include <cstdint>
#include <set>
#include <stdexcept>

#include "batch/batch_merge.hpp"
#include "commands/subcommand.hpp"
#include "io/shard_file.hpp"
#include "output/document.hpp"

namespace fracfit {
namespace {

class Merge : public Command {
 public:
  Merge() : Command("merge", "Joins the shards of a batch, a sweep or a map") {
    options()
        .texts("IN", in_, "Tables written with --shard by fracfit batch, simulate or map", "FILE")
        .required()
        .names_input();
    options().flag("--status", status_, "Say how far each shard is and which are missing; join nothing");
    add_common({"csv", "json", "table"});
    options()["--out"].default_is("none for a joined table, where - is standard output");
    set_footer(
        "All must stem from the same command, on the same files.  The result is that of the command without --shard.\n"
        "Rows are copied from file to file, so that memory does not grow with them.\n"
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
    if (out().empty())
      throw std::invalid_argument(
          "--out is required: the joined table, - for standard output; the arguments are inputs");
  }

  int write_states(const std::vector<io::ShardState>& states) {
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

  int run() override {
    const bool is_sweep = io::is_block_table(in_.front());
    if (status_) return write_states(is_sweep ? io::shard_states(in_) : batch_shard_states(in_));
    if (is_sweep) {
      output().write([&](const io::OutputFile::Sink& sink) { io::join_block_tables(in_, sink); });
      return usable_result;
    }
    const BatchMerge merged(in_);
    BatchMerge::Outcome outcome;
    output().write([&](const io::OutputFile::Sink& sink) { outcome = merged.write(sink); });
    for (const auto& note : outcome.notes) say(note);
    if (outcome.missing.empty()) return usable_result;
    say(outcome.missing);
    return no_usable_result;
  }

  std::vector<std::string> in_;
  bool status_ = false;
};

}  // namespace

std::unique_ptr<Command> make_merge() {
  return std::make_unique<Merge>();
}

}  // namespace fracfit
