// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <complex>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "exponential_terms.hpp"
#include "formula/leading_term.hpp"
#include "formula/program.hpp"
#include "formula/reduction.hpp"
#include "frac/structure.hpp"

namespace frac::detail {

/// A formula that is no ratio of sums of powers, at parameter values where all its singularities lie on the negative
/// real axis: every ray beside it is a cut along which the response can be integrated.
class CutPlaneModel {
 public:
  /// Empty where other singularities are possible (is_analytic_in_cut_plane()), or where it is not known what it tends
  /// to at infinity.
  [[nodiscard]] static std::optional<CutPlaneModel> of(const Structure& structure, std::span<const double> parameters,
                                                       Sensitivity sensitivity);

  /// It tends to a multiple of s^order there; infinite where it grows or vanishes faster.
  [[nodiscard]] double order_at_infinity() const noexcept { return order_at_infinity_; }
  [[nodiscard]] double order_at_origin() const noexcept { return order_at_origin_; }

  /// One for the value and one for each derivative.
  [[nodiscard]] Eigen::Index columns() const noexcept { return row_.size(); }
  /// At s = e^zeta, |Im zeta| < pi.
  [[nodiscard]] const ComplexRow& operator()(std::complex<double> zeta);
  /// What it tends to there, and its derivatives; 0 where it tends to 0, and where it does not stay finite.
  [[nodiscard]] RealRow at_infinity() const { return limit(Limit::infinity); }
  [[nodiscard]] RealRow at_origin() const { return limit(Limit::origin); }

 private:
  CutPlaneModel(const Structure& structure, std::span<const double> parameters, Sensitivity sensitivity);
  [[nodiscard]] RealRow limit(Limit which) const;
  /// d ln|G| / d ln s towards the limit, where leading terms cancel.
  [[nodiscard]] double slope(Limit at);

  Structure structure_;
  std::shared_ptr<const Program> program_;
  std::vector<double> parameters_;
  std::vector<std::complex<double>> gradient_;
  ComplexRow row_;
  double order_at_infinity_ = 0, order_at_origin_ = 0;
};

}  // namespace frac::detail
