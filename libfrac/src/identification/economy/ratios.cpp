// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <compare>
#include <map>
#include <utility>

#include "economy_search.hpp"
#include "identification/rational/rational_model.hpp"
#include "identification/rational/rational_problem.hpp"
#include "identification/search/thinned.hpp"

namespace frac::detail {
namespace {

/// z^offset (c_0 + ... + c_{coefficients - 1} z^{coefficients - 1}) over a polynomial with that many roots.
struct RatioSize {
  std::size_t poles;
  std::size_t coefficients;
  int offset;
  auto operator<=>(const RatioSize&) const = default;
};

RationalShape shape_of(const RatioSize& size, const RationalShape& from, bool free_order) {
  RationalShape shape = from;
  shape.integrators = size.offset < 0 ? static_cast<std::size_t>(-size.offset) : 0;
  shape.low = size.offset > 0 ? static_cast<std::size_t>(size.offset) : 0;
  shape.degree = shape.low + size.coefficients - 1;
  shape.free_order = free_order;
  return shape;
}

constexpr int largest_offset = 4;

class Ratios {
 public:
  Ratios(const EconomyProblem& given, EconomyClass model_class)
      : given_(given),
        free_order_(model_class == EconomyClass::commensurate),
        full_(given.data, given.rule, Poles::stable),
        scout_(thin(given)) {}

  EconomyCurve curve(EconomyClass model_class) {
    EconomyCurve result{std::string(to_string(model_class)), model_class, {}};
    const std::size_t own = free_order_ ? 1 : 0;  // the order
    for (std::size_t count = 1; count + own <= given_.options.most_parameters; ++count) {
      const std::vector<RatioSize> sizes = sizes_of(count);
      std::vector<RationalFit> scouted;
      for (const RatioSize& size : sizes) search(size, scouted);
      std::stable_sort(scouted.begin(), scouted.end(), cheaper);
      exchange(sizes, scouted);
      std::stable_sort(scouted.begin(), scouted.end(), cheaper);
      RationalFit best{{}, infinity, 0};
      constexpr std::size_t tried = 6;
      for (std::size_t i = 0; i < std::min(tried, scouted.size()); ++i) {
        RationalFit fit = full_.refine(scouted[i].shape, to_the_end);
        if (fit.cost < best.cost) best = std::move(fit);
      }
      if (!std::isfinite(best.cost)) continue;
      const NamedModel model = written_out(full_, best.shape, given_.options.component);
      const bool fractional = best.shape.searches_order() && !is_whole(best.shape.order);
      const double error = economy_error(given_, best.cost);
      add_point(result, {count + own, error, false, fractional, with_numbers(model)});
      if (error <= economy_rounding) break;
    }
    return result;
  }

 private:
  static bool cheaper(const RationalFit& a, const RationalFit& b) { return a.cost < b.cost; }

  static RationalProblem thin(const EconomyProblem& given) {
    constexpr std::size_t scouted = 48;  // six times as many as parameters
    const Thinned few = thinned(given.data, given.rule, scouted);
    return RationalProblem(few.data, few.rule, Poles::stable);
  }

  /// Coefficients that the component tells apart.  Of one component of a ratio in s the numerator times the conjugate
  /// denominator is seen at every other power.
  [[nodiscard]] std::size_t seen(const RatioSize& size) const {
    if (free_order_ || !full_.one_part()) return size.coefficients;
    return std::min(size.coefficients, powers(size).second);
  }
  /// The lowest power of omega that is seen, and how many are.
  [[nodiscard]] std::pair<int, std::size_t> powers(const RatioSize& size) const {
    const int parity = given_.options.component == Component::imaginary ? 1 : 0;
    const int last = size.offset + static_cast<int>(size.coefficients + size.poles) - 1;
    const int first = size.offset + ((size.offset % 2 + 2) % 2 == parity ? 0 : 1);
    return {first, first > last ? 0 : static_cast<std::size_t>((last - first) / 2 + 1)};
  }

  /// All shapes with that many parameters, each once.
  [[nodiscard]] std::vector<RatioSize> sizes_of(std::size_t count) const {
    std::vector<RatioSize> sizes;
    std::vector<std::pair<std::size_t, std::pair<int, std::size_t>>> complete;
    for (std::size_t poles = 0; poles < count; ++poles) {
      for (int offset = -largest_offset; offset <= largest_offset; ++offset) {
        for (std::size_t coefficients = count - poles; coefficients <= 2 * (count - poles); ++coefficients) {
          const RatioSize size{poles, coefficients, offset};
          const std::size_t visible = seen(size);
          if (visible != count - poles) continue;
          if (!free_order_ && full_.one_part() && visible == powers(size).second) {
            // Numerators of all that is seen: alike for all shapes with these powers.
            const std::pair key{poles, powers(size)};
            if (std::find(complete.begin(), complete.end(), key) != complete.end()) continue;
            complete.push_back(key);
          }
          sizes.push_back(size);
        }
      }
    }
    return sizes;
  }

  [[nodiscard]] const std::vector<RationalFit>& found(const RatioSize& size) const {
    static const std::vector<RationalFit> none;
    const auto at = found_.find(size);
    return at == found_.end() ? none : at->second;
  }

  /// Smaller shapes that the one contains with so many poles less, or with other numerators over the same.
  [[nodiscard]] std::vector<RationalShape> parents(const RatioSize& size, std::size_t fewer) const {
    std::vector<RationalShape> result;
    if (fewer == size.poles) {
      result.emplace_back();
      return result;
    }
    for (const auto& [other, fits] : found_) {
      if (other.poles + fewer != size.poles || other.coefficients > size.coefficients) continue;
      const int last = size.offset + static_cast<int>(size.coefficients),
                other_last = other.offset + static_cast<int>(other.coefficients);
      if (std::abs(size.offset - other.offset) > 1 || std::abs(last - other_last) > 1) continue;
      for (const RationalFit& fit : fits) result.push_back(fit.shape);
    }
    return result;
  }

  void add_minima(const RatioSize& size, const RationalShape& parent, const PoleFactor& kind, double order, int places,
                  std::vector<RationalFit>& starts) const {
    constexpr double margin = 3;
    const double first = full_.log_lower() - margin, last = full_.log_upper() + margin;
    std::vector<RationalFit> along;
    for (int i = 0; i < places; ++i) {
      RationalShape shape = shape_of(size, parent, free_order_);
      shape.order = order;
      shape.factors.push_back(kind);
      shape.factors.back().log_size = first + (last - first) * i / (places - 1);
      along.push_back(scout_.at(shape));
    }
    add_local_minima(std::move(along), starts);
  }

  /// Appends the best shapes with each of their factors in other places: one that suited a smaller ratio may suit the
  /// larger one elsewhere.
  void exchange(const std::vector<RatioSize>& sizes, std::vector<RationalFit>& all) {
    constexpr std::size_t exchanged = 4, tried = 4;
    const std::vector<RationalFit> best(all.begin(),
                                        all.begin() + static_cast<std::ptrdiff_t>(std::min(exchanged, all.size())));
    for (const RationalFit& fit : best) {
      const auto size = std::find_if(sizes.begin(), sizes.end(), [&](const RatioSize& each) {
        const RationalShape shape = shape_of(each, fit.shape, free_order_);
        std::size_t roots = 0;
        for (const PoleFactor& factor : fit.shape.factors) roots += factor.pair ? 2 : 1;
        return roots == each.poles && shape.low == fit.shape.low && shape.integrators == fit.shape.integrators &&
               shape.degree == fit.shape.degree;
      });
      if (size == sizes.end()) continue;
      std::vector<RationalFit> starts;
      for (std::size_t k = 0; k < fit.shape.factors.size(); ++k) {
        RationalShape rest = fit.shape;
        const bool pair = rest.factors[k].pair;
        rest.factors.erase(rest.factors.begin() + static_cast<std::ptrdiff_t>(k));
        add_factors(*size, rest, rest.order, pair, starts);
      }
      std::stable_sort(starts.begin(), starts.end(), cheaper);
      for (std::size_t i = 0; i < std::min(tried, starts.size()); ++i) {
        if (std::isfinite(starts[i].cost)) all.push_back(scout_.refine(starts[i].shape, scouting));
      }
    }
  }

  /// Appends the parent with one factor more at each local minimum along the band.
  void add_factors(const RatioSize& size, const RationalShape& parent, double order, bool pair,
                   std::vector<RationalFit>& starts) const {
    if (!pair) {
      add_minima(size, parent, {false, 0, 0, 1}, order, 12, starts);
      return;
    }
    for (const double damping : {0.05, 0.4}) add_minima(size, parent, {true, 0, damping, 1}, order, 10, starts);
  }

  void search(const RatioSize& size, std::vector<RationalFit>& all) {
    std::vector<RationalFit> starts;
    const auto orders = [&](const RationalShape& parent) {
      if (!free_order_) return std::vector<double>{1};
      return parent.factors.empty() ? std::vector<double>{0.15, 0.3, 0.5, 0.75, 1, 1.3}
                                    : std::vector<double>{parent.order};
    };
    if (size.poles == 0) {
      for (const double order : orders({})) {
        RationalShape shape = shape_of(size, {}, free_order_);
        shape.order = order;
        starts.push_back(scout_.at(shape));
      }
    }
    if (size.poles > 0) {
      for (const RationalShape& parent : parents(size, 0))
        starts.push_back(scout_.at(shape_of(size, parent, free_order_)));
      for (const std::size_t roots : {1u, 2u}) {
        if (roots > size.poles) continue;
        for (const RationalShape& parent : parents(size, roots)) {
          for (const double order : orders(parent)) add_factors(size, parent, order, roots == 2, starts);
        }
      }
    }
    std::stable_sort(starts.begin(), starts.end(), cheaper);
    constexpr std::size_t tried = 4, kept = 2;
    std::vector<RationalFit> fits;
    for (std::size_t i = 0; i < std::min(tried, starts.size()); ++i) {
      if (!std::isfinite(starts[i].cost)) break;
      fits.push_back(scout_.refine(starts[i].shape, scouting));
    }
    std::stable_sort(fits.begin(), fits.end(), cheaper);
    std::vector<RationalFit>& mine = found_[size];
    for (RationalFit& fit : fits) {
      if (!std::isfinite(fit.cost) || mine.size() == kept) break;
      if (!mine.empty() && fit.cost < mine.back().cost * 1.001) continue;
      all.push_back(fit);
      mine.push_back(std::move(fit));
    }
  }

  const EconomyProblem& given_;
  bool free_order_;
  RationalProblem full_, scout_;
  std::map<RatioSize, std::vector<RationalFit>> found_;
};

}  // namespace

EconomyCurve economy_of_ratios(const EconomyProblem& problem, EconomyClass model_class) {
  return Ratios(problem, model_class).curve(model_class);
}

}  // namespace frac::detail
