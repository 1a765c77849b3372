// SPDX-License-Identifier: BSD-3-Clause
#include "common_options.hpp"

#include <unistd.h>

#include <CLI/CLI.hpp>
#include <cmath>
#include <cstdio>
#include <stdexcept>

#include "choice.hpp"
#include "io/data_error.hpp"
#include "io/number.hpp"

namespace fracfit {
namespace {

std::string shell_quoted(const std::string& text) {
  constexpr std::string_view harmless = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-+=:,./%@";
  if (!text.empty() && text.find_first_not_of(harmless) == std::string::npos) return text;
  std::string quoted = "'";
  for (const char c : text) quoted += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return quoted + "'";
}

}  // namespace

CLI::Validator not_empty() {
  return CLI::Validator(
      [](const std::string& text) { return text.empty() ? std::string("expected a name, found none") : std::string(); },
      "");
}

void add_common_options(CLI::App& subcommand, CommonOptions& options, const std::vector<std::string>& formats) {
  constexpr int most_threads = 1024;
  if (!formats.empty()) {
    subcommand.add_option("--out", options.out, "Output file; standard output if not given")
        ->type_name("FILE")
        ->check(not_empty());
    subcommand.add_option("--format", options.format, "Output format")->check(one_of(formats))->type_name("FORMAT");
  }
  subcommand.add_option("--threads", options.threads, "Threads, 0 for one per core; results do not depend on it")
      ->check(CLI::Range(0, most_threads))
      ->type_name("N");
  subcommand.add_flag("--quiet", options.quiet, "No progress and no notes on standard error");
}

void add_repeatable(CLI::App& subcommand, const std::string& name, std::vector<std::string>& values,
                    const std::string& description, const std::string& type) {
  subcommand.add_option(name, values, description)->expected(1)->take_all()->type_name(type);
}

std::string chosen_format(const CommonOptions& options, const std::string& otherwise) {
  if (!options.format.empty()) return options.format;
  return options.out.empty() && ::isatty(STDOUT_FILENO) != 0 ? "table" : otherwise;
}

double number_option(std::string_view name, const std::string& text) {
  const auto value = io::parse_number(text);
  if (!value || !std::isfinite(*value))
    throw std::invalid_argument(std::string(name) + " " + io::quoted(text) + ": expected a finite number");
  return *value;
}

std::size_t count_option(std::string_view name, const std::string& text, std::size_t lowest, std::size_t highest) {
  const auto value = io::parse_count(text);
  if (!value || *value < lowest || *value > highest)
    throw std::invalid_argument(std::string(name) + " " + io::quoted(text) + ": expected a whole number from " +
                                std::to_string(lowest) + " to " + std::to_string(highest));
  return *value;
}

void require_table_size(std::initializer_list<std::pair<std::string_view, std::size_t>> counts) {
  std::string product;
  double rows = 1;
  for (const auto& [name, count] : counts) {
    product += (product.empty() ? "" : " times ") + std::to_string(count) + " (" + std::string(name) + ")";
    rows *= static_cast<double>(count);
  }
  if (rows > static_cast<double>(largest_table))
    throw std::invalid_argument(product + " rows: expected at most " + std::to_string(largest_table));
}

io::Shard shard_option(const std::string& text) {
  if (text.empty()) return {};
  const auto slash = text.find('/');
  if (slash == std::string::npos)
    throw std::invalid_argument("--shard " + io::quoted(text) + ": expected i/n, such as 1/4");
  const io::Shard shard{count_option("--shard", text.substr(0, slash), 1),
                        count_option("--shard", text.substr(slash + 1), 1)};
  if (shard.index > shard.count)
    throw std::invalid_argument("--shard " + io::quoted(text) + ": expected i/n with 1 <= i <= n");
  return shard;
}

std::pair<std::string, std::string> range_option(std::string_view name, const std::string& text) {
  return pair_option(name, text, "LOW:HIGH");
}

std::pair<std::string, std::string> pair_option(std::string_view name, const std::string& text, const char* form) {
  const auto colon = text.find(':');
  if (colon == std::string::npos || text.find(':', colon + 1) != std::string::npos)
    throw std::invalid_argument(std::string(name) + " " + io::quoted(text) + ": expected " + form);
  return {text.substr(0, colon), text.substr(colon + 1)};
}

CommandLine::CommandLine(std::string subcommand) : text_("fracfit " + std::move(subcommand)) {}

CommandLine& CommandLine::argument(const std::string& value) {
  text_ += " " + shell_quoted(value);
  return *this;
}

CommandLine& CommandLine::flag(const std::string& name) {
  text_ += " " + name;
  return *this;
}

CommandLine& CommandLine::option(const std::string& name, const std::string& value) {
  text_ += " " + name;
  return argument(value);
}

void say(const CommonOptions& options, const std::string& message) {
  if (!options.quiet) std::fprintf(stderr, "fracfit: %s\n", message.c_str());
}

}  // namespace fracfit
