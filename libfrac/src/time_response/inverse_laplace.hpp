// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <complex>
#include <deque>
#include <mutex>

#include "branch_cut.hpp"
#include "poles/laplace_image.hpp"

namespace frac::detail {

/// The original of an image at single instants t > 0 by two methods that judge each other: residues with the integral
/// along a turned branch cut, and a parabola that scales with 1/t.
/// Values along the cut are kept for later instants, under a lock: any number of threads may ask.
class InverseLaplace {
 public:
  explicit InverseLaplace(LaplaceImage image);

  [[nodiscard]] const LaplaceImage& image() const noexcept { return y; }

  struct Value {
    double value;           // infinite beyond the range of a double
    double error_estimate;  // from rounding, or the difference of the methods
    bool confirmed;         // they agree within their rounding and no pole is missing
  };
  [[nodiscard]] Value operator()(double t) const;

 private:
  struct Estimate {
    double value;
    double rounding;
  };
  [[nodiscard]] Estimate by_cut(double t) const;
  struct Parabola;
  [[nodiscard]] Estimate by_parabola(double t) const;
  // The trapezoidal rule, without poles; `offset` of the nodes from the real axis, in steps.
  [[nodiscard]] Estimate along(const Parabola& parabola, double offset) const;

  // What is left of the image beside its terms at the origin, over e^scale, at one node of the rule along the cut.
  struct Node {
    std::complex<double> value;
    double scale;
    double cancelled;  // rounding of the remainder and of the denominator, in their units
  };
  // Nodes by falling |s| from the index `first` on; an index is the same ln s for every instant.
  struct Nodes {
    long first = 0;
    std::deque<Node> list;
  };
  [[nodiscard]] std::complex<double> log_s_of(long index) const;
  [[nodiscard]] const Node& node(const LaplaceImage::OriginExpansion& expansion, Nodes& known, long index) const;

  LaplaceImage y;
  BranchCut cut;
  double cut_step;  // of the rule along the cut
  LaplaceImage::OriginExpansion early;
  // With more terms, those that vanish for t > 0 among them: late responses to relative accuracy.
  LaplaceImage::OriginExpansion late;
  mutable std::mutex lock;
  mutable Nodes early_nodes;
  mutable Nodes late_nodes;
};

}  // namespace frac::detail
