// SPDX-License-Identifier: BSD-3-Clause
#include "backlash/loops/predicted_cycles.hpp"

#include <algorithm>
#include <array>
#include <boost/math/tools/toms748_solve.hpp>
#include <cmath>
#include <complex>
#include <cstdint>
#include <functional>
#include <numbers>
#include <stdexcept>
#include <utility>

#include "base/check.hpp"
#include "base/impact_law.hpp"
#include "cycle_frequencies.hpp"
#include "frequency_search.hpp"
#include "loops/equations/cycle_equations.hpp"
#include "loops/equations/cycle_harmonics.hpp"
#include "loops/equations/dense_elimination.hpp"
#include "loops/equations/forced_orbits.hpp"
#include "loops/equations/gap_response.hpp"

namespace backlash {
namespace {

using Complex = std::complex<double>;
using detail::ClosedMotion;
using detail::CycleEquations;
constexpr double pi = std::numbers::pi;

// F G2 over the fundamental of the impulses.
Complex answer_of(const ControlLoop& loop, double omega) {
  const Complex controller = loop.controller().response(omega);
  const Complex load = loop.bodies().load().response(omega);
  const Complex drive = loop.bodies().drive().response(omega);
  return loop.measured() == Output::x1 ? -controller * load * drive
                                       : controller * drive * drive / (1.0 + controller * drive);
}

// -1/nu = C/((M1 + M2) w^2) of the rigid loop with the load measured, and what takes its place with x2 measured; of
// free masses.
Complex rigid_loop(const ControlLoop& loop, double omega) {
  const double mass1 = loop.system().mass1(), mass2 = loop.system().mass2();
  const Complex nu = -(mass1 + mass2) * omega * omega / loop.controller().response(omega);
  return loop.measured() == Output::x1 ? -1.0 / nu : 1.0 / (1.0 + mass2 / mass1 * (nu + 1.0));
}

double loss_ratio(const ControlLoop& loop) {
  return detail::loss_ratio(loop.system().restitution());
}

// The angle 2 pi (1/2 - share) at which theta/(2 sin theta) is a number above 1/2.
double angle_of(double real_part) {
  const auto excess = [&](double theta) { return theta - 2 * real_part * std::sin(theta); };
  std::uintmax_t evaluations = 60;
  // There the excess is below 0, as sin(theta) > theta - theta^3/6.
  const double low = std::sqrt(3 * (2 * real_part - 1) / (2 * real_part));
  if (!(excess(low) < 0)) return low;
  // The angle of numbers above 1e16 is pi to rounding.
  if (!(excess(pi) > 0)) return pi;
  const auto [from, to] =
      boost::math::tools::toms748_solve(excess, low, pi, boost::math::tools::eps_tolerance<double>(52), evaluations);
  return 0.5 * (from + to);
}

class Predictions {
 public:
  explicit Predictions(const ControlLoop& loop) : loop_(loop) {}

  [[nodiscard]] detail::FundamentalAnswer answer(int force_periods = 1) const {
    return {[this](double omega) { return answer_of(loop_, omega); }, force_periods};
  }

  /// The description of a motion that solves the equations.
  [[nodiscard]] PredictedCycle cycle(const CycleEquations& equations, const ClosedMotion& motion, bool symmetric,
                                     int force_periods = 1) const {
    const double omega = 2 * pi * force_periods / motion.period;
    const Complex share = answer_of(loop_, omega);
    const Complex kicks = CycleEquations::strength(motion, force_periods);
    const double force = std::abs(share * kicks / loop_.bodies().drive().response(omega));
    const auto harmonic = [&](int order) {
      const frac::FractionalTransferFunction& body =
          loop_.measured() == Output::x1 ? loop_.bodies().load() : loop_.bodies().drive();
      const Complex impulses = CycleEquations::strength(motion, order * force_periods);
      return std::abs(loop_.controller().response(order * omega) * body.response(order * omega) * impulses) / force;
    };
    PredictedCycle cycle{omega,         force,
                         false,         false,
                         harmonic(3),   symmetric ? 0 : harmonic(2),
                         symmetric,     static_cast<int>(motion.shares.size()),
                         force_periods, equations.reason_against(motion).empty()};
    if (const auto sensitivity = equations.sensitivity(motion)) judge(cycle, motion, *sensitivity, share, kicks);
    return cycle;
  }

  /// Two impulses of equal size and a middle that fit to a frequency and a share of the period, if they push.
  [[nodiscard]] std::optional<PredictedCycle> balanced(double omega, double share) const {
    const double period = 2 * pi / omega;
    const CycleGuess walls{period, {{0, 1, 0}, {share * period, -1, 0}}};
    const CycleEquations equations(loop_, walls, answer());
    const ClosedMotion unit{period, {0, share}, {1, -1}, 0};
    const std::vector<double> gap = equations.gap(unit, 0);
    const double impulse = 2 * equations.half_clearance() / (gap[0] - gap[1]);
    if (!(impulse > 0) || !std::isfinite(impulse)) return std::nullopt;
    return cycle(equations, {period, {0, share}, {impulse, -impulse}, equations.half_clearance() - impulse * gap[0]},
                 share == 0.5);
  }

 private:
  // The orbits of a sine force of given frequency are a curve in the plane of the answers A that they ask for, and the
  // cycle is the point of it at which A is that of the loop.  With D = 1 + C N, which is A less that of the loop times
  // a complex number, and s along the curve, Loeb's U_F V_w - V_F U_w is that number's square times
  //   Im(conj(A_s) (A_w - A_loop'))/F_s;   A_s = j g, A_w = g/|g|^2, g the gradient of omega by A.
  void judge(PredictedCycle& cycle, const ClosedMotion& motion, const CycleEquations::Sensitivity& sensitivity,
             Complex answer, Complex kicks) const {
    const Complex g = sensitivity.omega;
    const Complex along(-g.imag(), g.real());
    const auto rise = [&](Complex gradient) { return (std::conj(gradient) * along).real(); };
    Complex of_kicks = 0;
    for (std::size_t b = 0; b < motion.shares.size(); ++b) {
      const double turn = -2 * pi * cycle.period;
      of_kicks += 2 / motion.period * std::polar(1.0, turn * motion.shares[b]) *
                  Complex(rise(sensitivity.impulses[b]), motion.impulses[b] * turn * rise(sensitivity.shares[b]));
    }
    const double force = (along / answer + of_kicks / kicks).real();
    constexpr double step = 1e-5;
    const Complex slope = (answer_of(loop_, cycle.omega * (1 + step)) - answer_of(loop_, cycle.omega * (1 - step))) /
                          (2 * step * cycle.omega);
    cycle.stable = ((std::conj(g) * slope).real() - 1) * force > 0;
    cycle.faster_orbit = rise(sensitivity.impulses.front()) * motion.impulses.front() * force > 0;
  }

  const ControlLoop& loop_;
};

std::vector<double> grid_of(const ControlLoop& loop, const std::optional<FrequencyRange>& range) {
  return detail::search_grid(detail::search_range(loop, range), loop.controller().delay());
}

// Sign changes of a defect of the rigid loop, which is 0 where it is below the loop's own rounding.
std::vector<double> roots_of(const ControlLoop& loop, const std::function<double(double)>& defect,
                             const std::vector<double>& grid) {
  const auto relative = [&](double omega) {
    return defect(omega) / (std::abs(rigid_loop(loop, omega)) + loss_ratio(loop));
  };
  return detail::roots_on_grid(relative, relative, grid, 1e-14);
}

// Frequencies of the symmetric orbits.
std::vector<double> symmetric_frequencies(const ControlLoop& loop, const std::optional<FrequencyRange>& range) {
  std::vector<double> frequencies;
  if (!loop.bodies().are_free()) {
    // The masses meet at the speed that the impacts ask for.
    const detail::ImpulseAnswer response = detail::gap_response(loop.bodies());
    const double exchange = detail::speed_per_impulse(response.jump, loop.system());
    const auto defect = [&](double omega) {
      const double rate = detail::rate_before_impact(response, pi / omega);
      return (rate + detail::ForcedOrbits::impulse_share(omega) * omega * answer_of(loop, omega).imag()) / exchange + 1;
    };
    return detail::roots_on_grid(defect, defect, grid_of(loop, range));
  }
  const auto off_line = [&](double omega) { return rigid_loop(loop, omega).imag() - pi / 4 * loss_ratio(loop); };
  if (loop.measured() == Output::x1 && loop.controller().delay() == 0 && !detail::controller_powers(loop).empty()) {
    frequencies = detail::positive_roots(detail::frequency_equation(loop, detail::CountedHarmonics::first));
    if (range) std::erase_if(frequencies, [&](double omega) { return omega < range->from || omega > range->to; });
  } else {
    frequencies = roots_of(loop, off_line, grid_of(loop, range));
  }
  std::erase_if(frequencies, [&](double omega) { return !(std::abs(off_line(omega)) < 1e-6); });
  return frequencies;
}

// Asymmetric cycles of free masses, by the curve on which -1/nu of the asymmetric orbits lies.
std::vector<PredictedCycle> asymmetric_of_masses(const ControlLoop& loop, const std::optional<FrequencyRange>& range) {
  // The curve begins at real part 1/2; the grid gets the frequencies at which the loop passes that, so that what lies
  // left of it hides no root.
  std::vector<double> grid = grid_of(loop, range);
  const auto beyond = [&](double omega) { return rigid_loop(loop, omega).real() - 0.5; };
  const std::vector<double> ends = detail::roots_on_grid(beyond, beyond, grid);
  grid.insert(grid.end(), ends.begin(), ends.end());
  std::sort(grid.begin(), grid.end());
  const auto defect = [&](double omega) {
    const Complex at = rigid_loop(loop, omega);
    const double cosine = at.real() > 0.5 ? std::cos(angle_of(at.real())) : 1;
    return at.imag() - pi / 2 * loss_ratio(loop) / (1 + cosine);
  };
  const Predictions predictions(loop);
  std::vector<PredictedCycle> cycles;
  for (const double omega : roots_of(loop, defect, grid)) {
    const Complex at = rigid_loop(loop, omega);
    if (!(at.real() > 0.5 + 1e-9) || !(std::abs(defect(omega)) < 1e-6 * (1 + std::abs(at)))) continue;
    const double share = 0.5 - angle_of(at.real()) / (2 * pi);
    if (const auto cycle = predictions.balanced(omega, share)) cycles.push_back(*cycle);
  }
  return cycles;
}

// Of any bodies: for a frequency and a share of the period the impulses and the middle that meet the walls are those of
// a linear system, and what the two speeds then lack changes its sign about a cycle.
class ShareGrid {
 public:
  ShareGrid(const ControlLoop& loop, const std::vector<double>& omega)
      : loop_(loop), predictions_(loop), response_(detail::gap_response(loop.bodies())), omega_(omega) {}

  [[nodiscard]] std::vector<PredictedCycle> cycles() const {
    std::vector<PredictedCycle> found;
    std::vector<Corner> before = row(omega_.front());
    for (std::size_t i = 1; i < omega_.size(); ++i) {
      std::vector<Corner> after = row(omega_[i]);
      for (std::size_t k = 1; k < after.size(); ++k) {
        const std::array<const Corner*, 4> cell{&before[k - 1], &before[k], &after[k - 1], &after[k]};
        if (!changes_sign(cell, &Corner::even) || !changes_sign(cell, &Corner::odd)) continue;
        add(found, std::sqrt(omega_[i - 1] * omega_[i]), omega_[i] / omega_[i - 1], k);
      }
      before = std::move(after);
    }
    return found;
  }

 private:
  static constexpr int shares = 16;
  struct Corner {
    double even, odd;  // what the speeds lack, over that of the impulses; the second over the distance of symmetry
    double impulse1, impulse2;
  };
  [[nodiscard]] static double share(std::size_t k) { return 0.5 * (static_cast<double>(k) + 0.5) / shares; }
  [[nodiscard]] static bool changes_sign(const std::array<const Corner*, 4>& cell, double Corner::*part) {
    const auto is_above = [&](const Corner* corner) { return corner->*part > 0; };
    if (!std::all_of(cell.begin(), cell.end(), [&](const Corner* c) { return std::isfinite(c->*part); })) return false;
    return std::any_of(cell.begin(), cell.end(), is_above) && !std::all_of(cell.begin(), cell.end(), is_above);
  }

  [[nodiscard]] std::vector<Corner> row(double omega) const { return corners(omega, 0, shares); }
  // Those of the shares from first to last - 1.
  [[nodiscard]] std::vector<Corner> corners(double omega, std::size_t first_share, std::size_t last_share) const {
    const double period = 2 * pi / omega;
    const detail::AnsweredTrain train(response_, period, predictions_.answer());
    const std::optional<double> settled = detail::static_gap(loop_, omega);
    const std::array<double, 3> own = train.repeated(period);
    const double half = 0.5 * loop_.system().clearance();
    const double exchange = detail::speed_per_impulse(response_.jump, loop_.system());
    std::vector<Corner> corners;
    for (std::size_t k = first_share; k < last_share; ++k) {
      const std::array<double, 3> later = train.repeated(share(k) * period);
      const std::array<double, 3> earlier = train.repeated((1 - share(k)) * period);
      std::vector<double> matrix{-own[0], -earlier[0], 1, -later[0], -own[0], 1};
      const double drift = settled ? *settled / period : 1;
      matrix.insert(matrix.end(), {drift, drift, settled ? 1.0 : 0.0});
      std::vector<double> solved{half, -half, 0};
      if (detail::eliminate(matrix, solved) == 0) solved = {NAN, NAN, NAN};
      const double size = exchange * (std::abs(solved[0]) + std::abs(solved[1]));
      const double first = -(own[1] * solved[0] + earlier[1] * solved[1]) - exchange * solved[0];
      const double second = -(later[1] * solved[0] + own[1] * solved[1]) - exchange * solved[1];
      corners.push_back({(first - second) / size, (first + second) / size / (0.5 - share(k)), solved[0], solved[1]});
    }
    return corners;
  }

  // From the middle of a cell, between the shares k - 1 and k.
  void add(std::vector<PredictedCycle>& found, double omega, double ratio, std::size_t k) const {
    const double period = 2 * pi / omega;
    const double at = 0.5 * (share(k - 1) + share(k));
    const Corner start = corners(omega, k - 1, k).front();
    if (!(start.impulse1 > 0 && start.impulse2 < 0)) return;
    const CycleGuess guess{period, {{0, start.impulse1, 0}, {at * period, start.impulse2, 0}}};
    const CycleEquations equations(loop_, guess, predictions_.answer());
    const auto solution = equations.solve(guess);
    if (!solution) return;
    const ClosedMotion& motion = solution->motion;
    const double reached = 2 * pi / motion.period;
    if (std::abs(std::log(reached / omega)) > std::log(ratio) || std::abs(motion.shares[1] - 0.5) < 1e-6) return;
    if (reached < omega_.front() || reached > omega_.back()) return;
    for (const PredictedCycle& known : found) {
      if (std::abs(known.omega / reached - 1) < 1e-9) return;
    }
    found.push_back(predictions_.cycle(equations, motion, false));
  }

  const ControlLoop& loop_;
  Predictions predictions_;
  detail::ImpulseAnswer response_;
  const std::vector<double>& omega_;
};

std::vector<PredictedCycle> asymmetric_of_bodies(const ControlLoop& loop, const std::optional<FrequencyRange>& range) {
  std::vector<double> coarse;
  const std::vector<double> fine = grid_of(loop, range);
  for (std::size_t i = 0; i < fine.size(); i += 3) coarse.push_back(fine[i]);
  if (coarse.back() != fine.back()) coarse.push_back(fine.back());
  return ShareGrid(loop, coarse).cycles();
}

// Crossings of the loop with the line through the values of -1/nu along a branch, refined by Newton's method.
class BranchCrossings {
 public:
  BranchCrossings(const ControlLoop& loop, const OrbitDiagram& diagram, const std::vector<double>& omega)
      : loop_(loop), predictions_(loop), diagram_(diagram), omega_(omega) {
    for (const double each : omega) line_.push_back(rigid_loop(loop, each));
  }

  void add_of(const OrbitBranch& branch, std::vector<PredictedCycle>& found) const {
    for (std::size_t i = 1; i < branch.orbits.size(); ++i) {
      const Complex from = place(branch.orbits[i - 1]);
      const Complex to = place(branch.orbits[i]);
      for (std::size_t k = 1; k < line_.size(); ++k) {
        if (!cross(from, to, line_[k - 1], line_[k])) continue;
        const auto cycle = cycle_near(branch, branch.orbits[i], std::sqrt(omega_[k - 1] * omega_[k]));
        if (!cycle || std::any_of(found.begin(), found.end(), [&](const PredictedCycle& known) {
              return known.impacts == cycle->impacts && std::abs(known.omega / cycle->omega - 1) < 1e-9;
            })) {
          continue;
        }
        found.push_back(*cycle);
      }
    }
  }

 private:
  // -1/nu
  [[nodiscard]] Complex place(const PeriodicOrbit& orbit) const {
    const double mass1 = diagram_.system.mass1(), mass2 = diagram_.system.mass2();
    const Complex read = orbit.value * (mass1 + mass2) * orbit.omega * orbit.omega;
    return diagram_.options.output == Output::x1 ? -1.0 / read : 1.0 / (1.0 + mass2 / mass1 * (read + 1.0));
  }
  [[nodiscard]] static bool cross(Complex a, Complex b, Complex c, Complex d) {
    const auto side = [](Complex from, Complex to, Complex point) {
      return (std::conj(to - from) * (point - from)).imag() > 0;
    };
    return side(a, b, c) != side(a, b, d) && side(c, d, a) != side(c, d, b);
  }
  [[nodiscard]] std::optional<PredictedCycle> cycle_near(const OrbitBranch& branch, const PeriodicOrbit& orbit,
                                                         double omega) const {
    const double clearance =
        diagram_.parameter == OrbitParameter::clearance ? orbit.parameter : diagram_.system.clearance();
    const double period = 2 * pi * branch.period / omega;
    const TwoMassSystem& system = loop_.system();
    const double scale = detail::impulse_per_speed(system) * system.clearance() * omega / (clearance * orbit.omega);
    CycleGuess guess{period, {}};
    for (const OrbitImpact& impact : orbit.impacts) {
      const double sign = impact.wall == Wall::far ? 1 : -1;
      guess.impacts.push_back({(impact.phase - orbit.impacts.front().phase) / omega, sign * scale * impact.speed, 0});
    }
    const CycleEquations equations(loop_, guess, predictions_.answer(branch.period));
    const auto solution = equations.solve(guess);
    if (!solution || !(std::abs(std::log(solution->motion.period / period)) < 0.05)) return std::nullopt;
    return predictions_.cycle(equations, solution->motion, branch.symmetric, branch.period);
  }

  const ControlLoop& loop_;
  Predictions predictions_;
  const OrbitDiagram& diagram_;
  const std::vector<double>& omega_;
  std::vector<Complex> line_;
};

void sort_by_omega(std::vector<PredictedCycle>& cycles) {
  std::stable_sort(cycles.begin(), cycles.end(),
                   [](const PredictedCycle& a, const PredictedCycle& b) { return a.omega < b.omega; });
}

void require_free(const ControlLoop& loop) {
  if (loop.bodies().are_free()) return;
  throw std::invalid_argument("the orbits of a diagram are those of free masses, and the loop has other bodies");
}

}  // namespace

std::vector<PredictedCycle> predicted_limit_cycles(const ControlLoop& loop,
                                                   const std::optional<FrequencyRange>& range) {
  detail::require_range(range);
  const Predictions predictions(loop);
  std::vector<PredictedCycle> cycles;
  for (const double omega : symmetric_frequencies(loop, range)) {
    if (const auto cycle = predictions.balanced(omega, 0.5)) cycles.push_back(*cycle);
  }
  const std::vector<PredictedCycle> asymmetric =
      loop.bodies().are_free() ? asymmetric_of_masses(loop, range) : asymmetric_of_bodies(loop, range);
  cycles.insert(cycles.end(), asymmetric.begin(), asymmetric.end());
  sort_by_omega(cycles);
  return cycles;
}

std::vector<PredictedCycle> predicted_limit_cycles(const ControlLoop& loop, const OrbitDiagram& orbits,
                                                   const std::optional<FrequencyRange>& range) {
  detail::require_range(range);
  require_free(loop);
  if (orbits.parameter == OrbitParameter::restitution || orbits.system.restitution() != loop.system().restitution()) {
    throw std::invalid_argument("the diagram has other restitutions than the loop, " +
                                detail::text(loop.system().restitution()));
  }
  const std::vector<double> omega = grid_of(loop, range);
  const BranchCrossings crossings(loop, orbits, omega);
  std::vector<PredictedCycle> cycles;
  for (const OrbitBranch& branch : orbits.branches) {
    if (branch.period != 1 || branch.impacts != 2) crossings.add_of(branch, cycles);
  }
  sort_by_omega(cycles);
  return cycles;
}

std::vector<PredictedCycle> predicted_cycles_of_more_impacts(const ControlLoop& loop,
                                                             const std::optional<FrequencyRange>& range) {
  require_free(loop);
  // Of force over M2 clearance omega^2, at a force that makes omega^-2 of it.
  constexpr double lowest_ratio = 0.1, highest_ratio = 3;
  const TwoMassSystem& system = loop.system();
  const double force = system.mass2() * system.clearance();
  return predicted_limit_cycles(
      loop, orbit_diagram(system, force, 1 / std::sqrt(highest_ratio), 1 / std::sqrt(lowest_ratio)), range);
}

}  // namespace backlash
