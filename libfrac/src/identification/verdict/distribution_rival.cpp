// SPDX-License-Identifier: BSD-3-Clause
#include "identification/verdict/distribution_rival.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "base/short_text.hpp"
#include "identification/data/residual_rule.hpp"
#include "identification/rational/term_problem.hpp"
#include "identification/search/thinned.hpp"
#include "identification/statistics/information.hpp"
#include "identification/statistics/residual_tests.hpp"
#include "identification/verdict/evidence.hpp"

namespace frac::detail {
namespace {

constexpr Term::Kind spreads[] = {Term::Kind::normal_spread, Term::Kind::even_spread};
constexpr std::size_t most_spreads = 3;  // more of them follow any data

std::size_t spreads_in(const TermSum& sum) {
  return static_cast<std::size_t>(std::count_if(sum.begin(), sum.end(), [](const Term& t) { return t.is_spread(); }));
}

double value_of(const TermProblem& problem, const TermFit& fit) {
  return schwarz(problem, fit.cost, fit.parameters) +
         static_cast<double>(spreads_in(fit.sum)) * price_of_place(problem);
}

TermSum with(TermSum sum, const Term& term) {
  sum.push_back(term);
  return sum;
}

const Term constant{Term::Kind::power, 0, true};

Term spread(Term::Kind kind, double log_size, double width) {
  return {.kind = kind, .held = true, .log_size = log_size, .log_width = std::log(width)};
}

/// Refines the `count` starts of least cost.
void refine_best(const TermProblem& problem, std::vector<TermFit> starts, std::size_t count,
                 std::vector<TermFit>& refined) {
  std::stable_sort(starts.begin(), starts.end(), [](const auto& a, const auto& b) { return a.cost < b.cost; });
  for (std::size_t i = 0; i < std::min(count, starts.size()); ++i) {
    refined.push_back(problem.refine(std::move(starts[i].sum), scouting));
  }
}

double place(const TermProblem& problem, int i, int places) {
  const double first = problem.log_lower() - search_margin, last = problem.log_upper() + search_margin;
  return first + (last - first) * i / (places - 1);
}

/// Sums with a term more, refined.
std::vector<TermFit> extended(const TermProblem& problem, const TermSum& sum) {
  std::vector<TermFit> fits;
  for (const double order : {0.0, 1.0, -1.0}) {
    const Term power{Term::Kind::power, order, true};
    const bool there = std::any_of(sum.begin(), sum.end(), [&](const Term& term) { return same_power(term, power); });
    if (!there && !sum.empty()) fits.push_back(problem.refine(with(sum, power), scouting));
  }
  if (spreads_in(sum) >= most_spreads) return fits;
  constexpr int places = 12;
  constexpr std::size_t tried = 4;
  for (const Term::Kind kind : spreads) {
    std::vector<TermFit> starts;
    for (const double width : {0.3, 1.0, 3.0}) {
      std::vector<Term> along;
      along.reserve(places);
      for (int i = 0; i < places; ++i) {
        along.push_back(spread(kind, place(problem, i, places), width));
      }
      add_local_minima(problem.along(sum, along), starts);
    }
    refine_best(problem, std::move(starts), tried, fits);
  }
  return fits;
}

/// A constant and two spreads, which no spread alone comes near: the best of a lattice, refined.
std::vector<TermFit> pairs(const TermProblem& problem) {
  constexpr int places = 9;
  constexpr std::size_t tried = 4;
  std::vector<TermFit> starts;
  for (const double width : {0.4, 1.0, 2.0}) {
    const auto at = [&](int i) { return spread(Term::Kind::normal_spread, place(problem, i, places), width); };
    for (int i = 0; i + 1 < places; ++i) {
      std::vector<Term> others;
      for (int k = i + 1; k < places; ++k) others.push_back(at(k));
      add_local_minima(problem.along({constant, at(i)}, others), starts);
    }
  }
  std::vector<TermFit> fits;
  refine_best(problem, std::move(starts), tried, fits);
  return fits;
}

/// Grows until two further terms in a row do not pay.
TermFit grown(const TermProblem& problem) {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  TermFit best{{}, infinity, 0};
  std::vector<TermSum> sums{{}, {constant}};
  for (int in_vain = 0; in_vain < 2 && !sums.empty();) {
    std::vector<TermFit> fits;
    for (const TermSum& sum : sums) {
      for (TermFit& fit : extended(problem, sum)) fits.push_back(std::move(fit));
    }
    if (!std::isfinite(best.cost)) {
      for (TermFit& fit : pairs(problem)) fits.push_back(std::move(fit));
    }
    std::stable_sort(fits.begin(), fits.end(),
                     [&](const auto& a, const auto& b) { return value_of(problem, a) < value_of(problem, b); });
    sums.clear();
    constexpr std::size_t kept = 2;
    ++in_vain;
    for (std::size_t i = 0; i < std::min(kept, fits.size()) && std::isfinite(fits[i].cost); ++i) {
      TermFit fit = problem.refine(fits[i].sum, thorough);
      sums.push_back(fit.sum);
      if (std::isfinite(best.cost) && !(value_of(problem, fit) < value_of(problem, best))) continue;
      best = std::move(fit);
      in_vain = 0;
    }
  }
  return best;
}

std::string number(double value) {
  return short_text(value, 4);
}

/// "0.99 + 2.01/(1 + s t), ln t normal about ln(0.021 s), deviation 0.9"
std::string in_words(const TermProblem& problem, const TermSum& sum) {
  const std::vector<double> coefficients = problem.coefficients(sum);
  std::string text, spread;
  for (std::size_t k = 0; k < sum.size(); ++k) {
    const Term& term = sum[k];
    const double size = coefficients[k];
    text += (k > 0 ? size < 0 ? " - " : " + " : size < 0 ? "-" : "") + number(std::abs(size));
    if (!term.is_spread()) {
      text += term.order > 0 ? " s" : term.order < 0 ? "/s" : "";
      continue;
    }
    const std::string name =
        spreads_in(sum) > 1
            ? "t" + std::to_string(spreads_in({sum.begin(), sum.begin() + static_cast<std::ptrdiff_t>(k) + 1}))
            : "t";
    text += "/(1 + s " + name + ")";
    const double centre = std::exp(-term.log_size) / problem.centre_omega(), width = std::exp(term.log_width);
    spread += term.kind == Term::Kind::normal_spread
                  ? ", ln " + name + " normal about ln " + number(centre) + " s with deviation " + number(width)
                  : ", ln " + name + " even from ln " + number(centre * std::exp(-width)) + " s to ln " +
                        number(centre * std::exp(width)) + " s";
  }
  return text + spread;
}

}  // namespace

std::optional<DistributionRival> distribution_rival(const FrequencyResponseData& data, const FitOptions& options,
                                                    const Competitor& fractional, double share) {
  if (options.component == Component::magnitude || options.component == Component::phase) return std::nullopt;
  const ResidualRule rule = residual_rule(data, options);
  const TermProblem problem(data, rule);
  constexpr std::size_t scouted = 200;
  const Thinned few = thinned(data, rule, scouted);
  const bool many = few.data.size() < data.size();
  TermFit fit = grown(many ? TermProblem(few.data, few.rule) : problem);
  constexpr Effort to_the_end{200, 1e-11};  // evidence is told to four digits
  fit = problem.refine(std::move(fit.sum), to_the_end);
  const std::vector<std::complex<double>> response = problem.response(fit.sum);
  if (response.empty()) return std::nullopt;

  Competitor rival;
  rival.residual = curve_residuals(data, rule, response);
  const Information found = information(rival.residual, static_cast<double>(fit.parameters), rule.unit);
  rival.ranked.fit.bic = found.bic;
  rival.ranked.fit.free_parameters = fit.parameters;
  rival.ranked.lack_of_fit =
      residual_tests(rival.residual, rule.per_point(), data.omega(), fit.parameters, false, 1e-12 * rule.unit);
  return DistributionRival{in_words(problem, fit.sum), fit.parameters, found.rms / rule.unit,
                           evidence_for(fractional, rival, share)};
}

}  // namespace frac::detail
