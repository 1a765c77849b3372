// SPDX-License-Identifier: BSD-3-Clause
#include "report/measured.hpp"

#include <algorithm>

#include "frac/structure.hpp"
#include "report/html.hpp"
#include "report/prose.hpp"
#include "report/ranking.hpp"

namespace report {

namespace {

constexpr std::size_t most_points = 2000;

std::size_t free_parameters(const frac::NamedModel& model) {
  const auto fixed = std::count_if(model.constraints.begin(), model.constraints.end(),
                                   [](const auto& constraint) { return constraint.fixed.has_value(); });
  return frac::Structure(model.formula).parameter_names().size() - static_cast<std::size_t>(fixed);
}

}  // namespace

std::vector<std::size_t> evenly_chosen(std::size_t points) {
  std::vector<std::size_t> index;
  const std::size_t step = (points + most_points - 1) / most_points;
  for (std::size_t i = 0; i < points; i += step) index.push_back(i);
  return index;
}

std::vector<frac::NamedModel> candidates_for(std::size_t residuals, std::size_t further_parameters) {
  std::vector<frac::NamedModel> models;
  for (const auto& model : frac::model_library()) {
    if (residuals >= free_parameters(model) + further_parameters + 3) models.push_back(model);
  }
  return models;
}

std::vector<DrawnFit> drawn_fits(const frac::IdentificationResult& result) {
  static constexpr Mark marks[] = {Mark::line, Mark::dashed, Mark::dotted};
  std::vector<DrawnFit> drawn;
  for (std::size_t i = 0; i < std::min(std::size(marks), result.ranking.size()); ++i) {
    const frac::RankedFit& ranked = result.ranking[i];
    drawn.push_back({ranked, std::to_string(i + 1) + ". " + key_label(ranked), category_colour(i), marks[i]});
  }
  return drawn;
}

Section open_measured(std::string_view chapter, const std::string& file, std::size_t number) {
  Section section;
  section.id = "data-" + std::to_string(number);
  section.title = escape_html(file);
  section.reading = prose(chapter, "reading");
  return section;
}

void add_no_verdict(Section& section, const std::string& why, const std::string& verdict) {
  section.blocks.emplace_back(Html{"<p>" + why + "</p>"});
  section.facts.emplace_back("verdict_" + section.id, verdict);
}

void add_verdict(Section& section, const std::string& file, const frac::IdentificationResult& result) {
  section.facts.emplace_back("file_" + section.id, file);
  add_ranking(section, section.id, result,
              {section.id + "-ranking", prose("ranking", "ranking"), section.id + "-parameters",
               prose("ranking", "parameters")});
  section.findings.push_back(
      prose("ranking", "finding", {{"file", section.title}, {"sentence", escape_html(result.verdict_sentence)}}));
}

}  // namespace report
