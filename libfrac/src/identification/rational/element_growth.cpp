// SPDX-License-Identifier: BSD-3-Clause
#include "element_growth.hpp"

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <limits>
#include <optional>
#include <string>
#include <utility>

#include "identification/relaxation/nonnegative.hpp"

namespace frac::detail {
namespace {

using Kind = Term::Kind;
constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double indistinguishable = 2;  // differences of the value, as of AICc in identify()

// Number of ways to add an element that get a search of their own, those that lower the cost most before it.
constexpr std::size_t searched = 8;
// Sums that the next element is added to.  With two, the chosen sum costs more than the truth in 10 of 600 circuits of
// the benchmark element_rates, with four in 5, with six, which take 1.4 times as long, in 4.
constexpr std::size_t kept = 4;

/// Elements of one kind along orders or places.
using Line = std::vector<Term>;

/// Powers of an order between two whole ones.
Line free_powers(double least) {
  Line line;
  for (const double above : {0.25, 0.5, 0.75}) {
    line.push_back({Kind::power, least + above, false, 0, 0, least, least + 1});
  }
  return line;
}

Line placed(const TermProblem& problem, Term element) {
  Line line;
  for (const double at : places(problem, 16)) {
    element.log_size = at;
    line.push_back(element);
  }
  return line;
}

/// Modes may be narrower than the distance of places, so they are looked for at points of the data.
Line modes(const TermProblem& problem, Kind kind, double order, double log_damping) {
  constexpr std::size_t most_points = 60;
  const std::vector<double>& points = problem.log_omega();
  const std::size_t every = (points.size() + most_points - 1) / most_points;
  Line line;
  for (std::size_t i = 0; i < points.size(); i += every) {
    line.push_back({kind, order, true, points[i], log_damping});
  }
  return line;
}

/// Elements of which a passive response may consist, each line a kind.
std::vector<Line> catalogue(const TermProblem& problem, PassiveResponse response) {
  std::vector<Line> lines;
  const auto powers = [&](std::initializer_list<double> orders) {
    for (const double order : orders) lines.push_back({whole_power(order)});
  };
  if (response == PassiveResponse::receptance) {
    powers({0, -1, -2});
    for (const double least : {-1.0, -2.0}) lines.push_back(free_powers(least));
    for (const double order : {0.9, 0.6}) lines.push_back(placed(problem, {Kind::arc, order, false}));
    for (const double damping : {0.01, 0.1}) {
      lines.push_back(modes(problem, Kind::mode, 0, std::log(damping)));
      lines.push_back(modes(problem, Kind::structural_mode, 0, std::log(damping)));
    }
    return lines;
  }
  powers({0, 1, -1, -0.5});
  for (const double least : {-1.0, 0.0}) lines.push_back(free_powers(least));
  for (const double order : {0.95, 0.7, 0.45}) {
    lines.push_back(placed(problem, {Kind::arc, order, false}));
    lines.push_back(placed(problem, {Kind::rise, order, false}));
  }
  for (const Kind kind : {Kind::gerischer, Kind::layer_short, Kind::layer_open}) {
    lines.push_back(placed(problem, {kind, 0.5, true}));
  }
  for (const double damping : {0.02, 0.2}) lines.push_back(modes(problem, Kind::mode, 1, std::log(damping)));
  return lines;
}

/// Constant, spring or resistor; three (two) whole powers; two (two) free ones; relaxations of either direction with
/// and without a free order (falling ones alone), three kinds of diffusion; a mode (two).
double kinds_of(PassiveResponse response) {
  return response == PassiveResponse::receptance ? 9 : 14;
}

bool contains(const TermSum& sum, const Term& power) {
  return std::any_of(sum.begin(), sum.end(), [&](const Term& term) { return term.held && same_power(term, power); });
}

class ElementGrowth {
 public:
  ElementGrowth(const TermProblem& problem, PassiveResponse response)
      : problem_(problem), response_(response), catalogue_(catalogue(problem, response)) {
    for (const Line& line : catalogue_) seen_.push_back(problem.weighted(problem.columns(line)));
  }

  [[nodiscard]] double value(const TermFit& fit) const { return element_value(problem_, response_, fit); }

  /// The least cost with positive gains near a sum.  At that cost the gains that are not 0 are those of free signs, so
  /// that an element whose gain has become negative is taken out and the others searched again.
  [[nodiscard]] TermFit refine(TermSum sum, const Effort& effort) const {
    while (true) {
      TermFit fit = problem_.refine(std::move(sum), effort);
      if (!std::isfinite(fit.cost)) return fit;
      const std::vector<double> gains = problem_.coefficients(fit.sum);
      const auto least = std::min_element(gains.begin(), gains.end());
      if (*least > 0) return fit;
      sum = without_term(std::move(fit.sum), static_cast<std::size_t>(least - gains.begin()));
    }
  }

  /// Appends the sum with one more element, of each kind at its best place.
  void extend(const TermSum& sum, std::vector<TermFit>& refined) const {
    std::vector<TermFit> starts;
    TermProblem::Linear linear;
    if (!problem_.solve(problem_.columns(sum), linear)) return;
    for (std::size_t k = 0; k < catalogue_.size(); ++k) {
      const Line& line = catalogue_[k];
      if (!seen_[k]) continue;
      if (line.front().held && line.front().kind == Kind::power && contains(sum, line.front())) continue;
      std::vector<TermFit> along = problem_.along_gaining(sum, linear, line, seen_[k]->matrix);
      starts.push_back(std::move(*std::min_element(along.begin(), along.end(), costs_less)));
    }
    std::stable_sort(starts.begin(), starts.end(), costs_less);
    for (std::size_t i = 0; i < std::min(searched, starts.size()) && std::isfinite(starts[i].cost); ++i) {
      refined.push_back(refine(std::move(starts[i].sum), scouting));
    }
  }

  /// The fit with elements left out or made simpler as long as that pays.
  [[nodiscard]] TermFit simplified(TermFit best) const { return moved(std::move(best), simpler_than); }
  /// The fit with elements exchanged for others at the same place.
  [[nodiscard]] TermFit exchanged(TermFit best) const { return simplified(moved(std::move(best), exchanged_in)); }

  /// The fit with a resistor and a capacitor in the place of diffusion that the data do not tell from them.  Beyond the
  /// band one shape goes by several names, of which the plainest stands.
  [[nodiscard]] TermFit plain(TermFit best) const {
    for (std::size_t k = 0; k < best.sum.size(); ++k) {
      const Term& element = best.sum[k];
      if (element.kind == Kind::power || element.kind == Kind::arc || element.kind == Kind::rise || element.is_mode())
        continue;
      TermFit tried = refine(with_at(best.sum, k, {Kind::arc, 1, true, element.log_size}), thorough);
      if (tried.sum.size() == best.sum.size() && value(tried) < value(best) + indistinguishable)
        best = std::move(tried);
    }
    return best;
  }

 private:
  template <class Moves>
  [[nodiscard]] TermFit moved(TermFit best, Moves moves) const {
    const auto value_of = [this](const TermFit& fit) { return value(fit); };
    return without_idle(*this, std::move(best), &TermFit::sum, value_of,
                        [&](const TermFit& fit, int) { return moves(fit.sum); });
  }

  static TermSum with_at(const TermSum& sum, std::size_t k, const Term& other) {
    TermSum next = sum;
    next[k] = other;
    return next;
  }

  static std::vector<TermSum> simpler_than(const TermSum& sum) {
    std::vector<TermSum> moves;
    for (std::size_t k = 0; k < sum.size(); ++k) {
      if (sum.size() > 1) moves.push_back(without_term(sum, k));
      const Term& element = sum[k];
      if (element.kind != Kind::power && !element.is_mode()) {
        // An element beyond the band is a resistor, and on the other side an inductor, a capacitor or diffusion.
        const auto limits = element.kind == Kind::rise ? std::vector{0.0, 1.0} : std::vector{0.0, -1.0, -0.5};
        for (const double order : limits) {
          if (!contains(sum, whole_power(order))) moves.push_back(with_at(sum, k, whole_power(order)));
        }
      }
      if (element.held) continue;
      if (element.kind != Kind::power) {
        if (element.order > 0.7) moves.push_back(with_at(sum, k, {element.kind, 1, true, element.log_size}));
        continue;
      }
      for (const double order : {element.least_order, -0.5, element.most_order}) {
        if (std::abs(element.order - order) > 0.3 || contains(sum, whole_power(order))) continue;
        moves.push_back(with_at(sum, k, whole_power(order)));
      }
    }
    return moves;
  }

  /// Another kind of relaxation or diffusion at the place of one, alone and instead of a whole power or the nearest
  /// element too: diffusion into a layer, say, is nearly a capacitor and an arc.
  static std::vector<TermSum> exchanged_in(const TermSum& sum) {
    std::vector<TermSum> moves;
    const auto exchange = [&](std::size_t k, const Term& other) {
      moves.push_back(with_at(sum, k, other));
      const auto distance = [&](std::size_t i) {
        return i == k || sum[i].kind == Kind::power ? infinity : std::abs(sum[i].log_size - sum[k].log_size);
      };
      std::size_t nearest = 0;
      for (std::size_t i = 1; i < sum.size(); ++i) nearest = distance(i) < distance(nearest) ? i : nearest;
      for (std::size_t i = 0; i < sum.size(); ++i) {
        const bool replaced = sum[i].kind == Kind::power ? sum[i].held : i == nearest;
        if (i != k && replaced) moves.push_back(without_term(with_at(sum, k, other), i));
      }
    };
    for (std::size_t k = 0; k < sum.size(); ++k) {
      const Term& element = sum[k];
      if (element.kind == Kind::power || element.kind == Kind::rise || element.is_mode()) continue;
      if (element.kind != Kind::arc || element.held) exchange(k, {Kind::arc, 0.9, false, element.log_size});
      for (const Kind kind : {Kind::gerischer, Kind::layer_short, Kind::layer_open}) {
        if (element.kind != kind) exchange(k, {kind, 0.5, true, element.log_size});
      }
    }
    return moves;
  }

  const TermProblem& problem_;
  PassiveResponse response_;
  std::vector<Line> catalogue_;
  std::vector<std::optional<TermProblem::Weighted>> seen_;  // columns of each line
};

}  // namespace

PassiveKind passive_kind(const ProjectedData& data) {
  if (data.one_part()) return {PassiveResponse::immittance, 0};
  const Eigen::Index points = data.s().size();
  const auto against = [](const auto& part, double sign) { return (sign * part.array()).min(0.0).square().sum(); };
  const double immittance = against(data.target().head(points), 1),
               receptance = against(data.target().tail(points), -1);
  return receptance < immittance ? PassiveKind{PassiveResponse::receptance, receptance}
                                 : PassiveKind{PassiveResponse::immittance, immittance};
}

double element_value(const TermProblem& problem, PassiveResponse response, const TermFit& fit) {
  const auto count = static_cast<double>(fit.sum.size());
  const double of_kinds = count * std::log(kinds_of(response)) - std::lgamma(count + 1);
  return term_value(problem, fit) + 2 * of_kinds;
}

namespace {

bool alike(const TermFit& a, const TermFit& b) {
  return a.parameters == b.parameters && a.sum.size() == b.sum.size() && std::abs(a.cost - b.cost) <= 1e-2 * b.cost;
}

}  // namespace

ElementLadder grow_elements(const TermProblem& problem, std::size_t most_elements) {
  const ElementGrowth growth(problem, passive_kind(problem).response);
  const auto value_of = [&](const TermFit& fit) { return growth.value(fit); };
  ElementLadder ladder;
  std::vector<TermSum> sums{{}};
  for (std::size_t count = 1; count <= most_elements && 3 * count + 1 < problem.rows(); ++count) {
    std::vector<TermFit> refined;
    for (const TermSum& sum : sums) growth.extend(sum, refined);
    const std::vector<TermFit> best = best_sums(std::move(refined), kept, value_of, [&](const TermFit& grown) {
      return growth.simplified(growth.refine(grown.sum, thorough));
    });
    if (best.empty()) break;
    sums.clear();
    for (const TermFit& fit : best) sums.push_back(fit.sum);
    const double gain = ladder.fits.empty() ? infinity : growth.value(ladder.best()) - growth.value(best.front());
    // A sum that came back to the one before stands in its place.
    if (!ladder.fits.empty() && alike(best.front(), ladder.fits.back())) ladder.fits.pop_back();
    ladder.fits.push_back(best.front());
    if (gain > 0 || ladder.chosen >= ladder.fits.size()) ladder.chosen = ladder.fits.size() - 1;
    ladder.in_vain = gain > indistinguishable ? 0 : ladder.in_vain + 1;
    if (ladder.fits.back().cost <= problem.negligible_cost()) break;
    if (ladder.in_vain < 2) continue;
    // Another kind in the place of one that was taken too early may pay where a further element does not.
    TermFit other = growth.exchanged(ladder.best());
    if (!(growth.value(other) < growth.value(ladder.best()) - indistinguishable)) break;
    sums = {other.sum};
    ladder.fits.push_back(std::move(other));
    ladder.chosen = ladder.fits.size() - 1;
    ladder.in_vain = 0;
  }
  if (ladder.fits.empty()) return ladder;
  TermFit& chosen = ladder.fits[ladder.chosen];
  chosen = growth.plain(std::move(chosen));
  // Sums that were grown beyond the chosen one and came to no more, or back to it, are not listed.
  const auto last = ladder.fits.begin() + static_cast<std::ptrdiff_t>(ladder.chosen) + 1;
  ladder.fits.erase(
      std::remove_if(last, ladder.fits.end(), [&](const TermFit& fit) { return fit.parameters <= chosen.parameters; }),
      ladder.fits.end());
  return ladder;
}

double least_cost_of_relaxations(const TermProblem& problem) {
  // So many e-folds beyond the band a relaxation is a resistor, a capacitor or an inductor to 1e-4.
  constexpr double beyond = 9;
  // One between two places an eighth of an e-fold apart is their mixture to the square of that over 32, 5e-4.
  constexpr double places_per_e_fold = 8;
  TermSum all{whole_power(0), whole_power(1), whole_power(-1)};
  for (double at = problem.log_lower() - beyond; at < problem.log_upper() + beyond; at += 1 / places_per_e_fold) {
    for (const Kind kind : {Kind::arc, Kind::rise}) all.push_back({kind, 1, true, at});
  }
  const auto seen = problem.weighted(problem.columns(all));
  if (!seen) return 0;
  return (seen->matrix * nonnegative_least_squares(seen->matrix, problem.target()) - problem.target()).squaredNorm();
}

namespace {

/// A formula that grows element by element.
class WrittenSum {
 public:
  WrittenSum(const TermProblem& problem, bool is_modulus) : problem_(problem), is_modulus_(is_modulus) {}

  void add(const Term& element, double gain) {
    const std::string n = std::to_string(number_ + 1);
    const std::string constant = is_modulus_ ? "E" : "R";
    if (element.kind == Kind::power && element.held && element.order != -0.5) return add_whole_power(element, gain);
    ++number_;
    fractional_ = fractional_ || !(element.held && (element.order == std::round(element.order)));
    const double time = std::exp(-element.log_size) / problem_.centre_omega();
    const auto order = [&] { return parameter("n" + n, element.order, 0, 1); };
    switch (element.kind) {
      case Kind::power:
        if (element.held) return append("W" + n, gained("W" + n, gain) + "/sqrt(s)");
        return add_free_power(element, gain, n);
      case Kind::arc:
      case Kind::rise: {
        const bool falls = element.kind == Kind::arc;
        const std::string r = gained(constant + n, gain), t = timed("T" + n, time);
        const std::string power = element.held ? t + " s" : "(" + t + " s)^" + order();
        const std::string numerator = element.held ? r + " " + t + " s" : r + " (" + t + " s)^n" + n;
        const std::string partner = falls ? (element.held ? "C" : "CPE") : (element.held ? "L" : "LPE");
        const std::string maxwell = (element.held ? "Maxwell" : "fractional-Maxwell") + n;
        return append(is_modulus_ ? maxwell : "(R" + n + "|" + partner + n + ")",
                      (falls ? r : numerator) + "/(1 + " + power + ")");
      }
      case Kind::gerischer:
        return append("G" + n, gained("R" + n, gain) + "/sqrt(1 + " + timed("T" + n, time) + " s)");
      case Kind::layer_short:
      case Kind::layer_open: {
        const bool open = element.kind == Kind::layer_open;
        const std::string root = "sqrt(" + timed("T" + n, time) + " s)";
        return append((open ? "Wo" : "Ws") + n,
                      gained("R" + n, gain) + (open ? " coth(" : " tanh(") + root + ")/" + root);
      }
      case Kind::mode:
      case Kind::structural_mode: {
        const std::string g = gained("G" + n, gain), w = timed("w" + n, 1 / time);
        const std::string top = element.order > 0 ? g + " (s/" + w + ")" : g;
        if (element.kind == Kind::structural_mode) {
          fractional_ = true;
          const std::string q = parameter("q" + n, std::exp(element.log_damping), 0, 1);
          return append("structural-mode" + n, top + "/((s/" + w + ")^2 + (s/" + w + ")^" + q + ")");
        }
        const std::string d = timed("d" + n, 2 * std::exp(element.log_damping));
        return append("mode" + n, top + "/(s^2/" + w + "^2 + " + d + " s/" + w + " + 1)");
      }
      case Kind::normal_spread:
      case Kind::even_spread:
        return;  // no element of a catalogue
    }
  }

  [[nodiscard]] NamedModel model() && {
    model_.name = "elements:" + circuit_;
    model_.model_class = fractional_ ? ModelClass::fractional : ModelClass::integer_order;
    return std::move(model_);
  }

 private:
  std::string parameter(const std::string& name, double start, double lower, double upper) {
    model_.constraints.push_back({name, {}, lower, upper, start});
    return name;
  }
  std::string timed(const std::string& name, double start) { return parameter(name, start, 0, infinity); }
  std::string gained(const std::string& name, double start) {
    ParameterConstraint gain{name, {}, {}, {}, start};
    gain.positive = true;
    model_.constraints.push_back(std::move(gain));
    return name;
  }
  void append(const std::string& element, const std::string& text) {
    circuit_ += (circuit_.empty() ? "" : "+") + element;
    model_.formula += (model_.formula.empty() ? "" : " + ") + text;
  }
  void add_whole_power(const Term& element, double gain) {
    if (element.order == 0) {
      const std::string name = is_modulus_ ? "E0" : "R0";
      append(name, gained(name, gain));
    } else if (element.order > 0) {
      const std::string name = is_modulus_ ? "V0" : "L0";
      append(name, gained(name, gain) + " s");
    } else if (element.order > -2) {
      append("C0", "1/(" + gained("C0", 1 / gain) + " s)");
    } else {
      append("M0", "1/(" + gained("M0", 1 / gain) + " s^2)");
    }
  }
  /// s^-n by what it conducts, s^n by its gain, and s^(-1 - n) as the rest of an integrator.
  void add_free_power(const Term& element, double gain, const std::string& n) {
    const double least = element.least_order;
    if (least >= 0) {
      const std::string text = gained("A" + n, gain) + " s^" + parameter("n" + n, element.order, 0, 1);
      return append((is_modulus_ ? "springpot" : "LPE") + n, text);
    }
    const std::string q = gained("Q" + n, 1 / gain), whole = least < -1 ? "s " : "";
    const std::string order = parameter("n" + n, least < -1 ? -1 - element.order : -element.order, 0, 1);
    append("CPE" + n, "1/(" + q + " " + whole + "s^" + order + ")");
  }

  const TermProblem& problem_;
  bool is_modulus_;
  std::size_t number_ = 0;
  bool fractional_ = false;
  std::string circuit_;
  NamedModel model_{"", "", ModelClass::integer_order, "sum of passive elements", {}};
};

/// Whole powers, then all else by rising frequency, free powers last.
std::pair<int, double> rank(const Term& term) {
  if (term.kind != Kind::power) return {1, -term.log_size};
  return {term.held ? 0 : 2, std::abs(term.order - 0.1)};
}

/// Whether nothing falls with rising frequency and something rises that is no inductor.
bool is_modulus(const TermSum& sum) {
  const auto rises = [](const Term& term) {
    return term.kind == Kind::rise || (term.kind == Kind::power && !term.held && term.order > 0);
  };
  const auto keeps = [&](const Term& term) { return rises(term) || (term.kind == Kind::power && term.order >= 0); };
  return std::any_of(sum.begin(), sum.end(), rises) && std::all_of(sum.begin(), sum.end(), keeps);
}

}  // namespace

NamedModel elements_written_out(const TermProblem& problem, const TermSum& sum) {
  TermSum sorted = sum;
  std::stable_sort(sorted.begin(), sorted.end(), [](const Term& a, const Term& b) { return rank(a) < rank(b); });
  const std::vector<double> gains = problem.coefficients(sorted);
  WrittenSum written(problem, is_modulus(sum));
  for (std::size_t k = 0; k < sorted.size(); ++k) written.add(sorted[k], gains[k]);
  return std::move(written).model();
}

}  // namespace frac::detail
