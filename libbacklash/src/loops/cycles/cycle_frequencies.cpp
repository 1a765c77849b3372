// SPDX-License-Identifier: BSD-3-Clause
#include "cycle_frequencies.hpp"

#include <algorithm>
#include <boost/math/tools/toms748_solve.hpp>
#include <cmath>
#include <cstdint>
#include <limits>

#include "frac/cancellation.hpp"

namespace backlash::detail {
namespace {

using Terms = std::vector<frac::PowerTerm>;

double refined(const std::function<double(double)>& function, double from, double to, double at_from, double at_to) {
  std::uintmax_t evaluations = 100;
  // At a pole the iteration meets values without end, which would make its next point no number.
  const auto bounded = [&](double x) {
    constexpr double most = 1e100;
    const double value = function(x);
    return std::isnan(value) ? 0 : std::clamp(value, -most, most);
  };
  const auto [lower, upper] = boost::math::tools::toms748_solve(
      bounded, from, to, at_from, at_to, boost::math::tools::eps_tolerance<double>(53), evaluations);
  return std::abs(function(lower)) < std::abs(function(upper)) ? lower : upper;
}

// The sum over its largest term, at w = e^x.
double relative_value(const Terms& terms, double x) {
  double largest = -std::numeric_limits<double>::infinity();
  for (const frac::PowerTerm& term : terms)
    largest = std::max(largest, std::log(std::abs(term.coefficient)) + term.order * x);
  double sum = 0;
  for (const frac::PowerTerm& term : terms) {
    sum += std::copysign(std::exp(std::log(std::abs(term.coefficient)) + term.order * x - largest), term.coefficient);
  }
  return sum;
}

// Beyond the bounds one term is larger than all others together.
struct Bounds {
  double lower, upper;
};
Bounds dominated(const Terms& terms) {
  Bounds bounds{std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()};
  const double count = static_cast<double>(terms.size());
  const frac::PowerTerm& first = terms.front();
  const frac::PowerTerm& last = terms.back();
  for (const frac::PowerTerm& term : terms) {
    if (term.order > first.order) {
      bounds.lower = std::min(
          bounds.lower, std::log(std::abs(first.coefficient / term.coefficient) / count) / (term.order - first.order));
    }
    if (term.order < last.order) {
      bounds.upper = std::max(
          bounds.upper, std::log(count * std::abs(term.coefficient / last.coefficient)) / (last.order - term.order));
    }
  }
  return bounds;
}

// Terms by rising order; roots in x = ln w.
std::vector<double> log_roots(const Terms& terms) {
  const bool has_one_sign = std::all_of(terms.begin(), terms.end(), [&](const frac::PowerTerm& term) {
    return (term.coefficient > 0) == (terms.front().coefficient > 0);
  });
  if (terms.size() < 2 || has_one_sign) return {};
  Terms derivative(terms.begin() + 1, terms.end());
  for (frac::PowerTerm& term : derivative) {
    term.order -= terms.front().order;
    term.coefficient *= term.order;
  }
  const Bounds bounds = dominated(terms);
  std::vector<double> knots{bounds.lower - 1};
  for (const double x : log_roots(derivative)) {
    if (x > bounds.lower - 1 && x < bounds.upper + 1) knots.push_back(x);
  }
  knots.push_back(bounds.upper + 1);
  const auto value = [&](double x) { return relative_value(terms, x); };
  // A value below this is 0 but for the rounding of its terms.
  const double rounding = 8 * static_cast<double>(terms.size()) * std::numeric_limits<double>::epsilon();
  std::vector<double> roots;
  double before = value(knots.front());
  for (std::size_t i = 1; i < knots.size(); ++i) {
    const double after = value(knots[i]);
    if (std::abs(after) <= rounding) {
      roots.push_back(knots[i]);
    } else if (std::abs(before) > rounding && (before > 0) != (after > 0)) {
      roots.push_back(refined(value, knots[i - 1], knots[i], before, after));
    }
    before = after;
  }
  return roots;
}

}  // namespace

std::vector<double> positive_roots(std::vector<frac::PowerTerm> sum) {
  std::erase_if(sum, [](const frac::PowerTerm& term) { return term.coefficient == 0; });
  std::sort(sum.begin(), sum.end(),
            [](const frac::PowerTerm& a, const frac::PowerTerm& b) { return a.order < b.order; });
  Terms merged;
  for (const frac::PowerTerm& term : sum) {
    if (!merged.empty() && merged.back().order == term.order) {
      merged.back().coefficient += term.coefficient;
    } else {
      merged.push_back(term);
    }
  }
  std::erase_if(merged, [](const frac::PowerTerm& term) { return term.coefficient == 0; });
  if (merged.empty()) return {};
  std::vector<double> roots = log_roots(merged);
  for (double& root : roots) root = std::exp(root);
  // Orders that hardly differ balance where powers of the frequency leave the range of numbers.
  constexpr double lowest = 1e-60, highest = 1e60;
  std::erase_if(roots, [](double root) { return !(root > lowest && root < highest); });
  return roots;
}

std::vector<double> roots_on_grid(const std::function<double(double)>& scanned,
                                  const std::function<double(double)>& function, const std::vector<double>& grid,
                                  double rounding) {
  std::vector<double> roots;
  double before = scanned(grid.front());
  for (std::size_t i = 1; i < grid.size(); ++i) {
    frac::throw_if_cancelled();
    const double after = scanned(grid[i]);
    if (after == 0) {
      if (std::abs(before) >= rounding) roots.push_back(grid[i]);
    } else if (before != 0 && std::isfinite(before) && std::isfinite(after) && (before > 0) != (after > 0) &&
               std::max(std::abs(before), std::abs(after)) > rounding) {
      const double at_from = function(grid[i - 1]), at_to = function(grid[i]);
      if (std::isfinite(at_from) && std::isfinite(at_to) && (at_from > 0) != (at_to > 0)) {
        const double root = refined(function, grid[i - 1], grid[i], at_from, at_to);
        // A pole changes the sign too.
        if (std::abs(function(root)) <= std::max(std::abs(at_from), std::abs(at_to))) roots.push_back(root);
      }
    }
    before = after;
  }
  return roots;
}

}  // namespace backlash::detail
