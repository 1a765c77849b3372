// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <random>
#include <utility>

#include "frac/identification/time_fit.hpp"
#include "frac/time_response/reference_response.hpp"
#include "frac/time_response/response_methods.hpp"
#include "io/number.hpp"
#include "report/html.hpp"
#include "report/model_figures.hpp"
#include "report/prose.hpp"
#include "report/sections.hpp"
#include "report/timing.hpp"

namespace report {
namespace {

using frac::FractionalTransferFunction;
using frac::ResponseMethod;

struct System {
  const char* name;
  const char* formula;
};
// The reference systems of data/reference/step_systems.csv and two more.
constexpr System systems[] = {
    {"relaxation of order 0.5", "1/(s^0.5 + 1)"},
    {"relaxation of order 0.8", "1/(s^0.8 + 1)"},
    {"oscillation of order 1.5", "1/(s^1.5 + 1)"},
    {"commensurate", "1/(s^1.8 + 0.4 s^0.9 + 1)"},
    {"Bagley-Torvik", "1/(s^2 + s^1.5 + 1)"},
    {"five terms", "(-2 s^0.63 + 4)/(2 s^3.501 + 3.8 s^2.42 + 2.6 s^1.798 + 2.5 s^1.31 + 1.5)"},
    {"lead", "(s^0.5 + 0.5)/(s + 0.2 s^0.5 + 2)"},
    {"furnace", "1/(0.8 s^2.2 + 0.5 s^0.9 + 1)"},
    {"pole beside the cut", "1/(s^0.99 + 1)"}};
constexpr const char* furnace = systems[7].formula;

constexpr double horizon = 10;  // s
constexpr std::size_t coarsest = 125;

// Compares a response with exact values at instants that all grids share.
struct Judge {
  explicit Judge(const FractionalTransferFunction& model) {
    const frac::ReferenceResponse reference(model);
    for (std::size_t i = 1; i <= coarsest; i = i < 8 ? i + 1 : i + i / 4) {
      index.push_back(i);
      exact.push_back(reference(horizon * static_cast<double>(i) / static_cast<double>(coarsest)).value);
      largest = std::max(largest, std::abs(exact.back()));
    }
  }
  // Largest error over the largest value; `steps` a multiple of the coarsest.
  [[nodiscard]] double operator()(const std::vector<double>& output, std::size_t steps) const {
    double error = 0;
    for (std::size_t i = 0; i < index.size(); ++i) {
      error = std::max(error, std::abs(output[index[i] * (steps / coarsest)] - exact[i]));
    }
    return error / largest;
  }
  std::vector<std::size_t> index;
  std::vector<double> exact;
  double largest = 0;
};

struct Setting {
  std::string text;
  std::size_t steps;
  std::function<std::vector<double>(const FractionalTransferFunction&, std::size_t)> run;
};
struct Method {
  const char* name;
  std::vector<Setting> settings;
};

std::vector<Method> methods() {
  const auto ones = [](std::size_t steps) { return std::vector<double>(steps + 1, 1.0); };
  const auto step_of = [](std::size_t steps) { return horizon / static_cast<double>(steps); };
  std::vector<Method> all{
      {"Grünwald-Letnikov", {}}, {"BDF2", {}}, {"ladder", {}}, {"sum of exponentials", {}}, {"reference", {}}};
  for (std::size_t steps = coarsest; steps <= 16 * coarsest; steps *= 2) {
    const std::string text = std::to_string(steps) + " steps";
    all[0].settings.push_back({text, steps, [=](const FractionalTransferFunction& model, std::size_t n) {
                                 return frac::respond_grunwald_letnikov(model, ones(n), step_of(n));
                               }});
    all[1].settings.push_back({text, steps, [=](const FractionalTransferFunction& model, std::size_t n) {
                                 return frac::respond_bdf2(model, ones(n), step_of(n));
                               }});
  }
  constexpr std::size_t steps = 8 * coarsest;
  for (const double tolerance : {1e-2, 1e-4, 1e-6, 1e-8}) {
    all[2].settings.push_back({"1000 steps, tolerance " + io::format_number(tolerance), steps,
                               [=](const FractionalTransferFunction& model, std::size_t n) {
                                 return frac::respond_ladder(model, ones(n), step_of(n), tolerance);
                               }});
  }
  for (const double tolerance : {1e-3, 1e-6, 1e-9, 1e-12}) {
    all[3].settings.push_back({"1000 steps, tolerance " + io::format_number(tolerance), steps,
                               [=](const FractionalTransferFunction& model, std::size_t n) {
                                 return frac::respond(model, ones(n), step_of(n), tolerance);
                               }});
  }
  all[4].settings.push_back({"125 instants", coarsest, [=](const FractionalTransferFunction& model, std::size_t n) {
                               const frac::ReferenceResponse reference(model);
                               std::vector<double> output;
                               for (std::size_t i = 0; i <= n; ++i) {
                                 output.push_back(reference(step_of(n) * static_cast<double>(i)).value);
                               }
                               return output;
                             }});
  return all;
}

}  // namespace

namespace {

// 301 samples of the furnace's step response, exact and with noise, fitted over time from s^2 + s + 1.
void add_time_fit(Section& section) {
  constexpr std::size_t samples = 301;
  std::vector<double> time, exact;
  const frac::ReferenceResponse reference(FractionalTransferFunction::parse(furnace));
  for (std::size_t i = 0; i < samples; ++i) {
    time.push_back(0.05 * static_cast<double>(i));
    exact.push_back(reference(time.back()).value);
  }
  const frac::Structure structure("1/(a2 s^q2 + a1 s^q1 + 1)");
  frac::TimeFitOptions options;
  options.constraints = {
      {"a2", {}, {}, {}, 1.0}, {"q2", {}, {}, {}, 2.0}, {"a1", {}, {}, {}, 1.0}, {"q1", {}, {}, {}, 1.0}};
  Table table{"furnace-time-fit",
              prose("fractional-model", "time-fit"),
              {{"noise", "noise", 2},
               {"parameter", "parameter"},
               {"true_value", "true value"},
               {"estimate", "estimate", 8},
               {"half_width", "± 95 %", 2}}};
  const double truth[] = {0.8, 2.2, 0.5, 0.9, 0};
  for (const double noise : {0.0, 0.01, 0.05}) {
    std::mt19937_64 generator(1);
    std::vector<double> output = exact;
    for (double& value : output) {
      // The sum of twelve uniform draws less 6 has mean 0 and variance 1, and is the same on every machine.
      double draw = -6;
      for (int i = 0; i < 12; ++i) draw += static_cast<double>(generator() >> 11) * 0x1p-53;
      value += noise * draw;
    }
    const frac::FitResult fit =
        frac::fit(frac::TimeResponseData(time, std::vector<double>(samples, 1.0), output), structure, options);
    for (std::size_t i = 0; i < fit.parameters.size(); ++i) {
      const frac::ParameterEstimate& estimate = fit.parameters[i];
      table.rows.push_back(
          {noise, estimate.name, truth[i], estimate.value, (estimate.ci95_upper - estimate.ci95_lower) / 2});
    }
    if (noise > 0) continue;
    const double worst = std::max(std::abs(fit.parameters[1].value - 2.2), std::abs(fit.parameters[3].value - 0.9));
    section.finding(prose("fractional-model", "finding",
                          {{"worst", html_number(worst, 1)}, {"seconds", html_seconds(fit.seconds)}}));
    section.fact("furnace_time_fit_order_error", worst);
  }
  section.add(Html{prose("fractional-model", "time-fit-heading")});
  section.add(std::move(table));
}

}  // namespace

Section model_section() {
  Section section = open_section("fractional-model");
  for (Figure& figure : model_figures(FractionalTransferFunction::parse(furnace), "furnace")) {
    section.add(std::move(figure));
  }
  add_time_fit(section);
  return section;
}

Section response_speed_section() {
  Section section = open_section("response-speed");
  Table table{"response-speed",
              prose("response-speed", "table"),
              {{"system", "system"},
               {"model", "model", 4, true, true},
               {"method", "method"},
               {"setting", "setting"},
               {"relative_error", "relative error", 2},
               {"seconds", "seconds", 2}}};
  table.rows_on_page = 24;
  Figure figure;
  figure.name = "response-speed";
  figure.caption = prose("response-speed", "figure");
  figure.columns = 2;
  figure.panel_height = 200;
  double furnace_fast = std::nan(""), furnace_fast_error = std::nan("");
  double furnace_slow = std::nan(""), furnace_slow_error = std::nan("");
  for (const System& system : systems) {
    const auto model = FractionalTransferFunction::parse(system.formula);
    const Judge judge(model);
    Panel panel{system.name, {"seconds", true, 1e-5, 1.0}, {"relative error", true, 1e-16, 1.0}};
    panel.key = figure.panels.size() == 1;
    std::size_t colour = 0;
    for (const Method& method : methods()) {
      std::vector<double> error, time;
      for (const Setting& setting : method.settings) {
        std::vector<double> output;
        const double seconds = median_seconds([&] { output = setting.run(model, setting.steps); });
        error.push_back(judge(output, setting.steps));
        time.push_back(seconds);
        table.rows.push_back({std::string(system.name), std::string(system.formula), std::string(method.name),
                              setting.text, error.back(), seconds});
        error.back() = std::max(error.back(), std::numeric_limits<double>::epsilon());
      }
      if (system.formula == furnace && colour == 0) {
        furnace_slow = time.back();
        furnace_slow_error = error.back();
      }
      if (system.formula == furnace && colour == 3) {
        furnace_fast = time.back();
        furnace_fast_error = error.back();
      }
      panel.curves.push_back(
          make_curve(panel.key ? method.name : "", category_colour(colour++), Mark::line_points, time, error));
    }
    figure.panels.push_back(std::move(panel));
  }
  section.finding(prose("response-speed", "finding",
                        {{"fast", html_seconds(furnace_fast)},
                         {"fast_error", html_number(furnace_fast_error, 1)},
                         {"slow", html_seconds(furnace_slow)},
                         {"slow_error", html_number(furnace_slow_error, 1)}}));
  section.facts = {{"furnace_exponential_sum_seconds", furnace_fast},
                   {"furnace_exponential_sum_error", furnace_fast_error},
                   {"furnace_grunwald_letnikov_seconds", furnace_slow},
                   {"furnace_grunwald_letnikov_error", furnace_slow_error}};
  section.add(std::move(figure));
  section.add(std::move(table));
  return section;
}

}  // namespace report
