#pragma once

#include <Eigen/Core>
#include <complex>
#include <span>
#include <vector>

#include "parameter_map.hpp"
#include "residual_rule.hpp"

namespace frac::detail {

using RowMajorMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// The residuals of a structure and their Jacobian by theta, in units of the rule.  Not thread-safe: it keeps buffers
/// between calls.
class Residuals {
 public:
  Residuals(const FrequencyResponseData& data, const Structure& structure, const Realisation& realisation,
            const ParameterMap& map, const ResidualRule& rule);

  [[nodiscard]] std::size_t points() const noexcept { return data_.size(); }
  [[nodiscard]] std::size_t per_point() const noexcept { return rule_.per_point(); }
  [[nodiscard]] std::size_t count() const noexcept { return points() * per_point(); }
  [[nodiscard]] const ParameterMap& map() const noexcept { return map_; }
  [[nodiscard]] const FrequencyResponseData& data() const noexcept { return data_; }
  [[nodiscard]] const Structure& structure() const noexcept { return structure_; }
  [[nodiscard]] const ResidualRule& rule() const noexcept { return rule_; }

  /// Residuals of points [first, first + points) at theta, and their Jacobian unless null.  False where the model is
  /// not finite.
  bool evaluate(std::span<const double> theta, std::size_t first, std::size_t points, double* residual,
                double* jacobian_row_major) const;

  /// Sum of squares over all points; infinity where the model is not finite.
  [[nodiscard]] double cost(std::span<const double> theta) const;

  /// Costs below this are rounding: all of them are zero.
  [[nodiscard]] double rounding_cost() const noexcept { return static_cast<double>(count()) * 1e-28; }

  /// Factor by which the whole model is to be multiplied to come nearest the data; 1 where there is no positive one or
  /// where the residuals are blind to it (phase).
  [[nodiscard]] double best_factor(std::span<const double> theta) const;

 private:
  const FrequencyResponseData& data_;
  const Structure& structure_;
  const Realisation& realisation_;
  const ParameterMap& map_;
  const ResidualRule& rule_;
  mutable std::vector<std::complex<double>> value_;
  mutable std::vector<std::complex<double>> gradient_;
  mutable std::vector<double> scratch_;
};

}  // namespace frac::detail
