// SPDX-License-Identifier: BSD-3-Clause
// In the place of gnuplot_run.cpp and gnuplot_script.cpp in a browser, where no program can be started: the page of a
// report draws by its own script.
#include <stdexcept>

#include "report/figure.hpp"

namespace report {

std::string gnuplot_script(const Figure& figure) {
  if (figure.link.empty()) throw std::invalid_argument(gnuplot_missing());
  return "";
}

std::string gnuplot_missing() {
  return "gnuplot draws this, which a page in a browser cannot start; the program on a computer draws it";
}

std::optional<std::filesystem::path> find_gnuplot() {
  return std::nullopt;
}

std::string draw(const std::filesystem::path&, const std::filesystem::path&, const std::vector<std::string>&,
                 std::chrono::milliseconds) {
  return gnuplot_missing();
}

}  // namespace report
