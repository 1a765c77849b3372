// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <set>
#include <utility>
#include <vector>

#include "economy_search.hpp"
#include "identification/rational/term_growth.hpp"
#include "identification/rational/term_problem.hpp"

namespace frac::detail {
namespace {

/// What a term adds to the parameters: its coefficient and what is searched for.
std::size_t price(const Term& term) {
  return 1 + term.nonlinear();
}

bool cheaper(const TermFit& a, const TermFit& b) {
  return a.cost < b.cost;
}

constexpr std::ptrdiff_t most_modes = 2;  // as in TermFamily

/// Lines of terms of one kind and one order along the places of the band and its margins, or along orders.
std::vector<std::vector<Term>> lines_of_terms(const TermProblem& problem) {
  std::vector<std::vector<Term>> lines;
  for (const double order : {-1.0, 0.0, 1.0}) lines.push_back({{Term::Kind::power, order, true, 0, 0}});
  lines.emplace_back();
  for (double order = -most_power; order <= most_power; order += 0.25) {
    lines.back().push_back({Term::Kind::power, order, false, 0, 0});
  }
  constexpr int places = 14;
  constexpr double margin = 3;
  const double first = problem.log_lower() - margin, last = problem.log_upper() + margin;
  const auto add = [&](Term term) {
    lines.emplace_back();
    for (int i = 0; i < places; ++i) {
      term.log_size = first + (last - first) * i / (places - 1);
      lines.back().push_back(term);
    }
  };
  add({Term::Kind::arc, 1, true, 0, 0});
  for (const double order : {0.9, 0.6, 0.3}) add({Term::Kind::arc, order, false, 0, 0});
  for (const double top : {0.0, 1.0}) {
    for (const double damping : {0.05, 0.4}) add({Term::Kind::mode, top, true, 0, std::log(damping)});
  }
  return lines;
}

bool allowed(const TermSum& sum, const Term& next) {
  const auto same = [&](const Term& term) { return next.held && term.held && same_power(term, next); };
  const auto is_mode = [](const Term& term) { return term.kind == Term::Kind::mode; };
  return std::none_of(sum.begin(), sum.end(), same) &&
         (!is_mode(next) || std::count_if(sum.begin(), sum.end(), is_mode) < most_modes);
}

/// How many terms of each kind, held orders each a kind of their own.
using Composition = std::vector<std::pair<double, double>>;
Composition composition(const TermSum& sum) {
  Composition kinds;
  for (const Term& term : sum) {
    kinds.emplace_back(static_cast<double>(term.kind), term.held ? term.order : infinity);
  }
  std::sort(kinds.begin(), kinds.end());
  return kinds;
}

bool is_fractional(const Term& term) {
  return !is_whole(term.order);
}

}  // namespace

namespace {

class TermSearch {
 public:
  explicit TermSearch(const TermProblem& problem) : problem_(problem), lines_(lines_of_terms(problem)) {}

  /// The best sums with one number of parameters more than at the last call, best first, one of each composition.
  const std::vector<TermFit>& grow() {
    const std::size_t count = sums_.size();
    std::vector<TermFit> grown;
    for (std::size_t step = 1; step <= std::min<std::size_t>(count, 3); ++step) {
      for (const TermFit& parent : sums_[count - step]) extend(parent.sum, step, grown);
    }
    std::vector<TermFit> best;
    keep_best(std::move(grown), best);
    // A term that suited a smaller sum may suit the larger one elsewhere, or as one of another kind.
    constexpr std::size_t exchanged = 3;
    std::vector<TermFit> swapped;
    for (std::size_t i = 0; i < std::min(exchanged, best.size()); ++i) {
      for (std::size_t k = 0; k < best[i].sum.size(); ++k) {
        TermSum rest = best[i].sum;
        rest.erase(rest.begin() + static_cast<std::ptrdiff_t>(k));
        if (!rest.empty()) extend(rest, price(best[i].sum[k]), swapped);
      }
    }
    keep_best(std::move(swapped), best);
    sums_.push_back(std::move(best));
    return sums_.back();
  }

 private:
  /// Appends the sum with each term of that price at those of its places that are best.
  void extend(const TermSum& sum, std::size_t step, std::vector<TermFit>& refined) const {
    constexpr std::size_t refined_of_kind = 3;
    for (const std::vector<Term>& line : lines_) {
      if (price(line.front()) != step || !allowed(sum, line.front())) continue;
      std::vector<TermFit> starts;
      add_local_minima(problem_.along(sum, line), starts);
      std::stable_sort(starts.begin(), starts.end(), cheaper);
      for (std::size_t i = 0; i < std::min(refined_of_kind, starts.size()); ++i) {
        refined.push_back(problem_.refine(std::move(starts[i].sum), thorough));
      }
    }
  }

  /// Puts the best of each composition to those that are there.
  void keep_best(std::vector<TermFit> fits, std::vector<TermFit>& best) const {
    constexpr std::size_t beam = 12;
    std::stable_sort(fits.begin(), fits.end(), cheaper);
    std::set<Composition> seen;
    for (TermFit& fit : fits) {
      if (!std::isfinite(fit.cost) || seen.size() == beam) break;
      const Composition kinds = composition(fit.sum);
      if (!seen.insert(kinds).second) continue;
      const auto same =
          std::find_if(best.begin(), best.end(), [&](const TermFit& other) { return composition(other.sum) == kinds; });
      if (same != best.end() && !(fit.cost < same->cost)) continue;
      TermFit ended = problem_.refine(std::move(fit.sum), to_the_end);
      if (same == best.end()) {
        best.push_back(std::move(ended));
      } else {
        *same = std::move(ended);
      }
    }
    std::stable_sort(best.begin(), best.end(), cheaper);
    if (best.size() > beam) best.resize(beam);
  }

  const TermProblem& problem_;
  std::vector<std::vector<Term>> lines_;
  std::vector<std::vector<TermFit>> sums_{{{{}, problem_.data_power(), 0}}};  // by parameters
};

}  // namespace

// A beam: of each number of parameters the best sum of each composition is kept, as the best one grows from parts that
// are nothing alone.  Each gets each kind of term at each of its places that is a local minimum, and the best of these
// are refined.
EconomyCurve economy_of_terms(const EconomyProblem& given) {
  constexpr std::size_t points = 48, ended = 6;
  const Thinned few = scouted(given, points);
  const TermProblem scout(few.data, few.rule), problem(given.data, given.rule);
  EconomyCurve curve{std::string(to_string(EconomyClass::terms)), EconomyClass::terms, {}};
  TermSearch search(scout);
  for (std::size_t count = 1; count <= given.options.most_parameters; ++count) {
    const std::vector<TermFit>& sums = search.grow();
    TermFit best{{}, infinity, 0};
    for (std::size_t i = 0; i < std::min(ended, sums.size()); ++i) {
      TermFit end = problem.refine(sums[i].sum, to_the_end);
      if (end.cost < best.cost) best = std::move(end);
    }
    if (!std::isfinite(best.cost)) continue;
    const bool fractional = std::any_of(best.sum.begin(), best.sum.end(), is_fractional);
    const double error = economy_error(given, best.cost);
    add_point(curve, {count, error, false, fractional, with_numbers(written_out(problem, best.sum))});
    if (error <= economy_rounding) break;
  }
  return curve;
}

}  // namespace frac::detail
