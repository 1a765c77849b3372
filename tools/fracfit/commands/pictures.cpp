// SPDX-License-Identifier: BSD-3-Clause
#include "commands/pictures.hpp"

#include <filesystem>
#include <stdexcept>
#include <system_error>

#include "report/staged_folder.hpp"

namespace fracfit {

bool draw_pictures(const Command& command, const std::string& folder, const std::vector<report::Figure>& figures) {
  report::StagedFolder staged(folder);
  std::string script;
  const auto gnuplot = report::find_gnuplot();
  std::string trouble = gnuplot ? "" : "gnuplot was not found; the scripts are written";
  std::vector<std::string> names;
  for (const report::Figure& figure : figures) {
    names.push_back(figure.name);
    script = figure.name + ".gp";
    staged.write(script, report::gnuplot_script(figure));
  }
  if (gnuplot) trouble = report::draw(*gnuplot, staged.path(), names);
  staged.publish(script);
  if (!trouble.empty()) command.say(trouble);
  return trouble.empty();
}

void make_picture_folder(const std::string& path) {
  std::error_code trouble;
  std::filesystem::create_directories(path, trouble);
  // The library reports no error when a file stands in place of the folder, so this is checked here.
  if (!trouble && !std::filesystem::is_directory(path)) trouble = std::make_error_code(std::errc::not_a_directory);
  if (trouble) throw std::invalid_argument("--pictures " + path + ": cannot be made a folder: " + trouble.message());
}

}  // namespace fracfit
