#include "laplace_image.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "power_sum.hpp"

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

void widen(const std::vector<PowerTerm>& terms, double& lowest, double& highest) {
  for (const PowerTerm& a : terms) {
    for (const PowerTerm& b : terms) {
      if (a.order <= b.order) continue;
      const double corner = std::log(std::abs(b.coefficient / a.coefficient)) / (a.order - b.order);
      lowest = std::min(lowest, corner);
      highest = std::max(highest, corner);
    }
  }
}

}  // namespace

double dominant_slope(const std::vector<PowerTerm>& numerator, const std::vector<PowerTerm>& denominator,
                      double log_radius) {
  return dominant(numerator, log_radius).order - dominant(denominator, log_radius).order;
}

LaplaceImage::LaplaceImage(std::vector<PowerTerm> numerator, std::vector<PowerTerm> denominator)
    : numerator_(std::move(numerator)),
      denominator_(std::move(denominator)),
      poles_(power_sum_roots(denominator_, 1.5 * std::numbers::pi)) {
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
  widen(numerator_, lowest_corner_, highest_corner_);
  widen(denominator_, lowest_corner_, highest_corner_);
  if (lowest_corner_ > highest_corner_) lowest_corner_ = highest_corner_ = 0;
}

Complex LaplaceImage::value(Complex zeta, Complex exponent) const {
  const ScaledSum top = scaled_sum(numerator_, zeta);
  const ScaledSum bottom = scaled_sum(denominator_, zeta);
  return top.value / bottom.value * std::exp(exponent + top.scale - bottom.scale);
}

double LaplaceImage::log_magnitude(double log_radius) const {
  return log_size(dominant(numerator_, log_radius), log_radius) -
         log_size(dominant(denominator_, log_radius), log_radius);
}

double LaplaceImage::slope(double log_radius) const {
  return dominant_slope(numerator_, denominator_, log_radius);
}

LaplaceImage::OriginExpansion LaplaceImage::origin_expansion(double limit) const {
  OriginExpansion result{{}, numerator_};
  const PowerTerm lowest = denominator_.back();
  while (!result.remainder.empty() && result.terms.size() < 200) {
    const PowerTerm leading = result.remainder.back();
    const PowerTerm term{leading.coefficient / lowest.coefficient, leading.order - lowest.order};
    if (term.order > limit) break;
    result.terms.push_back(term);
    std::vector<PowerTerm> next(result.remainder.begin(), result.remainder.end() - 1);
    for (std::size_t i = 0; i + 1 < denominator_.size(); ++i) {
      next.push_back({-term.coefficient * denominator_[i].coefficient, term.order + denominator_[i].order});
    }
    result.remainder = collected(std::move(next));
  }
  return result;
}

}  // namespace frac::detail
