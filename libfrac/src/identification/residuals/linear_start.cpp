// SPDX-License-Identifier: BSD-3-Clause
#include "linear_start.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

#include "base/linear_algebra.hpp"

namespace frac::detail {

namespace {

using Index = Eigen::Index;

/// The terms of the form, each with what is known of its coefficient.
struct Unknowns {
  std::vector<const CoefficientTerm*> terms;
  std::size_t of_numerator = 0;  // the first ones
};

Unknowns unknowns_of(const CoefficientForm& form) {
  Unknowns result;
  for (const CoefficientTerm& term : form.numerator) {
    if (!term.is_constant()) result.terms.push_back(&term);
  }
  result.of_numerator = result.terms.size();
  for (const CoefficientTerm& term : form.denominator) {
    if (!term.is_constant()) result.terms.push_back(&term);
  }
  return result;
}

std::complex<double> power_of_s(double omega, double order) {
  const double angle = order * std::acos(0.0);
  return std::pow(omega, order) * std::complex<double>(std::cos(angle), std::sin(angle));
}

std::complex<double> sum_of(const std::vector<CoefficientTerm>& terms, const std::vector<double>& coefficients,
                            double omega) {
  std::complex<double> sum = 0;
  for (std::size_t i = 0; i < terms.size(); ++i) sum += coefficients[i] * power_of_s(omega, terms[i].order);
  return sum;
}

double vinagre_weight(std::span<const double> omega, std::size_t i) {
  const std::size_t before = i > 0 ? i - 1 : 0, behind = std::min(i + 1, omega.size() - 1);
  return (omega[behind] - omega[before]) / (2 * omega[i] * omega[i]);
}

}  // namespace

std::optional<LinearFit> linear_fit(const CoefficientForm& form, std::span<const double> omega,
                                    std::span<const std::complex<double>> value, std::span<const double> weight,
                                    LinearWeights weights) {
  const Unknowns unknowns = unknowns_of(form);
  const auto columns = static_cast<Index>(unknowns.terms.size());
  const auto rows = static_cast<Index>(2 * omega.size());
  const std::size_t constants = form.numerator.size() + form.denominator.size() - unknowns.terms.size();
  if (columns == 0 || constants == 0 || rows < columns) return std::nullopt;

  LinearFit fit{{}, {}, unknowns.terms.size(), 0};
  std::vector<double> scale(omega.size(), 1.0);
  const int passes = weights == LinearWeights::sanathanan_koerner ? 5 : 1;
  for (int pass = 0; pass < passes; ++pass) {
    // Unknown terms of N - D G e^{j omega delay} on the left, constants on the right.
    Eigen::MatrixXd matrix(rows, columns);
    Eigen::VectorXd right = Eigen::VectorXd::Zero(rows);
    for (std::size_t i = 0; i < omega.size(); ++i) {
      const double angle = omega[i] * form.delay;
      const std::complex<double> shifted = -value[i] * std::complex<double>(std::cos(angle), std::sin(angle));
      double factor = weight[i] * scale[i];
      if (weights == LinearWeights::vinagre) factor *= std::sqrt(vinagre_weight(omega, i));
      const auto row = static_cast<Index>(2 * i);
      Index column = 0;
      const auto add = [&](const CoefficientTerm& term, std::complex<double> of_side) {
        const std::complex<double> entry = factor * of_side * power_of_s(omega[i], term.order);
        if (term.is_constant()) {
          right[row] -= term.monomials[0].factor * entry.real();
          right[row + 1] -= term.monomials[0].factor * entry.imag();
          return;
        }
        matrix(row, column) = entry.real();
        matrix(row + 1, column++) = entry.imag();
      };
      for (const CoefficientTerm& term : form.numerator) add(term, 1);
      for (const CoefficientTerm& term : form.denominator) add(term, shifted);
    }
    // Columns of very different size are no sign of a missing rank.
    const Eigen::VectorXd norm = matrix.colwise().norm();
    if (!norm.allFinite() || !right.allFinite() || !(norm.minCoeff() > 0)) return std::nullopt;
    const Eigen::MatrixXd scaled = matrix * norm.cwiseInverse().asDiagonal();
    const PivotedQr decomposition(scaled, 1e-7);
    const Eigen::VectorXd solution = decomposition.solve(right).cwiseQuotient(norm);
    if (!solution.allFinite()) return std::nullopt;
    fit.rank = static_cast<std::size_t>(decomposition.rank());
    fit.numerator.clear();
    fit.denominator.clear();
    Index column = 0;
    for (const CoefficientTerm& term : form.numerator) {
      fit.numerator.push_back(term.is_constant() ? term.monomials[0].factor : solution[column++]);
    }
    for (const CoefficientTerm& term : form.denominator) {
      fit.denominator.push_back(term.is_constant() ? term.monomials[0].factor : solution[column++]);
    }
    for (std::size_t i = 0; i < omega.size(); ++i) {
      const double size = std::abs(sum_of(form.denominator, fit.denominator, omega[i]));
      if (!(size > 0) || !std::isfinite(size)) return std::nullopt;
      scale[i] = 1 / size;
    }
  }
  return fit;
}

std::optional<std::vector<double>> parameters_from(const CoefficientForm& form, const LinearFit& fit,
                                                   std::span<const double> near,
                                                   const std::vector<std::size_t>& wanted) {
  const Unknowns unknowns = unknowns_of(form);
  std::vector<double> target;
  for (std::size_t i = 0; i < form.numerator.size(); ++i) {
    if (!form.numerator[i].is_constant()) target.push_back(fit.numerator[i]);
  }
  for (std::size_t i = 0; i < form.denominator.size(); ++i) {
    if (!form.denominator[i].is_constant()) target.push_back(fit.denominator[i]);
  }
  if (std::any_of(target.begin(), target.end(), [](double each) { return !(std::abs(each) > 0); })) return std::nullopt;

  std::vector<double> parameters(near.begin(), near.end());
  const auto rows = static_cast<Index>(target.size()), columns = static_cast<Index>(wanted.size());
  if (columns == 0) return std::nullopt;
  const bool products = std::all_of(unknowns.terms.begin(), unknowns.terms.end(),
                                    [](const CoefficientTerm* term) { return term->monomials.size() == 1; });
  // Differences of logarithms for products, which one step solves; relative differences for sums, by damped steps.
  double damping = products ? 0 : 1e-2;
  double least = std::numeric_limits<double>::infinity();
  std::vector<double> best = parameters;
  for (int step = 0; step < (products ? 2 : 40); ++step) {
    Eigen::MatrixXd matrix = Eigen::MatrixXd::Zero(rows + columns, columns);
    Eigen::VectorXd right = Eigen::VectorXd::Zero(rows + columns);
    double cost = 0;
    for (Index row = 0; row < rows; ++row) {
      const CoefficientTerm& term = *unknowns.terms[static_cast<std::size_t>(row)];
      const double wanted_value = target[static_cast<std::size_t>(row)], value = term.value(parameters);
      const double unit = products ? value : wanted_value;
      right[row] = products ? std::log(std::abs(wanted_value / value)) : 1 - value / wanted_value;
      cost += right[row] * right[row];
      for (Index column = 0; column < columns; ++column) {
        matrix(row, column) = term.by_log(parameters, wanted[static_cast<std::size_t>(column)]) / unit;
      }
    }
    if (!std::isfinite(cost)) return std::nullopt;
    if (cost < least) {
      least = cost;
      best = parameters;
      damping /= 4;
    } else {
      parameters = best;
      damping = std::max(damping, 1e-6) * 16;
      if (products || damping > 1e6) break;
      continue;
    }
    for (Index column = 0; column < columns; ++column) matrix(rows + column, column) = std::sqrt(damping);
    const Eigen::VectorXd change = PivotedQr(matrix).solve(right);
    if (!change.allFinite()) return std::nullopt;
    for (Index column = 0; column < columns; ++column) {
      // A step is at most three e-folds long, because the linear picture holds no further.
      const double fold = products ? change[column] : std::clamp(change[column], -3.0, 3.0);
      parameters[wanted[static_cast<std::size_t>(column)]] *= std::exp(fold);
    }
  }
  return best;
}

}  // namespace frac::detail
