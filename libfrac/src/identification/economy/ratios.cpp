// SPDX-License-Identifier: BSD-3-Clause
#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <map>
#include <span>
#include <utility>
#include <vector>

#include "economy_search.hpp"
#include "identification/rational/rational_model.hpp"
#include "identification/rational/rational_problem.hpp"
#include "identification/search/triangular_form.hpp"

namespace frac::detail {
namespace {

using Index = Eigen::Index;

/// z^offset (c_0 + ... + c_{coefficients - 1} z^{coefficients - 1}), a numerator.
struct Numerator {
  int offset;
  std::size_t coefficients;
  std::size_t seen;  // coefficients that the component tells apart
};

RationalShape shape_of(const Numerator& numerator, const RationalShape& from) {
  RationalShape shape = from;
  shape.integrators = numerator.offset < 0 ? static_cast<std::size_t>(-numerator.offset) : 0;
  shape.low = numerator.offset > 0 ? static_cast<std::size_t>(numerator.offset) : 0;
  shape.degree = shape.low + numerator.coefficients - 1;
  return shape;
}

constexpr int largest_offset = 4;

/// Sorts, best first, and leaves so many that differ.
void keep_best(std::vector<RationalFit>& fits, std::size_t most) {
  constexpr double alike = 1e-4;
  std::stable_sort(fits.begin(), fits.end(), [](const auto& a, const auto& b) { return a.cost < b.cost; });
  std::vector<RationalFit> best;
  for (RationalFit& fit : fits) {
    if (best.size() == most || !std::isfinite(fit.cost)) break;
    if (best.empty() || fit.cost > best.back().cost * (1 + alike)) best.push_back(std::move(fit));
  }
  fits = std::move(best);
}

/// A numerator over denominators of one number of poles.
struct Ratio {
  Numerator numerator;
  std::vector<RationalFit> starts, found;  // found: best first
};

class Ratios {
 public:
  Ratios(const EconomyProblem& given, EconomyClass model_class)
      : given_(given),
        free_order_(model_class == EconomyClass::commensurate),
        most_(given.options.most_parameters - (free_order_ ? 1 : 0)),
        full_(given.data, given.rule, Poles::left_half_plane),
        scout_(thin(given)) {}

  EconomyCurve curve(EconomyClass model_class) {
    EconomyCurve result{std::string(to_string(model_class)), model_class, {}};
    std::vector<std::vector<RationalFit>> by_count(most_);
    search();
    for (std::size_t poles = 0; poles < most_; ++poles) {
      for (const Ratio& ratio : by_poles_[poles]) {
        auto& all = by_count[poles + ratio.numerator.seen - 1];
        all.insert(all.end(), ratio.found.begin(), ratio.found.end());
      }
    }
    for (std::size_t count = 1; count <= most_; ++count) {
      constexpr std::size_t ended = 4;
      keep_best(by_count[count - 1], ended);
      RationalFit best{{}, infinity, 0};
      for (const RationalFit& fit : by_count[count - 1]) {
        RationalFit end = full_.refine(fit.shape, to_the_end);
        if (end.cost < best.cost) best = std::move(end);
      }
      if (!std::isfinite(best.cost)) continue;
      const NamedModel model = written_out(full_, best.shape, given_.options.component);
      const bool fractional = best.shape.searches_order() && !is_whole(best.shape.order);
      const double error = economy_error(given_, best.cost);
      add_point(result, {count + (free_order_ ? 1 : 0), error, false, fractional, with_numbers(model)});
      if (error <= economy_rounding) break;
    }
    return result;
  }

 private:
  static RationalProblem thin(const EconomyProblem& given) {
    constexpr std::size_t points = 32;  // four times as many as parameters
    const Thinned few = scouted(given, points);
    return RationalProblem(few.data, few.rule, Poles::left_half_plane);
  }

  /// Numerators over so many poles that leave the parameters within the limit, each once.
  [[nodiscard]] std::vector<Ratio> ratios(std::size_t poles) const {
    std::vector<Ratio> result;
    const bool by_parity = !free_order_ && full_.one_part();
    const int parity = given_.options.component == Component::imaginary ? 1 : 0;
    std::vector<std::pair<int, std::size_t>> complete;
    const std::size_t most_seen = most_ - poles;
    for (std::size_t coefficients = 1; coefficients <= (by_parity ? 2 : 1) * most_seen; ++coefficients) {
      for (int offset = -largest_offset; offset <= largest_offset; ++offset) {
        std::size_t seen = coefficients;
        if (by_parity) {
          // Of one component of a ratio in s the numerator times the conjugate denominator is seen at every other
          // power.  Numerators of all that is seen are alike for all with these powers.
          const int last = offset + static_cast<int>(coefficients + poles) - 1,
                    first = offset + (std::abs(offset % 2) == parity ? 0 : 1);
          const std::size_t powers = first > last ? 0 : static_cast<std::size_t>((last - first) / 2 + 1);
          seen = std::min(seen, powers);
          if (seen == powers) {
            const std::pair key{first, powers};
            if (std::find(complete.begin(), complete.end(), key) != complete.end()) continue;
            complete.push_back(key);
          }
        }
        if (seen > 0 && seen <= most_seen) result.push_back({{offset, coefficients, seen}, {}, {}});
      }
    }
    return result;
  }

  /// A parent's denominator with a factor of so many roots more, or none, along a lattice of order, damping and place.
  struct Lattice {
    RationalShape parent;
    std::size_t roots;
    std::vector<double> orders, dampings, places;

    [[nodiscard]] std::size_t size() const { return orders.size() * dampings.size() * places.size(); }
    [[nodiscard]] RationalShape at(std::size_t i) const {
      RationalShape shape = parent;
      const std::size_t line = i / places.size();
      shape.order = orders[line / dampings.size()];
      if (roots > 0)
        shape.factors.push_back({roots == 2, places[i % places.size()], dampings[line % dampings.size()], 1});
      return shape;
    }
    /// Whether none beside it is less.
    [[nodiscard]] bool is_minimum(const std::vector<double>& cost, std::size_t i) const {
      std::size_t stride = 1;
      for (const std::size_t length : {places.size(), dampings.size(), orders.size()}) {
        const std::size_t along = i / stride % length;
        if (along > 0 && !(cost[i] <= cost[i - stride])) return false;
        if (along + 1 < length && !(cost[i] < cost[i + stride])) return false;
        stride *= length;
      }
      return true;
    }
  };

  [[nodiscard]] Lattice lattice(const RationalShape& parent, std::size_t roots) const {
    Lattice result{parent, roots, {parent.order}, {0}, {0}};
    if (parent.free_order && parent.factors.empty()) result.orders = spread(least_order, most_order, 11);
    if (roots == 2) result.dampings = {0.03, 0.25, 0.6};
    constexpr double margin = 3;
    if (roots > 0) {
      result.places = spread(scout_.log_lower() - margin, scout_.log_upper() + margin, roots == 2 ? 10 : 12);
    }
    return result;
  }

  static std::vector<double> spread(double first, double last, int count) {
    std::vector<double> values;
    for (int i = 0; i < count; ++i) values.push_back(first + (last - first) * i / (count - 1));
    return values;
  }

  /// What each numerator of the list leaves over a denominator, infinite where its offset is beyond the limits.  One
  /// triangular form for each offset tells it of every number of coefficients.
  [[nodiscard]] std::vector<double> costs(const RationalShape& denominator, const std::vector<Ratio>& list, int first,
                                          int last) const {
    std::vector<double> result(list.size(), infinity);
    std::size_t most = 1;
    for (const Ratio& ratio : list) most = std::max(most, ratio.numerator.coefficients);
    RationalShape plain = denominator;
    plain.integrators = plain.low = plain.degree = 0;
    const Eigen::VectorXcd inverse = scout_.columns(plain).col(0);
    Eigen::MatrixXcd columns(inverse.size(), last - first + static_cast<int>(most));
    const Eigen::ArrayXcd z = free_order_ ? scout_.power(denominator.order) : scout_.s().array();
    for (Index k = 0; k < columns.cols(); ++k) {
      if (k == 0) {
        columns.col(0) = (inverse.array() * scout_.power(denominator.order * first)).matrix();
      } else {
        columns.col(k) = (columns.col(k - 1).array() * z).matrix();
      }
    }
    const auto seen = scout_.weighted(columns);
    if (!seen) return result;
    const std::size_t rows = scout_.rows();
    std::vector<double> of_offset(most), triangle((most + 1) * (most + 1));
    for (int offset = first; offset <= last; ++offset) {
      const std::span<const double> window(seen->matrix.col(offset - first).data(), most * rows);
      triangular_form(window, {scout_.target().data(), rows}, triangle);
      // The last column holds what each further one takes from the data; one that depends on those before takes none.
      double left = std::pow(triangle.back(), 2);
      const auto taken = [&](std::size_t k) { return std::pow(triangle[k * (most + 1) + most], 2); };
      const auto is_dependent = [&](std::size_t k) { return std::abs(triangle[k * (most + 2)]) <= 1e-11; };
      for (std::size_t k = 0; k < most; ++k) left += is_dependent(k) ? taken(k) : 0;
      for (std::size_t k = most; k-- > 0;) {
        of_offset[k] = left;
        left += is_dependent(k) ? 0 : taken(k);
      }
      for (std::size_t i = 0; i < list.size(); ++i) {
        if (list[i].numerator.offset == offset) result[i] = of_offset[list[i].numerator.coefficients - 1];
      }
    }
    return result;
  }

  /// Adds to the starts of numerators about a parent's the minima of a lattice.
  void add_minima(const Lattice& all, std::vector<Ratio>& list, int first, int last) const {
    std::vector<std::vector<double>> along(list.size(), std::vector<double>(all.size()));
    for (std::size_t i = 0; i < all.size(); ++i) {
      const std::vector<double> each = costs(all.at(i), list, first, last);
      for (std::size_t k = 0; k < list.size(); ++k) along[k][i] = each[k];
    }
    for (std::size_t k = 0; k < list.size(); ++k) {
      for (std::size_t i = 0; i < all.size(); ++i) {
        if (std::isfinite(along[k][i]) && all.is_minimum(along[k], i)) add_start(list[k], all.at(i), along[k][i]);
      }
    }
  }
  static void add_start(Ratio& ratio, const RationalShape& denominator, double cost) {
    ratio.starts.push_back({shape_of(ratio.numerator, denominator), cost, 0});
  }

  /// A few steps from the best starts of each ratio, and to the end from the best of these for each number of
  /// coefficients.
  void refine(std::vector<Ratio>& list, std::size_t tried) const {
    constexpr std::size_t kept = 3, ended = 12;
    constexpr double hopeless = 1e4;  // a few steps seldom take a start below the hundredth part of its error
    constexpr Effort few_steps{4, scouting.tolerance};
    std::map<std::size_t, double> least;
    for (const Ratio& ratio : list) {
      double& cost = least.try_emplace(ratio.numerator.seen, infinity).first->second;
      for (const auto* fits : {&ratio.starts, &ratio.found}) {
        for (const RationalFit& fit : *fits) cost = std::min(cost, fit.cost);
      }
    }
    std::map<std::size_t, std::vector<std::pair<Ratio*, RationalFit>>> begun;
    for (Ratio& ratio : list) {
      keep_best(ratio.starts, tried);
      std::vector<RationalFit> fits;
      for (const RationalFit& start : ratio.starts) {
        if (start.cost <= hopeless * least[ratio.numerator.seen]) {
          fits.push_back(scout_.refine(start.shape, few_steps));
        }
      }
      ratio.starts.clear();
      keep_best(fits, kept);
      for (RationalFit& fit : fits) begun[ratio.numerator.seen].emplace_back(&ratio, std::move(fit));
    }
    for (auto& [seen, all] : begun) {
      std::stable_sort(all.begin(), all.end(),
                       [](const auto& a, const auto& b) { return a.second.cost < b.second.cost; });
      for (std::size_t i = 0; i < all.size(); ++i) {
        auto& [ratio, fit] = all[i];
        ratio->found.push_back(i < ended ? scout_.refine(fit.shape, thorough) : std::move(fit));
      }
    }
    for (Ratio& ratio : list) keep_best(ratio.found, kept);
  }

  /// Of each number of coefficients the best ratios of all offsets.
  [[nodiscard]] static std::vector<std::pair<int, RationalShape>> best_of(const std::vector<Ratio>& list,
                                                                          std::size_t most) {
    std::vector<std::pair<int, RationalShape>> result;
    std::size_t largest = 0;
    for (const Ratio& ratio : list) largest = std::max(largest, ratio.numerator.seen);
    for (std::size_t seen = 1; seen <= largest; ++seen) {
      std::vector<RationalFit> best;
      for (const Ratio& ratio : list) {
        if (ratio.numerator.seen == seen) best.insert(best.end(), ratio.found.begin(), ratio.found.end());
      }
      keep_best(best, most);
      for (const RationalFit& fit : best) {
        result.emplace_back(static_cast<int>(fit.shape.low) - static_cast<int>(fit.shape.integrators), fit.shape);
      }
    }
    return result;
  }

  /// Starts of a parent with a factor of so many roots more, for numerators about its own.
  void grow(const std::pair<int, RationalShape>& from, std::size_t roots, std::vector<Ratio>& list) const {
    const int around = !free_order_ && full_.one_part() ? 2 : 1;  // every other power is seen
    add_minima(lattice(from.second, roots), list, std::max(-largest_offset, from.first - around),
               std::min(largest_offset, from.first + around));
  }

  /// A denominator as a start of every numerator.
  void offer(const RationalShape& denominator, std::vector<Ratio>& list) const {
    const std::vector<double> each = costs(denominator, list, -largest_offset, largest_offset);
    for (std::size_t k = 0; k < list.size(); ++k) add_start(list[k], denominator, each[k]);
  }

  static RationalShape without(RationalShape shape, std::size_t factor) {
    shape.factors.erase(shape.factors.begin() + static_cast<std::ptrdiff_t>(factor));
    return shape;
  }

  /// From the best of fewer poles, with a factor more.
  void add_from_fewer(std::size_t poles, std::size_t parents, std::vector<Ratio>& list) const {
    for (std::size_t roots = 1; roots <= std::min<std::size_t>(poles, 2); ++roots) {
      for (const auto& parent : best_of(by_poles_[poles - roots], parents)) grow(parent, roots, list);
    }
  }
  /// From the best of more poles, with a factor less.
  void add_from_more(std::size_t poles, std::size_t parents, std::vector<Ratio>& list) const {
    for (std::size_t roots = 1; roots <= 2 && poles + roots < most_; ++roots) {
      for (const auto& [offset, shape] : best_of(by_poles_[poles + roots], parents)) {
        for (std::size_t k = 0; k < shape.factors.size(); ++k) {
          if (shape.factors[k].pair == (roots == 2)) offer(without(shape, k), list);
        }
      }
    }
  }

  /// A ratio that meets the data to rounding ends the curve: no longer one is looked for.
  void end_at_exact(const std::vector<Ratio>& list, std::size_t poles) {
    const auto is_exact = [&](const RationalFit& fit) { return economy_error(given_, fit.cost) <= economy_rounding; };
    for (const Ratio& ratio : list) {
      const std::size_t count = poles + ratio.numerator.seen;
      if (count >= most_ || ratio.found.empty() || !is_exact(ratio.found.front())) continue;
      if (is_exact(full_.refine(ratio.found.front().shape, to_the_end))) most_ = count;
    }
  }

  /// Upwards in the number of poles, and once down and up again: what suits a larger ratio may have escaped the smaller
  /// one.
  void search() {
    constexpr std::size_t parents = 4, fewer_parents = 2, exchanged = 4, tried = 8, tried_again = 4;
    RationalShape none;
    none.free_order = free_order_;
    for (std::size_t poles = 0; poles < most_; ++poles) {
      std::vector<Ratio>& list = by_poles_.emplace_back(ratios(poles));
      if (poles <= 2) add_minima(lattice(none, poles), list, -largest_offset, largest_offset);
      add_from_fewer(poles, parents, list);
      refine(list, tried);
      // A denominator that suits one numerator may suit another, and a factor that suited a smaller ratio may suit the
      // larger one elsewhere.
      for (const auto& [offset, shape] : best_of(list, exchanged)) {
        offer(shape, list);
        for (std::size_t k = 0; k < shape.factors.size(); ++k) {
          grow({offset, without(shape, k)}, shape.factors[k].pair ? 2 : 1, list);
        }
      }
      refine(list, tried_again);
      end_at_exact(list, poles);
    }
    for (std::size_t poles = most_; poles-- > 0;) {
      add_from_more(poles, exchanged, by_poles_[poles]);
      refine(by_poles_[poles], tried_again);
    }
    for (std::size_t poles = 1; poles < most_; ++poles) {
      add_from_fewer(poles, fewer_parents, by_poles_[poles]);
      refine(by_poles_[poles], tried_again);
    }
  }

  const EconomyProblem& given_;
  bool free_order_;
  std::size_t most_;  // parameters, the order apart
  RationalProblem full_, scout_;
  std::vector<std::vector<Ratio>> by_poles_;
};

}  // namespace

EconomyCurve economy_of_ratios(const EconomyProblem& problem, EconomyClass model_class) {
  return Ratios(problem, model_class).curve(model_class);
}

}  // namespace frac::detail
