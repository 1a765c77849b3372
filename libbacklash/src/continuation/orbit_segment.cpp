// SPDX-License-Identifier: BSD-3-Clause
#include "orbit_segment.hpp"

#include <cmath>
#include <numbers>
#include <numeric>

namespace backlash::detail {
namespace {

constexpr double pi = std::numbers::pi;

}  // namespace

double OrbitSegment::gamma() const noexcept {
  return std::exp(log_gamma);
}

SegmentImpact OrbitSegment::impact(std::size_t i) const noexcept {
  if (i < impacts.size()) return impacts[i];
  SegmentImpact again = impacts[i - impacts.size()];
  again.phase += half_periods * pi;
  if (symmetric()) again.wall = 1 - again.wall;
  return again;
}

Direction parameter_direction(const OrbitSegment& segment) {
  Direction direction(2 * segment.impacts.size() + 1, 0.0);
  direction.back() = 1;
  return direction;
}

Direction difference(const OrbitSegment& to, const OrbitSegment& from) {
  Direction result;
  result.reserve(2 * to.impacts.size() + 1);
  for (std::size_t i = 0; i < to.impacts.size(); ++i) {
    result.push_back(to.impacts[i].phase - from.impacts[i].phase);
    result.push_back(to.impacts[i].speed - from.impacts[i].speed);
  }
  result.push_back(to.parameter() - from.parameter());
  return result;
}

OrbitSegment moved(const OrbitSegment& from, const Direction& direction, double length) {
  OrbitSegment result = from;
  for (std::size_t i = 0; i < from.impacts.size(); ++i) {
    result.impacts[i].phase += length * direction[2 * i];
    result.impacts[i].speed += length * direction[2 * i + 1];
  }
  result.set_parameter(from.parameter() + length * direction.back());
  return result;
}

double dot(const Direction& a, const Direction& b) noexcept {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += a[i] * b[i];
  return sum;
}

OrbitSegment with_reduced_phase(OrbitSegment orbit) {
  const double turns = std::floor(orbit.impacts.front().phase / (2 * pi));
  if (turns != 0) {
    for (SegmentImpact& impact : orbit.impacts) impact.phase -= 2 * pi * turns;
  }
  return orbit;
}

std::complex<double> harmonic(const OrbitSegment& orbit, int k) {
  if (orbit.symmetric() && k % 2 == 0) return 0;
  // Two integrations by parts over the closed orbit leave the velocity jumps; a mirror half counts twice for odd k.
  std::complex<double> sum = 0;
  for (const SegmentImpact& impact : orbit.impacts) {
    sum += side_of(impact.wall) * (1 + orbit.restitution) * impact.speed * std::polar(1.0, -k * impact.phase);
  }
  const std::complex<double> jumps = sum * (-2 / (pi * orbit.half_periods * k * k));
  return k == 1 ? jumps - orbit.gamma() : jumps;
}

OrbitSegment mirror_image(const OrbitSegment& orbit) {
  OrbitSegment result = orbit;
  for (SegmentImpact& impact : result.impacts) {
    impact.phase += pi;
    impact.wall = 1 - impact.wall;
  }
  return with_reduced_phase(result);
}

OrbitSegment doubled(const OrbitSegment& orbit) {
  OrbitSegment result = orbit;
  const std::size_t n = orbit.impacts.size();
  for (std::size_t i = 0; i < n; ++i) result.impacts.push_back(orbit.impact(n + i));
  result.half_periods = 2 * orbit.half_periods;
  return result;
}

std::optional<Halves> halves(const OrbitSegment& orbit) {
  const std::size_t n = orbit.impacts.size();
  if (n % 2 != 0 || orbit.half_periods % 2 != 0) return std::nullopt;
  Halves result{{}, orbit};
  result.mean.half_periods = orbit.half_periods / 2;
  result.mean.impacts.resize(n / 2);
  for (std::size_t i = 0; i < n / 2; ++i) {
    SegmentImpact other = orbit.impacts[i + n / 2];
    other.phase -= result.mean.half_periods * pi;
    if (result.mean.symmetric()) other.wall = 1 - other.wall;
    const SegmentImpact& one = orbit.impacts[i];
    if (other.wall != one.wall) return std::nullopt;
    result.difference.push_back(one.phase - other.phase);
    result.difference.push_back(one.speed - other.speed);
    result.mean.impacts[i] = {0.5 * (one.phase + other.phase), 0.5 * (one.speed + other.speed), one.wall};
  }
  return result;
}

OrbitSegment with_impact(const OrbitSegment& orbit, std::size_t before, const SegmentImpact& impact) {
  OrbitSegment result = orbit;
  result.impacts.insert(result.impacts.begin() + static_cast<std::ptrdiff_t>(before) + 1, impact);
  return result;
}

OrbitSegment without_impact(const OrbitSegment& orbit, std::size_t index) {
  OrbitSegment result = orbit;
  result.impacts.erase(result.impacts.begin() + static_cast<std::ptrdiff_t>(index));
  return with_reduced_phase(result);
}

std::optional<OrbitSegment> repeated_round(const OrbitSegment& orbit) {
  const auto impacts = static_cast<int>(orbit.impacts.size());
  for (int rounds = std::gcd(impacts, orbit.half_periods); rounds > 1; --rounds) {
    if (impacts % rounds != 0 || orbit.half_periods % rounds != 0) continue;
    OrbitSegment round = orbit;
    round.half_periods /= rounds;
    round.impacts.resize(orbit.impacts.size() / static_cast<std::size_t>(rounds));
    double squares = 0;
    for (std::size_t i = 0; i < orbit.impacts.size(); ++i) {
      const SegmentImpact& first = round.impacts[i % round.impacts.size()];
      const auto turn = static_cast<int>(i / round.impacts.size());
      const SegmentImpact& again = orbit.impacts[i];
      const int wall = round.symmetric() && turn % 2 != 0 ? 1 - first.wall : first.wall;
      const double phase = again.phase - first.phase - turn * round.half_periods * pi;
      const double speed = again.speed - first.speed;
      squares += wall == again.wall ? phase * phase + speed * speed : 1;
    }
    if (squares < 1e-12) return round;
  }
  return std::nullopt;
}

}  // namespace backlash::detail
