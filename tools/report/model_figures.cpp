// SPDX-License-Identifier: BSD-3-Clause
#include "report/model_figures.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <numbers>
#include <utility>

#include "frac/stability.hpp"
#include "frac/time_response/response_methods.hpp"
#include "report/grid.hpp"
#include "report/html.hpp"
#include "report/prose.hpp"

namespace report {
namespace {

using frac::FractionalTransferFunction;

// Frequencies at which the model changes its slope: where two terms of a sum are equal, and the poles.
std::pair<double, double> corner_range(const FractionalTransferFunction& model, const std::vector<frac::Pole>& poles) {
  double lowest = std::numeric_limits<double>::infinity();
  double highest = 0;
  const auto widen = [&](double omega) {
    if (!(omega > 0 && std::isfinite(omega))) return;
    lowest = std::min(lowest, omega);
    highest = std::max(highest, omega);
  };
  for (const auto* terms : {&model.numerator(), &model.denominator()}) {
    for (std::size_t i = 0; i + 1 < terms->size(); ++i) {
      const auto& [higher, order] = (*terms)[i];
      const auto& [lower, lower_order] = (*terms)[i + 1];
      widen(std::pow(std::abs(lower / higher), 1 / (order - lower_order)));
    }
  }
  for (const frac::Pole& pole : poles) widen(std::abs(pole.value));
  if (model.delay() > 0) widen(1 / model.delay());
  if (highest == 0) return {1, 1};
  return {lowest, highest};
}

// A dense grid with more points near every lightly damped pole.
std::vector<double> frequencies(const FractionalTransferFunction& model, const std::vector<frac::Pole>& poles) {
  const auto [lowest, highest] = corner_range(model, poles);
  std::vector<double> omega = logarithmic_grid(lowest / 100, highest * 100, 1200);
  for (const frac::Pole& pole : poles) {
    const double at = std::abs(pole.value);
    const double width = std::abs(pole.value.real()) / at;
    for (int k = -200; k <= 200; ++k) omega.push_back(at * std::exp(0.03 * k * std::max(width, 1e-4)));
  }
  std::sort(omega.begin(), omega.end());
  omega.erase(std::unique(omega.begin(), omega.end()), omega.end());
  return omega;
}

struct Response {
  std::vector<double> omega, re, im, decibel;
  std::vector<double> degrees;  // phase, without jumps of 360
};

Response response_of(const FractionalTransferFunction& model, const std::vector<frac::Pole>& poles) {
  Response result;
  double turns = 0;
  double before = std::nan("");
  for (const double omega : frequencies(model, poles)) {
    const std::complex<double> value = model.response(omega);
    if (!std::isfinite(value.real()) || !std::isfinite(value.imag())) continue;
    double phase = std::arg(value) * 180 / std::numbers::pi;
    if (!std::isnan(before)) {
      while (phase + turns - before > 180) turns -= 360;
      while (phase + turns - before < -180) turns += 360;
    }
    phase += turns;
    before = phase;
    result.omega.push_back(omega);
    result.re.push_back(value.real());
    result.im.push_back(value.imag());
    result.decibel.push_back(20 * std::log10(std::abs(value)));
    result.degrees.push_back(phase);
  }
  return result;
}

// Long enough for the slowest mode to decay by six e-folds, but at most two decades beyond the lowest corner.
double step_length(const FractionalTransferFunction& model, const std::vector<frac::Pole>& poles) {
  const auto [lowest, highest] = corner_range(model, poles);
  double length = 10 / lowest;
  for (const frac::Pole& pole : poles) {
    if (pole.cancelled) continue;
    const double decay = -pole.value.real();
    // Shows four e-folds of a growing response.
    length = decay > 0 ? std::max(length, std::min(6 / decay, 100 / lowest)) : std::min(length, -4 / decay);
  }
  return length + model.delay();
}

Figure figure_of(const std::string& name, std::string caption, std::vector<Panel> panels, int height) {
  return {name, std::move(caption), std::move(panels), 1, height};
}

Panel plain_panel(const std::string& title, Axis x, Axis y, Curve curve) {
  Panel panel{title, std::move(x), std::move(y)};
  panel.curves.push_back(std::move(curve));
  return panel;
}

Curve reference_point(double x, double y) {
  return make_curve("", "#555555", Mark::points, {x}, {y});
}

// Axes with one scale for real and imaginary part.  They hold the part of the curve that is no larger than ten times
// its value in the middle of the frequencies, because an integrator runs off to infinity.
std::pair<Axis, Axis> equal_axes(const Response& response, int height) {
  const std::size_t middle = response.omega.size() / 2;
  const double limit = 10 * std::max(1.0, std::hypot(response.re[middle], response.im[middle]));
  double left = -1, right = 0, top = 0;
  for (std::size_t i = 0; i < response.omega.size(); ++i) {
    left = std::min(left, std::max(response.re[i], -limit));
    right = std::max(right, std::min(response.re[i], limit));
    top = std::max(top, std::min(std::abs(response.im[i]), limit));
  }
  // The axes box is about 870 px wide.
  const double shape = 870.0 / height;
  const double half = 1.05 * std::max(top, (right - left) / 2 / shape);
  const double centre = (left + right) / 2;
  return {{"Re G", false, centre - half * shape, centre + half * shape}, {"Im G", false, -half, half}};
}

}  // namespace

std::vector<Figure> model_figures(const FractionalTransferFunction& model, const std::string& name) {
  const std::vector<frac::Pole> poles = frac::analyse_stability(model).poles;
  const Response response = response_of(model, poles);
  const std::string colour = category_colour(0);
  const std::string formula = html_formula(model.formula());
  const Axis omega{"{/Symbol w} / (rad/s)", true, response.omega.front(), response.omega.back()};
  std::vector<Figure> figures;
  figures.push_back(figure_of(name + "-bode", prose("model", "bode", {{"model", formula}}),
                              {plain_panel("Magnitude", omega, {"|G| / dB"},
                                           make_curve("", colour, Mark::line, response.omega, response.decibel)),
                               plain_panel("Phase", omega, {.label = "arg G / degrees", .degrees = true},
                                           make_curve("", colour, Mark::line, response.omega, response.degrees))},
                              220));

  constexpr int square_height = 480;
  const auto [real_axis, imaginary_axis] = equal_axes(response, square_height);
  Panel nyquist = plain_panel("Nyquist diagram", real_axis, imaginary_axis,
                              make_curve("", colour, Mark::line, response.re, response.im));
  std::vector<double> mirrored = response.im;
  for (double& value : mirrored) value = -value;
  nyquist.curves.push_back(make_curve("", colour, Mark::dotted, response.re, mirrored));
  nyquist.curves.push_back(reference_point(-1, 0));
  figures.push_back(figure_of(name + "-nyquist", prose("model", "nyquist", {{"model", formula}}), {std::move(nyquist)},
                              square_height));

  Panel nichols = plain_panel("Nichols diagram", {.label = "arg G / degrees", .degrees = true}, {"|G| / dB"},
                              make_curve("", colour, Mark::line, response.degrees, response.decibel));
  nichols.curves.push_back(reference_point(-180, 0));
  figures.push_back(
      figure_of(name + "-nichols", prose("model", "nichols", {{"model", formula}}), {std::move(nichols)}, 340));

  const double length = step_length(model, poles);
  std::vector<double> time;
  constexpr std::size_t instants = 601;
  for (std::size_t i = 0; i < instants; ++i) {
    time.push_back(length * static_cast<double>(i) / static_cast<double>(instants - 1));
  }
  // The step response of an improper model is infinite at t = 0.
  if (model.numerator().front().order > model.denominator().front().order) time.erase(time.begin());
  const frac::TimeResponse step = frac::respond(model, frac::ResponseInput{}, time, 1e-6);
  figures.push_back(figure_of(name + "-step", prose("model", "step", {{"model", formula}}),
                              {plain_panel("Step response", {"t / s", false, 0.0, length}, {"y"},
                                           make_curve("", colour, Mark::line, time, step.output))},
                              240));
  return figures;
}

}  // namespace report
