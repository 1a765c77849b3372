// SPDX-License-Identifier: BSD-3-Clause
#include "backlash/identification/scene_comparison.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <map>
#include <optional>
#include <stdexcept>
#include <utility>

#include "backlash/static_backlash.hpp"
#include "base/median.hpp"
#include "base/short_text.hpp"
#include "frac/identification/identify.hpp"
#include "frac/identification/statistics.hpp"

namespace backlash {
namespace {

using frac::detail::short_text;
using Complex = std::complex<double>;

constexpr double decisive = 10;  // Burnham, Anderson (2002): "essentially no support" for the other

struct ComparedCurve {
  double force;
  std::vector<double> omega;
  std::vector<Complex> value;
  std::vector<double> sigma;
  std::vector<Complex> scene;
};

std::vector<ComparedCurve> compared_curves(const std::vector<MeasuredDescribingFunction>& curves,
                                           const SceneIdentification& identification) {
  std::vector<ComparedCurve> result(curves.size());
  std::size_t total = 0;
  for (const MeasuredDescribingFunction& curve : curves) total += curve.data.size();
  if (identification.points.size() != total) {
    throw std::invalid_argument("the identification has " + std::to_string(identification.points.size()) +
                                " points, the curves " + std::to_string(total) +
                                "; they must belong together, and the identification must have had a usable start");
  }
  for (const ScenePoint& point : identification.points) {
    const bool fits = point.curve < curves.size() && point.index < curves[point.curve].data.size() &&
                      curves[point.curve].data.omega()[point.index] == point.omega;
    if (!fits) throw std::invalid_argument("the identification does not belong to these curves");
    if (point.status == PointStatus::irregular) continue;
    const MeasuredDescribingFunction& curve = curves[point.curve];
    if (curve.harmonic != 1) continue;
    ComparedCurve& compared = result[point.curve];
    compared.force = curve.force_amplitude;
    compared.omega.push_back(point.omega);
    compared.value.push_back(curve.data.value()[point.index]);
    if (!curve.data.sigma().empty()) compared.sigma.push_back(curve.data.sigma()[point.index]);
    compared.scene.push_back(point.model);
  }
  std::erase_if(result, [](const ComparedCurve& curve) { return curve.omega.empty(); });
  return result;
}

// Static curve at frequencies that may repeat.
std::vector<Complex> static_curve(double mass, double clearance, const ComparedCurve& curve) {
  std::vector<double> grid = curve.omega;
  grid.erase(std::unique(grid.begin(), grid.end()), grid.end());
  // The static model depends on the sum of the masses only.
  const std::vector<Complex> values = static_describing_function(0.5 * mass, 0.5 * mass, clearance, curve.force, grid);
  std::vector<Complex> result;
  std::size_t at = 0;
  for (const double omega : curve.omega) {
    while (grid[at] != omega) ++at;
    result.push_back(values[at]);
  }
  return result;
}

double deviation_of(const ComparedCurve& curve, std::size_t i, frac::Weight weight) {
  return weight == frac::Weight::given      ? curve.sigma[i]
         : weight == frac::Weight::relative ? std::abs(curve.value[i])
                                            : 1;
}

double static_cost(double mass, double clearance, const std::vector<ComparedCurve>& curves,
                   const SceneIdentificationOptions& options) {
  double cost = 0;
  for (const ComparedCurve& curve : curves) {
    const std::vector<Complex> model = static_curve(mass, clearance, curve);
    for (std::size_t i = 0; i < model.size(); ++i) {
      const double deviation = deviation_of(curve, i, options.weight);
      const Complex residual = (model[i] - curve.value[i]) / deviation;
      if (options.component != frac::Component::imaginary) cost += residual.real() * residual.real();
      if (options.component != frac::Component::real) cost += residual.imag() * residual.imag();
    }
  }
  return cost;
}

struct StaticScene {
  double mass, clearance;
  std::size_t free_parameters;
};

std::optional<double> fixed_value(const SceneIdentificationOptions& options, std::string_view name) {
  for (const frac::ParameterConstraint& constraint : options.constraints) {
    if (constraint.name == name) return constraint.fixed;
  }
  return std::nullopt;
}

// Least squares for mass1 + mass2 and clearance: a grid, then a compass search, since the curve has kinks where the
// amplitude passes half of the clearance.
StaticScene fit_static(const std::vector<ComparedCurve>& curves, const SceneIdentificationOptions& options) {
  std::vector<double> masses;
  for (const ComparedCurve& curve : curves) {
    for (std::size_t i = 0; i < curve.omega.size(); ++i) {
      const double size = std::abs(curve.value[i]);
      if (size > 0) masses.push_back(1 / (size * curve.omega[i] * curve.omega[i]));
    }
  }
  const auto mass1 = fixed_value(options, "mass1");
  const auto mass2 = fixed_value(options, "mass2");
  const auto clearance = fixed_value(options, "clearance");
  const bool free_mass = !(mass1 && mass2);
  const double log_mass = std::log(free_mass ? frac::detail::median(masses) : *mass1 + *mass2);
  std::vector<double> amplitudes;
  for (const ComparedCurve& curve : curves) {
    for (const double omega : curve.omega) amplitudes.push_back(curve.force / (std::exp(log_mass) * omega * omega));
  }
  const double log_clearance = std::log(clearance ? *clearance : frac::detail::median(amplitudes));
  constexpr int half_grid = 12;
  constexpr double grid_step = 0.25;
  std::array<double, 2> best = {log_mass, log_clearance};
  const auto cost = [&](const std::array<double, 2>& at) {
    return static_cost(std::exp(at[0]), std::exp(at[1]), curves, options);
  };
  double least = cost(best);
  for (int i = free_mass ? -half_grid : 0; i <= (free_mass ? half_grid : 0); ++i) {
    for (int j = clearance ? 0 : -2 * half_grid; j <= (clearance ? 0 : half_grid); ++j) {
      const std::array<double, 2> at = {log_mass + grid_step * i, log_clearance + grid_step * j};
      const double here = cost(at);
      if (here < least) {
        least = here;
        best = at;
      }
    }
  }
  for (double step = grid_step; step > 1e-7;) {
    bool moved = false;
    for (const auto& [k, sign] : {std::pair{0, 1}, {0, -1}, {1, 1}, {1, -1}}) {
      if ((k == 0 && !free_mass) || (k == 1 && clearance)) continue;
      std::array<double, 2> at = best;
      at[static_cast<std::size_t>(k)] += sign * step;
      const double here = cost(at);
      if (here < least) {
        least = here;
        best = at;
        moved = true;
      }
    }
    if (!moved) step *= 0.5;
  }
  return {std::exp(best[0]), std::exp(best[1]), std::size_t{free_mass} + std::size_t{!clearance}};
}

struct Total {
  Explanation explanation;
  double cost = 0;
  std::size_t free_parameters = 0;
  std::size_t curves = 0;
};

Explanation explanation_of(frac::ModelClass model_class, const std::string& name) {
  if (model_class == frac::ModelClass::fractional) return Explanation::fractional;
  if (model_class == frac::ModelClass::integer_order) return Explanation::integer_order;
  return name == to_string(Explanation::two_masses) ? Explanation::two_masses : Explanation::static_backlash;
}

std::string sentence_of(const SceneComparison& comparison) {
  const ExplanationFit& best = comparison.ranking.front();
  std::string text = std::string(to_string(best.explanation));
  if (best.name != text) text += " ('" + best.name + "')";
  text += ", rms " + short_text(best.rms) + " with " + std::to_string(best.free_parameters) + " free parameters, ";
  if (comparison.ranking.size() == 1) return text + "is the only explanation that could be compared.";
  const ExplanationFit& next = comparison.ranking[1];
  text += next.delta_aicc > decisive ? "explains the data best" : "is ahead, but not decisively";
  return text + "; next is " + std::string(to_string(next.explanation)) + ", rms " + short_text(next.rms) + " with " +
         std::to_string(next.free_parameters) + ", AICc " + short_text(next.delta_aicc) + " above.";
}

}  // namespace

std::string_view to_string(Explanation explanation) {
  switch (explanation) {
    case Explanation::two_masses:
      return "two-masses";
    case Explanation::static_backlash:
      return "static-backlash";
    case Explanation::fractional:
      return "fractional";
    case Explanation::integer_order:
      return "integer-order";
  }
  return "unknown";
}

SceneComparison compare_explanations(const std::vector<MeasuredDescribingFunction>& curves,
                                     const SceneIdentificationOptions& options,
                                     const SceneIdentification& identification,
                                     const std::vector<frac::NamedModel>& models) {
  const std::vector<ComparedCurve> compared = compared_curves(curves, identification);
  if (compared.empty()) throw std::invalid_argument("the identified scene has a definite motion at no point");
  SceneComparison result{};
  std::optional<StaticScene> static_scene;
  if (options.output == Output::x1) {
    static_scene = fit_static(compared, options);
  } else {
    result.skipped.emplace_back("static-backlash: it describes x1, the data are of x2");
  }

  frac::FitOptions fit_options;
  fit_options.component = options.component;
  fit_options.weight = options.weight;
  std::map<std::string, Total> totals;
  double unit = 0;  // sum of squares of the data
  for (const ComparedCurve& curve : compared) {
    std::vector<frac::FixedCurve> fixed = {{std::string(to_string(Explanation::two_masses)), curve.scene}};
    if (static_scene) {
      fixed.push_back({std::string(to_string(Explanation::static_backlash)),
                       static_curve(static_scene->mass, static_scene->clearance, curve)});
    }
    const frac::FrequencyResponseData data(curve.omega, curve.value, curve.sigma);
    const frac::IdentificationResult identified = frac::identify(data, models, fixed, fit_options, options.threads);
    for (const frac::RankedFit& ranked : identified.ranking) {
      Total& total = totals[ranked.name];
      total.explanation = explanation_of(ranked.model_class, ranked.name);
      total.cost += ranked.fit.cost;
      total.free_parameters += ranked.fit.free_parameters;
      ++total.curves;
    }
    for (const std::string& reason : identified.skipped) {
      result.skipped.push_back("force " + short_text(curve.force) + " N: " + reason);
    }
    result.points += curve.omega.size();
    for (std::size_t i = 0; i < curve.omega.size(); ++i) {
      const double deviation = deviation_of(curve, i, options.weight);
      unit += std::norm(curve.value[i]) / (deviation * deviation);
    }
  }
  result.residuals = result.points * (options.component == frac::Component::both ? 2 : 1);
  const auto residuals = static_cast<double>(result.residuals);
  for (auto& [name, total] : totals) {
    if (total.curves != compared.size()) continue;
    if (total.explanation == Explanation::two_masses) total.free_parameters = identification.free_parameters;
    if (total.explanation == Explanation::static_backlash) total.free_parameters = static_scene->free_parameters;
    const ExplanationFit fit{
        total.explanation,
        name,
        total.cost,
        std::sqrt(total.cost / residuals),
        total.free_parameters,
        frac::information_criteria(total.cost, result.residuals, total.free_parameters, 1e-30 * unit).aicc,
        0};
    const auto rival = std::find_if(result.ranking.begin(), result.ranking.end(),
                                    [&](const ExplanationFit& other) { return other.explanation == fit.explanation; });
    if (rival == result.ranking.end()) {
      result.ranking.push_back(fit);
    } else if (fit.aicc < rival->aicc) {
      *rival = fit;
    }
  }
  std::stable_sort(result.ranking.begin(), result.ranking.end(),
                   [](const ExplanationFit& one, const ExplanationFit& other) { return one.aicc < other.aicc; });
  for (ExplanationFit& fit : result.ranking) fit.delta_aicc = fit.aicc - result.ranking.front().aicc;
  result.sentence = sentence_of(result);
  return result;
}

}  // namespace backlash
