// SPDX-License-Identifier: BSD-3-Clause
#include "time_growth.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "base/polynomial.hpp"
#include "frac/structure.hpp"
#include "identification/data/fit_data.hpp"
#include "identification/rational/growth.hpp"
#include "identification/statistics/information.hpp"
#include "identification/time_scout.hpp"

namespace frac::detail {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
// Longer records are thinned to so many samples, which tell members of a family apart.  A search among few samples may
// end in another minimum than one among many, so that both are made and the better end is taken.
constexpr std::size_t enough_samples = 400, few_samples = 100;
// Records resolve few modes, and each pole more takes a second of searching.
constexpr std::size_t most_over_time = 6;

/// exp(-L s) (b0 + b1 s + ...)/((s^2 + c1 s + e1) (s^2 + c2 s + e2) ... (s + p)): integrators, unstable poles, real and
/// complex ones without a seam.
struct Ratio {
  std::vector<double> numerator;                 // b0, b1, ...
  std::vector<std::pair<double, double>> pairs;  // c, e
  std::optional<double> single;                  // p
  std::optional<double> delay;

  [[nodiscard]] std::size_t poles() const { return 2 * pairs.size() + (single ? 1 : 0); }
  /// Stable real poles, and a dead time as one.
  [[nodiscard]] std::size_t relaxations() const {
    std::size_t count = (single && *single > 0 ? 1 : 0) + (delay ? 1 : 0);
    for (const auto& [c, e] : pairs) count += c > 0 && e > 0 && c * c >= 4 * e ? 2 : 0;
    return count;
  }
};

NamedModel written_out(const Ratio& ratio) {
  NamedModel model{"", "", ModelClass::integer_order, "ratio of polynomials in s", {}};
  const auto parameter = [&](const std::string& name, double start) {
    model.constraints.push_back({name, {}, -infinity, {}, start});
    return name;
  };
  std::string top, bottom;
  for (std::size_t i = 0; i < ratio.numerator.size(); ++i) {
    const std::string power = i == 0 ? "" : i == 1 ? " s" : " s^" + std::to_string(i);
    top += (i > 0 ? " + " : "") + parameter("b" + std::to_string(i), ratio.numerator[i]) + power;
  }
  for (std::size_t i = 0; i < ratio.pairs.size(); ++i) {
    const std::string n = std::to_string(i + 1);
    bottom += (bottom.empty() ? "" : " ") + ("(s^2 + " + parameter("c" + n, ratio.pairs[i].first)) + " s + " +
              parameter("e" + n, ratio.pairs[i].second) + ")";
  }
  if (ratio.single) bottom += (bottom.empty() ? "" : " ") + ("(s + " + parameter("p", *ratio.single)) + ")";
  model.formula = bottom.empty() ? top : "(" + top + ")/(" + bottom + ")";
  if (ratio.delay) {
    model.formula = "exp(-L s) (" + model.formula + ")";
    model.constraints.push_back({"L", {}, 0, {}, *ratio.delay});
  }
  model.name = "rational:" + std::to_string(ratio.numerator.size() - 1) + "/" + std::to_string(ratio.poles()) +
               (ratio.delay ? "+delay" : "");
  return model;
}

struct Member {
  Ratio ratio;
  double value = infinity;  // Schwarz's criterion and the price of the places
  double cost = infinity;
  bool exact = false;
};

class Growth {
 public:
  Growth(const TimeResponseData& data, const TimeFitOptions& options, const RationalFamily& family, std::size_t samples)
      : options_(options), family_(family) {
    std::vector<std::size_t> index;
    const std::size_t stride = (points(data) + samples - 1) / samples;
    for (std::size_t i = 0; i < points(data); i += stride) index.push_back(data.observed()[i]);
    data_.emplace(data.observed_at(std::move(index)));
    for (const std::size_t i : data.observed()) {
      size_ = std::max(size_, std::abs(data.output()[i]) / (data.sigma().empty() ? 1 : data.sigma()[i]));
    }
    const double length = data.time().back() - data.time().front();
    slow_ = 1 / length;
    fast_ = static_cast<double>(points(data)) / length;
  }

  /// Members from the fewest poles on.
  GrowthLadder<Member> grown() {
    GrowthLadder<Member> ladder;
    for (std::size_t poles = 0; poles <= std::min(family_.most_poles, most_over_time) && ladder.in_vain < 2; ++poles) {
      const std::size_t parameters = 2 * poles + 2;
      if (parameters + 3 >= points(*data_)) break;
      Member next = poles == 0 ? searched(0) : extended();
      if (poles == 1) {
        Member anew = searched(1);
        if (anew.cost < next.cost) next = std::move(anew);
      }
      members_.push_back(next);
      if (poles < family_.fewest_poles || !std::isfinite(next.cost)) continue;
      next = family_.zeros ? with_zeros(std::move(next), *family_.zeros) : without_idle_zeros(std::move(next));
      const double value = next.value;
      ladder.add(std::move(next), value);
      if (ladder.best().exact) break;
    }
    if (ladder.fits.empty()) throw std::invalid_argument("too few samples for any member of this family");
    return ladder;
  }

  [[nodiscard]] bool is_better(const Ratio& one, const Ratio& other) const {
    return fitted(one).value < fitted(other).value;
  }

 private:
  [[nodiscard]] Member fitted(const Ratio& start) const {
    const NamedModel model = written_out(start);
    const Structure structure(model.formula);
    TimeFitOptions options = options_;
    options.constraints = model.constraints;
    Member member{start};
    const Scouted found = scouted(*data_, structure, options);
    if (!std::isfinite(found.cost)) return member;
    const auto named = [&](const std::string& name) { return found.parameters[structure.parameter_index(name)]; };
    for (std::size_t i = 0; i < member.ratio.numerator.size(); ++i) {
      member.ratio.numerator[i] = named("b" + std::to_string(i));
    }
    for (std::size_t i = 0; i < member.ratio.pairs.size(); ++i) {
      member.ratio.pairs[i] = {named("c" + std::to_string(i + 1)), named("e" + std::to_string(i + 1))};
    }
    if (member.ratio.single) member.ratio.single = named("p");
    if (member.ratio.delay) member.ratio.delay = named("L");
    const auto n = static_cast<double>(points(*data_));
    const double k = static_cast<double>(structure.parameter_names().size() + (options_.offset ? 0 : 1));
    const double of_place = 2 * std::log(std::log(fast_ / slow_) + 1);
    constexpr double rounding = 1e-9;
    const double least = n * std::pow(rounding * size_, 2);
    member.cost = found.cost;
    member.exact = found.cost <= least;
    member.value = n * std::log(std::max(found.cost, least) / n) + price_of_parameters(k, n) +
                   of_place * static_cast<double>(member.ratio.poles());
    return member;
  }

  [[nodiscard]] static Member best_of(const std::vector<Member>& ends) {
    return *std::min_element(ends.begin(), ends.end(),
                             [](const Member& a, const Member& b) { return a.cost < b.cost; });
  }

  /// The best of searches from several dead times and places of the poles over the record.
  [[nodiscard]] Member searched(std::size_t poles) const {
    const std::vector<double> delays = family_.dead_time ? std::vector{0.0, 0.03, 0.1, 0.3} : std::vector{0.0};
    const std::vector<double> shares = poles > 0 ? std::vector{0.1, 0.3, 0.5, 0.75} : std::vector{0.0};
    std::vector<Member> ends;
    for (const double delay : delays) {
      for (const double share : shares) {
        Ratio ratio{{1}, {}, {}, {}};
        if (poles > 0) {
          ratio.single = place(share);
          ratio.numerator = {*ratio.single};
        }
        if (family_.dead_time) ratio.delay = delay / slow_;
        ends.push_back(fitted(ratio));
      }
    }
    return best_of(ends);
  }

  [[nodiscard]] double place(double share) const { return std::pow(slow_, 1 - share) * std::pow(fast_, share); }

  /// With one pole more than the last member: poles that a zero cancels are where searches start.
  [[nodiscard]] Member extended() const {
    std::vector<Member> ends;
    for (const double share : {0.15, 0.4, 0.7}) {
      const double at = place(share);
      Ratio next = members_.back().ratio;
      next.numerator = polynomial_product(next.numerator, {at, 1});
      if (next.single) {
        next.pairs.emplace_back(*next.single + at, *next.single * at);
        next.single.reset();
      } else {
        next.single = at;
      }
      trim(next);
      ends.push_back(fitted(next));
      if (members_.size() < 2) continue;
      Ratio pair = members_[members_.size() - 2].ratio;
      pair.numerator = polynomial_product(pair.numerator, {at * at, 0.3 * at, 1});
      pair.pairs.emplace_back(0.3 * at, at * at);
      trim(pair);
      ends.push_back(fitted(pair));
    }
    return best_of(ends);
  }

  /// A gain times a zero more than poles would pass the input on at once; strictly proper ones are grown.
  static void trim(Ratio& ratio) {
    ratio.numerator.resize(std::min(ratio.numerator.size(), std::max<std::size_t>(ratio.poles(), 1)));
  }

  [[nodiscard]] Member without_idle_zeros(Member member) const {
    if (member.ratio.poles() > 0) {
      Ratio direct = member.ratio;
      direct.numerator.push_back(0);
      Member with = fitted(direct);
      if (with.value < member.value) return with;
    }
    while (member.ratio.numerator.size() > 1) {
      Ratio less = member.ratio;
      less.numerator.pop_back();
      Member without = fitted(less);
      if (!(without.value < member.value)) break;
      member = std::move(without);
    }
    return member;
  }

  /// Zeros go one by one, each time from where the fit without the last one ended.
  [[nodiscard]] Member with_zeros(Member member, std::size_t zeros) const {
    if (zeros >= member.ratio.numerator.size()) {
      member.ratio.numerator.resize(zeros + 1);
      return fitted(member.ratio);
    }
    while (member.ratio.numerator.size() > zeros + 1) {
      member.ratio.numerator.pop_back();
      member = fitted(member.ratio);
    }
    return member;
  }

  const TimeFitOptions& options_;
  const RationalFamily& family_;
  std::optional<TimeResponseData> data_;
  double slow_, fast_;
  double size_ = 0;  // largest weighted output
  std::vector<Member> members_;
};

}  // namespace

FamilyMembers family_members(const TimeResponseData& data, const NamedModel& model, const TimeFitOptions& options) {
  const auto refuse = [&model](const std::string& reason) {
    throw std::invalid_argument("model '" + model.name + "': " + reason);
  };
  if (!model.rational || model.rational->free_order)
    refuse("the family is grown on frequency responses only; over time write the model as a formula");
  const RationalFamily& family = *model.rational;
  if (family.fewest_poles > most_over_time)
    refuse("more than " + std::to_string(most_over_time) + " poles, which no search over time finds");
  if (family.zeros && *family.zeros > family.most_poles)
    refuse("more zeros than poles, so that it has no finite response to a step");
  Growth growth(data, options, family, enough_samples);
  GrowthLadder<Member> ladder = growth.grown();
  if (points(data) > few_samples) {
    GrowthLadder<Member> other = Growth(data, options, family, few_samples).grown();
    if (growth.is_better(other.best().ratio, ladder.best().ratio)) ladder = std::move(other);
  }
  FamilyMembers members;
  for (const Member& member : ladder.fits) members.models.push_back(written_out(member.ratio));
  members.chosen = ladder.chosen;
  members.models[members.chosen].ends_its_family = ladder.best().ratio.poles() == most_over_time;
  members.relaxations = ladder.best().ratio.relaxations();
  return members;
}

FamilyMembers best_member(const TimeResponseData& data, const NamedModel& model, const TimeFitOptions& options) {
  FamilyMembers members = family_members(data, model, options);
  members.models = {std::move(members.models[members.chosen])};
  members.chosen = 0;
  return members;
}

}  // namespace frac::detail
