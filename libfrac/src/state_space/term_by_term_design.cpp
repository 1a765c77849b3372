// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>

#include "frac/approximation/approximate.hpp"
#include "frac/cancellation.hpp"
#include "model_on_band.hpp"

namespace frac::detail {
namespace {

using Extended = long double;
using Complex = std::complex<Extended>;

// coefficient s^whole L(s), L the ladder of index `ladder`, or 1 where that is negative.
struct Term {
  Extended coefficient;
  int whole;
  int ladder;
};

struct ValueAndSlope {
  Complex value;
  Complex slope;
};

struct Ladder {
  double order;
  std::vector<Extended> zeros;
  std::vector<Extended> poles;
  Extended gain = 1;
  bool in_denominator = false;

  // Multiplied factor by factor, so that the slope is as accurate at a zero, where a root may be, as elsewhere.
  [[nodiscard]] ValueAndSlope operator()(Complex s) const {
    ValueAndSlope product{gain, 0};
    for (std::size_t i = 0; i < poles.size(); ++i) {
      const Complex inverse = Extended(1) / (s - poles[i]);
      const Complex factor = (s - zeros[i]) * inverse;
      product.slope = product.slope * factor + product.value * ((zeros[i] - poles[i]) * inverse * inverse);
      product.value *= factor;
    }
    return product;
  }
};

// N(s)/D(s) of ladders, on the band scaled to be centred at 1 rad/s.
struct RationalRatio {
  std::vector<Ladder> ladders;
  std::vector<Term> numerator;
  std::vector<Term> denominator;

  [[nodiscard]] ValueAndSlope sum(const std::vector<Term>& terms, Complex s, int divided) const {
    ValueAndSlope total{0, 0};
    for (const Term& term : terms) {
      const int power = term.whole - divided;
      const ValueAndSlope ladder =
          term.ladder < 0 ? ValueAndSlope{1, 0} : ladders[static_cast<std::size_t>(term.ladder)](s);
      const Complex whole = power == 0 ? Complex(1) : std::pow(s, power);
      const Complex whole_slope = power == 0 ? Complex(0) : static_cast<Extended>(power) * std::pow(s, power - 1);
      total.value += term.coefficient * whole * ladder.value;
      total.slope += term.coefficient * (whole_slope * ladder.value + whole * ladder.slope);
    }
    return total;
  }
};

int highest(const std::vector<Term>& terms) {
  return std::max_element(terms.begin(), terms.end(), [](const Term& a, const Term& b) { return a.whole < b.whole; })
      ->whole;
}

RationalRatio with_ladders(const ModelOnBand& model, double ladder_tolerance) {
  constexpr double same_order = 1e-12;
  const std::vector<PowerTerm>& top = model.model().numerator();
  const std::vector<PowerTerm>& bottom = model.model().denominator();
  const double lowest = std::min(top.back().order, bottom.back().order);
  const auto fraction_of = [](double order) {
    const double fraction = order - std::floor(order);
    return fraction < same_order || fraction > 1 - same_order ? 0 : fraction;
  };
  // The ratio is to be proper as the model is.  Where the whole part of the numerator's order is the higher one, the
  // leading power of the denominator, and those that share its ladder, are rounded up and get a ladder of negative
  // order.
  const double leading = fraction_of(bottom.front().order - lowest);
  const auto whole_of = [&](double order) { return std::floor(order + same_order); };
  const bool from_above = leading > 0 && whole_of(top.front().order - lowest) > whole_of(bottom.front().order - lowest);
  RationalRatio ratio;
  const auto convert = [&](const std::vector<PowerTerm>& terms, std::vector<Term>& result, bool is_denominator) {
    for (const PowerTerm& term : terms) {
      const double order = term.order - lowest;
      double fraction = fraction_of(order);
      double whole = whole_of(order);
      if (from_above && fraction != 0 && std::abs(fraction - leading) < same_order) {
        fraction -= 1;
        whole += 1;
      }
      int index = -1;
      if (fraction != 0) {
        const auto found = std::find_if(ratio.ladders.begin(), ratio.ladders.end(), [&](const Ladder& ladder) {
          return std::abs(ladder.order - fraction) < same_order;
        });
        index = static_cast<int>(found - ratio.ladders.begin());
        if (found == ratio.ladders.end()) ratio.ladders.push_back({fraction, {}, {}, 1, false});
        Ladder& ladder = ratio.ladders[static_cast<std::size_t>(index)];
        ladder.in_denominator = ladder.in_denominator || is_denominator;
      }
      const Extended scale = std::pow(static_cast<Extended>(model.centre()), static_cast<Extended>(order));
      result.push_back({static_cast<Extended>(term.coefficient) * scale, static_cast<int>(whole), index});
    }
  };
  convert(bottom, ratio.denominator, true);
  convert(top, ratio.numerator, false);
  const FrequencyBand unit{std::exp(-model.half_width()), std::exp(model.half_width())};
  for (Ladder& ladder : ratio.ladders) {
    const Approximation design = approximate(ladder.order, unit, Tolerance{ladder_tolerance});
    ladder.zeros.assign(design.system.zeros.begin(), design.system.zeros.end());
    ladder.poles.assign(design.system.poles.begin(), design.system.poles.end());
    ladder.gain = static_cast<Extended>(design.system.gain);
  }
  return ratio;
}

// All roots of the denominator but those at 0, by Aberth's simultaneous iteration on D times the poles of its ladders.
std::vector<Complex> roots(const RationalRatio& ratio, const ModelOnBand& model, int at_origin) {
  std::vector<Extended> ladder_poles;
  for (const Ladder& ladder : ratio.ladders) {
    if (ladder.in_denominator) ladder_poles.insert(ladder_poles.end(), ladder.poles.begin(), ladder.poles.end());
  }
  std::vector<Complex> root;
  for (std::size_t i = 0; i < ladder_poles.size(); ++i) {
    root.push_back(ladder_poles[i] * std::polar(Extended(1.2), Extended(i % 2 == 0 ? 0.3 : -0.35)));
  }
  const std::size_t count = ladder_poles.size() + static_cast<std::size_t>(highest(ratio.denominator) - at_origin);
  for (const Mode& mode : model.kept_poles()) {
    for (const auto pole : {mode.pole, std::conj(mode.pole)}) {
      if (root.size() == count || mode.pole == 0.0) break;
      root.push_back(Complex(pole / model.centre()) * std::polar(Extended(1.01), Extended(0.01)));
      if (mode.pole.imag() == 0) break;
    }
  }
  for (std::size_t k = 1; root.size() < count; ++k) {
    root.push_back(std::polar(static_cast<Extended>(k), Extended(2.2) + Extended(1.3) * static_cast<Extended>(k)));
  }
  constexpr int most_rounds = 400;
  for (int round = 0; round < most_rounds; ++round) {
    throw_if_cancelled();
    Extended largest = 0;
    for (std::size_t i = 0; i < count; ++i) {
      const Complex s = root[i];
      const ValueAndSlope d = ratio.sum(ratio.denominator, s, at_origin);
      if (d.value == Complex(0)) continue;
      Complex inverse = d.slope / d.value;
      for (const Extended pole : ladder_poles) inverse += Extended(1) / (s - pole);
      for (std::size_t j = 0; j < count; ++j) {
        if (j != i) inverse -= Extended(1) / (s - root[j]);
      }
      const Complex change = Extended(1) / inverse;
      if (!(std::isfinite(change.real()) && std::isfinite(change.imag()))) continue;
      root[i] -= change;
      largest = std::max(largest, std::abs(change) / std::abs(root[i]));
    }
    if (largest < 1e-17L) break;
  }
  return root;
}

// Residue at pole i of a ladder of the numerator, of which every term with it has a share.
Extended ladder_residue(const RationalRatio& ratio, std::size_t index, std::size_t i) {
  const Ladder& ladder = ratio.ladders[index];
  const Complex pole = ladder.poles[i];
  Complex residue = ladder.gain * (pole - ladder.zeros[i]);
  for (std::size_t j = 0; j < ladder.poles.size(); ++j) {
    if (j != i) residue *= (pole - ladder.zeros[j]) / (pole - ladder.poles[j]);
  }
  Complex factor = 0;
  for (const Term& term : ratio.numerator) {
    if (term.ladder == static_cast<int>(index)) factor += term.coefficient * std::pow(pole, term.whole);
  }
  return (factor * residue / ratio.sum(ratio.denominator, pole, 0).value).real();
}

// Laurent coefficients at 0, a pole of some order, from a circle that holds no other pole.
Mode mode_at_origin(const RationalRatio& ratio, int order, Extended radius, Extended centre) {
  constexpr int points = 64;
  Mode mode{0, std::vector<std::complex<double>>(static_cast<std::size_t>(order))};
  for (int k = 0; k < order; ++k) {
    Complex sum = 0;
    for (int i = 0; i < points; ++i) {
      const Complex s =
          std::polar(radius, 2 * std::numbers::pi_v<Extended> * (static_cast<Extended>(i) + Extended(0.5)) / points);
      sum += ratio.sum(ratio.numerator, s, 0).value / ratio.sum(ratio.denominator, s, order).value * std::pow(s, -k);
    }
    mode.residues[static_cast<std::size_t>(order - 1 - k)] =
        static_cast<double>(sum.real() / points * std::pow(centre, static_cast<Extended>(order - k)));
  }
  return mode;
}

// What the ratio tends to at infinity.
double direct_gain(const RationalRatio& ratio) {
  const int high = highest(ratio.denominator);
  if (highest(ratio.numerator) != high) return 0;
  const auto at_infinity = [&](const std::vector<Term>& terms) {
    Extended sum = 0;
    for (const Term& term : terms) {
      if (term.whole == high)
        sum += term.coefficient * (term.ladder < 0 ? 1 : ratio.ladders[static_cast<std::size_t>(term.ladder)].gain);
    }
    return sum;
  };
  return static_cast<double>(at_infinity(ratio.numerator) / at_infinity(ratio.denominator));
}

}  // namespace

ModalDesign term_by_term_design(const ModelOnBand& model, double ladder_tolerance) {
  const RationalRatio ratio = with_ladders(model, ladder_tolerance);
  const int at_origin =
      std::min_element(ratio.denominator.begin(), ratio.denominator.end(), [](const Term& a, const Term& b) {
        return a.whole < b.whole;
      })->whole;
  const Extended centre = model.centre();
  ModalDesign design;
  design.density = 3;
  for (const Ladder& ladder : ratio.ladders) {
    design.density = std::max(design.density, 3.0 * static_cast<double>(ladder.poles.size()) / model.half_width());
  }
  const auto add = [&](Complex pole, Complex residue) {
    design.modes.push_back({std::complex<double>(pole * centre), {std::complex<double>(residue * centre)}});
  };
  Extended nearest = 1;
  for (const Complex root : roots(ratio, model, at_origin)) {
    nearest = std::min(nearest, std::abs(root));
    const bool real = std::abs(root.imag()) < 1e-12L * std::abs(root);
    if (!real && root.imag() < 0) continue;
    const Complex pole = real ? Complex(root.real()) : root;
    const ValueAndSlope d = ratio.sum(ratio.denominator, pole, 0);
    const Complex residue = ratio.sum(ratio.numerator, pole, 0).value / d.slope;
    add(pole, real ? Complex(residue.real()) : residue);
  }
  for (std::size_t index = 0; index < ratio.ladders.size(); ++index) {
    const Ladder& ladder = ratio.ladders[index];
    if (ladder.in_denominator) continue;
    for (std::size_t i = 0; i < ladder.poles.size(); ++i) {
      nearest = std::min(nearest, std::abs(ladder.poles[i]));
      add(ladder.poles[i], ladder_residue(ratio, index, i));
    }
  }
  if (at_origin > 0) design.modes.push_back(mode_at_origin(ratio, at_origin, nearest / 4, centre));
  design.direct = direct_gain(ratio);
  return design;
}

}  // namespace frac::detail
