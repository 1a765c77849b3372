// SPDX-License-Identifier: BSD-3-Clause
#include "cut_plane_model.hpp"

#include <cmath>

#include "formula/cut_plane.hpp"

namespace frac::detail {

std::optional<CutPlaneModel> CutPlaneModel::of(const Structure& structure, std::span<const double> parameters,
                                               Sensitivity sensitivity) {
  if (!is_analytic_in_cut_plane(structure.expression(), parameters)) return std::nullopt;
  const std::optional<PowerTerm> last = leading_term(structure.expression(), parameters, Limit::infinity);
  const std::optional<PowerTerm> first = leading_term(structure.expression(), parameters, Limit::origin);
  CutPlaneModel model(structure, parameters, sensitivity);
  model.order_at_infinity_ = last ? last->order : model.slope(Limit::infinity);
  model.order_at_origin_ = first ? first->order : std::round(model.slope(Limit::origin));
  // What terms that cancel leave at infinity is known where it vanishes.
  constexpr double vanishing = -0.01;
  if (!last && !(model.order_at_infinity_ <= vanishing)) return std::nullopt;
  if (std::isnan(model.order_at_origin_)) return std::nullopt;
  return model;
}

CutPlaneModel::CutPlaneModel(const Structure& structure, std::span<const double> parameters, Sensitivity sensitivity)
    : structure_(structure),
      program_(std::make_shared<const Program>(structure.expression())),
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

// At the origin the slope tells how often the model integrates.  One time too many costs nothing: what is integrated is
// the model times as many s.
double CutPlaneModel::slope(Limit at) {
  // So far out one term leads in common units, and of terms in s that cancel there half of the digits are left.
  constexpr double far = 20, step = 2;
  const double sign = at == Limit::infinity ? 1 : -1;
  const double here = std::abs((*this)(sign * far)[0]), beyond = std::abs((*this)(sign * (far + step))[0]);
  if (here == 0 || beyond == 0) return -sign;
  return sign * std::log(beyond / here) / step;
}

RealRow CutPlaneModel::limit(Limit which) const {
  RealRow row = RealRow::Zero(columns());
  const auto value = [&](const std::vector<double>& parameters) {
    const std::optional<PowerTerm> term = leading_term(structure_.expression(), parameters, which);
    return term && std::abs(term->order) <= 1e-12 ? term->coefficient : 0;
  };
  row[0] = value(parameters_);
  // A leading coefficient takes few operations, so that differences tell its derivatives to 1e-10.
  for (Eigen::Index p = 1; p < columns(); ++p) {
    std::vector<double> less = parameters_, more = parameters_;
    const auto at = static_cast<std::size_t>(p - 1);
    const double step = 1e-5 * (parameters_[at] == 0 ? 1 : std::abs(parameters_[at]));
    less[at] -= step;
    more[at] += step;
    row[p] = (value(more) - value(less)) / (2 * step);
  }
  return row;
}

}  // namespace frac::detail
