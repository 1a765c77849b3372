// SPDX-License-Identifier: BSD-3-Clause
#include "image_train.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace backlash::detail {
namespace {

using Complex = std::complex<double>;
constexpr double pi = std::numbers::pi;
// Step of the rule: singularities at least 0.22 off in angle leave an error of e^-31.
constexpr double step = 0.045;
// e^{r t} has decayed to nothing at |Re r| t of this size.
constexpr double decayed = 38;

// r = mu (1 - sin(angle - j x)), mu = 1/tau, in units of 1/tau.
Complex point_on(double angle, double x) {
  return {1 - std::sin(angle) * std::cosh(x), std::cos(angle) * std::sinh(x)};
}

Complex image_at(const frac::detail::LaplaceImage& image, Complex s) {
  return image.value(std::log(s));
}

}  // namespace

ImageTrain::ImageTrain(const ImagePart& part, double tau, double earliest) : ImageTrain(part, tau, earliest, 2) {}

ImageTrain::ImageTrain(const ImagePart& part, double tau, double earliest, std::size_t contours)
    : part_(part), tau_(tau), first_(std::floor(part.delay / tau) + 1), age_(first_ * tau - part.delay) {
  const double lag = std::max(1e-9, std::min(earliest, age_ / tau));
  contours_.push_back(contour(1, 1.25, lag));
  if (contours > 1) contours_.push_back(contour(0.45, 0.7, lag));
}

// Angle of the hyperbola through a point.
double ImageTrain::angle_of(Complex s) const {
  return -std::asin(s * tau_ - 1.0).real();
}

// At the angle in the range that is furthest from the poles, with the residues of those on its right.
ImageTrain::Contour ImageTrain::contour(double lowest_angle, double highest_angle, double earliest) const {
  const std::vector<frac::detail::RootCluster>& poles = part_.image->poles().clusters;
  Contour made{lowest_angle, {}};
  double widest = -1;
  constexpr int choices = 11;
  for (int i = 0; i < choices; ++i) {
    const double angle = lowest_angle + (highest_angle - lowest_angle) * i / (choices - 1);
    double clearance = 1;
    for (const frac::detail::RootCluster& pole : poles) {
      if (pole.log_s.imag() > pi) continue;
      clearance = std::min(clearance, std::abs(angle_of(std::exp(pole.log_s)) - angle));
    }
    if (clearance > widest + 1e-9) {
      widest = clearance;
      made.angle = angle;
    }
  }
  const auto add = [&](Complex r, Complex weight) {
    made.nodes.push_back({r, weight, std::exp(r * tau_), std::exp(r * age_)});
  };
  // (1/(2 pi j)) int Y e^{rt} dr, the upper half of the path; the lower one has the conjugate.
  const double end = std::acosh((decayed / earliest + 1) / std::sin(made.angle));
  for (double x = step / 2; x < end; x += step) {
    const Complex r = point_on(made.angle, x) / tau_;
    const Complex slope = Complex(-std::sin(made.angle) * std::sinh(x), std::cos(made.angle) * std::cosh(x)) / tau_;
    add(r, image_at(*part_.image, r) * slope * step / Complex(0, 2 * pi));
  }
  for (std::size_t k = 0; k < poles.size(); ++k) {
    const frac::detail::RootCluster& pole = poles[k];
    const Complex middle = std::exp(pole.log_s);
    if (pole.log_s.imag() > pi || angle_of(middle) > made.angle) continue;
    // A circle in ln s about the pole, or about all of a cluster: its upper half where it is its own conjugate.  A
    // single pole needs the residue alone.  About several ones the circle is kept small, as s may come near.
    const bool is_single = pole.multiplicity == 1;
    const double radius = std::max(std::min(0.4 * part_.image->clearance(k), is_single ? 0.2 : 0.02), 3 * pole.spread);
    constexpr int points = 64;
    Complex residue = 0;
    for (int i = 0; i < (pole.is_conjugate ? points / 2 : points); ++i) {
      const Complex offset = std::polar(radius, 2 * pi * (i + 0.5) / points);
      const Complex zeta = pole.log_s + offset;
      const Complex weight = part_.image->value(zeta, zeta) * offset / static_cast<double>(points);
      residue += weight;
      if (!is_single) add(std::exp(zeta), weight);
    }
    if (is_single) add(middle, pole.is_conjugate ? residue.real() : residue);
  }
  return made;
}

std::array<Complex, 3> ImageTrain::sums(Complex s) const {
  // Of the two contours the one further from s and what repeats it.
  const Contour* best = nullptr;
  double widest = -1;
  for (const Contour& each : contours_) {
    double clearance = 10;
    for (int n = -2; n <= 2; ++n) {
      clearance = std::min(clearance, std::abs(angle_of(s + Complex(0, 2 * pi * n / tau_)) - each.angle));
    }
    if (clearance > widest) {
      widest = clearance;
      best = &each;
    }
  }
  std::array<Complex, 3> total{};
  const Complex inverse_growth = std::exp(-s * tau_);
  const Complex begin = std::exp(-s * (first_ * tau_));
  const auto add = [&](Complex r, Complex weight, Complex growth, Complex begun) {
    Complex part = weight * begun / (1.0 - growth * inverse_growth);
    total[0] += part;
    part *= r;
    total[1] += part;
    total[2] += part * r;
  };
  for (const Node& node : best->nodes) {
    add(node.r, node.weight, node.growth, node.begun);
    add(std::conj(node.r), std::conj(node.weight), std::conj(node.growth), std::conj(node.begun));
  }
  for (Complex& each : total) each *= begin;
  for (int n = -2; n <= 2; ++n) {
    const Complex repeated = s + Complex(0, 2 * pi * n / tau_);
    if (!(angle_of(repeated) > best->angle)) continue;
    const Complex part = image_at(*part_.image, repeated) * std::exp(-repeated * part_.delay) / tau_;
    total[0] += part;
    total[1] += part * repeated;
    total[2] += part * repeated * repeated;
  }
  return total;
}

double ImageTrain::rate(const ImagePart& part, double tau) {
  return ImageTrain(part, tau, 1, 1).sums({0, pi / tau})[1].real();
}

ImageTrain::Wave ImageTrain::wave(double t) const {
  double age = age_ + t;
  double latest = first_;
  if (age > tau_) {
    age -= tau_;
    latest -= 1;
  }
  Complex value = 0;
  Complex slope = 0;
  const Contour& contour = contours_.front();
  for (const Node& node : contour.nodes) {
    const Complex part = node.weight * std::exp(node.r * age) / (1.0 + node.growth);
    value += part;
    slope += part * node.r;
  }
  const double sign = std::fmod(latest, 2) == 0 ? 2 : -2;
  Wave wave{sign * value.real(), sign * slope.real()};
  // Frequencies of the alternation on the side of the cut: those nearest to the origin, if any.
  const Complex turning(0, pi / tau_);
  if (angle_of(turning) > contour.angle) {
    const Complex part = 2.0 / tau_ * image_at(*part_.image, turning) * std::exp(turning * (t - part_.delay));
    wave.value += part.real();
    wave.slope += (part * turning).real();
  }
  return wave;
}

}  // namespace backlash::detail
