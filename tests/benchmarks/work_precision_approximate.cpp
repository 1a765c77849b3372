// SPDX-License-Identifier: BSD-3-Clause
// Design of rational approximations of s^a: largest relative error on the band and time of a design, by method and
// number of poles.  Prints case,method,setting,error,seconds; seconds are processor time, the median of 5 repeats.
// Rows "response value": the largest error of the response in double arithmetic on a grid of the band and the time per
// value.  Rows "true over reported error": |ratio - 1| of the error recomputed from logarithms and angles in long
// double on that grid, and its time; the program fails where one is above 2 %.
#include <algorithm>
#include <cmath>
#include <complex>
#include <cstdio>
#include <ctime>
#include <numbers>
#include <stdexcept>
#include <string>
#include <vector>

#include "frac/approximation/approximate.hpp"

namespace {

double processor_seconds() {
  timespec now{};
  ::clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

struct Case {
  std::string name;
  double order;
  frac::FrequencyBand band;
};

constexpr int grid_points = 10'000;

std::vector<double> grid(frac::FrequencyBand band) {
  std::vector<double> omega;
  const double decades = std::log(band.upper / band.lower);
  for (int i = 0; i <= grid_points; ++i) omega.push_back(band.lower * std::exp(decades * i / grid_points));
  return omega;
}

// |H/(j omega)^order - 1| for 0 < order < 1.
double true_error_at(const frac::Approximation& result, long double omega) {
  using Real = long double;
  const frac::ZeroPoleGain& system = result.system;
  Real log_gain = std::log(Real{system.gain}) - Real{result.order} * std::log(omega);
  Real angle = -Real{result.order} * std::numbers::pi_v<Real> / 2;
  const auto add = [&](std::complex<double> root, int sign) {
    const std::complex<Real> factor(-Real{root.real()}, omega - Real{root.imag()});
    log_gain += sign * std::log(std::abs(factor));
    angle += sign * std::arg(factor);
  };
  const auto add_pair = [&](std::complex<double> root, int sign) {
    add(root, sign);
    add(std::conj(root), sign);
  };
  // In turn, so that partial sums stay small: all zeros first would round at 3e-17.
  for (std::size_t i = 0; i < std::max(system.zeros.size(), system.poles.size()); ++i) {
    if (i < system.zeros.size()) add(system.zeros[i], 1);
    if (i < system.poles.size()) add(system.poles[i], -1);
  }
  for (const std::complex<double>& zero : system.zero_pairs) add_pair(zero, 1);
  for (const std::complex<double>& pole : system.pole_pairs) add_pair(pole, -1);
  const Real half = std::sin(angle / 2);
  return static_cast<double>(
      std::hypot(std::expm1(log_gain) * std::cos(angle) - 2 * half * half, std::exp(log_gain) * std::sin(angle)));
}

// @return whether the reported error is within 2 % of the true one.
bool check(const Case& power, const frac::Approximation& result) {
  const std::vector<double> omega = grid(power.band);
  const std::string method(frac::to_string(result.method));
  std::vector<std::complex<double>> values(omega.size());
  std::vector<double> seconds;
  for (int repeat = 0; repeat < 5; ++repeat) {
    const double start = processor_seconds();
    for (std::size_t i = 0; i < omega.size(); ++i) values[i] = result.system.response(omega[i]);
    seconds.push_back((processor_seconds() - start) / static_cast<double>(omega.size()));
  }
  std::nth_element(seconds.begin(), seconds.begin() + 2, seconds.end());
  double largest = 0;
  for (std::size_t i = 0; i < omega.size(); ++i) {
    const auto exact = std::polar(std::pow(omega[i], power.order), power.order * std::numbers::pi / 2);
    largest = std::max(largest, std::abs(values[i] / exact - 1.0));
  }
  std::printf("%s,%s,response value: %d poles,%.3e,%.3e\n", power.name.c_str(), method.c_str(), result.poles, largest,
              seconds[2]);
  const double start = processor_seconds();
  double true_error = 0;
  for (const double point : omega) true_error = std::max(true_error, true_error_at(result, point));
  const double departure = std::abs(true_error / result.error.max_relative - 1);
  std::printf("%s,%s,true over reported error: %d poles,%.3e,%.3e\n", power.name.c_str(), method.c_str(), result.poles,
              departure, processor_seconds() - start);
  return departure <= 0.02;
}

bool run(const Case& power, frac::ApproximationMethod method, frac::ApproximationGoal goal, const std::string& asked) {
  std::vector<double> seconds;
  frac::Approximation result = frac::approximate(power.order, power.band, goal, method);
  for (int repeat = 0; repeat < 5; ++repeat) {
    const double start = processor_seconds();
    result = frac::approximate(power.order, power.band, goal, method);
    seconds.push_back(processor_seconds() - start);
  }
  std::nth_element(seconds.begin(), seconds.begin() + 2, seconds.end());
  std::printf("%s,%s,%s%d poles (limit %d),%.3e,%.3e\n", power.name.c_str(),
              std::string(frac::to_string(method)).c_str(), asked.c_str(), result.poles, result.limit_poles,
              result.error.max_relative, seconds[2]);
  return check(power, result);
}

}  // namespace

int main() {
  std::printf("# %s, GCC %s, median of 5 repeats\ncase,method,setting,error,seconds\n", FRACFIT_BUILD_TYPE,
              __VERSION__);
  const Case cases[] = {{"s^0.5 over 4 decades", 0.5, {1e-2, 1e2}},
                        {"s^0.1 over 6 decades", 0.1, {1e-3, 1e3}},
                        {"s^0.5 over 6 decades", 0.5, {1e-3, 1e3}},
                        {"s^0.9 over 8 decades", 0.9, {1e-4, 1e4}}};
  bool all_true = true;
  for (const Case& power : cases) {
    for (const frac::ApproximationMethod method : frac::approximation_methods()) {
      for (const int poles : {1, 2, 3, 4, 5, 8, 12, 13, 15, 26, 30, 40, 60}) {
        try {
          all_true = run(power, method, frac::PoleCount{poles}, "") && all_true;
        } catch (const std::invalid_argument&) {
          continue;  // a number of poles that this method does not have
        }
      }
    }
    for (const double tolerance : {1e-1, 1e-3, 1e-6, 1e-9, 1e-12}) {
      char asked[32];
      std::snprintf(asked, sizeof asked, "tolerance %.0e: ", tolerance);
      all_true = run(power, frac::ApproximationMethod::ladder, frac::Tolerance{tolerance}, asked) && all_true;
    }
  }
  return all_true ? 0 : 1;
}
