// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "formula/reduction.hpp"
#include "frac/time_response/respond.hpp"

namespace frac::detail {

class CutPlaneModel;
struct EventPlan;

/// Response of a ratio of sums of powers at any instants to an input given at any instants, with its derivatives by the
/// parameters.  With H = G s^m finite or integrable at the origin, m whole integrations,
///   step response of H = c + Re sum_k w_k (e^{r_k t} - 1),   w_k = a_k H(s_k):
/// the nodes s_k = r_k are those of the trapezoidal rule along the branch cut and on a circle about each pole, and a_k
/// depends on them alone.  So every state is the same for H and for dH/d theta, and the derivative of the response is
/// exact: that of the weights, poles included, without a derivative of the poles and without differences.
class EventResponse {
 public:
  struct Knot {
    double time;
    double jump;   // of the input
    double slope;  // change of the input's slope
  };

  /// @param input_time  rising; from rest before the first.   @param output_time  rising, not before the first input.
  EventResponse(std::vector<double> input_time, std::vector<double> input, Hold hold, std::vector<double> output_time);

  struct Result {
    Eigen::VectorXd value;     // one per output instant
    Eigen::MatrixXd gradient;  // a column per parameter; no columns without sensitivities
  };
  /// False where the model is zero, improper, has poles that could not be counted, or outgrows a double.
  /// @param tolerance  of the step response, relative to the sum of its parts
  [[nodiscard]] bool evaluate(const RatioOfPowerSums& ratio, double tolerance, Result& result) const;
  /// The same of a formula without poles off the negative axis: the nodes lie along a cut before it.
  [[nodiscard]] bool evaluate(CutPlaneModel model, double tolerance, Result& result) const;
  /// The values alone, from the sum of exponentials that filters use: a product keeps its factors, and poles that
  /// coincide cost no digits.
  [[nodiscard]] bool evaluate(const FractionalTransferFunction& model, double tolerance, Result& result) const;

 private:
  // Orders of the model at infinity and at the origin; empty where it is improper or integrates too often.
  [[nodiscard]] std::optional<EventPlan> planned(double high_order, double low_order, double delay) const;
  [[nodiscard]] double shortest_lag(double delay) const;
  /// Nothing of the input has come by the last output.
  void set_nothing(Eigen::Index columns, Result& result) const;

  std::vector<Knot> knots_;
  std::vector<double> output_time_;
  bool has_slopes_ = false;
};

}  // namespace frac::detail
