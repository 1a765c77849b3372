// SPDX-License-Identifier: BSD-3-Clause
#include "backlash/compliant/compliant_history.hpp"

#include <array>
#include <numbers>
#include <stdexcept>
#include <string>
#include <utility>

#include "base/check.hpp"
#include "base/spelling.hpp"
#include "compliant_rows.hpp"

namespace backlash {
namespace {

constexpr std::array<std::pair<CompliantEvent, std::string_view>, 10> event_spellings = {{
    {CompliantEvent::sample, "sample"},
    {CompliantEvent::contact, "contact"},
    {CompliantEvent::separation, "separation"},
    {CompliantEvent::parting, "parting"},
    {CompliantEvent::stick1, "stick-1"},
    {CompliantEvent::slide1, "slide-1"},
    {CompliantEvent::reversal1, "reversal-1"},
    {CompliantEvent::stick2, "stick-2"},
    {CompliantEvent::slide2, "slide-2"},
    {CompliantEvent::reversal2, "reversal-2"},
}};

void require_count(const char* quantity, int value, int lowest) {
  if (value < lowest)
    throw std::invalid_argument(std::string(quantity) + " is " + std::to_string(value) + "; it must be at least " +
                                std::to_string(lowest));
}

void require_finite(const char* quantity, double value) {
  if (!std::isfinite(value))
    throw std::invalid_argument(std::string(quantity) + " is " + detail::text(value) + "; it must be finite");
}

}  // namespace

namespace detail {

std::optional<CompliantEvent> shown(CompliantRun::Event event, int subject) {
  using Event = CompliantRun::Event;
  const bool is_first = subject == 0;
  switch (event) {
    case Event::none:
      return CompliantEvent::sample;
    case Event::contact:
      return CompliantEvent::contact;
    case Event::separation:
      return CompliantEvent::separation;
    case Event::parting:
      return CompliantEvent::parting;
    case Event::stick:
      return is_first ? CompliantEvent::stick1 : CompliantEvent::stick2;
    case Event::slide:
      return is_first ? CompliantEvent::slide1 : CompliantEvent::slide2;
    case Event::reversal:
      return is_first ? CompliantEvent::reversal1 : CompliantEvent::reversal2;
    case Event::turn_of_force:
    case Event::limit:
      break;
  }
  return std::nullopt;
}

CompliantRow row_of(const CompliantRun& run, double time, CompliantEvent event) {
  const LoopStart at = CompliantFlow::positions(run.state());
  const int wall = run.mode().contact;
  CompliantRow row{time, at.x1, at.v1, at.x2, at.v2, 0, event, std::nullopt};
  if (wall == 0) return row;
  const auto& flow = run.flow();
  row.contact_force = flow.press(flow.regime(run.mode()), wall).row.dot(run.state());
  row.wall = wall > 0 ? Wall::far : Wall::near;
  return row;
}

}  // namespace detail

std::string_view to_string(CompliantEvent event) {
  return frac::detail::spelling(event_spellings, event);
}

CompliantHistory compliant_history(const CompliantBodies& bodies, double force_amplitude, double omega,
                                   const LoopStart& start, int skip, int periods, int samples) {
  constexpr double most_rows = 1e7, fractional_tolerance = 1e-9;
  detail::require_positive("force_amplitude", "N", force_amplitude);
  detail::require_positive("omega", "rad/s", omega);
  detail::require_followed(bodies, omega);
  for (const auto& [quantity, value] : {std::pair{"start x1", start.x1}, std::pair{"start v1", start.v1},
                                        std::pair{"start x2", start.x2}, std::pair{"start v2", start.v2}})
    require_finite(quantity, value);
  require_count("skip", skip, 0);
  require_count("periods", periods, 1);
  require_count("samples", samples, 1);
  if (static_cast<double>(periods) * samples > most_rows)
    throw std::invalid_argument("periods times samples is " + detail::text(static_cast<double>(periods) * samples) +
                                "; it must be at most 1e7");
  const detail::CompliantFlow flow(bodies, {force_amplitude, omega}, Output::x1, fractional_tolerance, 1);
  const Eigen::VectorXd state = flow.start(start);
  detail::CompliantRun run(flow, state, flow.mode_of(state));
  CompliantHistory history{{}, true, start};
  const auto ended_early = [&] {
    history.complete = false;
    history.end = detail::CompliantFlow::positions(run.state());
    return history;
  };
  for (int i = 0; i < skip; ++i)
    if (!run.follow(1)) return ended_early();
  const double period = 2 * std::numbers::pi / omega;
  history.rows.push_back(detail::row_of(run, 0, CompliantEvent::sample));
  for (int i = 0; i < periods; ++i) {
    int events = 0;
    for (int k = 1; k <= samples; ++k) {
      const double until = k * period / samples;
      for (;;) {
        const auto event = run.advance(until);
        if (run.has_escaped() || ++events > detail::CompliantRun::most_events) return ended_early();
        if (const auto word = detail::shown(event, run.subject()))
          history.rows.push_back(detail::row_of(run, i * period + run.time(), *word));
        if (event == detail::CompliantRun::Event::none) break;
      }
    }
    run.begin_anew(1);
  }
  history.end = detail::CompliantFlow::positions(run.state());
  return history;
}

LoopStart start_about_mean(const TwoMassSystem& system, double force_amplitude, double omega,
                           const RelativeState& start) {
  const double total = system.mass1() + system.mass2();
  const double centre = -force_amplitude / (total * omega * omega);
  const double share1 = system.mass2() / total, share2 = system.mass1() / total;
  // Bodies of a loop count the gap from its middle.
  return {centre - share1 * start.position, 0 - share1 * start.velocity,
          centre + share2 * start.position - 0.5 * system.clearance(), share2 * start.velocity};
}

RigMotion rig_motion(const CompliantBodies& bodies, double force_amplitude, const std::vector<double>& omega,
                     const LoopStart& start, int skip, int periods) {
  RigMotion motion{stepped_sine_force(force_amplitude, omega, periods, rig_steps), {}, {}, true};
  double begin = 0;
  LoopStart state = start;
  for (const double each : omega) {
    const auto part =
        compliant_history(bodies, force_amplitude, each, state, begin == 0 ? skip : 0, periods, rig_steps);
    for (const CompliantRow& row : part.rows) {
      motion.x1.add(begin + row.time, row.x1, row.v1);
      motion.x2.add(begin + row.time, row.x2, row.v2);
    }
    motion.complete = part.complete;
    if (!part.complete) break;
    state = part.end;
    begin += periods * 2 * std::numbers::pi / each;
  }
  return motion;
}

}  // namespace backlash
