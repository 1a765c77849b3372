// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "frac/identification/statistics.hpp"
#include "frac/identification/uncertainty.hpp"
#include "report/html.hpp"
#include "report/measured.hpp"
#include "report/prose.hpp"
#include "report/sections.hpp"
#include "report/sweep_curves.hpp"

namespace report {

namespace {

frac::FrequencyResponseData thinned(const frac::FrequencyResponseData& data) {
  std::vector<double> omega, sigma;
  std::vector<std::complex<double>> value;
  for (const std::size_t i : evenly_chosen(data.size())) {
    omega.push_back(data.omega()[i]);
    value.push_back(data.value()[i]);
    if (!data.sigma().empty()) sigma.push_back(data.sigma()[i]);
  }
  return {std::move(omega), std::move(value), std::move(sigma)};
}

// Phase in degrees without jumps, on the turn nearest to `first`.
std::vector<double> unwrapped_phase(const std::vector<std::complex<double>>& values, double first) {
  std::vector<double> phase;
  for (const auto& value : values) {
    const double before = phase.empty() ? first : phase.back();
    const double degrees = phase_degrees(value);
    phase.push_back(degrees + 360 * std::round((before - degrees) / 360));
  }
  return phase;
}

std::vector<double> decibels(const std::vector<std::complex<double>>& values) {
  std::vector<double> level;
  for (const auto& value : values) level.push_back(value == 0.0 ? std::nan("") : decibel(value));
  return level;
}

// Half widths of the 95 % band of a fitted curve.
struct Band {
  std::vector<double> decibel, degrees;  // of magnitude and phase
  std::vector<double> magnitude, phase;  // in % of the magnitude and in 1/100 rad
};

Band band_of(const frac::FitResult& fit, const std::vector<double>& omega) {
  const double t = frac::student_t_95(static_cast<double>(fit.residuals) - static_cast<double>(fit.free_parameters));
  Band band;
  for (const auto& deviation : frac::response_deviation(fit, frac::ExactRealisation{}, omega)) {
    band.decibel.push_back(t * deviation.log_magnitude * 20 / std::numbers::ln10);
    band.degrees.push_back(t * deviation.phase * 180 / std::numbers::pi);
    band.magnitude.push_back(100 * t * deviation.log_magnitude);
    band.phase.push_back(100 * t * deviation.phase);
  }
  return band;
}

Curve band_round(const std::string& label, const std::string& colour, const std::vector<double>& omega,
                 const std::vector<double>& middle, const std::vector<double>& half_width) {
  std::vector<double> lower, upper;
  for (std::size_t i = 0; i < omega.size(); ++i) {
    lower.push_back(middle[i] - half_width[i]);
    upper.push_back(middle[i] + half_width[i]);
  }
  return make_band(label, colour, omega, lower, upper);
}

// Shows data/model - 1 of the chosen structure.  To first order its real part is the relative error of the magnitude
// and its imaginary part the error of the phase in rad.
Figure residual_figure(const std::string& name, const frac::FrequencyResponseData& data,
                       const frac::RankedFit& chosen) {
  const std::vector<double>& omega = data.omega();
  const auto model = frac::fitted_response(chosen.fit, frac::ExactRealisation{}, omega);
  const Band band = band_of(chosen.fit, omega);
  std::vector<double> magnitude, phase;
  for (std::size_t i = 0; i < omega.size(); ++i) {
    const std::complex<double> error = 100.0 * (data.value()[i] / model[i] - 1.0);
    magnitude.push_back(error.real());
    phase.push_back(error.imag());
  }
  const std::vector<double> zero(omega.size(), 0.0);
  const auto panel = [&](const char* title, const char* axis, const std::vector<double>& error,
                         const std::vector<double>& half_width) {
    Panel drawn;
    drawn.title = title;
    drawn.x = {"ω in rad/s", true, {}, {}};
    drawn.y = {axis, false, {}, {}};
    drawn.curves.push_back(band_round("95 % band of the fit", category_colour(0), omega, zero, half_width));
    drawn.curves.push_back(make_curve("", category_colour(0), Mark::line, omega, zero));
    drawn.curves.push_back(make_curve("data", "#222222", Mark::open_points, omega, error));
    return drawn;
  };
  Figure figure;
  figure.name = name + "-residuals";
  figure.caption = prose("data", "residuals", {{"model", escape_html(chosen.name)}});
  figure.columns = 2;
  figure.panel_height = 220;
  figure.panels = {panel("Magnitude", "|data|/|model| − 1 in %", magnitude, band.magnitude),
                   panel("Phase", "data − model in 1/100 rad", phase, band.phase)};
  figure.panels.back().key = true;
  return figure;
}

Figure data_figure(const std::string& name, const std::string& caption, const frac::FrequencyResponseData& data,
                   const frac::IdentificationResult& result, const std::string& unit) {
  Panel magnitude, phase, residual;
  magnitude.title = "Magnitude";
  phase.title = "Phase";
  residual.title = "Distance of the fits from the data";
  magnitude.x = phase.x = residual.x = {"ω in rad/s", true, {}, {}};
  magnitude.y = {"dB re 1 " + enhanced_escape(unit.empty() ? "unit of the file" : unit), false, {}, {}};
  phase.y = {"degrees", false, {}, {}};
  residual.y = {"|model − data| / |data| in %", true, {}, {}};
  magnitude.key = true;
  const std::vector<double>& omega = data.omega();
  const std::vector<double> measured_phase = unwrapped_phase(data.value(), 0);
  for (const DrawnFit& drawn : drawn_fits(result)) {
    const auto model = frac::fitted_response(drawn.ranked.fit, frac::ExactRealisation{}, omega);
    std::vector<double> distance;
    for (std::size_t k = 0; k < omega.size(); ++k) {
      const double relative = 100 * std::abs(model[k] - data.value()[k]) / std::abs(data.value()[k]);
      distance.push_back(relative > 0 && std::isfinite(relative) ? relative : std::nan(""));
    }
    magnitude.curves.push_back(make_curve(drawn.label, drawn.colour, drawn.mark, omega, decibels(model)));
    phase.curves.push_back(
        make_curve("", drawn.colour, drawn.mark, omega, unwrapped_phase(model, measured_phase.front())));
    residual.curves.push_back(make_curve("", drawn.colour, drawn.mark, omega, distance));
  }
  const frac::RankedFit& chosen = result.ranking.at(result.chosen);
  const Band band = band_of(chosen.fit, omega);
  const auto model = frac::fitted_response(chosen.fit, frac::ExactRealisation{}, omega);
  const std::vector<double> model_phase = unwrapped_phase(model, measured_phase.front());
  // The bands are drawn first, so that they lie below all curves.
  magnitude.curves.insert(magnitude.curves.begin(), band_round("95 % band of " + enhanced_escape(chosen.name),
                                                               "#888888", omega, decibels(model), band.decibel));
  phase.curves.insert(phase.curves.begin(), band_round("", "#888888", omega, model_phase, band.degrees));
  magnitude.curves.push_back(make_curve("data", "#222222", Mark::open_points, omega, decibels(data.value())));
  phase.curves.push_back(make_curve("", "#222222", Mark::open_points, omega, measured_phase));
  Figure figure;
  figure.name = name;
  figure.caption = caption;
  figure.panel_height = 230;
  figure.panels = {std::move(magnitude), std::move(phase), std::move(residual)};
  return figure;
}

}  // namespace

Section data_section(const Work& work, const std::string& name, const io::FrequencyResponseFile& read,
                     std::size_t number) {
  const frac::FrequencyResponseData data = thinned(read.data);
  Section section = open_measured("data", name, number);
  frac::FitOptions options;
  options.component = frac::Component::both;
  const bool has_zero =
      std::any_of(data.value().begin(), data.value().end(), [](const auto& value) { return value == 0.0; });
  std::string weight = prose("data", "relative");
  if (!data.sigma().empty()) {
    options.weight = frac::Weight::given;
    weight = prose("data", "given");
  } else if (has_zero) {
    options.weight = frac::Weight::absolute;
    weight = prose("data", "plain");
  }
  std::string text = prose("data", "extent",
                           {{"points", std::to_string(read.data.size())},
                            {"from", html_number(read.data.omega().front())},
                            {"to", html_number(read.data.omega().back())},
                            {"weight", weight}});
  if (data.size() < read.data.size()) text += " " + prose("data", "thinned", {{"points", std::to_string(data.size())}});
  for (const std::string& note : read.notes) text += " " + escape_html(note);
  section.blocks.emplace_back(Html{"<p>" + text + "</p>"});

  const std::vector<frac::NamedModel> models = candidates_for(2 * data.size());
  if (models.empty()) {
    add_no_verdict(section,
                   prose("data", "too-few",
                         {{"points", std::to_string(data.size())}, {"residuals", std::to_string(2 * data.size())}}),
                   "too few points");
    return section;
  }
  const frac::IdentificationResult result = frac::identify(data, models, {}, options, work.threads);
  section.blocks.emplace_back(data_figure(section.id, prose("data", "figure"), data, result, read.value_unit));
  section.blocks.emplace_back(residual_figure(section.id, data, result.ranking.at(result.chosen)));
  add_verdict(section, name, result);
  return section;
}

}  // namespace report
