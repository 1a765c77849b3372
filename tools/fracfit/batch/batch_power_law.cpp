// SPDX-License-Identifier: BSD-3-Clause
#include "batch/batch_power_law.hpp"

#include <map>
#include <optional>
#include <stdexcept>

#include "frac/identification/power_law.hpp"
#include "io/data_error.hpp"
#include "io/number.hpp"

namespace fracfit {
namespace {

BatchCell number_cell(std::string column, double value) {
  return {std::move(column), value, std::nullopt};
}

BatchCell text_cell(std::string column, std::string text) {
  return {std::move(column), std::nullopt, std::move(text)};
}

// Points of a law, and why rows gave none: reason and number of rows.
struct LawData {
  std::vector<double> x, y;
  std::map<std::string, int> left_out;
};

// Reason why the row gives no point; empty if it gives one.
std::string obstacle(const PowerLawRequest& request, const std::map<std::string, std::string>& row,
                     std::optional<double> variable, std::optional<double> value) {
  const auto entry = [&](const std::string& column) {
    const auto found = row.find(column);
    return found == row.end() ? std::string() : found->second;
  };
  if (entry("status") != "converged") return "without a fit";
  if (const auto state = entry(request.parameter + "_state"); state != "identified")
    return request.parameter + " " + (state.empty() ? "unknown" : state);
  if (!variable) return "without " + request.variable;
  if (!value) return "without " + request.parameter;
  if (!(*variable > 0)) return request.variable + " not positive";
  if (!(*value > 0)) return request.parameter + " not positive";
  return "";
}

LawData law_data(const PowerLawRequest& request, BatchFormat format, const BatchManifest& manifest,
                 const std::vector<std::string>& lines) {
  LawData data;
  for (const auto& line : lines) {
    const auto row = read_row(format, manifest.columns, line);
    if (!row) throw std::logic_error("a row of the batch cannot be read back");
    const auto number = [&](const std::string& column) {
      const auto found = row->find(column);
      return found == row->end() ? std::nullopt : io::parse_number(found->second);
    };
    const auto variable = number(request.variable);
    const auto value = number(request.parameter);
    if (const auto reason = obstacle(request, *row, variable, value); !reason.empty()) {
      ++data.left_out[reason];
      continue;
    }
    data.x.push_back(*variable);
    data.y.push_back(*value);
  }
  return data;
}

// E.g. "2 without a fit, 1 K not-identified".
std::string reasons_text(const LawData& data) {
  std::string text;
  for (const auto& [reason, count] : data.left_out)
    text += (text.empty() ? "" : ", ") + std::to_string(count) + " " + reason;
  return text;
}

constexpr const char* two_points = "two points, which any law meets: no intervals";

BatchRow law_of(const PowerLawRequest& request, const LawData& data) {
  const auto& [x, y, left_out] = data;
  BatchRow remark{text_cell("power_law", request.parameter + ":" + request.variable),
                  number_cell("points", static_cast<double>(x.size()))};
  if (!left_out.empty()) remark.push_back(text_cell("left_out", reasons_text(data)));
  if (x.size() == 2) remark.push_back(text_cell("note", two_points));
  try {
    const auto law = frac::fit_power_law(x, y);
    remark.push_back(number_cell("coefficient", law.coefficient));
    remark.push_back(number_cell("coefficient_ci95_lower", law.coefficient_ci95_lower));
    remark.push_back(number_cell("coefficient_ci95_upper", law.coefficient_ci95_upper));
    remark.push_back(number_cell("exponent", law.exponent));
    remark.push_back(number_cell("exponent_ci95_lower", law.exponent_ci95_lower));
    remark.push_back(number_cell("exponent_ci95_upper", law.exponent_ci95_upper));
    remark.push_back(number_cell("r_squared", law.r_squared));
  } catch (const std::invalid_argument& error) {
    remark.push_back(text_cell("none", error.what()));
  }
  return remark;
}

}  // namespace

PowerLawRequest power_law_request(const std::string& text) {
  const auto colon = text.find(':');
  if (colon == std::string::npos || colon == 0 || colon + 1 == text.size())
    throw std::invalid_argument("--power-law " + io::quoted(text) + ": expected PARAMETER:VARIABLE, such as a:force_n");
  return {text.substr(0, colon), text.substr(colon + 1)};
}

PowerLawRemarks power_law_remarks(BatchFormat format, const BatchManifest& manifest,
                                  const std::vector<std::string>& lines) {
  PowerLawRemarks remarks;
  for (const auto& law : manifest.laws) {
    const auto request = power_law_request(law);
    const auto data = law_data(request, format, manifest, lines);
    remarks.text += remark_line(format, law_of(request, data));
    if (!data.left_out.empty())
      remarks.notes.push_back("power law " + law + ": " + std::to_string(lines.size() - data.x.size()) + " of " +
                              std::to_string(lines.size()) + " rows are left out: " + reasons_text(data));
    if (data.x.size() == 2) remarks.notes.push_back("power law " + law + ": " + two_points);
    if (data.x.size() < 2)
      remarks.notes.push_back("power law " + law + ": none, as only " + std::to_string(data.x.size()) +
                              " rows give a point");
  }
  return remarks;
}

}  // namespace fracfit
