// SPDX-License-Identifier: BSD-3-Clause
#include "backlash/loops/predicted_cycles.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

#include "cycle_frequencies.hpp"
#include "forced_orbits.hpp"
#include "frequency_search.hpp"
#include "gap_response.hpp"

namespace backlash {
namespace {

using Complex = std::complex<double>;
constexpr double pi = std::numbers::pi;

// Symmetric orbits in closed form.  With pre-impact speed v over clearance and omega,
//   Z = 1 - pi v (1 + eps)/2 + j v (1 - eps),   2 gamma = |Z|,   nu = N1 (M1 + M2) w^2 = (4 (1 + eps) v/pi)/conj(Z).
struct Orbit {
  double speed;
  double restitution;

  [[nodiscard]] Complex z() const { return {1 - pi * speed * (1 + restitution) / 2, speed * (1 - restitution)}; }
  [[nodiscard]] double gamma() const { return std::abs(z()) / 2; }
  [[nodiscard]] Complex nu() const { return 4 * (1 + restitution) * speed / pi / std::conj(z()); }
  // Half the slope of 4 gamma^2: positive on the branch of the faster orbits.
  [[nodiscard]] double slope() const {
    return -pi * (1 + restitution) / 2 * z().real() + speed * (1 - restitution) * (1 - restitution);
  }
  // The orbit of another gamma on the same branch.
  [[nodiscard]] Orbit at(double other_gamma) const {
    const double a = std::norm(Complex(pi * (1 + restitution) / 2, 1 - restitution));
    const double b = pi * (1 + restitution) / 2;
    const double root = std::sqrt(std::max(0.0, b * b - a * (1 - 4 * other_gamma * other_gamma)));
    return {(b + (slope() > 0 ? root : -root)) / a, restitution};
  }
};

class Balance {
 public:
  explicit Balance(const ControlLoop& loop)
      : loop_(loop),
        total_(loop.system().mass1() + loop.system().mass2()),
        share_(loop.system().mass1() / loop.system().mass2()) {}

  // nu of x1 that makes 1 + C N = 0; of x2 nu2 = -1 - (M1/M2) (1 + nu).
  [[nodiscard]] Complex wanted_nu(double omega) const {
    const Complex wanted = -total_ * omega * omega / loop_.controller().response(omega);
    return loop_.measured() == Output::x1 ? wanted : -1.0 - (wanted + 1.0) / share_;
  }
  // Distance from the line on which -1/nu of every symmetric orbit lies.
  [[nodiscard]] double off_line(double omega) const {
    const double restitution = loop_.system().restitution();
    return (-1.0 / wanted_nu(omega)).imag() - pi * (1 - restitution) / (4 * (1 + restitution));
  }
  [[nodiscard]] Complex describing_function(const Orbit& orbit, double omega) const {
    const Complex nu = orbit.nu();
    const Complex read = loop_.measured() == Output::x1 ? nu : -1.0 - share_ * (1.0 + nu);
    return read / (total_ * omega * omega);
  }
  // 1 + C N at another force and frequency.
  [[nodiscard]] Complex defect(const Orbit& orbit, double force, double omega) const {
    const TwoMassSystem& system = loop_.system();
    const Orbit other = orbit.at(force / (system.mass2() * system.clearance() * omega * omega));
    return 1.0 + loop_.controller().response(omega) * describing_function(other, omega);
  }
  // Third over first harmonic of the force.  x1 answers to the impulses alone, as 1/k^2; x2 by -M1/M2 of it from the
  // third on.
  [[nodiscard]] double third_harmonic(const Orbit& orbit, double omega) const {
    const double gains = std::abs(loop_.controller().response(3 * omega) / loop_.controller().response(omega));
    if (loop_.measured() == Output::x1) return gains / 9;
    const Complex first = describing_function(orbit, omega) * total_ * omega * omega;
    return gains * share_ * std::abs(orbit.nu() / first) / 9;
  }

 private:
  const ControlLoop& loop_;
  double total_;
  double share_;
};

// U_F V_w - V_F U_w > 0 with U + j V = 1 + C N (Loeb).
bool is_stable_by_loeb(Complex by_force, Complex by_omega) {
  return by_force.real() * by_omega.imag() - by_force.imag() * by_omega.real() > 0;
}
bool is_stable_by_loeb(const Balance& balance, const Orbit& orbit, double force, double omega) {
  constexpr double step = 1e-5;
  const Complex by_force =
      balance.defect(orbit, force * (1 + step), omega) - balance.defect(orbit, force * (1 - step), omega);
  const Complex by_omega =
      balance.defect(orbit, force, omega * (1 + step)) - balance.defect(orbit, force, omega * (1 - step));
  return is_stable_by_loeb(by_force, by_omega);
}

// Bodies of any receptance.
class BodiesBalance {
 public:
  explicit BodiesBalance(const ControlLoop& loop) : loop_(loop), response_(detail::gap_response(loop.bodies())) {}

  /// F G2 over the fundamental of the impulses, as the controller answers to the fundamental.
  [[nodiscard]] Complex answer(double omega) const {
    const Complex controller = loop_.controller().response(omega);
    const Complex load = loop_.bodies().load().response(omega);
    const Complex drive = loop_.bodies().drive().response(omega);
    return loop_.measured() == Output::x1 ? -controller * load * drive
                                          : controller * drive * drive / (1.0 + controller * drive);
  }
  /// 0 where the masses meet at the speed that the impacts ask for.
  [[nodiscard]] double rate_defect(double omega) const {
    const double exchange = response_.jump / (1 + loop_.system().restitution());
    const double rate = detail::rate_before_impact(response_, pi / omega);
    return (rate + detail::ForcedOrbits::impulse_share(omega) * omega * answer(omega).imag()) / exchange + 1;
  }
  [[nodiscard]] std::optional<PredictedCycle> cycle_at(double omega) const {
    const detail::ForcedOrbits orbits(loop_.bodies(), response_, omega);
    const Complex share = answer(omega);
    const std::optional<detail::ForcedOrbits::Orbit> orbit = orbits.answered_by(share);
    if (!orbit) return std::nullopt;
    const double force = std::abs(orbit->force);
    const bool is_faster = orbits.is_faster(orbit->impulse);
    const Complex by_force =
        defect(orbits, force * (1 + step), omega, is_faster) - defect(orbits, force * (1 - step), omega, is_faster);
    const auto at = [&](double other) {
      return defect(detail::ForcedOrbits(loop_.bodies(), response_, other), force, other, is_faster);
    };
    const Complex by_omega = at(omega * (1 + step)) - at(omega * (1 - step));
    return PredictedCycle{omega, force, is_faster, is_stable_by_loeb(by_force, by_omega),
                          third_harmonic(*orbit, omega)};
  }

 private:
  static constexpr double step = 1e-5;

  // 1 + C N
  [[nodiscard]] Complex defect(const detail::ForcedOrbits& orbits, double force, double omega, bool is_faster) const {
    const detail::ForcedOrbits::Orbit orbit = orbits.at(force, is_faster);
    const Complex measured = loop_.measured() == Output::x1 ? orbit.x1 : orbit.x2;
    return 1.0 + loop_.controller().response(omega) * measured / orbit.force;
  }
  [[nodiscard]] double third_harmonic(const detail::ForcedOrbits::Orbit& orbit, double omega) const {
    const bool is_load = loop_.measured() == Output::x1;
    const frac::FractionalTransferFunction& body = is_load ? loop_.bodies().load() : loop_.bodies().drive();
    const double third =
        detail::ForcedOrbits::impulse_share(omega) * orbit.impulse * std::abs(body.response(3 * omega));
    return std::abs(loop_.controller().response(3 * omega)) * third / std::abs(orbit.force);
  }

  const ControlLoop& loop_;
  detail::GapResponse response_;
};

std::vector<PredictedCycle> predicted_for_bodies(const ControlLoop& loop, const std::optional<FrequencyRange>& range) {
  const BodiesBalance balance(loop);
  std::vector<PredictedCycle> cycles;
  const auto defect = [&](double omega) { return balance.rate_defect(omega); };
  for (const double omega : detail::roots_on_grid(
           defect, defect, detail::search_grid(detail::search_range(loop, range), loop.controller().delay()))) {
    if (!(std::abs(balance.rate_defect(omega)) < 1e-6)) continue;  // a pole
    if (const auto cycle = balance.cycle_at(omega)) cycles.push_back(*cycle);
  }
  return cycles;
}

}  // namespace

std::vector<PredictedCycle> predicted_limit_cycles(const ControlLoop& loop,
                                                   const std::optional<FrequencyRange>& range) {
  detail::require_range(range);
  if (!loop.bodies().are_free()) return predicted_for_bodies(loop, range);
  const Balance balance(loop);
  const double restitution = loop.system().restitution();
  std::vector<double> frequencies;
  if (loop.measured() == Output::x1 && loop.controller().delay() == 0 && !detail::controller_powers(loop).empty()) {
    frequencies = detail::positive_roots(detail::frequency_equation(loop, detail::Harmonics::first));
    if (range) std::erase_if(frequencies, [&](double omega) { return omega < range->from || omega > range->to; });
  } else {
    const auto distance = [&](double omega) { return balance.off_line(omega); };
    frequencies = detail::roots_on_grid(
        distance, distance, detail::search_grid(detail::search_range(loop, range), loop.controller().delay()));
  }
  std::vector<PredictedCycle> cycles;
  for (const double omega : frequencies) {
    // A pole of -1/nu changes its sign too.
    if (!(std::abs(balance.off_line(omega)) < 1e-6)) continue;
    // pi/(4 (1 + eps) v) = pi^2/8 - Re(-1/nu)
    const double inverse_speed = 4 * (1 + restitution) / pi * (pi * pi / 8 - (-1.0 / balance.wanted_nu(omega)).real());
    if (!(inverse_speed > 0)) continue;
    const Orbit orbit{1 / inverse_speed, restitution};
    const double force = orbit.gamma() * loop.system().mass2() * loop.system().clearance() * omega * omega;
    cycles.push_back({omega, force, orbit.slope() > 0, is_stable_by_loeb(balance, orbit, force, omega),
                      balance.third_harmonic(orbit, omega)});
  }
  return cycles;
}

}  // namespace backlash
