// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <cstddef>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "backlash/minus_inverse.hpp"
#include "backlash/static_backlash.hpp"
#include "frac/identification/economy.hpp"
#include "frac/parallel_for.hpp"
#include "report/bands.hpp"
#include "report/html.hpp"
#include "report/prose.hpp"
#include "report/sections.hpp"

namespace report {

namespace {

using backlash::DescribingFunctionPoint;
using backlash::Quantity;
using frac::EconomyClass;
using frac::EconomyVerdict;

constexpr std::size_t most_points = 80;
constexpr std::array quantities = {Quantity::n, Quantity::minus_inverse};

std::string symbol_of(Quantity quantity) {
  return quantity == Quantity::n ? "N" : "−1/N";
}

// In the order of colours and rows.
constexpr std::array classes = {
    EconomyClass::real_powers, EconomyClass::integer_powers_of_s, EconomyClass::integer_powers_of_omega,
    EconomyClass::rational,    EconomyClass::commensurate,        EconomyClass::terms,
    EconomyClass::given};

std::string shown_name(EconomyClass model_class) {
  return model_class == EconomyClass::given ? "static backlash" : std::string(description(model_class));
}

const frac::EconomyCurve* curve_of(const frac::Economy& economy, EconomyClass model_class) {
  const auto found = std::find_if(economy.curves.begin(), economy.curves.end(),
                                  [&](const auto& each) { return each.model_class == model_class; });
  return found == economy.curves.end() ? nullptr : &*found;
}

// One band and one quantity.
struct Case {
  std::string id;     // of the band, in names
  std::string where;  // in sentences
  std::string band;   // in headings
  Quantity quantity;
  const std::vector<DescribingFunctionPoint>* points;
  frac::Economy economy = {};
};

struct Samples {
  frac::FrequencyResponseData data;
  std::vector<frac::FixedCurve> given;
};

// The imaginary part of a mean that may be zero has no relative error.
std::optional<Samples> samples_of(const Scene& scene, const Case& asked) {
  std::vector<double> omega;
  std::vector<std::complex<double>> value;
  // As smooth as the curves are, more points cost time and tell no more.
  const std::size_t step = 1 + asked.points->size() / most_points;
  for (std::size_t i = 0; i < asked.points->size(); i += step) {
    const DescribingFunctionPoint& point = (*asked.points)[i];
    if (!(std::abs(point.value.imag()) > point.uncertainty)) continue;
    omega.push_back(point.omega);
    value.push_back(point.value);
  }
  if (omega.size() < 2) return std::nullopt;
  std::vector<std::complex<double>> model =
      backlash::static_describing_function(scene.mass1, scene.mass2, scene.clearance, scene.force, omega);
  bool finite = true;
  if (asked.quantity == Quantity::minus_inverse) {
    for (auto* curve : {&value, &model}) {
      for (auto& each : *curve) {
        const auto inverse = backlash::minus_inverse(each, 0);
        finite = finite && inverse;
        if (inverse) each = inverse->value;
      }
    }
  }
  Samples samples{{std::move(omega), std::move(value)}, {}};
  if (finite) samples.given.push_back({shown_name(EconomyClass::given), std::move(model)});
  return samples;
}

bool is_exact(const frac::Economy& economy, const frac::EconomyPoint& point) {
  return point.error <= economy.rounding;
}

Panel panel_of(const Case& each) {
  // In per cent; what follows to rounding stands on the lower edge.
  constexpr double lowest = 1e-4, highest = 1e3;
  const frac::Economy& economy = each.economy;
  Panel panel{symbol_of(each.quantity) + ", " + each.band,
              {"parameters", false, 0.5, static_cast<double>(economy.most_parameters) + 0.5},
              {"error in %", true, lowest, highest}};
  std::size_t colour = 0;
  for (const EconomyClass model_class : classes) {
    std::vector<double> parameters, error;
    if (const frac::EconomyCurve* const curve = curve_of(economy, model_class)) {
      for (const frac::EconomyPoint& point : curve->points) {
        parameters.push_back(static_cast<double>(point.parameters));
        error.push_back(std::clamp(100 * point.error, lowest, highest));
      }
    }
    const bool is_given = model_class == EconomyClass::given;
    if (is_given && !error.empty()) {
      parameters = {*panel.x.from, *panel.x.to};
      error.push_back(error.front());
    }
    panel.curves.push_back(make_curve(shown_name(model_class), category_colour(colour++),
                                      is_given ? Mark::dashed : Mark::line_points, parameters, error));
  }
  return panel;
}

// "4, 4, 6"
std::string needs_of(const frac::Economy& economy, EconomyClass model_class) {
  const frac::EconomyCurve* const curve = curve_of(economy, model_class);
  if (curve == nullptr) return "–";
  if (model_class == EconomyClass::given)
    return "misses by " + html_number(100 * curve->points.front().error, 3) + " %";
  const frac::EconomyPoint* const first = curve->within(frac::economy_errors().front());
  if (first && is_exact(economy, *first)) return std::to_string(first->parameters) + ", exact";
  std::string text;
  for (const double error : frac::economy_errors()) {
    const frac::EconomyPoint* const point = curve->within(error);
    text += (text.empty() ? "" : ", ") +
            (point ? std::to_string(point->parameters) : ">" + std::to_string(economy.most_parameters));
  }
  return text;
}

Table needs_table(const std::vector<Case>& cases) {
  Table table{"economy-needs", prose("economy", "needs"), {{"class", "class"}}};
  for (const Case& each : cases) {
    table.columns.push_back(
        {each.id + "_" + std::string(to_string(each.quantity)), symbol_of(each.quantity) + ", " + each.band});
  }
  for (const EconomyClass model_class : classes) {
    std::vector<Cell> row{shown_name(model_class)};
    for (const Case& each : cases) row.emplace_back(needs_of(each.economy, model_class));
    table.rows.push_back(std::move(row));
  }
  return table;
}

Table points_table(const std::vector<Case>& cases) {
  Table table{"economy",
              prose("economy", "points"),
              {{"band", "band"},
               {"quantity", "quantity"},
               {"class", "class"},
               {"parameters", "parameters"},
               {"error", "error"},
               {"least_of_all", "least of all"},
               {"fractional", "fractional"},
               {"model", "model"}},
              {},
              false};
  const auto word = [](bool is) { return std::string(is ? "yes" : "no"); };
  for (const Case& each : cases) {
    for (const frac::EconomyCurve& curve : each.economy.curves) {
      for (const frac::EconomyPoint& point : curve.points) {
        table.rows.push_back({each.id, std::string(to_string(each.quantity)), shown_name(curve.model_class),
                              static_cast<double>(point.parameters), point.error, word(point.proven),
                              word(point.fractional), point.model});
      }
    }
  }
  return table;
}

// Fewest parameters for an error, of models with a fractional order or without.
std::optional<std::size_t> fewest(const frac::Economy& economy, double error, bool fractional) {
  std::optional<std::size_t> least;
  for (const frac::EconomyCurve& curve : economy.curves) {
    if (curve.model_class == EconomyClass::given) continue;
    for (const frac::EconomyPoint& point : curve.points) {
      if (point.fractional == fractional && point.error <= error)
        least = std::min(least.value_or(point.parameters), point.parameters);
    }
  }
  return least;
}

// Fewest parameters with which whole orders leave nothing but rounding.
std::optional<std::size_t> exact_law(const frac::Economy& economy) {
  return fewest(economy, economy.rounding, false);
}

// @param of  the quantities that it is said of
std::string words_of(const frac::Economy& economy, const std::string& of) {
  if (const auto parameters = exact_law(economy)) {
    return prose(
        "economy", "exact",
        {{"of", of}, {"parameters", std::to_string(*parameters) + (*parameters == 1 ? " parameter" : " parameters")}});
  }
  switch (economy.verdict) {
    case EconomyVerdict::fractional_cheaper:
      return prose("economy", "fractional-cheaper", {{"of", of}});
    case EconomyVerdict::integer_cheaper:
      return prose("economy", "integer-cheaper", {{"of", of}});
    case EconomyVerdict::equal:
      return prose("economy", "equal", {{"of", of}});
    case EconomyVerdict::depends:
      return prose("economy", "depends", {{"of", of}});
    case EconomyVerdict::neither:
      return prose("economy", "neither", {{"of", of}, {"most", std::to_string(economy.most_parameters)}});
  }
  return {};
}

// One sentence, in which what holds of N and of -1/N is said once.
std::string verdict_of(const std::vector<Case>& cases) {
  std::string sentence;
  for (std::size_t i = 0; i < cases.size(); ++i) {
    const Case& each = cases[i];
    const bool begins = i == 0 || cases[i - 1].id != each.id;
    sentence += begins ? (i == 0 ? "" : "; ") + each.where + " " : ", and ";
    const bool alike = i + 1 < cases.size() && cases[i + 1].id == each.id &&
                       words_of(each.economy, "") == words_of(cases[i + 1].economy, "");
    sentence += words_of(each.economy, alike ? prose("economy", "both") : symbol_of(each.quantity));
    if (alike) ++i;
  }
  if (sentence.front() >= 'a' && sentence.front() <= 'z') sentence.front() += 'A' - 'a';
  return prose("economy", "verdict", {{"sentence", sentence}});
}

void add_facts(Section& section, const Case& each) {
  const std::string name = each.id + "_" + std::string(to_string(each.quantity));
  section.fact("economy_" + name, std::string(to_string(each.economy.verdict)));
  for (const bool fractional : {true, false}) {
    const auto least = fewest(each.economy, 1e-3, fractional);
    section.fact(std::string(fractional ? "fractional" : "whole") + "_parameters_" + name,
                 least ? static_cast<double>(*least) : std::nan(""));
  }
  if (const auto* const curve = curve_of(each.economy, EconomyClass::given))
    section.fact("static_error_" + name, curve->points.front().error);
}

}  // namespace

Section economy_section(const Work& work, const Bands& bands) {
  Section section = open_section("economy");
  std::vector<Case> cases;
  const auto add = [&](const std::string& id, const std::string& name, const std::string& where,
                       const std::vector<DescribingFunctionPoint>& points) {
    if (points.empty()) return;
    const std::string range =
        ", " + html_number(points.front().omega, 3) + " … " + html_number(points.back().omega, 3) + " rad/s";
    for (const Quantity quantity : quantities)
      cases.push_back({id, where + range + ",", name + range, quantity, &points});
  };
  add("chatter", "chatter", prose("economy", "where-chatter"), bands.chatter);
  add("between", "between", prose("economy", "where-between"), bands.between);
  add("two-impact", "two impacts", prose("economy", "where-two-impacts"), bands.two_impact);
  std::vector<char> is_told(cases.size());
  frac::parallel_for(cases.size(), work.threads, [&](std::size_t i) {
    const auto samples = samples_of(work.scene, cases[i]);
    if (!samples) return;
    frac::EconomyOptions options;
    options.component = frac::Component::imaginary;
    cases[i].economy = frac::economy(samples->data, samples->given, options, 1);
    is_told[i] = 1;
  });
  for (std::size_t i = cases.size(); i-- > 0;) {
    if (!is_told[i]) cases.erase(cases.begin() + static_cast<std::ptrdiff_t>(i));
  }
  if (cases.empty()) {
    section.add(paragraph("economy", "no-band"));
    return section;
  }
  Figure figure{"economy", prose("economy", "figure"), {}, 2, 200};
  figure.verdict = verdict_of(cases);
  for (const Case& each : cases) {
    figure.panels.push_back(panel_of(each));
    add_facts(section, each);
  }
  figure.panels.at(figure.panels.size() > 1 ? 1 : 0).key = true;  // beside the first row
  section.add(std::move(figure));
  section.add(needs_table(cases));
  section.add(points_table(cases));
  return section;
}

}  // namespace report
