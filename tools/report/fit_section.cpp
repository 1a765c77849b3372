// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <iterator>
#include <numbers>
#include <optional>
#include <string_view>
#include <utility>

#include "backlash/static_backlash.hpp"
#include "frac/identification/model_choice.hpp"
#include "frac/identification/model_library.hpp"
#include "report/bands.hpp"
#include "report/html.hpp"
#include "report/prose.hpp"
#include "report/ranking.hpp"
#include "report/sections.hpp"

namespace report {

namespace {

using backlash::DescribingFunctionPoint;

// Structures that the imaginary part can tell apart.  Left out are those that differ from one of these only by a real
// constant or a free mass 1/(M s^2), which have no imaginary part.
constexpr std::string_view candidates[] = {"power-law",
                                           "two-power-laws",
                                           "fractional-lag",
                                           "fractional-oscillator",
                                           "differentiator",
                                           "two-differentiators",
                                           "integrator",
                                           "integrator-and-differentiator",
                                           "lag",
                                           "oscillator"};

// Rivals of equal power: both classes grow as far as it pays.
constexpr frac::GrowthFamily families[] = {frac::GrowthFamily::rational, frac::GrowthFamily::commensurate,
                                           frac::GrowthFamily::terms};

std::vector<frac::NamedModel> imaginary_candidates() {
  std::vector<frac::NamedModel> models;
  for (const frac::GrowthFamily family : families) models.push_back(frac::find_model(frac::to_string(family)));
  for (const auto& model : frac::model_library()) {
    if (std::find(std::begin(candidates), std::end(candidates), model.name) != std::end(candidates))
      models.push_back(model);
  }
  return models;
}

frac::FitOptions imaginary_options() {
  frac::FitOptions options;
  options.component = frac::Component::imaginary;
  options.weight = frac::Weight::given;
  return options;
}

struct Drawn {
  std::string label;
  std::string colour;
  Mark mark;
  std::vector<double> imaginary;
};

std::vector<double> imaginary_parts(const std::vector<std::complex<double>>& values) {
  std::vector<double> parts;
  for (const auto& value : values) parts.push_back(value.imag());
  return parts;
}

Figure fit_figure(const std::string& name, const std::string& caption,
                  const std::vector<DescribingFunctionPoint>& points, const std::vector<Drawn>& models) {
  const std::vector<double> omega = omega_of(points);
  Panel values, residuals;
  values.title = "Imaginary part of N and the structures fitted to it";
  values.x = residuals.x = {"ω in rad/s", true};
  values.y = {"Im N in m/N", true};
  values.key = true;
  residuals.title = "Distance from the data";
  residuals.y = {"|model / data − 1| in %", true, 1e-8, {}};
  const std::vector<double> measured = imaginary_of(points);
  // Draws every fourth point only, so that the lines below stay visible.
  std::vector<double> sparse_omega, sparse_value;
  for (std::size_t i = 0; i < omega.size(); i += 4) {
    sparse_omega.push_back(omega[i]);
    sparse_value.push_back(measured[i]);
  }
  for (const Drawn& model : models) {
    std::vector<double> level, distance;
    for (std::size_t i = 0; i < omega.size(); ++i) {
      level.push_back(model.imaginary[i] > 0 ? model.imaginary[i] : std::nan(""));
      const double relative = 100 * std::abs(model.imaginary[i] / measured[i] - 1);
      distance.push_back(relative > 0 ? relative : std::nan(""));
    }
    values.curves.push_back(make_curve(model.label, model.colour, model.mark, omega, level));
    residuals.curves.push_back(make_curve("", model.colour, model.mark, omega, distance));
  }
  values.curves.push_back(make_curve("computed N", "#222222", Mark::open_points, sparse_omega, sparse_value));
  return {name, caption, {std::move(values), std::move(residuals)}, 1, 260};
}

// The best fractional structure, the power law, the best integer-order structure and the static model, each once.
std::vector<Drawn> drawn_models(const frac::IdentificationResult& result, const std::vector<double>& omega,
                                const std::vector<std::complex<double>>& static_model) {
  std::vector<const frac::RankedFit*> chosen;
  const auto add = [&chosen](const frac::RankedFit* fit) {
    if (fit != nullptr && std::find(chosen.begin(), chosen.end(), fit) == chosen.end()) chosen.push_back(fit);
  };
  add(best_of(result, frac::ModelClass::fractional));
  for (const auto& ranked : result.ranking) {
    if (ranked.name == "power-law") add(&ranked);
  }
  add(best_of(result, frac::ModelClass::integer_order));
  std::vector<Drawn> models;
  static constexpr Mark marks[] = {Mark::line, Mark::dashed, Mark::dotted};
  for (std::size_t i = 0; i < chosen.size(); ++i) {
    models.push_back({key_label(*chosen[i]), category_colour(i), marks[i % 3],
                      imaginary_parts(frac::fitted_response(chosen[i]->fit, frac::ExactRealisation{}, omega))});
  }
  models.push_back({"static backlash", category_colour(4), Mark::dashed, imaginary_parts(static_model)});
  return models;
}

std::vector<std::complex<double>> static_model(const Scene& scene, const std::vector<double>& omega) {
  return backlash::static_describing_function(scene.mass1, scene.mass2, scene.clearance, scene.force, omega);
}

Table realisation_table(const std::string& name, const frac::FrequencyResponseData& data, int threads) {
  Table table{name,
              prose("fits", "realisations"),
              {{"realisation", "realisation"},
               {"order", "order a", 6},
               {"order_ci95_lower", "95 % from", 6},
               {"order_ci95_upper", "to", 6},
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
    frac::FitOptions options = imaginary_options();
    options.realisation = realisations[i].second;
    options.constraints = model.constraints;
    fits[i] = frac::fit(data, frac::Structure(model.formula), options);
  });
  for (std::size_t i = 0; i < fits.size(); ++i) {
    const frac::FitResult& fit = *fits[i];
    const auto* order = find_parameter(fit, "a");
    const auto* coefficient = find_parameter(fit, "K");
    std::string note = remark(*order);
    if (fit.termination != frac::FitTermination::converged) note += (note.empty() ? "" : "; ") + fit.message;
    table.rows.push_back({realisations[i].first, order->value, order->ci95_lower, order->ci95_upper, coefficient->value,
                          fit.rms, note.empty() ? std::string("identified") : note});
  }
  return table;
}

// Fits the free mass and the constant to the real part, with c and q held as the imaginary part gave them.
std::optional<frac::FitResult> real_part_fit(const std::vector<DescribingFunctionPoint>& points,
                                             const frac::FitResult& power_law) {
  const auto* coefficient = find_parameter(power_law, "K");
  const auto* order = find_parameter(power_law, "a");
  if (coefficient == nullptr || order == nullptr) return std::nullopt;
  const frac::NamedModel model = frac::find_model("inertia-and-power-law");
  frac::FitOptions options;
  options.component = frac::Component::real;
  options.weight = frac::Weight::relative;
  for (const auto& constraint : model.constraints) {
    if (constraint.name != "c" && constraint.name != "q") options.constraints.push_back(constraint);
  }
  options.constraints.push_back({"c", coefficient->value, {}, {}, {}});
  options.constraints.push_back({"q", order->value, {}, {}, {}});
  return frac::fit(relative_imaginary_data(points), frac::Structure(model.formula), options);
}

std::string percent(double share) {
  return html_number(100 * share, 2) + " %";
}

/// The members of each family, simplest first.
std::vector<frac::Growth> grown_rivals(const frac::FrequencyResponseData& data, int threads) {
  std::vector<frac::Growth> grown(std::size(families));
  frac::parallel_for(grown.size(), threads,
                     [&](std::size_t i) { grown[i] = frac::grow(data, families[i], imaginary_options()); });
  return grown;
}

Table rival_table(const std::string& name, const std::vector<frac::Growth>& grown) {
  Table table{name,
              prose("fits", "rivals"),
              {{"family", "family"},
               {"model", "structure", 0, true, true},
               {"free_parameters", "parameters"},
               {"rms_relative", "rms residual", 3},
               {"remark", "remark"}}};
  for (std::size_t i = 0; i < grown.size(); ++i) {
    for (std::size_t k = 0; k < grown[i].fits.size(); ++k) {
      table.rows.push_back({std::string(frac::to_string(families[i])), grown[i].models[k].name,
                            static_cast<double>(grown[i].fits[k].free_parameters), grown[i].fits[k].rms,
                            std::string(k == grown[i].chosen ? "chosen" : "")});
    }
  }
  return table;
}

/// What a rational model needs to follow the data as closely as a fractional fit.
std::string rational_price(const frac::RankedFit& fractional, const frac::Growth& rational) {
  const frac::FitResult* needed = nullptr;
  std::size_t closest = 0;
  std::string name;
  for (std::size_t i = 0; i < rational.fits.size(); ++i) {
    if (rational.fits[i].rms < rational.fits[closest].rms) closest = i;
    if (!(rational.fits[i].rms <= fractional.fit.rms)) continue;
    if (needed != nullptr && needed->free_parameters <= rational.fits[i].free_parameters) continue;
    needed = &rational.fits[i];
    name = rational.models[i].name;
  }
  const std::string model = escape_html(fractional.name);
  const std::string parameters = std::to_string(fractional.fit.free_parameters);
  if (needed != nullptr) {
    return prose("fits", "rational-needs",
                 {{"model", model},
                  {"parameters", parameters},
                  {"rms", percent(fractional.fit.rms)},
                  {"rational", name},
                  {"needed", std::to_string(needed->free_parameters)},
                  {"reached", percent(needed->rms)}});
  }
  return prose("fits", "rational-fails",
               {{"model", model},
                {"parameters", parameters},
                {"rms", percent(fractional.fit.rms)},
                {"rational", rational.models.at(closest).name},
                {"needed", std::to_string(rational.fits.at(closest).free_parameters)},
                {"reached", percent(rational.fits.at(closest).rms)}});
}

/// A formula, or the name of a structure whose formula would fill the line.
std::string short_formula(const frac::RankedFit& fit) {
  constexpr std::size_t longest = 50;
  return fit.fit.model.size() > longest ? escape_html(fit.name) : html_formula(fit.fit.model);
}

std::string verdict_words(frac::Verdict verdict) {
  switch (verdict) {
    case frac::Verdict::fractional_supported:
      return prose("fits", "supported");
    case frac::Verdict::fractional_not_supported:
      return prose("fits", "not-supported");
    case frac::Verdict::undecided:
      return prose("fits", "undecided");
    case frac::Verdict::no_adequate_model:
      return prose("fits", "no-adequate-model");
  }
  return {};
}

struct BandText {
  std::string id;    // suffix of names
  std::string name;  // in sentences
  std::string heading;
};

void add_band(Section& section, const Work& work, const std::vector<DescribingFunctionPoint>& points,
              const BandText& band) {
  const Scene& scene = work.scene;
  const std::vector<double> omega = omega_of(points);
  const std::string range = html_number(omega.front()) + " … " + html_number(omega.back()) + " rad/s";
  section.add(Html{prose("fits", "band-heading", {{"band", band.heading}, {"range", range}})});
  const frac::FrequencyResponseData data = relative_imaginary_data(points);
  const auto curve = static_model(scene, omega);
  const frac::IdentificationResult result =
      frac::identify(data, imaginary_candidates(), {{"static backlash", curve}}, imaginary_options(), work.threads);
  Figure figure = fit_figure("fit-" + band.id, prose("fits", "figure", {{"band", band.name}}), points,
                             drawn_models(result, omega, curve));
  figure.verdict = verdict_html(result) + " " + prose("fits", "one-misfit");
  section.add(std::move(figure));
  section.add(chosen_table("chosen-" + band.id, result, "m/N"));
  add_ranking(
      section, band.id, result,
      {"ranking-" + band.id, prose("fits", "ranking", {{"points", std::to_string(points.size())}, {"band", band.name}}),
       "parameters-" + band.id, prose("fits", "parameters")});

  const auto power_law = std::find_if(result.ranking.begin(), result.ranking.end(),
                                      [](const frac::RankedFit& fit) { return fit.name == "power-law"; });
  std::string finding =
      prose("fits", "verdict", {{"band", band.heading}, {"range", range}, {"verdict", verdict_words(result.verdict)}});
  const auto* best = best_of(result, frac::ModelClass::fractional);
  if (best != nullptr) {
    const auto* whole = best_of(result, frac::ModelClass::integer_order);
    const auto* fixed = best_of(result, frac::ModelClass::fixed_curve);
    finding +=
        " " + prose("fits", "best-fractional", {{"model", short_formula(*best)}, {"rms", percent(best->fit.rms)}});
    if (whole != nullptr) {
      finding += prose("fits", "best-whole", {{"model", short_formula(*whole)}, {"rms", percent(whole->fit.rms)}});
    }
    if (fixed != nullptr) finding += prose("fits", "static", {{"rms", percent(fixed->fit.rms)}});
    finding += ".";
  }
  const std::vector<frac::Growth> grown = grown_rivals(data, work.threads);
  if (power_law != result.ranking.end()) finding += " " + rational_price(*power_law, grown.front());
  if (best != nullptr && best->name != "power-law") finding += " " + rational_price(*best, grown.front());
  section.finding(finding);
  section.add(rival_table("rivals-" + band.id, grown));

  if (power_law != result.ranking.end()) {
    if (const auto* order = find_parameter(power_law->fit, "a")) {
      section.fact("order_" + band.id, order->value);
      section.fact("order_ci95_lower_" + band.id, order->ci95_lower);
      section.fact("order_ci95_upper_" + band.id, order->ci95_upper);
    }
    if (const auto real = real_part_fit(points, power_law->fit)) {
      const auto* mass = find_parameter(*real, "M");
      const auto* constant = find_parameter(*real, "d");
      const double free_mass = mass->value;
      section.add(paragraph("fits", "real-part",
                            {{"fitted_mass", html_number(free_mass)},
                             {"total_mass", html_number(scene.mass1 + scene.mass2)},
                             {"constant", html_number(constant->value)},
                             {"rms", percent(real->rms)}}));
      section.fact("free_mass_kg_" + band.id, free_mass);
    }
    section.add(realisation_table("realisations-" + band.id, data, work.threads));
  }
}

}  // namespace

Section fit_section(const Work& work, const Bands& bands) {
  Section section = open_section("fits");
  if (bands.two_impact.empty() && bands.chatter.empty()) {
    section.add(paragraph("fits", "no-band"));
    return section;
  }
  if (!bands.two_impact.empty()) {
    add_band(section, work, bands.two_impact,
             {"two-impact", "two-impact band", "Two impacts per period, symmetric orbit"});
  }
  if (!bands.chatter.empty()) {
    add_band(section, work, bands.chatter, {"chatter", "chatter band", "Chatter and sticking"});
  }
  return section;
}

}  // namespace report
