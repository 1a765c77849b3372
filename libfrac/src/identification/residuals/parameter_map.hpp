// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <optional>
#include <span>
#include <vector>

#include "formula/dimension_analysis.hpp"
#include "frac/identification/fit.hpp"
#include "frac/structure.hpp"

namespace frac::detail {

/// Magnitudes that make a fit dimensionless: typical |G|, typical omega, and the ranges the data span.
struct DataScale {
  double value, value_lower, value_upper;
  double omega, omega_lower, omega_upper;  // rad/s
};

/// Smooth map from the vector theta the solver works on to the parameters of the user.
///
///   positive coefficient     ln p = theta + v ln(value) + f(orders) ln(omega)
///   coefficient of any sign     p = theta value^v omega^f(orders)
///   order                       p = theta
///   delay                       p = theta/omega
///   above another one           ln p = ln other + theta, or p = other + theta value^v omega^f, theta >= 0
///   and below an upper limit    ln p = ln other + theta (ln limit - ln other), alike without logarithms, 0 <= theta <=
///   1
/// where value^v omega^f is the dimension of the parameter.  f depends (linearly) on the orders, so theta is the
/// parameter at the middle of the band, where it is least correlated with the orders.
class ParameterMap {
 public:
  /// @param blind_to_sign  magnitudes are fitted: outer gains are positive too
  /// @throws std::invalid_argument  unknown or repeated name, fixed with limits, lower > upper, start outside, not
  /// finite.
  ParameterMap(const Structure& structure, const std::vector<ParameterConstraint>& constraints, const DataScale& scale,
               bool blind_to_sign = false);

  /// How one free entry of theta is drawn and bounded.
  struct Free {
    std::size_t parameter;
    ParameterRole role;
    bool logarithmic;
    bool either_sign;
    bool bounded_by_user;
    double lower, upper;  // of theta
    double value_exponent;
    double frequency_exponent;                        // at the middle of the order ranges
    double least, most;                               // of the parameter; not finite where there is no limit
    std::optional<std::size_t> above = std::nullopt;  // entry of free() that this one is not below
  };

  [[nodiscard]] std::size_t parameter_count() const noexcept { return fixed_.size(); }
  [[nodiscard]] const std::vector<Free>& free() const noexcept { return free_; }
  [[nodiscard]] const DataScale& scale() const noexcept { return scale_; }
  /// Whether free entries times a factor to their value exponents multiply the whole model by the factor, at any
  /// orders.
  [[nodiscard]] bool scales_as_a_whole() const noexcept { return scales_as_a_whole_; }
  [[nodiscard]] bool is_fixed(std::size_t parameter) const { return !std::isnan(fixed_[parameter]); }

  /// Start values of the user; a free parameter without one is NaN.
  [[nodiscard]] const std::vector<double>& start() const noexcept { return start_; }

  [[nodiscard]] std::vector<double> to_user(std::span<const double> theta) const;
  /// Values that are not in the order the constraints want are exchanged.
  [[nodiscard]] std::vector<double> to_theta(std::span<const double> parameters) const;
  /// d parameter / d theta[free] where it is not 0; one pair may have several entries, which add up.
  struct Entry {
    std::size_t parameter, free;
    double derivative;
  };
  [[nodiscard]] std::vector<Entry> jacobian_entries(std::span<const double> parameters) const;
  /// Derivatives as a matrix, parameter_count() x free().size().
  [[nodiscard]] Eigen::MatrixXd jacobian(std::span<const double> parameters) const;
  /// The frequency exponent of free()[k] at given parameter values.
  [[nodiscard]] double frequency_exponent(std::size_t k, std::span<const double> parameters) const;
  /// free()[k] with frequency in units of the middle of the band, and its derivative by theta[k].
  [[nodiscard]] double centre_value(std::size_t k, std::span<const double> parameters) const;
  [[nodiscard]] double centre_value_by_theta(std::size_t k, std::span<const double> parameters) const;
  /// Its derivatives by every theta, which for one that is above another are several.
  [[nodiscard]] std::vector<Entry> centre_entries(std::size_t k, std::span<const double> parameters) const;

 private:
  /// Limits of those parameters that are orders, in the sequence of the parameters.
  struct OrderLimits {
    std::vector<double> lower, upper, middle;
  };
  /// At the middle orders, and with each of order_parameters_ raised by a half.
  struct Dimensions {
    std::vector<ParameterDimension> at_middle;
    std::vector<std::vector<ParameterDimension>> at_shifted_order;
  };

  [[nodiscard]] OrderLimits limits_of_orders(const Structure& structure,
                                             const std::vector<ParameterConstraint>& of) const;
  [[nodiscard]] Dimensions dimensions_of(const Structure& structure, const std::vector<double>& orders) const;
  [[nodiscard]] bool scales_as_a_whole(const Structure& structure, const std::vector<double>& orders,
                                       const Dimensions& dimensions) const;
  void tighten_orders(const std::vector<std::size_t>& lesser, OrderLimits& orders) const;
  void add_entry(std::size_t parameter, ParameterRole role, const ParameterConstraint& constraint,
                 const OrderLimits& orders, const Dimensions& dimensions);
  void limit_coefficient(const ParameterConstraint& constraint, const std::vector<double>& orders,
                         const Dimensions& dimensions, Free& entry);
  /// Entries that are above another get their limits from that one.
  void measure_from_lesser_ones(const Structure& structure, const std::vector<std::size_t>& lesser,
                                const std::vector<std::size_t>& entry_of);

  [[nodiscard]] double log_unit(std::size_t k, std::span<const double> parameters) const;
  [[nodiscard]] double value_at(std::size_t k, double theta, std::span<const double> parameters) const;
  [[nodiscard]] double theta_at(std::size_t k, std::span<const double> parameters) const;
  /// The amount that theta = 1 adds to the parameter that an entry is above, or to its logarithm.
  [[nodiscard]] double way_up(std::size_t k, std::span<const double> parameters) const;
  /// Derivatives of an entry times a factor, as those of another parameter.
  void add_slopes(std::size_t k, double factor, std::span<const double> parameters, std::size_t of_parameter,
                  std::vector<Entry>& entries) const;

  DataScale scale_;
  std::vector<double> fixed_;  // NaN: free
  std::vector<double> start_;
  std::vector<Free> free_;
  std::vector<std::size_t> order_parameters_;
  std::vector<std::vector<double>> slope_;  // [free][order parameter]: d frequency exponent / d order
  std::vector<double> intercept_;           // [free]: frequency exponent at all orders 0
  bool scales_as_a_whole_ = false;
  std::vector<std::size_t> sequence_;  // of free(): orders first, and each one after that which it is above
};

}  // namespace frac::detail
