// SPDX-License-Identifier: BSD-3-Clause
#include "report/measured.hpp"

#include <algorithm>
#include <cmath>

#include "frac/structure.hpp"
#include "report/html.hpp"
#include "report/prose.hpp"
#include "report/ranking.hpp"

namespace report {

namespace {

constexpr std::size_t most_points = 2000;

// Free parameters of a model; a family counts with its smallest member, a gain.
std::size_t fewest_parameters(const frac::NamedModel& model) {
  if (model.is_family()) return 1;
  const auto fixed = std::count_if(model.constraints.begin(), model.constraints.end(),
                                   [](const auto& constraint) { return constraint.fixed.has_value(); });
  return frac::Structure(model.formula).parameter_names().size() - static_cast<std::size_t>(fixed);
}

// Members of a family can be presets again.  Their searches end at the same cost to more digits than noise leaves to
// two different curves.
bool same_curve(const frac::RankedFit& one, const frac::RankedFit& other) {
  return std::abs(one.fit.rms - other.fit.rms) <= 1e-6 * one.fit.rms;
}

}  // namespace

std::vector<std::size_t> evenly_chosen(std::size_t points) {
  std::vector<std::size_t> index;
  const std::size_t step = (points + most_points - 1) / most_points;
  for (std::size_t i = 0; i < points; i += step) index.push_back(i);
  return index;
}

std::vector<frac::NamedModel> that_suit(std::vector<frac::NamedModel> candidates, std::size_t residuals,
                                        std::size_t further_parameters) {
  std::erase_if(candidates, [&](const frac::NamedModel& model) {
    return residuals < fewest_parameters(model) + further_parameters + 3;
  });
  return candidates;
}

std::vector<DrawnFit> drawn_fits(const frac::IdentificationResult& result) {
  static constexpr Mark marks[] = {Mark::line, Mark::dashed, Mark::dotted};
  std::vector<DrawnFit> drawn;
  const auto draw = [&](const frac::RankedFit& ranked) {
    const auto rank = static_cast<std::size_t>(&ranked - result.ranking.data()) + 1;
    const std::size_t i = drawn.size();
    drawn.push_back({ranked, std::to_string(rank) + ". " + key_label(ranked), category_colour(i), marks[i]});
  };
  const auto draw_first = [&](const auto& suits) {
    const auto found = std::find_if(result.ranking.begin(), result.ranking.end(), suits);
    if (found != result.ranking.end()) draw(*found);
  };
  const frac::RankedFit& chosen = result.ranking.at(result.chosen);
  draw(chosen);
  draw_first([&](const frac::RankedFit& other) { return other.model_class != chosen.model_class; });
  draw_first([&](const frac::RankedFit& other) {
    return !other.lack_of_fit.adequate &&
           std::none_of(drawn.begin(), drawn.end(), [&](const DrawnFit& fit) { return same_curve(fit.ranked, other); });
  });
  return drawn;
}

Section open_measured(std::string_view chapter, const std::string& file, std::size_t number) {
  Section section;
  section.id = "data-" + std::to_string(number);
  section.title = escape_html(file);
  section.reading = prose(chapter, "reading");
  return section;
}

std::string validity_sentence(const frac::ValidationResult& result, const io::FrequencyResponseFile& file) {
  const bool has_advice = result.reversed_sign && !file.other_sign.empty();
  return result.summary() + (has_advice ? "; " + file.other_sign : "");
}

void add_no_verdict(Section& section, const std::string& why, const std::string& verdict) {
  section.add(Html{"<p>" + why + "</p>"});
  section.fact("verdict_" + section.id, verdict);
}

void add_verdict(Section& section, const std::string& file, const frac::IdentificationResult& result) {
  section.fact("file_" + section.id, file);
  add_ranking(section, section.id, result,
              {section.id + "-ranking", prose("ranking", "ranking"), section.id + "-parameters",
               prose("ranking", "parameters")});
  section.finding(
      prose("ranking", "finding", {{"file", section.title}, {"sentence", escape_html(result.verdict_sentence)}}));
}

}  // namespace report
