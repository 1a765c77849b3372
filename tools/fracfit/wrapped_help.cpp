// SPDX-License-Identifier: BSD-3-Clause
#include "wrapped_help.hpp"

#include <CLI/CLI.hpp>
#include <sstream>
#include <string>

#include "choice.hpp"

namespace fracfit {
namespace {

constexpr std::size_t page_width = 100;

class WrappedHelp : public CLI::Formatter {
 public:
  std::string make_option_desc(const CLI::Option* option) const override { return wrapped(description_of(*option)); }

  std::string make_option_opts(const CLI::Option* option) const override {
    std::string text = CLI::Formatter::make_option_opts(option);
    const std::string full = option->get_type_name();
    const auto at = text.find(full);
    if (!full.empty() && at != std::string::npos) text.replace(at, full.size(), type_name_of(*option));
    return text;
  }

  std::string make_subcommand(const CLI::App* subcommand) const override {
    std::ostringstream text;
    CLI::detail::format_help(text, subcommand->get_name(), wrapped(subcommand->get_description()), get_column_width());
    return text.str();
  }

 private:
  [[nodiscard]] std::string wrapped(const std::string& description) const {
    const std::size_t room = page_width - get_column_width();
    std::istringstream words(description);
    std::string text;
    std::size_t used = 0;
    for (std::string word; words >> word;) {
      const bool fits = used == 0 || used + 1 + word.size() <= room;
      if (used > 0) text += fits ? ' ' : '\n';
      used = fits && used > 0 ? used + 1 + word.size() : word.size();
      text += word;
    }
    return text;
  }
};

}  // namespace

std::shared_ptr<CLI::FormatterBase> wrapped_help() {
  return std::make_shared<WrappedHelp>();
}

}  // namespace fracfit
