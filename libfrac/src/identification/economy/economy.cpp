// SPDX-License-Identifier: BSD-3-Clause
#include "frac/identification/economy.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <functional>
#include <map>
#include <stdexcept>
#include <utility>

#include "base/counted.hpp"
#include "base/short_text.hpp"
#include "base/spelling.hpp"
#include "economy_search.hpp"
#include "frac/parallel_for.hpp"

namespace frac {
namespace {

constexpr std::array errors = {1e-2, 1e-3, 1e-4};

constexpr detail::Spellings<EconomyClass, 7> class_names = {{
    {EconomyClass::real_powers, "real-powers"},
    {EconomyClass::integer_powers_of_s, "integer-powers-of-s"},
    {EconomyClass::integer_powers_of_omega, "integer-powers-of-omega"},
    {EconomyClass::rational, "rational"},
    {EconomyClass::commensurate, "commensurate"},
    {EconomyClass::terms, "terms"},
    {EconomyClass::given, "given"},
}};
constexpr detail::Spellings<EconomyClass, 7> descriptions = {{
    {EconomyClass::real_powers, "real powers"},
    {EconomyClass::integer_powers_of_s, "whole powers of s"},
    {EconomyClass::integer_powers_of_omega, "whole powers of omega"},
    {EconomyClass::rational, "ratios in s"},
    {EconomyClass::commensurate, "ratios in s^q"},
    {EconomyClass::terms, "arcs, modes, powers"},
    {EconomyClass::given, "given curve"},
}};
constexpr detail::Spellings<EconomyVerdict, 5> verdict_names = {{
    {EconomyVerdict::fractional_cheaper, "fractional-cheaper"},
    {EconomyVerdict::integer_cheaper, "integer-cheaper"},
    {EconomyVerdict::equal, "equal"},
    {EconomyVerdict::depends, "depends-on-error"},
    {EconomyVerdict::neither, "neither"},
}};

double part_of(std::complex<double> value, Component component) {
  return component == Component::imaginary ? value.imag()
         : component == Component::real    ? value.real()
                                           : std::abs(value);
}

std::string quantity_of(Component component) {
  return component == Component::both ? "value" : std::string(to_string(component)) + " part";
}

/// Weights of residuals relative to the component.
detail::ResidualRule relative_rule(const FrequencyResponseData& data, Component component) {
  detail::ResidualRule rule{component == Component::both        ? detail::ResidualForm::cartesian
                            : component == Component::imaginary ? detail::ResidualForm::imaginary
                                                                : detail::ResidualForm::real,
                            {},
                            1};
  for (std::size_t i = 0; i < data.size(); ++i) {
    const double size = std::abs(part_of(data.value()[i], component));
    if (!(size > 0) || !std::isfinite(1 / size)) {
      const FrequencyUnit unit = data.frequency_unit();
      throw std::invalid_argument(
          "the " + quantity_of(component) + (unit == FrequencyUnit::hertz ? " at f = " : " at omega = ") +
          detail::short_text(in_unit(data.omega()[i], unit), 6) + " " + std::string(to_string(unit)) + " is " +
          detail::short_text(size) + ", where no relative error exists");
    }
    rule.weight.push_back(1 / size);
  }
  return rule;
}

EconomyOptions checked(const FrequencyResponseData& data, EconomyOptions options) {
  if (options.component != Component::imaginary && options.component != Component::real &&
      options.component != Component::both) {
    throw std::invalid_argument("component " + std::string(to_string(options.component)) +
                                ": economy is told of imaginary, real or both");
  }
  constexpr std::size_t most = 8;
  if (options.most_parameters < 1 || options.most_parameters > most) {
    throw std::invalid_argument("most parameters = " + std::to_string(options.most_parameters) + "; allowed is 1 to " +
                                std::to_string(most));
  }
  constexpr int largest = 9;
  if (options.largest_power < 1 || options.largest_power > largest) {
    throw std::invalid_argument("largest power = " + std::to_string(options.largest_power) + "; allowed is 1 to " +
                                std::to_string(largest));
  }
  // As many parameters as numbers meet any data.
  const std::size_t numbers = data.size() * (options.component == Component::both ? 2 : 1);
  if (numbers < 2) {
    throw std::invalid_argument("a single value of the " + quantity_of(options.component) +
                                " is met by any one parameter; economy needs at least two");
  }
  options.most_parameters = std::min(options.most_parameters, numbers - 1);
  return options;
}

EconomyCurve economy_of_given(const detail::EconomyProblem& problem, const FixedCurve& curve) {
  if (curve.value.size() != problem.data.size()) {
    throw std::invalid_argument("curve '" + curve.name + "' has " + std::to_string(curve.value.size()) +
                                " values for " + std::to_string(problem.data.size()) + " frequencies");
  }
  double cost = 0;
  for (const double each : detail::curve_residuals(problem.data, problem.rule, curve.value)) cost += each * each;
  return {curve.name,
          EconomyClass::given,
          {{curve.fitted_parameters, detail::economy_error(problem, cost), true, false, curve.name}}};
}

/// Fewest parameters of models of whole orders, or of others, for an error.
struct Cheapest {
  const EconomyPoint* point = nullptr;
  const EconomyCurve* curve = nullptr;
};
Cheapest cheapest(const std::vector<EconomyCurve>& curves, double error, bool fractional) {
  Cheapest best;
  for (const EconomyCurve& curve : curves) {
    if (curve.model_class == EconomyClass::given) continue;
    for (const EconomyPoint& point : curve.points) {
      if (point.fractional != fractional || point.error > error) continue;
      if (!best.point || point.parameters < best.point->parameters) best = {&point, &curve};
      break;
    }
  }
  return best;
}

/// "2, 3 and more than 8"
std::string numbers_of(const std::array<Cheapest, errors.size()>& all, std::size_t most) {
  std::vector<std::string> texts;
  for (const Cheapest& each : all) {
    texts.push_back(each.point ? std::to_string(each.point->parameters) : "more than " + std::to_string(most));
  }
  return detail::listed(texts);
}

std::string classes_of(const std::array<Cheapest, errors.size()>& all) {
  std::vector<std::string> names;
  for (const Cheapest& each : all) {
    if (!each.curve) continue;
    const std::string name(description(each.curve->model_class));
    if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
  }
  return names.empty() ? "" : " (" + detail::listed(names) + ")";
}

/// A ratio in s is one in s^q with q = 1, a parameter more.
void contain(EconomyCurve& commensurate, const EconomyCurve& rational, std::size_t most) {
  std::vector<EconomyPoint> points = std::move(commensurate.points);
  for (EconomyPoint point : rational.points) {
    if (++point.parameters <= most) points.push_back(std::move(point));
  }
  std::stable_sort(points.begin(), points.end(), [](const EconomyPoint& a, const EconomyPoint& b) {
    return std::pair(a.parameters, a.error) < std::pair(b.parameters, b.error);
  });
  commensurate.points.clear();
  for (EconomyPoint& point : points) detail::add_point(commensurate, std::move(point));
}

/// The simplest model that leaves nothing but rounding.
const EconomyPoint* exact_law(const std::vector<EconomyCurve>& curves) {
  const EconomyPoint* simplest = nullptr;
  for (const EconomyCurve& curve : curves) {
    if (curve.model_class == EconomyClass::given) continue;
    const EconomyPoint* const point = curve.within(detail::economy_rounding);
    if (point && (!simplest || point->parameters < simplest->parameters)) simplest = point;
  }
  return simplest;
}

void judge(Economy& result) {
  std::array<Cheapest, errors.size()> fractional, integer;
  int fewer = 0, more = 0, reached = 0;
  for (std::size_t i = 0; i < errors.size(); ++i) {
    fractional[i] = cheapest(result.curves, errors[i], true);
    integer[i] = cheapest(result.curves, errors[i], false);
    const std::size_t beyond = result.most_parameters + 1;
    const std::size_t f = fractional[i].point ? fractional[i].point->parameters : beyond,
                      n = integer[i].point ? integer[i].point->parameters : beyond;
    fewer += f < n ? 1 : 0;
    more += f > n ? 1 : 0;
    reached += std::min(f, n) < beyond ? 1 : 0;
  }
  result.verdict = reached == 0              ? EconomyVerdict::neither
                   : fewer == 0 && more == 0 ? EconomyVerdict::equal
                   : more == 0               ? EconomyVerdict::fractional_cheaper
                   : fewer == 0              ? EconomyVerdict::integer_cheaper
                                             : EconomyVerdict::depends;
  const std::string of = result.component == Component::both ? "the values" : "the " + quantity_of(result.component);
  if (result.verdict == EconomyVerdict::neither) {
    result.sentence = "No class of models follows " + of + " to 1 % with " +
                      detail::counted(result.most_parameters, "parameter") +
                      " or fewer: there is no simple law of either kind.";
    return;
  }
  if (const EconomyPoint* const exact = exact_law(result.curves)) {
    result.sentence = "There is an exact law: to rounding, " + of +
                      (result.component == Component::both ? " are " : " is ") + exact->model + ", with " +
                      detail::counted(exact->parameters, "parameter") + " and " +
                      (exact->fractional ? "a fractional order." : "whole orders alone.");
    return;
  }
  const std::string saving =
      result.verdict == EconomyVerdict::fractional_cheaper ? "a fractional order is the shorter description"
      : result.verdict == EconomyVerdict::integer_cheaper
          ? "a fractional order saves nothing, whole orders are the shorter description"
      : result.verdict == EconomyVerdict::equal ? "a fractional order neither saves nor costs a parameter"
                                                : "which is the shorter description depends on the error asked for";
  result.sentence = "To follow " + of + " to 1 %, 0.1 % and 0.01 %, models of whole orders need " +
                    numbers_of(integer, result.most_parameters) + " parameters" + classes_of(integer) +
                    ", models with a fractional order " + numbers_of(fractional, result.most_parameters) +
                    classes_of(fractional) + ": " + saving + ".";
}

}  // namespace

namespace detail {

Thinned scouted(const EconomyProblem& problem, std::size_t points) {
  Thinned few = thinned(problem.data, problem.rule, points);
  std::vector<double> stands_for(few.data.size(), 0.0);
  std::size_t nearest = 0;
  for (const double omega : problem.data.omega()) {
    const auto distance = [&](std::size_t i) { return std::abs(few.data.omega()[i] - omega); };
    while (nearest + 1 < few.data.size() && distance(nearest + 1) < distance(nearest)) ++nearest;
    ++stands_for[nearest];
  }
  for (std::size_t i = 0; i < stands_for.size(); ++i) few.rule.weight[i] *= std::sqrt(stands_for[i]);
  return few;
}

void add_point(EconomyCurve& curve, EconomyPoint point) {
  if (!std::isfinite(point.error)) return;
  if (!curve.points.empty() && !(point.error < curve.points.back().error)) return;
  if (!curve.points.empty() && curve.points.back().error <= economy_rounding) return;
  curve.points.push_back(std::move(point));
}

std::string signed_number(double value, bool first) {
  const std::string size = short_text(std::abs(value), 7);
  return (first ? (value < 0 ? "-" : "") : value < 0 ? " - " : " + ") + size;
}

std::string with_numbers(const NamedModel& model) {
  std::map<std::string, double, std::less<>> values;
  for (const ParameterConstraint& each : model.constraints) values[each.name] = each.start.value_or(0);
  std::string text;
  for (std::size_t i = 0; i < model.formula.size();) {
    std::size_t end = i;
    const auto is_part = [&](char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0; };
    while (end < model.formula.size() && is_part(model.formula[end])) ++end;
    if (end == i) {
      text += model.formula[i++];
      continue;
    }
    const auto value = values.find(std::string_view(model.formula).substr(i, end - i));
    if (value == values.end()) {
      text += model.formula.substr(i, end - i);
    } else {
      const std::string number = short_text(value->second, 7);
      text += value->second < 0 ? "(" + number + ")" : number;
    }
    i = end;
  }
  return text;
}

}  // namespace detail

std::string_view to_string(EconomyClass model_class) {
  return detail::spelling(class_names, model_class);
}
std::string_view description(EconomyClass model_class) {
  return detail::spelling(descriptions, model_class);
}
std::string_view to_string(EconomyVerdict verdict) {
  return detail::spelling(verdict_names, verdict);
}

std::span<const double> economy_errors() {
  return errors;
}

const EconomyPoint* EconomyCurve::within(double error) const {
  const auto found =
      std::find_if(points.begin(), points.end(), [&](const auto& point) { return point.error <= error; });
  return found == points.end() ? nullptr : &*found;
}

Economy economy(const FrequencyResponseData& data, const std::vector<FixedCurve>& curves, const EconomyOptions& options,
                int threads) {
  const EconomyOptions used = checked(data, options);
  const detail::EconomyProblem problem{data, relative_rule(data, used.component), used};
  using Search = std::function<EconomyCurve()>;
  std::vector<Search> searches{
      [&] { return detail::economy_of_ratios(problem, EconomyClass::commensurate); },  // what takes longest first
      [&] { return detail::economy_of_ratios(problem, EconomyClass::rational); },
      [&] { return detail::economy_of_terms(problem); },
      [&] { return detail::economy_of_real_powers(problem); },
      [&] { return detail::economy_of_integer_powers(problem, EconomyClass::integer_powers_of_s); },
  };
  if (used.component != Component::both) {
    searches.emplace_back(
        [&] { return detail::economy_of_integer_powers(problem, EconomyClass::integer_powers_of_omega); });
  }
  Economy result{used.component,           used.most_parameters,    std::vector<EconomyCurve>(searches.size()),
                 detail::economy_rounding, EconomyVerdict::neither, {}};
  for (const FixedCurve& curve : curves) result.curves.push_back(economy_of_given(problem, curve));
  parallel_for(searches.size(), threads, [&](std::size_t i) { result.curves[i] = searches[i](); });
  contain(result.curves[0], result.curves[1], used.most_parameters);
  std::stable_sort(result.curves.begin(), result.curves.end(),
                   [](const auto& a, const auto& b) { return a.model_class < b.model_class; });
  judge(result);
  return result;
}

}  // namespace frac
