// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <complex>
#include <iterator>
#include <limits>
#include <numbers>
#include <optional>
#include <utility>

#include "backlash/jump_frequency.hpp"
#include "frac/approximation/oustaloup.hpp"
#include "frac/grunwald_letnikov.hpp"
#include "report/fixed_step_reference.hpp"
#include "report/grid.hpp"
#include "report/html.hpp"
#include "report/prose.hpp"
#include "report/sections.hpp"
#include "report/timing.hpp"

namespace report {

namespace {

// Sum of everything that was timed, so that no call can be optimised away.
volatile double sink = 0;

// Draws errors below the rounding unit at the rounding unit, because a logarithmic axis has no zero.
double visible(double error) {
  return std::max(error, std::numeric_limits<double>::epsilon());
}

// Times and errors of a method at several settings, as they are drawn.
struct Timed {
  std::vector<double> seconds, error;
  void add(double time, double relative_error) {
    seconds.push_back(time);
    error.push_back(visible(relative_error));
  }
};

struct Point {
  std::string name;
  double omega;
};

std::vector<Point> points_of(const Work& work) {
  const Scene& scene = work.scene;
  std::vector<Point> points = {{"low frequency", 2 * scene.omega_bode.front()}};
  const auto system = work.system();
  const auto lower = backlash::jump_frequency(system, scene.force, backlash::JumpCriterion::symmetry_loss);
  const auto collapse = backlash::jump_frequency(system, scene.force, backlash::JumpCriterion::saddle_node);
  const auto released = backlash::jump_frequency(system, scene.force, backlash::JumpCriterion::mid_gap_at_rest);
  const auto jump = backlash::jump_frequency(system, scene.force, backlash::JumpCriterion::two_impact_loss);
  if (jump && lower && *jump < *lower) points.push_back({"asymmetric orbit", std::sqrt(*jump * *lower)});
  // The fixed step starts at mid-gap at rest.  Above `released` both motions exist and that start never meets a wall.
  if (lower && released) {
    const double upper = std::min(*released, collapse.value_or(*released));
    if (*lower < upper) points.push_back({"symmetric orbit", std::sqrt(*lower * upper)});
  }
  return points;
}

// Fixed steps of several lengths, each with a row in the table.
Timed timed_steps(const FixedStepScene& scene, const Point& point, std::complex<double> reference, Table& table) {
  Timed timed;
  double before = std::nan("");
  for (std::size_t steps = 256; steps <= 16384; steps *= 4) {
    const auto run = [&] { return fixed_step_describing_function(scene, point.omega, steps, 60, 20); };
    const double error = std::abs(run() - reference) / std::abs(reference);
    const double seconds = median_seconds([&] { sink = sink + run().real(); });
    table.rows.push_back({point.name, point.omega, std::string("fixed step"),
                          std::to_string(steps) + " steps per period", error, seconds, std::log2(before / error) / 2});
    before = error;
    timed.add(seconds, error);
  }
  return timed;
}

void add_describing_function(Section& section, const Work& work) {
  const Scene& scene = work.scene;
  const auto system = work.system();
  Table table{"speed-describing-function",
              prose("speed", "describing-function"),
              {{"motion", "motion"},
               {"omega_rad_s", "ω / (rad/s)"},
               {"method", "method"},
               {"setting", "setting"},
               {"relative_error", "relative error", 2},
               {"seconds", "seconds", 3},
               {"order", "order", 2}}};
  Panel panel{"One describing-function value", {"seconds", true}, {"relative error of N", true, 1e-17, 1.0}};
  panel.key = true;
  const FixedStepScene fixed{scene.mass1, scene.mass2, scene.clearance, scene.restitution, scene.force};
  std::size_t colour = 0;
  std::optional<std::string> compared;
  for (const Point& point : points_of(work)) {
    backlash::SweepOptions options;
    options.threads = 1;
    options.protocol = backlash::Protocol::two_impact;
    const std::vector<double> omega = {point.omega};
    const auto value_at = [&](double tolerance) {
      options.tolerance = tolerance;
      return backlash::describing_function_sweep(system, scene.force, omega, options).points.front();
    };
    const auto reference = value_at(1e-13);
    if (reference.regime == backlash::Regime::averaged || reference.value == 0.0) continue;
    const std::string regime(backlash::to_string(reference.regime));
    Timed by_events;
    static const std::pair<double, std::string> tolerances[] = {
        {1e-4, "tolerance 1e-4"}, {1e-7, "tolerance 1e-7"}, {1e-10, "tolerance 1e-10"}, {1e-13, "tolerance 1e-13"}};
    for (const auto& [tolerance, setting] : tolerances) {
      const double error = std::abs(value_at(tolerance).value - reference.value) / std::abs(reference.value);
      const double seconds = median_seconds([&, at = tolerance] { sink = sink + value_at(at).value.real(); });
      table.rows.push_back(
          {point.name, point.omega, "event-driven (" + regime + ")", setting, error, seconds, std::nan("")});
      by_events.add(seconds, error);
    }
    const Timed by_steps = timed_steps(fixed, point, reference.value, table);
    const std::string shade = category_colour(colour++);
    panel.curves.push_back(
        make_curve("fixed step, " + point.name, shade, Mark::line_points, by_steps.seconds, by_steps.error));
    panel.curves.push_back(make_curve("event-driven", shade, Mark::open_points, by_events.seconds, by_events.error));
    if (point.name == "symmetric orbit" || !compared) {
      compared = prose("speed", "comparison",
                       {{"motion", point.name},
                        {"omega", html_number(point.omega, 3)},
                        {"exact", html_seconds(by_events.seconds.back())},
                        {"fixed", html_seconds(by_steps.seconds.back())},
                        {"error", html_number(100 * by_steps.error.back(), 2)}});
    }
  }
  if (compared) section.finding(prose("speed", "finding", {{"comparison", *compared}}));
  Figure figure;
  figure.name = "speed-describing-function";
  figure.caption = prose("speed", "describing-function-figure");
  figure.panels = {std::move(panel)};
  figure.panel_height = 340;
  section.add(Html{prose("speed", "describing-function-heading")});
  section.add(std::move(figure));
  section.add(std::move(table));
}

struct Measured {
  double error, nanoseconds;
};

constexpr double power_order = 0.5;

Measured measured(const std::vector<double>& grid, const std::function<std::complex<double>(double)>& response) {
  Measured result{0, 0};
  for (const double omega : grid) {
    const std::complex<double> exact = frac::power_response(frac::ExactRealisation{}, power_order, omega).value;
    result.error = std::max(result.error, std::abs(response(omega) / exact - 1.0));
  }
  const double seconds = median_seconds([&] {
    double sum = 0;
    for (const double omega : grid) sum += response(omega).real();
    sink = sink + sum;
  });
  result.nanoseconds = 1e9 * seconds / static_cast<double>(grid.size());
  return result;
}

struct Band {
  std::string name, column;
  double wider;  // factor beyond either end
};

constexpr double band_lower = 1e-2, band_upper = 1e2;

// Ladders of several sizes on three bands: their errors over the size and over the time.
Table oustaloup_ladders(const std::vector<double>& grid, Panel& by_size, Panel& by_time) {
  Table ladders{"speed-oustaloup", prose("speed", "oustaloup"), {{"poles", "poles"}}, {}};
  const Band bands[] = {{"own band", "error_own_band", 1},
                        {"± 1 decade", "error_wider_1_decade", 10},
                        {"± 3 decades", "error_wider_3_decades", 1000}};
  for (const Band& band : bands) ladders.columns.push_back({band.column, "error, " + band.name, 3});
  ladders.columns.push_back({"nanoseconds", "ns per value", 3});
  std::vector<std::vector<double>> errors(std::size(bands)), times(std::size(bands));
  std::vector<double> sizes;
  for (const int poles : {2, 4, 8, 12, 16, 24, 32, 48, 64}) {
    sizes.push_back(poles);
    std::vector<Cell> row = {static_cast<double>(poles)};
    for (std::size_t b = 0; b < std::size(bands); ++b) {
      const frac::ZeroPoleGain ladder =
          frac::oustaloup(power_order, {band_lower / bands[b].wider, band_upper * bands[b].wider}, poles);
      const Measured value = measured(grid, [&ladder](double omega) { return ladder.response(omega); });
      errors[b].push_back(value.error);
      times[b].push_back(value.nanoseconds);
      row.emplace_back(value.error);
    }
    row.emplace_back(times.back().back());
    ladders.rows.push_back(std::move(row));
  }
  for (std::size_t b = 0; b < std::size(bands); ++b) {
    by_size.curves.push_back(make_curve("", category_colour(b), Mark::line_points, sizes, errors[b]));
    by_time.curves.push_back(
        make_curve("Oustaloup, " + bands[b].name, category_colour(b), Mark::line_points, times[b], errors[b]));
  }
  return ladders;
}

// Sums of several lengths, and the exact power.
Table grunwald_letnikov_sums(const std::vector<double>& grid, Panel& by_time) {
  const double sample_time = 2 * std::numbers::pi / (40 * band_upper);
  Table sums{
      "speed-grunwald-letnikov",
      prose("speed", "grunwald-letnikov"),
      {{"method", "method"}, {"relative_error", "largest relative error", 3}, {"nanoseconds", "ns per value", 3}}};
  std::vector<double> error, time;
  for (const std::size_t memory : {10U, 100U, 1000U, 10000U}) {
    // The response of a long memory is a long sum.  Few frequencies are enough to show its error, which is largest at
    // the lowest one.
    const std::vector<double> coarse = logarithmic_grid(band_lower, band_upper, memory > 1000 ? 20 : 100);
    const Measured value = measured(coarse, [&](double omega) {
      return frac::grunwald_letnikov_response(power_order, sample_time, memory, omega);
    });
    sums.rows.push_back({"last " + std::to_string(memory) + " samples kept", value.error, value.nanoseconds});
    error.push_back(value.error);
    time.push_back(value.nanoseconds);
  }
  by_time.curves.push_back(make_curve("Grünwald-Letnikov", category_colour(3), Mark::line_points, time, error));
  const Measured all = measured(grid, [sample_time](double omega) {
    return frac::grunwald_letnikov_response(power_order, sample_time, 0, omega);
  });
  sums.rows.push_back({std::string("all samples kept"), all.error, all.nanoseconds});
  const Measured exact = measured(
      grid, [](double omega) { return frac::power_response(frac::ExactRealisation{}, power_order, omega).value; });
  sums.rows.push_back({std::string("exact power"), exact.error, exact.nanoseconds});
  return sums;
}

void add_power(Section& section) {
  const std::vector<double> grid = logarithmic_grid(band_lower, band_upper, 400);
  Panel by_size, by_time;
  by_size.title = "Error against number of poles";
  by_size.x = {"poles", true, 1.0, 100.0};
  by_size.y = {"largest relative error", true};
  by_time.title = "Error against time";
  by_time.x = {"nanoseconds per value", true};
  by_time.y = {"", true};
  by_time.key = true;
  Table ladders = oustaloup_ladders(grid, by_size, by_time);
  Table sums = grunwald_letnikov_sums(grid, by_time);
  Figure figure;
  figure.name = "speed-power";
  figure.caption = prose("speed", "power-figure");
  figure.columns = 2;
  figure.panel_height = 320;
  figure.panels = {std::move(by_size), std::move(by_time)};
  section.add(Html{prose("speed", "power-heading")});
  section.add(std::move(figure));
  section.add(std::move(ladders));
  section.add(std::move(sums));
}

}  // namespace

Section speed_section(const Work& work) {
  Section section = open_section("speed");
  if (work.scene.clearance > 0) add_describing_function(section, work);
  add_power(section);
  return section;
}

}  // namespace report
