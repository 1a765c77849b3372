#include "exponential_sum.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "branch_cut.hpp"

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
void add_pole(const LaplaceImage& image, std::size_t k, bool on_cut, double latest, std::vector<Exponential>& terms) {
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
      weight *= 2;
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

// What a term adds to the sum by the end of the horizon.
double effect(const Exponential& term, double latest) {
  return std::abs(term.weight) * std::min(1.0, std::abs(term.rate) * latest);
}

std::vector<Exponential> with_tolerance(const LaplaceImage& image, double earliest, double latest, double tolerance) {
  std::vector<Exponential> terms;
  const std::vector<RootCluster>& poles = image.poles().clusters;
  if (has_integer_orders(image)) {
    for (std::size_t k = 0; k < poles.size(); ++k) {
      const double argument = poles[k].log_s.imag();
      const bool on_cut = std::abs(argument - pi) < 1e-7 + poles[k].spread;
      if (on_cut || argument < pi) add_pole(image, k, on_cut, latest, terms);
    }
    return terms;
  }
  // A complex term costs as much as two real ones.
  const BranchCut cut = best_cut(image, 0.7, 2);
  for (std::size_t k = 0; k < poles.size(); ++k) {
    if (poles[k].log_s.imag() < cut.angle) add_pole(image, k, false, latest, terms);
  }
  const std::size_t first_of_cut = terms.size();
  const double digits = std::log(1 / tolerance) + 3;
  const double step = 2 * pi * 0.97 * cut.half_width / digits;
  const double upper = std::log(digits / (-std::cos(cut.angle) * earliest));
  const double lowest = std::min(image.lowest_corner(), -std::log(latest));
  double largest = 0;
  for (int k = 0; k < 100'000; ++k) {
    const double log_r = upper - k * step;
    const Complex zeta(log_r, cut.angle);
    const Complex weight = Complex(0, -step / pi) * image.value(zeta, zeta);
    if (cut.angle == pi) {
      terms.push_back({-std::exp(log_r), weight.real()});
    } else {
      terms.push_back({std::exp(zeta), weight});
    }
    const double added = std::abs(weight) * std::min(1.0, std::exp(log_r) * latest);
    largest = std::max(largest, added);
    if (log_r < lowest && added < 0.03 * step * tolerance * largest) break;
  }
  merge_slow(terms, first_of_cut, cut.angle, latest, tolerance);
  return terms;
}

}  // namespace

std::vector<Exponential> exponential_sum(const LaplaceImage& image, double earliest, double latest, double tolerance,
                                         double size) {
  std::vector<Exponential> terms = with_tolerance(image, earliest, latest, tolerance);
  double largest = 0;
  for (const Exponential& term : terms) largest = std::max(largest, effect(term, latest));
  // Beyond 1e-16 the rounding of the parts decides.
  const double finer = std::max(1e-16, tolerance * size / largest);
  return finer < 0.5 * tolerance ? with_tolerance(image, earliest, latest, finer) : terms;
}

}  // namespace frac::detail
