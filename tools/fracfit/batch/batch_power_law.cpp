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

// E.g. "2 without a fit, 1 K not-identified".
std::string reasons_text(const std::map<std::string, int>& left_out) {
  std::string text;
  for (const auto& [reason, count] : left_out)
    text += (text.empty() ? "" : ", ") + std::to_string(count) + " " + reason;
  return text;
}

constexpr const char* two_points = "two points, which any law meets: no intervals";

}  // namespace

PowerLawRequest power_law_request(const std::string& text) {
  const auto colon = text.find(':');
  if (colon == std::string::npos || colon == 0 || colon + 1 == text.size())
    throw std::invalid_argument("--power-law " + io::quoted(text) + ": expected PARAMETER:VARIABLE, such as a:force_n");
  return {text.substr(0, colon), text.substr(colon + 1)};
}

PowerLaws::PowerLaws(BatchFormat format, const BatchManifest& manifest) : format_(format), columns_(manifest.columns) {
  for (const auto& law : manifest.laws) laws_.push_back({power_law_request(law), {}, {}, {}});
}

void PowerLaws::add(std::string_view line) {
  ++rows_;
  if (laws_.empty()) return;
  const auto row = read_row(format_, columns_, std::string(line));
  if (!row) throw std::logic_error("a row of the batch cannot be read back");
  const auto number = [&](const std::string& column) {
    const auto found = row->find(column);
    return found == row->end() ? std::nullopt : io::parse_number(found->second);
  };
  for (Law& law : laws_) {
    const auto variable = number(law.request.variable), value = number(law.request.parameter);
    if (const auto reason = obstacle(law.request, *row, variable, value); !reason.empty()) {
      ++law.left_out[reason];
      continue;
    }
    law.x.push_back(*variable);
    law.y.push_back(*value);
  }
}

BatchRow PowerLaws::remark_of(const Law& law) {
  const auto& [request, x, y, left_out] = law;
  BatchRow remark{text_cell("power_law", request.parameter + ":" + request.variable),
                  number_cell("points", static_cast<double>(x.size()))};
  if (!left_out.empty()) remark.push_back(text_cell("left_out", reasons_text(left_out)));
  if (x.size() == 2) remark.push_back(text_cell("note", two_points));
  try {
    const auto fit = frac::fit_power_law(x, y);
    remark.push_back(number_cell("coefficient", fit.coefficient));
    remark.push_back(number_cell("coefficient_ci95_lower", fit.coefficient_ci95_lower));
    remark.push_back(number_cell("coefficient_ci95_upper", fit.coefficient_ci95_upper));
    remark.push_back(number_cell("exponent", fit.exponent));
    remark.push_back(number_cell("exponent_ci95_lower", fit.exponent_ci95_lower));
    remark.push_back(number_cell("exponent_ci95_upper", fit.exponent_ci95_upper));
    remark.push_back(number_cell("r_squared", fit.r_squared));
  } catch (const std::invalid_argument& error) {
    remark.push_back(text_cell("none", error.what()));
  }
  return remark;
}

PowerLawRemarks PowerLaws::remarks() const {
  PowerLawRemarks remarks;
  for (const Law& law : laws_) {
    remarks.text += remark_line(format_, remark_of(law));
    const std::string name = "power law " + law.request.parameter + ":" + law.request.variable + ": ";
    const std::size_t points = law.x.size();
    if (!law.left_out.empty())
      remarks.notes.push_back(name + std::to_string(rows_ - points) + " of " + std::to_string(rows_) +
                              " rows are left out: " + reasons_text(law.left_out));
    if (points == 2) remarks.notes.push_back(name + two_points);
    if (points < 2) remarks.notes.push_back(name + "none, as only " + std::to_string(points) + " rows give a point");
  }
  return remarks;
}

}  // namespace fracfit
