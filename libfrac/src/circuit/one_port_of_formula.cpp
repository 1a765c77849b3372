// SPDX-License-Identifier: BSD-3-Clause
#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <complex>
#include <functional>
#include <limits>
#include <numbers>
#include <stdexcept>
#include <string>
#include <vector>

#include "base/bound_text.hpp"
#include "base/eigenvalues.hpp"
#include "base/linear_algebra.hpp"
#include "base/short_text.hpp"
#include "circuit/circuit_error.hpp"
#include "frac/circuit.hpp"
#include "state_space/demand_check.hpp"

namespace frac {
namespace {

using Complex = std::complex<double>;
using detail::bound_text;
using detail::short_text;

// An impedance or admittance on the imaginary axis, over a band.
class OnBand {
 public:
  OnBand(std::function<Complex(double)> response, FrequencyBand band) : response_(std::move(response)), band_(band) {}

  [[nodiscard]] Complex response(double omega) const { return response_(omega); }
  [[nodiscard]] double half_width() const { return std::log(band_.upper / band_.lower) / 2; }
  [[nodiscard]] double centre() const { return std::sqrt(band_.lower) * std::sqrt(band_.upper); }
  [[nodiscard]] std::vector<double> grid(double density) const {
    const auto steps = static_cast<int>(std::ceil(2 * half_width() * density)) + 1;
    std::vector<double> omega{band_.lower};
    for (int i = 1; i < steps; ++i) omega.push_back(band_.lower * std::exp(2 * half_width() * i / steps));
    omega.push_back(band_.upper);
    return omega;
  }

 private:
  std::function<Complex(double)> response_;
  FrequencyBand band_;
};

// constant + integral/s + slope s + sum residue/(s + rate), nothing negative.
struct PositiveSum {
  double constant = 0, integral = 0, slope = 0;
  std::vector<double> rates, residues;
};

// Far from a band, in ln omega: integrands that fall as omega^(1/2) end below the rounding of a double.
constexpr double far = 75;

// A function that is positive real, at s = x > 0 from its real part on the imaginary axis (Cauer 1932):
//   f(x) = 2/pi integral of x Re f(j omega)/(x^2 + omega^2) d omega + integral/x + slope x.
// In ln omega the trapezoidal rule converges as e^(-pi^2/step), as the nearest singularities are pi/2 from the axis.
class OnRealAxis {
 public:
  explicit OnRealAxis(const OnBand& f) {
    constexpr double step = 0.2;
    const double end = f.half_width() + far;
    for (double ln = -end; ln <= end; ln += step) {
      omega_.push_back(f.centre() * std::exp(ln));
      const Complex value = f.response(omega_.back());
      if (!std::isfinite(value.real()) || !std::isfinite(value.imag()))
        throw std::domain_error("impedance: the formula has no finite value at omega = " + short_text(omega_.back()) +
                                " rad/s, from which its poles are told");
      weighted_.push_back(2 / std::numbers::pi * step * omega_.back() * value.real());
      if (ln == -end) integral = -value.imag() * omega_.back();
      slope = value.imag() / omega_.back();
    }
    // What vanishes slower than a pole at 0 or at infinity would leaves a rest here.
    if (integral < far_rest * std::abs(f.response(f.centre())) * f.centre()) integral = 0;
    if (slope < far_rest * std::abs(f.response(f.centre())) / f.centre()) slope = 0;
  }

  [[nodiscard]] double operator()(double x) const {
    double sum = 0;
    for (std::size_t i = 0; i < omega_.size(); ++i) sum += weighted_[i] * x / (x * x + omega_[i] * omega_[i]);
    return sum;
  }

  double integral = 0, slope = 0;

 private:
  static constexpr double far_rest = 1e-12;
  std::vector<double> omega_, weighted_;
};

// Rates of the interpolant at twice as many points of the real axis.  Of a function that is a sum or integral of
// positive r/(s + p) they are real and positive (Loewner's pencil of a Stieltjes function).
std::vector<double> rates_of(const OnRealAxis& f, const OnBand& on_band, int count) {
  const int points = 2 * count;
  Eigen::VectorXd x(points), value(points);
  for (int i = 0; i < points; ++i) {
    // One e-fold beyond the band at either end.
    const double place = points == 1 ? 0 : 2.0 * i / (points - 1) - 1;
    x[i] = on_band.centre() * std::exp(place * (on_band.half_width() + 1));
    value[i] = f(x[i]);
  }
  // Rows and columns are scaled alike, so that neither end of the band dominates.
  Eigen::MatrixXd loewner(count, count), shifted(count, count);
  for (int i = 0; i < count; ++i) {
    for (int j = 0; j < count; ++j) {
      const double a = x[2 * i], b = x[2 * j + 1];
      const double scale = std::sqrt(a * b);
      loewner(i, j) = scale * (value[2 * i] - value[2 * j + 1]) / (a - b);
      shifted(i, j) = scale * (a * value[2 * i] - b * value[2 * j + 1]) / (a - b);
    }
  }
  std::vector<double> rates;
  for (const Complex& pole : detail::eigenvalues(detail::PivotedQr(loewner).solve(shifted)))
    if (pole.real() < 0 && std::abs(pole.imag()) < 1e-6 * std::abs(pole.real())) rates.push_back(-pole.real());
  std::sort(rates.begin(), rates.end());
  return rates;
}

// Residues and constant by least squares of the relative error on the band; those that come out negative are left out.
PositiveSum fitted(const OnBand& f, const OnRealAxis& axis, std::vector<double> rates) {
  PositiveSum sum{1, axis.integral, axis.slope, {}, {}};
  const std::vector<double> omega = f.grid(6);
  bool has_constant = true;
  for (;;) {
    const auto columns = static_cast<Eigen::Index>(rates.size()) + (has_constant ? 1 : 0);
    const auto rows = 2 * static_cast<Eigen::Index>(omega.size());
    if (columns == 0) return sum;
    Eigen::MatrixXd a(rows, columns);
    Eigen::VectorXd b(rows);
    for (std::size_t k = 0; k < omega.size(); ++k) {
      const auto row = 2 * static_cast<Eigen::Index>(k);
      const Complex s(0, omega[k]), value = f.response(omega[k]);
      const auto put = [&](Eigen::Index column, Complex each) {
        a(row, column) = (each / value).real();
        a(row + 1, column) = (each / value).imag();
      };
      for (std::size_t i = 0; i < rates.size(); ++i)
        put(static_cast<Eigen::Index>(i), std::sqrt(rates[i] * f.centre()) / (s + rates[i]));
      if (has_constant) put(columns - 1, 1);
      const Complex rest = (value - sum.integral / s - sum.slope * s) / value;
      b[row] = rest.real();
      b[row + 1] = rest.imag();
    }
    const Eigen::VectorXd weights = detail::PivotedQr(a).solve(b);
    std::vector<double> kept;
    std::vector<double> residues;
    for (std::size_t i = 0; i < rates.size(); ++i) {
      if (weights[static_cast<Eigen::Index>(i)] <= 0) continue;
      kept.push_back(rates[i]);
      residues.push_back(weights[static_cast<Eigen::Index>(i)] * std::sqrt(rates[i] * f.centre()));
    }
    const bool constant_fits = !has_constant || weights[columns - 1] >= 0;
    sum.constant = has_constant && constant_fits ? weights[columns - 1] : 0;
    const bool is_done = kept.size() == rates.size() && constant_fits;
    sum.rates = rates = std::move(kept);
    sum.residues = std::move(residues);
    has_constant = has_constant && constant_fits;
    if (is_done) return sum;
  }
}

std::vector<FosterCell> cells_of(const PositiveSum& sum, FosterForm form) {
  std::vector<FosterCell> cells;
  const bool is_series = form == FosterForm::series;
  const auto add = [&](auto set) { set(cells.emplace_back()); };
  if (sum.constant > 0) add([&](FosterCell& cell) { cell.resistance = is_series ? sum.constant : 1 / sum.constant; });
  if (sum.integral > 0)
    add([&](FosterCell& cell) { (is_series ? cell.capacitance : cell.inductance) = 1 / sum.integral; });
  if (sum.slope > 0) add([&](FosterCell& cell) { (is_series ? cell.inductance : cell.capacitance) = sum.slope; });
  for (std::size_t i = 0; i < sum.rates.size(); ++i) {
    add([&](FosterCell& cell) {
      // r/(s + p) is 1/r farad beside r/p ohm, or 1/r henry behind p/r ohm.
      cell.resistance = is_series ? sum.residues[i] / sum.rates[i] : sum.rates[i] / sum.residues[i];
      (is_series ? cell.capacitance : cell.inductance) = 1 / sum.residues[i];
    });
  }
  return cells;
}

}  // namespace

PassiveOnePort passive_one_port(const Structure& impedance, FrequencyBand band, double tolerance) {
  if (!impedance.parameter_names().empty())
    throw std::invalid_argument("impedance: the formula has the parameter " + impedance.parameter_names().front() +
                                "; expected numbers");
  detail::check_demand("impedance", band, tolerance);
  const OnBand whole([&](double omega) { return impedance.response({}, omega); }, band);
  detail::check_passive(whole);
  constexpr int most_cells = 24;
  PassiveOnePort best{
      .impedance = impedance.formula(), .band = band, .tolerance = tolerance, .cells = {}, .message = {}};
  best.max_relative_error = std::numeric_limits<double>::infinity();
  for (const FosterForm form : {FosterForm::series, FosterForm::parallel}) {
    const OnBand f(
        [&](double omega) {
          const Complex value = impedance.response({}, omega);
          return form == FosterForm::series ? value : 1.0 / value;
        },
        band);
    const OnRealAxis axis(f);
    for (int count = 1; count <= most_cells; ++count) {
      PassiveOnePort circuit{.impedance = impedance.formula(),
                             .band = band,
                             .tolerance = tolerance,
                             .form = form,
                             .cells = cells_of(fitted(f, axis, rates_of(axis, f, count)), form),
                             .message = {}};
      if (circuit.cells.empty()) continue;
      detail::certify(
          circuit, whole, circuit.elements(), [&](double omega) { return circuit.response(omega); },
          std::to_string(circuit.elements()) + " elements");
      if (circuit.usable()) return circuit;
      if (circuit.max_relative_error < best.max_relative_error) best = std::move(circuit);
    }
  }
  throw std::domain_error(
      "impedance: no sum of resistors with capacitors, or with inductors, keeps the tolerance; the best one has "
      "an error of " +
      bound_text(best.max_relative_error) +
      ". A formula with functions is taken as such a sum, which one that resonates is not");
}

}  // namespace frac
