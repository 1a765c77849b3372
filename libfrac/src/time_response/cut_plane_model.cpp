// SPDX-License-Identifier: BSD-3-Clause
#include "cut_plane_model.hpp"

#include <cmath>
#include <limits>

#include "formula/cut_plane.hpp"

namespace frac::detail {
namespace {

// ln s beyond everything that a formula in common units tells of, yet so near that its square, too, is a double.
constexpr double far = 140;
constexpr double infinity = std::numeric_limits<double>::infinity();

}  // namespace

std::optional<CutPlaneModel> CutPlaneModel::of(const Structure& structure, std::span<const double> parameters,
                                               Sensitivity sensitivity) {
  if (!is_analytic_in_cut_plane(structure.expression(), parameters)) return std::nullopt;
  CutPlaneModel model(structure, parameters, sensitivity);
  model.order_at_infinity_ = model.slope(far);
  model.order_at_origin_ = model.slope(-far);
  if (std::isnan(model.order_at_infinity_) || !std::isfinite(model.order_at_origin_)) return std::nullopt;
  return model;
}

CutPlaneModel::CutPlaneModel(const Structure& structure, std::span<const double> parameters, Sensitivity sensitivity)
    : program_(std::make_shared<const Program>(structure.expression())),
      parameters_(parameters.begin(), parameters.end()),
      gradient_(sensitivity == Sensitivity::all ? parameters.size() : 0),
      row_(1 + static_cast<Eigen::Index>(gradient_.size())) {}

const ComplexRow& CutPlaneModel::operator()(std::complex<double> zeta) {
  const double modulus = std::exp(zeta.real());
  std::complex<double> value;
  // What lies below the axis mirrors what lies above it.
  program_->evaluate_on_ray(parameters_, std::abs(zeta.imag()), {&modulus, 1}, {&value, 1}, gradient_);
  row_[0] = value;
  for (std::size_t p = 0; p < gradient_.size(); ++p) row_[static_cast<Eigen::Index>(p) + 1] = gradient_[p];
  if (zeta.imag() < 0) row_ = row_.conjugate().eval();
  return row_;
}

// Orders differ from what they are at such an s by less than the rounding of the slope.
double CutPlaneModel::slope(double log_s) {
  constexpr double step = 4, digits = 1e9;
  const double here = std::abs((*this)(log_s)[0]), beyond = std::abs((*this)(log_s + step)[0]);
  if (here == 0 || beyond == 0) return log_s > 0 ? -infinity : infinity;
  return std::round(std::log(beyond / here) / step * digits) / digits;
}

RealRow CutPlaneModel::at_infinity() {
  return order_at_infinity_ == 0 ? RealRow((*this)(far).real()) : RealRow::Zero(columns());
}

RealRow CutPlaneModel::at_origin() {
  return order_at_origin_ == 0 ? RealRow((*this)(-far).real()) : RealRow::Zero(columns());
}

}  // namespace frac::detail
