// SPDX-License-Identifier: BSD-3-Clause
#include "term_growth.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>

namespace frac::detail {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
// Sums that the next term is added to.
constexpr std::size_t kept = 2;
// Rows of modes are ratios.
constexpr std::ptrdiff_t most_modes = 2;

bool contains(const TermSum& sum, const Term& power) {
  return std::any_of(sum.begin(), sum.end(), [&](const Term& term) { return same_power(term, power); });
}

bool has_free_order(const TermSum& sum) {
  return std::any_of(sum.begin(), sum.end(), [](const Term& term) { return !term.held; });
}

/// Appends sums with one more term, of each kind of term the best ones, refined.
void extend(const TermProblem& problem, const TermSum& sum, std::vector<TermFit>& refined) {
  for (const double order : {0.0, 1.0, -1.0}) {
    const Term power = whole_power(order);
    if (!contains(sum, power)) refined.push_back(problem.refine(with_term(sum, power), scouting));
  }
  std::vector<Term> powers;
  for (const double order : {-1.5, -0.75, -0.5, -0.25, 0.25, 0.5, 0.75, 1.5}) {
    powers.push_back({Term::Kind::power, order, false, 0, 0});
  }
  std::vector<TermFit> starts;
  add_local_minima(problem.along(sum, powers), starts);
  problem.refine_best(std::move(starts), 1, refined);
  starts.clear();
  const std::vector<double> band = places(problem, 12);
  for (const double order : {0.95, 0.7, 0.45}) {
    std::vector<Term> arcs;
    for (const double at : band) arcs.push_back({Term::Kind::arc, order, false, at, 0});
    add_local_minima(problem.along(sum, arcs), starts);
  }
  const double best_arc = starts.empty() ? infinity : std::min_element(starts.begin(), starts.end(), costs_less)->cost;
  problem.refine_best(std::move(starts), 3, refined);
  const auto modes =
      std::count_if(sum.begin(), sum.end(), [](const Term& term) { return term.kind == Term::Kind::mode; });
  if (sum.empty() || modes >= most_modes) return;
  starts.clear();
  for (const double top : {0.0, 1.0}) {
    std::vector<Term> modes_along;
    for (const double at : band) modes_along.push_back({Term::Kind::mode, top, true, at, std::log(0.2)});
    add_local_minima(problem.along(sum, modes_along), starts);
  }
  // Without a resonance in the data arcs are worth more from the start.
  std::erase_if(starts, [&](const TermFit& fit) { return !(fit.cost < best_arc); });
  problem.refine_best(std::move(starts), 2, refined);
}

/// The fit without terms that do not pay for themselves, and with whole orders where these may as well be.
TermFit without_idle_parts(const TermProblem& problem, TermFit fit) {
  const auto moves_of = [](const TermFit& best, int) {
    std::vector<TermSum> moves;
    for (std::size_t k = 0; k < best.sum.size(); ++k) {
      TermSum less = without_term(best.sum, k);
      if (has_free_order(less)) moves.push_back(std::move(less));
      const Term& term = best.sum[k];
      if (term.held) continue;
      TermSum whole = best.sum;
      whole[k].order = term.kind == Term::Kind::arc ? 1 : std::round(term.order);
      whole[k].held = true;
      const bool twice = contains(best.sum, whole[k]);
      if (!twice && std::abs(term.order - whole[k].order) < 0.3 && has_free_order(whole)) {
        moves.push_back(std::move(whole));
      }
    }
    return moves;
  };
  const auto value_of = [&](const TermFit& each) { return term_value(problem, each); };
  return without_idle(problem, std::move(fit), &TermFit::sum, value_of, moves_of);
}

}  // namespace

double term_value(const TermProblem& problem, const TermFit& fit) {
  double value = schwarz(problem, fit.cost, fit.parameters);
  for (const Term& term : fit.sum) {
    if (term.kind != Term::Kind::power) value += term.is_mode() ? price_of_point(problem) : price_of_place(problem);
  }
  return value;
}

TermLadder grow_terms(const TermProblem& problem, std::size_t most_terms) {
  TermLadder ladder;
  std::vector<TermSum> sums{{}};
  for (std::size_t count = 1; count <= most_terms && ladder.in_vain < 2 && 3 * count + 1 < problem.rows(); ++count) {
    std::vector<TermFit> refined;
    for (const TermSum& sum : sums) extend(problem, sum, refined);
    const std::vector<TermFit> best = best_sums(
        std::move(refined), kept, [&](const TermFit& fit) { return term_value(problem, fit); },
        [&](const TermFit& grown) {
          TermFit fit = problem.refine(grown.sum, thorough);
          return has_free_order(fit.sum) ? without_idle_parts(problem, std::move(fit)) : fit;
        });
    if (best.empty()) break;
    sums.clear();
    for (const TermFit& fit : best) sums.push_back(fit.sum);
    const auto free =
        std::find_if(best.begin(), best.end(), [](const TermFit& fit) { return has_free_order(fit.sum); });
    if (free == best.end()) continue;
    ladder.add(*free, term_value(problem, *free));
    const bool exact = free->cost <= problem.negligible_cost();
    if (exact) break;
  }
  return ladder;
}

NamedModel written_out(const TermProblem& problem, const TermSum& sum) {
  // Constant, whole powers, arcs by rising time constant, modes, free powers.
  const auto rank = [](const Term& term) {
    const bool power = term.kind == Term::Kind::power;
    const int kind = power ? (term.held ? 0 : 3) : term.kind == Term::Kind::arc ? 1 : 2;
    return std::pair(kind, power ? std::abs(term.order) + (term.order < 0 ? 0.1 : 0) : -term.log_size);
  };
  TermSum sorted = sum;
  std::stable_sort(sorted.begin(), sorted.end(), [&](const Term& a, const Term& b) { return rank(a) < rank(b); });
  const std::vector<double> coefficients = problem.coefficients(sorted);
  NamedModel model{"", "", ModelClass::fractional, "sum of powers, arcs and modes", {}};
  std::string ends;
  std::size_t arcs = 0, modes = 0, powers = 0;
  const auto parameter = [&](const std::string& name, double start, double lower, double upper) {
    model.constraints.push_back({name, {}, lower, upper, start});
    return name;
  };
  for (std::size_t k = 0; k < sorted.size(); ++k) {
    const Term& term = sorted[k];
    const auto gain = [&](const std::string& name) { return parameter(name, coefficients[k], -infinity, infinity); };
    std::string text;
    if (term.kind == Term::Kind::arc) {
      const std::string n = std::to_string(++arcs);
      text = gain("R" + n) + "/(1 + ";
      const std::string time = parameter("T" + n, std::exp(-term.log_size) / problem.centre_omega(), 0, infinity);
      text += term.held ? time + " s)" : "(" + time + " s)^" + parameter("n" + n, term.order, 0, 1) + ")";
    } else if (term.kind == Term::Kind::mode) {
      const std::string n = std::to_string(++modes);
      text = gain("G" + n);
      const std::string at_top = parameter("w" + n, std::exp(term.log_size) * problem.centre_omega(), 0, infinity);
      const std::string damping = parameter("d" + n, 2 * std::exp(term.log_damping), 0, infinity);
      text += (term.order > 0 ? " (s/" + at_top + ")" : "") + "/(s^2/" + at_top + "^2 + " + damping + " s/" + at_top +
              " + 1)";
    } else if (!term.held) {
      const std::string n = std::to_string(++powers);
      text = gain("A" + n) + " s^" + parameter("q" + n, term.order, -most_power, most_power);
    } else if (term.order == 0) {
      text = gain("R0");
      ends += "+R";
    } else if (term.order == 1) {
      text = gain("L") + " s";
      ends += "+L";
    } else {
      const auto size = static_cast<int>(std::abs(term.order));
      const std::string power = size == 1 ? "s" : "s^" + std::to_string(size);
      text = gain((term.order < 0 ? "D" : "L") + std::to_string(size)) + (term.order < 0 ? "/" : " ") + power;
      ends += "+" + std::string(term.order < 0 ? "1/" : "") + power;
    }
    model.formula += (model.formula.empty() ? "" : " + ") + text;
  }
  const auto counted = [](std::size_t count, const std::string& what) {
    return count == 0 ? "" : count == 1 ? "+" + what : "+" + std::to_string(count) + what + "s";
  };
  model.name = "terms:" + (ends + counted(arcs, "arc") + counted(modes, "mode") + counted(powers, "power")).substr(1);
  return model;
}

}  // namespace frac::detail
