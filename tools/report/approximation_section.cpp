// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <complex>
#include <ctime>
#include <limits>
#include <numbers>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "frac/approximation/approximate.hpp"
#include "frac/digital/digital_filter.hpp"
#include "frac/identification/fit.hpp"
#include "frac/identification/model_library.hpp"
#include "report/bands.hpp"
#include "report/html.hpp"
#include "report/prose.hpp"
#include "report/ranking.hpp"
#include "report/sections.hpp"

namespace report {

namespace {

using Complex = std::complex<double>;

constexpr double order = 0.5;
constexpr frac::FrequencyBand band{1e-2, 1e2};
constexpr int drawn_poles = 9;

// H(j omega)/(j omega)^order on the band and half a decade beyond.
struct Deviation {
  std::vector<double> omega, decibels, degrees;
};
Deviation deviation_of(const frac::Approximation& approximation) {
  constexpr int points = 500;
  Deviation deviation;
  const double from = band.lower / 3;
  const double to = band.upper * 3;
  for (int i = 0; i <= points; ++i) {
    const double omega = from * std::pow(to / from, static_cast<double>(i) / points);
    const Complex exact = std::polar(std::pow(omega, order), order * std::numbers::pi / 2);
    const Complex ratio = approximation.system.response(omega) / exact;
    deviation.omega.push_back(omega);
    deviation.decibels.push_back(20 * std::log10(std::abs(ratio)));
    deviation.degrees.push_back(std::arg(ratio) * 180 / std::numbers::pi);
  }
  return deviation;
}

// One design, or none where the method has no design with so many poles.
std::vector<frac::Approximation> designed(frac::ApproximationMethod method, int poles) {
  try {
    return {frac::approximate(order, band, frac::PoleCount{poles}, method)};
  } catch (const std::invalid_argument&) {
    return {};
  }
}

// Processor time of this thread, so that other work of the machine does not count.
double processor_seconds() {
  timespec now{};
  ::clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

struct Timed {
  frac::Approximation approximation;
  double design_seconds;  // of one design
  // Error of the recursion by the bilinear rule.  NaN if there are complex pairs.
  double seconds_per_sample;
};

double running_seconds(const frac::ZeroPoleGain& system) {
  if (!system.pole_pairs.empty() || !system.zero_pairs.empty()) return std::numeric_limits<double>::quiet_NaN();
  constexpr double sample_time = 0.1 / band.upper;
  constexpr std::size_t samples = 8192;
  frac::DigitalFilterDesign design;
  design.sample_time = sample_time;
  design.sections = frac::discretise(system, sample_time).parallel;
  frac::DigitalFilter<double> filter(design);
  std::vector<double> signal(samples);
  for (std::size_t n = 0; n < samples; ++n) signal[n] = std::sin(0.01 * static_cast<double>(n));
  std::vector<double> seconds;
  for (int repeat = 0; repeat < 5; ++repeat) {
    const double start = processor_seconds();
    filter.run(signal, signal);
    seconds.push_back((processor_seconds() - start) / static_cast<double>(samples));
  }
  std::nth_element(seconds.begin(), seconds.begin() + 2, seconds.end());
  return seconds[2];
}

std::vector<std::vector<Timed>> families() {
  std::vector<std::vector<Timed>> all;
  for (const frac::ApproximationMethod method : frac::approximation_methods()) {
    std::vector<Timed>& family = all.emplace_back();
    for (int poles = 1; poles <= 33; poles += 2) {
      const double start = processor_seconds();
      std::vector<frac::Approximation> design = designed(method, poles);
      const double seconds = processor_seconds() - start;
      if (design.empty()) continue;
      const double running = running_seconds(design[0].system);
      family.push_back({std::move(design[0]), seconds, running});
    }
  }
  return all;
}

// There are eight methods and seven colours that can be told apart, so the last method is grey.
std::string method_colour(frac::ApproximationMethod method) {
  const auto all = frac::approximation_methods();
  const auto index = static_cast<std::size_t>(std::find(all.begin(), all.end(), method) - all.begin());
  return index + 1 < all.size() ? category_colour(index) : "#999999";
}

Figure bode_error_figure(const std::string& name, const std::string& caption,
                         std::span<const frac::ApproximationMethod> methods, double decibels, double degrees) {
  Figure figure;
  figure.name = name;
  figure.caption = caption;
  Panel level, phase;
  level.title = "Magnitude error";
  phase.title = "Phase error";
  for (Panel* panel : {&level, &phase}) panel->x = {"ω in rad/s", true, band.lower / 3, band.upper * 3};
  level.y = {"dB", false, -decibels, decibels};
  phase.y = {"degrees", false, -degrees, degrees, true};
  level.key = methods.size() > 1;
  static constexpr Mark marks[] = {Mark::line, Mark::dashed, Mark::dotted};
  std::size_t drawn = 0;
  for (const frac::ApproximationMethod method : methods) {
    for (const frac::Approximation& approximation : designed(method, drawn_poles)) {
      const Deviation deviation = deviation_of(approximation);
      const std::string label(frac::to_string(method));
      const Mark mark = marks[drawn++ % 3];
      level.curves.push_back(make_curve(label, method_colour(method), mark, deviation.omega, deviation.decibels));
      phase.curves.push_back(make_curve(label, method_colour(method), mark, deviation.omega, deviation.degrees));
    }
  }
  figure.panels = {std::move(level), std::move(phase)};
  return figure;
}

void add_families(Panel& panel, const std::vector<std::vector<Timed>>& all, double (*abscissa)(const Timed&)) {
  for (const auto& family : all) {
    std::vector<double> x, y;
    for (const Timed& each : family) {
      if (!std::isfinite(abscissa(each))) continue;
      x.push_back(abscissa(each));
      y.push_back(each.approximation.error.max_relative);
    }
    if (x.empty()) continue;
    const frac::ApproximationMethod method = family[0].approximation.method;
    const Mark mark = method == frac::ApproximationMethod::carlson ? Mark::open_points : Mark::line_points;
    panel.curves.push_back(make_curve(std::string(frac::to_string(method)), method_colour(method), mark, x, y));
  }
}

Figure error_against_poles_figure(const std::vector<std::vector<Timed>>& all) {
  Figure figure;
  figure.name = "approximation-error-poles";
  figure.caption = prose("approximation", "error-poles");
  Panel panel{"", {"poles", false, 0.0, {}}, {"largest relative error on the band", true, 1e-11, 10.0}};
  panel.key = true;
  std::vector<double> poles, limit;
  for (int n = 1; n <= 34; ++n) {
    poles.push_back(n);
    const double width = std::log(band.upper / band.lower) + 4 * std::numbers::ln2;
    limit.push_back(2 * std::sin(std::numbers::pi * order) *
                    std::exp(-std::numbers::pi * std::numbers::pi * n / width));
  }
  panel.curves.push_back(make_curve("attainable", "#000000", Mark::dashed, poles, limit));
  add_families(panel, all, [](const Timed& each) { return static_cast<double>(each.approximation.poles); });
  figure.panels = {std::move(panel)};
  figure.panel_height = 380;
  return figure;
}

Figure work_precision_figure(const std::vector<std::vector<Timed>>& all) {
  Figure figure;
  figure.name = "approximation-work-precision";
  figure.caption = prose("approximation", "work-precision");
  Panel panel{"", {"milliseconds for one design", true}, {"largest relative error on the band", true, 1e-11, 10.0}};
  panel.key = true;
  add_families(panel, all, [](const Timed& each) { return 1e3 * each.design_seconds; });
  figure.panels = {std::move(panel)};
  figure.panel_height = 380;
  return figure;
}

Table methods_table(const std::vector<std::vector<Timed>>& all) {
  Table table;
  table.name = "approximation-methods";
  table.caption = prose("approximation", "methods");
  table.columns = {{"method", "method"},
                   {"poles", "poles"},
                   {"max_relative_error", "relative error"},
                   {"max_error_db", "dB"},
                   {"max_error_deg", "degrees"},
                   {"limit_poles", "poles the limit needs"},
                   {"design_ms", "design, ms", 2},
                   {"ns_per_sample", "ns per sample", 2}};
  table.rows_on_page = 40;
  for (const auto& family : all) {
    for (const auto& [each, design_seconds, seconds_per_sample] : family) {
      if (each.poles != 5 && each.poles != 9 && each.poles != 13 && each.poles != 21 && each.poles != 29) continue;
      table.rows.push_back({std::string(frac::to_string(each.method)), static_cast<double>(each.poles),
                            each.error.max_relative, each.error.max_decibels, each.error.max_degrees,
                            static_cast<double>(each.limit_poles), 1e3 * design_seconds, 1e9 * seconds_per_sample});
    }
  }
  return table;
}

// The power law of the chatter band, fitted through several realisations of s^a.
Table realisation_table(const frac::FrequencyResponseData& data, int threads) {
  Table table{"realisations",
              prose("approximation", "realisations"),
              {{"realisation", "realisation"},
               {"order", "order a", 6},
               {"coefficient", "K", 6},
               {"rms_relative", "rms relative residual", 3},
               {"remark", "remark"}}};
  const double lowest = data.omega().front();
  const double highest = data.omega().back();
  const double sample_time = std::numbers::pi / (10 * highest);
  const std::pair<std::string, frac::Realisation> realisations[] = {
      {"exact (jω)^a", frac::ExactRealisation{}},
      {"Oustaloup, band of the data, 4 poles", frac::OustaloupRealisation{{lowest, highest}, 4}},
      {"Oustaloup, one decade wider at both ends, 4 poles", frac::OustaloupRealisation{{lowest / 10, highest * 10}, 4}},
      {"Oustaloup, one decade wider at both ends, 12 poles",
       frac::OustaloupRealisation{{lowest / 10, highest * 10}, 12}},
      {"Grünwald-Letnikov, 20 samples per shortest period, all kept",
       frac::GrunwaldLetnikovRealisation{sample_time, 0}},
      {"Grünwald-Letnikov, 20 samples per shortest period, last 200 kept",
       frac::GrunwaldLetnikovRealisation{sample_time, 200}},
  };
  const frac::NamedModel model = frac::find_model("power-law");
  std::vector<std::optional<frac::FitResult>> fits(std::size(realisations));
  frac::parallel_for(fits.size(), threads, [&](std::size_t i) {
    frac::FitOptions options;
    options.component = frac::Component::imaginary;
    options.weight = frac::Weight::given;
    options.realisation = realisations[i].second;
    options.constraints = model.constraints;
    fits[i] = frac::fit(data, frac::Structure(model.formula), options);
  });
  for (std::size_t i = 0; i < fits.size(); ++i) {
    const frac::FitResult& fit = *fits[i];
    const auto* exponent = find_parameter(fit, "a");
    const auto* coefficient = find_parameter(fit, "K");
    std::string note = remark(*exponent);
    if (fit.termination != frac::FitTermination::converged) note += (note.empty() ? "" : "; ") + fit.message;
    table.rows.push_back({realisations[i].first, exponent->value, coefficient->value, fit.rms, note});
  }
  return table;
}

}  // namespace

Section approximation_section(const Work& work, const Bands& bands) {
  Section section = open_section("approximation");
  const std::vector<std::vector<Timed>> all = families();
  const std::string poles = std::to_string(drawn_poles);
  section.add(bode_error_figure("approximation-bode-error", prose("approximation", "bode-error", {{"poles", poles}}),
                                frac::approximation_methods(), 2, 30));
  static constexpr frac::ApproximationMethod ladder_alone[] = {frac::ApproximationMethod::ladder};
  section.add(bode_error_figure("approximation-ladder-error",
                                prose("approximation", "ladder-error", {{"poles", poles}}), ladder_alone, 0.015, 0.1));
  section.add(error_against_poles_figure(all));
  section.add(work_precision_figure(all));
  section.add(methods_table(all));
  if (!bands.chatter.empty()) section.add(realisation_table(relative_imaginary_data(bands.chatter), work.threads));
  const auto error_of = [](frac::ApproximationMethod method) {
    return designed(method, drawn_poles).at(0).error.max_relative;
  };
  const double ladder = error_of(frac::ApproximationMethod::ladder);
  const double oustaloup = error_of(frac::ApproximationMethod::oustaloup);
  section.finding(
      prose("approximation", "finding",
            {{"poles", poles}, {"ladder", html_number(ladder, 2)}, {"oustaloup", html_number(oustaloup, 2)}}));
  section.facts = {{"ladder_error_9_poles", ladder}, {"oustaloup_error_9_poles", oustaloup}};
  return section;
}

}  // namespace report
