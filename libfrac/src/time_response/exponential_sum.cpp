// SPDX-License-Identifier: BSD-3-Clause
#include "exponential_sum.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "branch_cut.hpp"
#include "exponential_terms.hpp"
#include "formula/whole_orders.hpp"
#include "special/phi_functions.hpp"

namespace frac::detail {
namespace {

using Complex = std::complex<double>;
constexpr double pi = std::numbers::pi;

// sum c e^{q zeta - scale} and its derivative.
struct LongSum {
  std::complex<long double> value, slope;
};
LongSum long_sum(const PowerProduct& product, std::complex<long double> zeta, long double scale) {
  LongSum whole{1, 0};
  long double left = scale;
  product.for_each_sum([&](const std::vector<PowerTerm>& terms, int power) {
    LongSum sum{0, 0};
    for (const PowerTerm& term : terms) {
      const long double order = term.order;
      const std::complex<long double> part = static_cast<long double>(term.coefficient) * std::exp(order * zeta - left);
      sum.value += part;
      sum.slope += order * part;
    }
    left = 0;
    for (int i = 0; i < power; ++i) {
      whole.slope = whole.slope * sum.value + whole.value * sum.slope;
      whole.value *= sum.value;
    }
  });
  return whole;
}

// The term of a single pole.  With another pole at distance d the weights are as large as 1/d, and the rounding of the
// two poles makes them err by 1/d^2 roundings: long double allows 1/d to be a thousand.
Exponential single_pole(const LaplaceImage& image, std::size_t k) {
  const double scale = scaled_sum(image.denominator(), image.poles().clusters[k].log_s).scale;
  std::complex<long double> zeta = image.poles().clusters[k].log_s;
  for (int i = 0; i < 3; ++i) {
    const LongSum bottom = long_sum(image.denominator(), zeta, scale);
    const std::complex<long double> change = bottom.value / bottom.slope;
    if (!(std::abs(change) < 0.1L * image.clearance(k))) break;
    zeta -= change;
  }
  const LongSum top = long_sum(image.numerator(), zeta, scale);
  const LongSum bottom = long_sum(image.denominator(), zeta, scale);
  return {Complex(std::exp(zeta)), Complex(top.value / bottom.slope * std::exp(zeta))};
}

// Terms of one pole; of a cluster, the trapezoidal rule on a circle about it, so small that e^{st} neither outgrows its
// value at the middle over the time it lasts nor outlasts it.
void add_pole(const LaplaceImage& image, std::size_t k, bool on_cut, double latest, Complex share,
              std::vector<Exponential>& terms) {
  const RootCluster& pole = image.poles().clusters[k];
  const bool alone = pole.is_conjugate || on_cut;
  const Complex log_s = on_cut ? Complex(pole.log_s.real(), pi) : pole.log_s;
  if (pole.multiplicity == 1) {
    Exponential term = single_pole(image, k);
    if (alone) {
      term.rate = term.rate.real();
      term.weight = term.weight.real();
    } else {
      term.weight *= 2.0 * share;
    }
    terms.push_back(term);
    return;
  }
  const double modulus = std::exp(log_s.real());
  const double lasting = std::max(3 / (modulus * latest), -0.5 * std::cos(log_s.imag()));
  const double clearance = image.clearance(k);
  const bool is_factored = image.denominator().is_factored();
  const double farthest = is_factored ? std::min({4 * pole.spread, 0.7 * clearance, 0.9}) : 4 * pole.spread;
  const double radius = std::max(std::min({0.5 * clearance, 0.3, lasting}), farthest);
  // The rule errs by the powers of both ratios.
  const double ratio = is_factored ? std::max(pole.spread / radius, radius / clearance) : 0.5;
  const int points = std::max(48, 2 * static_cast<int>(std::ceil(-20 / std::log(ratio))));
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
                                          [&](const Exponential& term) { return !is_slow(term.rate, latest); });
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

// What the sum is wanted for.
struct Purpose {
  double earliest, latest, tolerance;
  std::size_t integrations, constants;
  FastTerms fast;
};

// The m-fold integral over latest^m at latest * share.
double integral_at(const ExponentialSum& sum, const Purpose& purpose, double share) {
  const std::size_t m = purpose.integrations;
  const double t = purpose.latest * share;
  double value = 0;
  double power = 1;  // t^(m-i)/(m-i)! over latest^m, from i = m down
  for (std::size_t k = 0; k < m; ++k) power /= purpose.latest;
  for (std::size_t i = m + 1; i-- > 0;) {
    if (i < sum.constants.size()) value += sum.constants[i] * power;
    power *= t / static_cast<double>(m - i + 1);
  }
  std::vector<Complex> phis(m + 1);
  const double scale = std::pow(purpose.latest, -static_cast<double>(m));
  for (const Exponential& term : sum.terms) {
    const Complex z = term.rate * t;
    if (term.is_direct || m == 0) {
      value += (term.is_direct ? scale : 1) * (term.weight * expm1(z)).real();
    } else {
      phi(z, phis);
      value += std::pow(share, static_cast<double>(m)) * (term.weight * (z * phis[m])).real();
    }
  }
  return value;
}

// Number of the constants that diverge as sums over fast nodes, one at least: Y s grows as s^q, q >= 1 with
// integrations split off, and its polynomial part has no node.  They are read from the image instead.
std::size_t anchored_count(const LaplaceImage& image) {
  const double growth = image.numerator().front().order - image.denominator().front().order + 1;
  return growth >= 1 ? static_cast<std::size_t>(std::floor(growth)) + 1 : 1;
}

ExponentialSum with_tolerance(const LaplaceImage& image, const Purpose& purpose) {
  const auto [earliest, latest, tolerance, integrations, constants, fast] = purpose;
  const bool is_direct = fast == FastTerms::direct && integrations > 0;
  ExponentialSum sum{{}, std::vector<double>(constants, 0.0), 0};
  std::vector<Exponential>& terms = sum.terms;
  const std::vector<RootCluster>& poles = image.poles().clusters;
  const std::vector<double> log_anchor =
      log_anchors(poles, latest, is_direct ? integrations + 1 : anchored_count(image));
  const auto image_at = [&](Complex zeta) { return image.value(zeta, zeta); };
  if (has_whole_orders(image.numerator().terms) && has_whole_orders(image.denominator().terms)) {
    for (std::size_t k = 0; k < poles.size(); ++k) {
      const double argument = poles[k].log_s.imag();
      const bool on_cut = std::abs(argument - pi) < 1e-7 + poles[k].spread;
      if (on_cut || argument < pi) add_pole(image, k, on_cut, latest, 1, terms);
    }
    if (is_direct) make_direct(terms, latest, integrations);
    sum.constants = constants_of(terms, image_at, log_anchor, nullptr, 0, integrations, constants);
    return sum;
  }
  const CutRule rule(image, earliest, tolerance);
  const double lowest = std::min(image.lowest_corner(), -std::log(latest));
  const double negligible = 0.03 * rule.step() * tolerance;
  std::vector<Exponential> along;
  const double largest = append_cut_terms(rule, image_at, latest, integrations, lowest, negligible, along);
  if (rule.angle() == pi) {
    for (Exponential& term : along) term.weight = term.weight.real();
  }
  for (std::size_t k = 0; k < poles.size(); ++k) {
    const Complex share = rule.share_of(poles[k]);
    if (share == 0.0) continue;
    add_pole(image, k, false, latest, share, terms);
    const bool lies_beyond = poles[k].log_s.imag() > rule.angle();
    const Exponential& last = terms.back();
    const double added = effect(std::abs(last.weight), std::abs(last.rate), latest, integrations);
    if (lies_beyond && added < negligible * largest) terms.pop_back();
  }
  const std::size_t first_of_cut = terms.size();
  terms.insert(terms.end(), along.begin(), along.end());
  if (is_direct) make_direct(terms, latest, integrations);
  sum.constants = constants_of(terms, image_at, log_anchor, &rule, 1e-3 * rule.step() * tolerance * largest,
                               integrations, constants);
  merge_slow(terms, first_of_cut, rule.angle(), latest, tolerance);
  return sum;
}

}  // namespace

std::vector<double> log_anchors(const std::vector<RootCluster>& poles, double latest, std::size_t count) {
  struct Candidate {
    double log_s, distance;
  };
  std::vector<Candidate> candidates;
  for (std::size_t i = 0; i < 2 * count + 4; ++i) {
    // 0, 0.8, -0.8, 1.6, ...
    const double offset = 0.8 * static_cast<double>((i + 1) / 2) * (i % 2 == 1 ? 1 : -1);
    const double log_s = offset - std::log(latest);
    double distance = 1;
    for (const RootCluster& pole : poles) {
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

double effect(double weight, double rate, double latest, std::size_t integrations) {
  const double x = rate * latest;
  return x < 1 ? weight * x : weight * std::pow(x, -static_cast<double>(integrations));
}

ExponentialSum exponential_sum(const LaplaceImage& image, double earliest, double latest, double tolerance,
                               std::size_t integrations, std::size_t constants, FastTerms fast) {
  Purpose purpose{earliest, latest, tolerance, integrations, constants, fast};
  ExponentialSum sum = with_tolerance(image, purpose);
  const double unit = std::pow(latest, -static_cast<double>(integrations));
  double largest = 0;
  for (const Exponential& term : sum.terms) {
    const double weight = std::abs(term.weight);
    largest =
        std::max(largest, term.is_direct ? weight * unit : effect(weight, std::abs(term.rate), latest, integrations));
  }
  for (const double share : {1.0, 1 / 3.0, 1 / 20.0}) {
    const double value = integral_at(sum, purpose, share);
    if (std::isfinite(value)) sum.size = std::max(sum.size, std::abs(value));
  }
  // Beyond 1e-16 the rounding of the parts decides.
  purpose.tolerance = std::max(1e-16, tolerance * sum.size / largest);
  if (purpose.tolerance < 0.5 * tolerance) {
    const double size = sum.size;
    sum = with_tolerance(image, purpose);
    sum.size = size;
  }
  return sum;
}

}  // namespace frac::detail
