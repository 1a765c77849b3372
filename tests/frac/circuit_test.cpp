// SPDX-License-Identifier: BSD-3-Clause
#include "frac/circuit.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <functional>
#include <random>
#include <stdexcept>
#include <string>
#include <vector>

#include "support/expect_invalid_argument.hpp"

namespace {

using Complex = std::complex<double>;
using frac::FosterForm;
using frac::FractionalTransferFunction;

constexpr frac::FrequencyBand band{1e-3, 1e3};

FractionalTransferFunction model(const std::string& formula) {
  return FractionalTransferFunction::parse(formula);
}

// The finest turn of the error is seen by ten grid points or more, between which a parabola misses 1 % of its height.
constexpr double grid_slack = 1.01;

// Closed forms beside the formulas, so that nothing of the library stands on both sides.
struct Impedance {
  std::string formula;
  std::function<Complex(Complex)> value;
};

Complex zarc(Complex s, double time, double order) {
  return 1.0 / (1.0 + std::pow(time * s, order));
}

std::vector<Impedance> passive_impedances() {
  return {{"s^-0.5", [](Complex s) { return std::pow(s, -0.5); }},
          {"s^0.7", [](Complex s) { return std::pow(s, 0.7); }},
          {"3 s^-1", [](Complex s) { return 3.0 / s; }},
          {"3 s", [](Complex s) { return 3.0 * s; }},
          {"7", [](Complex) { return Complex(7); }},
          {"5 + 20/(1 + (0.1 s)^0.8) + 1/(0.3 s)^0.5",
           [](Complex s) { return 5.0 + 20.0 * zarc(s, 0.1, 0.8) + std::pow(0.3 * s, -0.5); }},
          {"0.001 s + 5 + 20/(1 + (0.1 s)^0.8)", [](Complex s) { return 0.001 * s + 5.0 + 20.0 * zarc(s, 0.1, 0.8); }},
          {"1/(0.1 s + 1/s + 0.3)", [](Complex s) { return 1.0 / (0.1 * s + 1.0 / s + 0.3); }},
          {"s^0.3/(s + 1)", [](Complex s) { return std::pow(s, 0.3) / (s + 1.0); }},
          {"5 + (s + 0.05)/(s^2 + 0.1 s + 1) + s^-0.5",
           [](Complex s) { return 5.0 + (s + 0.05) / (s * s + 0.1 * s + 1.0) + std::pow(s, -0.5); }},
          {"1/(5 + (s + 0.05)/(s^2 + 0.1 s + 1) + s^-0.5)",
           [](Complex s) { return 1.0 / (5.0 + (s + 0.05) / (s * s + 0.1 * s + 1.0) + std::pow(s, -0.5)); }}};
}

TEST(PassiveOnePort, HasPositiveElementsAndItsCertifiedError) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> decade(-3, 3);
  for (const Impedance& impedance : passive_impedances()) {
    for (const double tolerance : {1e-2, 1e-4}) {
      SCOPED_TRACE(impedance.formula);
      const auto circuit = frac::passive_one_port(model(impedance.formula), band, tolerance);
      EXPECT_TRUE(circuit.usable()) << circuit.message;
      EXPECT_LE(circuit.max_relative_error, tolerance);
      for (const frac::FosterCell& cell : circuit.cells)
        for (const auto& element : {cell.resistance, cell.capacitance, cell.inductance, cell.loss}) {
          if (element) {
            EXPECT_TRUE(*element > 0 && std::isfinite(*element));
          }
        }
      double worst = 0;
      for (int i = 0; i < 400; ++i) {
        const double omega = std::pow(10.0, decade(random));
        worst = std::max(worst, std::abs(circuit.response(omega) / impedance.value({0, omega}) - 1.0));
      }
      // Rounding of the sum of cells and of the closed form, for circuits that are exact.
      EXPECT_LE(worst, grid_slack * circuit.max_relative_error + 1e-12);
      EXPECT_GE(worst, 0.3 * circuit.max_relative_error - 1e-12);  // the figure is no mere bound
      // Passive beyond the band too.
      for (const double omega : {1e-9, 1e-6, 1e6, 1e9}) {
        const Complex value = circuit.response(omega);
        EXPECT_GE(value.real(), -1e-12 * std::abs(value)) << omega;
      }
    }
  }
}

void expect_refusal(const std::string& formula, const std::string& words) {
  SCOPED_TRACE(formula);
  try {
    (void)frac::passive_one_port(model(formula), band, 1e-3);
    ADD_FAILURE() << "nothing was thrown";
  } catch (const std::domain_error& error) {
    EXPECT_NE(std::string(error.what()).find(words), std::string::npos) << error.what();
  }
}

TEST(PassiveOnePort, RefusesWhatNoPassiveCircuitHas) {
  expect_refusal("s^1.2", "Re Z = -");
  expect_refusal("s^-1.2", "Re Z = -");
  expect_refusal("s - 1", "Re Z = -1 ohm");
  expect_refusal("exp(-0.1 s)/(s + 1)", "dead time of 0.1 s");
  expect_refusal("1 - 1e-4 s", "grows as -0.0001 s");
  // Passive, yet its pair has a real part of both signs by itself, and so has that of its inverse.
  expect_refusal("5 + 1/(s^2 + s + 1)", "at the poles -0.5 +- 0.866j rad/s changes sign");
}

TEST(PassiveOnePort, ChecksItsArguments) {
  support::expect_invalid_argument([] { (void)frac::passive_one_port(model("s^-0.5"), {1, 0.1}, 1e-3); }, {"band = 1"});
  support::expect_invalid_argument([] { (void)frac::passive_one_port(model("s^-0.5"), band, 2); }, {"tolerance = 2"});
  // An inductor alone has no part that a band would shape, and a formula with functions is designed in another way:
  // both ask for the same.
  support::expect_invalid_argument([] { (void)frac::passive_one_port(model("s"), {1, 0.1}, 1e-3); }, {"band = 1"});
  const frac::Structure line("tanh(s^0.5)/s^0.5");
  support::expect_invalid_argument([&] { (void)frac::passive_one_port(line, {1, 0.1}, 1e-3); }, {"band = 1 to 0.1"});
  support::expect_invalid_argument([&] { (void)frac::passive_one_port(line, band, 2); }, {"tolerance = 2"});
  const auto circuit = frac::passive_one_port(model("s^-0.5"), band, 1e-1);
  support::expect_invalid_argument([&] { (void)frac::spice_netlist(circuit, {.name = "1z"}); },
                                   {"name of the subcircuit \"1z\""});
}

TEST(TransferCircuit, HasItsCertifiedError) {
  std::mt19937 random(4);
  std::uniform_real_distribution<double> decade(-3, 3);
  const std::vector<Impedance> models{
      {"1/(0.8 s^2.2 + 0.5 s^0.9 + 1)",
       [](Complex s) { return 1.0 / (0.8 * std::pow(s, 2.2) + 0.5 * std::pow(s, 0.9) + 1.0); }},
      {"s^0.5", [](Complex s) { return std::sqrt(s); }},
      {"1/(s^2 + s^0.5)", [](Complex s) { return 1.0 / (s * s + std::sqrt(s)); }},
      {"2/s + s^-1.5", [](Complex s) { return 2.0 / s + std::pow(s, -1.5); }},
      {"1/s^2", [](Complex s) { return 1.0 / (s * s); }},
      {"1/((s^0.5 + 1)^2 (s + 1))", [](Complex s) { return 1.0 / (std::pow(std::sqrt(s) + 1.0, 2) * (s + 1.0)); }},
      {"1/(s^1.5 - 1)", [](Complex s) { return 1.0 / (std::pow(s, 1.5) - 1.0); }}};
  for (const Impedance& each : models) {
    SCOPED_TRACE(each.formula);
    const auto circuit = frac::transfer_circuit(model(each.formula), band, 1e-3);
    EXPECT_TRUE(circuit.usable()) << circuit.message;
    double worst = 0;
    for (int i = 0; i < 400; ++i) {
      const double omega = std::pow(10.0, decade(random));
      worst = std::max(worst, std::abs(circuit.system.response(omega) / each.value({0, omega}) - 1.0));
    }
    EXPECT_LE(worst, grid_slack * circuit.max_relative_error);
    EXPECT_GE(worst, 0.3 * circuit.max_relative_error);
    for (std::size_t i = 0; i < circuit.system.states; ++i) {
      EXPECT_GT(circuit.rates[i], 0);
      EXPECT_NE(circuit.system.a[i * circuit.system.states + i], 0) << "no operating point";
    }
  }
}

}  // namespace
