// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>

#include "approximation/multiprecision.hpp"
#include "approximation/unit_design.hpp"

namespace frac::detail {
namespace {

// first here + (s - node) before.
Polynomial next_convergent(const Multiprecision& first, const Polynomial& here, const Multiprecision& node,
                           const Polynomial& before) {
  Polynomial result(std::max(here.size(), before.size() + 1));
  for (std::size_t i = 0; i < here.size(); ++i) result[i] += first * here[i];
  for (std::size_t i = 0; i < before.size(); ++i) {
    result[i] -= node * before[i];
    result[i + 1] += before[i];
  }
  return result;
}

// Magnitudes, rising, of the roots of a polynomial whose roots are all real and negative: the simultaneous iteration of
// Aberth (1973) in real arithmetic.
std::vector<long double> negative_roots(const Polynomial& polynomial, double half_width) {
  const std::size_t degree = polynomial.size() - 1;
  std::vector<Multiprecision> root;
  for (std::size_t i = 0; i < degree; ++i) {
    const double position = (2 * (static_cast<double>(i) + 0.5) / static_cast<double>(degree) - 1) * (half_width + 1);
    root.emplace_back(-std::exp(position));
  }
  const Multiprecision close = 1e-25;
  for (int iteration = 0; iteration < 200; ++iteration) {
    bool settled = true;
    for (std::size_t i = 0; i < degree; ++i) {
      Multiprecision value = 0;
      Multiprecision slope = 0;
      for (std::size_t k = polynomial.size(); k-- > 0;) {
        slope = slope * root[i] + value;
        value = value * root[i] + polynomial[k];
      }
      Multiprecision repulsion = 0;
      for (std::size_t k = 0; k < degree; ++k) {
        if (k != i) repulsion += 1 / (root[i] - root[k]);
      }
      const Multiprecision step = value / (slope - value * repulsion);
      root[i] -= step;
      if (abs(step) > close * abs(root[i])) settled = false;
    }
    if (settled) break;
  }
  std::vector<long double> result;
  result.reserve(root.size());
  for (const Multiprecision& each : root) result.push_back(-static_cast<long double>(each));
  std::sort(result.begin(), result.end());
  return result;
}

}  // namespace

// Matsuda, Fujii (1993): Thiele's continued fraction c_0 + (s - x_0)/(c_1 + (s - x_1)/(c_2 + ...)) through x^a at 2N+1
// real points.  x^a is a Stieltjes function, so all zeros and poles are negative and interlace.
UnitDesign matsuda_design(const UnitProblem& problem, int poles) {
  const int points = 2 * poles + 1;
  std::vector<Multiprecision> node;
  std::vector<Multiprecision> inverse_difference;
  for (int k = 0; k < points; ++k) {
    const Multiprecision position = Multiprecision(problem.half_width) * (k - poles) / poles;
    node.push_back(exp(position));
    inverse_difference.push_back(exp(position * problem.order));
  }
  for (std::size_t level = 0; level + 1 < node.size(); ++level) {
    for (std::size_t k = level + 1; k < node.size(); ++k) {
      inverse_difference[k] = (node[k] - node[level]) / (inverse_difference[k] - inverse_difference[level]);
    }
  }
  Polynomial numerator_before{1};
  Polynomial numerator{inverse_difference[0]};
  Polynomial denominator_before;
  Polynomial denominator{1};
  for (std::size_t k = 1; k < node.size(); ++k) {
    Polynomial next = next_convergent(inverse_difference[k], numerator, node[k - 1], numerator_before);
    numerator_before = std::move(numerator);
    numerator = std::move(next);
    next = next_convergent(inverse_difference[k], denominator, node[k - 1], denominator_before);
    denominator_before = std::move(denominator);
    denominator = std::move(next);
  }
  // The top coefficient that the recurrence reserves stays zero at every other step.
  while (numerator.back() == 0) numerator.pop_back();
  while (denominator.back() == 0) denominator.pop_back();
  UnitDesign design;
  design.zeros = negative_roots(numerator, problem.half_width);
  design.poles = negative_roots(denominator, problem.half_width);
  design.gain = static_cast<long double>(Multiprecision(numerator.back() / denominator.back()));
  return design;
}

}  // namespace frac::detail
