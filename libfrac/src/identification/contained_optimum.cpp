// SPDX-License-Identifier: BSD-3-Clause
#include "identification/contained_optimum.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <map>
#include <mutex>
#include <set>
#include <stdexcept>
#include <string>
#include <utility>

#include "formula/canonical_form.hpp"
#include "frac/identification/constraints.hpp"
#include "identification/recognised_preset.hpp"
#include "identification/residuals/parameter_map.hpp"
#include "identification/search/global_search.hpp"

namespace frac::detail {
namespace {

constexpr double rounding = 1e-9;  // of costs, and of values that follow from one another
constexpr double hardly_anything = 1e-6, nearly_nothing = 1e-14, nothing = 1e-18;

std::vector<double> values_of(const FitResult& fit, const Structure& structure) {
  std::vector<double> values;
  for (std::size_t i = 0; i < structure.parameter_names().size(); ++i) values.push_back(fit.parameters[i].value);
  return values;
}

/// Two points within the limits of a preset: near either end of its orders, and with gains of either sign.
std::vector<std::vector<double>> points_of(const NamedModel& preset) {
  const ParameterMap map(Structure(preset.formula), preset.constraints, {1, 1, 1, 1, 1, 1});
  std::vector<std::vector<double>> points;
  for (const double share : {0.13, 0.87}) {
    std::vector<double> theta;
    for (const ParameterMap::Free& entry : map.free()) {
      const double apart = 0.1 * static_cast<double>(theta.size() + 1);  // no two are alike
      const bool is_order = entry.role == ParameterRole::order;
      const double sign = entry.either_sign && share < 0.5 ? -1 : 1;
      theta.push_back(is_order ? entry.lower + share * (entry.upper - entry.lower) : sign * (share + apart));
    }
    points.push_back(map.to_user(theta));
  }
  return points;
}

/// Where a structure is a preset at each of points_of(); fewer where it is not always that.
std::vector<std::vector<double>> where_contained(const Structure& structure, const std::vector<ParameterLimits>& limits,
                                                 const NamedModel& preset) {
  std::vector<std::vector<double>> where;
  const Structure simple(preset.formula);
  for (const std::vector<double>& point : points_of(preset)) {
    const std::optional<Containment> found = contained_in(structure, limits, simple, point, 1, 1);
    if (!found) return {};
    where.push_back(found->values);
  }
  return where;
}

/// Limits without what holds or narrows coefficients, which says nothing of the structure.
std::vector<ParameterLimits> widened(const Structure& structure, std::vector<ParameterLimits> limits) {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < limits.size(); ++i) {
    const bool is_order = structure.parameter_roles()[i] == ParameterRole::order;
    auto& [lower, upper] = limits[i];
    if (is_order && lower == upper) {
      lower = -4;
      upper = 4;
    } else if (!is_order) {
      const bool is_gain =
          structure.parameter_roles()[i] == ParameterRole::coefficient && !structure.parameter_keeps_sign()[i];
      lower = lower < 0 || (lower == upper && is_gain) ? -infinity : 0;
      upper = infinity;
    }
  }
  return limits;
}

/// A preset that a structure contains, and where.
struct ContainedPreset {
  const NamedModel* preset;
  std::vector<std::vector<double>> where;
};

/// largest_contained(), derived once for each structure: fits of many curves ask for the same one.
std::vector<ContainedPreset> contained_presets(const Structure& structure, const std::vector<ParameterLimits>& limits) {
  constexpr std::size_t most_kept = 1000;  // structures, each of some hundred bytes
  static std::mutex mutex;
  static std::map<std::pair<std::string, std::vector<double>>, std::vector<ContainedPreset>> kept;
  std::pair<std::string, std::vector<double>> key{structure.formula(), {}};
  for (const auto& [lower, upper] : limits) key.second.insert(key.second.end(), {lower, upper});
  {
    const std::lock_guard lock(mutex);
    if (const auto found = kept.find(key); found != kept.end()) return found->second;
  }
  std::vector<ContainedPreset> result;
  for (const NamedModel* preset : largest_contained(structure, limits))
    result.push_back({preset, where_contained(structure, limits, *preset)});
  const std::lock_guard lock(mutex);
  if (kept.size() >= most_kept) kept.clear();
  return kept.insert_or_assign(std::move(key), std::move(result)).first->second;
}

/// What is said of parameters of a structure, said of those of a preset that it contains: of those that have the same
/// value wherever it is that.  Its own limits hold for the others.
std::vector<ParameterConstraint> constraints_on(const NamedModel& preset, const Structure& structure,
                                                const std::vector<std::vector<double>>& where,
                                                const std::vector<ParameterConstraint>& constraints) {
  const Structure simple(preset.formula);
  const auto points = points_of(preset);
  std::vector<std::string> names, names_in_preset;
  for (std::size_t j = 0; j < simple.parameter_names().size(); ++j) {
    for (std::size_t i = 0; i < structure.parameter_names().size(); ++i) {
      bool same = true;
      for (std::size_t point = 0; point < where.size(); ++point)
        same = same && std::abs(where[point][i] - points[point][j]) <= rounding * std::abs(points[point][j]);
      if (!same) continue;
      names.push_back(structure.parameter_names()[i]);
      names_in_preset.push_back(simple.parameter_names()[j]);
      break;
    }
  }
  std::vector<ParameterConstraint> result = renamed(constraints, names, names_in_preset);
  for (const ParameterConstraint& own : preset.constraints) {
    const bool said =
        std::any_of(result.begin(), result.end(), [&](const auto& each) { return each.name == own.name; });
    if (!said) result.push_back(own);
  }
  return result;
}

/// Where a structure is another one at its optimum.
std::optional<Containment> containment_of(const Structure& structure, const std::vector<ParameterLimits>& limits,
                                          const FitResult& simple) {
  const Structure contained(simple.model);
  const std::vector<double> values = values_of(simple, contained);
  const double gain = std::abs(contained.response(values, simple.centre_omega));
  return contained_in(structure, limits, contained, values, gain, simple.centre_omega);
}

/// The fit, or another one of the same structure where that is lower: a minimum that the search has not seen.
FitResult lower_of(FitResult fit, std::optional<FitResult> other) {
  if (!other || !(other->cost < fit.cost)) return fit;
  other->starts = fit.starts + 1;
  other->starts_at_best = 1;
  other->distinct_minima = fit.distinct_minima + 1;
  other->confidence_of_optimum = confidence_of_optimum(other->starts, other->distinct_minima);
  other->seconds += fit.seconds;
  return std::move(*other);
}

/// The fit, or where the optimum of a structure that it contains is lower the fit from there.
/// @param clearly  share of the cost that it has to be lower by
FitResult no_worse_than(const FitResult& optimum, double clearly, const std::vector<ParameterConstraint>& constraints,
                        const FitOfData& fit_of, FitResult fit) {
  fit.seconds += optimum.seconds;
  if (!(optimum.cost < fit.cost * (1 - clearly))) return fit;
  return lower_of(fit, fit_from_contained(fit, optimum, constraints, fit_of));
}

/// The terms of the outermost sum, each with its sign and in parentheses.
void add_terms(const Expression& expression, const Node& node, bool negative, std::vector<std::string>& terms) {
  const auto operand = [&](int index) -> const Node& { return expression.nodes[static_cast<std::size_t>(index)]; };
  switch (node.operation) {
    case Operation::add:
    case Operation::subtract:
      add_terms(expression, operand(node.left), negative, terms);
      return add_terms(expression, operand(node.right), negative != (node.operation == Operation::subtract), terms);
    case Operation::negate:
      return add_terms(expression, operand(node.left), !negative, terms);
    default:
      terms.push_back((negative ? "-(" : "+(") + std::string(expression.text_of(node)) + ")");
  }
}

/// The structure without each of the terms of its outermost sum, those that are alike once.  Left out are what does not
/// depend on s, and presets, which have been asked already.
std::vector<Structure> without_a_term(const Structure& structure) {
  std::vector<std::string> terms;
  add_terms(structure.expression(), structure.expression().nodes.back(), false, terms);
  std::vector<Structure> result;
  if (terms.size() < 2) return result;
  std::set<std::string> shapes;
  for (std::size_t left_out = 0; left_out < terms.size(); ++left_out) {
    std::string formula;
    for (std::size_t i = 0; i < terms.size(); ++i) {
      if (i != left_out) formula += formula.empty() && terms[i][0] == '+' ? terms[i].substr(1) : terms[i];
    }
    Structure contained(formula);
    const bool simpler = contained.parameter_names().size() < structure.parameter_names().size();
    if (!simpler || !contained.depends_on_s() || recognised_preset(contained)) continue;
    if (shapes.insert(shape_of(contained.expression())).second) result.push_back(std::move(contained));
  }
  return result;
}

}  // namespace

std::vector<ParameterLimits> limits_in_force(const FitResult& fit) {
  std::vector<ParameterLimits> limits;
  const std::size_t own = Structure(fit.model).parameter_names().size();
  for (std::size_t i = 0; i < own; ++i) {
    const ParameterEstimate& each = fit.parameters[i];
    limits.push_back(each.fixed ? ParameterLimits{each.value, each.value}
                                : ParameterLimits{each.lower_limit, each.upper_limit});
  }
  return limits;
}

std::vector<ParameterLimits> limits_of(const NamedModel& model) {
  const ParameterMap map(Structure(model.formula), model.constraints, {1, 1, 1, 1, 1, 1});
  std::vector<ParameterLimits> limits(map.parameter_count());
  for (const ParameterMap::Free& entry : map.free()) limits[entry.parameter] = {entry.least, entry.most};
  return limits;
}

std::vector<const NamedModel*> largest_contained(const Structure& structure,
                                                 const std::vector<ParameterLimits>& limits) {
  std::vector<const NamedModel*> found;
  const auto parameters = [](const NamedModel& model) { return Structure(model.formula).parameter_names().size(); };
  for (const NamedModel& preset : model_library()) {
    if (parameters(preset) < structure.parameter_names().size() && !where_contained(structure, limits, preset).empty())
      found.push_back(&preset);
  }
  const auto contains = [&](const NamedModel& rich, const NamedModel& simple) {
    return parameters(simple) < parameters(rich) &&
           !where_contained(Structure(rich.formula), limits_of(rich), simple).empty();
  };
  std::vector<const NamedModel*> largest;
  for (const NamedModel* simple : found) {
    const bool inside =
        std::any_of(found.begin(), found.end(), [&](const auto* rich) { return contains(*rich, *simple); });
    if (!inside) largest.push_back(simple);
  }
  return largest;
}

std::optional<std::vector<double>> start_from_contained(const NamedModel& rich, const FitResult& simple) {
  const std::optional<Containment> found = containment_of(Structure(rich.formula), limits_of(rich), simple);
  return found ? std::optional(found->at(nothing)) : std::nullopt;
}

bool contains(const FitResult& rich, const FitResult& simple) {
  return containment_of(Structure(rich.model), limits_in_force(rich), simple).has_value();
}

std::optional<FitResult> fit_from_contained(const FitResult& rich, const FitResult& simple,
                                            const std::vector<ParameterConstraint>& constraints,
                                            const FitOfData& fit_of) {
  const Structure structure(rich.model);
  const std::optional<Containment> found = containment_of(structure, limits_in_force(rich), simple);
  if (!found) return std::nullopt;
  std::optional<FitResult> best;
  // What only a limit brings to nothing starts at a millionth, where it still has a slope to go down, and, if that ends
  // above the simpler optimum, at what changes no cost.
  for (const double smallness : {hardly_anything, nearly_nothing}) {
    const std::vector<double> start = found->at(smallness);
    std::vector<ParameterConstraint> warm = constraints;
    for (std::size_t i = 0; i < start.size(); ++i) {
      ParameterConstraint& own = constraint_of(warm, structure.parameter_names()[i]);
      if (!own.fixed) own.start = start[i];
    }
    try {
      FitResult fit = fit_of(structure, warm, FitFrom::start);
      if (!best || fit.cost < best->cost) best = std::move(fit);
    } catch (const std::invalid_argument&) {
      // The simpler structure has its optimum where the richer one is not allowed to be, or at infinity.
    }
    if (!found->is_limit() || (best && best->cost <= simple.cost * (1 + rounding))) break;
  }
  return best;
}

FitResult no_worse_than_contained(const Structure& structure, const std::vector<ParameterConstraint>& constraints,
                                  const FitOfData& fit_of, FitResult fit) {
  if (!(fit.cost > 0) || fit.termination == FitTermination::no_usable_start) return fit;
  // Residuals that are rounding cannot be beaten.
  if (fit.relative_rms <= rounding) return fit;
  const std::vector<ParameterLimits> limits = widened(structure, limits_in_force(fit));
  const auto compare = [&](const Structure& contained, const std::vector<ParameterConstraint>& of_contained,
                           FitFrom from, double clearly) {
    try {
      fit = no_worse_than(fit_of(contained, of_contained, from), clearly, constraints, fit_of, fit);
    } catch (const std::invalid_argument&) {
      // It is not allowed where the user wants the richer one.
    }
  };
  for (const auto& [preset, where] : contained_presets(structure, limits))
    compare(Structure(preset->formula), constraints_on(*preset, structure, where, constraints), FitFrom::search,
            rounding);
  for (const Structure& contained : without_a_term(structure)) {
    // A term that the fitted part is blind to changes the cost by no more than where solvers end.
    constexpr double solved = 1e-6;
    compare(contained, renamed(constraints, contained.parameter_names(), contained.parameter_names()),
            FitFrom::search_for_residuals, solved);
  }
  return fit;
}

}  // namespace frac::detail
