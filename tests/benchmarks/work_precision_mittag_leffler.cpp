// SPDX-License-Identifier: BSD-3-Clause
// Mittag-Leffler function: time per value beside libm's erfc (batch, z < 0) and std::exp of a complex number (scalar).
// Prints case,method,setting,error,seconds; error is the largest against data/reference/mittag_leffler.csv at that
// alpha in units of (1 + |E|) max(1, |z E'/E|), seconds of processor time are per value, the median of 15
// repeats over 20 000 arguments.
#include <algorithm>
#include <cmath>
#include <complex>
#include <cstdio>
#include <ctime>
#include <fstream>
#include <limits>
#include <sstream>
#include <string>
#include <vector>

#include "frac/mittag_leffler.hpp"
#include "support/random.hpp"

namespace {

using Complex = std::complex<double>;
constexpr std::size_t arguments = 20'000;

template <typename Work>
double seconds_per_value(const Work& work) {
  std::vector<double> seconds;
  for (int repeat = 0; repeat < 15; ++repeat) {
    const std::clock_t start = std::clock();
    work();
    seconds.push_back(static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC / static_cast<double>(arguments));
  }
  std::nth_element(seconds.begin(), seconds.begin() + 7, seconds.end());
  return seconds[7];
}

double largest_error(double alpha, bool negative_only) {
  std::ifstream file(std::string(FRACFIT_SOURCE_DIR) + "/data/reference/mittag_leffler.csv");
  std::string line;
  std::getline(file, line);
  double largest = std::numeric_limits<double>::quiet_NaN();
  while (std::getline(file, line)) {
    std::vector<std::string> cell;
    std::stringstream stream(line);
    for (std::string text; std::getline(stream, text, ',');) cell.push_back(text);
    const Complex z(std::stod(cell[3]), std::stod(cell[4]));
    if (std::stod(cell[0]) != alpha || (negative_only && (z.imag() != 0 || z.real() >= 0))) continue;
    const Complex exact(std::stod(cell[5]), std::stod(cell[6]));
    const double unit = (1 + std::abs(exact)) * std::max(1.0, std::stod(cell[10]));
    const double error = std::abs(frac::mittag_leffler(alpha, std::stod(cell[1]), z) - exact) / unit;
    largest = std::fmax(largest, error);
  }
  return largest;
}

void print(const std::string& name, const char* method, const std::string& setting, double error, double seconds) {
  std::printf("%s,%s,%s,%.3e,%.3e\n", name.c_str(), method, setting.c_str(), error, seconds);
}

}  // namespace

int main() {
  std::printf("# %s, GCC %s, median of 15 repeats\ncase,method,setting,error,seconds\n", FRACFIT_BUILD_TYPE,
              __VERSION__);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  support::Random random(1);
  std::vector<double> z(arguments), positive(arguments), value(arguments);
  std::vector<Complex> complex_z(arguments);
  for (std::size_t i = 0; i < arguments; ++i) {
    positive[i] = random.uniform(0, 5);
    z[i] = -random.log_uniform(0.02, 1e4);
    complex_z[i] = std::polar(random.log_uniform(0.02, 20), random.uniform(-3.14, 3.14));
  }
  print("z < 0", "libm erfc", "0 < x < 5", nan, seconds_per_value([&] {
          for (std::size_t i = 0; i < arguments; ++i) value[i] = std::erfc(positive[i]);
        }));
  for (const auto& [alpha, beta] : {std::pair{0.5, 1.0}, {0.75, 1.0}, {0.75, 0.75}, {0.25, 2.0}, {0.99, 1.0}}) {
    const std::string setting = "alpha " + std::to_string(alpha) + " beta " + std::to_string(beta);
    print("z < 0", "batch", setting, largest_error(alpha, true),
          seconds_per_value([&] { frac::mittag_leffler(alpha, beta, z, value); }));
  }
  volatile double sink = 0;
  print("complex z", "std::exp", "", nan, seconds_per_value([&] {
          Complex sum = 0;
          for (const Complex each : complex_z) sum += std::exp(each);
          sink = sum.real();
        }));
  for (const auto& [alpha, beta] :
       {std::pair{0.25, 1.0}, {0.5, 1.0}, {0.75, 0.75}, {0.99, 1.0}, {1.5, 1.0}, {1.9, 2.0}}) {
    const std::string setting = "alpha " + std::to_string(alpha) + " beta " + std::to_string(beta);
    print("complex z", "scalar", setting, largest_error(alpha, false), seconds_per_value([&] {
            Complex sum = 0;
            for (const Complex each : complex_z) sum += frac::mittag_leffler(alpha, beta, each);
            sink = sum.real();
          }));
  }
  print("complex z", "scalar", "another alpha at each call", nan, seconds_per_value([&] {
          Complex sum = 0;
          double alpha = 0.5;
          for (const Complex each : complex_z) sum += frac::mittag_leffler(alpha += 1e-5, 1, each);
          sink = sum.real();
        }));
}
