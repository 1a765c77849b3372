#include "exponential_sum.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "branch_cut.hpp"
#include "phi_functions.hpp"

namespace frac::detail {
namespace {

using Complex = std::complex<double>;
constexpr double pi = std::numbers::pi;

bool has_integer_orders(const LaplaceImage& image) {
  const auto is_integer = [](const PowerTerm& term) { return term.order == std::round(term.order); };
  return std::all_of(image.numerator().begin(), image.numerator().end(), is_integer) &&
         std::all_of(image.denominator().begin(), image.denominator().end(), is_integer);
}

// Terms of one pole; of a cluster, the trapezoidal rule on a circle about it, so small that e^{st} neither outgrows its
// value at the middle over the time it lasts nor outlasts it.
void add_pole(const LaplaceImage& image, std::size_t k, bool on_cut, double latest, Complex share,
              std::vector<Exponential>& terms) {
  const RootCluster& pole = image.poles().clusters[k];
  const bool alone = pole.is_conjugate || on_cut;
  const Complex log_s = on_cut ? Complex(pole.log_s.real(), pi) : pole.log_s;
  if (pole.multiplicity == 1) {
    const ScaledSum top = scaled_sum(image.numerator(), log_s);
    const ScaledSum bottom = scaled_sum(image.denominator(), log_s);
    Complex weight = top.value / bottom.slope * std::exp(top.scale - bottom.scale + log_s);
    Complex rate = std::exp(log_s);
    if (alone) {
      rate = rate.real();
      weight = weight.real();
    } else {
      weight *= 2.0 * share;
    }
    terms.push_back({rate, weight});
    return;
  }
  constexpr int points = 48;
  const double modulus = std::exp(log_s.real());
  const double lasting = std::max(3 / (modulus * latest), -0.5 * std::cos(log_s.imag()));
  const double radius = std::max({std::min({0.5 * image.clearance(k), 0.3, lasting}), 4 * pole.spread});
  for (int i = 0; i < (alone ? points / 2 : points); ++i) {
    const Complex offset = std::polar(radius, 2 * pi * (i + 0.5) / points);
    const Complex zeta = log_s + offset;
    terms.push_back({std::exp(zeta), 2.0 / points * image.value(zeta, zeta) * offset});
  }
}

// Exponentials that have not decayed at the end of the horizon, replaced by fewer at Chebyshev points of their common
// ray: (e^{rt} - 1)/r is interpolated in r, with an error below 2 t (|r| t/4)^n/n! for |r| t up to 2; divided by r it
// bears weights that grow towards the origin.
void merge_slow(std::vector<Exponential>& terms, std::size_t first, double angle, double latest, double tolerance) {
  const double end = 2 / latest;
  const auto slow = std::stable_partition(terms.begin() + static_cast<std::ptrdiff_t>(first), terms.end(),
                                          [&](const Exponential& term) { return std::abs(term.rate) > end; });
  std::size_t count = 4;
  for (double error = 2 / 24.0 / 16; error > 0.01 * tolerance && count < 30; ++count) {
    error *= 0.5 / static_cast<double>(count + 1);
  }
  if (static_cast<std::size_t>(terms.end() - slow) <= count) return;
  std::vector<double> point(count), weight(count);
  for (std::size_t j = 0; j < count; ++j) {
    const double theta = pi * (static_cast<double>(j) + 0.5) / static_cast<double>(count);
    point[j] = end / 2 * (1 + std::cos(theta));
    weight[j] = (j % 2 == 0 ? 1 : -1) * std::sin(theta);
  }
  std::vector<Complex> merged(count, 0);
  std::vector<double> share(count);
  for (auto term = slow; term != terms.end(); ++term) {
    const double r = std::abs(term->rate);
    double sum = 0;
    for (std::size_t j = 0; j < count; ++j) {
      share[j] = weight[j] / (r == point[j] ? 1e-300 : r - point[j]);
      sum += share[j];
    }
    for (std::size_t j = 0; j < count; ++j) merged[j] += term->weight * (r / point[j] * (share[j] / sum));
  }
  terms.erase(slow, terms.end());
  const Complex direction = angle == pi ? Complex(-1) : std::polar(1.0, angle);
  for (std::size_t j = 0; j < count; ++j) terms.push_back({point[j] * direction, merged[j]});
}

// Y s at s0 less what the terms make of it.
double rest_at(const LaplaceImage& image, double log_s0, const std::vector<Exponential>& terms) {
  const double s0 = std::exp(log_s0);
  double rest = image.value(log_s0, log_s0).real();
  for (const Exponential& term : terms) rest -= (term.weight * (term.rate / (s0 - term.rate))).real();
  return rest;
}

ExponentialSum with_tolerance(const LaplaceImage& image, double earliest, double latest, double tolerance,
                              std::size_t integrations, std::size_t constants) {
  ExponentialSum sum{{}, std::vector<double>(constants, 0.0)};
  std::vector<Exponential>& terms = sum.terms;
  const std::vector<RootCluster>& poles = image.poles().clusters;
  const std::vector<double> log_anchor = log_anchors(image, latest, anchored_count(image));
  std::vector<double> anchor, rest;
  for (const double log_s0 : log_anchor) anchor.push_back(std::exp(log_s0));
  const auto set_anchored = [&] {
    const std::vector<double> coefficient = interpolating_polynomial(anchor, rest);
    std::copy_n(coefficient.begin(), std::min(coefficient.size(), constants), sum.constants.begin());
  };
  if (has_integer_orders(image)) {
    for (std::size_t k = 0; k < poles.size(); ++k) {
      const double argument = poles[k].log_s.imag();
      const bool on_cut = std::abs(argument - pi) < 1e-7 + poles[k].spread;
      if (on_cut || argument < pi) add_pole(image, k, on_cut, latest, 1, terms);
    }
    for (const double log_s0 : log_anchor) rest.push_back(rest_at(image, log_s0, terms));
    set_anchored();
    return sum;
  }
  const CutRule rule(image, earliest, tolerance);
  const double step = rule.step();
  const double lowest = std::min(image.lowest_corner(), -std::log(latest));
  const auto term_at = [&](int k) -> Exponential {
    const Complex zeta = rule.node(k);
    const Complex weight = Complex(0, -step / pi) * image.value(zeta, zeta);
    if (rule.angle() == pi) return {-std::exp(zeta.real()), weight};
    return {std::exp(zeta), weight};
  };
  const auto effect_of = [&](const Exponential& term) {
    return effect(std::abs(term.weight), std::abs(term.rate), latest, integrations);
  };
  double largest = 0;
  std::vector<Exponential> along;
  for (int k = 0; k < 100'000; ++k) {
    along.push_back(term_at(k));
    const double added = effect_of(along.back());
    if (rule.angle() == pi) along.back().weight = along.back().weight.real();
    largest = std::max(largest, added);
    if (rule.node(k).real() < lowest && added < 0.03 * step * tolerance * largest) break;
  }
  for (std::size_t k = 0; k < poles.size(); ++k) {
    const Complex share = rule.share_of(poles[k]);
    if (share == 0.0) continue;
    add_pole(image, k, false, latest, share, terms);
    const bool lies_beyond = poles[k].log_s.imag() > rule.angle();
    if (lies_beyond && effect_of(terms.back()) < 0.03 * step * tolerance * largest) terms.pop_back();
  }
  const std::size_t first_of_cut = terms.size();
  terms.insert(terms.end(), along.begin(), along.end());
  for (const double log_s0 : log_anchor) rest.push_back(rest_at(image, log_s0, terms));
  const auto anchored = static_cast<int>(anchor.size());
  for (int k = 1; k < 5'000; ++k) {
    const auto [rate, weight] = term_at(-k);
    double size = 0;
    for (std::size_t i = 0; i < anchor.size(); ++i) {
      const Complex ratio = anchor[i] / rate;
      const Complex left = weight * std::pow(ratio, anchored) / (1.0 - ratio);
      rest[i] += left.real();
      size = std::max(size, std::abs(left));
    }
    Complex left = weight / std::pow(rate, anchored);
    for (std::size_t j = anchor.size(); j < constants; ++j, left /= rate) sum.constants[j] -= left.real();
    if (size < 1e-3 * step * tolerance * largest) break;
  }
  set_anchored();
  merge_slow(terms, first_of_cut, rule.angle(), latest, tolerance);
  return sum;
}

}  // namespace

std::size_t anchored_count(const LaplaceImage& image) {
  const double growth = image.numerator().front().order - image.denominator().front().order + 1;
  return growth >= 1 ? static_cast<std::size_t>(std::floor(growth)) + 1 : 1;
}

std::vector<double> log_anchors(const LaplaceImage& image, double latest, std::size_t count) {
  struct Candidate {
    double log_s, distance;
  };
  std::vector<Candidate> candidates;
  for (std::size_t i = 0; i < 2 * count + 4; ++i) {
    // 0, 0.8, -0.8, 1.6, ...
    const double offset = 0.8 * static_cast<double>((i + 1) / 2) * (i % 2 == 1 ? 1 : -1);
    const double log_s = offset - std::log(latest);
    double distance = 1;
    for (const RootCluster& pole : image.poles().clusters) {
      distance = std::min(distance, std::abs(pole.log_s - log_s) - pole.spread);
    }
    candidates.push_back({log_s, distance});
  }
  std::stable_sort(candidates.begin(), candidates.end(),
                   [](const Candidate& a, const Candidate& b) { return a.distance > b.distance; });
  std::vector<double> result;
  for (std::size_t i = 0; i < count; ++i) result.push_back(candidates[i].log_s);
  return result;
}

std::vector<double> interpolating_polynomial(const std::vector<double>& x, std::vector<double> y) {
  // Newton's divided differences, then Horner's scheme on the coefficients.
  const std::size_t count = x.size();
  for (std::size_t order = 1; order < count; ++order) {
    for (std::size_t i = count; i-- > order;) y[i] = (y[i] - y[i - 1]) / (x[i] - x[i - order]);
  }
  std::vector<double> coefficient(count, 0.0);
  for (std::size_t i = count; i-- > 0;) {
    for (std::size_t k = count; k-- > 1;) coefficient[k] = coefficient[k - 1] - x[i] * coefficient[k];
    coefficient[0] = y[i] - x[i] * coefficient[0];
  }
  return coefficient;
}

double effect(double weight, double rate, double latest, std::size_t integrations) {
  const double x = rate * latest;
  return x < 1 ? weight * x : weight * std::pow(x, -static_cast<double>(integrations));
}

ExponentialSum exponential_sum(const LaplaceImage& image, double earliest, double latest, double tolerance,
                               std::size_t integrations, std::size_t constants) {
  ExponentialSum sum = with_tolerance(image, earliest, latest, tolerance, integrations, constants);
  double largest = 0;
  for (const Exponential& term : sum.terms) {
    largest = std::max(largest, effect(std::abs(term.weight), std::abs(term.rate), latest, integrations));
  }
  double size = 0;
  for (const double t : {latest, latest / 3, latest / 20}) {
    double value = sum.constants[0];
    for (const Exponential& term : sum.terms) value += (term.weight * expm1(term.rate * t)).real();
    if (std::isfinite(value)) size = std::max(size, std::abs(value));
  }
  // Beyond 1e-16 the rounding of the parts decides.
  const double finer = std::max(1e-16, tolerance * size / largest);
  return finer < 0.5 * tolerance ? with_tolerance(image, earliest, latest, finer, integrations, constants) : sum;
}

}  // namespace frac::detail
