// SPDX-License-Identifier: BSD-3-Clause
#include "frac/time_response/loop_response.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <numbers>
#include <optional>
#include <stdexcept>
#include <string>
#include <unsupported/Eigen/FFT>
#include <utility>
#include <variant>

#include "base/bound_text.hpp"
#include "base/counted.hpp"
#include "base/number_text.hpp"
#include "base/short_text.hpp"
#include "frac/cancellation.hpp"
#include "frac/model/algebra.hpp"
#include "poles/laplace_image.hpp"
#include "poles/winding_number.hpp"

namespace frac {
namespace {

using Complex = std::complex<double>;
using Kind = ResponseInput::Kind;
constexpr double pi = std::numbers::pi;
constexpr double eps = std::numeric_limits<double>::epsilon();
constexpr double infinity = std::numeric_limits<double>::infinity();

double largest_of(const std::vector<double>& values) {
  double size = 0;
  for (const double value : values) {
    if (std::isfinite(value)) size = std::max(size, std::abs(value));
  }
  return size;
}

// The Laplace transform of the input, whose time counts from its first sample.
class InputImage {
 public:
  explicit InputImage(const TimeInput& input) {
    if (const auto* named = std::get_if<ResponseInput>(&input)) {
      named_ = *named;
      return;
    }
    const auto& sampled = std::get<SampledInput>(input);
    start_ = sampled.time.front();
    const bool straight = sampled.hold == Hold::first_order;
    double before = 0, slope = 0;
    for (std::size_t n = 0; n < sampled.time.size(); ++n) {
      const double jump = n == 0 || !straight ? sampled.value[n] - before : 0;
      const double next = straight && n + 1 < sampled.time.size()
                              ? (sampled.value[n + 1] - sampled.value[n]) / (sampled.time[n + 1] - sampled.time[n])
                              : 0;
      if (jump != 0 || next != slope) knots_.push_back({sampled.time[n] - start_, jump, next - slope});
      jumps_ += std::abs(jump);
      slopes_ += std::abs(next - slope);
      before = sampled.value[n];
      slope = next;
    }
  }

  [[nodiscard]] double start() const { return start_; }
  // It falls as s^-order.
  [[nodiscard]] double order() const {
    if (!named_) return jumps_ > 0 ? 1 : 2;
    return named_->kind == Kind::impulse ? 0 : named_->kind == Kind::step ? 1 : 2;
  }

  [[nodiscard]] Complex operator()(Complex s) const {
    if (named_) {
      switch (named_->kind) {
        case Kind::impulse:
          return 1;
        case Kind::step:
          return 1.0 / s;
        case Kind::ramp:
          return 1.0 / (s * s);
        case Kind::sine:
          return named_->omega / ((s - Complex(0, named_->omega)) * (s + Complex(0, named_->omega)));
      }
    }
    const Complex inverse = 1.0 / s;
    Complex sum = 0;
    for (const Knot& knot : knots_) sum += (knot.jump + knot.slope * inverse) * std::exp(-s * knot.time);
    return sum * inverse;
  }

  // At least |U(s)| for Re s >= 0.
  [[nodiscard]] double bound(Complex s) const {
    if (named_) return std::abs((*this)(s));
    const double size = std::abs(s);
    return (jumps_ + slopes_ / size) / size;
  }

 private:
  struct Knot {
    double time, jump, slope;
  };
  std::optional<ResponseInput> named_;
  std::vector<Knot> knots_;
  double start_ = 0;
  double jumps_ = 0, slopes_ = 0;  // sums of their moduli
};

FractionalTransferFunction without_delay(const FractionalTransferFunction& model) {
  if (model.denominator_factors().empty()) return {model.numerator(), model.denominator()};
  return FractionalTransferFunction::from_factors(model.numerator_factors(), model.denominator_factors());
}

std::vector<PowerFactor> to_power(std::vector<PowerFactor> factors, int power) {
  for (PowerFactor& factor : factors) factor.power *= power;
  return factors;
}

std::vector<PowerFactor> factors_of(const std::vector<PowerFactor>& factors, const std::vector<PowerTerm>& terms) {
  if (!factors.empty()) return factors;
  return {{terms, 1}};
}

// Sums over the nodes of a vertical line for the instants t.
class LineSum {
 public:
  LineSum(std::vector<Complex> values, double step) : values_(std::move(values)), step_(step) {}

  // Re sum values_k e^{j k step t}, by Horner's rule for several instants at once.
  [[nodiscard]] std::vector<double> at(std::span<const double> t) const {
    std::vector<double> sums(t.size());
    constexpr std::size_t width = 8;
    for (std::size_t first = 0; first < t.size(); first += width) {
      throw_if_cancelled();
      double re[width] = {}, im[width] = {}, turn_re[width] = {}, turn_im[width] = {};
      const std::size_t count = std::min(width, t.size() - first);
      for (std::size_t i = 0; i < count; ++i) {
        turn_re[i] = std::cos(step_ * t[first + i]);
        turn_im[i] = std::sin(step_ * t[first + i]);
      }
      for (auto value = values_.rbegin(); value != values_.rend(); ++value) {
        for (std::size_t i = 0; i < width; ++i) {
          const double real = re[i] * turn_re[i] - im[i] * turn_im[i] + value->real();
          im[i] = re[i] * turn_im[i] + im[i] * turn_re[i] + value->imag();
          re[i] = real;
        }
      }
      std::copy(re, re + count, sums.begin() + static_cast<std::ptrdiff_t>(first));
    }
    return sums;
  }

  // At from, from + T/length, from + 2 T/length, .., T = 2 pi/step: the nodes k, k + length, .. turn together, so that
  // one transform of their sums gives all.
  [[nodiscard]] std::vector<double> at_parts_of_period(double from, std::size_t length, std::size_t count) const {
    std::vector<Complex> folded(length, 0.0), sums;
    for (std::size_t k = 0; k < values_.size(); ++k)
      folded[k % length] += values_[k] * std::polar(1.0, static_cast<double>(k) * step_ * from);
    Eigen::FFT<double> transform;
    transform.SetFlag(Eigen::FFT<double>::Unscaled);
    transform.inv(sums, folded);
    std::vector<double> result;
    for (std::size_t i = 0; i < count; ++i) result.push_back(sums[i].real());
    return result;
  }

 private:
  std::vector<Complex> values_;
  double step_;
};

// Instants from, from + step, ..; length steps make a period of the rule.
struct EvenInstants {
  double step = 0;
  std::size_t length = 0;
};
// Empty where they are few or not even but for rounding.
std::optional<EvenInstants> even_instants(std::span<const double> t, double period) {
  constexpr std::size_t few = 64;
  if (t.size() < few) return std::nullopt;
  const double step = (t.back() - t.front()) / static_cast<double>(t.size() - 1);
  const double rounding = 4 * eps * std::max(std::abs(t.front()), std::abs(t.back()));
  for (std::size_t i = 0; i < t.size(); ++i) {
    if (std::abs(t[i] - t.front() - static_cast<double>(i) * step) > rounding) return std::nullopt;
  }
  // The transform is fast for products of small primes.
  auto length = static_cast<std::size_t>(std::ceil(period / step));
  const auto is_smooth = [](std::size_t number) {
    for (const std::size_t prime : {2, 3, 5})
      while (number % prime == 0) number /= prime;
    return number == 1;
  };
  while (!is_smooth(length)) ++length;
  return EvenInstants{step, length};
}

// |L| tends to a gain at high frequency.
bool keeps_gain(const FractionalTransferFunction& loop) {
  return std::abs(detail::order_at_infinity(loop)) <= 1e-13 * std::max(1.0, loop.denominator().front().order);
}

// forward/(1 + L e^{-delay s}) with the input, over times from 0 to `latest` after the dead time of forward.
class ClosedLoop {
 public:
  ClosedLoop(const FractionalTransferFunction& forward, const FractionalTransferFunction& loop, const TimeInput& input,
             double latest, double period)
      : forward_(without_delay(forward)),
        loop_(without_delay(loop)),
        forward_image_(detail::numerator_of(forward_), detail::denominator_of(forward_)),
        loop_image_(detail::numerator_of(loop_), detail::denominator_of(loop_)),
        input_(input),
        before_(forward.delay()),
        delay_(loop.delay()),
        latest_(latest),
        period_(period),
        gain_at_infinity_(keeps_gain(loop)
                              ? std::abs(loop.numerator().front().coefficient / loop.denominator().front().coefficient)
                              : 0) {}

  [[nodiscard]] double latest() const { return latest_; }
  [[nodiscard]] double delay() const { return delay_; }
  // Of the rule along the line.
  [[nodiscard]] double period() const { return period_; }
  // Passages that reach the output.
  [[nodiscard]] std::size_t all_passages() const {
    return static_cast<std::size_t>(std::min(std::floor(latest_ / delay_), 1e9)) + 1;
  }

  [[nodiscard]] FractionalTransferFunction passage(std::size_t k) const {
    const auto power = static_cast<int>(k);
    std::vector<PowerFactor> top = factors_of(forward_.numerator_factors(), forward_.numerator());
    std::vector<PowerFactor> bottom = factors_of(forward_.denominator_factors(), forward_.denominator());
    if (k > 0) {
      // One list, in which equal factors meet.
      top.push_back({{{k % 2 == 1 ? -1.0 : 1.0, 0}}, 1});
      for (PowerFactor& factor : to_power(factors_of(loop_.numerator_factors(), loop_.numerator()), power))
        top.push_back(std::move(factor));
      for (PowerFactor& factor : to_power(factors_of(loop_.denominator_factors(), loop_.denominator()), power))
        bottom.push_back(std::move(factor));
    }
    return FractionalTransferFunction::from_factors(std::move(top), std::move(bottom),
                                                    before_ + static_cast<double>(k) * delay_);
  }

  // The image beyond the first n passages.
  struct Rest {
    Complex value;
    double rounding;  // its relative error, in units of eps: of the sum 1 + L and of the phases
  };
  [[nodiscard]] Rest rest(Complex s, std::size_t n) const {
    const Complex loop = loop_at(s);
    const Complex sum = 1.0 + loop;
    const double turns = std::abs(s.imag()) * delay_;
    return {forward_at(s) * std::pow(-loop, static_cast<double>(n)) / sum * input_(s),
            8 + turns * static_cast<double>(n) + (1 + std::abs(loop) * (8 + turns)) / std::abs(sum)};
  }

  // e^{-abscissa t} times the response, in the mean over times up to about 1/rate.
  [[nodiscard]] double size(double abscissa, double rate) const {
    return std::abs(rest(abscissa + rate, 0).value) * rate;
  }
  // About e^{-abscissa t} times what passage k has grown to at t, by the saddle point of e^{st} on the real axis: of
  // t^m/m! it is within sqrt(2 pi m).
  [[nodiscard]] double passage_size(double abscissa, double t, std::size_t k) const {
    double least = infinity;
    for (double turns = 1; turns < 100; turns *= 1.4) {
      const Complex s = abscissa + turns / t;
      const double value = std::abs(forward_at(s) * input_(s)) *
                           std::pow(std::abs(loop_at(s)), static_cast<double>(k)) * std::exp(turns) * turns / t;
      least = std::min(least, value);
    }
    return least;
  }

  // Right of the poles of forward, loop and input.
  [[nodiscard]] double rightmost_open_pole() const {
    double right = 0;
    for (const auto* image : {&forward_image_, &loop_image_}) {
      if (!image->poles().complete) throw std::domain_error("closed loop: the poles of the open loop were not counted");
      for (const detail::RootCluster& pole : image->poles().clusters) {
        if (pole.log_s.imag() < pi / 2 + pole.spread)
          right = std::max(right, std::exp(pole.log_s.real() + pole.spread) * std::cos(pole.log_s.imag()));
      }
    }
    return right;
  }

  // Whether no root of 1 + L lies right of the abscissa, where L has no pole.  In ln(s - abscissa) the half-plane is a
  // strip, and D + N e^{-s delay} is analytic in it.
  [[nodiscard]] bool is_right_of_roots(double abscissa) const {
    const auto characteristic = [&](Complex w) -> detail::ValueAndSlope {
      const Complex from_line = std::exp(w);
      const Complex s = abscissa + from_line;
      const Complex zeta = std::log(s);
      const detail::ScaledSum top = detail::scaled_sum(loop_image_.numerator(), zeta);
      const detail::ScaledSum bottom = detail::scaled_sum(loop_image_.denominator(), zeta);
      const Complex turn = delay_ * s;
      const double scale = std::max(top.scale, bottom.scale);
      const Complex late = std::exp(-turn + (top.scale - scale));
      const double own = std::exp(bottom.scale - scale);
      const Complex by_zeta = bottom.slope * own + (top.slope - turn * top.value) * late;
      return {bottom.value * own + top.value * late, by_zeta / s * from_line};
    };
    const double last = log_radius_of_roots(abscissa);
    if (std::exp(last) * delay_ > 1e6) {
      throw std::domain_error("closed loop: |L| may be 1 at " + detail::short_text(std::exp(last) * delay_) +
                              " rad of its dead time; its roots are counted up to 1e6 rad");
    }
    const double first = std::log(abscissa) - 5;
    const double half = pi / 2;
    const double turns =
        detail::winding_number(characteristic, {{first, -half}, {last, -half}, {last, half}, {first, half}});
    return std::abs(turns) < 0.01;
  }

  // (1/pi) int_omega^inf |rest after n passages| d omega along a line, for frequencies on a logarithmic grid that has
  // the resonances of the open loop among its points; infinite where |L| is not below 1 from there on.
  struct Tails {
    std::vector<double> omega, forward, loop;
    double order_forward, order_loop;  // |forward U| and |L| end as omega^-order

    [[nodiscard]] std::vector<double> after(std::size_t n) const {
      std::vector<double> tail(omega.size(), infinity);
      const auto at = [&](std::size_t i) {
        return loop[i] < 1 ? forward[i] * std::pow(loop[i], static_cast<double>(n)) / (1 - loop[i]) * omega[i] / pi
                           : infinity;
      };
      const double excess = order_forward + static_cast<double>(n) * order_loop - 1;
      std::size_t i = omega.size() - 1;
      if (!(excess > 1e-9)) return tail;
      tail[i] = at(i) / excess;
      for (; i-- > 0 && tail[i + 1] < infinity;)
        tail[i] = tail[i + 1] + std::max(at(i), at(i + 1)) * std::log(omega[i + 1] / omega[i]);
      return tail;
    }
  };
  [[nodiscard]] Tails tails(double abscissa, double highest) const {
    std::vector<double> log_omega;
    const double corner = std::max(forward_image_.highest_corner(), loop_image_.highest_corner());
    const double end = std::max(std::log(highest), std::min(corner, 690.0)) + 5;
    for (double u = std::log(0.1 / latest_); u < end; u += 0.1) log_omega.push_back(u);
    for (const auto* image : {&forward_image_, &loop_image_}) {
      for (const detail::RootCluster& pole : image->poles().clusters) {
        const double resonance = pole.log_s.real() + std::log(std::abs(std::sin(pole.log_s.imag())));
        if (resonance > log_omega.front() && resonance < end) log_omega.push_back(resonance);
      }
    }
    std::sort(log_omega.begin(), log_omega.end());
    Tails result{{}, {}, {}, input_.order() - detail::order_at_infinity(forward_), -detail::order_at_infinity(loop_)};
    for (const double u : log_omega) {
      const Complex s(abscissa, std::exp(u));
      result.omega.push_back(std::exp(u));
      result.forward.push_back(std::abs(forward_at(s)) * input_.bound(s));
      result.loop.push_back(std::abs(loop_at(s)));
    }
    return result;
  }

 private:
  // ln|s - abscissa| beyond which |L| < 1 on the line, on an arc and so, by the maximum principle, right of both.
  [[nodiscard]] double log_radius_of_roots(double abscissa) const {
    constexpr double step = 0.2;
    const double most = 0.5 * (1 + gain_at_infinity_);
    const auto is_small = [&](double u) {
      for (const double angle : {0.5, 0.4, 0.3, 0.2, 0.1, 0.0}) {
        if (!(std::abs(loop_at(abscissa + std::polar(std::exp(u), angle * pi))) < most)) return false;
      }
      return true;
    };
    const double least = std::max(std::log(1 / delay_), std::log(abscissa));
    double last = std::min(std::max(loop_image_.highest_corner(), least) + 1, 690.0);
    while (!is_small(last) && last < 700) last += step;
    while (last > least && is_small(last - step)) last -= step;
    // A resonance may lie between two steps.
    for (const detail::RootCluster& pole : loop_image_.poles().clusters) {
      if (pole.log_s.real() > last && !is_small(pole.log_s.real())) last = pole.log_s.real() + 1;
    }
    return last;
  }
  [[nodiscard]] Complex forward_at(Complex s) const { return forward_image_.value(std::log(s)); }
  [[nodiscard]] Complex loop_at(Complex s) const { return loop_image_.value(std::log(s), -delay_ * s); }

  FractionalTransferFunction forward_, loop_;
  detail::LaplaceImage forward_image_, loop_image_;
  InputImage input_;
  double before_, delay_, latest_, period_;
  double gain_at_infinity_;
};

// A line Re s = abscissa right of all roots by about a `gap`, and as near to them as that.
double line_right_of_roots(const ClosedLoop& loop, double gap) {
  const double open = loop.rightmost_open_pole();
  double low = open;
  double high = open + gap;
  for (int attempt = 0; !loop.is_right_of_roots(high); ++attempt) {
    if (attempt == 60) throw std::domain_error("closed loop: no vertical line right of all roots was found");
    low = high;
    high = open + 2 * (high - open);
  }
  while (low > open && high - low > gap) {
    const double middle = (low + high) / 2;
    (loop.is_right_of_roots(middle) ? high : low) = middle;
  }
  return high;
}

// What the sum along the line takes for a number of passages.
struct Plan {
  std::size_t passages = 0;
  std::size_t nodes = 0;
  double abscissa = 0, step = 0;
  double error = 0;  // of the part beyond the last node, and of what folds back
};

// Passages that are computed one by one where |L| keeps a gain and hands every jump on.
constexpr std::size_t most_of_all = 200;

Plan planned(const ClosedLoop& loop, double abscissa, double target) {
  // Of a passage, over its size.
  constexpr double usual_error = 1e-14;
  constexpr std::size_t welcome_nodes = 1 << 16, most_nodes = 1 << 20, most_passages = 24;
  const double latest = loop.latest();
  const double period = loop.period();
  const double step = 2 * pi / period;
  const double highest = step * static_cast<double>(most_nodes);
  const double grown = std::exp(abscissa * latest);
  const double enough = 0.4 * target;
  std::optional<Plan> best;
  double best_error = infinity;
  // What folds back is no larger than the passages and the whole at the end of the period.
  double folding = loop.size(abscissa, 1 / period);
  double by_passages = 0;
  for (std::size_t n = 0; n <= std::min(most_passages, loop.all_passages()); ++n) {
    if (n > 0) {
      folding += loop.passage_size(abscissa, period, n - 1);
      by_passages += usual_error * grown * loop.passage_size(abscissa, latest, n - 1);
    }
    Plan plan{n, 0, 0, 0, 0};
    if (n < loop.all_passages()) {
      // Responses that beat or rise like a power of t exceed their mean; a factor 10 covers that.
      const double folded = std::clamp(std::log(10 * folding * grown / (0.1 * target)), 8.0, 60.0);
      plan = {n, 0, abscissa + folded / period, step, 10 * folding * grown * std::exp(-folded)};
      const ClosedLoop::Tails tails = loop.tails(plan.abscissa, highest);
      const std::vector<double> tail = tails.after(n);
      const double factor = std::exp(plan.abscissa * latest);
      double beyond = infinity;
      for (std::size_t i = 0; i < tail.size() && tails.omega[i] < highest && !(beyond < 0.1 * target); ++i) {
        if (!(tail[i] < infinity)) continue;
        plan.nodes = static_cast<std::size_t>(std::ceil(tails.omega[i] / step)) + 1;
        beyond = factor * tail[i];
      }
      plan.error += beyond;
    }
    const double error = plan.error + by_passages;
    if (!(error < infinity)) continue;
    const bool is_better =
        error < enough && best_error < enough ? 2 * plan.nodes < best->nodes : error < 0.5 * best_error;
    if (!best || is_better) {
      best = plan;
      best_error = error;
    }
    if (best_error < enough && best->nodes <= welcome_nodes) break;
  }
  if (!best) {
    throw std::domain_error("closed loop: |L| keeps a gain at high frequency, so that each of the " +
                            std::to_string(loop.all_passages()) + " passages through the dead time counts; at most " +
                            std::to_string(most_of_all) + " are computed, for shorter times");
  }
  return *best;
}

// Passages may be much larger than their sum.
constexpr double passage_tolerance = 1e-13;

LoopResponse evaluate(const ClosedLoop& loop, const TimeInput& input, std::span<const double> time,
                      std::span<const double> since, const Plan& plan) {
  LoopResponse response{std::vector<double>(time.size(), 0.0), plan.error, false, plan.passages, plan.nodes};
  for (std::size_t k = 0; k < plan.passages; ++k) {
    const TimeResponse part = respond(loop.passage(k), input, time, passage_tolerance);
    for (std::size_t i = 0; i < time.size(); ++i) response.output[i] += part.output[i];
    response.error_estimate += part.error_estimate;
  }
  if (plan.nodes == 0) return response;
  std::vector<Complex> values(plan.nodes);
  double rounding = 0;
  for (std::size_t k = 0; k < plan.nodes; ++k) {
    if (k % 64 == 0) throw_if_cancelled();
    const double omega = plan.step * static_cast<double>(k);
    const ClosedLoop::Rest rest = loop.rest({plan.abscissa, omega}, plan.passages);
    values[k] = k == 0 ? 0.5 * rest.value : rest.value;
    // Horner's rule adds at most a rounding for each node it passes.
    rounding += std::abs(values[k]) * (rest.rounding + 3 * static_cast<double>(k));
  }
  response.error_estimate += eps * rounding * plan.step / pi * std::exp(plan.abscissa * loop.latest());
  const LineSum sum(std::move(values), plan.step);
  const std::optional<EvenInstants> even = even_instants(since, loop.period() * (1 - 8 * eps));
  const std::vector<double> rest =
      even ? sum.at_parts_of_period(since.front(), even->length, since.size()) : sum.at(since);
  // Before its first passage the rest is 0 but for its error.
  const double start = static_cast<double>(plan.passages) * loop.delay();
  for (std::size_t i = 0; i < since.size(); ++i) {
    if (since[i] >= start) response.output[i] += std::exp(plan.abscissa * since[i]) * plan.step / pi * rest[i];
  }
  return response;
}

// forward/(1 + loop) without dead time in the loop.  The usual case, forward = loop or both over one denominator, is
// spared a common factor.
FractionalTransferFunction closed_ratio(const FractionalTransferFunction& forward,
                                        const FractionalTransferFunction& loop) {
  const FractionalTransferFunction one({{1, 0}}, {{1, 0}});
  if (forward.denominator() != loop.denominator()) return forward / (one + loop);
  const FractionalTransferFunction top(forward.numerator(), {{1, 0}}, forward.delay());
  return top / (FractionalTransferFunction(loop.numerator(), {{1, 0}}) +
                FractionalTransferFunction(loop.denominator(), {{1, 0}}));
}

}  // namespace

LoopResponse respond_closed_loop(const FractionalTransferFunction& forward, const FractionalTransferFunction& loop,
                                 const TimeInput& input, std::span<const double> time, double tolerance) {
  if (!(tolerance >= 1e-12 && tolerance <= 0.1)) {
    throw std::invalid_argument("closed loop: tolerance = " + detail::number_text(tolerance) +
                                "; allowed is 1e-12 to 0.1");
  }
  if (loop.delay() == 0) {
    const TimeResponse response = respond(closed_ratio(forward, loop), input, time, tolerance);
    return {response.output, response.error_estimate, response.meets_tolerance, 0, 0};
  }
  if (const auto* sampled = std::get_if<SampledInput>(&input); sampled && sampled->hold == Hold::band_limited) {
    throw std::invalid_argument(
        "closed loop: hold = band-limited has no meaning around a dead time; allowed are zero-order and first-order");
  }
  const double excess = detail::order_at_infinity(loop);
  if (excess > 0 && !keeps_gain(loop)) {
    throw std::invalid_argument("closed loop: |L| grows as omega^" + detail::short_text(excess) +
                                " at high frequency; with a dead time it must stay bounded");
  }
  // Checks input and instants, and is the first passage.
  const TimeResponse first = respond(forward, input, time, passage_tolerance);
  const InputImage image(input);
  std::vector<double> since;
  for (const double t : time) since.push_back(t - image.start() - forward.delay());
  if (since.back() < loop.delay()) {
    return {first.output, first.error_estimate, first.error_estimate <= tolerance * largest_of(first.output), 1, 0};
  }
  // Four lengths of the response, or a little more, so that even instants are parts of it.
  double period = 4 * since.back();
  if (const auto even = even_instants(since, period)) period = even->step * static_cast<double>(even->length);
  const ClosedLoop closed(forward, loop, input, since.back(), period);
  const auto judged = [tolerance](LoopResponse found) {
    found.meets_tolerance = found.error_estimate <= tolerance * largest_of(found.output);
    return found;
  };
  constexpr std::size_t few = 4;
  if (closed.all_passages() <= (keeps_gain(loop) ? most_of_all : few)) {
    return judged(evaluate(closed, input, time, since, {closed.all_passages(), 0, 0, 0, 0}));
  }
  const double abscissa = line_right_of_roots(closed, 2 / since.back());
  // Of the weighted response at several scales of time; the whole shows how large it was.
  double scale = 0;
  for (double part = 1; part > 1e-3; part /= 2) {
    scale = std::max(scale, closed.size(abscissa, 1 / (part * since.back())));
  }
  LoopResponse response{};
  for (int attempt = 0; attempt < 2; ++attempt) {
    response = judged(evaluate(closed, input, time, since, planned(closed, abscissa, tolerance * scale)));
    const double size = largest_of(response.output);
    if (response.meets_tolerance || !(size < scale)) break;
    scale = size;
  }
  return response;
}

std::string LoopResponse::summary() const {
  using detail::short_text;
  std::string text = detail::counted(output.size(), "instant") + " of a closed loop, largest output " +
                     short_text(largest_of(output)) + ", estimated error " + detail::bound_text(error_estimate) +
                     ", from " + detail::counted(passages, "passage");
  if (nodes > 0) text += " and " + detail::counted(nodes, "node") + " of a line";
  return text + (meets_tolerance ? "." : ", more than the tolerance allows.");
}

}  // namespace frac
