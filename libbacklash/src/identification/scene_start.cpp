// SPDX-License-Identifier: BSD-3-Clause
#include "scene_start.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

#include "frac/cancellation.hpp"
#include "frac/parallel_for.hpp"
#include "steady_state/steady_state.hpp"
#include "steady_state/two_impact_orbit.hpp"

namespace backlash::detail {
namespace {

using Complex = std::complex<double>;

constexpr double log_gamma_lower = -5;  // gamma 0.0067, below the saddle-node of restitution 0.96
constexpr double log_gamma_upper = 12;
constexpr double log_gamma_step = 0.05;
// Chatter is smooth in gamma: every few steps are enough.
constexpr int chatter_stride = 4;
constexpr std::array<double, 12> restitutions = {0, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.88, 0.94, 0.97};
// Between, the mean over chaotic and subharmonic motions is known to some percent at best.
constexpr int irregular_stride = 5;
// Points of the data that rate a node.
constexpr std::size_t most_points = 60;
constexpr double node_step = 0.1;  // of ln(mass2 clearance)
// Rounds of reweighting for the masses.
constexpr int linear_rounds = 3;
// Nodes nearer to each other than this lead to one estimate.
constexpr double near_log = 0.25;
constexpr double near_restitution = 0.11;

// h(gamma) at one restitution, where it is cheap and definite: two impacts per period, and chatter.
struct Row {
  double restitution;
  double loss;  // gamma where the orbit of two impacts ends
  double chatter_onset;
  std::vector<std::optional<Complex>> h;

  [[nodiscard]] std::optional<Complex> at(double log_gamma) const {
    const double place = (log_gamma - log_gamma_lower) / log_gamma_step;
    if (!(place >= 0 && place < static_cast<double>(h.size() - 1))) return std::nullopt;
    const auto below = static_cast<std::size_t>(place);
    if (!h[below] || !h[below + 1]) return std::nullopt;
    const double share = place - static_cast<double>(below);
    return (1 - share) * *h[below] + share * *h[below + 1];
  }
};

double gamma_of(int i) {
  return std::exp(log_gamma_lower + log_gamma_step * i);
}

Row make_row(double restitution) {
  const int count = static_cast<int>(std::lround((log_gamma_upper - log_gamma_lower) / log_gamma_step)) + 1;
  const double loss = restitution > 0 ? two_impact_loss(restitution).gamma : symmetry_loss(restitution).gamma;
  Row row{restitution, loss, std::exp(log_gamma_upper),
          std::vector<std::optional<Complex>>(static_cast<std::size_t>(count))};
  for (int i = 0; i < count && gamma_of(i) <= loss; ++i) {
    frac::throw_if_cancelled();
    if (const auto response = two_impact_response(gamma_of(i), restitution)) {
      row.h[static_cast<std::size_t>(i)] = response->h;
    }
  }
  int last = count - 1;
  std::optional<Complex> last_h;
  for (int i = count - 1; i >= 0; i -= chatter_stride) {
    frac::throw_if_cancelled();
    const auto h = sticking_h(gamma_of(i), restitution);
    if (!h || gamma_of(i) <= loss) break;
    row.h[static_cast<std::size_t>(i)] = h;
    for (int k = i + 1; last_h && k < last; ++k) {
      const double share = static_cast<double>(k - i) / (last - i);
      row.h[static_cast<std::size_t>(k)] = (1 - share) * *h + share * *last_h;
    }
    last = i;
    last_h = h;
    row.chatter_onset = gamma_of(i);
  }
  return row;
}

const std::vector<Row>& regular_table() {
  static const std::vector<Row> rows = [] {
    std::vector<Row> made;
    for (const double restitution : restitutions) made.push_back(make_row(restitution));
    return made;
  }();
  return rows;
}

// Fills what a row leaves open between its two motions, by averages from contact at rest.  They serve to rank starting
// points, to which the mean of a chaotic transient is as good as that of the orbit it ends on.
void fill_irregular(Row& row) {
  const auto first = static_cast<int>(std::floor((std::log(row.loss) - log_gamma_lower) / log_gamma_step));
  std::optional<Complex> before;
  int place = first;
  for (int i = std::max(first, 0); i < static_cast<int>(row.h.size()); i += irregular_stride) {
    const auto steady = find_steady_state(GapMotion(gamma_of(i), row.restitution), contact_at_rest_state(), 1e-6,
                                          {0, 0, Transients::ignored});
    const Complex here = steady.harmonics.u1_plus_gamma / gamma_of(i);
    for (int k = place; before && k <= i; ++k) {
      auto& entry = row.h[static_cast<std::size_t>(k)];
      const double share = static_cast<double>(k - place) / (i - place);
      if (!entry) entry = (1 - share) * *before + share * here;
    }
    before = here;
    place = i;
    if (gamma_of(i) >= row.chatter_onset) break;
  }
}

const std::vector<Row>& full_table() {
  static const std::vector<Row> rows = [] {
    std::vector<Row> filled = regular_table();
    frac::parallel_for(filled.size(), 0, [&](std::size_t i) { fill_irregular(filled[filled.size() - 1 - i]); });
    return filled;
  }();
  return rows;
}

struct Node {
  double log_product;  // ln(mass2 clearance)
  const Row* row;
  double restitution;
};

struct RatedStart {
  SceneVector theta;
  double log_product;
  double cost;
};

// Coefficients of N omega^2 = rigid + moving h in mass1 and mass2, by least squares over the parts fitted, each point
// weighed down by its misfit (Cauchy).
struct Masses {
  double mass1, mass2;
};

class NodeRater {
 public:
  NodeRater(const SceneData& data, const SceneBounds& bounds, const FixedScene& fixed)
      : data_(data), bounds_(bounds), fixed_(fixed) {
    const std::size_t stride = (data.points.size() + most_points - 1) / most_points;
    for (std::size_t i = 0; i < data.points.size(); i += stride) points_.push_back(i);
  }

  [[nodiscard]] std::optional<RatedStart> rate(const Node& node) const {
    std::vector<std::pair<std::size_t, Complex>> known;
    for (const std::size_t i : points_) {
      const MeasuredPoint& point = data_.points[i];
      const double log_gamma = std::log(point.force) - node.log_product - 2 * std::log(point.omega);
      if (const auto h = node.row->at(log_gamma)) known.emplace_back(i, *h);
    }
    if (known.size() < 2) return std::nullopt;
    const SceneVector theta = scene(node, masses(node, known));
    const OutputCoefficients coefficients = output_coefficients(theta, data_.output);
    double cost = 0;
    for (const std::size_t i : points_) {
      const MeasuredPoint& point = data_.points[i];
      const auto h = node.row->at(std::log(gamma_at(theta, point)));
      cost += data_.robust_cost(point, h ? std::optional<Complex>(point_value(coefficients, point, *h)) : std::nullopt);
    }
    return RatedStart{theta, node.log_product, cost};
  }

 private:
  // N omega^2 = -a h for x1 and -b (1 - h) - a h for x2, a = 1/(mass1 + mass2) and b = 1/mass2.
  [[nodiscard]] Masses masses(const Node& node, const std::vector<std::pair<std::size_t, Complex>>& known) const {
    std::optional<double> mass2 = fixed_[1];
    if (!mass2 && fixed_[2]) mass2 = std::exp(node.log_product) / *fixed_[2];
    if (mass2 && fixed_[0]) return {*fixed_[0], *mass2};
    const bool two_unknown = data_.output == Output::x2 && !mass2 && data_.component != frac::Component::imaginary;
    const bool difference_only = data_.output == Output::x2 && data_.component == frac::Component::imaginary;
    std::vector<double> weight(known.size(), 1.0);
    double a = 0, b = mass2 ? 1 / *mass2 : 0;
    for (int round = 0; round < linear_rounds; ++round) {
      double aa = 0, ab = 0, bb = 0, ay = 0, by = 0;
      for (std::size_t n = 0; n < known.size(); ++n) {
        const MeasuredPoint& point = data_.points[known[n].first];
        const Complex h = known[n].second;
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

  void reweigh(const std::vector<std::pair<std::size_t, Complex>>& known, double a, double b, bool difference_only,
               std::vector<double>& weight) const {
    for (std::size_t n = 0; n < known.size(); ++n) {
      const MeasuredPoint& point = data_.points[known[n].first];
      const Complex h = known[n].second;
      Complex model = difference_only ? a * h : -a * h;
      if (data_.output == Output::x2 && !difference_only) model -= b * (1.0 - h);
      model /= point.omega * point.omega;
      weight[n] = std::exp(-data_.robust_cost(point, model));
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
    const double total = 1 / a;
    if (!mass2 && data_.output == Output::x2 && b > 0) mass2 = 1 / b;
    if (fixed_[0]) return {*fixed_[0], mass2 ? *mass2 : std::max(total - *fixed_[0], 0.05 * total)};
    if (mass2) return {std::max(total - *mass2, 0.05 * *mass2), *mass2};
    return {0.5 * total, 0.5 * total};
  }

  [[nodiscard]] SceneVector scene(const Node& node, const Masses& masses) const {
    SceneVector theta{std::log(masses.mass1), std::log(masses.mass2), 0, node.restitution};
    theta[2] = node.log_product - theta[1];
    for (std::size_t k = 0; k < 4; ++k) theta[k] = std::clamp(theta[k], bounds_.lower[k], bounds_.upper[k]);
    return theta;
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
  for (double x = lowest - log_gamma_upper; x < highest - log_gamma_lower; x += node_step) result.push_back(x);
  for (const double jump : jumps) result.push_back(std::log(jump));
  return result;
}

}  // namespace

double chatter_onset(double restitution) {
  const auto& rows = regular_table();
  std::size_t above = 1;
  while (above + 1 < rows.size() && rows[above].restitution < restitution) ++above;
  // A power of 1 - restitution between two rows, and beyond the last one.
  const Row& lower = rows[above - 1];
  const Row& upper = rows[above];
  if (restitution >= 1) return std::numeric_limits<double>::infinity();
  const double slope =
      std::log(upper.chatter_onset / lower.chatter_onset) / std::log((1 - lower.restitution) / (1 - upper.restitution));
  return lower.chatter_onset * std::pow((1 - lower.restitution) / (1 - restitution), slope);
}

std::optional<Complex> irregular_h(double gamma, double restitution) {
  const auto& rows = full_table();
  std::size_t above = 1;
  while (above + 1 < rows.size() && rows[above].restitution < restitution) ++above;
  const auto lower = rows[above - 1].at(std::log(gamma));
  const auto upper = rows[above].at(std::log(gamma));
  if (!lower || !upper) return std::nullopt;
  const double width = rows[above].restitution - rows[above - 1].restitution;
  const double share = std::min((restitution - rows[above - 1].restitution) / width, 1.0);
  return (1 - share) * *lower + share * *upper;
}

std::vector<SceneVector> scene_starts(const SceneData& data, const SceneBounds& bounds, const FixedScene& fixed,
                                      const std::vector<double>& jumps, bool rate_irregular, std::size_t count) {
  const NodeRater rater(data, bounds, fixed);
  std::vector<RatedStart> rated;
  for (const double log_product : log_products(data, fixed, jumps)) {
    for (const Row& row : rate_irregular ? full_table() : regular_table()) {
      if (fixed[3] && std::abs(row.restitution - *fixed[3]) > near_restitution) continue;
      if (const auto start = rater.rate({log_product, &row, fixed[3].value_or(row.restitution)})) {
        rated.push_back(*start);
      }
    }
  }
  std::stable_sort(rated.begin(), rated.end(),
                   [](const RatedStart& one, const RatedStart& other) { return one.cost < other.cost; });
  std::vector<SceneVector> starts;
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

}  // namespace backlash::detail
