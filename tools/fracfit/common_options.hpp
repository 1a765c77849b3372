// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <initializer_list>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "io/output_file.hpp"
#include "io/shard.hpp"

namespace CLI {
class App;
class Validator;
}  // namespace CLI

namespace fracfit {

/// Options that every subcommand understands.
struct CommonOptions {
  std::string out;
  std::string format;  // as given; empty when not
  int threads = 0;     // 0: one per core
  bool quiet = false;
};

/// A check that the text of an option is not "".
[[nodiscard]] CLI::Validator not_empty();

/// --threads and --quiet, and, where `formats` is not empty, --out and --format.
void add_common_options(CLI::App& subcommand, CommonOptions& options, const std::vector<std::string>& formats);

/// An option that may be given several times, one value each.
void add_repeatable(CLI::App& subcommand, const std::string& name, std::vector<std::string>& values,
                    const std::string& description, const std::string& type);

/// The format asked for; if none, "table" on a terminal without --out, else `otherwise`.
[[nodiscard]] std::string chosen_format(const CommonOptions& options, const std::string& otherwise);

/// A finite number from an option. @throws std::invalid_argument  naming option and text.
[[nodiscard]] double number_option(std::string_view name, const std::string& text);
/// Rows of one table, or samples, that are no mistake and fit into the memory of a small computer.
constexpr std::size_t largest_table = 10'000'000;
/// A whole number in a range. @throws std::invalid_argument
[[nodiscard]] std::size_t count_option(std::string_view name, const std::string& text, std::size_t lowest,
                                       std::size_t highest = largest_table);
/// @throws std::invalid_argument  the product of these counts, each with the option it comes from, is above
/// largest_table.
void require_table_size(std::initializer_list<std::pair<std::string_view, std::size_t>> counts);
/// Of option --shard "i/n"; empty: all. @throws std::invalid_argument  not of that form with 1 <= i <= n.
[[nodiscard]] io::Shard shard_option(const std::string& text);
/// LOW:HIGH, split at the colon. @throws std::invalid_argument
[[nodiscard]] std::pair<std::string, std::string> range_option(std::string_view name, const std::string& text);
/// The same for two other things, told by the message as in `form`. @throws std::invalid_argument
[[nodiscard]] std::pair<std::string, std::string> pair_option(std::string_view name, const std::string& text,
                                                              const char* form);

/// The command line with every default spelled out, such that it can be pasted into a shell.  Options without influence
/// on the result (threads, output file, quiet) are left out.
class CommandLine {
 public:
  explicit CommandLine(std::string subcommand);
  CommandLine& argument(const std::string& value);
  CommandLine& flag(const std::string& name);
  CommandLine& option(const std::string& name, const std::string& value);
  [[nodiscard]] const std::string& text() const noexcept { return text_; }

 private:
  std::string text_;
};

/// "fracfit: message" on standard error, unless quiet.
void say(const CommonOptions& options, const std::string& message);

}  // namespace fracfit
