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

constexpr Term constant = whole_power(0);

Term spread(Term::Kind kind, double log_size, double width) {
  return {.kind = kind, .held = true, .log_size = log_size, .log_width = std::log(width)};
}

/// Sums with a term more, refined.
std::vector<TermFit> extended(const TermProblem& problem, const TermSum& sum) {
  std::vector<TermFit> fits;
  for (const double order : {0.0, 1.0, -1.0}) {
    const Term power = whole_power(order);
    const bool there = std::any_of(sum.begin(), sum.end(), [&](const Term& term) { return same_power(term, power); });
    if (!there && !sum.empty()) fits.push_back(problem.refine(with_term(sum, power), scouting));
  }
  if (spreads_in(sum) >= most_spreads) return fits;
  constexpr std::size_t tried = 4;
  for (const Term::Kind kind : spreads) {
    std::vector<TermFit> starts;
    for (const double width : {0.3, 1.0, 3.0}) {
      std::vector<Term> along;
      for (const double at : places(problem, 12)) along.push_back(spread(kind, at, width));
      add_local_minima(problem.along(sum, along), starts);
    }
    problem.refine_best(std::move(starts), tried, fits);
  }
  return fits;
}

/// A constant and two spreads, which no spread alone comes near: the best of a lattice, refined.
std::vector<TermFit> pairs(const TermProblem& problem) {
  constexpr std::size_t tried = 4;
  std::vector<TermFit> starts;
  for (const double width : {0.4, 1.0, 2.0}) {
    std::vector<Term> along;
    for (const double at : places(problem, 9)) along.push_back(spread(Term::Kind::normal_spread, at, width));
    for (auto next = along.begin(); next + 1 != along.end(); ++next) {
      add_local_minima(problem.along({constant, *next}, {next + 1, along.end()}), starts);
    }
  }
  std::vector<TermFit> fits;
  problem.refine_best(std::move(starts), tried, fits);
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
