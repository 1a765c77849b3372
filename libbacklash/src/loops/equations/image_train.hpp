// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <complex>
#include <cstddef>
#include <memory>
#include <optional>
#include <vector>

#include "poles/laplace_image.hpp"

namespace backlash::detail {

/// A response that is the original of Y(s) e^{-delay s}, Y a ratio of sums of powers of s.
struct ImagePart {
  ImagePart(frac::detail::PowerProduct numerator, frac::detail::PowerProduct denominator, double of_delay);

  /// weight e^{rate t}, with its conjugate: a pole in the upper half plane or on the axis, or a share of several.
  struct Exponential {
    std::complex<double> rate;
    std::complex<double> weight;
  };
  std::shared_ptr<const frac::detail::LaplaceImage> image;
  std::vector<Exponential> poles;
  double delay;
};

/// The sum that a train of impulses leaves at one time after an impact, and its derivative by that time.
struct TrainWave {
  double value;
  double slope;
};

/// Three sums as regular_j + mean s^j, with what is singular at s = 0 in `mean`.
struct TrainSplit {
  std::array<std::complex<double>, 3> regular;
  std::complex<double> mean;
};

/// The sums of ImpulseTrain for such a response g: with its inversion as an integral over r along a hyperbola about the
/// branch cut, and residues of the poles beyond it,
///   sum_(l >= 1) (-1)^l g^(j)(l tau) z^-l = sum_nodes W r^j/(e^{(s - r) tau} - 1),   z = -e^{s tau},
/// and, for those of the points s + 2 pi j n/tau that lie on the side of the cut, the response Y s^j/tau there.
///
/// The hyperbola is r tau = 1 - sin(angle - j x), and the integral the trapezoidal rule in x at (n + 1/2) step.  A pole
/// of the integrand at x0 adds residue/(1 + e^{-2 pi j x0/step}) to the rule: all of its residue where it lies right of
/// the path, nothing where it lies left, and what the rule errs by between; the same holds of the points s + 2 pi j
/// n/tau.  So no pole has to stay away from the path, and the rule errs by e^{-2 pi d/step}, d the distance in angle of
/// the cut.
class ImageTrain {
 public:
  /// @param tau       half period, s
  /// @param earliest  shortest lag that counts, over tau
  ImageTrain(const ImagePart& part, double tau, double earliest) : ImageTrain(part, tau, earliest, fine) {}

  [[nodiscard]] std::array<std::complex<double>, 3> sums(std::complex<double> s) const;
  /// At z = -1, without the harmonic of frequency 0.
  [[nodiscard]] std::array<double, 3> sums_of_one_sign() const;
  /// The second of `sums` at z = 1.
  [[nodiscard]] static double rate(const ImagePart& part, double tau);
  /// The sum to 1e-6 of its parts, at a third of the cost; empty where they leave less than a thousandth.
  [[nodiscard]] static std::optional<double> rough_rate(const ImagePart& part, double tau);

  /// sum_(l >= 0) (-1)^l g(l tau + t) and its derivative, from t = earliest tau on.
  [[nodiscard]] TrainWave wave(double t) const;

  /// sum_(l >= 0) g^(j)(l tau + t), j = 0, 1, 2, without the harmonic of frequency 0, from t = earliest tau to tau.
  [[nodiscard]] std::array<double, 3> repeated(double t) const;

  /// `sums` without the response at s itself, and that.
  [[nodiscard]] TrainSplit split(std::complex<double> s) const;

 private:
  /// The trapezoidal rule: its step in x, and |Re r| t at which e^{r t} has decayed to nothing.
  struct Rule {
    double step, decayed;
  };
  // e^{-2 pi 0.6/step} is 4e-17, and 3e-7.
  static constexpr Rule fine{0.1, 38}, rough{0.25, 16};
  ImageTrain(const ImagePart& part, double tau, double earliest, Rule rule);

  struct Rate {
    double value;
    double size;  // sum of the sizes of its parts
  };
  [[nodiscard]] Rate rate() const;
  [[nodiscard]] std::complex<double> share_right(std::complex<double> parameter) const;
  [[nodiscard]] std::complex<double> share_left(std::complex<double> s) const;
  template <typename Visit>
  void for_each_turning_left(const Visit& visit) const;

  struct Node {
    std::complex<double> r;
    std::complex<double> weight;
    std::complex<double> growth;  // e^{r tau}
    std::complex<double> begun;   // weight e^{r age}, at the age of the first impulse that has begun
  };
  void choose_angle();
  void add_contour(double earliest);
  void add(std::complex<double> r, std::complex<double> weight);
  /// Age of the latest impulse whose answer has begun, a time t <= tau after the impact.
  struct Age {
    double seconds;
    double latest;  // l of it
  };
  [[nodiscard]] Age age_at(double t) const;
  [[nodiscard]] std::complex<double> parameter(std::complex<double> s) const;
  [[nodiscard]] std::array<std::complex<double>, 3> sums(std::complex<double> s, bool with_zero) const;

  const ImagePart* part_;
  double tau_;
  Rule rule_;
  double first_;  // l of the first impulse whose answer has begun just before the impact
  double age_;    // its age then, s
  double angle_ = 0;
  double least_sine_ = 0;  // of an angle at which a share left of the path is e^{-2 pi 6}
  std::vector<Node> nodes_;
  std::size_t begun_ = 0;  // of them, the first ones, that have not decayed at that age
};

}  // namespace backlash::detail
