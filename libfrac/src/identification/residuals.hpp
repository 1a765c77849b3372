#pragma once

#include <Eigen/Core>
#include <complex>
#include <span>
#include <vector>

#include "frac/identification/fit.hpp"
#include "parameter_map.hpp"

namespace frac::detail {

using RowMajorMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// `both` gives two residuals per frequency (real, imaginary), the other components one.
[[nodiscard]] std::size_t residuals_per_point(Component component);

/// The weighted residuals of a structure and their Jacobian by theta, as fit.hpp defines them.  Not thread-safe: it
/// keeps buffers between calls.
class Residuals {
 public:
  /// @throws std::invalid_argument  weight `given` without sigma, or zero data under relative weight, magnitude or
  /// phase.
  Residuals(const FrequencyResponseData& data, const Structure& structure, const FitOptions& options,
            const ParameterMap& map);

  [[nodiscard]] std::size_t points() const noexcept { return data_.size(); }
  [[nodiscard]] std::size_t per_point() const noexcept { return residuals_per_point(component_); }
  [[nodiscard]] std::size_t count() const noexcept { return points() * per_point(); }
  [[nodiscard]] const ParameterMap& map() const noexcept { return map_; }
  /// Root mean square of the weighted data.  evaluate() and cost() work in this unit, so that solver tolerances mean
  /// the same for data of 1e-18 and of 1e18.
  [[nodiscard]] double unit() const noexcept { return unit_; }

  /// Residuals of points [first, first + points) at theta, and their Jacobian unless null.  False where the model is
  /// not finite.
  bool evaluate(std::span<const double> theta, std::size_t first, std::size_t points, double* residual,
                double* jacobian_row_major) const;

  /// Sum of squares over all points; infinity where the model is not finite.
  [[nodiscard]] double cost(std::span<const double> theta) const;

  /// Factor by which the whole model is to be multiplied to come nearest the data; 1 where there is no positive one or
  /// where the component is blind to it (phase).
  [[nodiscard]] double best_factor(std::span<const double> theta) const;

 private:
  const FrequencyResponseData& data_;
  const Structure& structure_;
  const ParameterMap& map_;
  Component component_;
  Realisation realisation_;
  bool logarithmic_magnitude_;
  std::vector<double> weight_;
  double unit_;
  mutable std::vector<std::complex<double>> value_;
  mutable std::vector<std::complex<double>> gradient_;
  mutable std::vector<double> scratch_;
};

/// Weighted residuals of given model values, as fit.hpp defines them. Throws as the constructor above.
[[nodiscard]] std::vector<double> curve_residuals(const FrequencyResponseData& data,
                                                  const std::vector<std::complex<double>>& model, Component component,
                                                  Weight weight);

/// Root mean square of the weighted data (1 where the residual is a pure number: phase, relative). Throws as the
/// constructor.
[[nodiscard]] double residual_unit(const FrequencyResponseData& data, Component component, Weight weight);

}  // namespace frac::detail
