// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "io/output_file.hpp"
#include "io/progress_bar.hpp"
#include "options/options.hpp"

namespace fracfit {

enum ExitCode : int { usable_result = 0, no_usable_result = 1, wrong_usage = 2, invalid_data = 3 };

/// "fracfit: message" on standard error.
void complain(const std::string& message);

/// A subcommand.  Its constructor declares the options, whose variables are its members; run() does the work.
class Command {
 public:
  Command(std::string name, std::string about);
  Command(const Command&) = delete;
  Command& operator=(const Command&) = delete;
  virtual ~Command() = default;

  /// True for a command that works on another one, whose words follow its own options.
  [[nodiscard]] virtual bool takes_command() const { return false; }
  virtual void set_words(const std::vector<std::string>&) {}

  /// Checks the options and runs. @return the exit code
  int execute();

  [[nodiscard]] const std::string& name() const { return name_; }
  [[nodiscard]] const std::string& about() const { return about_; }
  [[nodiscard]] const std::string& footer() const { return footer_; }
  [[nodiscard]] Options& options() { return options_; }
  [[nodiscard]] const Options& options() const { return options_; }

  /// A note on standard error, unless --quiet; the last one before an exit with no_usable_result is its reason and said
  /// all the same.
  void say(const std::string& message) const;
  [[nodiscard]] int threads() const { return threads_; }

 protected:
  /// Checks that the options fit together, where their declarations cannot say it, before anything is written or read.
  virtual void check() {}
  [[nodiscard]] virtual int run() = 0;

  /// --shard, whose place "{shard}" --out may name.
  /// @param pieces  what is shared out
  Option& add_shard(const std::string& pieces);
  [[nodiscard]] const io::Shard& shard() const { return shard_; }
  /// --progress, for commands that compute for long.
  void add_progress();
  [[nodiscard]] io::ProgressStyle progress_style() const;
  /// --threads, --time-limit and --quiet; --out and --format, the format of files first, where there are formats.
  void add_common(const std::vector<std::string>& formats = {});
  void set_footer(std::string text) { footer_ = std::move(text); }

  [[nodiscard]] const std::string& out() const { return out_; }
  /// As asked for; if not, "table" on a terminal without --out, else that of files.
  [[nodiscard]] virtual std::string format() const;
  [[nodiscard]] std::string command_line() const { return options_.command_line(name_); }
  /// Writes the result to --out, whole or not at all.
  void write(std::string_view text) const;
  [[nodiscard]] const io::OutputFile& output() const { return *output_; }
  /// --out is a file, not standard output or a device.
  [[nodiscard]] bool writes_file() const;

 private:
  int execute_interpreted(const std::string& note);
  int run_in_time();

  std::string name_, about_, footer_;
  Options options_;
  std::string out_, format_, file_format_, drive_words_;
  int threads_ = 0;
  bool quiet_ = false;
  std::optional<double> time_limit_;
  mutable std::string unsaid_;
  io::Shard shard_;
  std::string progress_ = "bar";
  std::optional<io::OutputFile> output_;
};

/// Subcommands that belong together in --help.
struct CommandGroup {
  std::string name;
  std::vector<std::unique_ptr<Command>> commands;
};

}  // namespace fracfit
