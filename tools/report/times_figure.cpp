// SPDX-License-Identifier: BSD-3-Clause
#include "report/times_figure.hpp"

#include <algorithm>
#include <vector>

#include "report/field.hpp"
#include "report/prose.hpp"

namespace report {

void add_times(const std::string& label, std::size_t colour, const frac::TimesDistribution& times, bool with_range,
               Panel& panel) {
  if (with_range && !times.lower.empty())
    panel.curves.push_back(make_band(label + ", range", category_colour(colour), times.tau, times.lower, times.upper));
  panel.curves.push_back(make_curve(label, category_colour(colour), Mark::line, times.tau, times.density));
  // A line has no density; its area stands at its time.
  std::vector<double> tau, area;
  for (const auto& line : times.lines) {
    tau.push_back(line.tau);
    area.push_back(line.area);
  }
  if (!tau.empty())
    panel.curves.push_back(
        make_curve(label + ", areas of lines", category_colour(colour), Mark::open_points, tau, area));
}

frac::TimesDistribution within_band(frac::TimesDistribution times, const frac::FrequencyResponseData& data) {
  const auto first = std::lower_bound(times.tau.begin(), times.tau.end(), 1 / data.omega().back());
  const auto last = std::upper_bound(first, times.tau.end(), 1 / data.omega().front());
  const auto from = first - times.tau.begin(), to = last - times.tau.begin();
  for (auto* each : {&times.tau, &times.density, &times.lower, &times.upper})
    if (!each->empty()) *each = {each->begin() + from, each->begin() + to};
  return times;
}

void make_room_for_ranges(Panel& panel) {
  double summit = 0, upper = 0;
  for (const Curve& curve : panel.curves)
    for (const auto& segment : curve.segments)
      for (const PlotPoint& point : segment) {
        if (curve.mark == Mark::band)
          upper = std::max(upper, point.upper);
        else
          summit = std::max(summit, point.y);
      }
  if (upper > summit && summit > 0) panel.y.to = 1.05 * std::min(upper, 2 * summit);
}

std::optional<Figure> times_figure(const std::string& name, const frac::FrequencyResponseData& data,
                                   const std::string& unit) {
  const auto times = frac::relaxation_times(data, frac::TimesKernel::falling);
  if (!times.follows_data()) return std::nullopt;
  Panel panel{"Relaxation times", {"τ in s", true}, {with_unit("density per e-fold", unit)}};
  panel.key = true;
  add_times("data", 0, within_band(times, data), true, panel);
  make_room_for_ranges(panel);
  Figure figure{name, prose("data", "times"), {std::move(panel)}};
  figure.link = name;
  return figure;
}

}  // namespace report
