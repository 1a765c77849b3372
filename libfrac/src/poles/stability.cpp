// SPDX-License-Identifier: BSD-3-Clause
#include "frac/stability.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <stdexcept>
#include <string>

#include "base/number_text.hpp"
#include "base/short_text.hpp"
#include "formula/power_sum.hpp"
#include "frac/model/algebra.hpp"
#include "frequency_axis.hpp"
#include "laplace_image.hpp"
#include "principal_sheet.hpp"
#include "winding_number.hpp"

namespace frac {
namespace {

using Complex = std::complex<double>;
using detail::RootCluster;
using detail::ScaledSum;
constexpr double pi = std::numbers::pi;
// Margin of arg s about pi/2 within which rounding of the coefficients decides.
constexpr double axis_width = 1e-9;
// Distance in ln s below which roots of different factors are one: rounding.
constexpr double same = 1e-13;
// Radians that dead time may turn along the contour of a closed loop: each takes a few evaluations.
constexpr double largest_turning = 1e6;

// Whether the numerator has the root as often as the denominator.  Of a cluster of roots that lie apart the middle is
// tried.
bool is_cancelled(const detail::PowerProduct& numerator, const RootCluster& root) {
  constexpr double vanishing = 1e-9;
  int zeros = 0;
  numerator.for_each_sum([&](const std::vector<PowerTerm>& sum, int power) {
    const auto count = static_cast<std::size_t>(root.multiplicity);
    const detail::TaylorStart start = detail::taylor_start(sum, root.log_s, root.multiplicity);
    const double size = detail::scaled_sum(sum, root.log_s).magnitude;
    std::size_t own = 0;
    while (own < count && std::abs(start.coefficient[own]) < vanishing * size) ++own;
    zeros += power * static_cast<int>(own);
  });
  return zeros >= root.multiplicity;
}

// The denominator as a polynomial in s^q, from its factors where each of them is one.
detail::PowerProduct in_lambda(const FractionalTransferFunction& model, double q) {
  const auto substituted = [&](std::vector<PowerTerm> sum, bool& fits) {
    const double lowest = sum.back().order;
    for (PowerTerm& term : sum) {
      const double order = (term.order - lowest) / q;
      fits = fits && std::abs(order - std::round(order)) < 1e-6;
      term.order = std::round(order);
    }
    return sum;
  };
  bool fits = true;
  detail::PowerProduct result{{}, substituted(model.denominator(), fits)};
  fits = true;
  for (const PowerFactor& factor : model.denominator_factors()) {
    result.factors.push_back({substituted(factor.sum, fits), factor.power});
  }
  if (!fits) result.factors.clear();
  return result;
}

// Returns where a condition that holds from `low` on, if anywhere, ceases to hold; `low` where it holds nowhere.
template <typename Condition>
double boundary(const Condition& holds, double low, double high) {
  return holds(low) ? detail::bisected([&](double u) { return holds(u) ? 1.0 : -1.0; }, low, high) : low;
}

}  // namespace

std::string_view to_string(Stability stability) noexcept {
  switch (stability) {
    case Stability::stable:
      return "stable";
    case Stability::marginal:
      return "marginal";
    case Stability::unstable:
      return "unstable";
    case Stability::integrating:
      return "integrating";
    case Stability::differentiating:
      return "differentiating";
    case Stability::undetermined:
      break;
  }
  return "undetermined";
}

StabilityAnalysis detail::analyse_principal_sheet(const FractionalTransferFunction& model) {
  StabilityAnalysis result{};
  const detail::PowerProduct numerator = detail::numerator_of(model);
  const detail::PowerSumRoots roots = detail::power_sum_roots(detail::denominator_of(model), pi, same);
  bool unstable = false;
  bool marginal = false;
  for (const RootCluster& root : roots.clusters) {
    const Complex s = std::exp(root.log_s);
    const bool real = root.is_conjugate || root.log_s.imag() > pi - 1e-12;
    const bool cancelled = is_cancelled(numerator, root);
    result.poles.push_back({real ? Complex(s.real()) : s, root.multiplicity, cancelled});
    if (cancelled) continue;
    marginal = marginal || std::abs(root.log_s.imag() - pi / 2) <= axis_width + root.spread;
    unstable = unstable || root.log_s.imag() < pi / 2 - axis_width - root.spread;
  }
  if (!roots.complete) {
    result.stability = Stability::undetermined;
    result.remark = "The poles could not be counted: " + std::string(roots.trouble) + ".";
  } else if (unstable) {
    result.stability = Stability::unstable;
  } else if (detail::order_at_infinity(model) > 0) {
    result.stability = Stability::differentiating;
  } else if (detail::order_at_origin(model) < 0) {
    result.stability = Stability::integrating;
  } else {
    result.stability = marginal ? Stability::marginal : Stability::stable;
  }
  return result;
}

StabilityAnalysis analyse_stability(const FractionalTransferFunction& model) {
  StabilityAnalysis result = detail::analyse_principal_sheet(model);
  // A finer one makes thousands of sheets, which take long and say nothing that a person could use.
  const auto common = commensurate_order(model);
  if (common && common->value() >= 1e-3) result.commensurate_order = common->value();
  if (result.commensurate_order) {
    const double q = *result.commensurate_order;
    const detail::PowerProduct polynomial = in_lambda(model, q);
    for (const RootCluster& root : detail::power_sum_roots(polynomial, pi, same).clusters) {
      const double argument = root.log_s.imag();
      const Complex lambda = std::exp(root.log_s);
      result.sheet_roots.push_back({root.is_conjugate || argument > pi - 1e-12 ? Complex(lambda.real()) : lambda,
                                    root.multiplicity, argument <= q * pi * (1 + 1e-12), argument > q * pi / 2});
    }
  }
  return result;
}

ClosedLoopStability analyse_closed_loop(const FractionalTransferFunction& loop) {
  const double order_rounding = 1e-13 * std::max(1.0, std::abs(loop.denominator().front().order));
  const double order_difference = detail::order_at_infinity(loop);
  const double high_order = std::abs(order_difference) <= order_rounding ? 0 : order_difference;
  const double high_gain = std::abs(loop.numerator().front().coefficient / loop.denominator().front().coefficient);
  // Nearer to 1 the leading terms may cancel to rounding.
  constexpr double most_high_gain = 1 - 16 * std::numeric_limits<double>::epsilon();
  if (high_order > 0 || (high_order == 0 && high_gain >= most_high_gain)) {
    throw std::invalid_argument("analyse_closed_loop: |L| tends to " +
                                (high_order > 0 ? std::string("infinity") : detail::number_text(high_gain)) +
                                " at high frequency; allowed is below 1");
  }
  const double delay = loop.delay();
  // Orders from 0: multiplying by a power of s changes no root right of the axis.
  const double lowest = std::min(loop.numerator().back().order, loop.denominator().back().order);
  const std::vector<PowerTerm> top = detail::scaled(loop.numerator(), 1, -lowest);
  const std::vector<PowerTerm> bottom = detail::scaled(loop.denominator(), 1, -lowest);
  const detail::PowerProduct factored_top = detail::scaled(detail::numerator_of(loop), 1, -lowest);
  const detail::PowerProduct factored_bottom = detail::scaled(detail::denominator_of(loop), 1, -lowest);
  const std::vector<PowerTerm> low_frequency_sum = detail::merged(top, bottom);
  const bool pole_at_origin = low_frequency_sum.back().order > 1e-12;
  // Without dead time, free of cancellation and of the pole at the origin.
  const std::vector<PowerTerm> polynomial = detail::scaled(low_frequency_sum, 1, -low_frequency_sum.back().order);
  const auto characteristic = [&](Complex zeta) {
    if (delay == 0 && (pole_at_origin || !factored_bottom.is_factored())) {
      const ScaledSum sum = detail::scaled_sum(polynomial, zeta);
      return detail::ValueAndSlope{sum.value, sum.slope};
    }
    const ScaledSum n = detail::scaled_sum(factored_top, zeta);
    const ScaledSum d = detail::scaled_sum(factored_bottom, zeta);
    const Complex turn = delay * std::exp(zeta);
    const double scale = std::max(n.scale, d.scale);
    const Complex late = std::exp(-turn + (n.scale - scale));
    const double own = std::exp(d.scale - scale);
    return detail::ValueAndSlope{d.value * own + n.value * late, d.slope * own + (n.slope - turn * n.value) * late};
  };
  std::vector<PowerTerm> all = polynomial;
  if (delay > 0) {
    all = top;
    all.insert(all.end(), bottom.begin(), bottom.end());
  }
  double lowest_corner = 0;
  double highest_corner = 0;
  for (const PowerTerm& a : all) {
    for (const PowerTerm& b : all) {
      if (a.order - b.order < 1e-13) continue;
      const double corner = std::log(std::abs(b.coefficient / a.coefficient)) / (a.order - b.order);
      lowest_corner = std::min(lowest_corner, corner);
      highest_corner = std::max(highest_corner, corner);
    }
  }
  if (delay > 0) {
    lowest_corner = std::min(lowest_corner, -std::log(delay));
    // The lowest terms may nearly cancel: what is left of them meets the other terms far below those' own corners.
    std::vector<PowerTerm> others = all;
    for (const PowerTerm& term : top) others.push_back({delay * term.coefficient, term.order + 1});
    for (const PowerTerm& term : others) {
      if (pole_at_origin || term.order < 1e-13) continue;
      const double corner = std::log(std::abs(low_frequency_sum.back().coefficient / term.coefficient)) / term.order;
      lowest_corner = std::min(lowest_corner, corner);
    }
  }
  double smallest_step = 1;
  for (std::size_t i = 0; i + 1 < all.size(); ++i) {
    for (std::size_t j = i + 1; j < all.size(); ++j) {
      const double gap = std::abs(all[i].order - all[j].order);
      if (gap > 1e-13) smallest_step = std::min(smallest_step, gap);
    }
  }
  // In the right half-plane e^{-delay s} is at most 1: no root where the terms say |L| < 1 for every phase of theirs.
  // The contour is taken no further, because dead time makes it turn as often as there are radians.
  const auto may_have_root = [&](double u) {
    const auto size = [&](const PowerTerm& term) {
      return std::abs(term.coefficient) * std::exp((term.order - bottom.front().order) * u);
    };
    double least = size(bottom.front());
    for (std::size_t i = 1; i < bottom.size(); ++i) {
      // Such a term stays within a right angle of the highest one in the whole half-plane, so it does not lessen the
      // sum.
      const bool helps =
          bottom[i].coefficient * bottom.front().coefficient > 0 && bottom.front().order - bottom[i].order <= 1;
      if (!helps) least -= size(bottom[i]);
    }
    double most = 0;
    for (const PowerTerm& term : top) most += size(term);
    return !(most < (high_order == 0 ? (1 + high_gain) / 2 : 0.5) * least);
  };
  double last = highest_corner + 3 / smallest_step;
  if (!may_have_root(last)) last = boundary(may_have_root, lowest_corner, last) + 0.1;
  if (delay * std::exp(last) > largest_turning) return {Stability::undetermined, 0};
  // Below `first` the lowest terms together outweigh the others twice, and the dead time is nothing; where they cancel,
  // the next do by far.
  const auto outweighed = [&](double u) {
    double lowest_terms = 0;
    double others = 0;
    for (const PowerTerm& term : all) {
      const double size = std::abs(term.coefficient) * std::exp(term.order * u);
      if (term.order < 1e-13) {
        lowest_terms += term.coefficient;
      } else {
        others += size;
      }
    }
    for (const PowerTerm& term : top) others += delay * std::abs(term.coefficient) * std::exp((term.order + 1) * u);
    return 2 * others < std::abs(lowest_terms);
  };
  const double least_first = lowest_corner - 8 / smallest_step;
  const double first = outweighed(last) ? last : boundary(outweighed, least_first, last) - 0.1;
  const double right = pi / 2 - axis_width;
  const double count =
      detail::winding_number(characteristic, {{first, -right}, {last, -right}, {last, right}, {first, right}});
  if (!std::isfinite(count)) return {Stability::marginal, 0};
  const int unstable = static_cast<int>(std::lround(count));
  if (std::abs(count - unstable) > 0.01 || unstable < 0) return {Stability::undetermined, 0};
  if (unstable > 0) return {Stability::unstable, unstable};
  const double left = pi / 2 + axis_width;
  const double with_axis =
      detail::winding_number(characteristic, {{first, -left}, {last, -left}, {last, left}, {first, left}});
  return {!pole_at_origin && std::abs(with_axis) < 0.01 ? Stability::stable : Stability::marginal, 0};
}

std::string StabilityAnalysis::summary() const {
  using detail::short_text;
  std::string text(to_string(stability));
  for (std::size_t i = 0; i < poles.size(); ++i) {
    const Pole& pole = poles[i];
    text += (i == 0 ? ", poles at " : ", ") + short_text(pole.value.real());
    if (pole.value.imag() != 0) text += " +- " + short_text(pole.value.imag()) + "i";
    if (pole.multiplicity > 1) text += " (" + std::to_string(pole.multiplicity) + " times)";
    if (pole.cancelled) text += " (cancelled)";
  }
  return text + (remark.empty() ? "" : ". " + remark);
}

}  // namespace frac
