// SPDX-License-Identifier: BSD-3-Clause
#include "placed_operator.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "formula/power_sum.hpp"

namespace backlash::detail {
namespace {

using Index = Eigen::Index;

}  // namespace

std::optional<frac::FractionalTransferFunction> resistance(const frac::FractionalTransferFunction& receptance,
                                                           double mass) {
  const std::vector<frac::PowerTerm>& top = receptance.numerator();
  const std::vector<frac::PowerTerm>& bottom = receptance.denominator();
  std::vector<frac::PowerTerm> rest = frac::detail::merged(bottom, frac::detail::scaled(top, -mass, 2));
  // The leading terms cancel but for rounding.
  std::erase_if(rest, [&](const frac::PowerTerm& term) { return term.order > bottom.front().order - 1e-9; });
  if (rest.empty()) return std::nullopt;
  return frac::FractionalTransferFunction(rest, top);
}

Index PlacedOperator::size() const {
  auto count = static_cast<Index>(of.integral_weights.size());
  for (const LoopOperator::OperatorMode& mode : of.modes) count += mode.is_real() ? 1 : 2;
  return count;
}

PlacedOperator::Row PlacedOperator::output(const Row& position, const Row& velocity) const {
  Row row = of.on_position * position + of.on_velocity * velocity;
  Index i = first;
  for (const double weight : of.integral_weights) row[i++] += weight;
  for (const LoopOperator::OperatorMode& mode : of.modes) {
    row[i++] += 2 * mode.weight.real();
    if (!mode.is_real()) row[i++] -= 2 * mode.weight.imag();
  }
  return row;
}

void PlacedOperator::fill(Eigen::MatrixXd& a, const Row& position, const Row& velocity, const Row& acceleration) const {
  const auto unit = [&](Index at) {
    Row row = Row::Zero(a.cols());
    row[at] = 1;
    return row;
  };
  const Index integrals = first;
  Index i = integrals;
  for (std::size_t k = 0; k < of.integral_weights.size(); ++k, ++i) {
    a.row(i) = k == 0 ? position : unit(i - 1);
  }
  for (const LoopOperator::OperatorMode& mode : of.modes) {
    const Row signal = mode.derivative == 0   ? position
                       : mode.derivative == 1 ? velocity
                       : mode.derivative == 2 ? acceleration
                                              : unit(integrals - mode.derivative - 1);
    a.row(i) = signal;
    a(i, i) += mode.rate.real();
    if (!mode.is_real()) {
      a(i, i + 1) -= mode.rate.imag();
      a(i + 1, i) += mode.rate.imag();
      a(i + 1, i + 1) += mode.rate.real();
      ++i;
    }
    ++i;
  }
}

void PlacedOperator::scale(Eigen::VectorXd& sizes, double length, double pace) const {
  Index i = first;
  double integral = length;
  for (std::size_t k = 0; k < of.integral_weights.size(); ++k) sizes[i++] = integral /= pace;
  for (const LoopOperator::OperatorMode& mode : of.modes) {
    const double size = length * std::pow(pace, mode.derivative) / std::max(pace, std::abs(mode.rate));
    sizes[i++] = size;
    if (!mode.is_real()) sizes[i++] = size;
  }
}

void PlacedOperator::kick(Eigen::VectorXd& state, int derivative, double size) const {
  Index i = first + static_cast<Index>(of.integral_weights.size());
  for (const LoopOperator::OperatorMode& mode : of.modes) {
    if (mode.derivative == derivative) state[i] += size;
    i += mode.is_real() ? 1 : 2;
  }
}

void PlacedOperator::remember(Eigen::VectorXd& state, const std::vector<std::pair<double, std::complex<double>>>& lines,
                              double jump) const {
  using Complex = std::complex<double>;
  Index i = first;
  for (std::size_t k = 0; k < of.integral_weights.size(); ++k, ++i) {
    state[i] = 0;
    for (const auto& [omega, phasor] : lines)
      state[i] += (phasor * std::pow(Complex(0, omega), -static_cast<int>(k) - 1)).real();
  }
  for (const LoopOperator::OperatorMode& mode : of.modes) {
    Complex sum = mode.derivative == 2 ? -0.5 * jump : 0;
    for (const auto& [omega, phasor] : lines) {
      const auto part = [&](Complex s, Complex of_line) {
        return 0.5 * of_line * std::pow(s, mode.derivative) / (s - mode.rate);
      };
      sum += part({0, omega}, phasor) + part({0, -omega}, std::conj(phasor));
    }
    state[i++] = sum.real();
    if (!mode.is_real()) state[i++] = sum.imag();
  }
}

}  // namespace backlash::detail
