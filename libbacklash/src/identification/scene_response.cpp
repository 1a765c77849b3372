// SPDX-License-Identifier: BSD-3-Clause
#include "scene_response.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/impact_law.hpp"
#include "steady_state/steady_state.hpp"
#include "steady_state/two_impact_orbit.hpp"

namespace backlash::detail {
namespace {

using Complex = std::complex<double>;
constexpr double pi = std::numbers::pi;
constexpr Complex j(0, 1);

// Orbits are closed to this; with the step below the derivatives keep about five digits, as many as least squares can
// use where residuals are noise.
constexpr double tolerance = 1e-12;
constexpr double difference_step = 1e-5;

struct ByLoss {
  Complex h, by_log_gamma, by_loss;
};

// The contacts of two impacts per period, as far apart as may be, are velocity jumps J and -J, of which the harmonics
// are -J e^{-jk tau}(1 - e^{-jk phi})/(pi k^2 gamma): of odd k, half a period apart, the fundamental's size over k^2 at
// k times its angle.
ByLoss harmonic_of(const ByLoss& fundamental, int k) {
  if (k == 1) return fundamental;
  const Complex h = std::polar(std::abs(fundamental.h) / (k * k), k * std::arg(fundamental.h));
  const auto by = [&](Complex change) {
    const Complex relative = change / fundamental.h;
    return h * Complex(relative.real(), k * relative.imag());
  };
  return {h, by(fundamental.by_log_gamma), by(fundamental.by_loss)};
}

// kappa = (1 - e)/(1 + e) takes the place of restitution, P = (1 + e) v/2 that of the impact speed v:
//   kappa^2 P^2 + (1 - pi P)^2/4 = gamma^2 (larger root),   h = -(4 P/(pi gamma^2)) [(1 - pi P)/2 + j kappa P].
std::optional<ByLoss> symmetric_response(double gamma, double kappa) {
  const double a = kappa * kappa + 0.25 * pi * pi;
  const double node = 0.5 * kappa / std::sqrt(a);
  const double square = a * (gamma - node) * (gamma + node);
  if (!(square > 0)) return std::nullopt;
  const double root = std::sqrt(square);
  const double p = (0.25 * pi + root) / a;
  const double p_by_log_gamma = gamma * gamma / root;
  const double p_by_kappa = -kappa * p * p / root;
  const double scale = -4 / (pi * gamma * gamma);
  const Complex h = scale * Complex(0.5 * p * (1 - pi * p), kappa * p * p);
  const Complex h_by_p = scale * Complex(0.5 - pi * p, 2 * kappa * p);
  return ByLoss{h, -2.0 * h + h_by_p * p_by_log_gamma, scale * j * p * p + h_by_p * p_by_kappa};
}

// One member of the asymmetric family, flights of pi -+ 2x, with derivatives:
//   h = 2 S cos x/(1 + j t),   gamma = sqrt(1 + t^2)/|D|,   S = sin x/x,   t = kappa (pi/2) S/cos x,
//   D = 2 cos x - (pi^2 - 4 x^2) S/2.
struct AsymmetricMember {
  double x, kappa;
  double s, s_by_x, cos_x, t, d;

  AsymmetricMember(double asymmetry, double loss) : x(asymmetry), kappa(loss) {
    s = x == 0 ? 1 : std::sin(x) / x;
    // S' = (cos x - S)/x cancels at small x; the first term left out of the series is x^7/45360.
    s_by_x = x < 0.05 ? x * (-1.0 / 3 + x * x * (1.0 / 30 - x * x / 840)) : (std::cos(x) - s) / x;
    cos_x = std::cos(x);
    t = kappa * 0.5 * pi * s / cos_x;
    d = 2 * cos_x - 0.5 * (pi * pi - 4 * x * x) * s;
  }
  [[nodiscard]] double gamma() const { return std::hypot(1, t) / std::abs(d); }
  [[nodiscard]] double t_by_x() const { return kappa * 0.5 * pi * (s_by_x + s * std::sin(x) / cos_x) / cos_x; }
  [[nodiscard]] double log_gamma_by_x() const {
    const double d_by_x = 2 * std::sin(x) - 0.5 * (pi * pi - 4 * x * x) * s_by_x;
    return -d_by_x / d + t * t_by_x() / (1 + t * t);
  }
  [[nodiscard]] ByLoss response(int k) const {
    const Complex turn = 1.0 / (1.0 + j * t);
    const Complex h = 2 * s * cos_x * turn;
    const Complex h_by_x = 2 * (s_by_x * cos_x - s * std::sin(x)) * turn - h * turn * j * t_by_x();
    const double t_by_kappa = 0.5 * pi * s / cos_x;
    const double log_gamma_by_kappa = t * t_by_kappa / (1 + t * t);
    const double x_by_log_gamma = 1 / log_gamma_by_x();
    const double x_by_kappa = -x_by_log_gamma * log_gamma_by_kappa;
    const ByLoss fundamental{h, h_by_x * x_by_log_gamma, -h * turn * j * t_by_kappa + h_by_x * x_by_kappa};
    if (k == 1) return fundamental;
    // Impacts pi - 2x apart: sin(k (pi - 2x)/2) in the place of sin((pi - 2x)/2), up to the sign of half a period.
    const ByLoss of_halves = harmonic_of(fundamental, k);
    const double ratio = std::cos(k * x) / cos_x;
    const double ratio_by_x = (ratio * std::sin(x) - k * std::sin(k * x)) / cos_x;
    return {of_halves.h * ratio, of_halves.by_log_gamma * ratio + of_halves.h * ratio_by_x * x_by_log_gamma,
            of_halves.by_loss * ratio + of_halves.h * ratio_by_x * x_by_kappa};
  }
};

// gamma rises from the pitchfork at x = 0; beyond largest_asymmetry no member is near to being stable.
constexpr double largest_asymmetry = 1.2;
// Nearer to the pitchfork both dh/dx and dgamma/dx are lost in rounding, while their ratio has a limit.
constexpr double least_asymmetry = 1e-5;

std::optional<ByLoss> asymmetric_response(double gamma, double kappa, int harmonic) {
  double lower = least_asymmetry, upper = largest_asymmetry;
  if (AsymmetricMember(upper, kappa).gamma() < gamma) return std::nullopt;
  double x = 0.3;
  for (int i = 0; i < 100; ++i) {
    const AsymmetricMember member(x, kappa);
    const double excess = std::log(member.gamma() / gamma);
    (excess < 0 ? lower : upper) = x;
    double next = x - excess / member.log_gamma_by_x();
    if (!(next > lower && next < upper)) next = 0.5 * (lower + upper);
    if (std::abs(next - x) <= 1e-15) break;
    x = next;
  }
  return AsymmetricMember(x, kappa).response(harmonic);
}

}  // namespace

std::optional<GapResponse> two_impact_response(double gamma, double restitution, int harmonic) {
  const double kappa = loss_ratio(restitution);
  const double kappa_by_restitution = -2 / ((1 + restitution) * (1 + restitution));
  const bool is_symmetric = gamma <= symmetry_breaking_gamma(restitution);
  auto response = is_symmetric ? symmetric_response(gamma, kappa) : asymmetric_response(gamma, kappa, harmonic);
  if (response && is_symmetric) response = harmonic_of(*response, harmonic);
  if (!response) return std::nullopt;
  return GapResponse{response->h, response->by_log_gamma, response->by_loss * kappa_by_restitution, 0};
}

std::optional<std::array<Complex, 3>> sticking_harmonics(double gamma, double restitution) {
  // A motion that wanders for long enough to tell about its mean does not stick every period.
  const MeanGoal rough{1, -gamma, Transients::ignored};
  const SteadyState steady =
      find_steady_state(GapMotion(gamma, restitution), contact_at_rest_state(), tolerance, rough);
  // Its multiplier is exactly 0.
  if (steady.spectral_radius != 0) return std::nullopt;
  static_assert(harmonic_orders[1] == 3 && harmonic_orders[2] == 5);
  const auto& u = steady.harmonics.u;
  return std::array{steady.harmonics.u1_plus_gamma / gamma, u[1] / gamma, u[2] / gamma};
}

std::optional<Complex> sticking_h(double gamma, double restitution, int harmonic) {
  const auto h = sticking_harmonics(gamma, restitution);
  return h ? std::optional<Complex>((*h)[static_cast<std::size_t>(harmonic / 2)]) : std::nullopt;
}

std::optional<GapResponse> sticking_response(double gamma, double restitution, int harmonic) {
  const double step = restitution + difference_step <= 1 ? difference_step : -difference_step;
  const auto here = sticking_h(gamma, restitution, harmonic);
  const auto stronger = sticking_h(gamma * std::exp(difference_step), restitution, harmonic);
  const auto beside = sticking_h(gamma, restitution + step, harmonic);
  if (!here || !stronger || !beside) return std::nullopt;
  return GapResponse{*here, (*stronger - *here) / difference_step, (*beside - *here) / step, 0};
}

std::vector<StartedMotion> motions_of_starts(double gamma, double restitution) {
  constexpr double mean_goal = 0.02;   // of h
  constexpr double same_orbit = 1e-6;  // of h, as starts that lead to one orbit agree
  std::vector<GapState> starts = {contact_at_rest_state()};
  for (const double position : {0.17, 0.5, 0.83}) {
    for (const double rate : {-0.75, -0.25, 0.25, 0.75}) starts.push_back(state_at_peak(position, rate));
  }
  std::vector<StartedMotion> motions;
  for (const GapState& start : starts) {
    const SteadyState steady =
        find_steady_state(GapMotion(gamma, restitution), start, tolerance, {mean_goal, -gamma, Transients::ignored});
    const StartedMotion found{steady.harmonics.u1_plus_gamma / gamma, steady.regime != Regime::averaged};
    const bool is_known = std::any_of(motions.begin(), motions.end(), [&](const StartedMotion& other) {
      const double allowed = found.closes ? same_orbit : mean_goal;
      return other.closes == found.closes && std::abs(other.h - found.h) <= allowed * std::abs(found.h);
    });
    if (!is_known) motions.push_back(found);
  }
  return motions;
}

GapState contact_at_rest_state() {
  return state_at_peak(0, 0);
}

}  // namespace backlash::detail
