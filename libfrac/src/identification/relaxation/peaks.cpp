// SPDX-License-Identifier: BSD-3-Clause
#include "peaks.hpp"

#include <algorithm>

namespace frac::detail {

double peak_area(std::span<const double> log_tau, std::span<const double> density, const PeakRange& range) {
  double sum = 0;
  for (std::size_t i = range.first; i < range.last; ++i)
    sum += (log_tau[i + 1] - log_tau[i]) * (density[i] + density[i + 1]) / 2;
  return sum;
}

std::vector<PeakRange> peak_ranges(std::span<const double> density) {
  constexpr double prominence = 0.01;
  std::vector<PeakRange> ranges;
  const std::size_t count = density.size();
  for (std::size_t i = 0; i < count;) {
    // Up to a top, then down to the next minimum.
    const std::size_t first = i;
    while (i + 1 < count && density[i + 1] >= density[i]) ++i;
    const std::size_t top = i;
    while (i + 1 < count && density[i + 1] <= density[i]) ++i;
    if (!(density[top] > 0)) {
      if (i == first) break;
      continue;
    }
    const double valley = density[first];
    const bool joins = !ranges.empty() && ranges.back().last == first &&
                       valley > (1 - prominence) * std::min(density[ranges.back().top], density[top]);
    if (joins) {
      ranges.back().last = i;
      if (density[top] > density[ranges.back().top]) ranges.back().top = top;
    } else {
      ranges.push_back({first, top, i});
    }
    if (i == first) break;
  }
  std::erase_if(ranges, [&](const PeakRange& range) { return range.top == 0 || range.top + 1 == count; });
  return ranges;
}

std::vector<PeakRange> joined_peaks(std::vector<PeakRange> ranges, std::span<const double> density,
                                    std::span<const double> lower, std::span<const double> upper) {
  while (ranges.size() > 1) {
    std::size_t weakest = 0;
    double most = -1;
    for (std::size_t k = 0; k + 1 < ranges.size(); ++k) {
      const std::size_t left = ranges[k].top, right = ranges[k + 1].top;
      const auto first = upper.begin() + static_cast<std::ptrdiff_t>(left);
      const double valley = *std::min_element(first, upper.begin() + static_cast<std::ptrdiff_t>(right) + 1);
      const double overlap = valley - std::min(lower[left], lower[right]);
      if (overlap > most) {
        most = overlap;
        weakest = k;
      }
    }
    if (most < 0) break;
    PeakRange& kept = ranges[weakest];
    const PeakRange& next = ranges[weakest + 1];
    if (density[next.top] > density[kept.top]) kept.top = next.top;
    kept.last = next.last;
    ranges.erase(ranges.begin() + static_cast<std::ptrdiff_t>(weakest) + 1);
  }
  return ranges;
}

std::vector<PeakRange> large_peaks(std::vector<PeakRange> ranges, std::span<const double> log_tau,
                                   std::span<const double> density, double beside) {
  constexpr double share = 1e-3;
  double whole = beside;
  for (const auto& range : ranges) whole += peak_area(log_tau, density, range);
  std::erase_if(ranges, [&](const auto& range) { return !(peak_area(log_tau, density, range) > share * whole); });
  return ranges;
}

namespace {

constexpr std::size_t reach_of_line = 2;  // nodes on each side of the top over which smoothing spreads one

}  // namespace

bool is_narrow(std::span<const double> density, std::size_t top) {
  const auto at = [&](std::ptrdiff_t away) {
    const std::ptrdiff_t place = static_cast<std::ptrdiff_t>(top) + away;
    return place < 0 || place >= static_cast<std::ptrdiff_t>(density.size()) ? 0.0
                                                                             : density[static_cast<std::size_t>(place)];
  };
  return at(-2) < density[top] / 2 && at(2) < density[top] / 2;
}

double peak_place(std::span<const double> log_tau, std::span<const double> density, const PeakRange& range) {
  std::size_t top = range.first;
  for (std::size_t i = range.first; i <= range.last; ++i)
    if (density[i] > density[top]) top = i;
  if (top == 0 || top + 1 >= density.size()) return log_tau[top];
  if (is_narrow(density, top)) {
    double weight = 0, moment = 0;
    for (std::size_t i = std::max(range.first, top - std::min(top, reach_of_line));
         i <= std::min(range.last, top + reach_of_line); ++i) {
      weight += density[i];
      moment += density[i] * log_tau[i];
    }
    return moment / weight;
  }
  const double below = density[top - 1], here = density[top], above = density[top + 1];
  const double bend = below - 2 * here + above;
  const double step = (log_tau[top + 1] - log_tau[top - 1]) / 2;
  return bend < 0 ? log_tau[top] + std::clamp(0.5 * (below - above) / bend, -1.0, 1.0) * step : log_tau[top];
}

}  // namespace frac::detail
