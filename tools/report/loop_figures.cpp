// SPDX-License-Identifier: BSD-3-Clause
#include "report/loop_figures.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <cstdio>
#include <numbers>
#include <utility>

#include "backlash/loops/simulate_loop.hpp"
#include "backlash/loops/simulate_sampled_loop.hpp"
#include "report/grid.hpp"

namespace report {
namespace {

using Complex = std::complex<double>;
using backlash::SymmetricCycle;
constexpr double pi = std::numbers::pi;

constexpr const char* exact_colour = "#0072b2";
constexpr const char* predicted_colour = "#d55e00";

Complex rigid_loop(const backlash::ControlLoop& loop, double omega) {
  return loop.controller().response(omega) / ((loop.system().mass1() + loop.system().mass2()) * omega * omega);
}

// Where the rigid loop comes nearest to the size 1, rad/s: what to show of a loop that was looked at everywhere and has
// no cycle.
double crossover(const backlash::ControlLoop& loop) {
  // As wide as powers of both bodies' masses and their frequencies stay numbers; a hundred points to a decade.
  const std::vector<double> grid = logarithmic_grid(1e-100, 1e100, 20001);
  return *std::min_element(grid.begin(), grid.end(), [&loop](double a, double b) {
    return std::abs(std::log(std::abs(rigid_loop(loop, a)))) < std::abs(std::log(std::abs(rigid_loop(loop, b))));
  });
}

struct Points {
  std::vector<double> x, y;
  void add(double at_x, double at_y) {
    x.push_back(at_x);
    y.push_back(at_y);
  }
};

Curve curve_of(std::string label, std::string colour, Mark mark, const Points& points) {
  return make_curve(std::move(label), std::move(colour), mark, points.x, points.y);
}

std::vector<double> other_restitutions(double own) {
  std::vector<double> all;
  for (const double each : {0.2, 0.4, 0.6, 0.8}) {
    if (std::abs(each - own) > 0.05) all.push_back(each);
  }
  return all;
}

std::string rounded(double value) {
  std::string text = std::to_string(std::round(1000 * value) / 1000);
  text.erase(text.find_last_not_of('0') + 1);
  if (text.back() == '.') text.pop_back();
  return text;
}

// Frequency of the only mark of a kind, for the key, which has no room for more.
std::string frequency_of(const std::vector<double>& omega) {
  if (omega.size() != 1) return {};
  std::array<char, 32> number{};
  std::snprintf(number.data(), number.size(), ", %.3g rad/s", omega.front());
  return number.data();
}

}  // namespace

Figure nyquist_figure(const LoopPicture& picture, std::string name, std::string caption) {
  const double restitution = picture.loop.system().restitution();
  Points exact, other, predicted;
  std::vector<double> exact_at, predicted_at;
  for (const SymmetricCycle& cycle : picture.exact.cycles) {
    const Complex at = rigid_loop(picture.loop, cycle.omega);
    (cycle.admissible ? exact : other).add(at.real(), at.imag());
    if (cycle.admissible) exact_at.push_back(cycle.omega);
  }
  for (const backlash::PredictedCycle& cycle : picture.predicted) {
    // Asymmetric orbits have lines of their own.
    if (!cycle.symmetric || cycle.impacts != 2) continue;
    const Complex at = rigid_loop(picture.loop, cycle.omega);
    predicted.add(at.real(), at.imag());
    predicted_at.push_back(cycle.omega);
  }
  std::vector<double> marked = exact_at;
  marked.insert(marked.end(), predicted_at.begin(), predicted_at.end());
  const auto [lowest, highest] = std::minmax_element(marked.begin(), marked.end());
  const bool bounded = marked.empty() && !picture.exact.certain;
  const double middle = marked.empty() && !bounded ? crossover(picture.loop) : 0;
  const double from = bounded ? picture.exact.searched.from : marked.empty() ? middle / 10 : *lowest / 3;
  const double to = bounded ? picture.exact.searched.to : marked.empty() ? middle * 10 : *highest * 6;
  double top = 0;
  for (const Points* points : {&exact, &predicted}) {
    for (const double y : points->y) top = std::max(top, 2 * std::abs(y));
  }
  top = std::max(0.58, top);  // where the line of ε = 0.2 shows
  top = std::max(top, 1.6 * pi * (1 - restitution) / (4 * (1 + restitution)));
  Points loop;
  for (const double omega : logarithmic_grid(from, to, 600)) {
    const Complex at = rigid_loop(picture.loop, omega);
    loop.add(at.real(), at.imag());
  }
  // The axes hold the marks, and the loop as far as it is not above them.
  double left = 0, right = 0;
  const auto hold = [&](const Points& points) {
    for (std::size_t i = 0; i < points.x.size(); ++i) {
      if (std::abs(points.y[i]) > top) continue;
      left = std::min(left, points.x[i]);
      right = std::max(right, points.x[i]);
    }
  };
  for (const Points* points : {&exact, &predicted, &loop}) hold(*points);
  const double margin = std::max(0.05, 0.15 * (right - left));
  left -= margin;
  right += margin;
  // -1/nu ends there: the impacts are infinitely fast.
  constexpr double end = pi * pi / 8;
  Panel panel{"", {"real part (no unit)", false, left, right}, {"imaginary part (no unit)", false, -0.15 * top, top}};
  panel.key = true;
  const auto line = [&](double eps, const char* colour, Mark mark, const std::string& label) {
    const double height = pi * (1 - eps) / (4 * (1 + eps));
    panel.curves.push_back(make_curve(label, colour, mark, {left, std::clamp(end, left, right)}, {height, height}));
  };
  std::string others;
  for (const double eps : other_restitutions(restitution))
    others += (others.empty() ? "from above ε = " : ", ") + rounded(eps);
  for (const double eps : other_restitutions(restitution)) {
    line(eps, "#bbbbbb", Mark::line, others);
    others.clear();  // one entry of the key for all
  }
  line(restitution, "#000000", Mark::line, "−1/ν, ε = " + rounded(restitution));
  panel.curves.push_back(curve_of("C(jω)/((M_1 + M_2) ω^2)", "#009e73", Mark::line, loop));
  if (!predicted.x.empty()) {
    panel.curves.push_back(
        curve_of("predicted" + frequency_of(predicted_at), predicted_colour, Mark::open_points, predicted));
  }
  if (!exact.x.empty())
    panel.curves.push_back(curve_of("exact" + frequency_of(exact_at), exact_colour, Mark::points, exact));
  if (!other.x.empty()) panel.curves.push_back(curve_of("root, no motion", "#888888", Mark::faint_points, other));
  return {std::move(name), std::move(caption), {std::move(panel)}, 1, 360};
}

namespace {

// The sums of a cycle's harmonics over a period.
class Series {
 public:
  Series(const std::vector<backlash::CycleHarmonic>& harmonics, double omega) : harmonics_(harmonics), omega_(omega) {}

  [[nodiscard]] double at(std::complex<double> backlash::CycleHarmonic::*phasor, double share, bool is_rate) const {
    double sum = 0;
    for (const backlash::CycleHarmonic& harmonic : harmonics_) {
      const Complex turned = harmonic.*phasor * std::polar(1.0, 2 * pi * harmonic.order * share);
      // The weight takes the ripples off the rate, whose harmonics fall as slowly as its jumps ask for.
      const double angle = pi * harmonic.order / (harmonics_.back().order + 2);
      sum += is_rate ? -harmonic.order * omega_ * turned.imag() * std::sin(angle) / angle : turned.real();
    }
    return sum;
  }
  [[nodiscard]] double gap(double share, bool is_rate) const {
    return at(&backlash::CycleHarmonic::x2, share, is_rate) - at(&backlash::CycleHarmonic::x1, share, is_rate);
  }
  [[nodiscard]] double period() const { return 2 * pi / omega_; }

 private:
  const std::vector<backlash::CycleHarmonic>& harmonics_;
  double omega_;
};

constexpr int points_of_period = 600;

// mean1, mean2: what harmonics do not tell of the positions.
Figure figure_of(const Series& series, double mean1, double mean2, const Points& portrait, std::string name,
                 std::string caption) {
  Points x1, x2, force;
  for (int i = 0; i <= points_of_period; ++i) {
    const double share = static_cast<double>(i) / points_of_period;
    const double time = share * series.period();
    x1.add(time, mean1 + series.at(&backlash::CycleHarmonic::x1, share, false));
    x2.add(time, mean2 + series.at(&backlash::CycleHarmonic::x2, share, false));
    force.add(time, series.at(&backlash::CycleHarmonic::force, share, false));
  }
  Panel motion{"", {"t / s", false, 0.0, series.period()}, {"x / m"}};
  motion.key = true;
  motion.curves = {curve_of("x_1", exact_colour, Mark::line, x1), curve_of("x_2", predicted_colour, Mark::line, x2)};
  Panel drive{"", {"t / s", false, 0.0, series.period()}, {"force / N"}};
  drive.key = true;
  drive.curves = {curve_of("force", "#009e73", Mark::line, force)};
  Panel phase{"", {"(x_2 - x_1)/Δ", false, -0.55, 0.55}, {"(x_2 - x_1)' / (m/s)"}};
  phase.key = true;
  phase.curves = {
      curve_of("gap", exact_colour, Mark::line, portrait),
  };
  return {std::move(name), std::move(caption), {std::move(motion), std::move(drive), std::move(phase)}, 1, 220};
}

}  // namespace

Figure cycle_figure(const backlash::ControlLoop& loop, const SymmetricCycle& cycle, std::string name,
                    std::string caption) {
  const double clearance = loop.system().clearance();
  const Series series(cycle.harmonics, cycle.omega);
  Points portrait;
  // The harmonics of the rate do not converge next to the impacts, where both rates are known.
  constexpr int half = points_of_period / 2;
  constexpr int left_out = 8;
  for (const double side : {-1.0, 1.0}) {
    const int first = side < 0 ? 0 : half;
    portrait.add(-side * 0.5, side * loop.system().restitution() * cycle.impact_speed);
    for (int i = first + left_out; i <= first + half - left_out; ++i) {
      const double share = static_cast<double>(i) / points_of_period;
      portrait.add(series.gap(share, false) / clearance, series.gap(share, true));
    }
    portrait.add(side * 0.5, side * cycle.impact_speed);
  }
  portrait.add(0.5, -loop.system().restitution() * cycle.impact_speed);
  return figure_of(series, 0, 0, portrait, std::move(name), std::move(caption));
}

Figure cycle_figure(const backlash::CompliantLoop& loop, const backlash::CompliantCycle& cycle, std::string name,
                    std::string caption) {
  const Series series(cycle.harmonics, cycle.omega);
  // The mean positions of an asymmetric cycle are those that its meeting at t = 0 asks for.
  const double mean1 = cycle.start.x1 - series.at(&backlash::CycleHarmonic::x1, 0, false);
  const double mean2 = cycle.start.x2 - series.at(&backlash::CycleHarmonic::x2, 0, false);
  Points portrait;
  for (int i = 0; i <= points_of_period; ++i) {
    const double share = static_cast<double>(i) / points_of_period;
    portrait.add((mean2 - mean1 + series.gap(share, false)) / loop.bodies().system().clearance(),
                 series.gap(share, true));
  }
  Figure figure = figure_of(series, mean1, mean2, portrait, std::move(name), std::move(caption));
  // Bodies overlap as far as their contacts are soft.
  figure.panels.back().x.from = figure.panels.back().x.to = std::nullopt;
  return figure;
}

Figure start_figure(const backlash::ControlLoop& loop, const SymmetricCycle& cycle, std::string name,
                    std::string caption) {
  const double period = 2 * pi / cycle.omega;
  const double duration = 6 * period;
  const auto gap_of = [&](const std::vector<backlash::LoopRow>& rows) {
    Points gap;
    for (const backlash::LoopRow& row : rows) gap.add(row.time, (row.x2 - row.x1) / loop.system().clearance());
    return gap;
  };
  backlash::LoopSimulationOptions continuous;
  continuous.duration = duration;
  continuous.sample_time = period / 100;
  backlash::SampledLoopOptions sampled;
  sampled.duration = duration;
  sampled.sample_time = period / 50;
  sampled.velocity2 = cycle.impact_speed;
  const Points exact = gap_of(backlash::simulate_loop(loop, {0, 0, 0, cycle.impact_speed}, {}, continuous).rows);
  const Points held = gap_of(backlash::simulate_sampled_loop(loop, sampled).rows);
  Panel panel{"", {"t / s", false, 0.0, duration}, {"(x_2 - x_1)/Δ", false, -0.55, 0.55}};
  panel.key = true;
  panel.curves = {curve_of("continuous", exact_colour, Mark::line, exact),
                  curve_of("sampled", predicted_colour, Mark::line, held)};
  return {std::move(name), std::move(caption), {std::move(panel)}, 1, 260};
}

Figure frequencies_figure(const LoopFamilyPicture& family, std::string name, std::string caption) {
  Points stable, unstable, none, predicted, events;
  for (std::size_t i = 0; i < family.loops.size(); ++i) {
    for (const SymmetricCycle& cycle : family.loops[i].exact.cycles) {
      Points& points = !cycle.admissible ? none : cycle.stability.stable ? stable : unstable;
      points.add(family.values[i], cycle.omega);
    }
    for (const backlash::PredictedCycle& cycle : family.loops[i].predicted)
      predicted.add(family.values[i], cycle.omega);
  }
  for (const backlash::CycleEvent& event : family.events) {
    if (event.is_admissible) events.add(event.parameter, event.omega);
  }
  Panel panel{"", {family.quantity, false, family.values.front(), family.values.back()}, {"ω / (rad/s)", true}};
  panel.key = true;
  const auto add = [&](const char* label, const char* colour, Mark mark, const Points& points) {
    if (!points.x.empty()) panel.curves.push_back(curve_of(label, colour, mark, points));
  };
  add("root, no motion", "#999999", Mark::faint_points, none);
  add("describing function", predicted_colour, Mark::open_points, predicted);
  add("exact, unstable", "#cc79a7", Mark::points, unstable);
  add("exact, stable", exact_colour, Mark::points, stable);
  add("events", "#000000", Mark::open_points, events);
  return {std::move(name), std::move(caption), {std::move(panel)}, 1, 360};
}

}  // namespace report
