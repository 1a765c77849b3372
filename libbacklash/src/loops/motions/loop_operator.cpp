// SPDX-License-Identifier: BSD-3-Clause
#include "loop_operator.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "formula/power_sum.hpp"
#include "formula/whole_orders.hpp"
#include "loops/equations/image_train.hpp"
#include "poles/laplace_image.hpp"

namespace backlash::detail {
namespace {

using Complex = std::complex<double>;
using frac::detail::has_whole_orders;
constexpr double pi = std::numbers::pi;

// Nodes along the cut: a_k = e^{(k + shift) step}.
class Cut {
 public:
  Cut(frac::FrequencyBand band, double tolerance, double shift)
      : step_(pi * pi / std::log(2 / tolerance)), shift_(shift) {
    // The modes at its ends err by about the square of the distance.
    first_ = static_cast<int>(std::floor(std::log(band.lower * std::sqrt(tolerance)) / step_));
    last_ = static_cast<int>(std::ceil(std::log(band.upper / std::sqrt(tolerance)) / step_));
  }
  [[nodiscard]] double node(int k) const { return std::exp((k + shift_) * step_); }
  [[nodiscard]] int first() const { return first_; }
  [[nodiscard]] int last() const { return last_; }
  [[nodiscard]] double step() const { return step_; }
  [[nodiscard]] double shift() const { return shift_; }
  void refine() {
    step_ /= 2;
    first_ *= 2;
    last_ *= 2;
  }

 private:
  double step_;
  double shift_;
  int first_;
  int last_;
};

// One mode for all nodes below the band, which keep their sum and their centre, and one for all above, which keep what
// they make of slow signals and of their rate.
struct Tail {
  double sum = 0;     // of weights; above, over the node
  double moment = 0;  // of weights times the node; above, over its square
};
void add_low(LoopOperator& result, int derivative, const Tail& tail) {
  if (tail.sum != 0) result.modes.push_back({derivative, -std::max(0.0, tail.moment / tail.sum), tail.sum / 2});
}
void add_high(LoopOperator& result, int derivative, const Tail& tail, double upper) {
  const double node = tail.sum / tail.moment;
  if (!(node > upper)) return;
  result.modes.push_back({derivative, -node, tail.sum * node / 2});
}

// The modes of all powers that act on the same derivative share their nodes.
void add_node(LoopOperator& result, int derivative, double node, double weight) {
  for (LoopOperator::OperatorMode& mode : result.modes) {
    if (mode.derivative == derivative && mode.rate == -node) {
      mode.weight += weight / 2;
      return;
    }
  }
  result.modes.push_back({derivative, -node, weight / 2});
}

// coefficient s^order, order below 2.
void add_power(LoopOperator& result, double coefficient, double order, const Cut& cut) {
  if (order == 0) {
    result.on_position += coefficient;
    return;
  }
  if (order == 1) {
    result.on_velocity += coefficient;
    return;
  }
  if (order == std::round(order)) {
    const auto integrals = static_cast<std::size_t>(-order);
    if (result.integral_weights.size() < integrals) result.integral_weights.resize(integrals, 0.0);
    result.integral_weights[integrals - 1] += coefficient;
    return;
  }
  const int derivative = static_cast<int>(std::floor(order)) + 1;
  const double p = derivative - order;
  const double scale = coefficient * std::sin(p * pi) / pi * cut.step();
  const auto weight = [&](int k) { return scale * std::pow(cut.node(k), 1 - p); };
  for (int k = cut.first(); k <= cut.last(); ++k) add_node(result, derivative, cut.node(k), weight(k));
  // Geometric series.
  const double low = cut.node(cut.first()), high = cut.node(cut.last());
  const auto rest = [&](double power) { return 1 / std::expm1(power * cut.step()); };
  add_low(result, derivative, {weight(cut.first()) * rest(1 - p), weight(cut.first()) * low * rest(2 - p)});
  add_high(result, derivative, {weight(cut.last()) / high * rest(p), weight(cut.last()) / (high * high) * rest(1 + p)},
           high);
}

// A strictly proper image, integrable at the origin, of x^(derivative).
void add_image(LoopOperator& result, const ImagePart& part, int derivative, const Cut& cut, bool has_cut) {
  for (const ImagePart::Exponential& pole : part.poles) {
    if (std::abs(pole.rate.imag()) > 1e-9 * std::abs(pole.rate)) {
      result.modes.push_back({derivative, pole.rate, pole.weight});
      continue;
    }
    double weight = pole.weight.real();
    if (pole.rate.real() < 0) {
      // On the cut: half of the residue on each lip.  The rule errs by pi cot of its distance from the nodes.
      const double distance = std::log(-pole.rate.real()) / cut.step() - cut.shift();
      const double lip = pole.weight.imag();
      weight = 0.5 * (weight + (std::abs(lip) > 1e-12 * std::abs(weight) ? lip / std::tan(pi * distance) : 0));
    }
    result.modes.push_back({derivative, pole.rate.real(), weight});
  }
  if (!has_cut) return;
  const auto weight = [&](int k) {
    const double node = cut.node(k);
    return -cut.step() / pi * node * part.image->value(Complex(std::log(node), pi)).imag();
  };
  for (int k = cut.first(); k <= cut.last(); ++k) add_node(result, derivative, cut.node(k), weight(k));
  Tail low, high;
  constexpr int most = 400;
  for (int k = cut.first() - 1; k > cut.first() - most; --k) {
    const double part_of = weight(k);
    low.sum += part_of;
    low.moment += part_of * cut.node(k);
    if (std::abs(part_of) < 1e-15 * std::abs(low.sum)) break;
  }
  for (int k = cut.last() + 1; k < cut.last() + most; ++k) {
    const double part_of = weight(k) / cut.node(k);
    high.sum += part_of;
    high.moment += part_of / cut.node(k);
    if (std::abs(part_of) < 1e-15 * std::abs(high.sum)) break;
  }
  add_low(result, derivative, low);
  add_high(result, derivative, high, cut.node(cut.last()));
}

LoopOperator realised_on(const frac::FractionalTransferFunction& operand, const Cut& cut) {
  LoopOperator result;
  const std::vector<frac::PowerTerm>& top = operand.numerator();
  const std::vector<frac::PowerTerm>& bottom = operand.denominator();
  if (bottom.size() == 1) {
    for (const frac::PowerTerm& term : top) {
      add_power(result, term.coefficient / bottom.front().coefficient, term.order - bottom.front().order, cut);
    }
    return result;
  }
  // C = terms that it has at the origin + rest, and the rest over s^derivative is integrable at both ends.
  const double growth = top.front().order - bottom.front().order;
  const int derivative = growth < 0 ? 0 : static_cast<int>(std::floor(growth)) + 1;
  const frac::detail::LaplaceImage whole(top, bottom);
  const frac::detail::LaplaceImage::OriginExpansion expansion = whole.origin_expansion(derivative - 1);
  for (const frac::PowerTerm& term : expansion.terms) add_power(result, term.coefficient, term.order, cut);
  if (expansion.remainder.empty()) return result;
  const ImagePart part({{}, expansion.remainder}, {{}, frac::detail::scaled(bottom, 1, derivative)}, 0);
  add_image(result, part, derivative, cut, !has_whole_orders(top) || !has_whole_orders(bottom));
  return result;
}

}  // namespace

Complex LoopOperator::response(double omega) const {
  const Complex s(0, omega);
  Complex sum = on_position + on_velocity * s;
  Complex power = 1;
  for (const double weight : integral_weights) {
    power /= s;
    sum += weight * power;
  }
  for (const OperatorMode& mode : modes) {
    const Complex both = mode.weight / (s - mode.rate) + std::conj(mode.weight) / (s - std::conj(mode.rate));
    sum += std::pow(s, mode.derivative) * both;
  }
  return sum;
}

LoopOperator realised(const frac::FractionalTransferFunction& operand, frac::FrequencyBand band, double tolerance,
                      double shift) {
  Cut cut(band, tolerance, shift);
  const frac::FractionalTransferFunction without_delay(operand.numerator(), operand.denominator());
  LoopOperator result;
  // A density that changes faster than that of a power needs nodes that are closer.
  for (int i = 0; i < 3; ++i, cut.refine()) {
    result = realised_on(without_delay, cut);
    const bool is_exact =
        std::none_of(result.modes.begin(), result.modes.end(), [](const auto& mode) { return mode.is_real(); }) ||
        (has_whole_orders(operand.numerator()) && has_whole_orders(operand.denominator()));
    if (is_exact) return result;
    result.error = 0;
    constexpr int points = 60;
    const double low = std::log(band.lower), high = std::log(band.upper);
    for (int k = 0; k <= points; ++k) {
      const double omega = std::exp(low + (high - low) * k / points);
      result.error = std::max(result.error, std::abs(result.response(omega) / without_delay.response(omega) - 1.0));
    }
    if (result.error < 30 * tolerance) break;
  }
  return result;
}

}  // namespace backlash::detail
