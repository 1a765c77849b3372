// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "frac/identification/economy.hpp"
#include "frac/identification/screened_fit.hpp"
#include "frac/identification/validate.hpp"
#include "frac/parameter_units.hpp"
#include "report/circuit_drawing.hpp"
#include "report/data_figures.hpp"
#include "report/html.hpp"
#include "report/measured.hpp"
#include "report/prose.hpp"
#include "report/ranking.hpp"
#include "report/sections.hpp"
#include "report/times_figure.hpp"

namespace report {

namespace {

frac::FrequencyResponseData thinned(const frac::FrequencyResponseData& data, frac::FrequencyUnit shown_in) {
  std::vector<double> omega, sigma;
  std::vector<std::complex<double>> value;
  for (const std::size_t i : evenly_chosen(data.size())) {
    omega.push_back(data.omega()[i]);
    value.push_back(data.value()[i]);
    if (!data.sigma().empty()) sigma.push_back(data.sigma()[i]);
  }
  return {std::move(omega), std::move(value), std::move(sigma), shown_in};
}

std::string frequency(const frac::FrequencyResponseData& data, double omega) {
  return html_number(in_unit(omega, data.frequency_unit()));
}

std::string frequencies_of(const frac::FrequencyResponseData& data, const std::vector<std::size_t>& points) {
  std::string text;
  for (const std::size_t i : points) text += (text.empty() ? "" : ", ") + frequency(data, data.omega()[i]);
  return text;
}

/// Of data without noise the verdict is about economy, and nothing else is to be said of odds.
void judge_economy(const frac::FrequencyResponseData& data, frac::Component component, int threads,
                   frac::IdentificationResult& result) {
  result.verdict_sentence = frac::no_noise_sentence;
  result.notes.clear();
  try {
    result.verdict_sentence += " " + frac::economy(data, {}, {component}, threads).sentence;
  } catch (const std::invalid_argument& error) {
    result.notes.emplace_back(error.what());
  }
}

/// The answers that a reader asks first: the verdict, the values, and to how much the points belong together.
std::string headline(const frac::IdentificationResult& result, const frac::ValidationResult& validity,
                     const std::string& unit) {
  const bool noisy = !result.without_noise();
  std::string line(noisy ? frac::to_string(result.verdict) : "without noise");
  // Of classes that both miss the data the odds say nothing.
  if (noisy && result.verdict != frac::Verdict::no_adequate_model && std::isfinite(result.log10_odds)) {
    const double odds = std::pow(10.0, std::abs(result.log10_odds));
    line +=
        ", odds " + html_number(odds, 3) + ":1 for " + (result.log10_odds > 0 ? "a fractional order" : "whole orders");
  }
  const frac::RankedFit& chosen = result.ranking.at(result.chosen);
  std::vector<std::string> units;
  if (!chosen.fit.parameters.empty()) units = frac::parameter_units(frac::Structure(chosen.fit.model), unit);
  // Those in the unit of the data: resistances of an impedance, moduli, gains.
  constexpr std::size_t most = 4;
  std::string values;
  std::size_t count = 0;
  for (std::size_t i = 0; i < std::min(units.size(), chosen.fit.parameters.size()) && count < most; ++i) {
    const frac::ParameterEstimate& each = chosen.fit.parameters[i];
    if (!noisy || units[i] != unit || !each.identified || std::isnan(each.ci95_lower)) continue;
    values += (values.empty() ? "" : ", ") + each.name + " = " + html_number(each.value, 4) + " ± " +
              html_number((each.ci95_upper - each.ci95_lower) / 2, 2) + (unit.empty() ? "" : " " + unit);
    ++count;
  }
  if (!values.empty()) line += "; " + values;
  if (std::isfinite(validity.consistent_to) && !validity.model.empty())
    line += "; consistent to " + html_number(100 * validity.consistent_to, 2) + " %";
  return line;
}

/// Says so where the chosen structure is none of the two that the verdict compares.
std::string chosen_beside(const frac::IdentificationResult& result) {
  if (!result.fractional || !result.integer || result.chosen == result.fractional->index ||
      result.chosen == result.integer->index)
    return {};
  const auto name = [&](std::size_t index) { return escape_html(result.ranking.at(index).name); };
  return prose("data", "chosen-beside",
               {{"model", name(result.chosen)},
                {"fractional", name(result.fractional->index)},
                {"integer", name(result.integer->index)}});
}

}  // namespace

Section data_section(const Work& work, const std::string& name, const io::FrequencyResponseFile& read,
                     std::size_t number, Field asked) {
  const Field field = asked == Field::automatic ? field_of(read) : asked;
  // Sentences speak of the frequency as the pictures show it.
  const Notation notation = notation_of(field, read.value_unit, read.data.frequency_unit());
  const frac::FrequencyUnit axis = notation.axis;
  const frac::FrequencyResponseData taken = thinned(read.data, axis);
  frac::FitOptions options;
  options.component = frac::fitted_component(taken, options.component);
  const bool both = options.component == frac::Component::both;
  frac::ScreenedData points(taken, options, false);
  Section section = open_measured("data", name, number);
  const bool has_zero = std::any_of(points.kept().value().begin(), points.kept().value().end(),
                                    [](const auto& value) { return value == 0.0; });
  options.weight = frac::Weight::learned;
  std::string weight = prose("data", "learned");
  if (!points.kept().sigma().empty()) {
    options.weight = frac::Weight::given;
    weight = prose("data", "given");
  } else if (has_zero) {
    options.weight = frac::Weight::absolute;
    weight = prose("data", "plain");
  }
  const std::size_t residuals = (both ? 2 : 1) * points.kept().size();
  const std::vector<frac::NamedModel> models = that_suit(frac::default_candidates(), residuals);
  std::optional<frac::IdentificationResult> result;
  options.without_noise = io::is_computed(read.metadata);
  if (!models.empty()) result = frac::identify(points, models, {}, options, work.threads);
  const frac::FrequencyResponseData& data = points.kept();
  if (result && result->without_noise()) judge_economy(data, options.component, work.threads, *result);
  std::string text = prose("data", "extent",
                           {{"points", std::to_string(read.data.size())},
                            {"from", frequency(taken, read.data.omega().front())},
                            {"to", frequency(taken, read.data.omega().back())},
                            {"unit", std::string(to_string(axis))},
                            {"weight", weight}});
  if (taken.size() < read.data.size())
    text += " " + prose("data", "thinned", {{"points", std::to_string(taken.size())}});
  if (!points.left_out().empty())
    text += " " + prose("data", "outliers",
                        {{"at", frequencies_of(taken, points.left_out())}, {"unit", std::string(to_string(axis))}});
  if (!both) text += " " + html_sentence(std::string(frac::imaginary_part_alone));
  for (const std::string& note : read.notes) text += " " + html_sentence(note);
  section.add(Html{"<p>" + text + "</p>"});

  if (!result) {
    add_no_verdict(
        section,
        prose("data", "too-few", {{"points", std::to_string(data.size())}, {"residuals", std::to_string(residuals)}}),
        "too few points");
    return section;
  }
  // It judges both parts together.
  const frac::ValidationResult validity =
      both ? frac::validate(data, {.most_points = frac::points_in_passing}) : frac::ValidationResult{};
  if (!validity.model.empty()) {
    section.add(Html{
        "<p>" + prose("data", "validity", {{"sentence", html_sentence(validity_sentence(validity, read))}}) + "</p>"});
    section.fact("validity_" + section.id, std::string(to_string(validity.validity)));
  }
  const bool is_number = field == Field::permittivity && notation.unit.empty();
  const std::string unit = is_number ? "1" : notation.unit;
  section.add(Html{"<p>" + prose("data", "headline", {{"line", headline(*result, validity, notation.unit)}}) + "</p>"});
  if (const std::string beside = chosen_beside(*result); !beside.empty()) section.add(Html{"<p>" + beside + "</p>"});
  MeasuredPictures pictures = draw_measured(section.id, data, options.component, *result, field, read.value_unit);
  section.add(std::move(pictures.response));
  const std::string& chosen = result->ranking.at(result->chosen).name;
  if (const std::string circuit = circuit_of(chosen); field == Field::impedance && !circuit.empty())
    section.add(Html{"<p>" + prose("data", "circuit", {{"model", escape_html(chosen)}}) + "</p><div class=\"scroll\">" +
                     circuit_drawing(circuit) + "</div>"});
  if (field == Field::impedance && both)
    if (auto times = times_figure(section.id + "-times", data, notation.unit)) section.add(*std::move(times));
  section.add(chosen_table(section.id + "-chosen", *result, unit));
  section.add(std::move(pictures.residuals));
  section.add(std::move(pictures.values));
  section.fact("quantity_" + section.id, std::string(to_string(field)));
  add_verdict(section, name, *result);
  return section;
}

}  // namespace report
