// SPDX-License-Identifier: BSD-3-Clause
#include "frac/state_space.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <stdexcept>

#include "base/number_text.hpp"
#include "base/short_text.hpp"
#include "base/spelling.hpp"
#include "model_on_band.hpp"

namespace frac {
namespace {

using detail::ModalDesign;
using detail::ModelOnBand;

constexpr detail::Spellings<RealisationMethod, 2> method_names{
    {{RealisationMethod::joint, "joint"}, {RealisationMethod::term_by_term, "term-by-term"}}};
constexpr detail::Spellings<RationalModelStatus, 2> status_names{
    {{RationalModelStatus::met, "met"}, {RationalModelStatus::not_attainable, "not-attainable"}}};

void check(const FractionalTransferFunction& model, FrequencyBand band, double tolerance) {
  const bool ordered = band.lower > 0 && band.lower < band.upper && std::isfinite(band.upper);
  const double decades = ordered ? std::log10(band.upper) - std::log10(band.lower) : 0;
  if (!ordered || decades < 0.01 || decades > 24) {
    throw std::invalid_argument("realise: band = " + detail::number_text(band.lower) + " to " +
                                detail::number_text(band.upper) +
                                " rad/s; needed is 0 < lower < upper < infinity, 0.01 to 24 decades apart");
  }
  if (!(tolerance >= 1e-12 && tolerance < 1)) {
    throw std::invalid_argument("realise: tolerance = " + detail::number_text(tolerance) +
                                "; allowed is 1e-12 to below 1");
  }
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

// The least number of real poles along the cut, from the number that the attainable limit of s^0.5 suggests.
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
  for (int without_gain = 0; without_gain < 3 && poles < most;) {
    RationalModel more = with(++poles);
    if (met(more)) return more;
    without_gain = more.max_relative_error < 0.9 * best.max_relative_error ? 0 : without_gain + 1;
    if (more.max_relative_error < best.max_relative_error) best = std::move(more);
  }
  return best;
}

// The least accurate ladders that will do.
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

}  // namespace

std::string_view to_string(RealisationMethod method) {
  return detail::spelling(method_names, method);
}

RealisationMethod realisation_method(std::string_view name) {
  return detail::from_spelling(method_names, "realisation method", name);
}

std::span<const RealisationMethod> realisation_methods() {
  static constexpr auto all = detail::enumerators(method_names);
  return all;
}

std::string_view to_string(RationalModelStatus status) {
  return detail::spelling(status_names, status);
}

std::complex<double> StateSpace::response(double omega) const {
  using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  const auto n = static_cast<Eigen::Index>(states);
  if (n == 0) return d;
  Eigen::MatrixXcd matrix = -Eigen::Map<const RowMajor>(a.data(), n, n).cast<std::complex<double>>();
  matrix.diagonal().array() += std::complex<double>(0, omega);
  const Eigen::VectorXcd x =
      matrix.partialPivLu().solve(Eigen::Map<const Eigen::VectorXd>(b.data(), n).cast<std::complex<double>>());
  return d + (Eigen::Map<const Eigen::VectorXd>(c.data(), n).array() * x.array()).sum();
}

std::complex<double> RationalModel::response(double omega) const {
  return detail::modal_response(direct, modes, omega);
}

RationalModel realise(const FractionalTransferFunction& model, FrequencyBand band, double tolerance,
                      RealisationMethod method) {
  check(model, band, tolerance);
  const ModelOnBand on_band(model, band);
  check_response(on_band);
  // Poles of a rational model are its own, whatever the method.
  std::optional<RationalModel> result;
  if (method == RealisationMethod::joint || on_band.is_rational()) {
    result = smallest_joint(model, on_band, tolerance);
    result->method = method;
  }
  if (!on_band.is_rational()) {
    RationalModel by_terms = smallest_term_by_term(model, on_band, tolerance);
    const bool better = !result || (met(by_terms) && (!met(*result) || by_terms.states < result->states));
    if (better) result = std::move(by_terms);
  }
  result->status = met(*result) ? RationalModelStatus::met : RationalModelStatus::not_attainable;
  const std::string states = std::to_string(result->states) + (result->states == 1 ? " state" : " states");
  result->message = met(*result)
                        ? "Tolerance " + detail::short_text(tolerance) + " is met with " + states +
                              ", largest relative error " + detail::short_text(result->max_relative_error) + "."
                        : "Tolerance " + detail::short_text(tolerance) + " is not attainable, best is " +
                              detail::short_text(result->max_relative_error) + " with " + states + ".";
  return std::move(*result);
}

StateSpace modal_form(const RationalModel& system) {
  StateSpace form;
  const std::size_t n = form.states = system.states;
  form.a.assign(n * n, 0);
  form.b.assign(n, 0);
  form.c.assign(n, 0);
  form.d = system.direct;
  std::size_t at = 0;
  for (const Mode& mode : system.modes) {
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

}  // namespace frac
