// SPDX-License-Identifier: BSD-3-Clause
#include "report/response_figure.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

#include "io/unit_name.hpp"

namespace report {
namespace {

using frac::ResponsePoint;

/// Values of points that have a deviation, over frequency, in rising order.
Curve curve_of(const std::string& label, const std::string& colour, Mark mark, const std::vector<ResponsePoint>& points,
               double (*value)(const ResponsePoint&), double (*half_width)(const ResponsePoint&) = nullptr) {
  Curve curve{label, colour, mark, {{}}};
  for (const ResponsePoint& point : points) {
    const double y = value(point);
    if (!std::isfinite(point.sigma) || !std::isfinite(y)) continue;
    const double reach = half_width != nullptr ? half_width(point) : 0;
    curve.segments[0].push_back({point.omega, y, y - reach, y + reach});
  }
  std::stable_sort(curve.segments[0].begin(), curve.segments[0].end(),
                   [](const PlotPoint& a, const PlotPoint& b) { return a.x < b.x; });
  return curve;
}

double magnitude(const ResponsePoint& point) {
  return std::abs(point.value);
}
double degrees(const ResponsePoint& point) {
  return std::arg(point.value) * 180 / std::numbers::pi;
}
/// Of 95 %, see ResponsePoint::sigma.
double half_width(const ResponsePoint& point) {
  return 1.98 * point.sigma;
}
double half_width_of_logarithm(const ResponsePoint& point) {
  // A bar down to zero has no end on a logarithmic axis.
  constexpr double most = 0.99;
  return std::min(half_width(point), most * magnitude(point));
}
double half_width_of_phase(const ResponsePoint& point) {
  return std::min(half_width(point) / magnitude(point), std::numbers::pi) * 180 / std::numbers::pi;
}
/// A logarithmic axis has no zero.
double positive(double value) {
  return value > 0 ? value : std::numeric_limits<double>::quiet_NaN();
}

void add(Panel& panel, Curve curve) {
  if (!curve.segments[0].empty()) panel.curves.push_back(std::move(curve));
}

}  // namespace

Figure response_figure(const frac::ResponseEstimate& estimate, const std::vector<std::string>& labels,
                       const std::string& unit) {
  const Axis omega{"{/Symbol w} (rad/s)", true};
  const std::string in = unit.empty() ? "" : " (" + enhanced_escape(io::written_unit(unit)) + ")";
  Panel size{"", omega, {"magnitude" + in, true}}, phase{"", omega, {"phase (deg)"}}, share{"", omega, {"coherence"}};
  phase.y.degrees = true;
  size.key = phase.key = share.key = true;
  for (std::size_t i = 0; i < estimate.outputs.size(); ++i) {
    const auto& points = estimate.outputs[i];
    const std::string colour = category_colour(i), label = enhanced_escape(labels[i]);
    add(size, curve_of("", colour, Mark::faint_bars, points, magnitude, half_width_of_logarithm));
    add(size, curve_of(label, colour, Mark::points, points, magnitude));
    add(size, curve_of(label + ", noise", colour, Mark::line, points,
                       [](const ResponsePoint& p) { return positive(p.noise); }));
    add(size, curve_of(label + ", distortion", colour, Mark::dashed, points,
                       [](const ResponsePoint& p) { return positive(p.distortion); }));
    add(size, curve_of(label + ", even distortion", colour, Mark::dotted, points,
                       [](const ResponsePoint& p) { return positive(p.even_distortion); }));
    add(phase, curve_of("", colour, Mark::faint_bars, points, degrees, half_width_of_phase));
    add(phase, curve_of(label, colour, Mark::points, points, degrees));
    add(share, curve_of(label, colour, Mark::points, points, [](const ResponsePoint& p) { return p.coherence; }));
  }
  Figure figure{"response", "", {std::move(size), std::move(phase)}};
  if (!share.curves.empty()) {
    share.y.from = 0;
    share.y.to = 1;
    figure.panels.push_back(std::move(share));
  }
  return figure;
}

}  // namespace report
