// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <array>
#include <filesystem>
#include <stdexcept>

#include "commands/subcommand.hpp"
#include "options/parser.hpp"

namespace fracfit {
namespace {

// The command to be shared out: checked as if it were to run, and its words without what the script decides.
struct SharedCommand {
  std::string words;
  std::string out;
  std::string name;
};

SharedCommand shared_command(const std::vector<std::string>& words) {
  const std::vector<CommandGroup> groups = all_commands();
  const Request request = parse(groups, words);
  constexpr std::array<std::string_view, 3> kinds{"map", "simulate", "batch"};
  if (request.command == nullptr || std::ranges::find(kinds, request.command->name()) == kinds.end())
    throw std::invalid_argument("expected map, simulate or batch with its options, as these have shards");
  Options& options = request.command->options();
  options.interpret();
  const auto refuse = [&](const std::string& option, const std::string& why) {
    if (options[option].is_given()) throw std::invalid_argument(option + " of " + request.command->name() + ": " + why);
  };
  refuse("--shard", "the script gives each task its own");
  refuse("--threads", "the script gives each task the cores it has");
  if (!options["--out"].is_given())
    throw std::invalid_argument("--out of " + request.command->name() + " is required: the joined table");
  SharedCommand shared{"", options["--out"].text(), request.command->name()};
  for (std::size_t i = 0; i < words.size(); ++i) {
    if (words[i] == "--out" || words[i] == "-o")
      ++i;
    else if (!words[i].starts_with("--out="))
      shared.words += " " + shell_quoted(words[i]);
  }
  return shared;
}

class ClusterScript : public Command {
 public:
  ClusterScript() : Command("cluster-script", "Prints a script that runs the shards of a command on a cluster") {
    Options& o = options();
    o.flag("--slurm", slurm_, "An array of tasks for sbatch, and the merge that waits for it");
    o.flag("--parallel", parallel_, "For GNU parallel on one machine or several");
    o.exactly_one({"--slurm", "--parallel"}, "what runs the shards");
    o.count("--shards", shards_, 1, largest_table, "Number of shards; each should run for minutes, not seconds", "N");
    o.count("--cores", cores_, 1, 1024, "Cores for each", "N");
    add_common({"script"});
    set_footer(
        "The command follows, with --out as the joined table: map, simulate or batch.\n"
        "Run the script with bash: it submits all shards, and the merge.  Given a list such as 7,9-12 it runs these "
        "alone\n"
        "again, from where they stopped; fracfit merge --status and a merge that fails name the list.\n"
        "Examples:\n"
        "  fracfit cluster-script --slurm --shards 200 map --restitution 0:1:2001 --omega 0.5:4:5000log --out map.csv "
        "> job.sh\n"
        "  fracfit cluster-script --parallel --shards 16 batch spectra --model zarc --out rows.csv > job.sh");
  }

 private:
  [[nodiscard]] bool takes_command() const override { return true; }
  void set_words(const std::vector<std::string>& words) override { words_ = words; }

  void check() override {
    if (words_.empty())
      throw std::invalid_argument(
          "expected a command to share out, such as map --restitution 0:1:251 ... --out map.csv");
    shared_ = shared_command(words_);
  }

  int run() override {
    std::error_code none;
    const std::string program = std::filesystem::read_symlink("/proc/self/exe", none).string();
    const std::string count = std::to_string(shards_), cores = std::to_string(cores_);
    const std::string head =
        "#!/bin/bash\n"
        "# " +
        count + " shards of: fracfit" + shared_.words + " --out " + shell_quoted(shared_.out) +
        "\n"
        "# bash SCRIPT runs all of them and joins them; bash SCRIPT 7,9-12 runs these again from where they stopped.\n";
    const std::string body =
        "set -eu\n"
        "fracfit=${FRACFIT:-" +
        shell_quoted(none ? "fracfit" : program) +
        "}\n"
        "out=" +
        shell_quoted(shared_.out) +
        "\n"
        "parts=$out.parts\n"
        "shard() { \"$fracfit\"" +
        shared_.words + " --shard \"$1/" + count + "\" --threads " + cores +
        " --quiet --out \"$parts/{shard}.csv\"; }\n"
        "join() { \"$fracfit\" merge \"$parts\"/*-of-" +
        count + ".csv --out \"$out\"; }\n";
    write(head + (slurm_ ? slurm_lines(body, count, cores) : parallel_lines(body, count)));
    return usable_result;
  }

  // One file is the submission, the task and the merge: a task knows its number, the merge is told.
  [[nodiscard]] std::string slurm_lines(const std::string& body, const std::string& count,
                                        const std::string& cores) const {
    return "#SBATCH --job-name=fracfit-" + shared_.name + "\n#SBATCH --cpus-per-task=" + cores + "\n" + body +
           "if [ -n \"${SLURM_ARRAY_TASK_ID:-}\" ]; then\n"
           "  shard \"$SLURM_ARRAY_TASK_ID\"\n"
           "elif [ \"${1:-}\" = join ]; then\n"
           "  join\n"
           "else\n"
           "  mkdir -p \"$parts\"\n"
           "  array=$(sbatch --parsable --array=\"${1:-1-" +
           count +
           "}\" --output=\"$parts/%a.log\" \"$0\")\n"
           "  sbatch --dependency=\"afterok:$array\" --kill-on-invalid-dep=yes --output=\"$parts/join.log\" \"$0\" "
           "join\n"
           "fi\n";
  }

  [[nodiscard]] static std::string parallel_lines(const std::string& body, const std::string& count) {
    return body +
           "mkdir -p \"$parts\"\n"
           "export fracfit parts\n"
           "export -f shard\n"
           "# Turns 7,9-12 into numbers, one per line.\n"
           "numbers() { tr , '\\n' <<<\"$1\" | while IFS=- read -r from to; do seq \"$from\" \"${to:-$from}\"; done; "
           "}\n"
           "numbers \"${1:-1-" +
           count +
           "}\" | parallel --joblog \"$parts/jobs.log\" shard {}\n"
           "join\n";
  }

  bool slurm_ = false, parallel_ = false;
  int shards_ = 16, cores_ = 1;
  std::vector<std::string> words_;
  SharedCommand shared_;
};

}  // namespace

std::unique_ptr<Command> make_cluster_script() {
  return std::make_unique<ClusterScript>();
}

}  // namespace fracfit
