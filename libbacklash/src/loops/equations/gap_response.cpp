// SPDX-License-Identifier: BSD-3-Clause
#include "gap_response.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <utility>

#include "formula/power_sum.hpp"
#include "formula/whole_orders.hpp"
#include "special/reciprocal_gamma.hpp"

namespace backlash::detail {
namespace {

using Complex = std::complex<double>;

// Taylor coefficients e_i of 1/(1 + e^t).
constexpr std::size_t boole_order = 18;
std::array<double, boole_order> boole_coefficients() {
  std::array<double, boole_order> e{};
  std::array<double, boole_order> inverse_factorial{};
  inverse_factorial[0] = 1;
  e[0] = 0.5;
  for (std::size_t i = 1; i < boole_order; ++i) {
    inverse_factorial[i] = inverse_factorial[i - 1] / static_cast<double>(i);
    double inner = 0;
    for (std::size_t m = 0; m < i; ++m) inner += e[m] * inverse_factorial[i - m];
    e[i] = -0.5 * inner;
  }
  return e;
}

// The remainder of sum (-1)^n (n + v)^power from n = 0 on where v is large: Boole's expansion.
template <typename Real>
Real boole_rest(double power, Real v, Real v_to_the_power) {
  static const std::array<double, boole_order> e = boole_coefficients();
  Real derivative = v_to_the_power;
  Real sum = static_cast<Real>(e[0]) * derivative;
  for (std::size_t i = 1; i < boole_order; ++i) {
    derivative *= (static_cast<Real>(power) + 1 - static_cast<Real>(i)) / v;
    if (i % 2 == 1) sum += static_cast<Real>(e[i]) * derivative;
  }
  return sum;
}

constexpr int direct_terms = 20;  // an even number; the rest then errs by about 18!/(20 pi)^18

// The first `direct_terms` instants from `v` on, to a falling sequence of powers.  Long double bears that their squares
// and cubes are much larger than what they leave.
template <typename Real>
class AlternatingSums {
 public:
  AlternatingSums(double power, Real v) : power_(power), v_(v) {
    for (int n = 0; n <= direct_terms; ++n) {
      value_[static_cast<std::size_t>(n)] = std::pow(static_cast<Real>(n) + v, static_cast<Real>(power));
    }
  }
  [[nodiscard]] double sum() const {
    Real sum = 0;
    for (std::size_t n = direct_terms; n-- > 0;) sum += n % 2 == 0 ? value_[n] : -value_[n];
    return static_cast<double>(sum + boole_rest(power_, direct_terms + v_, value_[direct_terms]));
  }
  void lower_power() {
    if (inverse_[0] == 0) {
      for (int n = 0; n <= direct_terms; ++n) inverse_[static_cast<std::size_t>(n)] = 1 / (static_cast<Real>(n) + v_);
    }
    for (std::size_t n = 0; n < value_.size(); ++n) value_[n] *= inverse_[n];
    power_ -= 1;
  }

 private:
  double power_;
  Real v_;
  std::array<Real, direct_terms + 1> value_;
  std::array<Real, direct_terms + 1> inverse_{};  // of the instants
};

// Coefficients of the older pulses; the series of a whole power ends with that power.
std::vector<double> older_pulses(double power) {
  const bool is_whole = power == std::round(power);
  std::vector<double> coefficient(is_whole ? static_cast<std::size_t>(power) + 1 : 36);
  AlternatingSums<double> sums(power, 1.5);
  double binomial = 1;
  for (std::size_t i = 0; i < coefficient.size(); ++i) {
    coefficient[i] = -binomial * sums.sum();
    binomial *= (power - static_cast<double>(i)) / static_cast<double>(i + 1);
    sums.lower_power();
  }
  return coefficient;
}

// First impulse, counted from that at the impact, whose answer has begun before t = 0, and its age.
struct FirstPulse {
  int index;
  double age;  // over tau, in (0, 1]
};
FirstPulse first_pulse(double delay, double tau) {
  const double periods = std::floor(delay / tau);
  return {static_cast<int>(periods) + 1, 1 - (delay / tau - periods)};
}

using Terms = std::vector<frac::PowerTerm>;

// G = N/D less its own free mass, 1/(M s^2): excess/(s^2 M D), so that the jump of velocity at an impact is apart from
// what follows it.
struct Body {
  Body(Terms of_numerator, const Terms& denominator, double mass)
      : numerator(std::move(of_numerator)), scaled_denominator(frac::detail::scaled(denominator, mass, 0)) {
    excess = frac::detail::merged(frac::detail::scaled(numerator, mass, 2), frac::detail::scaled(denominator, -1, 0));
    // The leading terms cancel but for rounding.
    std::erase_if(excess, [&](const frac::PowerTerm& term) { return term.order > denominator.front().order - 1e-9; });
  }
  Body(const frac::FractionalTransferFunction& receptance, double mass)
      : Body(receptance.numerator(), receptance.denominator(), mass) {}

  Terms numerator;
  Terms scaled_denominator;  // M D
  Terms excess;
};

ImpulseAnswer free_response(const TwoMassSystem& system) {
  const double jump = 1 / system.mass1() + 1 / system.mass2();
  return {{{jump, 1, 0}}, {}, jump};
}

void add_image(ImpulseAnswer& response, Terms numerator, const std::vector<Terms>& denominators, double delay) {
  if (numerator.empty()) return;
  // Single terms make one factor, which comes first.
  frac::detail::PowerProduct denominator;
  Terms power{{1, 0}};
  for (const Terms& each : denominators) {
    if (each.size() == 1) {
      power = frac::detail::product(power, each);
    } else {
      frac::detail::multiply(denominator.factors, {each, 1});
    }
  }
  denominator.factors.insert(denominator.factors.begin(), {power, 1});
  denominator.terms = frac::detail::expanded(denominator.factors);
  response.images.emplace_back(frac::detail::PowerProduct{{}, std::move(numerator)}, std::move(denominator), delay);
}

template <typename Real>
double rate_of_powers(const ImpulseAnswer& response, double half_period) {
  double rate = 0;
  for (const PowerPart& part : response.parts) {
    const FirstPulse first = first_pulse(part.delay, half_period);
    const double sum = part.coefficient * part.exponent * std::pow(half_period, part.exponent - 1) *
                       AlternatingSums<Real>(part.exponent - 1, static_cast<Real>(first.age)).sum();
    rate += first.index % 2 == 0 ? sum : -sum;
  }
  return rate;
}

}  // namespace

ImpulseAnswer gap_response(const LinearBodies& bodies) {
  ImpulseAnswer response = free_response(bodies.system());
  if (bodies.are_free()) return response;
  const Body load(bodies.load(), bodies.system().mass1());
  const Body drive(bodies.drive(), bodies.system().mass2());
  Terms numerator = frac::detail::merged(frac::detail::product(load.excess, drive.scaled_denominator),
                                         frac::detail::product(drive.excess, load.scaled_denominator));
  add_image(response, std::move(numerator), {{{1, 2}}, load.scaled_denominator, drive.scaled_denominator}, 0);
  return response;
}

ImpulseAnswer gap_response(const ControlLoop& loop) {
  const LinearBodies& bodies = loop.bodies();
  const frac::FractionalTransferFunction& controller = loop.controller();
  const double mass1 = loop.system().mass1();
  const double mass2 = loop.system().mass2();
  const bool is_driven = loop.measured() == Output::x2;
  if (is_driven && controller.delay() > 0) {
    throw std::invalid_argument(
        "exact cycles with the driven body measured (x2) and a dead time are not computed; measure the load (x1) or "
        "leave the dead time out");
  }
  if (bodies.are_free() && !is_driven) {
    // G1 + G2 and C G1 G2; 1/s^p is t^(p - 1)/Gamma(p).
    ImpulseAnswer response = free_response(bodies.system());
    if (controller.denominator().size() != 1) {
      add_image(response, controller.numerator(), {controller.denominator(), {{mass1 * mass2, 4}}}, controller.delay());
      return response;
    }
    for (const frac::PowerTerm& term : controller.numerator()) {
      const double p = 4 - (term.order - controller.denominator().front().order);
      response.parts.push_back(
          {term.coefficient / (mass1 * mass2) * frac::detail::reciprocal_gamma(p), p - 1, controller.delay()});
    }
    return response;
  }
  using frac::detail::merged;
  using frac::detail::product;
  const Body load(bodies.load(), mass1);
  if (is_driven) {
    // G1, and G2/(1 + C G2) as one body.
    const Body drive(product(bodies.drive().numerator(), controller.denominator()),
                     merged(product(bodies.drive().denominator(), controller.denominator()),
                            product(bodies.drive().numerator(), controller.numerator())),
                     mass2);
    ImpulseAnswer response = free_response(bodies.system());
    add_image(response,
              merged(product(load.excess, drive.scaled_denominator), product(drive.excess, load.scaled_denominator)),
              {{{1, 2}}, load.scaled_denominator, drive.scaled_denominator}, 0);
    return response;
  }
  const Body drive(bodies.drive(), mass2);
  // C G1 G2 over the masses times denominators of all three.
  Terms chain = product(product(load.numerator, drive.numerator), controller.numerator());
  chain = frac::detail::scaled(std::move(chain), mass1 * mass2, 0);
  if (controller.delay() > 0) {
    ImpulseAnswer response = gap_response(bodies);
    add_image(response, std::move(chain), {controller.denominator(), load.scaled_denominator, drive.scaled_denominator},
              controller.delay());
    return response;
  }
  ImpulseAnswer response = free_response(bodies.system());
  const Terms apart =
      merged(product(load.excess, drive.scaled_denominator), product(drive.excess, load.scaled_denominator));
  add_image(response, merged(product(apart, controller.denominator()), frac::detail::scaled(std::move(chain), 1, 2)),
            {{{1, 2}}, controller.denominator(), load.scaled_denominator, drive.scaled_denominator}, 0);
  return response;
}

ImpulseTrain::ImpulseTrain(const ImpulseAnswer& response, double half_period) : tau_(half_period) {
  parts_.reserve(response.parts.size());
  has_whole_powers_ = std::all_of(response.parts.begin(), response.parts.end(),
                                  [](const PowerPart& part) { return part.exponent == std::round(part.exponent); });
  for (const PowerPart& part : response.parts) {
    const FirstPulse first = first_pulse(part.delay, tau_);
    parts_.push_back({part.coefficient * std::pow(tau_, part.exponent), part.exponent, first.index, first.age,
                      PowerTrain(part.exponent, first.age), older_pulses(part.exponent)});
  }
  if (response.images.empty()) return;
  // Before a thousandth of the half period has gone by, nothing but the masses has answered to the impact.
  constexpr double earliest = 1e-3;
  images_.reserve(response.images.size());
  for (const ImagePart& part : response.images) {
    images_.emplace_back(part, tau_, earliest);
    has_whole_powers_ = has_whole_powers_ && frac::detail::has_whole_orders(part.image->numerator().terms) &&
                        frac::detail::has_whole_orders(part.image->denominator().terms);
  }
  // The last one has the poles of the others.
  for (const frac::detail::RootCluster& pole : response.images.back().image->poles().clusters) {
    if (pole.log_s.imag() > std::numbers::pi) continue;
    const int count = pole.multiplicity * (pole.is_conjugate ? 1 : 2);
    growth_rates_.insert(growth_rates_.end(), static_cast<std::size_t>(count), std::exp(pole.log_s).real() * tau_);
  }
}

std::array<Complex, 3> ImpulseTrain::sums(const TrainPoint& point) const {
  std::array<Complex, 3> total{};
  for (const Part& part : parts_) {
    const std::array<Complex, 3> train = part.train(point);
    const Complex begin = part.first == 1 ? point.turned : std::exp(point.u * static_cast<double>(part.first));
    const Complex scale = part.coefficient * begin;
    const double by_time = part.exponent / tau_;
    total[0] += scale * train[0];
    total[1] += scale * by_time * train[1];
    total[2] += scale * (by_time * (part.exponent - 1) / tau_) * train[2];
  }
  for (const ImageTrain& image : images_) {
    const std::array<Complex, 3> others = image.sums(-point.u / tau_);
    for (std::size_t j = 0; j < 3; ++j) total[j] += others[j];
  }
  return total;
}

std::array<double, 3> ImpulseTrain::sums_of_one_sign() const {
  std::array<double, 3> total{};
  for (const Part& part : parts_) {
    const std::array<double, 3> train = part.train.at_origin();
    const double by_time = part.exponent / tau_;
    total[0] += part.coefficient * train[0];
    total[1] += part.coefficient * by_time * train[1];
    // A ramp has no second derivative, but its mean parabola has.
    total[2] +=
        part.coefficient / (tau_ * tau_) * (part.exponent == 1 ? -1 : part.exponent * (part.exponent - 1) * train[2]);
  }
  for (const ImageTrain& image : images_) {
    const std::array<double, 3> others = image.sums_of_one_sign();
    for (std::size_t j = 0; j < 3; ++j) total[j] += others[j];
  }
  return total;
}

std::array<double, 3> ImpulseTrain::repeated(double t) const {
  std::array<double, 3> total{};
  for (const Part& part : parts_) {
    double age = part.offset + t / tau_;
    if (age > 1) age -= 1;
    const std::array<double, 3> sums = power_sums_of_one_sign(part.exponent, age);
    const double by_time = part.exponent / tau_;
    total[0] += part.coefficient * sums[0];
    total[1] += part.coefficient * by_time * sums[1];
    // As in sums_of_one_sign().
    total[2] +=
        part.coefficient / (tau_ * tau_) * (part.exponent == 1 ? -1 : part.exponent * (part.exponent - 1) * sums[2]);
  }
  for (const ImageTrain& image : images_) {
    const std::array<double, 3> others = image.repeated(t);
    for (std::size_t j = 0; j < 3; ++j) total[j] += others[j];
  }
  return total;
}

TrainSplit ImpulseTrain::split(Complex s) const {
  TrainSplit total{};
  const Complex u = -s * tau_;
  for (const Part& part : parts_) {
    const PowerTrain::Split train = part.train.split(u);
    const Complex scale = part.coefficient * std::exp(u * static_cast<double>(part.first));
    const double by_time = part.exponent / tau_;
    total.regular[0] += scale * train.regular[0];
    total.regular[1] += scale * by_time * train.regular[1];
    // A ramp has no second derivative, but its mean has.
    total.regular[2] += part.exponent == 1 ? -scale * train.mean * s * s
                                           : scale * (by_time * (part.exponent - 1) / tau_) * train.regular[2];
    total.mean += scale * train.mean;
  }
  for (const ImageTrain& image : images_) {
    const TrainSplit other = image.split(s);
    for (std::size_t j = 0; j < 3; ++j) total.regular[j] += other.regular[j];
    total.mean += other.mean;
  }
  return total;
}

TrainWave ImpulseTrain::wave(double t) const {
  TrainWave wave{0, 0};
  for (const Part& part : parts_) {
    // Age over tau, now, of the latest impulse whose answer has begun.
    double age = part.offset + t / tau_;
    int latest = part.first;
    if (age > 1) {
      age -= 1;
      latest -= 1;
    }
    // Even and odd powers apart, neither of which waits for the other.
    const double x = age - 0.5, square = x * x;
    double even = 0, even_slope = 0, odd = 0, odd_slope = 0;  // slopes by the square
    std::size_t i = part.older.size();
    if (i % 2 == 1) even = part.older[--i];
    while (i > 0) {
      odd_slope = odd_slope * square + odd;
      odd = odd * square + part.older[--i];
      even_slope = even_slope * square + even;
      even = even * square + part.older[--i];
    }
    const double value = even + x * odd;
    const double slope = odd + 2 * x * (even_slope + x * odd_slope);
    const bool is_whole = part.older.size() <= 4;
    double young = is_whole ? 1 : std::pow(age, part.exponent);
    for (std::size_t k = 1; is_whole && k < part.older.size(); ++k) young *= age;
    const double sign = latest % 2 == 0 ? part.coefficient : -part.coefficient;
    wave.value += sign * (value + young);
    wave.slope += sign / tau_ * (slope + (age > 0 ? part.exponent * young / age : 0));
  }
  for (const ImageTrain& image : images_) {
    const TrainWave other = image.wave(t);
    wave.value += other.value;
    wave.slope += other.slope;
  }
  return wave;
}

double rate_before_impact(const ImpulseAnswer& response, double half_period) {
  double rate = rate_of_powers<long double>(response, half_period);
  for (const ImagePart& part : response.images) rate += ImageTrain::rate(part, half_period);
  return rate;
}

double rough_rate_before_impact(const ImpulseAnswer& response, double half_period) {
  double rate = rate_of_powers<double>(response, half_period);
  for (const ImagePart& part : response.images) {
    const std::optional<double> rough = ImageTrain::rough_rate(part, half_period);
    if (!rough) return rate_before_impact(response, half_period);
    rate += *rough;
  }
  return rate;
}

}  // namespace backlash::detail
