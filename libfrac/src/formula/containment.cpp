// SPDX-License-Identifier: BSD-3-Clause
#include "containment.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <complex>
#include <functional>
#include <stdexcept>
#include <utility>

#include "base/linear_algebra.hpp"
#include "dimension_analysis.hpp"
#include "expression.hpp"
#include "reduction.hpp"

namespace frac::detail {
namespace {

using Index = Eigen::Index;
using Known = std::vector<std::optional<double>>;
/// Coefficients of the parameters of the richer structure, as far as they are orders, and a constant behind them.
using Exponent = Eigen::RowVectorXd;

constexpr double rounding = 1e-9;  // of orders and logarithms that follow from a few sums of doubles

/// No sum of such terms, or a power of one that is none.
struct NoForm {};

bool is_whole(double value) {
  return value == std::nearbyint(value);
}
bool is_number(const Eigen::MatrixXd& exponents) {
  return exponents.leftCols(exponents.cols() - 1).isZero(0);
}

/// number times the parameters of the richer structure and, last, s, each to the exponent of its row.
struct Monomial {
  double number;
  Eigen::MatrixXd exponents;
};
Monomial operator*(const Monomial& a, const Monomial& b) {
  return {a.number * b.number, a.exponents + b.exponents};
}
/// Empty where it is no such monomial.
std::optional<Monomial> raised(const Monomial& base, const Exponent& exponent) {
  const double constant = exponent[exponent.size() - 1];
  if (is_number(exponent)) {
    if (base.number < 0 && !is_whole(constant)) return std::nullopt;
    return Monomial{std::pow(base.number, constant), constant * base.exponents};
  }
  if (base.number != 1 || !is_number(base.exponents)) return std::nullopt;
  return Monomial{1, base.exponents.rightCols(1) * exponent};
}

struct Term;
using Sum = std::vector<Term>;
struct Factor {
  Operation function;  // add: the sum itself
  Sum inside;
  Exponent exponent;
};
struct Term {
  Monomial monomial;
  std::vector<Factor> factors;
};

/// Writes expressions as sums of terms.
class Writer {
 public:
  /// @param parameters  of the richer structure
  /// @param expand      products of sums become sums
  Writer(std::size_t parameters, bool expand) : size_(static_cast<Index>(parameters) + 1), expand_(expand) {}

  /// @param known  numbers in the place of parameters; any other is one of the richer structure
  [[nodiscard]] Sum sum(const Expression& expression, const Known& known) const {
    std::vector<Sum> done;
    for (const Node& node : expression.nodes) done.push_back(apply(node, done, known));
    return done.back();
  }

  /// e^{-delay s} numerator/denominator, also divided once where both have the same degree.
  [[nodiscard]] Sum ratio(const RatioOfPowerSums& of, bool divided) const {
    const std::vector<PowerTerm> numerator = plain_terms(of.numerator);
    const std::vector<PowerTerm> denominator = plain_terms(of.denominator);
    if (numerator.empty()) return {};
    Sum whole;
    if (divided && denominator.size() > 1) {
      if (numerator.front().order != denominator.front().order || of.delay != 0) throw NoForm{};
      const double quotient = numerator.front().coefficient / denominator.front().coefficient;
      whole = number(quotient);
      Sum rest = power_sum(numerator);
      for (const PowerTerm& term : denominator) add(power_sum({{-quotient * term.coefficient, term.order}})[0], rest);
      // The leading term cancels but for rounding.
      const double degree = numerator.front().order;
      std::erase_if(rest, [&](const Term& term) { return term.monomial.exponents(size_ - 1, size_ - 1) == degree; });
      for (const Term& term : product(rest, raised(power_sum(denominator), constant(-1)))) add(term, whole);
      return whole;
    }
    whole = product(power_sum(numerator), raised(power_sum(denominator), constant(-1)));
    if (of.delay == 0) return whole;
    return product(whole, {{number(1)[0].monomial, {{Operation::exp, power_sum({{-of.delay, 1}}), constant(1)}}}});
  }

  [[nodiscard]] Exponent constant(double value) const {
    Exponent exponent = Exponent::Zero(size_);
    exponent[size_ - 1] = value;
    return exponent;
  }

 private:
  [[nodiscard]] Sum number(double value) const {
    if (!std::isfinite(value)) throw NoForm{};
    if (value == 0) return {};
    return {{{value, Eigen::MatrixXd::Zero(size_, size_)}, {}}};
  }
  /// A parameter, or s behind them.
  [[nodiscard]] Sum symbol(Index index) const {
    Sum result = number(1);
    result[0].monomial.exponents(index, size_ - 1) = 1;
    return result;
  }
  [[nodiscard]] Sum power_sum(const std::vector<PowerTerm>& terms) const {
    Sum result;
    for (const PowerTerm& term : terms) {
      result.push_back(number(term.coefficient).at(0));
      result.back().monomial.exponents(size_ - 1, size_ - 1) = term.order;
    }
    return result;
  }

  static void add(const Term& term, Sum& sum) {
    const auto same = std::find_if(sum.begin(), sum.end(), [&](const Term& each) {
      return each.factors.empty() && term.factors.empty() && each.monomial.exponents == term.monomial.exponents;
    });
    if (same == sum.end()) {
      sum.push_back(term);
    } else if ((same->monomial.number += term.monomial.number) == 0) {
      sum.erase(same);
    }
  }

  [[nodiscard]] Sum scaled(Sum sum, double factor) const {
    for (Term& term : sum) term.monomial.number *= factor;
    return sum;
  }
  [[nodiscard]] Sum product(const Sum& a, const Sum& b) const {
    if (!expand_ && a.size() > 1) return product({{number(1)[0].monomial, {{Operation::add, a, constant(1)}}}}, b);
    if (!expand_ && b.size() > 1) return product(a, {{number(1)[0].monomial, {{Operation::add, b, constant(1)}}}});
    Sum result;
    for (const Term& left : a) {
      for (const Term& right : b) {
        Term term{left.monomial * right.monomial, left.factors};
        term.factors.insert(term.factors.end(), right.factors.begin(), right.factors.end());
        add(term, result);
      }
    }
    return result;
  }
  [[nodiscard]] Sum raised(const Sum& base, const Exponent& exponent) const {
    if (is_number(exponent) && exponent[size_ - 1] == 0) return number(1);
    if (is_number(exponent) && exponent[size_ - 1] == 1) return base;
    if (base.empty()) throw NoForm{};
    if (base.size() > 1) return {{number(1)[0].monomial, {{Operation::add, base, exponent}}}};
    const auto monomial = detail::raised(base[0].monomial, exponent);
    if (!monomial) throw NoForm{};
    Term term{*monomial, base[0].factors};
    for (Factor& factor : term.factors) {
      const Exponent own = factor.exponent;
      if (!is_number(own) && !is_number(exponent)) throw NoForm{};
      factor.exponent = is_number(own) ? Exponent(own[size_ - 1] * exponent) : Exponent(exponent[size_ - 1] * own);
    }
    return {term};
  }
  /// A sum of orders as what it is in an exponent.
  [[nodiscard]] Exponent as_exponent(const Sum& sum) const {
    Exponent result = constant(0);
    for (const Term& term : sum) {
      const auto& exponents = term.monomial.exponents;
      if (!term.factors.empty() || !is_number(exponents)) throw NoForm{};
      const Eigen::VectorXd powers = exponents.rightCols(1);
      Index place = size_ - 1;
      if (powers.sum() != 0 && (powers.maxCoeff(&place) != 1 || powers.cwiseAbs().sum() != 1)) throw NoForm{};
      result[place] += term.monomial.number;
    }
    return result;
  }

  [[nodiscard]] Sum apply(const Node& node, const std::vector<Sum>& done, const Known& known) const {
    const auto left = [&]() -> const Sum& { return done[static_cast<std::size_t>(node.left)]; };
    const auto right = [&]() -> const Sum& { return done[static_cast<std::size_t>(node.right)]; };
    switch (node.operation) {
      case Operation::number:
        return number(node.number);
      case Operation::parameter: {
        const std::optional<double>& value = known[static_cast<std::size_t>(node.parameter)];
        return value ? number(*value) : symbol(node.parameter);
      }
      case Operation::laplace:
      case Operation::exact_laplace:
        return symbol(size_ - 1);
      case Operation::add:
      case Operation::subtract: {
        Sum result = left();
        for (const Term& term : scaled(right(), node.operation == Operation::add ? 1 : -1)) add(term, result);
        return result;
      }
      case Operation::negate:
        return scaled(left(), -1);
      case Operation::multiply:
        return product(left(), right());
      case Operation::divide:
        return product(left(), raised(right(), constant(-1)));
      case Operation::power:
        return raised(left(), as_exponent(right()));
      case Operation::power_of_s:
        return raised(product(left(), symbol(size_ - 1)), as_exponent(right()));
      case Operation::sqrt:
        return raised(left(), constant(0.5));
      default:
        return {{number(1)[0].monomial, {{node.operation, left(), constant(1)}}}};
    }
  }

  Index size_;
  bool expand_;
};

/// What a way to match demands.
struct Demands {
  std::vector<Exponent> orders;                    // are 0
  std::vector<Monomial> equal;                     // are 1 for every s, ...
  std::vector<std::vector<Monomial>> with;         // ... each with these added to it
  std::vector<std::pair<Monomial, double>> below;  // grow with an exponent of at most that

  /// Whether that does not contradict itself.
  [[nodiscard]] bool add_order(const Exponent& order) {
    if (is_number(order)) return std::abs(order[order.size() - 1]) <= rounding;
    orders.push_back(order);
    return true;
  }
  [[nodiscard]] bool add_equal(const Monomial& monomial) {
    equal.push_back(monomial);
    with.emplace_back();
    return add_order(monomial.exponents.bottomRows(1));
  }
  [[nodiscard]] Demands and_below(const Monomial& monomial, double growth) const {
    Demands result = *this;
    result.below.emplace_back(monomial, growth);
    return result;
  }
};

class Search {
 public:
  Search(const Structure& rich, std::span<const ParameterLimits> limits, const Structure& simple,
         std::span<const double> values, double unit_of_value, double unit_of_omega)
      : rich_(rich),
        limits_(limits),
        simple_(simple),
        values_(values),
        unit_of_value_(unit_of_value),
        unit_of_omega_(unit_of_omega),
        parameters_(static_cast<Index>(limits.size())) {}

  /// Of all ways the one with the least rates.
  [[nodiscard]] std::optional<Containment> best() {
    Known of_rich;
    const Known of_simple(values_.begin(), values_.end());
    for (const ParameterLimits& each : limits_)
      of_rich.push_back(each.lower == each.upper ? std::optional(each.lower) : std::nullopt);
    for (const bool expand : {false, true}) {
      const Writer writer(limits_.size(), expand);
      for (const Form form : {Form::as_written, Form::ratio, Form::divided}) {
        if (is_over()) break;
        try {
          const Sum simple = form == Form::as_written
                                 ? writer.sum(simple_.expression(), of_simple)
                                 : writer.ratio(reduce(simple_.expression(), values_), form == Form::divided);
          if (simple.empty()) return std::nullopt;
          match_sum(writer.sum(rich_.expression(), of_rich), simple, false, {},
                    [&](const Demands& demands, const Monomial&) { solve(demands); });
        } catch (const NoForm&) {
        } catch (const std::invalid_argument&) {  // no ratio of sums of powers
        }
      }
    }
    return best_;
  }

 private:
  enum class Form { as_written, ratio, divided };
  using Next = std::function<void(const Demands&, const Monomial&)>;
  using Step = std::function<void(std::size_t, const Demands&, const Monomial&)>;

  /// An exact one cannot be bettered; many like parts can be matched in very many ways, of which pairs of presets need
  /// far fewer than these: 52 ways and 236 pairings of parts at most.
  [[nodiscard]] bool is_over() const {
    constexpr std::size_t most_ways = 200, most_pairings = 1000;
    return (best_ && !best_->is_limit()) || ways_ > most_ways || pairings_ > most_pairings;
  }

  static Monomial inverse(const Monomial& monomial) { return {1 / monomial.number, -monomial.exponents}; }

  /// The product with a power goes on.
  static void go_on_raised(const Demands& demands, const Monomial& product, const Monomial& base,
                           const Exponent& exponent, const Next& next) {
    if (const auto power = raised(base, exponent)) return next(demands, product * *power);
    if (is_number(exponent)) return;
    // Of a power of a power, with two orders open, the outer one is taken as 1: it is then what stands inside.
    Exponent at_one = Exponent::Zero(exponent.size());
    at_one[exponent.size() - 1] = exponent.sum();
    Demands held = demands;
    if (held.add_order(exponent - at_one)) go_on_raised(held, product, base, at_one, next);
  }

  /// The sum is the other one, or with `relative` the other one times the monomial that goes on.
  void match_sum(const Sum& rich, const Sum& simple, bool relative, const Demands& demands, const Next& next) {
    const std::size_t none = simple.size();
    std::vector<std::size_t> partner(rich.size(), none), row(simple.size());
    Step match_from, drop_from;
    match_from = [&](std::size_t k, const Demands& so_far, const Monomial& scale) {
      if (k == simple.size()) return drop_from(0, so_far, scale);
      for (std::size_t j = 0; j < rich.size() && !is_over(); ++j) {
        if (partner[j] != none) continue;
        ++pairings_;
        partner[j] = k;
        match_term(rich[j], simple[k], so_far, [&](const Demands& matched, const Monomial& quotient) {
          if (relative && k == 0) return match_from(1, matched, quotient);
          Demands equated = matched;
          row[k] = equated.equal.size();
          if (equated.add_equal(quotient * inverse(scale))) match_from(k + 1, equated, scale);
        });
        partner[j] = none;
      }
    };
    drop_from = [&](std::size_t j, const Demands& so_far, const Monomial& scale) {
      if (j == rich.size()) return next(so_far, scale);
      if (partner[j] != none) return drop_from(j + 1, so_far, scale);
      lead_term(rich[j], 0, so_far, [&](const Demands& led, const Monomial& lead) {
        drop_from(j + 1, led.and_below(lead * inverse(scale), -1), scale);
      });
      if (relative || !rich[j].factors.empty()) return;
      for (std::size_t i = 0; i < rich.size() && !is_over(); ++i) {
        if (partner[i] == none || !rich[i].factors.empty()) continue;
        const Monomial &part = rich[j].monomial, &whole = rich[i].monomial;
        if (part.exponents.bottomRows(1) != whole.exponents.bottomRows(1)) continue;
        Demands joined = so_far;
        joined.with[row[partner[i]]].push_back(part * inverse(simple[partner[i]].monomial));
        drop_from(j + 1, joined, scale);
      }
    };
    match_from(0, demands, {1, Eigen::MatrixXd::Zero(parameters_ + 1, parameters_ + 1)});
  }

  /// The quotient of the terms goes on, everything but monomials being matched.
  void match_term(const Term& rich, const Term& simple, const Demands& demands, const Next& next) {
    std::vector<bool> used(rich.factors.size(), false);
    Step match_from, collapse_from;
    match_from = [&](std::size_t k, const Demands& so_far, const Monomial& quotient) {
      if (k == simple.factors.size()) return collapse_from(0, so_far, quotient);
      const Factor& wanted = simple.factors[k];
      for (std::size_t j = 0; j < rich.factors.size() && !is_over(); ++j) {
        const Factor& factor = rich.factors[j];
        Demands equated = so_far;
        if (used[j] || factor.function != wanted.function || !equated.add_order(factor.exponent - wanted.exponent))
          continue;
        used[j] = true;
        const bool is_sum = factor.function == Operation::add;
        match_sum(factor.inside, wanted.inside, is_sum, equated, [&](const Demands& matched, const Monomial& scale) {
          go_on_raised(matched, quotient, scale, wanted.exponent,
                       [&](const Demands& d, const Monomial& m) { match_from(k + 1, d, m); });
        });
        used[j] = false;
      }
    };
    collapse_from = [&](std::size_t j, const Demands& so_far, const Monomial& quotient) {
      if (j == rich.factors.size()) return next(so_far, quotient);
      if (used[j]) return collapse_from(j + 1, so_far, quotient);
      lead_factor(rich.factors[j], -1, so_far, quotient,
                  [&](const Demands& d, const Monomial& m) { collapse_from(j + 1, d, m); });
    };
    match_from(0, demands, rich.monomial * inverse(simple.monomial));
  }

  /// The monomial that a sum goes over into goes on.
  /// @param growth  of all its other terms, measured by that: -1 where they vanish, 0 where they may be as large
  void lead_sum(const Sum& sum, double growth, const Demands& demands, const Next& next) {
    for (std::size_t i = 0; i < sum.size() && !is_over(); ++i) {
      ++pairings_;
      const Step others_from = [&](std::size_t j, const Demands& so_far, const Monomial& lead) {
        if (j == sum.size()) return next(so_far, lead);
        if (j == i) return others_from(j + 1, so_far, lead);
        lead_term(sum[j], 0, so_far, [&](const Demands& led, const Monomial& other) {
          others_from(j + 1, led.and_below(other * inverse(lead), growth), lead);
        });
      };
      lead_term(sum[i], growth, demands, [&](const Demands& led, const Monomial& lead) { others_from(0, led, lead); });
    }
  }
  void lead_term(const Term& term, double growth, const Demands& demands, const Next& next) {
    const Step lead_from = [&](std::size_t j, const Demands& so_far, const Monomial& lead) {
      if (j == term.factors.size()) return next(so_far, lead);
      lead_factor(term.factors[j], growth, so_far, lead,
                  [&](const Demands& d, const Monomial& m) { lead_from(j + 1, d, m); });
    };
    lead_from(0, demands, term.monomial);
  }
  /// The product with what a factor goes over into goes on.
  void lead_factor(const Factor& factor, double growth, const Demands& demands, const Monomial& product,
                   const Next& next) {
    lead_sum(factor.inside, growth, demands, [&](const Demands& led, const Monomial& lead) {
      const Operation function = factor.function;
      if (function == Operation::add) return go_on_raised(led, product, lead, factor.exponent, next);
      // A function of a finite argument is finite.
      if (growth == 0) return next(led.and_below(lead, 0).and_below(inverse(lead), 0), product);
      const Demands small = led.and_below(lead, -1), large = led.and_below(inverse(lead), -1);
      switch (function) {
        case Operation::tanh:
          next(large, product);
          return go_on_raised(small, product, lead, factor.exponent, next);
        case Operation::coth:
          next(large, product);
          return go_on_raised(small, product, lead, -factor.exponent, next);
        case Operation::sinh:
          return go_on_raised(small, product, lead, factor.exponent, next);
        case Operation::exp:
        case Operation::cosh:
        case Operation::sech:
          return next(small, product);
        default:  // a logarithm has no such limit
          return;
      }
    });
  }

  // Solution of the demands.

  [[nodiscard]] double lower(Index i) const { return limits_[static_cast<std::size_t>(i)].lower; }
  [[nodiscard]] double upper(Index i) const { return limits_[static_cast<std::size_t>(i)].upper; }
  [[nodiscard]] ParameterRole role(Index i) const { return rich_.parameter_roles()[static_cast<std::size_t>(i)]; }

  /// The orders that were asked for, those left open in the middle of their limits, and 1 behind them.
  [[nodiscard]] std::optional<Eigen::VectorXd> orders_of(const Demands& demands) const {
    Eigen::VectorXd orders = Eigen::VectorXd::Zero(parameters_ + 1);
    orders[parameters_] = 1;
    for (Index i = 0; i < parameters_; ++i)
      if (role(i) == ParameterRole::order) orders[i] = (lower(i) + upper(i)) / 2;
    if (demands.orders.empty()) return orders;
    Eigen::MatrixXd rows(static_cast<Index>(demands.orders.size()), parameters_ + 1);
    for (Index k = 0; k < rows.rows(); ++k) rows.row(k) = demands.orders[static_cast<std::size_t>(k)];
    const Eigen::MatrixXd of_orders = rows.leftCols(parameters_);
    orders.head(parameters_) -= PivotedQr(of_orders, rounding).solve(Eigen::VectorXd(rows * orders));
    if (!((rows * orders).cwiseAbs().maxCoeff() <= rounding)) return std::nullopt;
    for (Index i = 0; i < parameters_; ++i) {
      if (role(i) != ParameterRole::order) continue;
      if (orders[i] < lower(i) - rounding || orders[i] > upper(i) + rounding) return std::nullopt;
      orders[i] = std::clamp(orders[i], lower(i), upper(i));
    }
    return orders;
  }

  /// Products of parameters that are to be 1: exponents in rows.
  struct Products {
    Eigen::MatrixXd exponents;
    Eigen::VectorXd numbers;
  };
  [[nodiscard]] Products products_of(const std::vector<Monomial>& monomials, const Eigen::VectorXd& orders) const {
    const auto count = static_cast<Index>(monomials.size());
    Products result{Eigen::MatrixXd(count, parameters_), Eigen::VectorXd(count)};
    for (Index k = 0; k < count; ++k) {
      const Monomial& each = monomials[static_cast<std::size_t>(k)];
      result.exponents.row(k) = (each.exponents.topRows(parameters_) * orders).transpose();
      result.numbers[k] = each.number;
    }
    return result;
  }

  /// Values with which every product is 1: logarithms by linear equations, signs by trial.  What is left open has its
  /// natural unit.
  [[nodiscard]] std::optional<Eigen::VectorXd> coefficients_of(const std::vector<Monomial>& monomials,
                                                               const Eigen::VectorXd& orders) const {
    const auto [rows, numbers] = products_of(monomials, orders);
    const auto units = parameter_dimensions(rich_, {orders.data(), static_cast<std::size_t>(parameters_)});
    Eigen::VectorXd logarithms(parameters_);
    std::vector<Index> either_sign;
    for (Index i = 0; i < parameters_; ++i) {
      const auto [of_value, of_omega] = units[static_cast<std::size_t>(i)];
      logarithms[i] = of_value * std::log(unit_of_value_) + of_omega * std::log(unit_of_omega_);
      if (lower(i) < 0 && role(i) != ParameterRole::order) either_sign.push_back(i);
    }
    if (!monomials.empty()) {
      const Eigen::VectorXd wanted = -numbers.array().abs().log().matrix();
      logarithms += PivotedQr(rows, rounding).solve(Eigen::VectorXd(wanted - rows * logarithms));
      const double most = rounding * (1 + wanted.cwiseAbs().maxCoeff());
      if (!((rows * logarithms - wanted).cwiseAbs().maxCoeff() <= most)) return std::nullopt;
    }
    for (std::size_t signs = 0; signs < std::size_t{1} << either_sign.size(); ++signs) {
      Eigen::VectorXd result = logarithms.array().exp();
      for (std::size_t k = 0; k < either_sign.size(); ++k)
        if ((signs >> k & 1) != 0) result[either_sign[k]] *= -1;
      bool holds = true;
      for (Index row = 0; row < rows.rows() && holds; ++row) {
        double sign = numbers[row];
        for (const Index i : either_sign) sign *= std::pow(result[i] < 0 ? -1 : 1, rows(row, i));
        holds = sign > 0;  // NaN for a power of a negative number
      }
      if (holds) return result;
    }
    return std::nullopt;
  }

  /// Exponents with which parameters grow: products of `rows` not at all, those of `below` at most as given.  By
  /// projections on what is violated most (Agmon 1954), which end where the set has an interior.
  [[nodiscard]] std::optional<Eigen::VectorXd> growth_of(const Eigen::MatrixXd& rows, const Eigen::MatrixXd& below,
                                                         const Eigen::VectorXd& most) const {
    Eigen::VectorXd growth = Eigen::VectorXd::Zero(parameters_);
    if (below.rows() == 0) return growth;
    Eigen::MatrixXd directions = below;
    if (rows.rows() > 0 && !rows.isZero(0)) {
      const Eigen::MatrixXd kept = PivotedQr(rows.transpose(), rounding).basis();
      directions -= (below * kept) * kept.transpose();
    }
    constexpr int most_steps = 500;
    constexpr double enough = 0.5;  // of what is demanded; all of it then by a factor, since demands are homogeneous
    for (int step = 0; step < most_steps; ++step) {
      Index worst = 0;
      if ((directions * growth - enough * most).maxCoeff(&worst) <= rounding) {
        double least = 1;
        for (Index row = 0; row < most.size(); ++row)
          if (most[row] < 0) least = std::min(least, directions.row(row).dot(growth) / most[row]);
        return (growth.array().abs() < rounding).select(0, growth / least);
      }
      const double square = directions.row(worst).squaredNorm();
      if (!(square > rounding)) return std::nullopt;
      growth -= (directions.row(worst).dot(growth) - most[worst]) / square * directions.row(worst).transpose();
    }
    return std::nullopt;
  }

  void solve(const Demands& demands) {
    ++ways_;
    const auto orders = orders_of(demands);
    if (!orders) return;
    // Of a sum that is to be 1 the other products tell the parts, and so what is left for its first one.
    std::vector<Monomial> kept, first, parts, dropped;
    for (std::size_t k = 0; k < demands.equal.size(); ++k)
      if (demands.with[k].empty()) kept.push_back(demands.equal[k]);
    auto coefficients = coefficients_of(kept, *orders);
    if (!coefficients) return;
    for (std::size_t k = 0; k < demands.equal.size(); ++k) {
      if (demands.with[k].empty()) continue;
      double rest = 1;
      const auto [exponents, numbers] = products_of(demands.with[k], *orders);
      for (Index part = 0; part < numbers.size(); ++part)
        rest -= numbers[part] * coefficients->array().pow(exponents.row(part).transpose().array()).prod();
      first.push_back(demands.equal[k]);
      first.back().number /= rest;
      parts.insert(parts.end(), demands.with[k].begin(), demands.with[k].end());
    }
    kept.insert(kept.end(), first.begin(), first.end());
    if (!first.empty()) coefficients = coefficients_of(kept, *orders);
    if (!coefficients) return;
    kept.insert(kept.end(), parts.begin(), parts.end());

    Eigen::VectorXd most(static_cast<Index>(demands.below.size()));
    for (const auto& [monomial, growth] : demands.below) {
      most[static_cast<Index>(dropped.size())] = growth;
      dropped.push_back(monomial);
    }
    const Eigen::MatrixXd rows = products_of(kept, *orders).exponents, below = products_of(dropped, *orders).exponents;
    const auto growth = growth_of(rows, below, most);
    if (!growth) return;

    Containment result;
    for (Index i = 0; i < parameters_; ++i) {
      const bool is_order = role(i) == ParameterRole::order, is_held = lower(i) == upper(i);
      double value = is_held ? lower(i) : is_order ? (*orders)[i] : (*coefficients)[i];
      double rate = is_held || is_order ? 0 : -(*growth)[i];
      const bool may_be_zero = lower(i) < 0 || (role(i) == ParameterRole::delay && lower(i) == 0);
      if (rate > 0 && may_be_zero && rows.col(i).isZero(0) && below.col(i).minCoeff() >= 0) value = rate = 0;
      result.values.push_back(value);
      result.rates.push_back(rate);
    }
    const auto size = [](const Containment& of) {
      return Eigen::Map<const Eigen::VectorXd>(of.rates.data(), static_cast<Index>(of.rates.size())).norm();
    };
    if ((!best_ || size(result) < size(*best_)) && is_right(result)) best_ = std::move(result);
  }

  /// Limits, and what no algebra above sees: branches of powers.
  [[nodiscard]] bool is_right(const Containment& containment) const {
    // What is dropped is one part in 1e10, and a decade off no more than the tolerance for orders up to 7 apart, as
    // s^-2 and s^4 are.
    constexpr double smallness = 1e-10, tolerance = 1e-3;
    const std::vector<double> parameters = containment.at(smallness);
    for (std::size_t i = 0; i < parameters.size(); ++i)
      if (!(parameters[i] >= limits_[i].lower && parameters[i] <= limits_[i].upper)) return false;
    for (const double factor : {0.1, 0.7, 10.0}) {
      const double omega = factor * unit_of_omega_;
      const std::complex<double> wanted = simple_.response(values_, omega);
      const double distance = std::abs(rich_.response(parameters, omega) - wanted);
      if (!(distance <= (containment.is_limit() ? tolerance : rounding) * std::abs(wanted))) return false;
    }
    return true;
  }

  const Structure& rich_;
  std::span<const ParameterLimits> limits_;
  const Structure& simple_;
  std::span<const double> values_;
  double unit_of_value_, unit_of_omega_;
  Index parameters_;
  std::optional<Containment> best_;
  std::size_t ways_ = 0, pairings_ = 0;
};

}  // namespace

bool Containment::is_limit() const {
  return std::any_of(rates.begin(), rates.end(), [](double rate) { return rate != 0; });
}

std::vector<double> Containment::at(double smallness) const {
  std::vector<double> result;
  for (std::size_t i = 0; i < values.size(); ++i) result.push_back(values[i] * std::pow(smallness, rates[i]));
  return result;
}

std::optional<Containment> contained_in(const Structure& rich, std::span<const ParameterLimits> limits,
                                        const Structure& simple, std::span<const double> values, double unit_of_value,
                                        double unit_of_omega) {
  return Search(rich, limits, simple, values, unit_of_value, unit_of_omega).best();
}

}  // namespace frac::detail
