// SPDX-License-Identifier: BSD-3-Clause
#include "rest_cycles.hpp"

#include <algorithm>
#include <boost/math/quadrature/gauss.hpp>
#include <cmath>
#include <complex>
#include <cstddef>
#include <numbers>

#include "base/eigenvalues.hpp"
#include "base/impact_law.hpp"
#include "base/linear_algebra.hpp"
#include "loops/equations/cycle_harmonics.hpp"

namespace backlash::detail {
namespace {

using Complex = std::complex<double>;
using Eigen::MatrixXd;
using Eigen::VectorXd;
constexpr std::size_t most_releases = 12;
// Events on the way to a release; bounces that keep 0.99 of their speed end after 2300.
constexpr int most_events = 20'000;

// From release to release, of states over their sizes.
class ReleaseMap {
 public:
  ReleaseMap(const RealisedLoop& loop, const RestPattern& pattern)
      : pattern_(pattern), sizes_(loop.sizes()), start_(pattern.release.state().cwiseQuotient(sizes_)) {
    // Parts of a state right after a release that may not change: gap, its rate, and its acceleration in flight, which
    // is that of the contact's force.
    MatrixXd held = MatrixXd::Zero(sizes_.size(), 3);
    held(0, 0) = held(1, 1) = -1;
    held(2, 0) = held(3, 1) = 1;
    held.col(2) = loop.regime({}).gap_acceleration.transpose().cwiseProduct(sizes_);
    held.col(2).normalize();
    const MatrixXd basis = frac::detail::PlainQr(held).basis();
    free_ = MatrixXd::Identity(sizes_.size(), sizes_.size()) - basis * basis.transpose();
  }

  [[nodiscard]] const VectorXd& start() const { return start_; }
  [[nodiscard]] LoopRun run_from(const VectorXd& z) const {
    LoopRun run = pattern_.release;
    run.set_state(z.cwiseProduct(sizes_));
    return run;
  }
  // Empty where the motion comes to no such release.
  [[nodiscard]] std::optional<VectorXd> operator()(const VectorXd& z) const {
    LoopRun run = run_from(z);
    int releases = 0;
    for (int i = 0; i < most_events && releases < pattern_.releases; ++i) {
      const LoopRun::Event event = run.advance(run.time() + 1000 / pace());
      if (event == LoopRun::Event::none || run.is_stuck()) return std::nullopt;
      releases += event == LoopRun::Event::release;
    }
    const double sign = pattern_.is_mirror ? -1 : 1;
    if (releases < pattern_.releases || run.wall() != sign * pattern_.release.wall()) return std::nullopt;
    return sign * run.state().cwiseQuotient(sizes_);
  }
  [[nodiscard]] std::optional<MatrixXd> derivative(const VectorXd& z) const {
    MatrixXd by_state(z.size(), z.size());
    for (Eigen::Index i = 0; i < z.size(); ++i) {
      const VectorXd step = difference * free_.col(i);
      const auto after = (*this)(z + step), before = (*this)(z - step);
      if (!after || !before) return std::nullopt;
      by_state.col(i) = (*after - *before) / (2 * difference);
    }
    return by_state;
  }

 private:
  static constexpr double difference = 1e-4;
  [[nodiscard]] double pace() const { return sizes_[1] / sizes_[0]; }

  const RestPattern& pattern_;
  VectorXd sizes_;
  VectorXd start_;
  MatrixXd free_;
};

struct FixedPoint {
  VectorXd state;
  MatrixXd derivative;
  double error;
};
std::optional<FixedPoint> fixed_point(const ReleaseMap& map) {
  VectorXd z = map.start();
  std::optional<MatrixXd> derivative;
  double change = 1;
  const MatrixXd one = MatrixXd::Identity(z.size(), z.size());
  for (int i = 0; i < 30; ++i) {
    const auto next = map(z);
    if (!next) return std::nullopt;
    const VectorXd defect = *next - z;
    const double now = defect.lpNorm<Eigen::Infinity>() / (1 + z.lpNorm<Eigen::Infinity>());
    const bool has_settled = now < 1e-14 || (now < 1e-7 && now > 0.3 * change);
    if (!derivative || has_settled || now > 0.1 * change) derivative = map.derivative(z);
    if (!derivative) return std::nullopt;
    if (has_settled) return FixedPoint{z, *derivative, now};
    change = now;
    z += frac::detail::PivotedQr(one - *derivative).solve(defect);
    if (!z.allFinite()) return std::nullopt;
  }
  return std::nullopt;
}

// Of a fractional loop those real ones that a history without end makes a cut of are left out.
CycleStability stability_of(const FixedPoint& point, const RestPattern& pattern, bool is_fractional) {
  CycleStability stability{true, 0, 0, StabilityLoss::none};
  Complex dominant = 0;
  const Eigen::VectorXcd all = frac::detail::eigenvalues(point.derivative);
  for (const Complex z : all) {
    const double along = pattern.is_mirror ? -z.real() : z.real();
    if (is_fractional && z.imag() == 0 && along > 0 && along < 1) continue;
    if (std::abs(z) > 1) ++stability.unstable_multipliers;
    if (std::abs(z) > std::max(std::abs(dominant), 0.05)) dominant = z;
  }
  stability.dominant = pattern.is_mirror ? dominant * dominant : dominant;
  stability.stable = stability.unstable_multipliers == 0;
  if (stability.stable) return stability;
  stability.loss = dominant.imag() != 0  ? StabilityLoss::torus
                   : dominant.real() > 0 ? StabilityLoss::saddle_node
                   : pattern.is_mirror   ? StabilityLoss::symmetry_breaking
                                         : StabilityLoss::period_doubling;
  return stability;
}

// One flight or rest.
struct Piece {
  LoopRun begin;
  double length;
};

// Sum over nodes that crowd at the begin, where the memory of a fractional order has a root of time, and that follow
// what oscillates as fast as the highest harmonic.
// @param fastest  rad/s
template <typename Function>
void integrate(const Piece& piece, double fastest, const Function& add) {
  using Rule = boost::math::quadrature::gauss<double, 20>;
  const int panels = 4 + static_cast<int>(fastest * piece.length / 2);
  std::vector<std::pair<double, double>> nodes;
  for (int panel = 0; panel < panels; ++panel) {
    for (std::size_t i = 0; i < Rule::abscissa().size(); ++i) {
      for (const double side : {-1.0, 1.0}) {
        const double u = (panel + 0.5 + 0.5 * side * Rule::abscissa()[i]) / panels;
        nodes.emplace_back(std::pow(u, 4), 4 * std::pow(u, 3) * Rule::weights()[i] * 0.5 / panels);
      }
    }
  }
  std::sort(nodes.begin(), nodes.end());
  LoopRun run = piece.begin;
  for (const auto& [share, weight] : nodes) {
    static_cast<void>(run.advance(piece.begin.time() + share * piece.length));
    add(run, weight * piece.length);
  }
}

}  // namespace

std::optional<RestPattern> repeated_rests(const RealisedLoop& loop, const std::vector<LoopRun>& releases,
                                          double tolerance) {
  for (std::size_t n = 1; n <= most_releases && 2 * n < releases.size(); ++n) {
    const auto at = [&](std::size_t back) -> const LoopRun& { return releases[releases.size() - 1 - back]; };
    const double sign = at(0).wall() * at(n).wall();
    const auto apart = [&](std::size_t later, std::size_t earlier) {
      return (at(later).state() - sign * at(earlier).state())
          .cwiseQuotient(loop.sizes())
          .head<4>()
          .lpNorm<Eigen::Infinity>();
    };
    const double size = at(0).state().cwiseQuotient(loop.sizes()).head<4>().lpNorm<Eigen::Infinity>();
    const double length = at(0).time() - at(n).time();
    if (apart(0, n) > tolerance * size || apart(n, 2 * n) > tolerance * size) continue;
    if (std::abs(at(n).time() - at(2 * n).time() - length) > tolerance * length) continue;
    return RestPattern{at(0), static_cast<int>(n), sign < 0};
  }
  return std::nullopt;
}

std::optional<ImpactCycle> close_rests(const ControlLoop& loop, const RealisedLoop& realised,
                                       const RestPattern& pattern, int harmonics) {
  const ReleaseMap map(realised, pattern);
  const auto point = fixed_point(map);
  if (!point) return std::nullopt;
  ImpactCycle cycle{};
  cycle.symmetric = pattern.is_mirror;
  cycle.admissible = true;
  cycle.stability = stability_of(*point, pattern, realised.error() > 0);
  cycle.error = std::max(point->error, realised.error());

  const TwoMassSystem& system = loop.system();
  LoopRun run = map.run_from(point->state);
  const double begin = run.time();
  std::vector<Piece> pieces{{run, 0}};
  const int releases = pattern.releases * (pattern.is_mirror ? 2 : 1);
  for (int passed = 0; passed < releases;) {
    const LoopRun::Event event = run.advance(run.time() + 1000 / realised.pace());
    if (event == LoopRun::Event::none) return std::nullopt;
    pieces.back().length = run.time() - pieces.back().begin.time();
    if (event == LoopRun::Event::impact) {
      const LoopImpact& impact = run.last_impact();
      const double sign = impact.wall == Wall::far ? 1 : -1;
      cycle.impacts.push_back({impact.time - begin, sign * impulse_per_speed(system) * impact.speed, impact.speed});
    }
    if (run.is_in_contact()) cycle.rests.push_back({run.time() - begin, 0, 0});
    if (event == LoopRun::Event::release) {
      ++passed;
      cycle.rests.back().duration = run.time() - begin - cycle.rests.back().time;
    }
    if (passed < releases) pieces.push_back({run, 0});
  }
  cycle.period = run.time() - begin;
  if (cycle.impacts.empty()) return std::nullopt;

  const auto hardest =
      std::max_element(cycle.impacts.begin(), cycle.impacts.end(), [](const CycleImpact& a, const CycleImpact& b) {
        // But for rounding the one at the far wall.
        return std::abs(a.speed / b.speed - 1) < 1e-8 ? a.impulse < b.impulse : a.speed < b.speed;
      });
  const double first = hardest->time, sign = hardest->impulse > 0 ? 1 : -1;
  const double omega = 2 * std::numbers::pi / cycle.period;
  // Of the force of the walls on mass 1.
  std::vector<Complex> strengths(static_cast<std::size_t>(harmonics), 0.0);
  const auto add_force = [&](double time, double impulse) {
    const Complex turn = std::polar(1.0, -omega * (time - first));
    Complex turned = sign * impulse * 2 / cycle.period;
    for (Complex& strength : strengths) strength += turned *= turn;
  };
  for (const CycleImpact& impact : cycle.impacts) add_force(impact.time, impact.impulse);
  auto rest = cycle.rests.begin();
  for (const Piece& piece : pieces) {
    const bool is_rest = piece.begin.is_in_contact();
    integrate(piece, is_rest ? harmonics * omega : 0, [&](const LoopRun& at, double weight) {
      const LoopRow row = at.row(LoopEvent::sample);
      cycle.middle += sign * weight / cycle.period * (row.x2 - row.x1);
      if (!is_rest) return;
      const double impulse = weight * at.contact_force();
      rest->impulse += impulse;
      add_force(at.time() - begin, impulse);
    });
    if (is_rest) ++rest;
  }
  for (int k = 1; k <= harmonics; ++k) {
    cycle.harmonics.push_back(cycle_harmonic(loop, omega, k, strengths[static_cast<std::size_t>(k - 1)]));
  }
  const auto shift = [&](auto& all) {
    for (auto& each : all) {
      each.impulse *= sign;
      each.time -= first;
      if (each.time < 0) each.time += cycle.period;
    }
    std::sort(all.begin(), all.end(), [](const auto& a, const auto& b) { return a.time < b.time; });
  };
  shift(cycle.impacts);
  shift(cycle.rests);
  return cycle;
}

}  // namespace backlash::detail
