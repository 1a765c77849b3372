// SPDX-License-Identifier: BSD-3-Clause
#include "scene_start.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "frac/cancellation.hpp"
#include "response_table.hpp"

namespace backlash::detail {
namespace {

using Complex = std::complex<double>;

// Points of the data that rate a node.
constexpr std::size_t most_points = 60;
constexpr double node_step = 0.1;  // of ln(mass2 clearance)
// Rounds of reweighting for the masses.
constexpr int linear_rounds = 3;
constexpr double nearly_real = 0.1;
// Nodes nearer to each other than this lead to one estimate.
constexpr double near_log = 0.25;
constexpr double near_restitution = 0.11;

struct Node {
  double log_product;  // ln(mass2 clearance)
  const ResponseRow* row;
  double restitution;
};

struct RatedStart {
  Coordinates theta;
  double log_product;
  double cost;
};

// Coefficients of N omega^2 = rigid + moving h in mass1 and mass2, by least squares over the parts fitted, each point
// weighed down by its misfit (Cauchy).
struct Masses {
  double mass1, mass2;
};

std::optional<double> known_mass2(double log_product, const FixedScene& fixed) {
  if (!fixed[1] && fixed[2]) return std::exp(log_product) / *fixed[2];
  return fixed[1];
}

// Both masses of a total: what is known of either stands, and halves where nothing is.
Masses shares_of(double total, std::optional<double> mass1, std::optional<double> mass2) {
  if (mass1) return {*mass1, mass2 ? *mass2 : std::max(total - *mass1, 0.05 * total)};
  if (mass2) return {std::max(total - *mass2, 0.05 * *mass2), *mass2};
  return {0.5 * total, 0.5 * total};
}

Coordinates scene(const Masses& masses, double log_product, double restitution, const SceneBounds& bounds) {
  Coordinates theta{std::log(masses.mass1), std::log(masses.mass2), 0, restitution, 0, 0, 0};
  theta[2] = log_product - theta[1];
  for (std::size_t k = 0; k < 4; ++k) theta[k] = std::clamp(theta[k], bounds.lower[k], bounds.upper[k]);
  return theta;
}

// Points that rate a place: all, or some of them all over the curves.
std::vector<std::size_t> rating_points(const SceneData& data) {
  std::vector<std::size_t> fundamental, points;
  for (std::size_t i = 0; i < data.points.size(); ++i)
    if (data.points[i].harmonic == 1) fundamental.push_back(i);
  const std::size_t stride = (fundamental.size() + most_points - 1) / most_points;
  for (std::size_t i = 0; i < fundamental.size(); i += stride) points.push_back(fundamental[i]);
  return points;
}

// The best that are not near each other.
std::vector<Coordinates> best_apart(std::vector<RatedStart> rated, std::size_t count) {
  std::stable_sort(rated.begin(), rated.end(),
                   [](const RatedStart& one, const RatedStart& other) { return one.cost < other.cost; });
  std::vector<Coordinates> starts;
  std::vector<const RatedStart*> taken;
  for (const RatedStart& candidate : rated) {
    const bool is_near = std::any_of(taken.begin(), taken.end(), [&](const RatedStart* other) {
      return std::abs(candidate.log_product - other->log_product) < near_log &&
             std::abs(candidate.theta[3] - other->theta[3]) < near_restitution;
    });
    if (is_near) continue;
    taken.push_back(&candidate);
    starts.push_back(candidate.theta);
    if (starts.size() == count) break;
  }
  return starts;
}

class NodeRater {
 public:
  NodeRater(const SceneData& data, const SceneBounds& bounds, const FixedScene& fixed)
      : data_(data), bounds_(bounds), fixed_(fixed), points_(rating_points(data)) {}

  [[nodiscard]] std::optional<RatedStart> rate(const Node& node) const {
    std::vector<KnownPoint> known;
    bool ambiguous = false;
    for (const std::size_t i : points_) {
      const MeasuredPoint& point = data_.points[i];
      const auto motions = motions_of(node, std::log(point.force) - node.log_product - 2 * std::log(point.omega));
      if (motions.empty()) continue;
      ambiguous = ambiguous || motions.size() > 1;
      known.push_back({i, motions, motions.front()});
    }
    if (known.size() < 2) return std::nullopt;
    RatedStart best = rate(node, known);
    if (ambiguous) {
      // A motion without impacts loses no energy: what is nearly real is taken for one.
      for (KnownPoint& point : known) {
        const Complex value = data_.points[point.index].value;
        point.h = std::abs(value.imag()) < nearly_real * std::abs(value) ? point.motions.back() : point.motions.front();
      }
      const RatedStart other = rate(node, known);
      if (other.cost < best.cost) best = other;
    }
    return best;
  }

 private:
  struct KnownPoint {
    std::size_t index;
    std::vector<Complex> motions;  // h of each that the scene has there
    Complex h;                     // of the one that the data are taken to show
  };

  [[nodiscard]] RatedStart rate(const Node& node, std::vector<KnownPoint> known) const {
    const Coordinates theta = scene(masses(node, known), node.log_product, node.restitution, bounds_);
    const OutputCoefficients coefficients = output_coefficients(theta, data_.output);
    double cost = 0;
    for (const std::size_t i : points_) {
      const MeasuredPoint& point = data_.points[i];
      double least = data_.robust_cost(point, std::nullopt);
      for (const Complex& h : motions_of(node, std::log(gamma_at(theta, point)))) {
        least = std::min(least, data_.robust_cost(point, point_value(coefficients, point, h)));
      }
      cost += least;
    }
    return {theta, node.log_product, cost};
  }

  // From the row; without impacts x1 stands still, and x2 moves freely.
  [[nodiscard]] std::vector<Complex> motions_of(const Node& node, double log_gamma) const {
    std::vector<Complex> motions;
    if (const auto h = node.row->at(log_gamma)) motions.push_back(*h);
    const bool shows_free = data_.output == Output::x2 && data_.component != frac::Component::imaginary;
    if (shows_free && log_gamma <= std::log(node.row->loss)) motions.emplace_back(0);
    return motions;
  }

  // N omega^2 = -a h for x1 and -b (1 - h) - a h for x2, a = 1/(mass1 + mass2) and b = 1/mass2.
  [[nodiscard]] Masses masses(const Node& node, std::vector<KnownPoint>& known) const {
    const std::optional<double> mass2 = known_mass2(node.log_product, fixed_);
    if (mass2 && fixed_[0]) return {*fixed_[0], *mass2};
    const bool two_unknown = data_.output == Output::x2 && !mass2 && data_.component != frac::Component::imaginary;
    const bool difference_only = data_.output == Output::x2 && data_.component == frac::Component::imaginary;
    std::vector<double> weight(known.size(), 1.0);
    double a = 0, b = mass2 ? 1 / *mass2 : 0;
    for (int round = 0; round < linear_rounds; ++round) {
      double aa = 0, ab = 0, bb = 0, ay = 0, by = 0;
      for (std::size_t n = 0; n < known.size(); ++n) {
        const MeasuredPoint& point = data_.points[known[n].index];
        const Complex h = known[n].h;
        const double deviation = data_.deviation(point, point.value);
        if (!(deviation > 0)) continue;
        const double scale = 1 / (deviation * point.omega * point.omega);
        const Complex y_value = point.value / deviation;
        Complex column_a = -h * scale;
        Complex column_b = 0;
        if (data_.output == Output::x2) column_b = difference_only ? 0.0 : -(1.0 - h) * scale;
        if (difference_only) column_a = h * scale;
        const auto y = data_.parts(two_unknown ? y_value : y_value - b * column_b);
        const auto ca = data_.parts(column_a);
        const auto cb = data_.parts(column_b);
        for (std::size_t part = 0; part < 2; ++part) {
          aa += weight[n] * ca[part] * ca[part];
          ab += weight[n] * ca[part] * cb[part];
          bb += weight[n] * cb[part] * cb[part];
          ay += weight[n] * ca[part] * y[part];
          by += weight[n] * cb[part] * y[part];
        }
      }
      if (two_unknown) {
        const double determinant = aa * bb - ab * ab;
        if (determinant > 1e-12 * aa * bb) {
          a = (bb * ay - ab * by) / determinant;
          b = (aa * by - ab * ay) / determinant;
        } else {
          a = b = aa > 0 ? ay / aa : 0;
        }
      } else {
        a = aa > 0 ? ay / aa : 0;
      }
      reweigh(known, a, b, difference_only, weight);
    }
    return from_coefficients(a, b, mass2, difference_only);
  }

  void reweigh(std::vector<KnownPoint>& known, double a, double b, bool difference_only,
               std::vector<double>& weight) const {
    for (std::size_t n = 0; n < known.size(); ++n) {
      const MeasuredPoint& point = data_.points[known[n].index];
      weight[n] = 0;
      for (const Complex& h : known[n].motions) {
        Complex model = difference_only ? a * h : -a * h;
        if (data_.output == Output::x2 && !difference_only) model -= b * (1.0 - h);
        model /= point.omega * point.omega;
        const double weight_of_motion = std::exp(-data_.robust_cost(point, model));
        if (weight_of_motion <= weight[n]) continue;
        weight[n] = weight_of_motion;
        known[n].h = h;
      }
    }
  }

  [[nodiscard]] Masses from_coefficients(double a, double b, std::optional<double> mass2, bool difference_only) const {
    if (!(a > 0)) a = 1e-6 / std::exp(bounds_.lower[0]);
    if (difference_only) {
      // a = mass1/(mass2 (mass1 + mass2)); equal masses where neither is known.
      if (mass2) return {a * *mass2 < 1 ? a * *mass2 * *mass2 / (1 - a * *mass2) : *mass2, *mass2};
      if (fixed_[0]) {
        const double m = *fixed_[0];
        return {m, 0.5 * (std::sqrt(m * m + 4 * m / a) - m)};
      }
      return {0.5 / a, 0.5 / a};
    }
    if (!mass2 && data_.output == Output::x2 && b > 0) mass2 = 1 / b;
    return shares_of(1 / a, fixed_[0], mass2);
  }

  const SceneData& data_;
  const SceneBounds& bounds_;
  const FixedScene& fixed_;
  std::vector<std::size_t> points_;
};

std::vector<double> log_products(const SceneData& data, const FixedScene& fixed, const std::vector<double>& jumps) {
  if (fixed[1] && fixed[2]) return {std::log(*fixed[1]) + std::log(*fixed[2])};
  double lowest = std::numeric_limits<double>::infinity(), highest = -lowest;
  for (const MeasuredPoint& point : data.points) {
    const double log_force = std::log(point.force) - 2 * std::log(point.omega);
    lowest = std::min(lowest, log_force);
    highest = std::max(highest, log_force);
  }
  // All from: every point at the upper end of the table, to: every point at the lower one.
  std::vector<double> result;
  for (double x = lowest - highest_log_gamma; x < highest - lowest_log_gamma; x += node_step) result.push_back(x);
  for (const double jump : jumps) result.push_back(std::log(jump));
  return result;
}

}  // namespace

std::vector<Coordinates> scene_starts(const SceneData& data, const SceneBounds& bounds, const FixedScene& fixed,
                                      const std::vector<double>& jumps, bool rate_irregular, std::size_t count) {
  const NodeRater rater(data, bounds, fixed);
  std::vector<RatedStart> rated;
  for (const double log_product : log_products(data, fixed, jumps)) {
    frac::throw_if_cancelled();
    for (const ResponseRow& row : rate_irregular ? full_table() : regular_table()) {
      if (fixed[3] && std::abs(row.restitution - *fixed[3]) > near_restitution) continue;
      if (const auto start = rater.rate({log_product, &row, fixed[3].value_or(row.restitution)})) {
        rated.push_back(*start);
      }
    }
  }
  return best_apart(std::move(rated), count);
}

namespace {

// Of both masses, over the least force.
using Friction = std::array<double, 2>;

// What a point of x1 says if its motion has two symmetric impacts per period (tools/docs/methods/loss-factor.md).  With
// a = (1+e)/(1-e), M = mass1 + mass2 and P = mass2 clearance
//   Im(-1/N) = (pi/4) (M/a) omega^2,     Re N/Im N = (2 P a/(pi M))/(F |N|) - (pi/2) a.
struct LawPoint {
  double effective_mass;  // M/a, kg
  double compliance;      // (2/pi)/(F |N| M/a), per kg m: times P, less (pi/2) a, is the ratio
  double ratio;           // Re N/Im N
};

struct Groups {
  double total, product, spread;  // M, P, a
};

class LawStarts {
 public:
  LawStarts(const SceneData& data, const SceneBounds& bounds, const FixedScene& fixed)
      : data_(data), bounds_(bounds), fixed_(fixed), rating_(rating_points(data)) {
    if (fixed[3]) spread_ = (1 + *fixed[3]) / (1 - *fixed[3]);
    if (fixed[0] && fixed[1]) total_ = *fixed[0] + *fixed[1];
  }

  /// Rates the scenes of all pairs, or of all points where one suffices, with friction of both masses, over the least
  /// force.
  void rate(const Friction& friction) {
    for (std::size_t i = 0; i < rating_.size(); ++i) {
      frac::throw_if_cancelled();
      if (spread_ || total_) {
        rate(friction, i, i);
        continue;
      }
      for (std::size_t k = 0; k < i; ++k) rate(friction, i, k);
    }
  }
  [[nodiscard]] std::vector<Coordinates> best(std::size_t count) { return best_apart(std::move(rated_), count); }

 private:
  [[nodiscard]] MeasuredPoint point_of(std::size_t i, const Masses& masses, const Friction& friction) const {
    return without_friction(data_.points[i], data_.output, {masses.mass1, masses.mass2},
                            {friction[0] * data_.force_unit, friction[1] * data_.force_unit});
  }
  // Impacts take energy, so that Im N is positive; empty where it is not.
  static std::optional<LawPoint> law_of(const MeasuredPoint& point) {
    const double size = std::abs(point.value);
    if (!(point.value.imag() > 0)) return std::nullopt;
    const double mass = point.value.imag() / (half_pi / 2 * std::pow(size * point.omega, 2));
    return LawPoint{mass, 1 / (half_pi * point.force * size * mass), point.value.real() / point.value.imag()};
  }
  // A restitution from 0 on has a from 1 on, of which noise may fall short.
  [[nodiscard]] std::optional<Groups> groups_of(const LawPoint& one, const LawPoint& other) const {
    Groups groups{};
    if (spread_ || total_) {
      const double a = spread_ ? *spread_ : *total_ / one.effective_mass;
      groups = {a * one.effective_mass, (one.ratio + half_pi * a) / one.compliance, a};
    } else {
      const double product = (one.ratio - other.ratio) / (one.compliance - other.compliance);
      const double a = (product * one.compliance - one.ratio) / half_pi;
      groups = {a * std::sqrt(one.effective_mass * other.effective_mass), product, a};
    }
    const bool is_scene = groups.spread > 0 && groups.product > 0 && std::isfinite(groups.product + groups.total);
    return is_scene ? std::optional(groups) : std::nullopt;
  }
  [[nodiscard]] Masses masses_of(const Groups& groups) const {
    return shares_of(groups.total, fixed_[0], known_mass2(std::log(groups.product), fixed_));
  }

  void rate(const Friction& friction, std::size_t one, std::size_t other) {
    // The masses tell what the mass that is not measured does, and are told by that: settled to some percent.
    constexpr int rounds_with_friction = 4;
    const bool rubs = friction[0] > 0 || friction[1] > 0;
    std::optional<Groups> groups;
    for (int round = 0; round < (rubs ? rounds_with_friction : 1); ++round) {
      const double like = fixed_[0].value_or(fixed_[1].value_or(1));
      const Masses masses = groups ? masses_of(*groups) : Masses{like, like};
      const auto first = law_of(point_of(rating_[one], masses, friction));
      const auto second = law_of(point_of(rating_[other], masses, friction));
      groups = first && second ? groups_of(*first, *second) : std::nullopt;
      if (!groups) return;
    }
    const double log_product = std::log(groups->product);
    Coordinates theta =
        scene(masses_of(*groups), log_product, std::max(0.0, (groups->spread - 1) / (groups->spread + 1)), bounds_);
    const Masses masses = {std::exp(theta[0]), std::exp(theta[1])};
    const OutputCoefficients coefficients = output_coefficients(theta, data_.output);
    double cost = 0;
    for (const std::size_t i : rating_) {
      const MeasuredPoint point = point_of(i, masses, friction);
      double least = data_.robust_cost(point, std::nullopt);
      if (const auto response = two_impact_response(gamma_at(theta, point), theta[3]))
        least = std::min(least, data_.robust_cost(point, point_value(coefficients, point, response->h)));
      cost += least;
    }
    std::copy(friction.begin(), friction.end(), theta.begin() + first_friction);
    rated_.push_back({theta, theta[1] + theta[2], cost});
  }

  static constexpr double half_pi = std::numbers::pi / 2;
  const SceneData& data_;
  const SceneBounds& bounds_;
  const FixedScene& fixed_;
  std::vector<std::size_t> rating_;
  std::optional<double> spread_, total_;
  std::vector<RatedStart> rated_;
};

bool law_speaks(const SceneData& data) {
  return data.output == Output::x1 && data.component == frac::Component::both;
}

}  // namespace

std::vector<Coordinates> law_starts(const SceneData& data, const SceneBounds& bounds, const FixedScene& fixed,
                                    std::size_t count) {
  if (!law_speaks(data)) return {};
  LawStarts starts(data, bounds, fixed);
  starts.rate({0, 0});
  return starts.best(count);
}

std::vector<Coordinates> rubbing_starts(const SceneData& data, const SceneBounds& bounds, const FixedScene& fixed,
                                        std::size_t count) {
  // Powers of 4 up to what stops most motions.
  constexpr std::array<double, 3> shares = {0, 0.05, 0.2};
  LawStarts starts(data, bounds, fixed);
  std::vector<Coordinates> places;
  for (const double of_drive : shares) {
    if (law_speaks(data)) {
      for (const double of_load : shares) starts.rate({of_load, of_drive});
      continue;
    }
    if (of_drive == 0) continue;
    SceneData smooth = data;
    for (MeasuredPoint& point : smooth.points)
      point = without_friction(point, data.output, {1, 1}, {0, of_drive * data.force_unit});
    for (Coordinates& place : scene_starts(smooth, bounds, fixed, {}, false, count / (shares.size() - 1))) {
      place[first_friction + 1] = of_drive;
      places.push_back(place);
    }
  }
  return law_speaks(data) ? starts.best(count) : places;
}

}  // namespace backlash::detail
