// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "frac/identification/model_library.hpp"
#include "frac/identification/statistics.hpp"
#include "frac/identification/uncertainty.hpp"
#include "frac/structure.hpp"
#include "report/html.hpp"
#include "report/ranking.hpp"
#include "report/sections.hpp"
#include "report/sweep_curves.hpp"

namespace report {

namespace {

// More points do not change a ranking but make every fit slower in proportion.
constexpr std::size_t most_points = 2000;
constexpr std::size_t drawn_fits = 3;

frac::FrequencyResponseData thinned(const frac::FrequencyResponseData& data) {
  const std::size_t step = (data.size() + most_points - 1) / most_points;
  std::vector<double> omega, sigma;
  std::vector<std::complex<double>> value;
  for (std::size_t i = 0; i < data.size(); i += step) {
    omega.push_back(data.omega()[i]);
    value.push_back(data.value()[i]);
    if (!data.sigma().empty()) sigma.push_back(data.sigma()[i]);
  }
  return {std::move(omega), std::move(value), std::move(sigma)};
}

std::size_t free_parameters(const frac::NamedModel& model) {
  std::size_t fixed = 0;
  for (const auto& constraint : model.constraints) fixed += constraint.fixed.has_value() ? 1 : 0;
  return frac::Structure(model.formula).parameter_names().size() - fixed;
}

// AICc needs two residuals more than parameters; each point gives two.
std::vector<frac::NamedModel> candidates_for(std::size_t points) {
  std::vector<frac::NamedModel> models;
  for (const auto& model : frac::model_library()) {
    if (2 * points >= free_parameters(model) + 3) models.push_back(model);
  }
  return models;
}

// Phase without jumps of 360 degrees between neighbours.
std::vector<double> unwrapped_phase(const std::vector<std::complex<double>>& values) {
  std::vector<double> phase;
  for (const auto& value : values) {
    double degrees = phase_degrees(value);
    if (!phase.empty()) degrees += 360 * std::round((phase.back() - degrees) / 360);
    phase.push_back(degrees);
  }
  return phase;
}

std::vector<double> decibels(const std::vector<std::complex<double>>& values) {
  std::vector<double> level;
  for (const auto& value : values) level.push_back(value == 0.0 ? std::nan("") : decibel(value));
  return level;
}

/// Half widths of the 95 % band of a fitted curve.
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

/// data/model - 1 of the chosen structure: its real part is the error of the magnitude, its imaginary part that of the
/// phase.
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
  figure.caption = "Residuals of the chosen structure, " + escape_html(chosen.name) +
                   ", along the frequency axis, with the 95 % band of the fitted curve. Points that scatter about "
                   "zero without a trend are noise; a wave is what the structure cannot follow.";
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
  const std::vector<double> measured_phase = unwrapped_phase(data.value());
  static constexpr Mark marks[] = {Mark::line, Mark::dashed, Mark::dotted};
  for (std::size_t i = 0; i < std::min(drawn_fits, result.ranking.size()); ++i) {
    const frac::RankedFit& ranked = result.ranking[i];
    const auto model = frac::fitted_response(ranked.fit, frac::ExactRealisation{}, omega);
    std::vector<double> distance;
    for (std::size_t k = 0; k < omega.size(); ++k) {
      const double relative = 100 * std::abs(model[k] - data.value()[k]) / std::abs(data.value()[k]);
      distance.push_back(relative > 0 && std::isfinite(relative) ? relative : std::nan(""));
    }
    std::vector<double> model_phase = unwrapped_phase(model);
    const double turn = 360 * std::round((measured_phase.front() - model_phase.front()) / 360);
    for (double& degrees : model_phase) degrees += turn;
    magnitude.curves.push_back(make_curve(std::to_string(i + 1) + ". " + key_label(ranked), category_colour(i),
                                          marks[i], omega, decibels(model)));
    phase.curves.push_back(make_curve("", category_colour(i), marks[i], omega, model_phase));
    residual.curves.push_back(make_curve("", category_colour(i), marks[i], omega, distance));
  }
  const frac::RankedFit& chosen = result.ranking.at(result.chosen);
  const Band band = band_of(chosen.fit, omega);
  const auto model = frac::fitted_response(chosen.fit, frac::ExactRealisation{}, omega);
  std::vector<double> model_phase = unwrapped_phase(model);
  const double turn = 360 * std::round((measured_phase.front() - model_phase.front()) / 360);
  for (double& degrees : model_phase) degrees += turn;
  // Below all curves.
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
  const std::string id = "data-" + std::to_string(number);
  Section section;
  section.id = id;
  section.title = escape_html(name);
  section.reading =
      "Both parts of the response are fitted together by every structure of the library. The ranking weighs closeness "
      "against the "
      "number of parameters (AICc; a difference of 10 is decisive). A good fit has residuals without a trend; a trend "
      "means that the "
      "structure, not the noise, limits it. Intervals are 95 % and assume independent residuals of equal relative "
      "size.";

  frac::FitOptions options;
  options.component = frac::Component::both;
  const bool has_zero =
      std::any_of(data.value().begin(), data.value().end(), [](const auto& value) { return value == 0.0; });
  std::string weight = "residual divided by |data|";
  if (!data.sigma().empty()) {
    options.weight = frac::Weight::given;
    weight = "residual divided by the given standard deviation";
  } else if (has_zero) {
    options.weight = frac::Weight::absolute;
    weight = "plain residual, because some values are zero";
  }
  std::string text = "<p>" + std::to_string(read.data.size()) + " points, " + html_number(read.data.omega().front()) +
                     " … " + html_number(read.data.omega().back()) + " rad/s; " + weight + ".";
  if (data.size() < read.data.size())
    text += " Fitted and drawn: " + std::to_string(data.size()) + " of them, evenly taken.";
  for (const std::string& note : read.notes) text += " " + escape_html(note);
  section.blocks.emplace_back(Html{text + "</p>"});

  const std::vector<frac::NamedModel> models = candidates_for(data.size());
  if (models.empty()) {
    section.blocks.emplace_back(Html{"<p>This is too little for any structure: " + std::to_string(data.size()) +
                                     " points give " + std::to_string(2 * data.size()) + " residuals.</p>"});
    section.facts.emplace_back("verdict_" + id, std::string("too few points"));
    return section;
  }
  const frac::IdentificationResult result = frac::identify(data, models, {}, options, work.threads);
  section.blocks.emplace_back(
      data_figure(id, "Data with the three best structures, and their relative distance from the data.", data, result,
                  read.value_unit));
  section.blocks.emplace_back(residual_figure(id, data, result.ranking.at(result.chosen)));
  add_verdict(section, name, result);
  return section;
}

}  // namespace report
