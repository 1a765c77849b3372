// SPDX-License-Identifier: BSD-3-Clause
#include "frac/state_space.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <stdexcept>
#include <utility>

#include "base/bound_text.hpp"
#include "base/counted.hpp"
#include "base/number_text.hpp"
#include "base/short_text.hpp"
#include "base/spelling.hpp"
#include "demand_check.hpp"
#include "model_on_band.hpp"
#include "series_split.hpp"
#include "solved_states.hpp"

namespace frac {
namespace {

using detail::ModalDesign;
using detail::ModelOnBand;

constexpr detail::Spellings<RealisationMethod, 2> method_names{
    {{RealisationMethod::joint, "joint"}, {RealisationMethod::term_by_term, "term-by-term"}}};
constexpr detail::Spellings<RationalModelStatus, 2> status_names{
    {{RationalModelStatus::met, "met"}, {RationalModelStatus::not_attainable, "not-attainable"}}};

void check(const FractionalTransferFunction& model, FrequencyBand band, double tolerance) {
  detail::check_demand("realise", band, tolerance);
  const double growth = model.numerator().front().order - model.denominator().front().order;
  if (!(growth < 1)) {
    throw std::invalid_argument("realise: the model grows as s^" + detail::number_text(growth) +
                                " at high frequency; allowed is a growth below s");
  }
}

void check_response(const ModelOnBand& model) {
  for (const double omega : model.grid(3)) {
    const std::complex<double> value = model.response(omega);
    if (!(std::isfinite(std::abs(value)) && std::abs(value) > 0)) {
      throw std::domain_error("realise: |G| = " + detail::number_text(std::abs(value)) + " at omega = " +
                              detail::number_text(omega) + " rad/s; needed is a finite response other than 0");
    }
  }
}

RationalModel measured(const FractionalTransferFunction& model, const ModelOnBand& on_band, double tolerance,
                       RealisationMethod method, ModalDesign design) {
  RationalModel result{.model = model,
                       .band = on_band.band(),
                       .tolerance = tolerance,
                       .method = method,
                       .delay = model.delay(),
                       .direct = design.direct,
                       .modes = std::move(design.modes),
                       .series = {},
                       .message = {}};
  std::sort(result.modes.begin(), result.modes.end(),
            [](const Mode& a, const Mode& b) { return std::abs(a.pole) < std::abs(b.pole); });
  result.states = detail::state_count(result.modes);
  result.stable =
      std::all_of(result.modes.begin(), result.modes.end(), [](const Mode& mode) { return mode.pole.real() < 0; });
  detail::measure(on_band, design.density, result);
  return result;
}

bool met(const RationalModel& result) {
  return result.max_relative_error <= result.tolerance;
}

// The relative error of a sum of modes by rounding.  At a frequency modes cancel that are as large as the largest
// response at any lower frequency, fallen as 1/omega since, and as the largest one at any higher frequency.
double rounding_of_modes(const ModelOnBand& model) {
  const std::vector<double> omega = model.grid(3);
  std::vector<double> size;
  for (const double each : omega) size.push_back(std::abs(model.response(each)));
  double worst = 0;
  double falling = 0;
  for (std::size_t i = 0; i < omega.size(); ++i) {
    falling = std::max(falling, size[i] * omega[i]);
    worst = std::max(worst, falling / (size[i] * omega[i]));
  }
  double rising = 0;
  for (std::size_t i = omega.size(); i-- > 0;) {
    rising = std::max(rising, size[i]);
    worst = std::max(worst, rising / size[i]);
  }
  return worst * std::numeric_limits<double>::epsilon();
}

// Whether one sum of modes cannot keep the tolerance.  For a rational model it is tried all the same, because its poles
// may form one chain.
bool is_hidden_by_rounding(const ModelOnBand& model, double tolerance) {
  return !model.is_rational() && rounding_of_modes(model) > 0.03 * tolerance;
}

// Looks for the least number of real poles along the cut, from the number that the attainable limit of s^0.5 suggests.
RationalModel smallest_joint(const FractionalTransferFunction& model, const ModelOnBand& on_band, double tolerance) {
  const auto with = [&](int cut_poles) {
    return measured(model, on_band, tolerance, RealisationMethod::joint, detail::joint_design(on_band, cut_poles));
  };
  if (on_band.is_rational()) return with(0);
  constexpr int most = 80;
  const double width = 2 * on_band.half_width() + 4 * std::numbers::ln2;
  const double guess = width / (std::numbers::pi * std::numbers::pi) * std::log(2 / tolerance);
  int poles = std::clamp(static_cast<int>(std::ceil(guess)), 1, most);
  RationalModel best = with(poles);
  if (met(best)) {
    for (int misses = 0; poles > 0 && misses < 2;) {
      RationalModel fewer = with(--poles);
      if (met(fewer)) {
        best = std::move(fewer);
        misses = 0;
      } else {
        ++misses;
      }
    }
    return best;
  }
  // Each further pole divides the attainable error by e^(pi^2/width).  Adds as many as the error asks for, a few at a
  // time.
  const double per_pole = std::numbers::pi * std::numbers::pi / width;
  int missed = poles;
  for (int without_gain = 0; without_gain < 3 && poles < most;) {
    const double wanted = std::log(best.max_relative_error / tolerance) / per_pole;
    poles = std::min(poles + std::clamp(static_cast<int>(wanted), 1, without_gain > 0 ? 1 : 4), most);
    RationalModel more = with(poles);
    if (met(more)) {
      while (poles - 1 > missed) {
        RationalModel fewer = with(--poles);
        if (!met(fewer)) break;
        more = std::move(fewer);
      }
      return more;
    }
    missed = poles;
    without_gain = more.max_relative_error < 0.9 * best.max_relative_error ? 0 : without_gain + 1;
    if (more.max_relative_error < best.max_relative_error) best = std::move(more);
  }
  return best;
}

// Looks for the least accurate ladders with which the whole keeps the tolerance.
RationalModel smallest_term_by_term(const FractionalTransferFunction& model, const ModelOnBand& on_band,
                                    double tolerance) {
  const auto with = [&](double ladder_tolerance) {
    return measured(model, on_band, tolerance, RealisationMethod::term_by_term,
                    detail::term_by_term_design(on_band, ladder_tolerance));
  };
  double ladder_tolerance = tolerance;
  RationalModel best = with(ladder_tolerance);
  if (met(best)) {
    for (int tries = 0; tries < 12 && 1.4 * ladder_tolerance < 0.5; ++tries) {
      ladder_tolerance *= 1.4;
      RationalModel coarser = with(ladder_tolerance);
      if (!met(coarser)) break;
      if (coarser.states < best.states) best = std::move(coarser);
    }
    return best;
  }
  for (int tries = 0; tries < 20 && ladder_tolerance > 1e-14; ++tries) {
    ladder_tolerance *= 0.6;
    RationalModel finer = with(ladder_tolerance);
    if (met(finer)) return finer;
    if (finer.max_relative_error < best.max_relative_error) best = std::move(finer);
  }
  return best;
}

RationalModel smallest_sum_of_modes(const FractionalTransferFunction& model, const ModelOnBand& on_band,
                                    double tolerance, RealisationMethod method) {
  // A rational model keeps its own poles, whatever the method.
  if (method == RealisationMethod::joint || on_band.is_rational()) return smallest_joint(model, on_band, tolerance);
  return smallest_term_by_term(model, on_band, tolerance);
}

// Realises stages in series, of which the fractional ones share the error evenly; empty where the model cannot be
// split.
std::optional<RationalModel> in_series(const ModelOnBand& on_band, const RationalModel& frame,
                                       detail::SeriesSplit split) {
  const auto [gain, stages] = detail::series_stages(on_band.model(), split);
  if (stages.empty()) return std::nullopt;
  std::vector<std::pair<std::size_t, ModelOnBand>> different;  // first of its kind
  std::vector<std::size_t> kind;
  for (std::size_t i = 0; i < stages.size(); ++i) {
    const auto same = std::find_if(different.begin(), different.end(),
                                   [&all = stages, i](const auto& each) { return all[each.first] == all[i]; });
    kind.push_back(static_cast<std::size_t>(same - different.begin()));
    if (same != different.end()) continue;
    different.emplace_back(i, ModelOnBand(stages[i], frame.band));
    if (is_hidden_by_rounding(different.back().second, frame.tolerance)) return std::nullopt;
  }
  const auto shared =
      std::count_if(kind.begin(), kind.end(), [&](std::size_t each) { return !different[each].second.is_rational(); });
  double share = frame.tolerance / static_cast<double>(std::max<std::ptrdiff_t>(shared, 1));
  std::optional<RationalModel> best;
  for (int attempt = 0; attempt < 3; ++attempt, share *= 0.7) {
    RationalModel result = frame;
    result.states = 0;
    result.stable = true;
    std::vector<RationalModel> designs;
    for (const auto& [first, each] : different) {
      designs.push_back(smallest_sum_of_modes(stages[first], each, std::max(share, 1e-14), frame.method));
    }
    std::size_t most_states = 0;
    for (const std::size_t each : kind) {
      const RationalModel& design = designs[each];
      result.series.push_back({design.direct, design.modes});
      result.states += design.states;
      result.stable = result.stable && design.stable;
      most_states = std::max(most_states, design.states);
    }
    result.direct = gain * result.series.front().direct;
    result.modes = std::move(result.series.front().modes);
    result.series.erase(result.series.begin());
    for (Mode& mode : result.modes) {
      for (std::complex<double>& residue : mode.residues) residue *= gain;
    }
    const double density = std::max(3.0, 3.0 * static_cast<double>(most_states + 1) / on_band.half_width());
    detail::measure(on_band, density, result);
    if (!best || result.max_relative_error < best->max_relative_error) best = std::move(result);
    const bool can_do_better = std::all_of(designs.begin(), designs.end(), met);
    if (met(*best) || !can_do_better) break;
  }
  return best;
}

// Realises a model given as a product.  Expanding it would not help: that only makes more terms, whose sums cancel.
RationalModel smallest_of_product(const FractionalTransferFunction& model, const ModelOnBand& on_band, double tolerance,
                                  RealisationMethod method) {
  std::optional<RationalModel> result;
  const bool is_one_sum = on_band.is_rational() || method == RealisationMethod::joint;
  if (is_one_sum && !is_hidden_by_rounding(on_band, tolerance)) {
    result = smallest_joint(model, on_band, tolerance);
  }
  const RationalModel frame{.model = model,
                            .band = on_band.band(),
                            .tolerance = tolerance,
                            .method = method,
                            .delay = model.delay(),
                            .modes = {},
                            .series = {},
                            .message = {}};
  for (const auto split : {detail::SeriesSplit::whole_orders, detail::SeriesSplit::every_factor}) {
    if (result && met(*result)) break;
    if (auto series = in_series(on_band, frame, split)) {
      if (!result || series->max_relative_error < result->max_relative_error) result = std::move(series);
    }
  }
  return result ? std::move(*result) : smallest_sum_of_modes(model, on_band, tolerance, method);
}

}  // namespace

std::string_view to_string(RealisationMethod method) {
  return detail::spelling(method_names, method);
}

RealisationMethod realisation_method_from_string(std::string_view name) {
  return detail::from_spelling(method_names, "realisation method", name);
}

std::span<const RealisationMethod> realisation_methods() {
  static constexpr auto all = detail::enumerators(method_names);
  return all;
}

std::string_view to_string(RationalModelStatus status) {
  return detail::spelling(status_names, status);
}

std::vector<std::complex<double>> detail::solved_states(const StateSpace& system, double omega) {
  // (j omega - A) x = B by Gaussian elimination with partial pivoting.  It skips zeros, of which a modal form is full:
  // a dense factorisation by Eigen takes 2.4 times as long there and 8 % longer for a full matrix of 16 states.
  using Complex = std::complex<double>;
  const std::size_t n = system.states;
  std::vector<Complex> matrix(n * n);
  for (std::size_t i = 0; i < n * n; ++i) matrix[i] = -system.a[i];
  for (std::size_t i = 0; i < n; ++i) matrix[i * n + i] += Complex(0, omega);
  std::vector<Complex> x(system.b.begin(), system.b.end());
  for (std::size_t k = 0; k < n; ++k) {
    std::size_t pivot = k;
    for (std::size_t i = k + 1; i < n; ++i) {
      if (std::abs(matrix[i * n + k]) > std::abs(matrix[pivot * n + k])) pivot = i;
    }
    for (std::size_t j = 0; j < n; ++j) std::swap(matrix[k * n + j], matrix[pivot * n + j]);
    std::swap(x[k], x[pivot]);
    for (std::size_t i = k + 1; i < n; ++i) {
      const Complex factor = matrix[i * n + k] / matrix[k * n + k];
      if (factor == 0.0) continue;
      for (std::size_t j = k; j < n; ++j) matrix[i * n + j] -= factor * matrix[k * n + j];
      x[i] -= factor * x[k];
    }
  }
  for (std::size_t k = n; k-- > 0;) {
    for (std::size_t j = k + 1; j < n; ++j) x[k] -= matrix[k * n + j] * x[j];
    x[k] /= matrix[k * n + k];
  }
  return x;
}

std::complex<double> StateSpace::response(double omega) const {
  const std::vector<std::complex<double>> x = detail::solved_states(*this, omega);
  std::complex<double> y = d;
  for (std::size_t k = states; k-- > 0;) y += c[k] * x[k];
  return y;
}

std::complex<double> RationalModel::response(double omega) const {
  std::complex<double> product = detail::modal_response(direct, modes, omega);
  for (const RationalStage& stage : series) product *= detail::modal_response(stage.direct, stage.modes, omega);
  return product;
}

RationalModel realise(const FractionalTransferFunction& model, FrequencyBand band, double tolerance,
                      RealisationMethod method) {
  check(model, band, tolerance);
  const ModelOnBand on_band(model, band);
  check_response(on_band);
  std::optional<RationalModel> result;
  if (!model.denominator_factors().empty()) {
    result = smallest_of_product(model, on_band, tolerance, method);
    result->method = method;
  } else {
    if (method == RealisationMethod::joint || on_band.is_rational()) {
      result = smallest_joint(model, on_band, tolerance);
      result->method = method;
    }
    if (!on_band.is_rational()) {
      RationalModel by_terms = smallest_term_by_term(model, on_band, tolerance);
      const bool better = !result || (met(by_terms) && (!met(*result) || by_terms.states < result->states));
      if (better) result = std::move(by_terms);
    }
  }
  result->status = met(*result) ? RationalModelStatus::met : RationalModelStatus::not_attainable;
  const std::string states = detail::counted(result->states, "state");
  result->message = met(*result)
                        ? "Tolerance " + detail::short_text(tolerance) + " is met with " + states +
                              ", largest relative error " + detail::bound_text(result->max_relative_error) + "."
                        : "Tolerance " + detail::short_text(tolerance) + " is not attainable, best is " +
                              detail::bound_text(result->max_relative_error) + " with " + states + ".";
  return std::move(*result);
}

namespace {

StateSpace modal_stage(double direct, const std::vector<Mode>& modes) {
  StateSpace form;
  const std::size_t n = form.states = detail::state_count(modes);
  form.a.assign(n * n, 0);
  form.b.assign(n, 0);
  form.c.assign(n, 0);
  form.d = direct;
  std::size_t at = 0;
  for (const Mode& mode : modes) {
    const std::size_t width = mode.pole.imag() == 0 ? 1 : 2;
    const std::size_t order = mode.residues.size();
    double size = 0;
    for (const auto residue : mode.residues) size = std::max(size, std::abs(residue));
    // The input enters the first block, each block drives the next: block k is the input over (s - pole)^k.
    const double root = size > 0 ? std::sqrt(size) : 1;
    for (std::size_t k = 0; k < order; ++k) {
      const std::size_t row = at + k * width;
      form.a[row * n + row] = mode.pole.real();
      if (width == 2) {
        form.a[(row + 1) * n + row + 1] = mode.pole.real();
        form.a[row * n + row + 1] = mode.pole.imag();
        form.a[(row + 1) * n + row] = -mode.pole.imag();
      }
      for (std::size_t i = 0; i < width && k > 0; ++i) form.a[(row + i) * n + row - width + i] = 1;
      // x = (re, -im) of the complex state z' = pole z + root u; y = 2 Re(residue/root z), or Re for a real pole.
      const double factor = width == 2 ? 2 : 1;
      form.c[row] = factor * mode.residues[k].real() / root;
      if (width == 2) form.c[row + 1] = factor * mode.residues[k].imag() / root;
    }
    form.b[at] = root;
    at += order * width;
  }
  return form;
}

// The output of the first drives the second.
StateSpace series_of(const StateSpace& first, const StateSpace& second) {
  StateSpace form;
  const std::size_t n = form.states = first.states + second.states;
  form.a.assign(n * n, 0);
  for (std::size_t i = 0; i < first.states; ++i) {
    for (std::size_t j = 0; j < first.states; ++j) form.a[i * n + j] = first.a[i * first.states + j];
  }
  for (std::size_t i = 0; i < second.states; ++i) {
    const std::size_t row = first.states + i;
    for (std::size_t j = 0; j < first.states; ++j) form.a[row * n + j] = second.b[i] * first.c[j];
    for (std::size_t j = 0; j < second.states; ++j)
      form.a[row * n + first.states + j] = second.a[i * second.states + j];
  }
  form.b = first.b;
  for (const double each : second.b) form.b.push_back(each * first.d);
  for (const double each : first.c) form.c.push_back(second.d * each);
  form.c.insert(form.c.end(), second.c.begin(), second.c.end());
  form.d = second.d * first.d;
  return form;
}

}  // namespace

StateSpace modal_form(const RationalModel& system) {
  StateSpace form = modal_stage(system.direct, system.modes);
  for (const RationalStage& stage : system.series) form = series_of(form, modal_stage(stage.direct, stage.modes));
  return form;
}

std::string RationalModel::summary() const {
  using detail::short_text;
  return model.formula() + " on " + short_text(band.lower) + " .. " + short_text(band.upper) + " rad/s by " +
         std::string(to_string(method)) + (stable ? ", stable. " : ", not stable. ") + message;
}

}  // namespace frac
