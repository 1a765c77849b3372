#include "residuals.hpp"

#include <cmath>
#include <limits>

namespace frac::detail {

bool Residuals::evaluate_all(std::span<const double> theta, std::vector<double>& residual) const {
  residual.resize(count());
  return evaluate(theta, 0, points(), residual.data(), nullptr);
}

double Residuals::cost(std::span<const double> theta) const {
  if (!evaluate_all(theta, scratch_)) return std::numeric_limits<double>::infinity();
  double sum = 0;
  for (const double residual : scratch_) sum += residual * residual;
  return std::isfinite(sum) ? sum : std::numeric_limits<double>::infinity();
}

FrequencyResiduals::FrequencyResiduals(const FrequencyResponseData& data, const Structure& structure,
                                       const Realisation& realisation, const ParameterMap& map,
                                       const ResidualRule& rule)
    : Residuals(map),
      data_(data),
      structure_(structure),
      realisation_(realisation),
      rule_(rule),
      value_(data.size()),
      gradient_(data.size() * map.parameter_count()) {}

bool FrequencyResiduals::evaluate(std::span<const double> theta, std::size_t first, std::size_t points,
                                  double* residual, double* jacobian_row_major) const {
  const std::vector<double> parameters = map().to_user(theta);
  const std::span omega(data_.omega().data() + first, points);
  const std::span value(value_.data(), points);
  const std::size_t all = map().parameter_count();
  if (jacobian_row_major) {
    structure_.response_and_gradient(parameters, omega, realisation_, value, std::span(gradient_.data(), points * all));
  } else {
    structure_.response(parameters, omega, realisation_, value);
  }

  for (std::size_t i = 0; i < points; ++i) {
    if (!rule_.residual(first + i, value[i], data_.value()[first + i], residual + i * per_point())) return false;
  }
  if (!jacobian_row_major) return true;

  RowMajorMatrix by_parameter(static_cast<Eigen::Index>(points * per_point()), static_cast<Eigen::Index>(all));
  for (std::size_t i = 0; i < points; ++i) {
    double* row = by_parameter.data() + i * per_point() * all;
    for (std::size_t j = 0; j < all; ++j) {
      rule_.derivative(first + i, value[i], gradient_[i * all + j], row + j,
                       per_point() == 2 ? row + j + all : nullptr);
    }
  }
  Eigen::Map<RowMajorMatrix> jacobian(jacobian_row_major, by_parameter.rows(),
                                      static_cast<Eigen::Index>(map().free().size()));
  jacobian.noalias() = by_parameter.lazyProduct(map().jacobian(parameters));
  return jacobian.allFinite();
}

double FrequencyResiduals::best_factor(std::span<const double> theta) const {
  std::vector<double> all;
  if (rule_.form == ResidualForm::phase || !evaluate_all(theta, all)) return 1;
  const bool logarithmic = rule_.form == ResidualForm::logarithmic || rule_.form == ResidualForm::log_magnitude;
  double product = 0, power = 0, sum = 0;
  for (std::size_t i = 0; i < points(); ++i) {
    const std::complex<double> datum = data_.value()[i];
    const double* residual = all.data() + i * per_point();
    sum += residual[0];
    const auto add = [&](double rest, double target) {
      product += (rest + target) * target;
      power += (rest + target) * (rest + target);
    };
    const double w = rule_.weight[i];
    switch (rule_.form) {
      case ResidualForm::imaginary:
        add(residual[0], w * datum.imag());
        break;
      case ResidualForm::real:
        add(residual[0], w * datum.real());
        break;
      case ResidualForm::cartesian:
        add(residual[0], w * datum.real());
        add(residual[1], w * datum.imag());
        break;
      default:
        add(residual[0], w * std::abs(datum));
    }
  }
  const double factor = logarithmic ? std::exp(-sum / static_cast<double>(points())) : product / power;
  return factor > 0 && std::isfinite(factor) ? factor : 1;
}

}  // namespace frac::detail
