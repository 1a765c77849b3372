// SPDX-License-Identifier: BSD-3-Clause
#include "contact_response.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

#include "backlash/compliant/compliant_bodies.hpp"
#include "backlash/compliant_contact.hpp"
#include "compliant/compliant_flow.hpp"
#include "compliant/compliant_run.hpp"
#include "steady_state/two_impact_orbit.hpp"

namespace backlash::detail {
namespace {

using Complex = std::complex<double>;

constexpr double least_restitution = 1e-6;
// Below these angles of contact N is interpolated between the hard contact and one of this angle: it is off by the
// square of the angle, and contacts so short lose digits, or bounce for long.
constexpr double least_symmetric_tau = 1e-5, least_followed_tau = 1e-3;
// Orbits are solved to rounding; derivatives keep four or five digits.
constexpr double contact_difference = 1e-5;

/// Both masses 2, so that the reduced mass is 1, at clearance 1 and omega 1.
constexpr double each_mass = 2;

CompliantBodies unit_bodies(const CompliantGroups& groups) {
  return {free_mass(each_mass), free_mass(each_mass), 1,
          CompliantContact(groups.nu * groups.nu, 2 * groups.zeta * groups.nu)};
}

// The orbit of one period that a motion comes to within some periods.
std::optional<CompliantOrbit> orbit_after(const CompliantFlow& flow, CompliantRun run) {
  constexpr std::array<int, 4> followed = {6, 6, 12, 24};
  constexpr double near = 0.05;  // over the sizes of the states, from where Newton's method is tried
  for (const int periods : followed) {
    for (int n = 0; n + 1 < periods; ++n)
      if (!run.follow(1)) return std::nullopt;
    const Eigen::VectorXd before = run.state();
    if (!run.follow(1)) return std::nullopt;
    double change = 0;
    for (const Eigen::Index i : flow.repeating())
      change = std::max(change, std::abs(run.state()[i] - before[i]) / flow.sizes()[i]);
    if (!(change < near)) continue;
    auto orbit = closed_orbit(flow, run.state(), run.mode(), 1);
    if (orbit && orbit->contacts > 0 && orbit->largest_multiplier < 1) return orbit;
  }
  return std::nullopt;
}

CompliantRun from_rest(const CompliantFlow& flow) {
  const Eigen::VectorXd start = flow.start({0.25, 0, -0.25, 0});
  return {flow, start, flow.mode_of(start)};
}

// Beside a symmetric orbit, at the next peak of the force; the centre of mass as the force leaves it.
CompliantRun beside(const CompliantFlow& flow, const SymmetricCompliantOrbit& orbit) {
  constexpr double faster = 1.02;
  const double rate = faster * orbit.speed;
  const double centre = flow.force() / (2 * each_mass) * std::sin(orbit.angle);
  return at_next_peak(flow, {0, centre - rate / 2, 0.5, centre + rate / 2}, orbit.angle);
}

}  // namespace

ContactShape contact_shape(double restitution) {
  const double ratio = damping_ratio_of_restitution(std::max(restitution, least_restitution));
  return {ratio, free_contact(CompliantContact(1, 2 * ratio), each_mass, each_mass).duration};
}

ContactMotions::ContactMotions(double restitution)
    : restitution_(std::max(restitution, least_restitution)), shape_(contact_shape(restitution)) {}

CompliantGroups ContactMotions::groups(double gamma, double tau) const {
  return {gamma, shape_.angle / tau, shape_.damping_ratio};
}

// From contacts so stiff that they are nearly hard, softer by halves.
std::optional<SymmetricCompliantOrbit> ContactMotions::at_hard_gamma(const CompliantGroups& of) const {
  constexpr double stiff = 128;
  const SymmetricImpact impact = SymmetricFamily(restitution_).at(of.gamma);
  int halvings = 0;
  while (std::ldexp(of.nu, halvings) < stiff) ++halvings;
  CompliantGroups at = of;
  at.nu = std::ldexp(of.nu, halvings);
  // The hard orbit's phase is that of the other wall.
  const double phase = std::atan2(impact.sin_phase, impact.cos_phase) + std::numbers::pi;
  auto orbit = symmetric_compliant_orbit(at, phase, impact.speed, shape_.angle / at.nu);
  double angle = phase;
  for (; orbit && halvings > 0; --halvings) {
    at.nu /= 2;
    // In first order of 1/nu.
    const double shift = orbit->angle - angle;
    angle = orbit->angle;
    orbit = symmetric_compliant_orbit(at, angle + shift, orbit->speed, 2 * orbit->duration);
  }
  return orbit;
}

// Where hard contacts have no such orbit, from a stronger force on.
std::optional<SymmetricCompliantOrbit> ContactMotions::from_hard(const CompliantGroups& of) const {
  constexpr double above_saddle_node = 1.2, largest_ratio = 0.9;
  const double first = above_saddle_node * SymmetricFamily(restitution_).saddle_node();
  if (of.gamma >= first) return at_hard_gamma(of);
  CompliantGroups at = of;
  at.gamma = first;
  auto orbit = at_hard_gamma(at);
  while (orbit && at.gamma > of.gamma) {
    at.gamma = std::max(of.gamma, at.gamma * largest_ratio);
    orbit = symmetric_compliant_orbit(at, orbit->angle, orbit->speed, orbit->duration);
  }
  return orbit;
}

std::optional<ContactMotions::Symmetric> ContactMotions::symmetric(double gamma, double tau, int harmonic,
                                                                   FoundMotions& found) const {
  const CompliantGroups at = groups(gamma, tau);
  std::optional<SymmetricCompliantOrbit> orbit;
  if (found.symmetric)
    orbit = symmetric_compliant_orbit(at, found.symmetric->angle, found.symmetric->speed, found.symmetric->duration);
  // The orbit that hard contacts tend to, where what was found last has become another one.
  if (!orbit || orbit->largest_multiplier >= 1) {
    const auto other = from_hard(at);
    if (other && (!orbit || other->largest_multiplier < orbit->largest_multiplier)) orbit = other;
  }
  if (!orbit) return std::nullopt;
  found.symmetric = orbit;
  // -k^2 U_k is the phasor of what the contacts press.
  const Complex contact = orbit->contact[static_cast<std::size_t>(harmonic / 2)];
  return Symmetric{contact / (gamma * harmonic * harmonic), orbit->largest_multiplier};
}

std::optional<Complex> ContactMotions::followed(double gamma, double tau, int harmonic, FoundMotions& found,
                                                bool from_start) const {
  constexpr double exact = 1e-9;  // of fractional powers, of which there are none
  const SineForce force{each_mass * gamma, 1};
  const CompliantGroups at = groups(gamma, tau);
  const CompliantFlow flow(unit_bodies(at), force, Output::x1, exact, harmonic);
  std::optional<CompliantOrbit> orbit;
  if (found.followed) {
    orbit = closed_orbit(flow, found.followed->state, found.followed->mode, 1);
    if (orbit && !(orbit->contacts > 0 && orbit->largest_multiplier < 1)) orbit.reset();
  }
  if (from_start) {
    // Where the symmetric orbit has just lost its stability an asymmetric one is beside it.
    constexpr double just_lost = 2;
    const auto& symmetric = found.symmetric;
    if (!orbit && symmetric && symmetric->largest_multiplier >= 1 && symmetric->largest_multiplier < just_lost)
      orbit = orbit_after(flow, beside(flow, *symmetric));
    if (!orbit) orbit = orbit_after(flow, from_rest(flow));
  }
  if (!orbit) return std::nullopt;
  CompliantRun run(flow, orbit->state, orbit->mode);
  run.follow(1);
  found.followed = std::move(orbit);
  const Complex n = run.phasors().back() / Complex(0, harmonic * force.omega) / force.amplitude;
  return -2 * each_mass * n;
}

namespace {

std::optional<Complex> hard_h(double gamma, double restitution, bool is_followed, Complex near, int harmonic) {
  std::optional<Complex> nearest;
  const auto offer = [&](Complex h) {
    if (!nearest || std::abs(h - near) < std::abs(*nearest - near)) nearest = h;
  };
  if (const auto response = two_impact_response(gamma, restitution, harmonic)) offer(response->h);
  if (is_followed)
    if (const auto h = sticking_h(gamma, restitution, harmonic)) offer(*h);
  return nearest;
}

std::optional<Complex> h_of_contact(const ContactMotions& motions, double gamma, double tau, bool is_followed,
                                    FoundMotions& found, bool from_start, int harmonic) {
  if (is_followed) return motions.followed(gamma, tau, harmonic, found, from_start);
  const auto orbit = motions.symmetric(gamma, tau, harmonic, found);
  return orbit ? std::optional<Complex>(orbit->h) : std::nullopt;
}

}  // namespace

std::optional<Complex> contact_h(const ContactMotions& motions, double gamma, double tau, bool is_followed,
                                 FoundMotions& found, bool from_start, int harmonic) {
  const double least = is_followed ? least_followed_tau : least_symmetric_tau;
  const auto h = h_of_contact(motions, gamma, std::max(tau, least), is_followed, found, from_start, harmonic);
  if (!h || tau >= least) return h;
  const auto hard = hard_h(gamma, motions.restitution(), is_followed, *h, harmonic);
  // N changes by about the angle between a motion and the one that it tends to, a harmonic by as many times that.
  const double same_motion_within = 10 * harmonic;
  const bool is_its_limit = hard && (!is_followed || std::abs(*hard - *h) <= same_motion_within * least * std::abs(*h));
  if (is_its_limit) return *hard + tau / least * (*h - *hard);
  if (!is_followed) return std::nullopt;
  // Hard contacts have more orbits than those in closed form and those that stick.
  FoundMotions further = found;
  const auto second = h_of_contact(motions, gamma, 2 * least, is_followed, further, false, harmonic);
  const auto third = h_of_contact(motions, gamma, 3 * least, is_followed, further, false, harmonic);
  if (!second || !third) return std::nullopt;
  // The parabola through these, off by the cube of the angle.
  const double x = tau / least;
  return 0.5 * (x - 2) * (x - 3) * *h - (x - 1) * (x - 3) * *second + 0.5 * (x - 1) * (x - 2) * *third;
}

ContactResponses::ContactResponses(double restitution)
    : here_(restitution),
      beside_(restitution + contact_difference <= 1 ? restitution + contact_difference
                                                    : restitution - contact_difference) {}

std::optional<GapResponse> ContactResponses::at(double gamma, double tau, bool is_followed, FoundMotions found,
                                                int harmonic) const {
  const auto here = contact_h(here_, gamma, tau, is_followed, found, true, harmonic);
  if (!here) return std::nullopt;
  const double by = std::max(tau * contact_difference, is_followed ? least_followed_tau : least_symmetric_tau);
  const auto moved = [&](const ContactMotions& motions, double log_change, double longer) {
    FoundMotions neighbour = found;
    return contact_h(motions, gamma * std::exp(log_change), tau + longer, is_followed, neighbour, false, harmonic);
  };
  const auto stronger = moved(here_, contact_difference, 0), beside = moved(beside_, 0, 0),
             longer = moved(here_, 0, by);
  if (!stronger || !beside || !longer) return std::nullopt;
  return GapResponse{*here, (*stronger - *here) / contact_difference,
                     (*beside - *here) / (beside_.restitution() - here_.restitution()), (*longer - *here) / by};
}

}  // namespace backlash::detail
