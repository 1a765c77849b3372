// SPDX-License-Identifier: BSD-3-Clause
#include "backlash/loops/impact_cycles.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <numbers>
#include <stdexcept>

#include "base/check.hpp"
#include "cycle_harmonics.hpp"
#include "cycle_stability.hpp"
#include "dense_elimination.hpp"
#include "excursion.hpp"
#include "gap_response.hpp"

namespace backlash {
namespace {

using Complex = std::complex<double>;

// The unknowns of Newton's method.
struct Motion {
  double period;
  std::vector<double> shares;  // of the period, at which the impacts happen; the first is 0
  std::vector<double> impulses;
  double middle;
};

// R_j of all pairs of impacts: at impact a the sum over the earlier impacts b of g^(j), with their mean left out.
class PairSums {
 public:
  PairSums(const detail::GapResponse& response, const Motion& motion)
      : impulses_(motion.impulses), count_(motion.shares.size()) {
    const detail::ImpulseTrain train(response, motion.period);
    const std::array<double, 3> own = train.repeated(motion.period);
    for (std::size_t a = 0; a < count_; ++a) {
      for (std::size_t b = 0; b < count_; ++b) {
        const double share = motion.shares[a] - motion.shares[b];
        all_.push_back(a == b ? own : train.repeated(motion.period * (share > 0 ? share : share + 1)));
      }
    }
  }
  [[nodiscard]] const std::array<double, 3>& at(std::size_t a, std::size_t b) const { return all_[a * count_ + b]; }
  /// The j-th derivative of x2 - x1 just before impact a; of the position without the middle.
  [[nodiscard]] double gap(std::size_t a, std::size_t j) const {
    double total = 0;
    for (std::size_t b = 0; b < count_; ++b) total -= impulses_[b] * at(a, b)[j];
    return total;
  }

 private:
  std::vector<double> impulses_;
  std::size_t count_;
  std::vector<std::array<double, 3>> all_;
};

class Equations {
 public:
  Equations(const ControlLoop& loop, const CycleGuess& guess)
      : response_(detail::gap_response(loop)),
        static_gap_(detail::static_gap(loop, 2 * std::numbers::pi / guess.period)),
        half_clearance_(0.5 * loop.system().clearance()),
        exchange_(response_.jump / (1 + loop.system().restitution())),
        count_(guess.impacts.size()) {
    for (const CycleImpact& impact : guess.impacts) walls_.push_back(impact.impulse > 0 ? 1 : -1);
  }

  [[nodiscard]] const detail::GapResponse& response() const { return response_; }
  [[nodiscard]] double exchange() const { return exchange_; }
  [[nodiscard]] double half_clearance() const { return half_clearance_; }

  /// The guess, with the middle that meets the walls on average.
  [[nodiscard]] Motion start(const CycleGuess& guess) const {
    Motion motion{guess.period, {}, {}, 0};
    for (const CycleImpact& impact : guess.impacts) {
      motion.shares.push_back(impact.time / guess.period);
      motion.impulses.push_back(impact.impulse);
    }
    const PairSums sums(response_, motion);
    for (std::size_t a = 0; a < count_; ++a) {
      motion.middle += (walls_[a] * half_clearance_ - sums.gap(a, 0)) / static_cast<double>(count_);
    }
    return motion;
  }

  /// One step of Newton's method. @return the largest relative change it asks for; NaN where there is none
  double improve(Motion& motion) const {
    double scale = 0;
    for (const double impulse : motion.impulses) scale = std::max(scale, std::abs(impulse));
    std::vector<double> change = residuals(motion, scale);
    for (double& each : change) each = -each;
    std::vector<double> matrix = derivatives(motion, scale);
    if (detail::eliminate(matrix, change) == 0) return NAN;
    double largest = 0;
    for (const double each : change) largest = std::max(largest, std::abs(each));
    if (!std::isfinite(largest)) return NAN;
    const double damping = largest > 0.3 ? 0.3 / largest : 1;
    for (std::size_t a = 1; a < count_; ++a) motion.shares[a] += damping * change[a - 1];
    motion.period *= std::exp(damping * change[count_ - 1]);
    for (std::size_t b = 0; b < count_; ++b) motion.impulses[b] += damping * scale * change[count_ + b];
    motion.middle += damping * half_clearance_ * change.back();
    for (std::size_t a = 0; a < count_; ++a) {
      if (!((a + 1 < count_ ? motion.shares[a + 1] : 1) > motion.shares[a])) return NAN;
    }
    return largest;
  }

 private:
  // Walls over half the clearance, speeds over that of the scale, and what keeps a free body from drifting.
  [[nodiscard]] std::vector<double> residuals(const Motion& motion, double scale) const {
    const PairSums sums(response_, motion);
    std::vector<double> residual(2 * count_ + 1);
    double total = 0;
    for (std::size_t a = 0; a < count_; ++a) {
      residual[a] = (motion.middle + sums.gap(a, 0)) / half_clearance_ - walls_[a];
      residual[count_ + a] = (sums.gap(a, 1) / exchange_ - motion.impulses[a]) / scale;
      total += motion.impulses[a];
    }
    residual.back() =
        static_gap_ ? (motion.middle + *static_gap_ * total / motion.period) / half_clearance_ : total / scale;
    return residual;
  }

  // By the shares but the first, the logarithm of the period, the impulses over the scale, and the middle over half the
  // clearance.
  [[nodiscard]] std::vector<double> derivatives(const Motion& motion, double scale) const {
    const PairSums sums(response_, motion);
    const std::size_t size = 2 * count_ + 1;
    std::vector<double> matrix(size * size, 0.0);
    const auto at = [&](std::size_t row, std::size_t column) -> double& { return matrix[row * size + column]; };
    const double speed = exchange_ * scale;
    for (std::size_t a = 0; a < count_; ++a) {
      for (std::size_t b = 0; b < count_; ++b) {
        const std::array<double, 3>& r = sums.at(a, b);
        if (b != a) {
          const double by_lag = motion.impulses[b] * motion.period * r[1] / half_clearance_;
          const double rate_by_lag = motion.impulses[b] * motion.period * r[2] / speed;
          if (a > 0) {
            at(a, a - 1) -= by_lag;
            at(count_ + a, a - 1) -= rate_by_lag;
          }
          if (b > 0) {
            at(a, b - 1) += by_lag;
            at(count_ + a, b - 1) += rate_by_lag;
          }
        }
        at(a, count_ + b) -= scale * r[0] / half_clearance_;
        at(count_ + a, count_ + b) -= scale * r[1] / speed;
      }
      at(count_ + a, count_ + a) -= 1;
      at(a, size - 1) = 1;
      at(size - 1, count_ + a) = static_gap_ ? *static_gap_ * scale / motion.period / half_clearance_ : 1;
    }
    at(size - 1, size - 1) = static_gap_ ? 1 : 0;
    // The period enters the sums over all earlier impacts, which have no closed derivative by it.
    constexpr double step = 1e-6;
    const auto shifted = [&](double by) {
      Motion other = motion;
      other.period *= std::exp(by);
      return residuals(other, scale);
    };
    const std::vector<double> later = shifted(step);
    const std::vector<double> earlier = shifted(-step);
    for (std::size_t row = 0; row < size; ++row) at(row, count_ - 1) = (later[row] - earlier[row]) / (2 * step);
    return matrix;
  }

  detail::GapResponse response_;
  std::optional<double> static_gap_;  // of a constant force between the bodies, m/N, if they settle
  double half_clearance_;
  double exchange_;
  std::size_t count_;
  std::vector<double> walls_;  // 1: +clearance/2
};

// x2 - x1 over the clearance, a time after the first impact that is none of an impact.
detail::GapMotion gap_at(const Motion& motion, const detail::ImpulseTrain& train, double clearance, double time) {
  detail::GapMotion gap{motion.middle / clearance, 0};
  for (std::size_t b = 0; b < motion.shares.size(); ++b) {
    double lag = time - motion.period * motion.shares[b];
    if (lag <= 0) lag += motion.period;
    const std::array<double, 3> sums = train.repeated(lag);
    gap.value -= motion.impulses[b] / clearance * sums[0];
    gap.rate -= motion.impulses[b] / clearance * sums[1];
  }
  return gap;
}

// `walls` of the guess it was made from.
std::string reason_against(const Motion& motion, const std::vector<double>& walls, const detail::ImpulseTrain& train,
                           double clearance) {
  const std::size_t count = motion.shares.size();
  for (std::size_t a = 0; a < count; ++a) {
    if (!(motion.impulses[a] * walls[a] > 0)) return "an impact would have to pull the masses together";
  }
  for (std::size_t a = 0; a < count; ++a) {
    const double from = motion.period * motion.shares[a];
    const double length = motion.period * ((a + 1 < count ? motion.shares[a + 1] : 1) - motion.shares[a]);
    const auto gap = [&](double t) { return gap_at(motion, train, clearance, from + t); };
    if (walls[a] * gap(1e-6 * length).rate > 0) return "the masses would be pressed into the wall they have just hit";
    const double excursion = detail::largest_excursion(gap, length);
    if (excursion >= 0.5) {
      return "between its impacts the motion would reach " + detail::text(std::round(1e4 * excursion) / 1e4) +
             " of the clearance from the middle, beyond the walls at 0.5";
    }
  }
  return {};
}

// Begins with the hardest impact.  A mirror image has it at the far wall.
struct Order {
  std::size_t first;
  double sign;
};
Order order_of(const Motion& motion) {
  std::size_t first = 0;
  for (std::size_t a = 1; a < motion.shares.size(); ++a) {
    const double more = std::abs(motion.impulses[a]) / std::abs(motion.impulses[first]) - 1;
    const bool is_equal = std::abs(more) <= 1e-9;  // but for rounding: the one at the far wall
    if (is_equal ? motion.impulses[first] < 0 && motion.impulses[a] > 0 : more > 0) first = a;
  }
  return {first, motion.impulses[first] > 0 ? 1.0 : -1.0};
}

bool is_symmetric(const Motion& motion, double half_clearance) {
  const std::size_t n = motion.shares.size();
  constexpr double tolerance = 1e-8;
  if (n % 2 == 1 || std::abs(motion.middle) > tolerance * half_clearance) return false;
  for (std::size_t a = 0; a < n / 2; ++a) {
    if (std::abs(motion.shares[a + n / 2] - motion.shares[a] - 0.5) > tolerance) return false;
    if (std::abs(motion.impulses[a + n / 2] / motion.impulses[a] + 1) > tolerance) return false;
  }
  return true;
}

void require_valid(const CycleGuess& guess) {
  detail::require_positive("period", "s", guess.period);
  if (guess.impacts.empty()) throw std::invalid_argument("the guess of a cycle has no impacts");
  if (guess.impacts.front().time != 0) throw std::invalid_argument("the first impact of the guess is not at time 0");
  for (std::size_t a = 0; a < guess.impacts.size(); ++a) {
    const CycleImpact& impact = guess.impacts[a];
    const double until = a + 1 < guess.impacts.size() ? guess.impacts[a + 1].time : guess.period;
    if (!(impact.time < until)) {
      throw std::invalid_argument("impact " + std::to_string(a + 1) + " of the guess is at " +
                                  detail::text(impact.time) + " s; times rise and stay below the period");
    }
    if (impact.impulse == 0 || !std::isfinite(impact.impulse)) {
      throw std::invalid_argument("impulse " + std::to_string(a + 1) + " of the guess is " +
                                  detail::text(impact.impulse) + " N s; it is finite and not 0");
    }
  }
}

}  // namespace

std::optional<ImpactCycle> close_cycle(const ControlLoop& loop, const CycleGuess& guess, int harmonics) {
  require_valid(guess);
  if (harmonics < 1) throw std::invalid_argument("harmonics is less than 1");
  const Equations equations(loop, guess);
  Motion found = equations.start(guess);
  // Quadratic once near; then the rounding of the sums decides.
  double change = 1;
  for (int i = 0; i < 40; ++i) {
    const double next = equations.improve(found);
    if (!std::isfinite(next)) return std::nullopt;
    const bool has_settled = next < 1e-15 || (next < 1e-9 && next > 0.5 * change);
    change = next;
    if (has_settled) break;
  }
  if (!(change < 1e-8)) return std::nullopt;

  const std::size_t count = found.shares.size();
  const Order order = order_of(found);
  Motion motion{found.period, {}, {}, order.sign * found.middle};
  std::vector<double> walls;
  std::vector<double> times;
  ImpactCycle cycle{};
  for (std::size_t a = 0; a < count; ++a) {
    const std::size_t from = (order.first + a) % count;
    const double share = found.shares[from] - found.shares[order.first];
    motion.shares.push_back(share < 0 ? share + 1 : share);
    motion.impulses.push_back(order.sign * found.impulses[from]);
    walls.push_back(order.sign * (guess.impacts[from].impulse > 0 ? 1 : -1));
    times.push_back(motion.period * motion.shares[a]);
    cycle.impacts.push_back({times[a], motion.impulses[a], equations.exchange() * std::abs(motion.impulses[a])});
  }
  cycle.period = motion.period;
  cycle.middle = motion.middle;
  cycle.symmetric = is_symmetric(motion, equations.half_clearance());
  const detail::ImpulseTrain train(equations.response(), motion.period);
  cycle.reason = reason_against(motion, walls, train, loop.system().clearance());
  cycle.admissible = cycle.reason.empty();
  const PairSums sums(equations.response(), motion);
  std::vector<double> bend;
  for (std::size_t a = 0; a < count; ++a) bend.push_back(-sums.gap(a, 2) / motion.impulses[a]);
  cycle.stability = detail::cycle_stability(equations.response(), train, times, bend, equations.exchange());
  cycle.error = change;
  const double omega = 2 * std::numbers::pi / motion.period;
  for (int k = 1; k <= harmonics; ++k) {
    Complex strength = 0;
    for (const CycleImpact& impact : cycle.impacts) {
      strength += 2 / motion.period * impact.impulse * std::polar(1.0, -k * omega * impact.time);
    }
    cycle.harmonics.push_back(detail::cycle_harmonic(loop, omega, k, strength));
  }
  return cycle;
}

std::optional<CycleGuess> repeated_pattern(const ControlLoop& loop, const std::vector<LoopImpact>& impacts,
                                           std::size_t most, double tolerance) {
  const TwoMassSystem& system = loop.system();
  const double impulse_per_speed = (1 + system.restitution()) / (1 / system.mass1() + 1 / system.mass2());
  for (std::size_t n = 1; n <= most && 2 * n + 1 <= impacts.size(); ++n) {
    const std::size_t last = impacts.size() - 1;
    const double period = impacts[last].time - impacts[last - n].time;
    double fastest = 0;
    for (std::size_t a = 0; a < n; ++a) fastest = std::max(fastest, impacts[last - a].speed);
    bool repeats = period > 0;
    for (std::size_t a = 0; a < n && repeats; ++a) {
      const LoopImpact& now = impacts[last - a];
      const LoopImpact& then = impacts[last - a - n];
      repeats = now.wall == then.wall && std::abs(now.speed - then.speed) <= tolerance * fastest &&
                std::abs(now.time - then.time - period) <= tolerance * period;
    }
    if (!repeats) continue;
    CycleGuess guess{period, {}};
    for (std::size_t a = 0; a < n; ++a) {
      const LoopImpact& impact = impacts[last - n + a];
      const double sign = impact.wall == Wall::far ? 1 : -1;
      guess.impacts.push_back(
          {impact.time - impacts[last - n].time, sign * impulse_per_speed * impact.speed, impact.speed});
    }
    return guess;
  }
  return std::nullopt;
}

}  // namespace backlash
