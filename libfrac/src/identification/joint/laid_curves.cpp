// SPDX-License-Identifier: BSD-3-Clause
#include "laid_curves.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <stdexcept>
#include <string>

#include "frac/identification/constraints.hpp"
#include "identification/data/fit_data.hpp"
#include "identification/statistics/definition.hpp"
#include "joint_confidence.hpp"
#include "joint_search.hpp"
#include "shift.hpp"
#include "special/distributions.hpp"

namespace frac::detail {
namespace {

/// Options on parameters of the structure itself, without shift factors and laws.
FitOptions options_of_master(const Structure& master, const JointFitOptions& options) {
  FitOptions of_master = options.fit;
  const auto& names = master.parameter_names();
  std::erase_if(of_master.constraints, [&](const ParameterConstraint& each) {
    return std::find(names.begin(), names.end(), each.name) == names.end();
  });
  return of_master;
}

Preparation from_superposition(const std::vector<JointCurve>& curves, const Structure& master,
                               const Structure& structure, const CurveShift& shift, const FitOptions& of_master) {
  const Superposition found = superposed(curves, master, shift, of_master);
  if (!found.master.usable())
    throw std::invalid_argument("no fit of " + master.formula() + " to all curves as one: " + found.master.message);
  Preparation result{Alone(curves.size()), {}, {}, std::vector<double>(curves.size(), found.master.rms)};
  if (!(found.master.rms > 0) || of_master.weight == Weight::given) result.noise.assign(curves.size(), 1.0);
  for (std::size_t c = 0; c < curves.size(); ++c) {
    std::vector<double>& values = result.values.parameters.emplace_back();
    for (const std::string& name : structure.parameter_names()) {
      const auto& known = found.master.parameters;
      const auto of = std::find_if(known.begin(), known.end(), [&](const auto& each) { return each.name == name; });
      values.push_back(name == horizontal_shift ? found.horizontal[c]
                       : name == vertical_shift ? found.vertical[c]
                                                : of->value);
    }
    result.values.from_curve.push_back(false);
    result.values.lead_laws.push_back(1);
    result.settled.emplace_back(settled(of_master, found.master));
  }
  return result;
}

/// Shift factors of each curve in a list of values by the structure.
struct ShiftFactors {
  std::vector<double> horizontal, vertical;
};
ShiftFactors factors_in(const std::vector<std::vector<double>>& values, const Structure& structure) {
  ShiftFactors result;
  const std::size_t along = structure.parameter_index(horizontal_shift);
  const auto& names = structure.parameter_names();
  const auto up = std::find(names.begin(), names.end(), vertical_shift);
  for (const std::vector<double>& each : values) {
    result.horizontal.push_back(each[along]);
    result.vertical.push_back(up == names.end() ? 1 : each[static_cast<std::size_t>(up - names.begin())]);
  }
  return result;
}

void take_shifts(const std::vector<double>& from, const Structure& structure, std::vector<double>& values) {
  for (const char* name : {horizontal_shift, vertical_shift}) {
    const auto& names = structure.parameter_names();
    const auto place = static_cast<std::size_t>(std::find(names.begin(), names.end(), name) - names.begin());
    if (place < names.size()) values[place] = from[place];
  }
}

/// A fit to all curves as one, taken as the start of each.
void start_at(const FitResult& master, const Structure& structure, Preparation& known) {
  for (const ParameterEstimate& each : master.parameters) {
    const std::size_t place = structure.parameter_index(each.name);
    for (std::vector<double>& values : known.values.parameters) values[place] = each.value;
  }
}

/// The options without the laws of shift factors, and without what is said of parameters of these laws alone.
JointFitOptions with_free_shifts(const JointFitOptions& options, const Structure& structure,
                                 const std::vector<JointCurve>& curves, const Laws& laws) {
  JointFitOptions free = options;
  std::erase_if(free.laws, [&](const std::string& law) {
    const auto [driven, right] = split_definition(law);
    return driven == horizontal_shift || driven == vertical_shift;
  });
  const Laws left(structure, free, curves);
  std::erase_if(free.fit.constraints,
                [&](const ParameterConstraint& each) { return laws.has(each.name) && !left.has(each.name); });
  return free;
}

/// Weights of the shift factors of the curves: 1 over the standard error of their logarithms in white noise; what a
/// smooth error may add says nothing of where the law goes.  On a plateau it is 0.
std::vector<double> weights_of_shifts(JointSearch& search, const Structure& structure) {
  const JointConfidence found = joint_confidence(search.problem(), search.layout(), search.point);
  constexpr double least = 0.1, most = 10;  // a better one need not be followed more closely, a worse one tells nothing
  std::vector<double> error(found.curve.size(), least);
  for (const auto& place : search.layout().free) {
    const std::string& name = structure.parameter_names()[place.parameter];
    if (place.shared || (name != horizontal_shift && name != vertical_shift)) continue;
    const auto k = static_cast<Eigen::Index>(place.index);
    for (std::size_t c = 0; c < error.size(); ++c) {
      if (search.layout().is_held(c, place.index)) continue;
      const double here = found.own_at_bound[c][place.index]
                              ? most
                              : std::sqrt(found.curve[c](k, k)) / found.own_widening[c][place.index];
      error[c] = here < most ? std::max(error[c], here) : most;
    }
  }
  std::vector<double> weights;
  weights.reserve(error.size());
  for (const double each : error) weights.push_back(each < most ? 1 / each : 0);
  return weights;
}

/// Fits the curves with free shift factors, which then stand in what is known, with the noise they leave.  Where the
/// weight is learned it is learned anew with the curves where that fit lays them, until they stay: where neighbours
/// lay them first depends on the order of the curves.
/// @return  none where free factors are more than the residuals tell, or nothing was found
std::optional<FreeShifts> fit_free_shifts(const std::vector<JointCurve>& curves, const Structure& master,
                                          const Structure& structure, const JointFitOptions& options,
                                          const FitOptions& of_master, Preparation& known) {
  const Laws laws(structure, options, curves);
  const bool learns = options.fit.weight == Weight::learned && !options.fit.noise_floor;
  constexpr int most_rounds = 8;
  constexpr double stays = 1e-6;  // change of a factor, far below its interval
  const std::vector<std::vector<double>> laid = known.values.parameters;
  for (int round = 0; round < most_rounds; ++round) {
    JointSearch search(curves, structure, options, known, laws);
    JointFitResult counts{};
    search.run(options, known, counts);
    if (!std::isfinite(search.point.cost)) return std::nullopt;
    const ShiftFactors before = factors_in(known.values.parameters, structure);
    for (std::size_t c = 0; c < curves.size(); ++c) known.values.parameters[c] = search.parameters(c);
    if (!search.noise.empty()) known.noise = search.noise;
    const ShiftFactors now = factors_in(known.values.parameters, structure);
    double moved = 0;
    for (std::size_t c = 0; c < curves.size(); ++c)
      moved = std::max({moved, std::abs(std::log(now.horizontal[c] / before.horizontal[c])),
                        std::abs(std::log(now.vertical[c] / before.vertical[c]))});
    if (!learns || (round > 0 && moved < stays) || round + 1 == most_rounds) {
      known.values.lead_laws = weights_of_shifts(search, structure);
      // A factor that no residual holds has run away; where the curve was laid is near enough to start from.
      for (std::size_t c = 0; c < curves.size(); ++c)
        if (known.values.lead_laws[c] == 0) take_shifts(laid[c], structure, known.values.parameters[c]);
      return FreeShifts{cost_of_data(search.problem(), search.point).squares, search.unlikelihood, counts.residuals,
                        counts.free_parameters};
    }
    const FitResult all = fit_laid(curves, now.horizontal, now.vertical, master, of_master);
    if (!all.usable()) return std::nullopt;
    for (std::size_t c = 0; c < curves.size(); ++c) known.settled[c] = settled(options.fit, all);
  }
  return std::nullopt;
}

/// The chance that curves which follow the laws ask for free factors as strongly as these do.
double chance_of_laws(const FreeShifts& free, double squares, std::size_t free_parameters) {
  const double saved = static_cast<double>(free.free_parameters) - static_cast<double>(free_parameters);
  const double degrees = static_cast<double>(free.residuals) - static_cast<double>(free.free_parameters);
  if (!(saved > 0) || !(degrees > 0) || !(free.squares > 0)) return std::numeric_limits<double>::quiet_NaN();
  return fisher_f_above(std::max(0.0, squares - free.squares) / saved / (free.squares / degrees), saved, degrees);
}
constexpr double doubtful_chance = 0.01;

/// Puts the curves of what is known where the laws lay them.
Preparation placed_by(const std::vector<double>& values, const Laws& laws, Preparation known) {
  std::vector<double> gradient(values.size());
  for (std::size_t l = 0; l < laws.count(); ++l)
    for (std::size_t c = 0; c < known.values.parameters.size(); ++c)
      known.values.parameters[c][laws.parameter(l)] = laws.at(l, c, values, gradient);
  known.values.of_laws = values;
  return known;
}

bool are_drawn(const ShiftFactors& factors) {
  const auto is_drawn = [](double factor) {
    constexpr double widest = 1e100;
    return factor > 1 / widest && factor < widest;
  };
  return std::all_of(factors.horizontal.begin(), factors.horizontal.end(), is_drawn) &&
         std::all_of(factors.vertical.begin(), factors.vertical.end(), is_drawn);
}

/// Multiplies the factors by a common one, so that half of the curves lie below the others.
void move_onto(std::vector<double>& factors, const std::vector<double>& others) {
  std::vector<double> apart;
  for (std::size_t c = 0; c < factors.size(); ++c) apart.push_back(others[c] / factors[c]);
  const auto middle = apart.begin() + static_cast<std::ptrdiff_t>(apart.size() / 2);
  std::nth_element(apart.begin(), middle, apart.end());
  for (double& each : factors) each *= *middle;
}

bool are_alike(const std::vector<double>& one, const std::vector<double>& other) {
  constexpr double alike = 0.02;  // of a logarithm, from where a search ends in the same place
  for (std::size_t c = 0; c < one.size(); ++c)
    if (!(std::abs(std::log(one[c] / other[c])) < alike)) return false;
  return true;
}

/// A place where the laws may lay the curves: values of the laws' parameters, the shift factors they give up to one
/// that is common to all curves, and the rms that the structure leaves when it is fitted to all curves there.
struct Place {
  std::vector<double> values;
  ShiftFactors factors;
  double rms;
};

/// Places from several sets of values of the laws, each once, the best first.
std::vector<Place> places_of(const std::vector<std::vector<double>>& starts, const std::vector<JointCurve>& curves,
                             const Structure& master, const Structure& structure, const FitOptions& of_master,
                             const Laws& laws, const Preparation& known) {
  const ShiftFactors free = factors_in(known.values.parameters, structure);
  const FitResult centre = fit_laid(curves, free.horizontal, free.vertical, master, of_master);
  const FitOptions near_centre = centre.usable() ? started_at(of_master, centre) : of_master;
  std::vector<Place> places;
  for (const std::vector<double>& values : starts) {
    Place here{values, factors_in(placed_by(values, laws, known).values.parameters, structure), 0};
    if (!are_drawn(here.factors)) continue;
    move_onto(here.factors.horizontal, free.horizontal);
    move_onto(here.factors.vertical, free.vertical);
    if (std::any_of(places.begin(), places.end(), [&](const Place& each) {
          return are_alike(each.factors.horizontal, here.factors.horizontal) &&
                 are_alike(each.factors.vertical, here.factors.vertical);
        }))
      continue;
    const FitResult all = fit_laid(curves, here.factors.horizontal, here.factors.vertical, master, near_centre);
    here.rms = all.usable() ? all.rms : std::numeric_limits<double>::infinity();
    places.push_back(std::move(here));
  }
  std::stable_sort(places.begin(), places.end(),
                   [](const Place& one, const Place& other) { return one.rms < other.rms; });
  return places;
}

/// The preparation, with the curves where the laws lay them and the structure fitted to all of them there.
Preparation laid_by(const std::vector<double>& values, const std::vector<JointCurve>& curves, const Structure& master,
                    const Structure& structure, const FitOptions& of_master, const Laws& laws, Preparation known) {
  known = placed_by(values, laws, std::move(known));
  const ShiftFactors laid = factors_in(known.values.parameters, structure);
  const FitResult all = fit_laid(curves, laid.horizontal, laid.vertical, master, of_master);
  if (all.usable()) start_at(all, structure, known);
  return known;
}

/// The end of a search is better than another if its unlikelihood is less by this.
constexpr double clearly = 2;

/// Laws of shift factors say where the master curve itself stands, which need not be the reference: the structure is
/// fitted to all curves where the laws lay them.  Laws may follow the factors in several ways, of which some lay a
/// curve far off whose factor nothing determines, and a factor may be wrong itself; the place counts from which the
/// search leaves least.
/// @return  the unlikelihood of what that search leaves; infinite where there is none
double lay_by_laws(const std::vector<JointCurve>& curves, const Structure& master, const Structure& structure,
                   const JointFitOptions& options, const FitOptions& of_master, const Laws& laws, LaidCurves& laid) {
  JointFitOptions of_structure = options;
  const std::vector<double> given = given_starts(laws, taken_out(of_structure.fit.constraints, laws));
  const auto& factors = laid.known.values.parameters;
  auto starts = laws.starts(factors, laid.known.values.lead_laws, given);
  if (!given.empty() && std::none_of(given.begin(), given.end(), [](double each) { return std::isnan(each); }))
    starts.insert(starts.begin(), given);
  if (!laid.known.values.of_laws.empty()) starts.insert(starts.begin(), laid.known.values.of_laws);
  for (auto& each : laws.starts_of_neighbours(factors, given)) starts.push_back(std::move(each));
  const std::vector<Place> places = places_of(starts, curves, master, structure, of_master, laws, laid.known);
  double least = std::numeric_limits<double>::infinity();
  const Preparation free = laid.known;
  constexpr std::size_t most_searched = 4;
  for (std::size_t k = 0; k < std::min(places.size(), most_searched); ++k) {
    Preparation here = laid_by(places[k].values, curves, master, structure, of_master, laws, free);
    if (k == 0) laid.known = here;
    if (!laid.free || places.size() == 1) break;
    JointSearch search(curves, structure, options, here, laws);
    JointFitResult counts{};
    search.run(options, here, counts);
    // A search that does not end has parameters that run away, as those of a hyperbola that becomes a line.
    const double here_is = search.unlikelihood + (search.point.converged ? 0 : clearly);
    if (!(here_is < least) || !std::isfinite(search.point.cost)) continue;
    least = here_is;
    laid.known = std::move(here);
  }
  return least;
}

}  // namespace

void keep_shifts_positive(std::vector<ParameterConstraint>& constraints, const CurveShift& shift) {
  for (const char* name : {horizontal_shift, vertical_shift}) {
    if (name == vertical_shift && !shift.vertical) continue;
    ParameterConstraint& each = constraint_of(constraints, name);
    constexpr double largest = 1e150;
    each.positive = true;
    if (!each.fixed && !each.upper) each.upper = largest;
  }
}

LaidCurves lay_curves(const std::vector<JointCurve>& curves, const Structure& master, const Structure& structure,
                      const JointFitOptions& options, const JointFitOptions& without_laws, const Laws& laws) {
  const FitOptions of_master = options_of_master(master, without_laws);
  LaidCurves result{from_superposition(curves, master, structure, *options.shift, of_master), std::nullopt};
  const JointFitOptions free_options = with_free_shifts(options, structure, curves, laws);
  result.free = fit_free_shifts(curves, master, structure, free_options, of_master, result.known);
  if (!laws.drive_shifts()) return result;
  const double least = lay_by_laws(curves, master, structure, options, of_master, laws, result);
  // Free factors can take the values of any law.  If they end less likely, some curves lie in a wrong place, and the
  // search with free factors starts again from where the laws lay them.
  if (!result.free || !(least < result.free->unlikelihood - clearly)) return result;
  Preparation known = result.known;
  known.values.of_laws.clear();
  const auto free = fit_free_shifts(curves, master, structure, free_options, of_master, known);
  if (!free) return result;
  known.values.of_laws = std::move(result.known.values.of_laws);
  result = {std::move(known), free};
  lay_by_laws(curves, master, structure, options, of_master, laws, result);
  return result;
}

void compare_with_free(const FreeShifts& free, double squares, JointFitResult& result) {
  const double chance = chance_of_laws(free, squares, result.free_parameters);
  if (std::isnan(chance)) return;
  result.sharing_p_value = chance;
  if (!(chance < doubtful_chance) || !result.usable()) return;
  char text[240];
  std::snprintf(text, sizeof text,
                " The shift factors do not follow their law: by it residuals are %.3g times those with free factors, "
                "which chance explains with probability %.1e.",
                std::sqrt(squares / free.squares), result.sharing_p_value);
  result.message += text;
}

}  // namespace frac::detail
