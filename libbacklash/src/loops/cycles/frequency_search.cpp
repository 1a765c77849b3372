// SPDX-License-Identifier: BSD-3-Clause
#include "frequency_search.hpp"

#include <algorithm>
#include <boost/math/special_functions/zeta.hpp>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "base/check.hpp"
#include "base/impact_law.hpp"
#include "cycle_frequencies.hpp"
#include "special/exact_power.hpp"

namespace backlash::detail {
namespace {

constexpr double pi = std::numbers::pi;

// sum over odd k of k^-p
double dirichlet_lambda(double p) {
  return -std::expm1(-p * std::numbers::ln2) * boost::math::zeta(p);
}

frac::PowerTerm loss(const ControlLoop& loop) {
  const TwoMassSystem& system = loop.system();
  return {-pi / 4 * (system.mass1() + system.mass2()) * loss_ratio(system.restitution()), 2};
}

}  // namespace

std::vector<frac::PowerTerm> controller_powers(const ControlLoop& loop) {
  const frac::FractionalTransferFunction& controller = loop.controller();
  if (controller.denominator().size() != 1) return {};
  std::vector<frac::PowerTerm> powers = controller.numerator();
  for (frac::PowerTerm& term : powers) term.order -= controller.denominator().front().order;
  return powers;
}

std::vector<frac::PowerTerm> frequency_equation(const ControlLoop& loop, CountedHarmonics harmonics) {
  std::vector<frac::PowerTerm> equation = controller_powers(loop);
  for (frac::PowerTerm& term : equation) {
    term.coefficient *= frac::detail::quarter_turns(term.order).imag();
    if (harmonics == CountedHarmonics::all) term.coefficient *= dirichlet_lambda(3 - term.order);
  }
  equation.push_back(loss(loop));
  return equation;
}

FrequencyRange search_range(const ControlLoop& loop, const std::optional<FrequencyRange>& asked) {
  if (asked) return *asked;
  std::vector<frac::PowerTerm> sizes = controller_powers(loop);
  if (sizes.empty()) return {1e-4, 1e4};
  for (frac::PowerTerm& term : sizes) term.coefficient = std::abs(term.coefficient);
  const TwoMassSystem& system = loop.system();
  // With the driven body measured its own answer, C/(M2^2 s^4) at first, takes the place of C/(M1 M2 s^4).
  const bool is_driven = loop.measured() == Output::x2;
  std::vector<frac::PowerTerm> bound = sizes;
  for (frac::PowerTerm& term : bound) {
    term.coefficient *= dirichlet_lambda(3 - term.order) * (is_driven ? system.mass1() / system.mass2() : 1);
  }
  bound.push_back(loss(loop));
  std::vector<double> roots = positive_roots(bound);
  double highest = roots.empty() ? 0 : 1.01 * roots.back();
  if (is_driven) {
    // Near the frequency at which C holds the driven body that answer is larger.
    sizes.push_back({-system.mass2(), 2});
    roots = positive_roots(sizes);
    if (!roots.empty()) highest = std::max(highest, 3 * roots.back());
  }
  double lowest = 1e-4 * highest;
  // Beyond the corners of the bodies they are masses or springs.
  for (const frac::FractionalTransferFunction* body : {&loop.bodies().load(), &loop.bodies().drive()}) {
    const std::vector<frac::PowerTerm>& terms = body->denominator();
    for (std::size_t i = 1; i < terms.size(); ++i) {
      const double corner = std::pow(std::abs(terms[i].coefficient / terms.front().coefficient),
                                     1 / (terms.front().order - terms[i].order));
      highest = std::max(highest, 10 * corner);
      lowest = std::min(lowest == 0 ? corner : lowest, 0.1 * corner);
    }
  }
  if (highest == 0) return {1e-4, 1e4};
  return {std::max(lowest, 1e-6 * highest), highest};
}

std::vector<double> search_grid(const FrequencyRange& range, double delay) {
  std::vector<double> grid{range.from};
  while (grid.back() < range.to) {
    double step = grid.back() * 0.0115;  // 200 per decade
    if (delay > 0) step = std::min(step, 2 * pi / delay / 200);
    grid.push_back(std::min(range.to, grid.back() + step));
    if (grid.size() > 1'000'000) {
      throw std::invalid_argument(
          "the range of omega holds too many turns of the dead time to be searched; make it narrower");
    }
  }
  return grid;
}

void require_range(const std::optional<FrequencyRange>& range) {
  if (!range) return;
  require_positive("lower end of the range of omega", "rad/s", range->from);
  require_positive("upper end of the range of omega", "rad/s", range->to);
  if (!(range->from < range->to)) {
    throw std::invalid_argument("the range of omega runs from " + text(range->from) + " to " + text(range->to) +
                                "; the first must be the lower one");
  }
}

}  // namespace backlash::detail
