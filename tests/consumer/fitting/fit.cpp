// SPDX-License-Identifier: BSD-3-Clause
// A fractional lag fitted to its own response.
#include <frac/identification/fit.hpp>
#include <frac/model/fractional_transfer_function.hpp>
#include <iostream>

int main() {
  const auto plant = frac::FractionalTransferFunction::parse("2/(0.5 s^0.7 + 1)");
  const auto data = plant.response(std::vector<double>{0.1, 0.2, 0.5, 1, 2, 5, 10, 20, 50, 100});
  const frac::FitResult result = frac::fit(data, frac::Structure("K/(T s^a + 1)"), frac::FitOptions{});
  for (const auto& parameter : result.parameters) std::cout << parameter.name << " = " << parameter.value << '\n';
  std::cout << result.summary() << '\n';
  return result.usable() ? 0 : 1;
}
