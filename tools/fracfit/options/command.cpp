// SPDX-License-Identifier: BSD-3-Clause
#include "options/command.hpp"

#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <stdexcept>
#include <string_view>
#include <utility>

#include "io/data_error.hpp"

namespace fracfit {

void complain(const std::string& message) {
  // Names of files may hold anything, bytes that command the terminal too; only our own messages have several lines.
  std::string text;
  for (std::size_t begin = 0; begin <= message.size();) {
    const std::size_t end = std::min(message.find('\n', begin), message.size());
    text += (begin > 0 ? "\n" : "") + io::printable(std::string_view(message).substr(begin, end - begin));
    begin = end + 1;
  }
  std::fprintf(stderr, "fracfit: %s\n", text.c_str());
}

Command::Command(std::string name, std::string about) : name_(std::move(name)), about_(std::move(about)) {}

void Command::add_common(const std::vector<std::string>& formats) {
  constexpr std::size_t most_threads = 1024;
  if (!formats.empty()) {
    file_format_ = formats.front();
    options_.text("--out", out_).also("-o").default_is("standard output").unsaid();
    options_.text("--format", format_)
        .one_of(formats)
        .default_is(std::find(formats.begin(), formats.end(), "table") == formats.end()
                        ? file_format_
                        : file_format_ + "; table on a terminal")
        .unsaid();
  }
  options_.count("--threads", threads_, 0, most_threads).unsaid();
  options_.flag("--quiet", quiet_, "No progress and no notes on standard error").unsaid();
}

Option& Command::add_shard(const std::string& pieces) {
  return options_.parsed("--shard", shard_, shard_of, "the pieces are " + pieces).unsaid();
}

void Command::add_progress() {
  options_.text("--progress", progress_).one_of({"bar", "json"}).unsaid();
}

io::ProgressStyle Command::progress_style() const {
  if (quiet_) return io::ProgressStyle::none;
  return progress_ == "json" ? io::ProgressStyle::lines : io::ProgressStyle::bar;
}

bool Command::writes_file() const {
  std::error_code none;
  const auto status = std::filesystem::status(out_, none);
  return !output_->is_standard_output() &&
         (!std::filesystem::exists(status) || std::filesystem::is_regular_file(status));
}

int Command::execute() {
  options_.interpret();
  try {
    for (const Option& option : options_.all())
      if (option.name() == "--out" && option.is_given() && option.text().empty())
        throw std::invalid_argument("--out '': expected a name");
    check();
    out_ = io::with_shard(out_, shard_);
    output_.emplace(out_, options_.input_files());
    return run();
  } catch (const std::invalid_argument& error) {
    throw std::invalid_argument(options_.in_their_words(error.what()));
  } catch (const std::domain_error& error) {
    throw std::invalid_argument(options_.in_their_words(error.what()));
  }
}

void Command::say(const std::string& message) const {
  if (!quiet_) complain(message);
}

std::string Command::format() const {
  if (!format_.empty()) return format_;
  return out_.empty() && ::isatty(STDOUT_FILENO) != 0 ? "table" : file_format_;
}

}  // namespace fracfit
