// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <complex>
#include <optional>
#include <utility>
#include <vector>

namespace backlash::detail {

/// Exact flights of x' = A x.  Eigenvalues much faster than the motion are modes of their own; the slow ones, whose
/// eigenvectors may coincide (masses that fly freely are a chain of zeros), stay together, and their flight is a Taylor
/// polynomial that ends before it errs.
class LinearFlight {
 public:
  /// @param pace       rad/s, of the motion
  /// @param sizes      of the states, roughly
  /// @param most_skew  size of the left eigenvectors, over those of orthogonal modes, up to which fast modes are told
  ///                   apart; flights lose as many digits, and those of modes that stay together take shorter steps
  LinearFlight(const Eigen::MatrixXd& a, double pace, const Eigen::VectorXd& sizes, double most_skew = realised_skew);
  /// The `most_skew` for realised powers of s, which err by more than such flights.
  static constexpr double realised_skew = 1e6;

  /// A linear form of the state, as the modes see it.
  struct Form {
    Eigen::RowVectorXd slow;
    Eigen::RowVectorXcd fast;
  };
  [[nodiscard]] Form form(const Eigen::RowVectorXd& row) const;
  /// e^{A t}.
  [[nodiscard]] Eigen::MatrixXd transition(double t) const;

 private:
  friend class FlightPath;
  Eigen::VectorXd scale_;
  Eigen::MatrixXd slow_basis_;  // of scaled states, orthonormal
  Eigen::MatrixXd to_slow_;
  Eigen::MatrixXd slow_;
  Eigen::VectorXcd rates_;  // real ones, and of pairs the one above the axis
  Eigen::MatrixXcd fast_basis_;
  Eigen::MatrixXcd to_fast_;
};

/// One flight.
class FlightPath {
 public:
  FlightPath(const LinearFlight& flight, const Eigen::VectorXd& state);

  /// How long it holds, s.
  [[nodiscard]] double horizon() const noexcept { return horizon_; }
  [[nodiscard]] Eigen::VectorXd state(double t) const;

  /// A linear form along the path.
  class Signal {
   public:
    Signal(const FlightPath& path, const LinearFlight::Form& form, double sign, double offset);
    /// False where the state has left the range of numbers, so that nothing can be said.
    [[nodiscard]] bool is_finite() const;
    [[nodiscard]] double value(double t) const;
    [[nodiscard]] double rate(double t) const;
    /// The first instant in (from, to] at which it rises above 0; none is missed, as an interval is passed over only
    /// where bounds of the rate exclude it.
    [[nodiscard]] std::optional<double> first_rise(double from, double to) const;

   private:
    struct Range {
      double low, high;
    };
    [[nodiscard]] Range rates(double from, double to) const;
    [[nodiscard]] std::optional<double> first_rise(double from, double at_from, double to, int depth) const;
    [[nodiscard]] double root(double low, double high) const;

    const FlightPath& path_;
    std::vector<double> polynomial_;
    Eigen::VectorXcd fast_;  // with the weight 2 of pairs
    mutable int left_ = 0;   // intervals that are still looked at
  };
  /// sign times the form, plus an offset.
  [[nodiscard]] Signal signal(const LinearFlight::Form& form, double sign = 1, double offset = 0) const {
    return {*this, form, sign, offset};
  }

 private:
  // e^{rate t} of all modes; the last few instants are kept.
  [[nodiscard]] const Eigen::VectorXcd& decays(double t) const;

  const LinearFlight& flight_;
  Eigen::MatrixXd taylor_;
  Eigen::VectorXcd fast_;
  double horizon_;
  mutable std::vector<std::pair<double, Eigen::VectorXcd>> decays_;
  mutable std::size_t next_ = 0;
};

}  // namespace backlash::detail
