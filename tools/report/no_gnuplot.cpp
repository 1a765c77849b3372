// SPDX-License-Identifier: BSD-3-Clause
// In the place of gnuplot_run.cpp and gnuplot_script.cpp where no program can be started: the script of a page draws
// from the numbers of a figure alone.
#include "report/figure.hpp"

namespace report {

std::string gnuplot_script(const Figure& figure) {
  return "# " + figure.name + ": drawn by the page\n";
}

std::optional<std::filesystem::path> find_gnuplot() {
  return std::nullopt;
}

std::string draw(const std::filesystem::path&, const std::filesystem::path&, const std::vector<std::string>&,
                 std::chrono::milliseconds) {
  return "no program can be started here";
}

}  // namespace report
