// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <string>
#include <vector>

/// What a reader does with one block of a page: types a command, or saves a file under its caption.
struct PageStep {
  int line = 0;                            ///< line of the page, from 1
  std::string command = {};                ///< without its prompt, continued lines joined; empty for a file
  std::vector<std::string> expected = {};  ///< lines printed below the command
  double tolerance = 1e-8;                 ///< relative, of the numbers in these lines
  std::string file = {};                   ///< name of a file to save
  std::string content = {};                ///< of that file
};

/// A page of tools/docs: its steps in order, and the prose between its blocks.
struct Page {
  std::vector<PageStep> steps;
  std::vector<std::pair<int, std::string>> prose;  ///< line number and text
};

/// Reads the `console` blocks ("$ command", "> continued line", output) and the code blocks with a `:caption:`.  A
/// comment
/// `<!-- numbers to 1e-4: why -->` gives the tolerance of the block that follows it, where it is not that of all
/// others.
Page read_page(const std::filesystem::path& path);

/// The commands of the ```sh blocks of a page that begin with `program`, lines that end in a backslash joined.
std::vector<std::string> shell_commands(const std::filesystem::path& path, const std::string& program);

/// Compares what a page shows with what a command printed; an empty text where they agree, else what differs.
///
/// Both are read word by word, wherever their lines break: a terminal wraps them elsewhere when one digit more is
/// printed.
/// `...` as a word stands for any words, within a word for any text.  A number with a decimal point or an exponent is
/// compared by its value, to `tolerance` relative to it; one of at least four digits, or one that `...` follows, may
/// differ by one unit of the last digit that the page shows as well, which is how a rounded number differs between
/// processors. All else is compared character by character; so are whole numbers, and digits inside names.
std::string difference(const std::vector<std::string>& shown, const std::vector<std::string>& printed,
                       double tolerance = 1e-8);

/// Numbers with a decimal point in a text: their value and the unit of their last digit.
struct PrintedNumber {
  std::string text;
  double value = 0;
  double unit = 0;
};
std::vector<PrintedNumber> decimal_numbers(const std::string& text);
