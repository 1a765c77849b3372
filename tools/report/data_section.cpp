// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <utility>

#include "frac/identification/outliers.hpp"
#include "frac/identification/validate.hpp"
#include "report/data_figures.hpp"
#include "report/html.hpp"
#include "report/measured.hpp"
#include "report/prose.hpp"
#include "report/ranking.hpp"
#include "report/sections.hpp"

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
  const auto outliers = frac::isolated_outliers(taken, options.component);
  const frac::FrequencyResponseData data = frac::without_points(taken, outliers);
  Section section = open_measured("data", name, number);
  const bool has_zero =
      std::any_of(data.value().begin(), data.value().end(), [](const auto& value) { return value == 0.0; });
  options.weight = frac::Weight::learned;
  std::string weight = prose("data", "learned");
  if (!data.sigma().empty()) {
    options.weight = frac::Weight::given;
    weight = prose("data", "given");
  } else if (has_zero) {
    options.weight = frac::Weight::absolute;
    weight = prose("data", "plain");
  }
  std::string text = prose("data", "extent",
                           {{"points", std::to_string(read.data.size())},
                            {"from", frequency(taken, read.data.omega().front())},
                            {"to", frequency(taken, read.data.omega().back())},
                            {"unit", std::string(to_string(axis))},
                            {"weight", weight}});
  if (taken.size() < read.data.size())
    text += " " + prose("data", "thinned", {{"points", std::to_string(taken.size())}});
  if (!outliers.empty())
    text += " " + prose("data", "outliers",
                        {{"at", frequencies_of(taken, outliers)}, {"unit", std::string(to_string(axis))}});
  if (!both) text += " " + html_sentence(std::string(frac::imaginary_part_alone));
  for (const std::string& note : read.notes) text += " " + html_sentence(note);
  section.add(Html{"<p>" + text + "</p>"});

  const std::size_t residuals = (both ? 2 : 1) * data.size();
  const std::vector<frac::NamedModel> models = that_suit(frac::default_candidates(), residuals);
  if (models.empty()) {
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
  const frac::IdentificationResult result = frac::identify(data, models, {}, options, work.threads);
  MeasuredPictures pictures = draw_measured(section.id, data, options.component, result, field, read.value_unit);
  section.add(std::move(pictures.response));
  const bool is_number = field == Field::permittivity && notation.unit.empty();
  section.add(chosen_table(section.id + "-chosen", result, is_number ? "1" : notation.unit));
  section.add(std::move(pictures.residuals));
  section.add(std::move(pictures.values));
  section.fact("quantity_" + section.id, std::string(to_string(field)));
  add_verdict(section, name, result);
  return section;
}

}  // namespace report
