#include "batch_power_law.hpp"

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

BatchRow law_of(const PowerLawRequest& request, const std::vector<double>& x, const std::vector<double>& y) {
  BatchRow remark{text_cell("power_law", request.parameter + ":" + request.variable),
                  number_cell("points", static_cast<double>(x.size()))};
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

std::string power_law_remarks(BatchFormat format, const BatchManifest& manifest,
                              const std::vector<std::string>& lines) {
  std::string text;
  for (const auto& law : manifest.laws) {
    const auto request = power_law_request(law);
    std::vector<double> x, y;
    for (const auto& line : lines) {
      const auto row = read_row(format, manifest.columns, line);
      if (!row) throw std::logic_error("a row of the batch cannot be read back");
      const auto entry = [&](const std::string& column) {
        const auto found = row->find(column);
        return found == row->end() ? std::string() : found->second;
      };
      const auto variable = io::parse_number(entry(request.variable));
      const auto value = io::parse_number(entry(request.parameter));
      if (entry("status") != "converged" || entry(request.parameter + "_state") != "identified" || !variable || !value)
        continue;
      x.push_back(*variable);
      y.push_back(*value);
    }
    text += remark_line(format, law_of(request, x, y));
  }
  return text;
}

}  // namespace fracfit
