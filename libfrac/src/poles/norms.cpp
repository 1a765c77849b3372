// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <boost/math/quadrature/gauss_kronrod.hpp>
#include <cmath>
#include <complex>
#include <limits>
#include <numbers>
#include <vector>

#include "frac/stability.hpp"
#include "frequency_axis.hpp"
#include "laplace_image.hpp"
#include "principal_sheet.hpp"
#include "resonance_axis.hpp"

namespace frac {
namespace {

using detail::LaplaceImage;
using detail::RootCluster;
constexpr double pi = std::numbers::pi;
constexpr double infinity = std::numeric_limits<double>::infinity();

LaplaceImage image(const FractionalTransferFunction& model) {
  return {detail::numerator_of(model), detail::denominator_of(model)};
}

// A pole this close to the axis, in ln s, makes a resonance on which a double loses digits.
constexpr double narrow = 0.01;

// What G does beside the resonances that lie together, counted from one of them.
struct Resonance {
  detail::ResonanceAxis axis;
  double width;  // distance of the nearest of the poles from the axis, in ln s
};

// A stretch of u = ln omega, counted from a resonance where there is one.
struct Stretch {
  double from;
  double to;
  const Resonance* resonance;
};

// omega |G|^2.
class GainDensity {
 public:
  explicit GainDensity(const LaplaceImage& image) : axis_(image, 0) {}
  [[nodiscard]] double operator()(const Resonance* resonance, double u) const {
    if (resonance == nullptr) return std::exp(2 * axis_.log_gain(u) + u);
    const long double middle = resonance->axis.middle();
    return static_cast<double>(std::exp(2 * resonance->axis.log_gain(u) + middle + u));
  }

 private:
  detail::FrequencyAxis axis_;
};

struct NearAxis {
  double middle;
  double width;
};

// Poles between the ends, by rising frequency.
std::vector<NearAxis> poles_along_axis(const LaplaceImage& image, double first, double last) {
  std::vector<NearAxis> list;
  const auto add = [&](std::complex<double> log_s) {
    const double width = std::max(1e-12, std::abs(log_s.imag() - pi / 2));
    if (log_s.real() > first && log_s.real() < last) list.push_back({log_s.real(), width});
  };
  for (const RootCluster& pole : image.poles().clusters) {
    if (pole.members.empty()) add(pole.log_s);
    for (const detail::ClusterMember& member : pole.members) add(pole.log_s + member.offset);
  }
  std::sort(list.begin(), list.end(), [](const NearAxis& a, const NearAxis& b) { return a.middle < b.middle; });
  return list;
}

// The axis cut into stretches that grow with the distance from each pole beside it.  A point is placed relative to its
// resonance, since the rounding of ln omega may be as large as the resonance is wide.
class Stretches {
 public:
  Stretches(const LaplaceImage& image, double first, double last) {
    const std::vector<NearAxis> poles = poles_along_axis(image, first, last);
    for (const NearAxis& pole : poles) {
      if (pole.width >= narrow) continue;
      // Within that many widths one middle serves for both, and beyond it the rounding of a common end does not matter.
      constexpr double together = 1e4;
      if (resonances_.empty() ||
          pole.middle - resonances_.back().axis.middle() > together * std::min(pole.width, resonances_.back().width)) {
        resonances_.push_back({detail::ResonanceAxis(image, pole.middle), pole.width});
      }
    }
    std::vector<double> ends{first, last};
    for (const NearAxis& pole : poles) {
      ends.push_back(pole.middle);
      for (double offset = pole.width; offset < 2; offset *= 3) {
        for (const double end : {pole.middle - offset, pole.middle + offset}) {
          if (end > first && end < last) ends.push_back(end);
        }
      }
    }
    std::sort(ends.begin(), ends.end());
    for (std::size_t i = 0; i + 1 < ends.size(); ++i) {
      if (!(ends[i + 1] > ends[i])) continue;
      const Resonance* own = nearest(ends[i], ends[i + 1]);
      const double origin = own ? own->axis.middle() : 0;
      list_.push_back({ends[i] - origin, ends[i + 1] - origin, own});
    }
  }
  [[nodiscard]] const std::vector<Stretch>& list() const { return list_; }

 private:
  // The resonance that a stretch lies beside, if any.
  [[nodiscard]] const Resonance* nearest(double from, double to) const {
    constexpr double beside = 0.5;
    const Resonance* best = nullptr;
    double closest = beside;
    for (const Resonance& each : resonances_) {
      const double distance = std::abs((from + to) / 2 - each.axis.middle());
      if (distance < closest) {
        closest = distance;
        best = &each;
      }
    }
    return best;
  }

  std::vector<Resonance> resonances_;
  std::vector<Stretch> list_;
};

// Sum of the integrals over all stretches.  One is halved while the two rules that are compared on it differ by more
// than `tolerance` of the sum, and by more than the rounding of its density, which grows with |ln|G||.
double integral(const GainDensity& density, std::vector<Stretch> stretches, double tolerance, double log_size) {
  struct Part {
    double value;
    double error;
  };
  const auto part_of = [&](const Stretch& each) {
    double error = 0;
    const double value = boost::math::quadrature::gauss_kronrod<double, 31>::integrate(
        [&](double u) { return density(each.resonance, u); }, each.from, each.to, 0, 0, &error);
    return Part{value, error * (each.to - each.from) / 2};  // Boost gives that of the stretch mapped to (-1, 1)
  };
  std::vector<Part> parts;
  double whole = 0;
  for (const Stretch& each : stretches) {
    parts.push_back(part_of(each));
    whole += parts.back().value;
  }
  const double rounding = 8 * std::numeric_limits<double>::epsilon() * (4 + log_size);
  constexpr int most_parts = 20'000;
  double sum = 0;
  for (int count = 0; !stretches.empty(); ++count) {
    const Stretch each = stretches.back();
    const Part part = parts.back();
    stretches.pop_back();
    parts.pop_back();
    const double middle = each.from + (each.to - each.from) / 2;
    const bool is_done = part.error <= std::max(tolerance * whole, rounding * part.value);
    if (is_done || count > most_parts || !(each.from < middle && middle < each.to)) {
      sum += part.value;
      continue;
    }
    for (const Stretch& half : {Stretch{each.from, middle, each.resonance}, Stretch{middle, each.to, each.resonance}}) {
      stretches.push_back(half);
      parts.push_back(part_of(half));
    }
  }
  return sum;
}

}  // namespace

PeakGain h_infinity_norm(const FractionalTransferFunction& model) {
  if (detail::analyse_principal_sheet(model).stability != Stability::stable)
    return {infinity, std::numeric_limits<double>::quiet_NaN()};
  const LaplaceImage y = image(model);
  const detail::FrequencyAxis axis(y, 0);
  const auto limit = [](double order, const PowerTerm& top, const PowerTerm& bottom) {
    return order == 0 ? std::abs(top.coefficient / bottom.coefficient) : 0.0;
  };
  PeakGain best{limit(detail::order_at_origin(model), model.numerator().back(), model.denominator().back()), 0};
  const double high = limit(detail::order_at_infinity(model), model.numerator().front(), model.denominator().front());
  if (high > best.gain) best = {high, infinity};
  // Up to where |G| is monotone towards its limits.
  constexpr double widest = 690;
  double first = std::min(y.lowest_corner(), 0.0) - 12;
  const detail::AxisLimit low(y, detail::AxisLimit::End::low);
  while (first > -widest && !low.gain_is_monotone(first)) first -= 2;
  double last = y.highest_corner() + 12;
  const detail::AxisLimit end(y, detail::AxisLimit::End::high);
  while (last < widest && !end.gain_is_monotone(last)) last += 2;
  const std::vector<double> points = axis.breakpoints(first, last);
  const auto slope = [&](double u) { return axis.log_slope(u).real(); };
  for (std::size_t i = 0; i + 1 < points.size(); ++i) {
    if (!(slope(points[i]) > 0 && slope(points[i + 1]) <= 0)) continue;
    const double u = detail::bisected(slope, points[i], points[i + 1]);
    // Evaluates in more digits, because a double loses some beside a pole next to the axis.
    const double gain = static_cast<double>(std::exp(detail::ResonanceAxis(y, u).log_gain(0)));
    if (gain > best.gain) best = {gain, std::exp(u)};
  }
  return best;
}

double h2_norm(const FractionalTransferFunction& model) {
  const double origin = 2 * detail::order_at_origin(model) + 1;
  const double far = 2 * detail::order_at_infinity(model) + 1;
  const Stability stability = detail::analyse_principal_sheet(model).stability;
  const bool has_stable_poles = stability == Stability::stable || stability == Stability::integrating;
  if (!has_stable_poles || origin <= 0 || far >= 0) return infinity;
  const LaplaceImage y = image(model);
  // |G|^2 omega falls as omega^origin and omega^far outwards: 1e-17 of it is left beyond the ends.
  const double first = y.lowest_corner() - 3 - 40 / origin;
  const double last = y.highest_corner() + 3 - 40 / far;
  const GainDensity density(y);
  const Stretches stretches(y, first, last);
  constexpr double tolerance = 1e-14;
  const double log_size = std::abs(y.log_magnitude(y.lowest_corner())) + std::abs(y.lowest_corner());
  return std::sqrt(integral(density, stretches.list(), tolerance, log_size) / pi);
}

}  // namespace frac
