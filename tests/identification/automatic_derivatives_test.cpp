// SPDX-License-Identifier: BSD-3-Clause
// Derivatives of the library against Ceres' dual numbers and against complex steps, both through models written out
// here as pairs of reals.  A complex step of 1e-30 has no truncation error in double.
#include <ceres/jet.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <functional>
#include <numbers>
#include <string>
#include <type_traits>
#include <vector>

#include "frac/structure.hpp"
#include "realisation/ladder_table.hpp"

namespace {

constexpr int most_parameters = 7;
using Jet = ceres::Jet<double, most_parameters>;
using Step = std::complex<double>;

template <typename T>
struct Pair {
  T re, im;

  friend Pair operator+(const Pair& a, const Pair& b) { return {a.re + b.re, a.im + b.im}; }
  friend Pair operator*(const Pair& a, const Pair& b) { return {a.re * b.re - a.im * b.im, a.re * b.im + a.im * b.re}; }
  friend Pair operator/(const Pair& a, const Pair& b) {
    const T square = b.re * b.re + b.im * b.im;
    return {(a.re * b.re + a.im * b.im) / square, (a.im * b.re - a.re * b.im) / square};
  }
};

template <typename T>
Pair<T> without_imaginary(const T& value) {
  return {value, T(0.0)};
}

/// size^order e^{j order angle}
template <typename T>
Pair<T> polar_power(double log_size, double angle, const T& order) {
  using std::cos, std::exp, std::sin;
  const T size = exp(order * T(log_size));
  return {size * cos(order * T(angle)), size * sin(order * T(angle))};
}

/// base^order for a base in the right half plane.
template <typename T>
Pair<T> power(const Pair<T>& base, const T& order) {
  using std::atan, std::cos, std::exp, std::log, std::sin;
  const T log_size = T(0.5) * log(base.re * base.re + base.im * base.im), angle = atan(base.im / base.re);
  const T size = exp(order * log_size);
  return {size * cos(order * angle), size * sin(order * angle)};
}

/// s^order.
template <typename T>
using Power = std::function<Pair<T>(double, const T&)>;

template <typename T>
Pair<T> exact_power(double omega, const T& order) {
  return polar_power(std::log(omega), std::numbers::pi / 2, order);
}

constexpr double sample_time = 0.02;
/// ((1 - e^{-j omega h})/h)^order = (2 sin(omega h/2)/h)^order e^{j order (pi - omega h)/2}.
template <typename T>
Pair<T> difference_power(double omega, const T& order) {
  const double x = omega * sample_time;
  return polar_power(std::log(2 * std::sin(x / 2) / sample_time), (std::numbers::pi - x) / 2, order);
}

constexpr std::size_t memory = 100;
/// h^-order sum over k <= memory of w_k e^{-j k omega h}, w_k = w_{k-1} (1 - (order + 1)/k).
template <typename T>
Pair<T> finite_difference_power(double omega, const T& order) {
  using std::exp;
  const double x = omega * sample_time;
  const T unit = exp(order * T(-std::log(sample_time)));
  T weight(1.0);
  Pair<T> sum = without_imaginary(T(1.0));
  for (std::size_t k = 1; k <= memory; ++k) {
    const auto number = static_cast<double>(k);
    weight = weight * (T(1.0) - (order + T(1.0)) / T(number));
    sum = sum + Pair<T>{weight * T(std::cos(number * x)), weight * T(-std::sin(number * x))};
  }
  return without_imaginary(unit) * sum;
}

const frac::LadderRealisation& minimax_ladder() {
  static const frac::LadderRealisation ladder({1e-3, 1e3}, 9);
  return ladder;
}

double value_of(const Jet& number) {
  return number.a;
}
double value_of(const Step& number) {
  return number.real();
}

/// p + slope (order - value of order): what automatic differentiation needs to know of a tabulated function.
template <typename T>
T tangent(double p, double slope, const T& order) {
  return T(p) + T(slope) * (order - T(value_of(order)));
}

/// centre^order prod p_i (s + 1/p_i)/(s + p_i) at s = j omega/centre, for orders within (0, 1).  The poles and their
/// slopes come from the table; that these belong together is the subject of ladder_realisation_test.
template <typename T>
Pair<T> minimax_power(double omega, const T& order) {
  using std::exp;
  const frac::FrequencyBand band = minimax_ladder().band();
  const double log_centre = (std::log(band.lower) + std::log(band.upper)) / 2;
  const double scaled = omega / std::exp(log_centre);
  std::vector<double> log_poles, slopes;
  minimax_ladder().table().evaluate(value_of(order), log_poles, slopes);
  Pair<T> result = without_imaginary(T(exp(order * T(log_centre))));
  for (std::size_t i = 0; i < log_poles.size(); ++i) {
    const T log_pole = tangent(log_poles[i], slopes[i], order);
    const T pole = exp(log_pole), zero = exp(T(0.0) - log_pole);
    result = result * without_imaginary(pole) * Pair<T>{zero, T(scaled)} / Pair<T>{pole, T(scaled)};
  }
  return result;
}

constexpr frac::OustaloupRealisation ladder{{1e-2, 1e3}, 6};
/// upper^order prod (s + z_i)/(s + p_i), ln z_i = ln lower + (i + 1/2 - order/2) rung, p_i with + order/2, for orders
/// within (-1, 1) (Oustaloup et al. 2000).
template <typename T>
Pair<T> oustaloup_power(double omega, const T& order) {
  using std::exp;
  const double lower = std::log(ladder.band.lower), upper = std::log(ladder.band.upper);
  const double rung = (upper - lower) / ladder.poles;
  Pair<T> result = without_imaginary(T(exp(order * T(upper))));
  for (int i = 0; i < ladder.poles; ++i) {
    const T zero = exp(T(lower + (i + 0.5) * rung) - order * T(rung / 2));
    const T pole = exp(T(lower + (i + 0.5) * rung) + order * T(rung / 2));
    result = result * Pair<T>{zero, T(omega)} / Pair<T>{pole, T(omega)};
  }
  return result;
}

struct Furnace {
  static constexpr const char* formula = "1/(b2 s^a2 + b1 s^a1 + b0)";
  static std::vector<double> parameters() { return {0.8, 0.95, 0.5, 0.4, 1}; }
  template <typename T>
  static Pair<T> value(const std::vector<T>& p, double omega, const Power<T>& s) {
    return without_imaginary(T(1.0)) / (without_imaginary(p[0]) * s(omega, p[1]) +
                                        without_imaginary(p[2]) * s(omega, p[3]) + without_imaginary(p[4]));
  }
};

struct DelayedLag {
  static constexpr const char* formula = "K exp(-L s)/(T s^a + 1)";
  static std::vector<double> parameters() { return {2, 0.3, 0.6, 0.7}; }
  template <typename T>
  static Pair<T> value(const std::vector<T>& p, double omega, const Power<T>& s) {
    using std::cos, std::sin;
    const Pair<T> delay{cos(p[1] * T(omega)), T(0.0) - sin(p[1] * T(omega))};
    return without_imaginary(p[0]) * delay / (without_imaginary(p[2]) * s(omega, p[3]) + without_imaginary(T(1.0)));
  }
};

struct TwoArcs {
  static constexpr const char* formula = "R0 + R1/(1 + R1 Q1 s^n1) + R2/(1 + R2 Q2 s^n2)";
  static std::vector<double> parameters() { return {0.1, 0.5, 3, 0.8, 0.7, 40, 0.9}; }
  template <typename T>
  static Pair<T> value(const std::vector<T>& p, double omega, const Power<T>& s) {
    const auto arc = [&](const T& r, const T& q, const T& n) {
      return without_imaginary(r) / (without_imaginary(T(1.0)) + without_imaginary(T(r * q)) * s(omega, n));
    };
    return without_imaginary(p[0]) + arc(p[1], p[2], p[3]) + arc(p[4], p[5], p[6]);
  }
};

/// Exact powers only: its outer power is not one of s.
struct HavriliakNegami {
  static constexpr const char* formula = "K/(1 + (T s)^a)^b";
  static std::vector<double> parameters() { return {3, 0.5, 0.8, 0.45}; }
  template <typename T>
  static Pair<T> value(const std::vector<T>& p, double omega, const Power<T>& s) {
    using std::exp, std::log;
    const Pair<T> base = without_imaginary(T(1.0)) + without_imaginary(T(exp(p[2] * log(p[1])))) * s(omega, p[2]);
    return without_imaginary(p[0]) / power(base, p[3]);
  }
};

template <typename Model>
class AutomaticDerivatives : public testing::Test {};
using Models = testing::Types<Furnace, DelayedLag, TwoArcs, HavriliakNegami>;
TYPED_TEST_SUITE(AutomaticDerivatives, Models);

// Every operation rounds to 1e-16, and none of these models takes more than a hundred.  A derivative by ln p is the sum
// of terms as large as the value, which may cancel: it is right relative to the value.
constexpr double tolerance = 1e-13;

/// @param cancellation  how much larger the terms of a reference are than their sum
template <typename Model>
void compare(const frac::Realisation& realisation, const Power<Jet>& jet_power, const Power<Step>& step_power,
             double cancellation = 1) {
  const frac::Structure structure(Model::formula);
  const std::vector<double> p = Model::parameters();
  for (const double omega : {0.05, 0.7, 3.0, 40.0}) {
    std::vector<Step> gradient(p.size());
    const Step value = structure.response_and_gradient(p, omega, realisation, gradient);
    std::vector<Jet> jets;
    for (std::size_t i = 0; i < p.size(); ++i) jets.emplace_back(p[i], static_cast<int>(i));
    const Pair<Jet> expected = Model::value(jets, omega, jet_power);
    EXPECT_NEAR(std::abs(value - Step(expected.re.a, expected.im.a)), 0, tolerance * cancellation * std::abs(value));
    for (std::size_t i = 0; i < p.size(); ++i) {
      const auto k = static_cast<Eigen::Index>(i);
      const Step by_jet(expected.re.v[k], expected.im.v[k]);
      std::vector<Step> stepped(p.begin(), p.end());
      constexpr double step = 1e-30;
      stepped[i] += Step(0, step);
      const Pair<Step> moved = Model::value(stepped, omega, step_power);
      const Step by_step(moved.re.imag() / step, moved.im.imag() / step);
      const std::string place = structure.parameter_names()[i] + " at " + std::to_string(omega) + " rad/s through " +
                                frac::to_string(realisation);
      const double limit = tolerance * cancellation * std::max(std::abs(by_jet), std::abs(value / p[i]));
      EXPECT_NEAR(std::abs(gradient[i] - by_jet), 0, limit) << place;
      EXPECT_NEAR(std::abs(gradient[i] - by_step), 0, limit) << place;
    }
  }
}

TYPED_TEST(AutomaticDerivatives, AgreeWithThoseOfTheLibrary) {
  compare<TypeParam>(frac::ExactRealisation{}, exact_power<Jet>, exact_power<Step>);
  if constexpr (!std::is_same_v<TypeParam, HavriliakNegami>) {
    compare<TypeParam>(ladder, oustaloup_power<Jet>, oustaloup_power<Step>);
    compare<TypeParam>(frac::GrunwaldLetnikovRealisation{sample_time, 0}, difference_power<Jet>,
                       difference_power<Step>);
    compare<TypeParam>(minimax_ladder(), minimax_power<Jet>, minimax_power<Step>);
    // The weights of the sum as it stands add up to 2 in magnitude and to (omega h)^0.95 = 1.4e-3 at least.
    compare<TypeParam>(frac::GrunwaldLetnikovRealisation{sample_time, memory}, finite_difference_power<Jet>,
                       finite_difference_power<Step>, 2 / 1.4e-3);
  }
}

}  // namespace
