// SPDX-License-Identifier: BSD-3-Clause
#include "model_on_band.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "approximation/band_error.hpp"
#include "formula/whole_orders.hpp"
#include "frac/stability.hpp"
#include "poles/principal_sheet.hpp"

namespace frac::detail {
namespace {

using Complex = std::complex<double>;

FractionalTransferFunction without_delay(const FractionalTransferFunction& model) {
  if (model.denominator_factors().empty()) return {model.numerator(), model.denominator()};
  return FractionalTransferFunction::from_factors(model.numerator_factors(), model.denominator_factors());
}

}  // namespace

ModelOnBand::ModelOnBand(const FractionalTransferFunction& model, FrequencyBand band)
    : model_(without_delay(model)),
      band_(band),
      half_width_((std::log(band.upper) - std::log(band.lower)) / 2),
      centre_(std::exp((std::log(band.upper) + std::log(band.lower)) / 2)),
      has_direct_(model.numerator().front().order - model.denominator().front().order > -1),
      is_rational_(has_whole_orders(model.numerator()) && has_whole_orders(model.denominator())) {
  const StabilityAnalysis analysis = analyse_principal_sheet(model_);
  if (analysis.stability == Stability::undetermined) throw std::domain_error("realise: " + analysis.remark);
  constexpr double beyond_band = 100;
  for (const Pole& pole : analysis.poles) {
    if (pole.cancelled) continue;
    const double size = std::abs(pole.value);
    const bool near = size > band.lower / beyond_band && size < band.upper * beyond_band;
    if (!near && !is_rational_ && pole.value.real() < 0) continue;
    kept_poles_.push_back({pole.value, std::vector<Complex>(static_cast<std::size_t>(pole.multiplicity))});
  }
  const double at_origin = model_.numerator().back().order - model_.denominator().back().order;
  if (at_origin <= -1) {
    kept_poles_.push_back({0, std::vector<Complex>(static_cast<std::size_t>(std::floor(-at_origin)))});
  }
}

std::vector<double> ModelOnBand::grid(double density) const {
  // Within one unit of an end steps shrink in proportion to the root of the distance, as the turns of an equal-ripple
  // error do.
  std::vector<double> logarithms;
  const double end = std::min(1.0, half_width_);
  const int inner = std::max(2, static_cast<int>(std::ceil(2 * (half_width_ - end) * density)));
  for (int i = 0; i <= inner; ++i) logarithms.push_back((half_width_ - end) * (2.0 * i / inner - 1));
  const int outer = std::max(4, static_cast<int>(std::ceil(2 * density * end)));
  for (int i = 0; i < outer; ++i) {
    const double from_end = end * std::pow(static_cast<double>(i) / outer, 2);
    logarithms.push_back(half_width_ - from_end);
    logarithms.push_back(from_end - half_width_);
  }
  // A lightly damped pole turns the response within its own distance from the axis.
  for (const Mode& mode : kept_poles_) {
    const double damping = std::abs(mode.pole.real()) / std::abs(mode.pole);
    if (!(damping < 0.5)) continue;
    const double middle = std::log(std::abs(mode.pole)) - std::log(centre_);
    const int points = static_cast<int>(std::ceil(8 * density));
    for (int i = 0; i < points; ++i) {
      const double away = std::max(damping, 1e-9) * std::sinh(std::asinh(1 / std::max(damping, 1e-9)) * i / points);
      for (const double at : {middle - away, middle + away}) {
        if (std::abs(at) <= half_width_) logarithms.push_back(at);
      }
    }
  }
  std::sort(logarithms.begin(), logarithms.end());
  std::vector<double> omega;
  for (const double each : logarithms) {
    const double value = std::clamp(centre_ * std::exp(each), band_.lower, band_.upper);
    if (omega.empty() || value > omega.back()) omega.push_back(value);
  }
  return omega;
}

std::size_t state_count(const std::vector<Mode>& modes) {
  std::size_t count = 0;
  for (const Mode& mode : modes) count += mode.residues.size() * (mode.pole.imag() == 0 ? 1 : 2);
  return count;
}

std::complex<double> modal_response(double direct, const std::vector<Mode>& modes, double omega) {
  const Complex s(0, omega);
  Complex sum = direct;
  for (const Mode& mode : modes) {
    const auto add = [&](Complex pole, bool conjugate) {
      const Complex factor = 1.0 / (s - pole);
      Complex power = factor;
      for (const Complex residue : mode.residues) {
        sum += (conjugate ? std::conj(residue) : residue) * power;
        power *= factor;
      }
    };
    add(mode.pole, false);
    if (mode.pole.imag() != 0) add(std::conj(mode.pole), true);
  }
  return sum;
}

void measure(const ModelOnBand& model, double density, RationalModel& system) {
  const std::vector<double> omega = model.grid(10 * density);
  const BandError<double> error =
      band_error(omega, [&](double each) { return system.response(each) / model.response(each); });
  system.max_relative_error = error.relative;
  system.omega_at_maximum = error.place;
  system.max_decibels = error.decibels;
  system.max_degrees = error.degrees;
  system.grid_points = static_cast<int>(omega.size());
}

}  // namespace frac::detail
