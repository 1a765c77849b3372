// SPDX-License-Identifier: BSD-3-Clause
#include "options/scene_options.hpp"

#include <algorithm>
#include <stdexcept>

#include "io/data_error.hpp"
#include "io/number.hpp"

namespace fracfit {
namespace {

// "0,3", "4,0" or "20,5": two whole numbers that no list of rising values would hold, or that begin with 0.
bool looks_like_decimal_comma(const std::string& text) {
  if (text.find_first_not_of("0123456789,") != std::string::npos) return false;
  const auto comma = text.find(',');
  if (comma == std::string::npos || text.find(',', comma + 1) != std::string::npos) return false;
  const auto first = io::parse_number(text.substr(0, comma)), second = io::parse_number(text.substr(comma + 1));
  return first && second && (text.front() == '0' || text[comma + 1] == '0' || *second < *first);
}

}  // namespace

void add_masses(Options& options, double& mass1, double& mass2) {
  options.number("--mass1", mass1);
  options.number("--mass2", mass2);
}

void add_scene(Options& options, Scene& scene) {
  options.number("--force", scene.force);
  options.number("--clearance", scene.clearance);
  add_masses(options, scene.mass1, scene.mass2);
}

std::vector<double> scene_values_of(std::string_view name, const std::string& text) {
  std::vector<double> values = numbers_of(name, text);
  const auto refuse = [&](const std::string& message) {
    throw std::invalid_argument(std::string(name) + " " + io::quoted(text) + ": " + message);
  };
  // Otherwise two scenes would be computed instead of one, unnoticed.
  if (looks_like_decimal_comma(text))
    refuse("expected one number with a decimal point, such as 0.3, or two with one each, such as 0.0,3.0");
  std::vector<double> sorted = values;
  std::sort(sorted.begin(), sorted.end());
  const auto twice = std::adjacent_find(sorted.begin(), sorted.end());
  if (twice != sorted.end()) refuse("holds " + io::format_number(*twice) + " twice");
  return values;
}

}  // namespace fracfit
