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

ContactMotions::ContactMotions(double restitution, int harmonics)
    : restitution_(std::max(restitution, least_restitution)),
      harmonics_(harmonics),
      shape_(contact_shape(restitution)) {}

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

MotionHarmonics ContactMotions::symmetric(double gamma, double tau, FoundMotions& found) const {
  const CompliantGroups at = groups(gamma, tau);
  std::optional<SymmetricCompliantOrbit> orbit;
  if (found.symmetric)
    orbit = symmetric_compliant_orbit(at, found.symmetric->angle, found.symmetric->speed, found.symmetric->duration);
  // The orbit that hard contacts tend to, where what was found last has become another one.
  if (!orbit || orbit->largest_multiplier >= 1) {
    const auto other = from_hard(at);
    if (other && (!orbit || other->largest_multiplier < orbit->largest_multiplier)) orbit = other;
  }
  MotionHarmonics h;
  if (!orbit) return h;
  found.symmetric = orbit;
  // -k^2 U_k is the phasor of what the contacts press.
  for (int k = 1; k <= harmonics_; k += 2) h[harmonic_place(k)] = orbit->contact[harmonic_place(k)] / (gamma * k * k);
  return h;
}

MotionHarmonics ContactMotions::followed(double gamma, double tau, FoundMotions& found, bool from_start) const {
  constexpr double exact = 1e-9;  // of fractional powers, of which there are none
  const SineForce force{each_mass * gamma, 1};
  const CompliantGroups at = groups(gamma, tau);
  const CompliantFlow flow(unit_bodies(at), force, Output::x1, exact, 1);
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
  MotionHarmonics h;
  if (!orbit) return h;
  const auto read = [&](const CompliantFlow& reading, const Eigen::VectorXd& state) {
    CompliantRun run(reading, state, orbit->mode);
    run.follow(1);
    for (int k = 1; k <= harmonics_; k += 2)
      h[harmonic_place(k)] = -2 * each_mass * run.phasors()[static_cast<std::size_t>(k - 1)] /
                             Complex(0, k * force.omega) / force.amplitude;
  };
  if (harmonics_ == 1) {
    read(flow, orbit->state);
  } else {
    // The orbit is solved for without the states of higher harmonics, which nothing depends on.
    const CompliantFlow reading(unit_bodies(at), force, Output::x1, exact, harmonics_);
    Eigen::VectorXd state = Eigen::VectorXd::Zero(reading.sizes().size());
    state.head(CompliantFlow::first_memory) = orbit->state.head(CompliantFlow::first_memory);
    read(reading, state);
  }
  found.followed = std::move(orbit);
  return h;
}

namespace {

// sticking: of the motion that sticks, where one of that kind may be meant
std::optional<Complex> hard_h(double gamma, double restitution, std::optional<Complex> sticking, Complex near,
                              int harmonic) {
  std::optional<Complex> nearest;
  const auto offer = [&](Complex h) {
    if (!nearest || std::abs(h - near) < std::abs(*nearest - near)) nearest = h;
  };
  if (const auto response = two_impact_response(gamma, restitution, harmonic)) offer(response->h);
  if (sticking) offer(*sticking);
  return nearest;
}

MotionHarmonics h_of_contact(const ContactMotions& motions, double gamma, double tau, bool is_followed,
                             FoundMotions& found, bool from_start) {
  return is_followed ? motions.followed(gamma, tau, found, from_start) : motions.symmetric(gamma, tau, found);
}

MotionHarmonics near_hard(const ContactMotions& motions, double gamma, double tau, bool is_followed,
                          FoundMotions& found, bool from_start) {
  const double least = is_followed ? least_followed_tau : least_symmetric_tau;
  MotionHarmonics h = h_of_contact(motions, gamma, std::max(tau, least), is_followed, found, from_start);
  if (!h[0] || tau >= least) return h;
  const auto sticking = is_followed ? sticking_harmonics(gamma, motions.restitution()) : std::nullopt;
  // Those of 2 and 3 of the least angles.
  std::optional<std::array<MotionHarmonics, 2>> further;
  for (int k = 1; k <= motions.harmonics(); k += 2) {
    std::optional<Complex>& own = h[harmonic_place(k)];
    const auto hard = hard_h(gamma, motions.restitution(),
                             sticking ? std::optional<Complex>((*sticking)[harmonic_place(k)]) : std::nullopt, *own, k);
    // N changes by about the angle between a motion and the one that it tends to, a harmonic by as many times that.
    const double same_motion_within = 10 * k;
    const bool is_its_limit =
        hard && (!is_followed || std::abs(*hard - *own) <= same_motion_within * least * std::abs(*own));
    if (is_its_limit) {
      own = *hard + tau / least * (*own - *hard);
      continue;
    }
    // Hard contacts have more orbits than those in closed form and those that stick.
    if (is_followed && !further) {
      FoundMotions copy = found;
      further.emplace();
      for (std::size_t i = 0; i < 2; ++i)
        (*further)[i] = motions.followed(gamma, static_cast<double>(i + 2) * least, copy, false);
    }
    const auto second = further ? (*further)[0][harmonic_place(k)] : std::nullopt,
               third = further ? (*further)[1][harmonic_place(k)] : std::nullopt;
    if (!second || !third) {
      own.reset();
      continue;
    }
    // The parabola through these, off by the cube of the angle.
    const double x = tau / least;
    own = 0.5 * (x - 2) * (x - 3) * *own - (x - 1) * (x - 3) * *second + 0.5 * (x - 1) * (x - 2) * *third;
  }
  return h;
}

}  // namespace

const MotionHarmonics& contact_h(const ContactMotions& motions, double gamma, double tau, bool is_followed,
                                 FoundMotions& found, bool from_start) {
  FoundMotions::Answer& answer = found.answers[is_followed ? 1 : 0];
  const std::array<double, 3> at = {gamma, tau, motions.restitution()};
  if (answer.at == at && (answer.from_start || !from_start || answer.h[0])) return answer.h;
  const MotionHarmonics h = near_hard(motions, gamma, tau, is_followed, found, from_start);
  answer = {at, from_start, h};
  return answer.h;
}

ContactResponses::ContactResponses(double restitution, int harmonics)
    : here_(restitution, harmonics),
      beside_(
          restitution + contact_difference <= 1 ? restitution + contact_difference : restitution - contact_difference,
          harmonics) {}

ContactResponses::All ContactResponses::at(double gamma, double tau, bool is_followed, FoundMotions found) const {
  All responses;
  const MotionHarmonics here = contact_h(here_, gamma, tau, is_followed, found, true);
  if (!here[0]) return responses;
  const double by = std::max(tau * contact_difference, is_followed ? least_followed_tau : least_symmetric_tau);
  const auto moved = [&](const ContactMotions& motions, double log_change, double longer) {
    FoundMotions neighbour = found;
    return MotionHarmonics(
        contact_h(motions, gamma * std::exp(log_change), tau + longer, is_followed, neighbour, false));
  };
  const MotionHarmonics stronger = moved(here_, contact_difference, 0), beside = moved(beside_, 0, 0),
                        longer = moved(here_, 0, by);
  for (std::size_t n = 0; n < responses.size(); ++n) {
    if (!here[n] || !stronger[n] || !beside[n] || !longer[n]) continue;
    responses[n] = GapResponse{*here[n], (*stronger[n] - *here[n]) / contact_difference,
                               (*beside[n] - *here[n]) / (beside_.restitution() - here_.restitution()),
                               (*longer[n] - *here[n]) / by};
  }
  return responses;
}

}  // namespace backlash::detail
