// SPDX-License-Identifier: BSD-3-Clause
#include "output/economy_output.hpp"

#include <vector>

#include "frac/identification/describe.hpp"
#include "output/aligned_table.hpp"
#include "output/described.hpp"

namespace fracfit {
namespace {

std::string shown_name(const frac::EconomyCurve& curve) {
  return curve.model_class == frac::EconomyClass::given ? curve.name : std::string(description(curve.model_class));
}

/// The error with up to that many parameters, in per cent; nothing where the curve has ended before at rounding.
std::string error_with(const frac::Economy& economy, const frac::EconomyCurve& curve, std::size_t parameters) {
  const frac::EconomyPoint* best = nullptr;
  for (const frac::EconomyPoint& point : curve.points) {
    if (point.parameters <= parameters) best = &point;
  }
  if (!best) return "";
  // What more parameters do not improve is not said twice.
  if (best->parameters < parameters) return best->error <= economy.rounding ? "" : "\"";
  return best->error <= economy.rounding ? "0" : short_number(100 * best->error, 2);
}

std::string parameters_for(const frac::EconomyCurve& curve, double error, std::size_t most) {
  const frac::EconomyPoint* const point = curve.within(error);
  if (point) return std::to_string(point->parameters);
  return curve.model_class == frac::EconomyClass::given ? "never" : "> " + std::to_string(most);
}

}  // namespace

std::string economy_table(const frac::Economy& economy) {
  std::vector<std::string> heading{"parameters needed"};
  for (const double error : frac::economy_errors()) heading.push_back("to " + short_number(100 * error) + " %");
  AlignedTable needs(heading);
  heading = {"rms error, %"};
  for (std::size_t count = 1; count <= economy.most_parameters; ++count) heading.push_back(std::to_string(count));
  AlignedTable errors(heading);
  std::string given;
  for (const frac::EconomyCurve& curve : economy.curves) {
    std::vector<std::string> row{shown_name(curve)};
    for (const double error : frac::economy_errors())
      row.push_back(parameters_for(curve, error, economy.most_parameters));
    needs.add(row);
    if (curve.model_class == frac::EconomyClass::given) {
      given += curve.name + ", which nothing is fitted in, misses by " +
               short_number(100 * curve.points.front().error, 3) + " %\n";
      continue;
    }
    row = {shown_name(curve)};
    for (std::size_t count = 1; count <= economy.most_parameters; ++count)
      row.push_back(error_with(economy, curve, count));
    errors.add(row);
  }
  return std::string(frac::no_noise_sentence) + "\n\n" + needs.text() + "\n" + errors.text() + given +
         "whole powers: the least of all; others: the least found; \" no less; 0 rounding\n\n" +
         paragraph("economy: " + std::string(to_string(economy.verdict)) + ". " + economy.sentence);
}

Json economy_json(const frac::Economy& economy) {
  return json_of(economy);
}

}  // namespace fracfit
