// SPDX-License-Identifier: BSD-3-Clause
#include "report/sweep_curves.hpp"

#include <cmath>
#include <numbers>
#include <utility>

namespace report {

namespace {

// Bars shorter than this share of the value are not drawn: they would be hidden by the point.
constexpr double visible_bar = 0.02;

Curve empty_curve(const std::string& label, const std::string& colour, Mark mark) {
  return {label, colour, mark, {}};
}

}  // namespace

bool on_one_branch(const backlash::DescribingFunctionPoint& a, const backlash::DescribingFunctionPoint& b) {
  using backlash::Regime;
  if (a.regime == Regime::averaged || b.regime == Regime::averaged) return false;
  // Chatter has infinitely many impacts per period; infinities compare equal, so all chatter is one branch.
  return a.period == b.period && a.impacts_per_period == b.impacts_per_period;
}

double phase_degrees(std::complex<double> value) {
  return std::arg(value) * 180 / std::numbers::pi;
}

double decibel(std::complex<double> value) {
  return 20 * std::log10(std::abs(value));
}

std::vector<Curve> sweep_curves(
    const backlash::DescribingFunctionSweep& sweep, const std::string& label, const std::string& colour,
    const std::function<std::optional<PlotPoint>(const backlash::DescribingFunctionPoint&)>& place) {
  Curve exact = empty_curve(label, colour, Mark::line);
  Curve single = empty_curve("", colour, Mark::points);
  Curve mean = empty_curve("", colour, Mark::faint_points);
  Curve bars = empty_curve("", colour, Mark::faint_bars);
  const backlash::DescribingFunctionPoint* before = nullptr;
  const auto close_segment = [&] {
    if (!exact.segments.empty() && exact.segments.back().size() == 1) {
      single.segments.push_back(std::move(exact.segments.back()));
      exact.segments.pop_back();
    }
    before = nullptr;
  };
  for (const auto& point : sweep.points) {
    const std::optional<PlotPoint> drawn = place(point);
    if (!drawn || !std::isfinite(drawn->x) || !std::isfinite(drawn->y)) {
      close_segment();
      continue;
    }
    if (point.regime == backlash::Regime::averaged) {
      close_segment();
      mean.segments.push_back({*drawn});
      if (drawn->upper - drawn->lower > visible_bar * std::abs(drawn->y)) bars.segments.push_back({*drawn});
      continue;
    }
    if (before == nullptr || !on_one_branch(*before, point)) {
      close_segment();
      exact.segments.emplace_back();
    }
    exact.segments.back().push_back(*drawn);
    before = &point;
  }
  close_segment();
  return {std::move(bars), std::move(mean), std::move(single), std::move(exact)};
}

Table sweep_table(const std::string& name, const std::string& caption,
                  const std::vector<backlash::DescribingFunctionSweep>& sweeps) {
  Table table{name,
              caption,
              {{"force_n", "F / N"},
               {"clearance_m", "Δ / m"},
               {"restitution", "ε"},
               {"omega_rad_s", "ω / (rad/s)"},
               {"re_m_per_n", "Re N / (m/N)"},
               {"im_m_per_n", "Im N / (m/N)"},
               {"regime", "regime"},
               {"period", "period"},
               {"impacts_per_period", "impacts"},
               {"uncertainty_m_per_n", "uncertainty / (m/N)"},
               {"third_harmonic_ratio", "third harmonic ratio"}},
              {},
              false};
  for (const auto& sweep : sweeps) {
    for (const auto& point : sweep.points) {
      table.rows.push_back({sweep.force_amplitude, sweep.system.clearance(), sweep.system.restitution(), point.omega,
                            point.value.real(), point.value.imag(), std::string(backlash::to_string(point.regime)),
                            static_cast<double>(point.period), point.impacts_per_period, point.uncertainty,
                            point.third_harmonic_ratio});
    }
  }
  return table;
}

}  // namespace report
