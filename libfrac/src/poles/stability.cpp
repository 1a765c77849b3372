// SPDX-License-Identifier: BSD-3-Clause
#include "frac/stability.hpp"

#include <cmath>
#include <numbers>
#include <string>

#include "base/short_text.hpp"
#include "formula/power_sum.hpp"
#include "frac/model/algebra.hpp"
#include "laplace_image.hpp"
#include "principal_sheet.hpp"

namespace frac {
namespace {

using Complex = std::complex<double>;
using detail::RootCluster;
constexpr double pi = std::numbers::pi;
// Distance in ln s below which roots of different factors are one: rounding.
constexpr double same = 1e-13;

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
