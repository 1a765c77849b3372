// SPDX-License-Identifier: BSD-3-Clause
#include "inverse_laplace.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <numbers>
#include <utility>

#include "special/reciprocal_gamma.hpp"

namespace frac::detail {
namespace {

using Complex = std::complex<double>;
constexpr double pi = std::numbers::pi;
constexpr double eps = std::numeric_limits<double>::epsilon();
constexpr double infinity = std::numeric_limits<double>::infinity();

// e^-40 is a fiftieth of the rounding unit.
constexpr double accuracy = 40;

// e^{st} at ln s = zeta + offset.  The distance to the middle is formed without it, so that the phase of the middle,
// known to the rounding of s t, is common to a cluster.
Complex exponential(Complex zeta, Complex offset, double t) {
  // On the imaginary axis e^{st} neither grows nor decays, which the rounding of pi/2 would hide.
  const Complex middle = zeta.imag() == pi / 2 ? Complex(0, std::exp(zeta.real()) * t) : std::exp(zeta) * t;
  if (middle.real() < -700) return 0;
  if (offset == 0.0) return std::exp(middle);
  const double half_sine = std::sin(offset.imag() / 2);
  const Complex relative(std::expm1(offset.real()) * std::cos(offset.imag()) - 2 * half_sine * half_sine,
                         std::exp(offset.real()) * std::sin(offset.imag()));
  return std::exp(middle) * std::exp(middle * relative);
}

}  // namespace

// Up to s^-1/2, so that the integral along the cut converges quickly at the origin.
InverseLaplace::InverseLaplace(LaplaceImage image)
    : y(std::move(image)),
      cut(best_cut(y, 0.5, 1.3)),
      cut_step(2 * pi * 0.95 * cut.half_width / digits_beside_pole(accuracy, cut.half_width, largest_multiplicity(y))),
      early(y.origin_expansion(-0.5)),
      late(y.origin_expansion(1.5)) {}

// Node 0 has decayed to e^-60 at t = 1.
Complex InverseLaplace::log_s_of(long index) const {
  return {std::log(-60 / std::cos(cut.angle)) - static_cast<double>(index) * cut_step, cut.angle};
}

const InverseLaplace::Node& InverseLaplace::node(const LaplaceImage::OriginExpansion& expansion, Nodes& known,
                                                 long index) const {
  const auto computed = [&](long each) {
    const Complex zeta = log_s_of(each);
    const ScaledSum top = scaled_sum(expansion.remainder, zeta);
    const ScaledSum bottom = scaled_sum(y.denominator(), zeta);
    return Node{top.value / bottom.value, top.scale - bottom.scale,
                top.magnitude / std::abs(top.value) + bottom.magnitude / std::abs(bottom.value)};
  };
  if (known.list.empty()) known.first = index;
  while (index < known.first) known.list.push_front(computed(--known.first));
  auto end = known.first + static_cast<long>(known.list.size());
  while (index >= end) known.list.push_back(computed(end++));
  return known.list[static_cast<std::size_t>(index - known.first)];
}

// y(t) = sum c t^(-q-1)/Gamma(-q) over the origin's terms + residues between the cuts
//        + (1/pi) Im int_0^inf R(s) e^{st} ds along arg s = angle,
// the integral by the trapezoidal rule in ln|s|.
InverseLaplace::Estimate InverseLaplace::by_cut(double t) const {
  const double log_t = std::log(t);
  const bool is_late = log_t + y.lowest_corner() > 2;
  const LaplaceImage::OriginExpansion& expansion = is_late ? late : early;
  const auto& [origin, remainder] = expansion;
  double sum = 0;
  double rounding = 0;
  for (const PowerTerm& term : origin) {
    const double part = term.coefficient * reciprocal_gamma(-term.order) * std::exp((-term.order - 1) * log_t);
    sum += part;
    rounding += std::abs(part) * (2 + std::abs((term.order + 1) * log_t));
  }
  for (std::size_t k = 0; k < y.poles().clusters.size(); ++k) {
    const RootCluster& pole = y.poles().clusters[k];
    if (pole.log_s.imag() > cut.angle) continue;
    const double rate = 1 + std::exp(pole.log_s.real() + log_t);
    const LaplaceImage::Sum part = y.residue(
        k, [&](Complex zeta, Complex offset) { return exponential(zeta, offset, t); }, rate);
    sum += part.value;
    rounding += part.rounding;
  }
  if (!remainder.empty()) {
    const double corner = std::min(y.lowest_corner(), -log_t) - 3;
    double integral = 0;
    double magnitude = 0;
    // The same nodes for every instant, so that the image is evaluated once at each.
    const std::lock_guard<std::mutex> guard(lock);
    Nodes& known = is_late ? late_nodes : early_nodes;
    const auto first = static_cast<long>(std::floor(log_t / cut_step));
    for (long k = first; k < first + 1'000'000; ++k) {
      const Node& each = node(expansion, known, k);
      const Complex zeta = log_s_of(k);
      const Complex part = each.value * std::exp(std::exp(zeta + log_t) + zeta + each.scale);
      integral += part.imag();
      magnitude += std::abs(part) * (2 + std::exp(zeta.real() + log_t)) * (1 + 0.1 * each.cancelled);
      if (zeta.real() < corner && std::abs(part) < 1e-19 * magnitude) break;
    }
    sum += integral * cut_step / pi;
    rounding += magnitude * cut_step / pi;
  }
  return {sum, 3 * eps * rounding};
}

// s = w^2/t on the line Re w = c, as for the Mittag-Leffler function.
struct InverseLaplace::Parabola {
  double log_t;
  double line;       // c
  double step = 0;   // of the rule along the line
  double scale = 0;  // ln of the integrand at its saddle
  double inner = 0;  // radius where the shifted line stops short of the origin

  // The three errors of the rule are bounded with the terms of Y that dominate at each |s| and held e^-40 below the
  // integrand at its saddle.
  Parabola(const LaplaceImage& image, double t) : log_t(std::log(t)) {
    const double p = -(2 * image.slope(-log_t) + 1);
    const double saddle = std::sqrt(std::max(p, 1.0) / 2);
    line = std::max(1.6, saddle + (p > 2 ? 1 : 0));
    scale = log_size(image, saddle) + (p > 2 ? saddle * saddle : 0);
    step = 2 * pi * line / accuracy;
    for (int attempt = 0; attempt < 400; ++attempt, step *= 0.97) {
      const double rate = 2 * pi / step;
      double left = infinity;
      for (double w = line * 1e-3; w < line; w *= 1.2) {
        const double bound = log_size(image, w) - rate * (line - w);
        if (bound < left) {
          left = bound;
          inner = w;
        }
      }
      const double right_end = std::max(pi / step, line);
      const double right = right_end * right_end + log_size(image, right_end) - rate * (right_end - line);
      if (std::max(left, right) < scale - accuracy + 2) break;
    }
  }

  [[nodiscard]] double log_size(const LaplaceImage& image, double w) const {
    return image.log_magnitude(2 * std::log(w) - log_t) + std::log(w);
  }
};

InverseLaplace::Estimate InverseLaplace::along(const Parabola& parabola, double offset) const {
  const auto& [log_t, line, step, scale, inner] = parabola;
  Estimate result{0, 0};
  for (int k = 0; k < 2000; ++k) {
    const Complex w(line, (k + offset) * step);
    const Complex log_w = std::log(w);
    const double tail = (w * w).real() + parabola.log_size(y, std::abs(w));
    if (w.imag() > line && tail < scale - accuracy) break;
    const double weight = (k == 0 && offset == 0 ? 0.5 : 1) * 2 * step / pi;
    const Complex part = weight * y.value(2.0 * log_w - log_t, w * w + log_w - log_t);
    result.value += part.real();
    // The image comes from its logarithm, whose rounding grows with its size.
    const double log_image = y.log_magnitude(2 * log_w.real() - log_t);
    result.rounding += std::abs(part) * (4 + 2 * std::abs(w) + 0.5 * std::abs(log_image));
  }
  return result;
}

InverseLaplace::Estimate InverseLaplace::by_parabola(double t) const {
  const Parabola parabola(y, t);
  const double log_t = parabola.log_t, line = parabola.line, step = parabola.step;
  struct Pole {
    std::size_t index;
    Complex w;
  };
  std::vector<Pole> poles;
  for (std::size_t k = 0; k < y.poles().clusters.size(); ++k) {
    const RootCluster& pole = y.poles().clusters[k];
    if (pole.log_s.imag() - pole.spread >= pi) continue;
    const Complex w = std::exp((pole.log_s + log_t) / 2.0);
    if (std::abs(w) > parabola.inner) poles.push_back({k, w});
  }
  const auto nearest = [&](double offset) {
    double distance = infinity;
    for (const Pole& pole : poles) {
      const Complex at = (pole.w - line) / step - Complex(0, offset);
      distance = std::min(distance, std::abs(at - Complex(0, std::round(at.imag()))));
    }
    return distance;
  };
  const double offset = nearest(0.5) > 0.25 || nearest(0.5) >= nearest(0) ? 0.5 : 0;

  auto [sum, rounding] = along(parabola, offset);
  const double rate = 2 * pi / step;
  for (const Pole& pole : poles) {
    const double growth = std::norm(pole.w);
    const LaplaceImage::Sum part = y.residue(
        pole.index,
        [&](Complex zeta, Complex from_middle) {
          const Complex w = std::exp((zeta + from_middle + log_t) / 2.0);
          const Complex exponent = Complex(0, 2 * pi * offset) - rate * (w - line);
          if (exponent.real() > 300) return Complex(0);
          return exponential(zeta, from_middle, t) / (1.0 - (exponent.real() < -accuracy ? 0.0 : std::exp(exponent)));
        },
        1 + growth + (pole.w.real() - line < accuracy / rate ? 2 * rate * std::abs(pole.w) : 0));
    sum += part.value;
    rounding += part.rounding;
  }
  return {sum, 3 * eps * rounding};
}

InverseLaplace::Value InverseLaplace::operator()(double t) const {
  const Estimate by_residues = by_cut(t);
  const Estimate by_line = by_parabola(t);
  const bool has_residues = std::isfinite(by_residues.value);
  const bool has_line = std::isfinite(by_line.value);
  if (!has_residues && !has_line) return {by_residues.value > 0 ? infinity : -infinity, infinity, false};
  const Estimate& better =
      !has_line || (has_residues && by_residues.rounding < by_line.rounding) ? by_residues : by_line;
  const double difference = has_residues && has_line ? std::abs(by_residues.value - by_line.value) : infinity;
  if (!(difference <= 2 * (by_residues.rounding + by_line.rounding)) || !y.poles().complete) {
    return {better.value, std::max(difference, better.rounding), false};
  }
  return {better.value, better.rounding, true};
}

}  // namespace frac::detail
