// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "frac/identification/model_library.hpp"
#include "frac/structure.hpp"
#include "report/html.hpp"
#include "report/ranking.hpp"
#include "report/sections.hpp"

namespace report {

namespace {

// More outputs do not change a ranking but make every fit slower in proportion; the input drives the models in full.
constexpr std::size_t most_outputs = 2000;
constexpr std::size_t drawn_fits = 3;

frac::TimeResponseData thinned(const frac::TimeResponseData& data) {
  const std::size_t step = (data.size() + most_outputs - 1) / most_outputs;
  std::vector<std::size_t> index;
  for (std::size_t i = 0; i < data.size(); i += step) index.push_back(i);
  return data.observed_at(std::move(index));
}

// AICc needs two samples more than parameters, the offset among them.
std::vector<frac::NamedModel> candidates_for(std::size_t outputs) {
  std::vector<frac::NamedModel> models;
  for (const auto& model : frac::model_library()) {
    if (outputs >= frac::Structure(model.formula).parameter_names().size() + 4) models.push_back(model);
  }
  return models;
}

std::vector<double> at(const std::vector<double>& values, const std::vector<std::size_t>& index) {
  std::vector<double> chosen;
  for (const std::size_t i : index) chosen.push_back(values[i]);
  return chosen;
}

// What the samples say between them: a staircase up from rest.
Curve input_curve(const frac::TimeResponseData& data) {
  std::vector<double> time{data.time().front()}, value{data.input_at_rest()};
  for (std::size_t i = 0; i < data.size(); ++i) {
    const bool changes = i == 0 || data.input()[i] != data.input()[i - 1];
    if (!changes && i + 1 < data.size()) continue;
    if (i > 0) {
      time.push_back(data.time()[i]);
      value.push_back(data.input()[i - 1]);
    }
    time.push_back(data.time()[i]);
    value.push_back(data.input()[i]);
  }
  return make_curve("input", "#888888", Mark::line, time, value);
}

Figure time_figure(const std::string& name, const frac::TimeResponseData& data,
                   const frac::IdentificationResult& result) {
  Panel output, input, residual;
  output.title = "Output";
  input.title = "Input";
  residual.title = "Residuals of the chosen structure, " + enhanced_escape(result.ranking.at(result.chosen).name);
  output.x = input.x = residual.x = {"t in s", false, {}, {}};
  output.y = {"unit of the file", false, {}, {}};
  input.y = {"unit of the file", false, {}, {}};
  residual.y = {data.sigma().empty() ? "data − model" : "(data − model)/sigma", false, {}, {}};
  output.key = true;
  const std::vector<double> time = at(data.time(), data.observed());
  const std::vector<double> measured = at(data.output(), data.observed());
  output.curves.push_back(make_curve("data", "#222222", Mark::open_points, time, measured));
  static constexpr Mark marks[] = {Mark::line, Mark::dashed, Mark::dotted};
  for (std::size_t i = 0; i < std::min(drawn_fits, result.ranking.size()); ++i) {
    const frac::RankedFit& ranked = result.ranking[i];
    output.curves.push_back(make_curve(std::to_string(i + 1) + ". " + key_label(ranked), category_colour(i), marks[i],
                                       time, at(frac::fitted_output(ranked.fit, data), data.observed())));
  }
  const std::vector<double> model =
      at(frac::fitted_output(result.ranking.at(result.chosen).fit, data), data.observed());
  std::vector<double> rest;
  for (std::size_t i = 0; i < time.size(); ++i) {
    rest.push_back((measured[i] - model[i]) / (data.sigma().empty() ? 1 : data.sigma()[data.observed()[i]]));
  }
  residual.curves.push_back(make_curve("", category_colour(0), Mark::line, {time.front(), time.back()}, {0.0, 0.0}));
  residual.curves.push_back(make_curve("", "#222222", Mark::open_points, time, rest));
  input.curves.push_back(input_curve(data));
  Figure figure;
  figure.name = name;
  figure.caption =
      "Measured output with the three best structures, the input, and what the chosen structure, " +
      escape_html(result.ranking.at(result.chosen).name) +
      ", leaves of the output. Points that scatter about zero without a trend are noise; a wave is what the structure "
      "cannot follow.";
  figure.panel_height = 230;
  figure.panels = {std::move(output), std::move(residual), std::move(input)};
  return figure;
}

}  // namespace

Section time_section(const Work& work, const std::string& name, const frac::TimeResponseData& read,
                     const std::vector<std::string>& notes, std::size_t number) {
  const frac::TimeResponseData data = thinned(read);
  const std::string id = "data-" + std::to_string(number);
  Section section;
  section.id = id;
  section.title = escape_html(name);
  section.reading =
      "Every structure of the library that can be simulated is driven by the input as sampled, held from sample to "
      "sample, and fitted to the output with one more parameter, the offset the output shows at rest. The ranking "
      "weighs closeness against the number of parameters (AICc; a difference of 10 is decisive). A good fit has "
      "residuals without a trend; a trend means that the structure, not the noise, limits it. Intervals are 95 % and "
      "assume independent residuals.";
  std::string text = "<p>" + std::to_string(read.size()) + " samples, " + html_number(read.time().front()) + " … " +
                     html_number(read.time().back()) + " s; " +
                     (read.sigma().empty() ? "plain residuals." : "residuals divided by the given standard deviation.");
  if (data.observed().size() < read.size())
    text += " Fitted and drawn: " + std::to_string(data.observed().size()) + " of the outputs, evenly taken.";
  for (const std::string& note : notes) text += " " + escape_html(note);
  section.blocks.emplace_back(Html{text + "</p>"});

  const auto without_verdict = [&](const std::string& sentence, const char* fact) {
    section.blocks.emplace_back(Html{"<p>" + escape_html(sentence) + "</p>"});
    section.facts.emplace_back("verdict_" + id, std::string(fact));
    return section;
  };
  const std::vector<frac::NamedModel> models = candidates_for(data.observed().size());
  if (models.empty()) {
    return without_verdict(
        "This is too little for any structure: " + std::to_string(data.observed().size()) + " samples.",
        "too few points");
  }
  std::optional<frac::IdentificationResult> found;
  try {
    found = frac::identify(data, models, frac::TimeFitOptions{}, work.threads);
  } catch (const frac::NoCandidateFits& error) {
    return without_verdict(error.what(), "no structure fits");
  }
  const frac::IdentificationResult& result = *found;
  section.blocks.emplace_back(time_figure(id, data, result));
  add_verdict(section, name, result);
  return section;
}

}  // namespace report
