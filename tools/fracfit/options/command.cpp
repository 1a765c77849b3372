// SPDX-License-Identifier: BSD-3-Clause
#include "options/command.hpp"

#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstdio>
#include <filesystem>
#include <mutex>
#include <stdexcept>
#include <string_view>
#include <thread>
#include <utility>

#include "frac/cancellation.hpp"
#include "io/data_error.hpp"
#include "io/termination.hpp"
#include "options/drive_options.hpp"
#include "output/terminal.hpp"

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
  add_drive_words(options_, drive_words_);
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
  options_.number("--time-limit", time_limit_).default_is("none").unsaid();
  options_.flag("--quiet", quiet_, "No progress and no notes on standard error; why there is no usable result is said")
      .unsaid();
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
  const std::string note = convert_drive_words(options_);
  try {
    options_.interpret();
    return execute_interpreted(note);
  } catch (const std::invalid_argument& error) {
    throw std::invalid_argument(in_drive_words(options_, error.what()));
  }
}

int Command::execute_interpreted(const std::string& note) {
  try {
    for (const Option& option : options_.all())
      if (option.name() == "--out" && option.is_given() && option.text().empty())
        throw std::invalid_argument("--out '': expected a name");
    check();
    constexpr double longest = 1e9;  // s, thirty years
    if (time_limit_ && !(*time_limit_ > 0 && *time_limit_ <= longest))
      throw std::invalid_argument("--time-limit " + options_["--time-limit"].text() +
                                  ": allowed is above 0 up to 1e9 s");
    out_ = io::with_shard(out_, shard_);
    output_.emplace(out_, options_.input_files());
    if (!note.empty()) say(note);
    const int code = run_in_time();
    if (code == no_usable_result && !unsaid_.empty()) complain(unsaid_);
    return code;
  } catch (const std::invalid_argument& error) {
    throw std::invalid_argument(options_.in_their_words(error.what()));
  } catch (const std::domain_error& error) {
    throw std::invalid_argument(options_.in_their_words(error.what()));
  }
}

int Command::run_in_time() {
  // Commands with a bar of their own show it; the others, and these before and after, that they are at work.
  const frac::Progress nothing_counted;
  const io::ProgressBar at_work(name_, nothing_counted, progress_style());
  if (!time_limit_) return run();
  const std::string reason = "--time-limit " + options_["--time-limit"].text() + ": the time is over";
  std::atomic<bool> is_over = false;
  const frac::CancellationScope watched(is_over);
  const std::jthread clock([&](const std::stop_token& stop) {
    std::mutex mutex;
    std::unique_lock lock(mutex);
    std::condition_variable_any wakeup;
    const auto ends_within = [&](double seconds) {
      wakeup.wait_for(lock, stop, std::chrono::duration<double>(seconds), [] { return false; });
      return stop.stop_requested();
    };
    // Long computations look at the flag; a system call, a library or a loop over very many rows may not.
    constexpr double patience = 1;  // s
    if (ends_within(*time_limit_)) return;
    is_over = true;
    if (ends_within(patience)) return;
    if (::isatty(STDERR_FILENO) != 0) std::fputs("\r\033[K", stderr);
    complain(reason);
    io::end_at_once(no_usable_result);
  });
  try {
    return run();
  } catch (const frac::Cancelled&) {
    throw std::runtime_error(reason);
  }
}

void Command::say(const std::string& message) const {
  if (quiet_)
    unsaid_ = message;
  else
    complain(message);
}

std::string Command::format() const {
  if (!format_.empty()) return format_;
  return out_.empty() && output_is_terminal() ? "table" : file_format_;
}

void Command::write(std::string_view text) const {
  if (out_.empty() && format() == "table" && shows_colours())
    output_->write(in_colours(text));
  else
    output_->write(text);
}

}  // namespace fracfit
