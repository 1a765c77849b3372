// SPDX-License-Identifier: BSD-3-Clause
#include "laplace_image.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "base/log_ratio.hpp"
#include "formula/power_sum.hpp"

namespace frac::detail {
namespace {

using Complex = std::complex<double>;

const PowerTerm& dominant(const std::vector<PowerTerm>& terms, double log_radius) {
  const auto size = [&](const PowerTerm& term) {
    return std::log(std::abs(term.coefficient)) + term.order * log_radius;
  };
  return *std::max_element(terms.begin(), terms.end(),
                           [&](const PowerTerm& a, const PowerTerm& b) { return size(a) < size(b); });
}

double log_size(const PowerTerm& term, double log_radius) {
  return std::log(std::abs(term.coefficient)) + term.order * log_radius;
}

// ln of the modulus and order of the product of the terms that dominate its sums.
struct Dominant {
  double log_size = 0;
  double order = 0;
};
Dominant dominant(const PowerProduct& product, double log_radius) {
  Dominant result;
  product.for_each_sum([&](const std::vector<PowerTerm>& sum, int power) {
    const PowerTerm& term = dominant(sum, log_radius);
    result.log_size += power * log_size(term, log_radius);
    result.order += power * term.order;
  });
  return result;
}

// Visits ln|s| where two terms of a sum are equally large.
template <typename Visit>
void for_each_corner(const PowerProduct& product, const Visit& visit) {
  product.for_each_sum([&](const std::vector<PowerTerm>& terms, int) {
    for (const PowerTerm& a : terms) {
      for (const PowerTerm& b : terms) {
        if (a.order <= b.order) continue;
        visit(log_ratio(b.coefficient, a.coefficient) / (a.order - b.order));
      }
    }
  });
}

}  // namespace

double dominant_slope(const PowerProduct& numerator, const PowerProduct& denominator, double log_radius) {
  return dominant(numerator, log_radius).order - dominant(denominator, log_radius).order;
}

LaplaceImage::LaplaceImage(PowerProduct numerator, PowerProduct denominator)
    : numerator_(std::move(numerator)),
      denominator_(std::move(denominator)),
      poles_(power_sum_roots(denominator_, 1.5 * std::numbers::pi)) {
  // The coefficients of an expansion say no more of crowded poles than the roots themselves.
  if (denominator_.is_factored()) poles_.clusters = without_crowds(std::move(poles_.clusters));
  const std::vector<RootCluster>& clusters = poles_.clusters;
  for (const RootCluster& pole : clusters) {
    double clearance = std::numeric_limits<double>::infinity();
    for (const RootCluster& other : clusters) {
      if (&other != &pole) {
        clearance = std::min(clearance, std::abs(pole.log_s - other.log_s) - other.spread);
      }
      if (&other != &pole || !pole.is_conjugate) {
        clearance = std::min(clearance, std::abs(pole.log_s - std::conj(other.log_s)) - other.spread);
      }
    }
    clearance_.push_back(clearance);
  }
  lowest_corner_ = std::numeric_limits<double>::infinity();
  highest_corner_ = -lowest_corner_;
  for (const PowerProduct* product : {&numerator_, &denominator_}) {
    for_each_corner(*product, [&](double corner) {
      lowest_corner_ = std::min(lowest_corner_, corner);
      highest_corner_ = std::max(highest_corner_, corner);
    });
  }
  if (lowest_corner_ > highest_corner_) lowest_corner_ = highest_corner_ = 0;
}

Complex LaplaceImage::value(Complex zeta, Complex exponent) const {
  const ScaledSum top = scaled_sum(numerator_, zeta);
  const ScaledSum bottom = scaled_sum(denominator_, zeta);
  return top.value / bottom.value * std::exp(exponent + top.scale - bottom.scale);
}

double LaplaceImage::log_magnitude(double log_radius) const {
  return dominant(numerator_, log_radius).log_size - dominant(denominator_, log_radius).log_size;
}

double LaplaceImage::slope(double log_radius) const {
  return dominant_slope(numerator_, denominator_, log_radius);
}

double LaplaceImage::lowest_noticed(double latest, double tolerance) const {
  // Nodes at s add about Y s latest to a response up to `latest` where s latest < 1; in logarithms that is piecewise
  // straight, so it is largest at a corner.  A margin for what poles nearby add.
  const double own = -std::log(latest);
  const double least = log_magnitude(own) + std::log(1e-3 * tolerance);
  double lowest = own;
  for (const PowerProduct* product : {&numerator_, &denominator_}) {
    for_each_corner(*product, [&](double corner) {
      if (corner < lowest && log_magnitude(corner) + corner - own > least) lowest = corner;
    });
  }
  return lowest;
}

LaplaceImage::OriginExpansion LaplaceImage::origin_expansion(double limit) const {
  const std::vector<PowerTerm>& denominator = denominator_.terms;
  OriginExpansion result{{}, numerator_.terms};
  const PowerTerm lowest = denominator.back();
  while (!result.remainder.empty() && result.terms.size() < 200) {
    const PowerTerm leading = result.remainder.back();
    const PowerTerm term{leading.coefficient / lowest.coefficient, leading.order - lowest.order};
    if (term.order > limit) break;
    result.terms.push_back(term);
    std::vector<PowerTerm> next(result.remainder.begin(), result.remainder.end() - 1);
    for (std::size_t i = 0; i + 1 < denominator.size(); ++i) {
      next.push_back({-term.coefficient * denominator[i].coefficient, term.order + denominator[i].order});
    }
    result.remainder = collected(std::move(next));
  }
  return result;
}

}  // namespace frac::detail
