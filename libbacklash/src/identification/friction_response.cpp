// SPDX-License-Identifier: BSD-3-Clause
#include "friction_response.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "backlash/compliant/compliant_bodies.hpp"
#include "base/linear_algebra.hpp"
#include "compliant/compliant_flow.hpp"
#include "compliant/compliant_run.hpp"
#include "compliant/symmetric_compliant_orbit.hpp"
#include "contact_response.hpp"

namespace backlash::detail {
namespace {

using Complex = std::complex<double>;
using Index = Eigen::Index;

// Angle of the shortest contacts that are computed: hard ones lie on the line through this one and its double.
constexpr double least_tau = 1e-3;
// Of both bodies, where they have none: the masses would drift together at any speed.  That of one of them which turns
// at hard impacts hardly holds them, as it is none in the mean at any drift.
constexpr double least_friction = 1e-6;
// Half of the digits of a flow.
constexpr double difference = 1e-6;
constexpr double exact = 1e-9;  // of fractional powers, of which there are none

struct Units {
  CompliantBodies bodies;
  SineForce force;
};

// Clearance, omega and the reduced mass are 1.
FrictionGroups holding(FrictionGroups groups) {
  if (groups.friction[0] + groups.friction[1] < least_friction) groups.friction = {least_friction, least_friction};
  return groups;
}

Units units(FrictionGroups groups) {
  groups = holding(groups);
  const double mass1 = 1 + groups.mass_ratio, mass2 = 1 + 1 / groups.mass_ratio;
  const double force = groups.gamma * mass2;
  const ContactShape shape = contact_shape(groups.restitution);
  const double frequency = shape.angle / groups.tau;
  const CoulombFriction friction{force * groups.friction[0], force * groups.friction[1]};
  return {{free_mass(mass1), free_mass(mass2), 1,
           CompliantContact(frequency * frequency, 2 * shape.damping_ratio * frequency), friction},
          {force, 1}};
}

/// What is read: the position of a body, and which harmonic of it.
struct Read {
  Output output;
  int harmonic;
};

CompliantFlow flow_of(const Units& units, Read read) {
  return {units.bodies, units.force, read.output, exact, read.harmonic};
}

Complex reading(const CompliantRun& run, const CompliantFlow& flow, Read read) {
  return run.phasors().back() / Complex(0, read.harmonic * flow.omega()) / flow.force();
}

bool is_steady(const std::optional<CompliantOrbit>& orbit) {
  return orbit && orbit->contacts > 0 && orbit->largest_multiplier < 1;
}

// The orbit of one period that a motion comes to within some periods.
std::optional<CompliantOrbit> orbit_after(const CompliantFlow& flow, CompliantRun run) {
  constexpr std::array<int, 4> followed = {4, 6, 12, 24};
  for (const int periods : followed) {
    for (int n = 0; n < periods; ++n)
      if (!run.follow(1)) return std::nullopt;
    auto orbit = closed_orbit(flow, run.state(), run.mode(), 1);
    if (is_steady(orbit)) return orbit;
  }
  return std::nullopt;
}

CompliantRun from_rest(const CompliantFlow& flow) {
  const Eigen::VectorXd start = flow.start({0.25, 0, -0.25, 0});
  return {flow, start, flow.mode_of(start)};
}

// At the next peak of the force after a contact of the symmetric orbit begins.
CompliantRun from_symmetric(const CompliantFlow& flow, const SymmetricCompliantOrbit& orbit) {
  const TwoMassSystem& system = flow.bodies().system();
  const double total = system.mass1() + system.mass2();
  // Of the centre of mass, as the force leaves it.
  const double centre = flow.force() / total * std::sin(orbit.angle);
  return at_next_peak(
      flow, {0, centre - orbit.speed * system.mass2() / total, 0.5, centre + orbit.speed * system.mass1() / total},
      orbit.angle);
}

// Of an orbit of other friction: of a body without any the mode knows no direction of sliding.
CompliantMode mode_in(const CompliantFlow& flow, const CompliantOrbit& orbit) {
  CompliantMode mode = orbit.mode;
  const LoopStart at = CompliantFlow::positions(orbit.state);
  for (int body = 0; body < 2; ++body) {
    int& slide = mode.slide[static_cast<std::size_t>(body)];
    if (flow.friction(body) > 0 && slide * (body == 0 ? at.v1 : at.v2) < 0) slide = -slide;
  }
  return mode;
}

std::optional<CompliantOrbit> orbit_of(const CompliantFlow& flow, const FrictionGroups& groups, FrictionStart start,
                                       const FoundOrbit& found) {
  switch (start) {
    case FrictionStart::found: {
      if (!found) return std::nullopt;
      auto orbit = closed_orbit(flow, found->state, mode_in(flow, *found), 1);
      return is_steady(orbit) ? orbit : std::nullopt;
    }
    case FrictionStart::symmetric: {
      const ContactShape shape = contact_shape(groups.restitution);
      const auto symmetric =
          symmetric_compliant_orbit_from_hard({groups.gamma, shape.angle / groups.tau, shape.damping_ratio});
      return symmetric ? orbit_after(flow, from_symmetric(flow, *symmetric)) : std::nullopt;
    }
    case FrictionStart::rest:
      break;
  }
  return orbit_after(flow, from_rest(flow));
}

struct Followed {
  Complex n;
  CompliantOrbit orbit;
};
std::optional<Followed> followed(const FrictionGroups& groups, Read read, FrictionStart start,
                                 const FoundOrbit& found) {
  const CompliantFlow flow = flow_of(units(groups), read);
  auto orbit = orbit_of(flow, groups, start, found);
  if (!orbit) return std::nullopt;
  CompliantRun run(flow, orbit->state, orbit->mode);
  run.follow(1);
  return Followed{reading(run, flow, read), std::move(*orbit)};
}

FrictionGroups with_tau(FrictionGroups groups, double tau) {
  groups.tau = tau;
  return groups;
}

// Of contacts that take time.
std::optional<FrictionResponse> response_at(const FrictionGroups& groups, Read read, const FoundOrbit& found) {
  const CompliantFlow flow = flow_of(units(groups), read);
  const auto orbit = orbit_of(flow, groups, FrictionStart::found, found);
  if (!orbit) return std::nullopt;
  CompliantRun run(flow, orbit->state, orbit->mode);
  run.begin_transition();
  run.follow(1);
  const Eigen::VectorXd end = run.state();
  const Complex here = reading(run, flow, read);
  const std::vector<Index>& repeating = flow.repeating();
  const auto count = static_cast<Index>(repeating.size());
  const Eigen::MatrixXd remaining = Eigen::MatrixXd::Identity(count, count) - orbit->monodromy;
  // The two states of the highest phasor are the last; what they are at the end turns into n as reading() does.
  const Index phasors = end.size() - 2;
  const Complex to_n = flow.omega() / (std::numbers::pi * Complex(0, read.harmonic * flow.omega()) * flow.force());
  const auto by = [&](const FrictionGroups& other, double step) {
    const CompliantFlow beside = flow_of(units(other), read);
    CompliantRun changed(beside, orbit->state, mode_in(beside, *orbit));
    changed.follow(1);
    Eigen::VectorXd moved(count);
    for (Index i = 0; i < count; ++i) {
      const Index at = repeating[static_cast<std::size_t>(i)];
      moved[i] = (changed.state()[at] - end[at]) / step;
    }
    const Eigen::VectorXd of_orbit = frac::detail::solve_square(remaining, moved);
    Complex n = (reading(changed, beside, read) - here) / step;
    for (Index i = 0; i < count; ++i) {
      const Index at = repeating[static_cast<std::size_t>(i)];
      n += to_n * of_orbit[i] * Complex(run.transition()(phasors, at), run.transition()(phasors + 1, at));
    }
    return n;
  };
  FrictionResponse response{here, {}, {}, {}, {}, {}};
  FrictionGroups other = groups;
  other.gamma *= std::exp(difference);
  response.by_log_gamma = by(other, difference);
  other = with_tau(groups, groups.tau * (1 + difference));
  response.by_tau = by(other, groups.tau * difference);
  other = groups;
  const double step = groups.restitution + difference <= 1 ? difference : -difference;
  other.restitution += step;
  response.by_restitution = by(other, step);
  other = groups;
  other.mass_ratio *= std::exp(difference);
  response.by_log_mass_ratio = by(other, difference);
  for (std::size_t i = 0; i < 2; ++i) {
    other = holding(groups);
    other.friction[i] += difference;
    response.by_friction[i] = by(other, difference);
  }
  return response;
}

}  // namespace

std::optional<Complex> friction_n(const FrictionGroups& groups, Output output, FrictionStart start, FoundOrbit& found,
                                  int harmonic) {
  const Read read{output, harmonic};
  const double x = groups.tau / least_tau;
  auto near = followed(with_tau(groups, std::max(groups.tau, least_tau)), read, start, found);
  if (!near) return std::nullopt;
  found = std::move(near->orbit);
  if (x >= 1) return near->n;
  const auto far = followed(with_tau(groups, 2 * least_tau), read, FrictionStart::found, found);
  if (!far) return std::nullopt;
  return near->n + (x - 1) * (far->n - near->n);
}

std::optional<FrictionResponse> friction_response(const FrictionGroups& groups, Output output, const FoundOrbit& found,
                                                  int harmonic) {
  const Read read{output, harmonic};
  const double x = groups.tau / least_tau;
  auto near = response_at(with_tau(groups, std::max(groups.tau, least_tau)), read, found);
  if (!near || x >= 1) return near;
  const auto far = response_at(with_tau(groups, 2 * least_tau), read, found);
  if (!far) return std::nullopt;
  const auto line = [&](auto member) {
    const Complex first = (*near).*member, second = (*far).*member;
    return first + (x - 1) * (second - first);
  };
  FrictionResponse hard{};
  hard.n = line(&FrictionResponse::n);
  hard.by_tau = (far->n - near->n) / least_tau;
  for (const auto member :
       {&FrictionResponse::by_log_gamma, &FrictionResponse::by_restitution, &FrictionResponse::by_log_mass_ratio})
    hard.*member = line(member);
  for (std::size_t i = 0; i < 2; ++i)
    hard.by_friction[i] = near->by_friction[i] + (x - 1) * (far->by_friction[i] - near->by_friction[i]);
  return hard;
}

}  // namespace backlash::detail
