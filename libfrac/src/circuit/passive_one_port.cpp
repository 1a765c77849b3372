// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>
#include <utility>

#include "base/counted.hpp"
#include "base/number_text.hpp"
#include "base/short_text.hpp"
#include "circuit/circuit_error.hpp"
#include "frac/circuit.hpp"
#include "frac/model/algebra.hpp"
#include "state_space/demand_check.hpp"
#include "state_space/model_on_band.hpp"

namespace frac {
namespace {

using Complex = std::complex<double>;
using detail::ModelOnBand;

// A cell of an impedance in series form or, with the elements exchanged for their duals, of an admittance in parallel
// form: 1/cell = conductance + slope s + 1/(ramp s + drop), where a missing ramp means that the last term is missing.
struct Immittance {
  double conductance = 0;
  double slope = 0;
  std::optional<double> ramp;
  double drop = 0;
};

struct PartialFractions {
  // Empty where no projection on positive elements makes sense.
  std::vector<Immittance> cells;
  // What had to be changed to make all elements positive, or prevents it; empty where nothing does.
  std::string obstacle;
};

constexpr double rounding = detail::rounding_of_parts;

std::string place_of(Complex pole) {
  return pole.imag() == 0
             ? "at the pole " + detail::short_text(pole.real()) + " rad/s"
             : "at the poles " + detail::short_text(pole.real()) + " +- " + detail::short_text(pole.imag()) + "j rad/s";
}

// c s + d over s^2 + a1 s + a0 has 1/cell = s/c + g + e/(c s + d), g = (a1 - d/c)/c, e = a0 - d g: no element is
// negative where c > 0 and 0 <= d <= a1 c, which is where the fraction is positive real.
void add_pair(const Mode& mode, PartialFractions& result) {
  const Complex residue = mode.residues.front();
  const double decay = -mode.pole.real();
  const double c = 2 * residue.real();
  const double a1 = 2 * decay;
  const double a0 = std::norm(mode.pole);
  const double wanted = 2 * (decay * residue.real() - mode.pole.imag() * residue.imag());
  const double d = std::clamp(wanted, 0.0, std::max(a1 * c, 0.0));
  if (!(c > 0 && std::abs(d - wanted) <= rounding * c * std::sqrt(a0))) {
    result.obstacle = "the real part of its share " + place_of(mode.pole) +
                      " changes sign, which that of no cell of resistors, capacitors and inductors does";
  }
  if (!(c > 0)) return;
  Immittance cell;
  cell.slope = 1 / c;
  cell.conductance = std::max((a1 - d / c) / c, 0.0);
  const double rest = a0 - d * cell.conductance;
  cell.ramp = c / rest;
  cell.drop = d / rest;
  result.cells.push_back(cell);
}

// Partial fractions as cells.  A design within a tolerance may miss a sign where the model is at the edge of being
// passive: the nearest positive element is taken then, and the error that is measured afterwards decides.
PartialFractions positive_cells(const RationalModel& rational) {
  const auto refuse = [](std::string why) { return PartialFractions{{}, std::move(why)}; };
  if (!rational.series.empty()) return refuse("it is a product whose factors have no common partial fractions");
  PartialFractions result;
  // What a pole with a negative residue takes of the constant: r/(s - p) = r/|p| + |r|/|p| s/(s - p).
  double constant = rational.direct;
  double size = std::abs(rational.direct);
  for (const Mode& mode : rational.modes) {
    if (mode.residues.size() > 1) return refuse("it has a multiple pole " + place_of(mode.pole));
    if (mode.pole.real() > 0) return refuse("it is unstable " + place_of(mode.pole));
    if (mode.pole.imag() != 0) {
      add_pair(mode, result);
      continue;
    }
    const double residue = mode.residues.front().real();
    const double rate = -mode.pole.real();
    if (residue == 0) continue;
    Immittance cell;
    if (residue > 0) {
      cell.conductance = rate / residue;
      cell.slope = 1 / residue;
    } else {
      if (rate == 0) return refuse("its residue " + place_of(mode.pole) + " is negative");
      const double share = -residue / rate;
      constant -= share;
      size += share;
      cell.conductance = 1 / share;
      cell.ramp = share / rate;
    }
    result.cells.push_back(cell);
  }
  if (constant < -rounding * size) {
    result.obstacle = "its value without the cells of its poles is " + detail::short_text(constant) +
                      ", a negative resistance or conductance";
  }
  if (constant > std::numeric_limits<double>::epsilon() * size) {
    Immittance cell;
    cell.conductance = 1 / constant;
    result.cells.insert(result.cells.begin(), cell);
  }
  return result;
}

// f = slope s + rest, where f grows as s; what grows less has no such part.
struct Growth {
  double slope = 0;
  std::optional<FractionalTransferFunction> rest;
};

Growth growth_of(const FractionalTransferFunction& f) {
  const PowerTerm top = f.numerator().front();
  const PowerTerm bottom = f.denominator().front();
  if (top.order - bottom.order < 1) return {0, f};
  const double slope = top.coefficient / bottom.coefficient;
  const bool is_all = f.numerator().size() == 1 && f.denominator().size() == 1;
  if (is_all) return {slope, std::nullopt};
  return {slope, f - FractionalTransferFunction({{slope, 1}}, {{1, 0}})};
}

std::optional<double> positive(double value) {
  return value > 0 ? std::optional(value) : std::nullopt;
}

FosterCell elements_of(const Immittance& cell, FosterForm form) {
  FosterCell elements;
  if (form == FosterForm::series) {
    if (cell.conductance > 0) elements.resistance = 1 / cell.conductance;
    elements.capacitance = positive(cell.slope);
    elements.inductance = cell.ramp;
    elements.loss = positive(cell.drop);
  } else {
    elements.resistance = positive(cell.conductance);
    elements.inductance = positive(cell.slope);
    elements.capacitance = cell.ramp;
    if (cell.drop > 0) elements.loss = 1 / cell.drop;
  }
  return elements;
}

void check_no_delay(const FractionalTransferFunction& impedance) {
  if (impedance.delay() > 0) {
    throw std::domain_error("impedance: it has a dead time of " + detail::number_text(impedance.delay()) +
                            " s, which no resistor, capacitor or inductor has");
  }
}

std::size_t count(const FosterCell& cell) {
  return static_cast<std::size_t>(cell.resistance.has_value()) + cell.capacitance.has_value() +
         cell.inductance.has_value() + cell.loss.has_value();
}

}  // namespace

Complex PassiveOnePort::response(double omega) const {
  const Complex s(0, omega);
  Complex sum = 0;
  for (const FosterCell& cell : cells) {
    Complex inverse = 0;
    if (form == FosterForm::series) {
      if (cell.resistance) inverse += 1 / *cell.resistance;
      if (cell.capacitance) inverse += s * *cell.capacitance;
      if (cell.inductance) inverse += 1.0 / (s * *cell.inductance + cell.loss.value_or(0));
    } else {
      inverse += cell.resistance.value_or(0);
      if (cell.inductance) inverse += s * *cell.inductance;
      if (cell.capacitance) inverse += 1.0 / (s * *cell.capacitance + (cell.loss ? 1 / *cell.loss : 0));
    }
    sum += 1.0 / inverse;
  }
  return form == FosterForm::series ? sum : 1.0 / sum;
}

std::size_t PassiveOnePort::elements() const noexcept {
  std::size_t sum = 0;
  for (const FosterCell& cell : cells) sum += count(cell);
  return sum;
}

std::string PassiveOnePort::summary() const {
  return impedance + " ohm on " + detail::band_text(band) + ". " + message;
}

PassiveOnePort passive_one_port(const FractionalTransferFunction& impedance, FrequencyBand band, double tolerance) {
  detail::check_demand("impedance", band, tolerance);
  check_no_delay(impedance);
  const FractionalTransferFunction admittance = FractionalTransferFunction({{1, 0}}, {{1, 0}}) / impedance;
  std::optional<PassiveOnePort> best;
  std::optional<ModelOnBand> on_band;
  std::string obstacles;
  for (const FosterForm form : {FosterForm::series, FosterForm::parallel}) {
    const bool is_impedance = form == FosterForm::series;
    const FractionalTransferFunction& immittance = is_impedance ? impedance : admittance;
    if (immittance.numerator().front().order - immittance.denominator().front().order > 1) continue;
    const Growth growth = growth_of(immittance);
    std::string obstacle;
    // The error of a part, and what a projection on positive elements changes, may count more in the whole.
    for (const double share : {1.0, 0.3, 0.1}) {
      PassiveOnePort circuit{.impedance = impedance.formula(),
                             .band = band,
                             .tolerance = tolerance,
                             .form = form,
                             .cells = {},
                             .message = {}};
      PartialFractions fractions;
      if (growth.rest) fractions = positive_cells(realise(*growth.rest, band, std::max(share * tolerance, 1e-12)));
      if (!on_band) {
        on_band.emplace(impedance, band);
        detail::check_passive(*on_band);
      }
      if (growth.slope < 0)
        fractions = {{}, "it grows as " + detail::short_text(growth.slope) + " s, a negative element"};
      if (growth.slope > 0) fractions.cells.push_back({.conductance = 0, .slope = 0, .ramp = growth.slope});
      if (obstacle.empty()) obstacle = fractions.obstacle;
      if (fractions.cells.empty()) break;
      for (const Immittance& cell : fractions.cells) circuit.cells.push_back(elements_of(cell, form));
      detail::certify(
          circuit, *on_band, circuit.elements(), [&](double omega) { return circuit.response(omega); },
          detail::counted(circuit.elements(), "element"));
      if (circuit.usable()) return circuit;
      if (!best || circuit.max_relative_error < best->max_relative_error) best = std::move(circuit);
    }
    if (obstacle.empty()) continue;
    obstacles += (obstacles.empty() ? "" : "; ") +
                 std::string(is_impedance ? "of the impedance, " : "of the admittance, ") + obstacle;
  }
  if (obstacles.empty() && best) return std::move(*best);
  throw std::domain_error("impedance: no circuit of positive elements keeps the tolerance: " + obstacles);
}

}  // namespace frac
