// SPDX-License-Identifier: BSD-3-Clause
#include "backlash/loops/predicted_cycles.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

#include "cycle_frequencies.hpp"
#include "frequency_search.hpp"

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
bool is_stable_by_loeb(const Balance& balance, const Orbit& orbit, double force, double omega) {
  constexpr double step = 1e-5;
  const Complex by_force =
      balance.defect(orbit, force * (1 + step), omega) - balance.defect(orbit, force * (1 - step), omega);
  const Complex by_omega =
      balance.defect(orbit, force, omega * (1 + step)) - balance.defect(orbit, force, omega * (1 - step));
  return by_force.real() * by_omega.imag() - by_force.imag() * by_omega.real() > 0;
}

}  // namespace

std::vector<PredictedCycle> predicted_limit_cycles(const ControlLoop& loop,
                                                   const std::optional<FrequencyRange>& range) {
  detail::require_range(range);
  const Balance balance(loop);
  const double restitution = loop.system().restitution();
  std::vector<double> frequencies;
  if (loop.measured() == Output::x1 && loop.controller().delay() == 0 && !detail::controller_powers(loop).empty()) {
    frequencies = detail::positive_roots(detail::frequency_equation(loop, detail::Harmonics::first));
    if (range) std::erase_if(frequencies, [&](double omega) { return omega < range->from || omega > range->to; });
  } else {
    frequencies =
        detail::roots_on_grid([&](double omega) { return balance.off_line(omega); },
                              detail::search_grid(detail::search_range(loop, range), loop.controller().delay()));
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
