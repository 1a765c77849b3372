// SPDX-License-Identifier: BSD-3-Clause
#include "cycle_equations.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "base/check.hpp"
#include "base/impact_law.hpp"
#include "cycle_harmonics.hpp"
#include "dense_elimination.hpp"

namespace backlash::detail {
namespace {

using Complex = std::complex<double>;
constexpr double pi = std::numbers::pi;

// R_j of all pairs of impacts: at impact a the sum over the earlier impacts b of g^(j), with their mean left out.
class PairSums {
 public:
  PairSums(const AnsweredTrain& train, const ClosedMotion& motion)
      : impulses_(motion.impulses), count_(motion.shares.size()) {
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

double largest_impulse(const ClosedMotion& motion) {
  double largest = 0;
  for (const double impulse : motion.impulses) largest = std::max(largest, std::abs(impulse));
  return largest;
}

}  // namespace

AnsweredTrain::AnsweredTrain(const ImpulseAnswer& response, double period,
                             const std::optional<FundamentalAnswer>& answer)
    : train_(response, period) {
  if (!answer) return;
  omega_ = 2 * pi * answer->force_periods / period;
  answer_ = 2 / period * answer->answer(omega_);
}

std::array<double, 3> AnsweredTrain::repeated(double t) const {
  std::array<double, 3> sums = train_.repeated(t);
  if (answer_ == 0.0) return sums;
  Complex turned = answer_ * std::polar(1.0, omega_ * t);
  for (double& each : sums) {
    each -= turned.real();
    turned *= Complex(0, omega_);
  }
  return sums;
}

CycleEquations::CycleEquations(const ControlLoop& loop, const CycleGuess& guess)
    : CycleEquations(loop.system(), guess, gap_response(loop), detail::static_gap(loop, 2 * pi / guess.period)) {}

CycleEquations::CycleEquations(const ControlLoop& loop, const CycleGuess& guess, FundamentalAnswer answer)
    : CycleEquations(loop.system(), guess, gap_response(loop.bodies()),
                     detail::static_gap(loop, 2 * pi / guess.period)) {
  answer_ = std::move(answer);
}

CycleEquations::CycleEquations(const LinearBodies& bodies, const CycleGuess& guess, const ForcedGap& forced)
    : CycleEquations(bodies.system(), guess, gap_response(bodies), detail::static_gap(bodies, 2 * pi / guess.period)) {
  forced_ = forced;
}

CycleEquations::CycleEquations(const TwoMassSystem& system, const CycleGuess& guess, ImpulseAnswer response,
                               std::optional<double> static_gap)
    : response_(std::move(response)),
      static_gap_(static_gap),
      half_clearance_(0.5 * system.clearance()),
      exchange_(speed_per_impulse(response_.jump, system)),
      count_(guess.impacts.size()) {
  for (const CycleImpact& impact : guess.impacts) walls_.push_back(impact.impulse > 0 ? 1 : -1);
}

std::array<double, 3> CycleEquations::forced_at(const ClosedMotion& motion, double time) const {
  if (!forced_) return {0, 0, 0};
  const double omega = 2 * pi * forced_->force_periods / motion.period;
  const double angle = omega * time + motion.phase;
  const double position = forced_->amplitude * std::cos(angle);
  return {position, -omega * forced_->amplitude * std::sin(angle), -omega * omega * position};
}

// A time after the first impact that is none of an impact.
GapSample CycleEquations::gap_at(const ClosedMotion& motion, const AnsweredTrain& train, double time) const {
  const std::array<double, 3> forced = forced_at(motion, time);
  GapSample gap{motion.middle + forced[0], forced[1]};
  for (std::size_t b = 0; b < count_; ++b) {
    double lag = time - motion.period * motion.shares[b];
    if (lag <= 0) lag += motion.period;
    const std::array<double, 3> sums = train.repeated(lag);
    gap.value -= motion.impulses[b] * sums[0];
    gap.rate -= motion.impulses[b] * sums[1];
  }
  return gap;
}

std::optional<CycleEquations::Solution> CycleEquations::solve(const CycleGuess& guess, double phase) const {
  ClosedMotion found = start(guess, phase);
  // Quadratic once near; then the rounding of the sums decides.
  double change = 1;
  for (int i = 0; i < 40; ++i) {
    const double next = improve(found);
    if (!std::isfinite(next)) return std::nullopt;
    const bool has_settled = next < 1e-15 || (next < 1e-9 && next > 0.5 * change);
    change = next;
    if (has_settled) break;
  }
  if (!(change < 1e-8)) return std::nullopt;
  return Solution{found, change};
}

// The guess, with the middle that meets the walls on average.
ClosedMotion CycleEquations::start(const CycleGuess& guess, double phase) const {
  ClosedMotion motion{guess.period, {}, {}, 0, phase};
  for (const CycleImpact& impact : guess.impacts) {
    motion.shares.push_back(impact.time / guess.period);
    motion.impulses.push_back(impact.impulse);
  }
  const std::vector<double> position = gap(motion, 0);
  for (std::size_t a = 0; a < count_; ++a) {
    motion.middle += (walls_[a] * half_clearance_ - position[a]) / static_cast<double>(count_);
  }
  return motion;
}

// One step of Newton's method. Returns the largest relative change it asks for; NaN where there is none.
double CycleEquations::improve(ClosedMotion& motion) const {
  const double scale = largest_impulse(motion);
  std::vector<double> change = residuals(motion, scale);
  for (double& each : change) each = -each;
  std::vector<double> matrix = derivatives(motion, scale);
  if (eliminate(matrix, change) == 0) return NAN;
  double largest = 0;
  for (const double each : change) {
    if (!std::isfinite(each)) return NAN;
    largest = std::max(largest, std::abs(each));
  }
  const double damping = largest > 0.3 ? 0.3 / largest : 1;
  for (std::size_t a = 1; a < count_; ++a) motion.shares[a] += damping * change[a - 1];
  if (forced_) {
    motion.phase += damping * change[count_ - 1];
  } else {
    motion.period *= std::exp(damping * change[count_ - 1]);
  }
  for (std::size_t b = 0; b < count_; ++b) motion.impulses[b] += damping * scale * change[count_ + b];
  motion.middle += damping * half_clearance_ * change.back();
  for (std::size_t a = 0; a < count_; ++a) {
    if (!((a + 1 < count_ ? motion.shares[a + 1] : 1) > motion.shares[a])) return NAN;
  }
  return largest;
}

// Walls over half the clearance, speeds over that of the scale, and what keeps a free body from drifting.
std::vector<double> CycleEquations::residuals(const ClosedMotion& motion, double scale) const {
  const PairSums sums(AnsweredTrain(response_, motion.period, answer_), motion);
  std::vector<double> residual(2 * count_ + 1);
  double total = 0;
  for (std::size_t a = 0; a < count_; ++a) {
    const std::array<double, 3> forced = forced_at(motion, motion.period * motion.shares[a]);
    residual[a] = (motion.middle + sums.gap(a, 0) + forced[0]) / half_clearance_ - walls_[a];
    residual[count_ + a] = ((sums.gap(a, 1) + forced[1]) / exchange_ - motion.impulses[a]) / scale;
    total += motion.impulses[a];
  }
  residual.back() =
      static_gap_ ? (motion.middle + *static_gap_ * total / motion.period) / half_clearance_ : total / scale;
  return residual;
}

// By the shares but the first, the logarithm of the period or the phase of the force, the impulses over the scale, and
// the middle over half the clearance.
std::vector<double> CycleEquations::derivatives(const ClosedMotion& motion, double scale) const {
  const PairSums sums(AnsweredTrain(response_, motion.period, answer_), motion);
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
    if (forced_) {
      const std::array<double, 3> forced = forced_at(motion, motion.period * motion.shares[a]);
      if (a > 0) {
        at(a, a - 1) += motion.period * forced[1] / half_clearance_;
        at(count_ + a, a - 1) += motion.period * forced[2] / speed;
      }
      const double omega = 2 * pi * forced_->force_periods / motion.period;
      at(a, count_ - 1) = forced[1] / omega / half_clearance_;
      at(count_ + a, count_ - 1) = forced[2] / omega / speed;
    }
    at(count_ + a, count_ + a) -= 1;
    at(a, size - 1) = 1;
    at(size - 1, count_ + a) = static_gap_ ? *static_gap_ * scale / motion.period / half_clearance_ : 1;
  }
  at(size - 1, size - 1) = static_gap_ ? 1 : 0;
  if (forced_) return matrix;
  // The period enters the sums over all earlier impacts, which have no closed derivative by it.
  constexpr double step = 1e-6;
  const auto shifted = [&](double by) {
    ClosedMotion other = motion;
    other.period *= std::exp(by);
    return residuals(other, scale);
  };
  const std::vector<double> later = shifted(step);
  const std::vector<double> earlier = shifted(-step);
  for (std::size_t row = 0; row < size; ++row) at(row, count_ - 1) = (later[row] - earlier[row]) / (2 * step);
  return matrix;
}

std::optional<CycleEquations::Sensitivity> CycleEquations::sensitivity(const ClosedMotion& motion) const {
  const double scale = largest_impulse(motion);
  const std::size_t size = 2 * count_ + 1;
  const int turns = answer_->force_periods;
  const double omega = 2 * pi * turns / motion.period;
  const Complex kicks = strength(motion, turns);
  std::array<std::vector<double>, 2> solved;
  for (std::size_t part = 0; part < 2; ++part) {
    // The force adds Re(answer kicks e^{j omega t}) to x2 - x1.
    std::vector<double> change(size, 0.0);
    for (std::size_t a = 0; a < count_; ++a) {
      const Complex turned =
          (part == 0 ? Complex(1) : Complex(0, 1)) * kicks * std::polar(1.0, omega * motion.shares[a] * motion.period);
      change[a] = -turned.real() / half_clearance_;
      change[count_ + a] = -(Complex(0, omega) * turned).real() / (exchange_ * scale);
    }
    std::vector<double> matrix = derivatives(motion, scale);
    if (eliminate(matrix, change) == 0) return std::nullopt;
    solved[part] = std::move(change);
  }
  const auto both = [&](std::size_t row, double factor) { return factor * Complex(solved[0][row], solved[1][row]); };
  Sensitivity result{both(count_ - 1, -omega), {0}, {}};
  for (std::size_t a = 1; a < count_; ++a) result.shares.push_back(both(a - 1, 1));
  for (std::size_t b = 0; b < count_; ++b) result.impulses.push_back(both(count_ + b, scale));
  return result;
}

std::string CycleEquations::reason_against(const ClosedMotion& motion) const {
  for (std::size_t a = 0; a < count_; ++a) {
    if (!(motion.impulses[a] * walls_[a] > 0)) return "an impact would have to pull the masses together";
  }
  const AnsweredTrain train(response_, motion.period, answer_);
  for (std::size_t a = 0; a < count_; ++a) {
    const double from = motion.period * motion.shares[a];
    const double length = motion.period * ((a + 1 < count_ ? motion.shares[a + 1] : 1) - motion.shares[a]);
    const auto gap = [&](double t) { return gap_at(motion, train, from + t); };
    if (walls_[a] * gap(1e-6 * length).rate > 0) return "the masses would be pressed into the wall they have just hit";
    const double excursion = largest_excursion(gap, length) / (2 * half_clearance_);
    if (excursion >= 0.5) {
      return "between its impacts the motion would reach " + text(std::round(1e4 * excursion) / 1e4) +
             " of the clearance from the middle, beyond the walls at 0.5";
    }
  }
  return {};
}

std::vector<double> CycleEquations::gap(const ClosedMotion& motion, std::size_t derivative) const {
  const PairSums sums(AnsweredTrain(response_, motion.period, answer_), motion);
  std::vector<double> values;
  for (std::size_t a = 0; a < count_; ++a) {
    values.push_back(sums.gap(a, derivative) + forced_at(motion, motion.period * motion.shares[a])[derivative]);
  }
  return values;
}

Complex CycleEquations::strength(const ClosedMotion& motion, int turns) {
  Complex sum = 0;
  for (std::size_t b = 0; b < motion.shares.size(); ++b) {
    sum += 2 / motion.period * motion.impulses[b] * std::polar(1.0, -2 * pi * turns * motion.shares[b]);
  }
  return sum;
}

}  // namespace backlash::detail
