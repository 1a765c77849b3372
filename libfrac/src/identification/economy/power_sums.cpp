// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "base/short_text.hpp"
#include "column_subsets.hpp"
#include "economy_search.hpp"

namespace frac::detail {
namespace {

using Complex = std::complex<double>;
using Index = Eigen::Index;
using Exponents = std::vector<double>;

/// Weighted least squares of sums of powers by variable projection, see gauss_newton(): coefficients follow, exponents
/// are searched for.
class PowerProblem : public ProjectedData {
 public:
  explicit PowerProblem(const EconomyProblem& problem)
      : ProjectedData(problem.data, problem.rule),
        largest_(problem.options.largest_power),
        is_imaginary_(problem.options.component == Component::imaginary) {}

  /// Of one component its own law, the same in both parts of a complex number.
  [[nodiscard]] Eigen::ArrayXcd column(double exponent) const {
    if (!one_part()) return power(exponent);
    return power(exponent).abs().cast<Complex>() * Complex(1, 1);
  }
  [[nodiscard]] Eigen::MatrixXcd columns(const Exponents& exponents) const {
    Eigen::MatrixXcd result(s().size(), static_cast<Index>(exponents.size()));
    for (std::size_t k = 0; k < exponents.size(); ++k) {
      result.col(static_cast<Index>(k)) = column(exponents[k]).matrix();
    }
    return result;
  }
  [[nodiscard]] Eigen::MatrixXcd derivatives(const Exponents& exponents, const Linear& linear) const {
    Eigen::MatrixXcd result = columns(exponents) * linear.coefficients.asDiagonal();
    if (one_part()) return log_s().real().asDiagonal() * result;
    return log_s().asDiagonal() * result;
  }
  [[nodiscard]] StepBounds step_bounds(const Exponents& exponents) const {
    constexpr double moderate = 1;
    StepBounds result(exponents.size());
    for (const double each : exponents) result.add(moderate, each, -largest_, largest_);
    return result;
  }
  [[nodiscard]] Exponents stepped(const Exponents& exponents, const Eigen::VectorXd& step) const {
    Exponents next = exponents;
    for (std::size_t k = 0; k < next.size(); ++k) next[k] += step[static_cast<Index>(k)];
    return next;
  }

  /// Of the columns of a list of exponents, see best_subsets(); nothing where a number overflows.
  [[nodiscard]] std::optional<std::vector<std::vector<ColumnSubset>>> subsets(const Exponents& all, std::size_t most,
                                                                              std::size_t kept) const {
    const std::optional<Weighted> seen = weighted(columns(all));
    if (!seen) return std::nullopt;
    return best_subsets(seen->matrix, target(), most, kept);
  }

  /// K1 s^a1 + ... with its numbers, over omega where it is a law of one component.
  [[nodiscard]] std::string written(const Exponents& exponents, bool of_omega) const {
    Linear linear;
    if (!solve(columns(exponents), linear)) return {};
    std::string text;
    for (std::size_t k = 0; k < exponents.size(); ++k) {
      const double exponent = exponents[k], half_turns = exponent / 2;
      double coefficient = linear.coefficients[static_cast<Index>(k)] * std::pow(centre_omega(), -exponent);
      // A real power of s has its share in the component.
      if (one_part() && !of_omega) {
        coefficient /=
            is_imaginary_ ? std::sin(half_turns * std::numbers::pi) : std::cos(half_turns * std::numbers::pi);
      }
      text += signed_number(coefficient, k == 0);
      if (exponent == 0) continue;
      text += of_omega ? " omega" : " s";
      if (exponent == 1) continue;
      const std::string number = short_text(exponent, 7);
      text += "^" + (exponent < 0 ? "(" + number + ")" : number);
    }
    return text;
  }

 private:
  double largest_;
  bool is_imaginary_;
};

Exponents chosen(const Exponents& all, const ColumnSubset& subset) {
  Exponents result;
  for (const std::size_t member : subset.members) result.push_back(all[member]);
  return result;
}

}  // namespace

EconomyCurve economy_of_integer_powers(const EconomyProblem& given, EconomyClass model_class) {
  const PowerProblem problem(given);
  const bool of_omega = model_class == EconomyClass::integer_powers_of_omega;
  EconomyCurve curve{std::string(to_string(model_class)), model_class, {}};
  // Imaginary parts of real coefficients times whole powers of s are odd in omega, real parts even.
  const bool only_odd = !of_omega && given.options.component == Component::imaginary,
             only_even = !of_omega && given.options.component == Component::real;
  Exponents all;
  for (int exponent = -given.options.largest_power; exponent <= given.options.largest_power; ++exponent) {
    const bool odd = exponent % 2 != 0;
    if ((only_odd && !odd) || (only_even && odd)) continue;
    all.push_back(exponent);
  }
  const auto best = problem.subsets(all, std::min(given.options.most_parameters, all.size()), 1);
  if (!best) return curve;
  for (const auto& of_size : *best) {
    if (of_size.empty()) break;
    const Exponents exponents = chosen(all, of_size.front());
    const auto projection = problem.project(problem.columns(exponents));
    if (!projection) break;
    add_point(curve, {exponents.size(), economy_error(given, projection->cost), true, false,
                      problem.written(exponents, of_omega)});
  }
  return curve;
}

namespace {

/// Those of a list, best first, of which no other on the list with one member moved to its neighbour is better.  As the
/// list holds the best of all, a better neighbour would be on it.
std::vector<ColumnSubset> local_minima(const std::vector<ColumnSubset>& best, std::size_t most) {
  std::vector<ColumnSubset> minima;
  std::set<std::vector<std::size_t>> better;
  for (const ColumnSubset& subset : best) {
    const auto has_better_neighbour = [&] {
      for (std::size_t k = 0; k < subset.members.size(); ++k) {
        for (const int step : {-1, 1}) {
          std::vector<std::size_t> moved = subset.members;
          moved[k] += static_cast<std::size_t>(step);  // beyond the ends there is none on the list
          if (better.contains(moved)) return true;
        }
      }
      return false;
    };
    if (!has_better_neighbour()) minima.push_back(subset);
    if (minima.size() == most) break;
    better.insert(subset.members);
  }
  return minima;
}

}  // namespace

// Starts are sums of powers from a lattice of exponents, every one of which is looked at: over the two to three e-folds
// of a decade the column of one exponent and that of another half a one away are alike to a few per cent, so that a
// minimum between the lattice's points is seen from them.
EconomyCurve economy_of_real_powers(const EconomyProblem& given) {
  const PowerProblem problem(given);
  EconomyCurve curve{std::string(to_string(EconomyClass::real_powers)), EconomyClass::real_powers, {}};
  constexpr double step = 0.5;
  constexpr std::size_t listed = 4000, tried = 24;
  Exponents lattice;
  for (int k = 0; k * step <= 2 * given.options.largest_power; ++k) {
    lattice.push_back(k * step - given.options.largest_power);
  }
  const auto starts = problem.subsets(lattice, given.options.most_parameters / 2, listed);
  if (!starts) return curve;
  for (const auto& of_size : *starts) {
    Exponents best;
    double least = infinity;
    for (const ColumnSubset& start : local_minima(of_size, tried)) {
      Exponents exponents = chosen(lattice, start);
      ProjectedData::Linear linear;
      if (!gauss_newton(problem, problem, exponents, linear, to_the_end) || !(linear.cost < least)) continue;
      least = linear.cost;
      best = std::move(exponents);
    }
    if (!std::isfinite(least)) break;
    std::sort(best.begin(), best.end());
    const bool fractional = !std::all_of(best.begin(), best.end(), is_whole);
    const double error = economy_error(given, least);
    add_point(curve, {2 * best.size(), error, false, fractional, problem.written(best, problem.one_part())});
    if (error <= economy_rounding) break;
  }
  return curve;
}

}  // namespace frac::detail
