// SPDX-License-Identifier: BSD-3-Clause
#include "error_measure.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>

#include "band_error.hpp"
#include "flux_law.hpp"

namespace frac::detail {
namespace {

using Extended = long double;
using ExtendedComplex = std::complex<Extended>;

class Ratio {
 public:
  Ratio(const ZeroPoleGain& system, double order)
      : system_(system),
        order_(order),
        turn_(std::polar(Extended{1}, -static_cast<Extended>(order) * std::numbers::pi_v<Extended> / 2)) {}

  // H(j omega)/(j omega)^order.
  [[nodiscard]] ExtendedComplex operator()(Extended omega) const {
    // Factors are divided by the larger of root and omega, and zeros are taken with poles, so that no product leaves
    // the range.
    ExtendedComplex numerator = turn_;
    ExtendedComplex denominator = 1;
    Extended size = static_cast<Extended>(system_.gain) / std::pow(omega, static_cast<Extended>(order_));
    const auto real_factor = [&](ExtendedComplex& product, double root) {
      const Extended larger = std::max(omega, static_cast<Extended>(std::abs(root)));
      const Extended real = -static_cast<Extended>(root) / larger;
      const Extended imaginary = omega / larger;
      product = {product.real() * real - product.imag() * imaginary,
                 product.real() * imaginary + product.imag() * real};
      return larger;
    };
    const auto pair_factor = [&](ExtendedComplex& product, std::complex<double> root) {
      const Extended re = root.real();
      const Extended im = root.imag();
      const Extended larger = std::max(omega, std::hypot(re, im));
      product *= ExtendedComplex(
          (re / larger) * (re / larger) + (im / larger - omega / larger) * (im / larger + omega / larger),
          -2 * (omega / larger) * (re / larger));
      return larger * larger;
    };
    for (std::size_t i = 0; i < std::max(system_.zeros.size(), system_.poles.size()); ++i) {
      if (i < system_.zeros.size()) size *= real_factor(numerator, system_.zeros[i]);
      if (i < system_.poles.size()) size /= real_factor(denominator, system_.poles[i]);
    }
    for (std::size_t i = 0; i < std::max(system_.zero_pairs.size(), system_.pole_pairs.size()); ++i) {
      if (i < system_.zero_pairs.size()) size *= pair_factor(numerator, system_.zero_pairs[i]);
      if (i < system_.pole_pairs.size()) size /= pair_factor(denominator, system_.pole_pairs[i]);
    }
    return size * numerator / denominator;
  }

 private:
  const ZeroPoleGain& system_;
  double order_;
  ExtendedComplex turn_;
};

// Ten times the ladder's own density, eight points per pole, and never fewer than forty per decade.
std::vector<double> log_offsets(std::size_t poles, double half_width) {
  constexpr double per_e_fold = 40 / std::numbers::ln10;
  const double wanted = std::max(40.0 * static_cast<double>(poles) + 40, std::max(240.0, per_e_fold * half_width));
  return FluxLaw(half_width).band_grid(static_cast<int>(wanted));
}

}  // namespace

ApproximationError measured_error(const ZeroPoleGain& system, double fractional_order, FrequencyBand band) {
  const Extended lower = std::log(static_cast<Extended>(band.lower));
  const Extended upper = std::log(static_cast<Extended>(band.upper));
  const Extended middle = (lower + upper) / 2;
  const std::size_t poles = system.poles.size() + 2 * system.pole_pairs.size();
  const auto half = log_offsets(poles, static_cast<double>((upper - lower) / 2));
  std::vector<Extended> log_omega;
  for (std::size_t i = half.size(); i-- > 1;) log_omega.push_back(middle - half[i]);
  for (const double offset : half) log_omega.push_back(middle + offset);
  log_omega.front() = lower;
  log_omega.back() = upper;

  const Ratio ratio(system, fractional_order);
  const BandError<Extended> largest =
      band_error(log_omega, [&](Extended log_frequency) { return ratio(std::exp(log_frequency)); });
  ApproximationError error;
  error.max_relative = static_cast<double>(largest.relative);
  error.omega_at_maximum = std::clamp(static_cast<double>(std::exp(largest.place)), band.lower, band.upper);
  error.max_decibels = static_cast<double>(largest.decibels);
  error.max_degrees = static_cast<double>(largest.degrees);
  error.grid_points = static_cast<int>(log_omega.size());
  return error;
}

}  // namespace frac::detail
