// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <complex>
#include <vector>

#include "backlash/loops/control_loop.hpp"
#include "image_train.hpp"
#include "power_train.hpp"

namespace backlash::detail {

/// coefficient (t - delay)^exponent for t > delay.
struct PowerPart {
  double coefficient;
  double exponent;
  double delay;
};

/// The answer of the gap to an impact: a unit impulse on mass 1 and its opposite on mass 2 make x2 - x1 = -g(t), with
/// the controller's answer in it.  With the load measured and a controller that is a sum of powers g is one too;
/// otherwise originals of images are added, and of bodies that are no free masses too.
struct ImpulseAnswer {
  std::vector<PowerPart> parts;
  std::vector<ImagePart> images;  // the last one has the poles of the others
  double jump;                    // 1/M1 + 1/M2: g' right after the impulse
};
/// @throws std::invalid_argument  dead time with the driven body measured: g has then no image of finitely many powers;
///                                poles that could not be counted.
[[nodiscard]] ImpulseAnswer gap_response(const ControlLoop& loop);
/// Without a controller.
[[nodiscard]] ImpulseAnswer gap_response(const LinearBodies& bodies);

/// Alternating impulses at all t = l tau, l = ..., -1, 0: what is left of them.
class ImpulseTrain {
 public:
  /// @param half_period  tau, s, > 0
  ImpulseTrain(const ImpulseAnswer& response, double half_period);

  /// sum_(l >= 1) (-1)^l g^(j)(l tau) z^-l, j = 0, 1, 2, at z = -e^{s tau}: outside the unit circle where Re s > 0, z =
  /// 1 at s = j pi/tau, and z = -1, where the sums are singular, at s = 0.  Continued analytically to |Im s| <= pi/tau
  /// but the negative real axis.
  [[nodiscard]] std::array<std::complex<double>, 3> sums(std::complex<double> s) const {
    return sums(TrainPoint(-s * tau_));
  }
  /// At u = -s tau.
  [[nodiscard]] std::array<std::complex<double>, 3> sums(const TrainPoint& point) const;

  /// sum_(l >= 1) g^(j)(l tau), j = 0, 1, 2, without the mean of what such a train does: without the harmonic of
  /// frequency 0.
  [[nodiscard]] std::array<double, 3> sums_of_one_sign() const;

  /// sum_(l >= 0) (-1)^l g(l tau + t) and its derivative by t, 0 < t < tau.
  [[nodiscard]] TrainWave wave(double t) const;

  /// sum_(l >= 0) g^(j)(l tau + t), j = 0, 1, 2, for 0 < t <= tau, without the harmonic of frequency 0: what impulses
  /// of one sign leave a time t after the last one; at tau just before the next.
  [[nodiscard]] std::array<double, 3> repeated(double t) const;

  /// sums_j(s) in parts; |s tau| < 2 pi.
  [[nodiscard]] TrainSplit split(std::complex<double> s) const;

  [[nodiscard]] double half_period() const noexcept { return tau_; }
  /// Real parts of the poles of g's image, times tau, each as often as it counts, conjugates too.
  [[nodiscard]] const std::vector<double>& growth_rates() const noexcept { return growth_rates_; }
  [[nodiscard]] bool is_sum_of_powers() const noexcept { return images_.empty(); }
  /// g has no fractional power: the sums have poles where else they have a cut.
  [[nodiscard]] bool has_whole_powers() const noexcept { return has_whole_powers_; }

 private:
  struct Part {
    double coefficient;  // at the scale of tau
    double exponent;
    int first;      // l of the first impulse whose answer has begun just before the impact
    double offset;  // its age then over tau, in (0, 1]
    PowerTrain train;
    // sum_(n >= 1) (-1)^n (n + v)^exponent in powers of v - 1/2; its radius of convergence is 3/2.
    std::vector<double> older;
  };
  double tau_;
  std::vector<Part> parts_;
  std::vector<ImageTrain> images_;
  bool has_whole_powers_;
  std::vector<double> growth_rates_;
};

/// sum_(l >= 1) (-1)^l g'(l tau): the cheap part of `sums` at z = 1 that decides the frequency of a cycle.
[[nodiscard]] double rate_before_impact(const ImpulseAnswer& response, double half_period);
/// The answer to about 1e-10 of its largest part, at a tenth of the cost where g is a sum of powers; to 1e-3 of it
/// where g has images, at a third of the cost.
[[nodiscard]] double rough_rate_before_impact(const ImpulseAnswer& response, double half_period);

}  // namespace backlash::detail
