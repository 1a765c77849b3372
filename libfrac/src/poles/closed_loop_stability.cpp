// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <numbers>
#include <stdexcept>
#include <string>
#include <vector>

#include "base/log_ratio.hpp"
#include "base/number_text.hpp"
#include "formula/power_sum.hpp"
#include "frac/stability.hpp"
#include "frequency_axis.hpp"
#include "laplace_image.hpp"
#include "principal_sheet.hpp"
#include "winding_number.hpp"

namespace frac {
namespace {

using Complex = std::complex<double>;
using detail::ScaledSum;
constexpr double pi = std::numbers::pi;
// Radians that dead time and powers may turn along the contour: each takes a few evaluations.
constexpr double largest_turning = 1e6;

// Returns where a condition that holds from `low` on, if anywhere, ceases to hold; `low` where it holds nowhere.
template <typename Condition>
double boundary(const Condition& holds, double low, double high) {
  return holds(low) ? detail::bisected([&](double u) { return holds(u) ? 1.0 : -1.0; }, low, high) : low;
}

// Order of L at infinity and, where that is 0, the limit of |L|.
struct HighFrequency {
  double order, gain;
};

HighFrequency high_frequency(const FractionalTransferFunction& loop) {
  const double rounding = 1e-13 * std::max(1.0, std::abs(loop.denominator().front().order));
  const double difference = detail::order_at_infinity(loop);
  const HighFrequency high{std::abs(difference) <= rounding ? 0 : difference,
                           std::abs(loop.numerator().front().coefficient / loop.denominator().front().coefficient)};
  // Nearer to 1 the leading terms may cancel to rounding.
  constexpr double most_gain = 1 - 16 * std::numeric_limits<double>::epsilon();
  if (high.order > 0 || (high.order == 0 && high.gain >= most_gain)) {
    throw std::invalid_argument("closed loop: |L| tends to " +
                                (high.order > 0 ? std::string("infinity") : detail::number_text(high.gain)) +
                                " at high frequency; allowed is below 1");
  }
  return high;
}

// The function D(s) + N(s) e^{-delay s} of a loop N/D, whose zeros in the right half-plane are counted, and the stretch
// of frequencies in which they can lie.
class Characteristic {
 public:
  explicit Characteristic(const FractionalTransferFunction& loop)
      : Characteristic(loop, std::min(loop.numerator().back().order, loop.denominator().back().order)) {}

  [[nodiscard]] bool has_root_at_origin() const { return pole_at_origin_; }

  // Value and slope at s = e^zeta, but for a positive factor.
  [[nodiscard]] detail::ValueAndSlope at(Complex zeta) const {
    if (delay_ == 0 && (pole_at_origin_ || !factored_bottom_.is_factored())) {
      const ScaledSum sum = detail::scaled_sum(polynomial_, zeta);
      return {sum.value, sum.slope};
    }
    const ScaledSum n = detail::scaled_sum(factored_top_, zeta);
    const ScaledSum d = detail::scaled_sum(factored_bottom_, zeta);
    const Complex turn = delay_ * std::exp(zeta);
    const double scale = std::max(n.scale, d.scale);
    const Complex late = std::exp(-turn + (n.scale - scale));
    const double own = std::exp(d.scale - scale);
    return {d.value * own + n.value * late, d.slope * own + (n.slope - turn * n.value) * late};
  }

  // Logarithms of the frequencies between which roots can lie.
  struct Stretch {
    double first, last;
  };
  [[nodiscard]] Stretch stretch() const {
    const auto [lowest, highest] = corners();
    const double step = smallest_step();
    const auto possible = [this](double u) { return may_have_root(u); };
    double last = highest + 3 / step;
    if (!possible(last)) last = boundary(possible, lowest, last) + 0.1;
    const auto outweighed = [this](double u) { return is_outweighed(u); };
    const double least = lowest - 8 / step;
    return {outweighed(last) ? last : boundary(outweighed, least, last) - 0.1, last};
  }

 private:
  // Orders from 0: multiplying by a power of s changes no root right of the axis.
  Characteristic(const FractionalTransferFunction& loop, double lowest)
      : delay_(loop.delay()),
        high_(high_frequency(loop)),
        top_(detail::scaled(loop.numerator(), 1, -lowest)),
        bottom_(detail::scaled(loop.denominator(), 1, -lowest)),
        factored_top_(detail::scaled(detail::numerator_of(loop), 1, -lowest)),
        factored_bottom_(detail::scaled(detail::denominator_of(loop), 1, -lowest)),
        low_frequency_sum_(detail::merged(top_, bottom_)),
        pole_at_origin_(low_frequency_sum_.back().order > 1e-12),
        polynomial_(detail::scaled(low_frequency_sum_, 1, -low_frequency_sum_.back().order)),
        all_(polynomial_) {
    if (delay_ > 0) {
      all_ = top_;
      all_.insert(all_.end(), bottom_.begin(), bottom_.end());
    }
  }

  // Logarithms of the lowest and highest frequency, 1 rad/s among them, at which two terms are of equal size.
  struct Corners {
    double lowest = 0, highest = 0;
  };
  [[nodiscard]] Corners corners() const {
    Corners found;
    for (const PowerTerm& a : all_) {
      for (const PowerTerm& b : all_) {
        if (a.order - b.order < 1e-13) continue;
        const double corner = detail::log_ratio(b.coefficient, a.coefficient) / (a.order - b.order);
        found.lowest = std::min(found.lowest, corner);
        found.highest = std::max(found.highest, corner);
      }
    }
    if (delay_ > 0) {
      found.lowest = std::min(found.lowest, -std::log(delay_));
      // The lowest terms may nearly cancel: what is left of them meets the other terms far below those' own corners.
      std::vector<PowerTerm> others = all_;
      for (const PowerTerm& term : top_) others.push_back({delay_ * term.coefficient, term.order + 1});
      for (const PowerTerm& term : others) {
        if (pole_at_origin_ || term.order < 1e-13) continue;
        const double corner = detail::log_ratio(low_frequency_sum_.back().coefficient, term.coefficient) / term.order;
        found.lowest = std::min(found.lowest, corner);
      }
    }
    return found;
  }

  [[nodiscard]] double smallest_step() const {
    double smallest = 1;
    for (std::size_t i = 0; i + 1 < all_.size(); ++i) {
      for (std::size_t j = i + 1; j < all_.size(); ++j) {
        const double gap = std::abs(all_[i].order - all_[j].order);
        if (gap > 1e-13) smallest = std::min(smallest, gap);
      }
    }
    return smallest;
  }

  // In the right half-plane e^{-delay s} is at most 1: no root where the terms say |L| < 1 for every phase of theirs.
  // The contour is taken no further, because dead time makes it turn as often as there are radians.
  [[nodiscard]] bool may_have_root(double u) const {
    const auto size = [&](const PowerTerm& term) {
      return std::abs(term.coefficient) * std::exp((term.order - bottom_.front().order) * u);
    };
    double least = size(bottom_.front());
    for (std::size_t i = 1; i < bottom_.size(); ++i) {
      // Such a term stays within a right angle of the highest one in the whole half-plane, so it does not lessen the
      // sum.
      const bool helps =
          bottom_[i].coefficient * bottom_.front().coefficient > 0 && bottom_.front().order - bottom_[i].order <= 1;
      if (!helps) least -= size(bottom_[i]);
    }
    double most = 0;
    for (const PowerTerm& term : top_) most += size(term);
    return !(most < (high_.order == 0 ? (1 + high_.gain) / 2 : 0.5) * least);
  }

  // The lowest terms together outweigh the others twice, and the dead time is nothing; where they cancel, the next do
  // by far.
  [[nodiscard]] bool is_outweighed(double u) const {
    double lowest_terms = 0;
    double others = 0;
    for (const PowerTerm& term : all_) {
      const double size = std::abs(term.coefficient) * std::exp(term.order * u);
      if (term.order < 1e-13) {
        lowest_terms += term.coefficient;
      } else {
        others += size;
      }
    }
    for (const PowerTerm& term : top_) others += delay_ * std::abs(term.coefficient) * std::exp((term.order + 1) * u);
    return 2 * others < std::abs(lowest_terms);
  }

  double delay_;
  HighFrequency high_;
  std::vector<PowerTerm> top_, bottom_;
  detail::PowerProduct factored_top_, factored_bottom_;
  std::vector<PowerTerm> low_frequency_sum_;
  bool pole_at_origin_;
  // Without dead time, free of cancellation and of the pole at the origin.
  std::vector<PowerTerm> polynomial_;
  // The terms whose sizes decide where roots can lie.
  std::vector<PowerTerm> all_;
};

}  // namespace

ClosedLoopStability analyse_closed_loop(const FractionalTransferFunction& loop) {
  const Characteristic characteristic(loop);
  const auto stretch = characteristic.stretch();
  const double first = stretch.first, last = stretch.last;
  if (loop.delay() * std::exp(last) + loop.denominator().front().order > largest_turning) {
    return {Stability::undetermined, 0};
  }
  const auto turns = [&](double angle) {
    return detail::winding_number([&](Complex zeta) { return characteristic.at(zeta); },
                                  {{first, -angle}, {last, -angle}, {last, angle}, {first, angle}});
  };
  const double count = turns(pi / 2 - detail::axis_width);
  if (!std::isfinite(count)) return {Stability::marginal, 0};
  const int unstable = static_cast<int>(std::lround(count));
  if (std::abs(count - unstable) > 0.01 || unstable < 0) return {Stability::undetermined, 0};
  if (unstable > 0) return {Stability::unstable, unstable};
  const double with_axis = turns(pi / 2 + detail::axis_width);
  return {!characteristic.has_root_at_origin() && std::abs(with_axis) < 0.01 ? Stability::stable : Stability::marginal,
          0};
}

}  // namespace frac
