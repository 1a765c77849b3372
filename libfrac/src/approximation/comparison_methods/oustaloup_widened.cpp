// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <boost/math/tools/minima.hpp>
#include <cmath>
#include <cstddef>
#include <numbers>

#include "approximation/flux_law.hpp"
#include "approximation/unit_design.hpp"

namespace frac::detail {
namespace {

// Largest |ln(H/(j omega)^order)| at the given frequencies.
double largest_log_error(const UnitDesign& design, double order, const std::vector<double>& log_omega) {
  double largest = 0;
  for (const double t : log_omega) {
    const double omega = std::exp(t);
    std::complex<double> product =
        std::polar(static_cast<double>(design.gain) * std::pow(omega, -order), -order * std::numbers::pi / 2);
    for (std::size_t i = 0; i < design.poles.size(); ++i) {
      const double pole = static_cast<double>(design.poles[i]);
      const double zero = static_cast<double>(design.zeros[i]);
      const double square = pole * pole + omega * omega;
      product *= std::complex<double>((zero * pole + omega * omega) / square, omega * (pole - zero) / square);
    }
    largest = std::max(largest, std::abs(std::log(product)));
  }
  return largest;
}

}  // namespace

// A wider band lessens the error at the edges, about order exp(-margin), and coarsens the ladder, whose ripple is
// 2 sin(pi order) exp(-pi^2 poles/(width + 2 margin)): one falls, the other rises, and the larger of them has a single
// minimum.
UnitDesign oustaloup_widened_design(const UnitProblem& problem, int poles) {
  const auto grid = FluxLaw(problem.half_width).band_grid(std::max(4 * poles + 4, 40));
  const auto widened = [&](double margin) {
    return oustaloup_design({problem.order, problem.half_width + margin}, poles);
  };
  const auto error = [&](double margin) { return largest_log_error(widened(margin), problem.order, grid); };
  constexpr double widest = 37;  // exp(-37) = 1e-16
  constexpr int bits = 12;       // of the margin; the error is as flat as that around its minimum
  const double margin = boost::math::tools::brent_find_minima(error, 0.0, widest, bits).first;
  UnitDesign design = widened(margin);
  design.parameters.emplace_back("margin_decades", margin / std::numbers::ln10);
  return design;
}

}  // namespace frac::detail
