// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <optional>
#include <utility>

#include "report/html.hpp"
#include "report/measured.hpp"
#include "report/prose.hpp"
#include "report/ranking.hpp"
#include "report/sections.hpp"

namespace report {

namespace {

std::vector<double> at(const std::vector<double>& values, const std::vector<std::size_t>& index) {
  std::vector<double> chosen;
  for (const std::size_t i : index) chosen.push_back(values[i]);
  return chosen;
}

// The input, held from sample to sample, as a staircase that begins at the value at rest.
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
  output.x = input.x = residual.x = {"t in s"};
  output.y = {"unit of the file"};
  input.y = {"unit of the file"};
  residual.y = {data.sigma().empty() ? "data − model" : "(data − model)/sigma", false, {}, {}};
  output.key = true;
  const std::vector<double> time = at(data.time(), data.observed());
  const std::vector<double> measured = at(data.output(), data.observed());
  output.curves.push_back(make_curve("data", "#222222", Mark::open_points, time, measured));
  for (const DrawnFit& drawn : drawn_fits(result)) {
    output.curves.push_back(make_curve(drawn.label, drawn.colour, drawn.mark, time,
                                       at(frac::fitted_output(drawn.ranked.fit, data), data.observed())));
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
  return {name,
          prose("time", "figure", {{"model", escape_html(result.ranking.at(result.chosen).name)}}),
          {std::move(output), std::move(residual), std::move(input)},
          1,
          230,
          verdict_html(result),
          name};
}

}  // namespace

Section time_section(const Work& work, const std::string& name, const frac::TimeResponseData& read,
                     const std::vector<std::string>& notes, std::size_t number) {
  const frac::TimeResponseData data = read.observed_at(evenly_chosen(read.size()));
  Section section = open_measured("time", name, number);
  std::string text = prose("time", "extent",
                           {{"samples", std::to_string(read.size())},
                            {"from", html_number(read.time().front())},
                            {"to", html_number(read.time().back())},
                            {"weight", read.sigma().empty() ? prose("time", "plain") : prose("time", "given")}});
  const std::string outputs = std::to_string(data.observed().size());
  if (data.observed().size() < read.size()) text += " " + prose("time", "thinned", {{"outputs", outputs}});
  for (const std::string& note : notes) text += " " + html_sentence(note);
  section.add(Html{"<p>" + text + "</p>"});

  // The offset is fitted beside the parameters of each structure.
  const std::vector<frac::NamedModel> models =
      that_suit(frac::default_candidates_over_time(), data.observed().size(), 1);
  if (models.empty()) {
    add_no_verdict(section, prose("time", "too-few", {{"samples", outputs}}), "too few points");
    return section;
  }
  std::optional<frac::IdentificationResult> found;
  try {
    found = frac::identify(data, models, frac::TimeFitOptions{}, work.threads);
  } catch (const frac::NoCandidateFits& error) {
    add_no_verdict(section, escape_html(error.what()), "no structure fits");
    return section;
  }
  const frac::IdentificationResult& result = *found;
  section.add(time_figure(section.id, data, result));
  section.add(chosen_table(section.id + "-chosen", result, ""));
  add_verdict(section, name, result);
  return section;
}

}  // namespace report
