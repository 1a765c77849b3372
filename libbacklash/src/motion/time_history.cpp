// SPDX-License-Identifier: BSD-3-Clause
#include "backlash/time_history.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <stdexcept>
#include <string>
#include <utility>

#include "base/spelling.hpp"
#include "frac/cancellation.hpp"
#include "motion_piece.hpp"
#include "simulation_start.hpp"

namespace backlash {
namespace {

constexpr double pi = std::numbers::pi;
constexpr std::int64_t most_samples = 10'000'000;

constexpr std::array<std::pair<HistoryEvent, std::string_view>, 5> events = {{
    {HistoryEvent::sample, "sample"},
    {HistoryEvent::before_impact, "before-impact"},
    {HistoryEvent::after_impact, "after-impact"},
    {HistoryEvent::rest_begin, "rest-begin"},
    {HistoryEvent::release, "release"},
}};

// Turns relative motion in a phase of the force into a row.
class RowMaker {
 public:
  RowMaker(const TwoMassSystem& system, double force_amplitude, double omega)
      : omega_(omega),
        clearance_(system.clearance()),
        share1_(system.mass2() / (system.mass1() + system.mass2())),
        share2_(system.mass1() / (system.mass1() + system.mass2())),
        swing_speed_(force_amplitude / (system.mass1() + system.mass2()) / omega),
        swing_(swing_speed_ / omega) {}

  // @param radians since the start;  @param cosine,sine  of them;  @param position,rate  in units of the clearance
  [[nodiscard]] HistoryRow row(double radians, double cosine, double sine, double position, double rate,
                               HistoryEvent event, std::optional<Wall> wall) const {
    const double mean = -swing_ * cosine;
    const double mean_speed = swing_speed_ * sine;
    const double y = position * clearance_;
    const double dy = rate * clearance_ * omega_;
    return {radians / omega_,
            mean - share1_ * y,
            mean_speed - share1_ * dy,
            mean + share2_ * y,
            mean_speed + share2_ * dy,
            event,
            wall};
  }

  // At a state of the motion, whose phase is tau = half_period pi - pi/2 + s, started at half_period 1, s = -pi/2.
  [[nodiscard]] HistoryRow row(const detail::GapState& state, double rate, HistoryEvent event,
                               std::optional<Wall> wall) const {
    const double sign = (state.half_period & 1) != 0 ? 1 : -1;
    const double radians = static_cast<double>(state.half_period - 1) * pi + (state.s + pi / 2);
    return row(radians, -sign * state.sin_s, sign * state.cos_s, state.position(), rate, event, wall);
  }

 private:
  double omega_, clearance_, share1_, share2_, swing_speed_, swing_;
};

}  // namespace

std::string_view to_string(HistoryEvent event) {
  return frac::detail::spelling(events, event);
}

TimeHistory time_history(const TwoMassSystem& system, double force_amplitude, double omega, const RelativeState& start,
                         int periods, int samples, std::size_t max_impacts) {
  const auto [motion, begin, speed_unit] = detail::simulation_start(system, force_amplitude, omega, start, periods);
  const std::int64_t all_samples = static_cast<std::int64_t>(periods) * samples;
  if (samples < 1 || all_samples > most_samples) {
    throw std::invalid_argument("samples is " + std::to_string(samples) + "; it must be positive, and " +
                                std::to_string(periods) + " periods of it at most " + std::to_string(most_samples));
  }
  const RowMaker maker(system, force_amplitude, omega);
  const std::int64_t last_peak = 1 + 2 * static_cast<std::int64_t>(periods);
  TimeHistory history{{}, true, {}};
  history.rows.reserve(static_cast<std::size_t>(all_samples) + 1);
  std::int64_t next_sample = 0;
  detail::GapState state = begin;
  std::size_t impacts = 0;
  for (;;) {
    const detail::MotionPiece piece = detail::piece_from(motion, state, detail::neglected_tail);
    const bool lasts = piece.end.half_period >= last_peak || (!piece.is_rest && !piece.flight.hits);
    const std::optional<Wall> contact = piece.is_rest ? std::optional(detail::wall_of(piece.begin)) : std::nullopt;
    if (piece.is_rest) history.rows.push_back(maker.row(piece.begin, 0, HistoryEvent::rest_begin, contact));
    const double length =
        piece.is_rest ? detail::radians_to_half_period(piece.begin, piece.end.half_period) + (pi / 2 + piece.end.s)
                      : piece.flight.duration;
    for (; next_sample <= all_samples; ++next_sample) {
      frac::throw_if_cancelled();
      const std::int64_t period = next_sample / samples;
      const double phase = 2 * pi * static_cast<double>(next_sample % samples) / samples;
      // Peaks of the force begin the odd half periods.
      const double h = detail::radians_to_half_period(piece.begin, 1 + 2 * period) + phase;
      if (h >= length && !lasts) break;
      double position = piece.begin.wall;
      double rate = 0;
      if (!piece.is_rest) {
        const detail::DistanceAndVelocity at = motion.along(piece.begin, piece.flight, std::max(h, 0.0));
        const double distance = std::clamp(at.distance, 0.0, 1.0);
        position = piece.begin.wall == 0 ? distance : 1 - distance;
        rate = piece.begin.wall == 0 ? at.velocity : -at.velocity;
      }
      history.rows.push_back(maker.row(2 * pi * static_cast<double>(period) + phase, std::cos(phase), std::sin(phase),
                                       position, rate, HistoryEvent::sample, contact));
      history.end = {position * system.clearance(), rate * speed_unit};
    }
    if (lasts) return history;
    if (piece.is_rest) {
      history.rows.push_back(maker.row(piece.end, 0, HistoryEvent::release, contact));
    } else {
      const Wall wall = detail::wall_of(piece.end);
      const double into_wall = wall == Wall::near ? -piece.flight.speed : piece.flight.speed;
      history.rows.push_back(maker.row(piece.end, into_wall, HistoryEvent::before_impact, wall));
      history.rows.push_back(maker.row(piece.end, piece.end.position_rate(), HistoryEvent::after_impact, wall));
      if (++impacts >= max_impacts) {
        history.complete = false;
        history.end = {piece.end.position() * system.clearance(), piece.end.position_rate() * speed_unit};
        return history;
      }
    }
    state = piece.end;
  }
}

TimeHistory stepped_sine_history(const TwoMassSystem& system, double force_amplitude, const std::vector<double>& omega,
                                 const RelativeState& start, int periods, int samples) {
  if (omega.empty()) throw std::invalid_argument("omega is empty; expected at least one frequency");
  if (static_cast<double>(omega.size()) * periods * samples > static_cast<double>(most_samples))
    throw std::invalid_argument("samples is " + std::to_string(samples) + "; " + std::to_string(omega.size()) +
                                " frequencies of " + std::to_string(periods) + " periods of it must be at most " +
                                std::to_string(most_samples));
  // The centre of mass swings about 0 at each frequency alone: where it is at a peak, which it passes without velocity.
  const double total = system.mass1() + system.mass2();
  const auto at_peak = [&](double w) { return -force_amplitude / (total * w * w); };
  TimeHistory whole{{}, true, start};
  double time = 0;
  for (const double w : omega) {
    const double shift = at_peak(omega.front()) - at_peak(w);
    const TimeHistory part = time_history(system, force_amplitude, w, whole.end, periods, samples);
    for (HistoryRow row : part.rows) {
      // The first row of a part is the last one of the part before.
      if (!whole.rows.empty() && row.time == 0 && row.event == HistoryEvent::sample) continue;
      row.time += time;
      row.x1 += shift;
      row.x2 += shift;
      whole.rows.push_back(row);
    }
    whole.end = part.end;
    whole.complete = part.complete;
    if (!part.complete) break;
    time += periods * 2 * pi / w;
  }
  return whole;
}

}  // namespace backlash
