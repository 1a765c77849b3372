// SPDX-License-Identifier: BSD-3-Clause
// s^a realised: error against poles (Oustaloup) or memory (Gruenwald-Letnikov), and the time of one response value.
// Prints case,method,setting,error,seconds; error is the largest |H(jw)/(jw)^a - 1| over the band of the case, seconds
// are per value, the median of 15 repeats over 2000 frequencies.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <complex>
#include <cstdio>
#include <numbers>
#include <string>
#include <vector>

#include "frac/structure.hpp"
#include "support/relative_error.hpp"

namespace {

using Complex = std::complex<double>;

struct PowerCase {
  std::string name;
  double order;
  frac::FrequencyBand band;
};

void run(const PowerCase& power, const std::string& method, const std::string& setting,
         const frac::Realisation& realisation) {
  const frac::Structure structure("s^a");
  const std::vector<double> parameters{power.order};
  const std::vector<double> omega = support::log_grid(power.band.lower, power.band.upper, 2000);
  std::vector<Complex> exact(omega.size());
  std::vector<Complex> value(omega.size());
  structure.response(parameters, omega, frac::ExactRealisation{}, exact);
  std::vector<double> seconds;
  for (int repeat = 0; repeat < 15; ++repeat) {
    const auto start = std::chrono::steady_clock::now();
    structure.response(parameters, omega, realisation, value);
    const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - start;
    seconds.push_back(elapsed.count() / static_cast<double>(omega.size()));
  }
  std::nth_element(seconds.begin(), seconds.begin() + 7, seconds.end());
  double error = 0;
  for (std::size_t i = 0; i < omega.size(); ++i) {
    error = std::max(error, support::relative_error(value[i], exact[i]));
  }
  std::printf("%s,%s,%s,%.3e,%.3e\n", power.name.c_str(), method.c_str(), setting.c_str(), error, seconds[7]);
}

// The margin on each side of the band, in decades, that serves the given number of poles best.
double best_margin(const PowerCase& power, int poles) {
  const std::vector<double> omega = support::log_grid(power.band.lower, power.band.upper, 200);
  double best = 0;
  double least_error = 1e300;
  for (double margin = 0; margin <= 8; margin += 0.1) {
    const double factor = std::pow(10.0, margin);
    const frac::OustaloupRealisation realisation{{power.band.lower / factor, power.band.upper * factor}, poles};
    double error = 0;
    for (const double each : omega) {
      const Complex exact = frac::power_response(frac::ExactRealisation{}, power.order, each).value;
      error =
          std::max(error, support::relative_error(frac::power_response(realisation, power.order, each).value, exact));
    }
    if (error < least_error) {
      least_error = error;
      best = margin;
    }
  }
  return best;
}

}  // namespace

int main() {
  std::printf("# %s, GCC %s, median of 15 repeats\ncase,method,setting,error,seconds\n", FRACFIT_BUILD_TYPE,
              __VERSION__);
  const PowerCase cases[] = {{"s^0.5 over 4 decades", 0.5, {1e-2, 1e2}}, {"s^0.9 over 8 decades", 0.9, {1e-4, 1e4}}};
  for (const PowerCase& power : cases) {
    run(power, "exact", "", frac::ExactRealisation{});
    for (const int poles : {5, 10, 20, 40}) {
      run(power, "oustaloup", std::to_string(poles) + " poles", frac::OustaloupRealisation{power.band, poles});
    }
    for (const int poles : {5, 10, 20, 40, 60, 120}) {
      const double margin = best_margin(power, poles);
      const double factor = std::pow(10.0, margin);
      char setting[64];
      std::snprintf(setting, sizeof setting, "%d poles margin %.1f decades", poles, margin);
      run(power, "oustaloup widened", setting,
          frac::OustaloupRealisation{{power.band.lower / factor, power.band.upper * factor}, poles});
    }
    // A hundred samples per period of the highest frequency: the difference alone is then off by about a pi/100 there.
    const double sample_time = 2 * std::numbers::pi / (100 * power.band.upper);
    for (const std::size_t memory_length : {100u, 1000u, 10'000u}) {
      run(power, "grunwald-letnikov", "memory " + std::to_string(memory_length),
          frac::GrunwaldLetnikovRealisation{sample_time, memory_length});
    }
    run(power, "grunwald-letnikov", "all samples", frac::GrunwaldLetnikovRealisation{sample_time, 0});
  }
}
