// SPDX-License-Identifier: BSD-3-Clause
// Exported subcircuits in ngspice: over frequency against the formula, over time against respond().
#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <cstdlib>
#include <fstream>
#include <functional>
#include <numbers>
#include <sstream>
#include <string>
#include <vector>

#include "frac/circuit.hpp"
#include "frac/structure.hpp"
#include "frac/time_response/respond.hpp"
#include "support/random.hpp"
#include "tools/temporary_folder.hpp"

namespace {

using Complex = std::complex<double>;
using frac::FractionalTransferFunction;
using Rows = std::vector<std::vector<double>>;

constexpr frac::FrequencyBand band{1e-2, 1e2};
constexpr double tolerance = 1e-3;

class Spice : public ::testing::Test {
 protected:
  void SetUp() override {
    if (std::system("ngspice --version >/dev/null 2>&1") != 0) GTEST_SKIP() << "ngspice is not installed";
  }

  // Columns that ngspice writes for `vector` after `analysis`, for a circuit around the subcircuit `part`.
  Rows simulated(const std::string& netlist, const std::string& around, const std::string& analysis,
                 const std::string& vector) const {
    const std::string output = folder_.path("output");
    folder_.write("part.lib", netlist);
    // Tolerances of the solver for pulses of 1 V; finer ones end in steps below its rounding.
    const std::string deck = "test of an exported part\n.include " + folder_.path("part.lib") + "\n" + around +
                             "\n.options reltol=1e-5 vntol=1e-9 abstol=1e-12 chgtol=1e-10 method=trap\n.control\n" +
                             "set numdgt=15\nset wr_singlescale\n" + analysis + "\nwrdata " + output + " " + vector +
                             "\nquit\n.endc\n.end\n";
    folder_.write("deck.cir", deck);
    const std::string messages = folder_.path("messages");
    EXPECT_EQ(std::system(("ngspice -b " + folder_.path("deck.cir") + " >" + messages + " 2>&1").c_str()), 0)
        << content_of(messages);
    std::ifstream file(output);
    Rows rows;
    for (std::string line; std::getline(file, line);) {
      std::istringstream words(line);
      std::vector<double> row;
      for (double number; words >> number;) row.push_back(number);
      if (!row.empty()) rows.push_back(row);
    }
    EXPECT_FALSE(rows.empty()) << content_of(messages) << netlist;
    return rows;
  }

 private:
  TemporaryFolder folder_;
};

std::string impedance_under_current(const std::string& source) {
  return "X1 a 0 part\nI1 0 a " + source;
}

std::string transfer_under_voltage(const std::string& source) {
  return "X1 in 0 out 0 part\nV1 in 0 " + source;
}

// Hertz whose angular frequencies fill the band.
std::string sweep_of_band() {
  std::ostringstream text;
  text.precision(17);
  text << "ac dec 20 " << band.lower / (2 * std::numbers::pi) << ' ' << band.upper / (2 * std::numbers::pi);
  return text.str();
}

// @param rounding  of the solver of ngspice: by default of sums that cancel to 1e-5 of their terms at most
void expect_over_frequency(const Rows& rows, const std::function<Complex(Complex)>& exact, double certified,
                           double rounding = 1e-9) {
  ASSERT_GE(rows.size(), 80U);
  double worst = 0;
  for (const auto& row : rows) {
    const double omega = 2 * std::numbers::pi * row[0];
    // The last frequency of ngspice's own grid may lie above the band.
    if (omega > band.upper) continue;
    worst = std::max(worst, std::abs(Complex(row[1], row[2]) / exact({0, omega}) - 1.0));
  }
  EXPECT_LE(worst, certified + rounding);
  EXPECT_GE(worst, 0.3 * certified - rounding);
}

// A smooth pulse of height 1 without a mean, x exp((1 - x^2)/2) with x = t/width - 8, straight between samples for both
// sides alike.
struct Pulse {
  double width = 1;
  double step = 0.05;
  int samples = 800;

  [[nodiscard]] std::vector<double> values() const {
    std::vector<double> u;
    for (int n = 0; n < samples; ++n) {
      const double x = n * step / width - 8;
      u.push_back(x * std::exp(0.5 - 0.5 * x * x));
    }
    u.front() = 0;
    return u;
  }
  [[nodiscard]] std::string source() const {
    std::ostringstream text;
    text.precision(17);
    text << "PWL(";
    const std::vector<double> u = values();
    for (int n = 0; n < samples; ++n)
      text << (n % 8 == 7 ? "\n+ " : " ") << n * step << ' ' << u[static_cast<std::size_t>(n)];
    text << ")";
    return text.str();
  }
  // |U(j omega)| of the smooth pulse.  Straight lines change it by (omega step)^2/24 of itself, 1e-4 up to 1/width.
  [[nodiscard]] double spectrum(double omega) const {
    const double x = omega * width;
    return std::sqrt(2 * std::numbers::pi) * width * x * std::exp(0.5 - 0.5 * x * x);
  }
};

// |y_H - y_G| <= 1/pi integral of |H - G| |U|: the certified error on the band, the difference itself below it.
double time_bound(const std::function<Complex(double)>& circuit, const std::function<Complex(Complex)>& exact,
                  double certified, const Pulse& pulse) {
  double sum = 0;
  constexpr double per_step = 0.01;  // of ln omega
  for (double ln = std::log(1e-8); ln < std::log(30 / pulse.width); ln += per_step) {
    const double omega = std::exp(ln);
    const Complex g = exact({0, omega});
    const bool is_inside = omega >= band.lower && omega <= band.upper;
    const double difference = is_inside ? certified * std::abs(g) : std::abs(circuit(omega) - g);
    sum += difference * pulse.spectrum(omega) * omega * per_step;
  }
  return sum / std::numbers::pi;
}

void expect_over_time(const Rows& rows, const std::vector<double>& expected, const Pulse& pulse, double bound) {
  double largest = 0;
  for (const double each : expected) largest = std::max(largest, std::abs(each));
  double worst = 0;
  std::size_t compared = 0;
  // Corners of the source are time points of ngspice, to rounding of its sums of steps.
  constexpr double same_time = 1e-7;
  std::size_t n = 0;
  for (const auto& row : rows) {
    while (n < expected.size() && static_cast<double>(n) * pulse.step < row[0] - same_time) ++n;
    if (n >= expected.size() || std::abs(static_cast<double>(n) * pulse.step - row[0]) > same_time) continue;
    worst = std::max(worst, std::abs(row[1] - expected[n]));
    ++compared;
  }
  EXPECT_GE(compared, expected.size() * 9 / 10);
  // The trapezoidal rule of ngspice at a quarter of the samples' step: (step/4)^2/12 of the second derivative, which is
  // 1/width^2 of the signal.
  const double rule = std::pow(pulse.step / 4 / pulse.width, 2) / 12 * largest;
  EXPECT_LE(worst, bound + rule + 1e-5 * largest) << "bound " << bound << ", of " << largest;
  EXPECT_LT(bound, 0.02 * largest) << "the comparison says something";
}

struct Case {
  std::string formula;
  std::function<Complex(Complex)> exact;
};

std::string transient(const Pulse& pulse) {
  std::ostringstream text;
  text.precision(17);
  text << "tran " << pulse.step << ' ' << (pulse.samples - 1) * pulse.step << " 0 " << pulse.step / 4;
  return text.str();
}

TEST_F(Spice, OnePortsHaveTheirCertifiedErrorOverFrequencyAndTime) {
  const std::vector<Case> cases{
      {"s^-0.5", [](Complex s) { return std::pow(s, -0.5); }},
      {"s^0.5", [](Complex s) { return std::pow(s, 0.5); }},
      {"0.1 s + 5 + 20/(1 + s^0.8)", [](Complex s) { return 0.1 * s + 5.0 + 20.0 / (1.0 + std::pow(s, 0.8)); }},
      {"1/(5 + (s + 0.05)/(s^2 + 0.1 s + 1) + s^-0.5)",
       [](Complex s) { return 1.0 / (5.0 + (s + 0.05) / (s * s + 0.1 * s + 1.0) + std::pow(s, -0.5)); }}};
  for (const Case& each : cases) {
    SCOPED_TRACE(each.formula);
    const auto model = FractionalTransferFunction::parse(each.formula);
    const auto circuit = frac::passive_one_port(model, band, tolerance);
    const std::string netlist = frac::spice_netlist(circuit, {.name = "part", .comment = circuit.summary()});
    expect_over_frequency(simulated(netlist, impedance_under_current("dc 0 ac 1"), sweep_of_band(), "v(a)"), each.exact,
                          circuit.max_relative_error);
    // respond() takes what does not grow with s; the impedances that do are driven by a voltage.
    const bool grows = model.numerator().front().order > model.denominator().front().order;
    const Pulse pulse;
    const auto exact = [&](Complex s) { return grows ? 1.0 / each.exact(s) : each.exact(s); };
    const auto of_circuit = [&](double omega) {
      return grows ? 1.0 / circuit.response(omega) : circuit.response(omega);
    };
    const auto driven = grows ? FractionalTransferFunction(model.denominator(), model.numerator()) : model;
    const std::vector<double> expected =
        frac::respond(driven, pulse.values(), pulse.step, 1e-10, frac::Hold::first_order);
    const Rows rows = grows ? simulated(netlist, "X1 a 0 part\nV1 a 0 " + pulse.source(), transient(pulse), "-i(V1)")
                            : simulated(netlist, impedance_under_current(pulse.source()), transient(pulse), "v(a)");
    // The circuit's error relative to its inverse is the same to second order.
    expect_over_time(rows, expected, pulse, time_bound(of_circuit, exact, 1.01 * circuit.max_relative_error, pulse));
  }
}

// Diffusion of finite length, behind either end, in a cell with an inductance, and one that only inductors give.  Over
// time a sum over the exact poles of the first stands for respond(), which takes powers alone: a current of 1 A from
// t = 0 on gives R tanh(sqrt(tau s))/sqrt(tau s) the voltage R (1 - sum 8/((2k+1) pi)^2 exp(-(2k+1)^2 pi^2 t/(4 tau))).
TEST_F(Spice, OnePortsWithFunctionsHaveTheirCertifiedErrorOverFrequencyAndTime) {
  const auto warburg = [](Complex s) { return std::tanh(std::sqrt(s)) / std::sqrt(s); };
  const std::vector<Case> cases{
      {"tanh(sqrt(s))/sqrt(s)", warburg},
      {"0.01 s + 3 + 1/(tanh(sqrt(s)) sqrt(s))",
       [](Complex s) { return 0.01 * s + 3.0 + 1.0 / (std::tanh(std::sqrt(s)) * std::sqrt(s)); }},
      {"5 + 1/(0.1 s + 1/(10 + 20 tanh(sqrt(3 s))/sqrt(3 s)))",
       [&](Complex s) { return 5.0 + 1.0 / (0.1 * s + 1.0 / (10.0 + 20.0 * warburg(3.0 * s))); }},
      {"sqrt(s) coth(sqrt(s))", [&](Complex s) { return 1.0 / warburg(s); }}};
  for (const Case& each : cases) {
    SCOPED_TRACE(each.formula);
    const auto circuit = frac::passive_one_port(frac::Structure(each.formula), band, 1e-4);
    EXPECT_LE(circuit.max_relative_error, 1e-4);
    const std::string netlist = frac::spice_netlist(circuit, {.name = "part", .comment = circuit.summary()});
    // A cell of 2e6 F has 2e8 times the admittance of the whole at the upper edge, which leaves 8 digits.
    expect_over_frequency(simulated(netlist, impedance_under_current("dc 0 ac 1"), sweep_of_band(), "v(a)"), each.exact,
                          circuit.max_relative_error, 3e-7);
    if (&each != &cases.front()) continue;
    const Rows rows = simulated(netlist, impedance_under_current("PWL(0 0 1e-6 1)"), "tran 0.01 5 0 0.01", "v(a)");
    for (const auto& row : rows) {
      if (row[0] < 0.1) continue;
      double exact = 1;
      for (int k = 0; k < 40; ++k) {
        const double odd = (2 * k + 1) * std::numbers::pi;
        exact -= 8 / (odd * odd) * std::exp(-odd * odd / 4 * row[0]);
      }
      // The certified error, of a step whose share above the band is 0.1 of the whole, and the rule of ngspice at steps
      // of 0.01 of the slowest time constant's share, (pi^2/4 0.01)^2/12.
      ASSERT_NEAR(row[1], exact, 3e-4) << row[0];
    }
  }
  // A line without loss resonates: its poles lie on the axis.
  EXPECT_THROW((void)frac::passive_one_port(frac::Structure("coth(s + 0.1)"), band, 1e-3), std::domain_error);
  EXPECT_THROW((void)frac::passive_one_port(frac::Structure("-tanh(s)"), band, 1e-3), std::domain_error);
  EXPECT_THROW((void)frac::passive_one_port(frac::Structure("K tanh(s)"), band, 1e-3), std::invalid_argument);
}

TEST_F(Spice, TransferFunctionsHaveTheirCertifiedErrorOverFrequencyAndTime) {
  const std::vector<Case> cases{
      {"1/(0.8 s^2.2 + 0.5 s^0.9 + 1)",
       [](Complex s) { return 1.0 / (0.8 * std::pow(s, 2.2) + 0.5 * std::pow(s, 0.9) + 1.0); }},
      {"s^-0.5", [](Complex s) { return std::pow(s, -0.5); }},
      {"exp(-0.7 s)/(s^1.5 + 1)", [](Complex s) { return std::exp(-0.7 * s) / (std::pow(s, 1.5) + 1.0); }},
      {"1/((s^0.5 + 1)^2 (s + 1))", [](Complex s) { return 1.0 / (std::pow(std::sqrt(s) + 1.0, 2) * (s + 1.0)); }}};
  for (const Case& each : cases) {
    SCOPED_TRACE(each.formula);
    const auto model = FractionalTransferFunction::parse(each.formula);
    const auto circuit = frac::transfer_circuit(model, band, tolerance);
    const std::string netlist = frac::spice_netlist(circuit, {.name = "part", .comment = circuit.summary()});
    expect_over_frequency(simulated(netlist, transfer_under_voltage("dc 0 ac 1"), sweep_of_band(), "v(out)"),
                          each.exact, circuit.max_relative_error);
    const Pulse pulse;
    const std::vector<double> expected =
        frac::respond(model, pulse.values(), pulse.step, 1e-10, frac::Hold::first_order);
    const auto of_circuit = [&](double omega) {
      return circuit.system.response(omega) * std::polar(1.0, -omega * circuit.delay);
    };
    expect_over_time(simulated(netlist, transfer_under_voltage(pulse.source()), transient(pulse), "v(out)"), expected,
                     pulse, time_bound(of_circuit, each.exact, circuit.max_relative_error, pulse));
  }
}

// Random models of one to three terms with and without dead time.  The error that the netlist names is a bound: up to
// both ends of the band, as the netlist names them in hertz, nothing is above it, not even by the rounding of its three
// digits.
TEST_F(Spice, TheErrorThatANetlistNamesIsABound) {
  support::Random random(390101);
  constexpr int models = 12;
  for (int trial = 0; trial < models; ++trial) {
    const int terms = 1 + trial % 3;
    std::vector<frac::PowerTerm> below{{1, 0}};
    for (int i = 0; i < terms; ++i) below.push_back({random.log_uniform(0.03, 30), random.uniform(0.1, 1.9)});
    const std::vector<frac::PowerTerm> above{{random.log_uniform(0.03, 30), 0}};
    const double delay = trial % 2 == 0 ? random.log_uniform(0.01, 1) : 0;
    const frac::FractionalTransferFunction model(above, below, delay);
    const frac::FrequencyBand own{1e-2, trial % 4 < 2 ? 1e2 : 1e3};
    SCOPED_TRACE(model.formula());
    const auto circuit = frac::transfer_circuit(model, own, trial % 3 == 0 ? 1e-2 : 1e-3);
    const std::string netlist = frac::spice_netlist(circuit, {.name = "part", .comment = circuit.summary()});
    const auto after = [&](const std::string& words, std::size_t from) {
      const std::size_t at = netlist.find(words, from);
      EXPECT_NE(at, std::string::npos) << netlist.substr(0, 300);
      return at + words.size();
    };
    const std::size_t in_hertz = after("rad/s (", 0);
    const double low = std::stod(netlist.substr(in_hertz));
    const double high = std::stod(netlist.substr(after(" .. ", in_hertz)));
    const double stated = std::stod(netlist.substr(after("largest relative error ", 0)));
    EXPECT_LE(circuit.max_relative_error, stated);
    // Six digits of hertz, within the band.
    EXPECT_GE(2 * std::numbers::pi * low, own.lower);
    EXPECT_LE(2 * std::numbers::pi * high, own.upper);
    EXPECT_NEAR(2 * std::numbers::pi * low / own.lower, 1, 2e-5);
    EXPECT_NEAR(2 * std::numbers::pi * high / own.upper, 1, 2e-5);
    std::ostringstream sweep;
    sweep.precision(17);
    sweep << "ac dec 200 " << low << ' ' << high;
    double worst = 0;
    for (const auto& row : simulated(netlist, transfer_under_voltage("dc 0 ac 1"), sweep.str(), "v(out)")) {
      const double omega = 2 * std::numbers::pi * row[0];
      if (omega > own.upper) continue;
      Complex sum = 0;
      for (const frac::PowerTerm& term : below) sum += term.coefficient * std::pow(Complex(0, omega), term.order);
      const Complex exact = above.front().coefficient * std::polar(1.0, -omega * delay) / sum;
      worst = std::max(worst, std::abs(Complex(row[1], row[2]) / exact - 1.0));
    }
    EXPECT_LE(worst, stated);
    EXPECT_GE(worst, 0.9 * circuit.max_relative_error) << "the bound is no loose one";
  }
}

}  // namespace
