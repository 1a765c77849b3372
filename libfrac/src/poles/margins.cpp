// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>
#include <vector>

#include "base/short_text.hpp"
#include "frac/stability.hpp"
#include "frequency_axis.hpp"
#include "laplace_image.hpp"

namespace frac {
namespace {

using Complex = std::complex<double>;
using detail::AxisLimit;
using detail::FrequencyAxis;
using detail::LaplaceImage;
constexpr double pi = std::numbers::pi;
constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double epsilon = std::numeric_limits<double>::epsilon();

// ln omega beyond which omega or a power of it may overflow.
constexpr double widest = 690;
// So many quarter turns of the dead time, a thousand turns, are followed one by one.
constexpr double followed_quarters = 4000;
// An interval has a phase crossover within a turn of each end, if it is longer; the rest allows for phase of the poles.
constexpr int quarters_from_end = 16;
constexpr double least_listed_gain = 1e-3;
constexpr double largest_phase_rounding = 1e-3;  // rad

// The sum of all terms but the one that leads towards one end of the axis, over that one.
double rest_over_leading(const std::vector<PowerTerm>& terms, const PowerTerm& leading, double u) {
  double rest = 0;
  for (const PowerTerm& term : terms) {
    if (term.order == leading.order) continue;
    rest += std::abs(term.coefficient / leading.coefficient) * std::exp((term.order - leading.order) * u);
  }
  return rest;
}

// One end of the axis of u = ln omega, where L tends to gain (j omega)^order.
struct AxisEnd {
  const LaplaceImage& image;
  const PowerTerm& top;
  const PowerTerm& bottom;
  double outward;  // 1 at high frequency, -1 at low
  double delay;
  AxisLimit limit;

  [[nodiscard]] double order() const { return top.order - bottom.order; }
  [[nodiscard]] double gain() const { return std::abs(top.coefficient / bottom.coefficient); }
  // Without dead time.
  [[nodiscard]] bool has_negative_limit() const {
    return std::abs(order()) < 1e-13 && top.coefficient / bottom.coefficient < 0;
  }

  // From u outwards |L| stays on one side of 1: the bounds by the leading terms only tighten.
  [[nodiscard]] bool gain_is_settled(double u) const {
    const double above = rest_over_leading(image.numerator().terms, top, u);
    const double below = rest_over_leading(image.denominator().terms, bottom, u);
    if (!(above < 1 && below < 1)) return false;
    const double leading = std::log(gain()) + order() * u;
    const double rising = outward * order();
    // |L| tends to 1: further out its square may differ from 1 by less than rounding.
    if (rising == 0 && leading == 0) return above + below < 1e-5;
    return (rising <= 0 && leading + std::log((1 + above) / (1 - below)) < 0) ||
           (rising >= 0 && leading + std::log((1 - above) / (1 + below)) > 0);
  }

  // From u outwards L, at high frequency without its dead time, keeps off the negative axis, or nears it from one side.
  [[nodiscard]] bool phase_is_settled(double u) const {
    const double above = rest_over_leading(image.numerator().terms, top, u);
    const double below = rest_over_leading(image.denominator().terms, bottom, u);
    if (!(above < 1 && below < 1)) return false;
    const double sign = top.coefficient / bottom.coefficient > 0 ? 0 : pi;
    const double gap = std::abs(std::remainder(order() * pi / 2 + sign - pi, 2 * pi));
    const double late = outward < 0 ? delay * std::exp(u) : 0;
    return gap < 1e-9 ? limit.phase_keeps_side(u, delay) : std::asin(above) + std::asin(below) + late < gap;
  }
};

double settled_end(const AxisEnd& end, double start) {
  double u = start;
  while (std::abs(u) < widest && !(end.gain_is_settled(u) && end.phase_is_settled(u))) u += 0.5 * end.outward;
  return std::clamp(u, -widest, widest);
}

// Splits [points[i], points[i + 1]] where `slope` changes sign.
template <typename Slope>
std::vector<double> with_extrema(const std::vector<double>& points, const Slope& slope) {
  std::vector<double> result;
  for (std::size_t i = 0; i + 1 < points.size(); ++i) {
    result.push_back(points[i]);
    if ((slope(points[i]) < 0) != (slope(points[i + 1]) < 0)) {
      result.push_back(detail::bisected(slope, points[i], points[i + 1]));
    }
  }
  result.push_back(points.back());
  return result;
}

// ln omega of the phase crossovers between a and b, which are less than about a quarter turn of the dead time apart.
std::vector<double> phase_crossovers_between(const FrequencyAxis& axis, double a, double b) {
  const auto imaginary = [&](double u) {
    const Complex value = axis.value(u);
    return value.imag() / std::abs(value);
  };
  const std::vector<double> ends = with_extrema({a, b}, [&](double u) { return axis.log_slope(u).imag(); });
  std::vector<double> found;
  for (std::size_t i = 0; i + 1 < ends.size(); ++i) {
    if ((imaginary(ends[i]) < 0) == (imaginary(ends[i + 1]) < 0)) continue;
    const double u = detail::bisected(imaginary, ends[i], ends[i + 1]);
    // A change of sign in Re > 0 is the positive axis.
    if (axis.value(u).real() < 0) found.push_back(u);
  }
  return found;
}

struct PhaseCrossovers {
  std::vector<double> log_omega;     // rising
  double followed_until = infinity;  // ln omega up to which none is left out
};

// On an undamped pole the phase turns without being -180 degrees anywhere: only there the gain falls by half within a
// few roundings of the frequency.
bool is_pole(const FrequencyAxis& axis, double u) {
  const double near = 64 * epsilon * (1 + std::abs(u));
  return axis.log_gain(u) - std::max(axis.log_gain(u - near), axis.log_gain(u + near)) > std::log(2.0);
}

// All of them while turns are left, then those next to the ends of each interval of `points`, on which |L| is monotone.
PhaseCrossovers phase_crossovers(const FrequencyAxis& axis, const std::vector<double>& points, double delay) {
  PhaseCrossovers result;
  const auto add = [&](const std::vector<double>& found) {
    result.log_omega.insert(result.log_omega.end(), found.begin(), found.end());
  };
  double left = followed_quarters;
  for (std::size_t i = 0; i + 1 < points.size(); ++i) {
    const double a = points[i];
    const double b = points[i + 1];
    const double quarters = std::floor(delay * (std::exp(b) - std::exp(a)) / (pi / 2));
    const double pieces = 1 + quarters;
    const auto piece = [&](double k) {
      return phase_crossovers_between(axis, a + (b - a) * k / pieces, a + (b - a) * (k + 1) / pieces);
    };
    left -= quarters;
    if (left >= 0 || pieces <= 2 * quarters_from_end) {
      for (double k = 0; k < pieces; ++k) add(piece(k));
      continue;
    }
    result.followed_until = std::min(result.followed_until, a);
    if (pieces > 1e12) {
      // There is a phase crossover within a hundred quarter turns of the end.
      add({a + (b - a) * 1e-10, b - (b - a) * 1e-10});
      continue;
    }
    std::vector<double> found;
    for (int k = 0; k < quarters_from_end && found.empty(); ++k) found = piece(k);
    add(found);
    found.clear();
    for (int k = 1; k <= quarters_from_end && found.empty(); ++k) found = piece(pieces - k);
    add(found);
  }
  std::erase_if(result.log_omega, [&](double u) { return is_pole(axis, u); });
  std::sort(result.log_omega.begin(), result.log_omega.end());
  return result;
}

void add_remark(std::string& text, const std::string& remark) {
  text += (text.empty() ? "" : " ") + remark;
}

void read_phase_margins(const FrequencyAxis& axis, double delay, const std::vector<double>& gain_crossovers,
                        Margins& result) {
  result.phase_margin = result.delay_margin = infinity;
  bool blurred = false;
  for (const double u : gain_crossovers) {
    const double omega = std::exp(u);
    if (delay * omega * epsilon * (1 + std::abs(u)) > largest_phase_rounding) {
      blurred = true;
      result.phase.push_back({omega, std::numeric_limits<double>::quiet_NaN()});
      add_remark(result.remark, "The phase margin at " + detail::four_digits(omega) +
                                    " rad/s is not determined: the dead time turns the phase by " +
                                    detail::four_digits(delay * omega) + " rad there, which rounding blurs.");
      continue;
    }
    const double margin = std::arg(-axis.value(u));
    result.phase.push_back({omega, margin});
    result.phase_margin = std::min(result.phase_margin, std::abs(margin));
    const double turn = margin >= 0 ? margin : margin + 2 * pi;
    result.delay_margin = std::min(result.delay_margin, turn / omega);
  }
  if (blurred) result.phase_margin = result.delay_margin = std::numeric_limits<double>::quiet_NaN();
}

void count_gain_factor(double factor, Margins& result) {
  if (factor >= 1) result.gain_margin = std::min(result.gain_margin, factor);
  if (factor < 1) result.gain_reduction = std::max(result.gain_reduction, factor);
}

void read_gain_margins(const FrequencyAxis& axis, const PhaseCrossovers& crossovers, const AxisEnd& low,
                       const AxisEnd& high, double delay, Margins& result) {
  result.gain_margin = infinity;
  for (const double u : crossovers.log_omega) count_gain_factor(std::exp(-axis.log_gain(u)), result);
  const bool ends_negative = delay == 0 && high.has_negative_limit();
  if (low.has_negative_limit()) {
    count_gain_factor(1 / low.gain(), result);
    result.gain.push_back({0, 1 / low.gain()});
  }
  if (ends_negative || (delay > 0 && high.order() == 0)) count_gain_factor(1 / high.gain(), result);
  for (const double u : crossovers.log_omega) {
    const double factor = std::exp(-axis.log_gain(u));
    const bool decides = factor == result.gain_margin || factor == result.gain_reduction;
    const bool listed = u <= crossovers.followed_until && factor <= 1 / least_listed_gain;
    if (decides || listed) result.gain.push_back({std::exp(u), factor});
  }
  if (ends_negative) result.gain.push_back({infinity, 1 / high.gain()});
}

}  // namespace

Margins margins(const FractionalTransferFunction& loop) {
  const LaplaceImage y(detail::numerator_of(loop), detail::denominator_of(loop));
  const double delay = loop.delay();
  const FrequencyAxis axis(y, delay);
  const AxisEnd low{y,     loop.numerator().back(),          loop.denominator().back(), -1,
                    delay, AxisLimit(y, AxisLimit::End::low)};
  const AxisEnd high{y,     loop.numerator().front(),          loop.denominator().front(), 1,
                     delay, AxisLimit(y, AxisLimit::End::high)};
  const double first = settled_end(low, std::min(y.lowest_corner(), delay > 0 ? -std::log(delay) : 0.0) - 12);
  double last = settled_end(high, y.highest_corner() + (delay > 0 ? 2 : 12));
  const bool ends_settled = low.gain_is_settled(first) && high.gain_is_settled(last);
  double listed_end = last;
  if (delay > 0) {
    // Follows the axis two turns further, to the first phase crossover beyond the last gain crossover.
    last = std::max(last, std::log(std::exp(last) + 4 * pi / delay));
    const double faded = high.order() < 0 ? std::log(high.gain() / least_listed_gain) / -high.order() : infinity;
    const double thousand_turns = std::log(followed_quarters * (pi / 2) / delay);
    listed_end = faded;
    last = std::max(last, std::min(faded, thousand_turns));
  }

  std::vector<double> points =
      with_extrema(axis.breakpoints(first, last), [&](double u) { return axis.log_slope(u).real(); });
  const auto log_gain = [&](double u) { return axis.log_gain(u); };
  std::vector<double> gain_crossovers;
  for (std::size_t i = 0; i + 1 < points.size(); ++i) {
    if ((log_gain(points[i]) < 0) != (log_gain(points[i + 1]) < 0)) {
      gain_crossovers.push_back(detail::bisected(log_gain, points[i], points[i + 1]));
    }
  }
  points.insert(points.end(), gain_crossovers.begin(), gain_crossovers.end());
  std::sort(points.begin(), points.end());
  const PhaseCrossovers crossovers = phase_crossovers(axis, points, delay);

  Margins result;
  read_phase_margins(axis, delay, gain_crossovers, result);
  read_gain_margins(axis, crossovers, low, high, delay, result);
  if (!ends_settled) {
    result.phase_margin = result.delay_margin = std::numeric_limits<double>::quiet_NaN();
    add_remark(result.remark,
               "Phase and delay margin are not determined: |L| may be 1 below e^-690 or above e^690 rad/s.");
  }
  const double listed_until = std::min(crossovers.followed_until, last);
  if (delay > 0 && listed_until < listed_end) {
    add_remark(result.remark, "Phase crossovers are listed up to " + detail::four_digits(std::exp(listed_until)) +
                                  " rad/s and beyond only where they decide a margin; dead time makes more with |L| "
                                  "above 1e-3.");
  }
  return result;
}

}  // namespace frac
