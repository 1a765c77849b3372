// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <complex>
#include <memory>
#include <vector>

#include "poles/laplace_image.hpp"

namespace backlash::detail {

/// A response that is the original of Y(s) e^{-delay s}, Y a ratio of sums of powers of s.
struct ImagePart {
  std::shared_ptr<const frac::detail::LaplaceImage> image;
  double delay;
};

/// The sums of ImpulseTrain for such a response g: with its inversion as an integral over r along a hyperbola about the
/// branch cut, and residues of the poles beyond it,
///   sum_(l >= 1) (-1)^l g^(j)(l tau) z^-l = sum_nodes W r^j/(e^{(s - r) tau} - 1),   z = -e^{s tau},
/// and, for those of the points s + 2 pi j n/tau that lie on the side of the cut, the response Y s^j/tau there.  On r =
/// mu (1 - sin(angle - j x)) the trapezoidal rule in x errs by e^{-2 pi d/step}, d the distance of the next
/// singularity's angle.
class ImageTrain {
 public:
  /// @param tau       half period, s
  /// @param earliest  shortest lag that counts, over tau
  ImageTrain(const ImagePart& part, double tau, double earliest);

  [[nodiscard]] std::array<std::complex<double>, 3> sums(std::complex<double> s) const;
  /// The second of them at z = 1.
  [[nodiscard]] static double rate(const ImagePart& part, double tau);

  /// sum_(l >= 0) (-1)^l g(l tau + t) and its derivative, from t = earliest tau on.
  struct Wave {
    double value;
    double slope;
  };
  [[nodiscard]] Wave wave(double t) const;

 private:
  struct Node {
    std::complex<double> r;
    std::complex<double> weight;
    std::complex<double> growth;  // e^{r tau}
    std::complex<double> begun;   // e^{r age}, at the age of the first impulse that has begun
  };
  struct Contour {
    double angle;
    std::vector<Node> nodes;
  };
  ImageTrain(const ImagePart& part, double tau, double earliest, std::size_t contours);
  [[nodiscard]] Contour contour(double lowest_angle, double highest_angle, double earliest) const;
  [[nodiscard]] double angle_of(std::complex<double> s) const;

  ImagePart part_;
  double tau_;
  double first_;  // l of the first impulse whose answer has begun just before the impact
  double age_;    // its age then, s
  std::vector<Contour> contours_;
};

}  // namespace backlash::detail
