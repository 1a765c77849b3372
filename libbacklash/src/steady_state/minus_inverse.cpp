// SPDX-License-Identifier: BSD-3-Clause
#include "backlash/minus_inverse.hpp"

#include <cmath>
#include <stdexcept>
#include <string>

#include "base/spelling.hpp"

namespace backlash {
namespace {

constexpr frac::detail::Spellings<Quantity, 2> quantity_spellings = {
    {{Quantity::n, "n"}, {Quantity::minus_inverse, "minus-inverse"}}};
constexpr auto all_quantities = frac::detail::enumerators(quantity_spellings);

bool is_finite(std::complex<double> value) {
  return std::isfinite(value.real()) && std::isfinite(value.imag());
}

}  // namespace

std::string_view to_string(Quantity quantity) {
  return frac::detail::spelling(quantity_spellings, quantity);
}

Quantity quantity_from_string(std::string_view text) {
  return frac::detail::from_spelling(quantity_spellings, "quantity", text);
}

std::span<const Quantity> quantities() {
  return all_quantities;
}

std::optional<MinusInverse> minus_inverse(std::complex<double> value, double uncertainty) {
  const std::complex<double> inverse = -1.0 / value;
  if (is_finite(value) && !is_finite(inverse)) return std::nullopt;
  const double size = std::abs(inverse);
  return MinusInverse{inverse, uncertainty * size * size};
}

std::optional<MinusInverse> minus_inverse(const DescribingFunctionPoint& point) {
  return minus_inverse(point.value, point.uncertainty);
}

MinusInverseData minus_inverse(const frac::FrequencyResponseData& data) {
  std::vector<double> omega, sigma, left_out;
  std::vector<std::complex<double>> value;
  for (std::size_t i = 0; i < data.size(); ++i) {
    const auto inverse = minus_inverse(data.value()[i], data.sigma().empty() ? 0 : data.sigma()[i]);
    if (!inverse) {
      left_out.push_back(data.omega()[i]);
      continue;
    }
    omega.push_back(data.omega()[i]);
    value.push_back(inverse->value);
    if (!data.sigma().empty()) sigma.push_back(inverse->uncertainty);
  }
  if (omega.empty())
    throw std::invalid_argument("the response is 0 at each of its " + std::to_string(data.size()) +
                                " points, where -1/N is infinite");
  return {frac::FrequencyResponseData(std::move(omega), std::move(value), std::move(sigma), data.frequency_unit()),
          std::move(left_out)};
}

}  // namespace backlash
