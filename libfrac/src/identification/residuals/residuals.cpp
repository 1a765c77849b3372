// SPDX-License-Identifier: BSD-3-Clause
#include "residuals.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/wide_vectors.hpp"
#include "frac/cancellation.hpp"
#include "identification/data/physical_properties.hpp"
#include "linear_start.hpp"

namespace frac::detail {

namespace {

FRACFIT_INLINE inline void add_multiple(double factor, const double* from, std::size_t count, double* sum) {
  for (std::size_t i = 0; i < count; ++i) sum[i] += factor * from[i];
}

void add_multiple(double factor, const std::complex<double>* from, std::span<std::complex<double>> sum) {
  // Complex numbers are pairs of reals in memory.
  with_wide_vectors([&]() FRACFIT_INLINE {
    add_multiple(factor, reinterpret_cast<const double*>(from), 2 * sum.size(), reinterpret_cast<double*>(sum.data()));
  });
}

}  // namespace

bool Residuals::evaluate_all(std::span<const double> theta, std::vector<double>& residual) const {
  throw_if_cancelled();
  residual.resize(count());
  return evaluate(theta, residual.data(), nullptr);
}

double Residuals::cost(std::span<const double> theta) const {
  if (!evaluate_all(theta, scratch_)) return std::numeric_limits<double>::infinity();
  double sum = 0;
  for (const double residual : scratch_) sum += residual * residual;
  sum += prior_cost(theta);
  return std::isfinite(sum) ? sum : std::numeric_limits<double>::infinity();
}

FrequencyResiduals::FrequencyResiduals(const FrequencyResponseData& data, const Structure& structure,
                                       const Realisation& realisation, const ParameterMap& map,
                                       const ResidualRule& rule, bool only_stable)
    : Residuals(map),
      data_(data),
      structure_(structure),
      realisation_(realisation),
      rule_(rule),
      only_stable_(only_stable),
      value_(data.size()),
      gradient_(data.size() * map.parameter_count()),
      by_theta_(data.size()) {}

ResidualAxis FrequencyResiduals::axis(std::span<const double> theta) const {
  ResidualAxis axis{per_point()};
  for (const double omega : data_.omega()) axis.position.push_back(std::log(omega));
  const bool turns = rule_.form == ResidualForm::cartesian;
  if (!turns && !rule_.floor) return axis;
  structure_.response(map().to_user(theta), data_.omega(), realisation_, value_);
  for (std::size_t i = 0; i < points(); ++i) {
    const std::complex<double> datum = data_.value()[i], seen = seen_of(rule_.form, value_[i], datum);
    std::complex<double> factor = 1;
    if (turns && seen != 0.0) factor = std::conj(seen) / std::abs(seen);
    if (rule_.floor && seen != 0.0 && datum != 0.0)
      factor *= std::hypot(std::abs(datum), *rule_.floor) / std::hypot(std::abs(seen), *rule_.floor);
    axis.factor.push_back(factor);
  }
  return axis;
}

double FrequencyResiduals::wall(std::span<const double> parameters) const {
  // A finite wall, which a solver steps back from; one that is not finite would stop it after a few steps.
  constexpr double height = 1e6;
  return only_stable_ && is_unstable(structure_, parameters).value_or(false) ? height : 1;
}

bool FrequencyResiduals::evaluate(std::span<const double> theta, double* residual, double* jacobian) const {
  const std::vector<double> parameters = map().to_user(theta);
  if (jacobian) {
    structure_.response_and_gradient(parameters, data_.omega(), realisation_, value_, gradient_);
  } else {
    structure_.response(parameters, data_.omega(), realisation_, value_);
  }
  if (!rule_.residuals(value_, data_.value(), residual)) return false;
  const double height = wall(parameters);
  if (height != 1) std::for_each_n(residual, count(), [&](double& each) { each *= height; });
  if (!jacobian) return true;

  // d model / d theta from d model / d parameter; most entries of the map's Jacobian are 0.
  const std::vector<ParameterMap::Entry> entries = map().jacobian_entries(parameters);
  for (std::size_t k = 0; k < map().free().size(); ++k) {
    std::fill(by_theta_.begin(), by_theta_.end(), 0.0);
    for (const ParameterMap::Entry& entry : entries) {
      if (entry.free == k) add_multiple(entry.derivative, gradient_.data() + entry.parameter * points(), by_theta_);
    }
    if (!rule_.derivatives(value_, by_theta_, jacobian + k * count())) return false;
    if (height != 1) std::for_each_n(jacobian + k * count(), count(), [&](double& each) { each *= height; });
  }
  return true;
}

Residuals::BestFactor FrequencyResiduals::best_factor(std::span<const double> theta) const {
  if (rule_.form == ResidualForm::phase) return {};
  throw_if_cancelled();
  const std::vector<double> parameters = map().to_user(theta);
  structure_.response(parameters, data_.omega(), realisation_, value_);
  scratch_.resize(count());
  if (!rule_.residuals(value_, data_.value(), scratch_.data())) return {1, std::numeric_limits<double>::infinity()};
  double factor = 1, cost = 0, cost_without = 0;
  for (const double residual : scratch_) cost_without += residual * residual;
  if (rule_.form == ResidualForm::logarithmic || rule_.form == ResidualForm::log_magnitude) {
    double sum = 0;
    for (std::size_t i = 0; i < scratch_.size(); i += per_point()) sum += scratch_[i];
    const double mean = sum / static_cast<double>(points());
    factor = std::exp(-mean);
    cost = cost_without - mean * sum;
  } else {
    // Of the model itself: what a residual adds to the datum has lost the digits of a model far below the data.
    double product = 0, power = 0, of_data = 0;
    const auto add = [&](double model, double datum) {
      product += model * datum;
      power += model * model;
      of_data += datum * datum;
    };
    for (std::size_t i = 0; i < points(); ++i) {
      const std::complex<double> model = rule_.weight[i] * value_[i], datum = rule_.weight[i] * data_.value()[i];
      switch (rule_.form) {
        case ResidualForm::imaginary:
          add(model.imag(), datum.imag());
          break;
        case ResidualForm::real:
          add(model.real(), datum.real());
          break;
        case ResidualForm::cartesian:
          add(model.real(), datum.real());
          add(model.imag(), datum.imag());
          break;
        default:
          add(std::abs(model), std::abs(datum));
      }
    }
    factor = product / power;
    cost = of_data - factor * product;
  }
  const bool is_usable = factor > 0 && std::isfinite(factor);
  return {is_usable ? factor : 1, std::max(0.0, std::pow(wall(parameters), 2) * (is_usable ? cost : cost_without))};
}

std::vector<std::vector<double>> Residuals::linear_fits(std::span<const double>) const {
  return {};
}

std::vector<std::vector<double>> FrequencyResiduals::linear_fits(std::span<const double> near) const {
  if (per_point() != 2) return {};
  const auto form = coefficient_form(structure_, near);
  if (!form) return {};
  std::vector<std::size_t> wanted;
  for (const ParameterMap::Free& entry : map().free()) {
    if (entry.role == ParameterRole::coefficient) wanted.push_back(entry.parameter);
  }
  std::vector<double> weight = rule_.weight;
  if (rule_.form == ResidualForm::logarithmic) {
    for (std::size_t i = 0; i < weight.size(); ++i) weight[i] = 1 / std::abs(data_.value()[i]);
  }
  std::vector<std::vector<double>> found;
  for (const auto weights : {LinearWeights::levy, LinearWeights::vinagre, LinearWeights::sanathanan_koerner}) {
    const auto fit = linear_fit(*form, data_.omega(), data_.value(), weight, weights);
    auto parameters = fit ? parameters_from(*form, *fit, near, wanted) : std::nullopt;
    if (parameters) found.push_back(std::move(*parameters));
  }
  return found;
}

}  // namespace frac::detail
