// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "frac/identification/time_fit.hpp"
#include "identification/residuals/time_residuals.hpp"
#include "projection.hpp"

namespace frac::detail {

struct PoleFactor;
struct RationalShape;

/// The outputs of a record that tell members of a family apart, in units of their rms: what their residuals are.
[[nodiscard]] RecordRows record_rows(const TimeResponseData& data, const TimeFitOptions& options);

/// What rational functions answer to the input of a record, at its observed outputs.
class RecordAnswers {
 public:
  /// @param earlier_input  whether the record may start in motion
  /// @param centre_omega   the unit of frequencies, rad/s
  RecordAnswers(const TimeResponseData& data, bool earlier_input, double centre_omega);

  /// The answers of functions whose poles are those of a shape, known by their values at s, and
  /// behind them motions that fade by themselves, one for each pole, if the record may start in motion.  Not finite
  /// where an answer outgrows a double or a function passes derivatives of the input on.
  /// @param log_s  over the band; s in units of its middle
  [[nodiscard]] Eigen::MatrixXcd columns(const RationalShape& shape, const Eigen::VectorXcd& log_s,
                                         const Eigen::MatrixXcd& values) const;
  /// The derivatives of an output by what acts nonlinearly in a shape.
  /// @param model         values of its rational function at s
  /// @param values        those of the derivatives
  /// @param coefficients  of columns()
  [[nodiscard]] Eigen::MatrixXcd derivatives(const RationalShape& shape, const Eigen::VectorXcd& log_s,
                                             const Eigen::VectorXcd& model, const Eigen::MatrixXcd& values,
                                             const Eigen::VectorXd& coefficients) const;
  [[nodiscard]] std::size_t free_motion_count(const RationalShape& shape) const;

 private:
  Eigen::Index outputs_;
  double centre_;
  RecordResponse response_;
  std::optional<EventResponse> step_;  // from the first sample on
};

}  // namespace frac::detail
