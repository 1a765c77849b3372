// SPDX-License-Identifier: BSD-3-Clause
// Which of several structures do measured data speak for?  Here they come from a fractional oscillator with 0.5 %
// noise.
#include <cmath>
#include <complex>
#include <frac/identification/identify.hpp>
#include <frac/identification/model_library.hpp>
#include <frac/model/fractional_transfer_function.hpp>
#include <iostream>
#include <random>

int main() {
  const auto plant = frac::FractionalTransferFunction::parse("2/(0.5 s^1.6 + 0.3 s^0.7 + 1)");
  std::mt19937_64 generator(1);
  std::normal_distribution<double> noise(0, 0.005);
  std::vector<double> omega;
  std::vector<std::complex<double>> value;
  for (int i = 0; i < 60; ++i) {
    omega.push_back(std::pow(10.0, -1.5 + 3.0 * i / 59));  // rad/s
    const std::complex<double> relative(1 + noise(generator), noise(generator));
    value.push_back(plant.response(omega.back()) * relative);
  }
  const frac::FrequencyResponseData data(omega, value);
  std::vector<frac::NamedModel> models;
  for (const char* each : {"oscillator", "fractional-lag", "K/(T2 s^a + T1 s^b + 1)", "rational:1..4"}) {
    models.push_back(frac::find_model(each));
  }
  const frac::IdentificationResult result = frac::identify(data, models, {}, {});
  std::cout << "verdict " << to_string(result.verdict) << '\n' << result.summary() << '\n';
  return result.usable() ? 0 : 1;
}
