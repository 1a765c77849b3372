// SPDX-License-Identifier: BSD-3-Clause
#include "power_sum_roots.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <utility>

#include "base/log_ratio.hpp"
#include "formula/whole_orders.hpp"
#include "scaled_sum.hpp"
#include "winding_number.hpp"

namespace frac::detail {
namespace {

using Complex = std::complex<double>;

// Roots closer than that in ln s make one cluster.
constexpr double one_cluster = 1e-3;
// The roots of s^n = c lie 2 pi/n apart in ln s: three times that of a cluster here, and beyond it soon in one cluster.
constexpr double largest_order = 2000;

struct Box {
  double left, right, bottom, top;
  [[nodiscard]] Complex centre() const { return {(left + right) / 2, (bottom + top) / 2}; }
  [[nodiscard]] double size() const { return std::max(right - left, top - bottom); }
  [[nodiscard]] bool contains(Complex z) const {
    return z.real() >= left && z.real() <= right && z.imag() >= bottom && z.imag() <= top;
  }
};

struct Found {
  Complex log_s;
  int multiplicity;
  double radius;
};

// Divides by (y - root), in exact arithmetic or not at all.
bool divides_exactly(std::vector<double>& polynomial, double root) {
  std::vector<double> quotient;
  double carry = 0;
  for (const double coefficient : polynomial) {  // from the highest power down
    const double product = root * carry;
    if (std::fma(root, carry, -product) != 0) return false;
    const double sum = product + coefficient;
    const double back = sum - product;
    if ((product - (sum - back)) + (coefficient - back) != 0) return false;
    carry = sum;
    quotient.push_back(sum);
  }
  if (carry != 0) return false;
  if (!quotient.empty()) quotient.pop_back();
  polynomial = std::move(quotient);
  return true;
}

// A root s = i omega of order m of a polynomial is one of order m, as -omega^2, of its even and its odd part.
bool snapped_to_imaginary_axis(const std::vector<PowerTerm>& sum, RootCluster& cluster) {
  constexpr double pi = std::numbers::pi;
  constexpr double highest_degree = 200;
  if (!(std::abs(cluster.log_s.imag() - pi / 2) < 1e-9) || sum.front().order > highest_degree) return false;
  const auto half_degree = static_cast<std::size_t>(sum.front().order / 2);
  std::vector<double> even(half_degree + 1, 0.0), odd(half_degree + 1, 0.0);  // from the highest power down
  for (const PowerTerm& term : sum) {
    if (term.order != std::floor(term.order)) return false;
    const auto power = static_cast<std::size_t>(term.order);
    (power % 2 == 0 ? even : odd)[half_degree - power / 2] = term.coefficient;
  }
  // omega^2 rounded to 44 bits: only a number short enough to be meant can pass.
  int exponent = 0;
  const double mantissa = std::frexp(std::exp(2 * cluster.log_s.real()), &exponent);
  const double square = std::ldexp(std::round(std::ldexp(mantissa, 44)), exponent - 44);
  for (int i = 0; i < cluster.multiplicity; ++i) {
    if (!divides_exactly(even, -square) || !divides_exactly(odd, -square)) return false;
  }
  cluster.log_s = {std::log(square) / 2, pi / 2};
  cluster.spread = 0;
  cluster.is_exact = true;
  return true;
}

// All roots of a polynomial, coefficients by rising power, by simultaneous iteration (Weierstrass).
std::vector<Complex> polynomial_roots(const std::vector<Complex>& coefficient) {
  const std::size_t degree = coefficient.size() - 1;
  double bound = 0;
  for (std::size_t k = 1; k <= degree; ++k) {
    const double ratio = std::abs(coefficient[degree - k] / coefficient[degree]);
    bound = std::max(bound, std::pow(ratio, 1 / static_cast<double>(k)));
  }
  std::vector<Complex> root;
  for (std::size_t i = 0; i < degree; ++i) {
    root.push_back(
        std::polar(bound, 0.4 + 2 * std::numbers::pi * static_cast<double>(i) / static_cast<double>(degree)));
  }
  for (int round = 0; round < 200; ++round) {
    double largest_step = 0;
    for (std::size_t i = 0; i < degree; ++i) {
      Complex value = 0;
      for (std::size_t k = degree + 1; k-- > 0;) value = value * root[i] + coefficient[k];
      Complex step = value / coefficient[degree];
      for (std::size_t j = 0; j < degree; ++j) {
        if (j != i) step /= root[i] - root[j];
      }
      root[i] -= step;
      largest_step = std::max(largest_step, std::abs(step));
    }
    if (!(largest_step > 1e-15 * bound)) break;
  }
  return root;
}

class Search {
 public:
  explicit Search(const std::vector<PowerTerm>& sum) : sum_(sum), is_polynomial_(has_whole_orders(sum)) {
    for (const PowerTerm& term : sum) log_size_.push_back(std::log(std::abs(term.coefficient)));
  }

  // NaN where an edge meets a root.
  [[nodiscard]] double count(const Box& box) const {
    return winding_number(
        [this](Complex zeta) {
          constexpr double nothing = std::numeric_limits<double>::quiet_NaN();
          work_ += sum_.size();
          if (work_ > most_work) return ValueAndSlope{nothing, nothing};
          const ScaledSum f = value_at(zeta);
          // Within rounding of 0 the phase says nothing: the edge meets a root.
          constexpr double noise = 4 * std::numeric_limits<double>::epsilon();
          if (std::norm(f.value) < noise * noise * f.magnitude * f.magnitude) return ValueAndSlope{nothing, nothing};
          return ValueAndSlope{f.value, f.slope};
        },
        {{box.left, box.bottom}, {box.right, box.bottom}, {box.right, box.top}, {box.left, box.top}});
  }

  void divide(const Box& box, int expected, int depth) {
    if (expected == 0) return;
    if (expected == 1) {
      const std::optional<Complex> root = polished(box.centre());
      if (root && box.contains(*root)) {
        found_.push_back({*root, 1, 0});
        return;
      }
    }
    // A double root is only known to the square root of the rounding, a triple one to the third.
    if (box.size() < std::max(1e-4, blur(box, expected)) || depth == 0) {
      found_.push_back({box.centre(), expected, box.size()});
      return;
    }
    const bool across = box.right - box.left > box.top - box.bottom;
    for (const double share : {0.5, 0.46, 0.55, 0.41, 0.585, 0.37}) {
      Box first = box;
      Box second = box;
      if (across) {
        first.right = second.left = box.left + share * (box.right - box.left);
      } else {
        first.top = second.bottom = box.bottom + share * (box.top - box.bottom);
      }
      const double first_count = count(first);
      const double second_count = count(second);
      if (!(std::abs(first_count + second_count - expected) < 0.01)) continue;
      divide(first, static_cast<int>(std::lround(first_count)), depth - 1);
      divide(second, static_cast<int>(std::lround(second_count)), depth - 1);
      return;
    }
    found_.push_back({box.centre(), expected, box.size()});
    complete_ = complete_ && box.size() < 1e-3;
  }

  // Newton's method from where two terms balance that outweigh all others somewhere, first on the sum, then on the sum
  // over its roots known so far, which leads to others.  True, and the roots are kept, if as many are found as the box
  // holds: they are all then.
  bool find_from_balances(const Box& box, int expected) {
    const auto wanted = static_cast<std::size_t>(expected);
    const auto inside = [&](const std::vector<Complex>& known) { return images_in(box, known); };
    const std::vector<Complex> known = roots_from(
        balanced_points(box, wanted), [&](const std::vector<Complex>& each) { return inside(each).size() < wanted; });
    if (inside(known).size() != wanted) return false;
    for (const Complex root : inside(known)) found_.push_back({root, 1, 0});
    return true;
  }

  // The roots of a polynomial, which need not be counted first: as many distinct ones as its degree are all.  False
  // where Newton's method does not find so many, as where some coincide.
  bool find_of_polynomial(const Box& box) {
    if (!is_polynomial_) return false;
    const auto degree = static_cast<std::size_t>(sum_.front().order);
    const Box plane{box.left, box.right, one_cluster - std::numbers::pi, one_cluster + std::numbers::pi};
    const auto all = [&](const std::vector<Complex>& known) { return images_in(plane, known); };
    const std::vector<Complex> known = roots_from(
        balanced_points(plane, degree), [&](const std::vector<Complex>& each) { return all(each).size() < degree; });
    if (all(known).size() != degree) return false;
    for (const Complex root : images_in(box, known)) found_.push_back({root, 1, 0});
    return true;
  }

  // A linear factor to a power, as of equal lags: its root follows from the two highest terms.
  bool find_of_power(const Box& box) {
    if (!is_polynomial_ || sum_.size() < 3 || sum_.front().order != static_cast<double>(sum_.size() - 1)) return false;
    const auto degree = static_cast<int>(sum_.size() - 1);
    const double root = -sum_[1].coefficient / (degree * sum_[0].coefficient);
    // Nearly all polynomials are told from a power by their third term.
    const double third = 0.5 * degree * (degree - 1) * root * root * sum_[0].coefficient;
    if (!(std::abs(sum_[2].coefficient - third) <= 1e-9 * std::abs(third))) return false;
    const Complex log_root(std::log(std::abs(root)), root < 0 ? std::numbers::pi : 0);
    if (!coincide(taylor_start(sum_, log_root, degree))) return false;
    for (const Complex image : images_in(box, {log_root})) found_.push_back({image, degree, 0});
    return true;
  }

  [[nodiscard]] const std::vector<Found>& found() const { return found_; }
  [[nodiscard]] bool complete() const { return complete_; }
  [[nodiscard]] bool gave_up() const { return work_ > most_work; }

  // The middle of roots that lie close together is nearly a simple root of a derivative, and known to rounding where
  // they coincide.
  void polish(RootCluster& cluster) const {
    if (cluster.multiplicity == 1) return;
    std::vector<PowerTerm> derivative = sum_;
    for (PowerTerm& term : derivative) term.coefficient *= std::pow(term.order, cluster.multiplicity - 1);
    std::erase_if(derivative, [](const PowerTerm& term) { return term.coefficient == 0; });
    const std::optional<Complex> root = polished(derivative, cluster.log_s);
    if (root && std::abs(*root - cluster.log_s) < 2 * cluster.spread) cluster.log_s = *root;
    if (snapped_to_imaginary_axis(sum_, cluster)) return;
    resolve(cluster);
  }

 private:
  [[nodiscard]] ScaledSum value_at(Complex zeta) const { return scaled_sum(sum_, log_size_, zeta); }

  // Distinct roots that Newton's method finds from there and then beside those, as long as more are wanted.
  template <typename MoreWanted>
  [[nodiscard]] std::vector<Complex> roots_from(const std::vector<Complex>& starts,
                                                const MoreWanted& more_wanted) const {
    std::vector<Complex> known;
    const auto take = [&](std::optional<Complex> root) {
      if (!root || !is_new(*root, known)) return false;
      known.push_back(*root);
      return true;
    };
    for (const Complex start : starts) take(polished(start));
    for (const Complex start : starts) {
      // Off the axes, on which the steps from a point on them would stay.
      const Complex beside = start + Complex(0.07, 0.11);
      while (more_wanted(known) && take(polished_beside(known, beside))) {
      }
    }
    return known;
  }

  [[nodiscard]] std::vector<Complex> images_in(const Box& box, const std::vector<Complex>& roots) const {
    std::vector<Complex> inside;
    for (const Complex root : roots) {
      for (const Complex image : images(root)) {
        if (box.contains(image) && is_new(image, inside)) inside.push_back(image);
      }
    }
    return inside;
  }

  // Size of a box below which rounding hides where several roots lie in it.  About m of them the sum is c zeta^m, and
  // its edges must keep away from where that is no more than rounding.
  [[nodiscard]] double blur(const Box& box, int multiplicity) const {
    if (multiplicity < 3) return 0;
    const TaylorStart start = taylor_start(sum_, box.centre(), multiplicity + 1);
    const double noise = std::numeric_limits<double>::epsilon() * start.rounding[0];
    const double radius = std::pow(noise / std::abs(start.coefficient.back()), 1.0 / multiplicity);
    return std::isfinite(radius) ? 8 * radius : 0;
  }

  // Neighbours on the upper hull of (order, ln|coefficient|), by falling order: for each there is an |s| where the two
  // are equal and no other term is larger.
  [[nodiscard]] std::vector<std::pair<const PowerTerm*, const PowerTerm*>> balances() const {
    std::vector<const PowerTerm*> hull;
    const auto height = [](const PowerTerm& term) { return std::log(std::abs(term.coefficient)); };
    const auto slope = [&](const PowerTerm& a, const PowerTerm& b) {
      return (height(a) - height(b)) / (a.order - b.order);
    };
    for (const PowerTerm& term : sum_) {
      while (hull.size() > 1 && slope(*hull[hull.size() - 2], *hull.back()) >= slope(*hull.back(), term)) {
        hull.pop_back();
      }
      hull.push_back(&term);
    }
    std::vector<std::pair<const PowerTerm*, const PowerTerm*>> pairs;
    for (std::size_t i = 1; i < hull.size(); ++i) pairs.emplace_back(hull[i - 1], hull[i]);
    return pairs;
  }

  // Where two terms that outweigh all others cancel, in the box and no more than `most`.
  [[nodiscard]] std::vector<Complex> balanced_points(const Box& box, std::size_t most) const {
    std::vector<Complex> points;
    for (const auto& [high, low] : balances()) {
      const double gap = high->order - low->order;
      const double log_modulus = log_ratio(low->coefficient, high->coefficient) / gap;
      const double turn = (low->coefficient > 0) == (high->coefficient > 0) ? std::numbers::pi : 0;
      const double first = std::ceil((box.bottom * gap - turn) / (2 * std::numbers::pi));
      for (double k = first; points.size() < most; ++k) {
        const double argument = (turn + 2 * std::numbers::pi * k) / gap;
        if (argument > box.top) break;
        points.emplace_back(log_modulus, argument);
      }
    }
    return points;
  }

  // Newton's method ends within far less of a root, so that two ends this far apart are two roots.
  [[nodiscard]] static bool is_new(Complex root, const std::vector<Complex>& known) {
    return std::none_of(known.begin(), known.end(),
                        [&](Complex other) { return std::abs(other - root) < 2 * one_cluster; });
  }

  // The root, its conjugate and, of a polynomial, both on the next sheet.
  [[nodiscard]] std::vector<Complex> images(Complex root) const {
    std::vector<Complex> result{root, std::conj(root)};
    if (is_polynomial_) {
      const double argument = std::remainder(root.imag(), 2 * std::numbers::pi);
      for (const double turns : {0.0, 1.0}) {
        result.emplace_back(root.real(), argument + 2 * std::numbers::pi * turns);
        result.emplace_back(root.real(), -argument + 2 * std::numbers::pi * turns);
      }
    }
    return result;
  }

  [[nodiscard]] bool is_real(Complex root) const {
    const double beside = is_polynomial_ ? std::remainder(root.imag(), std::numbers::pi) : root.imag();
    return std::abs(beside) < one_cluster;
  }

  // A root from there that none of the known ones and their conjugates attracts.
  [[nodiscard]] std::optional<Complex> polished_beside(const std::vector<Complex>& known, Complex zeta) const {
    const auto divided_by = [&](Complex root) {
      return is_polynomial_ ? 1.0 / (1.0 - std::exp(root - zeta)) : 1.0 / (zeta - root);
    };
    for (int i = 0; i < 60; ++i) {
      const ScaledSum f = value_at(zeta);
      Complex slope = f.slope / f.value;
      for (const Complex root : known) {
        slope -= divided_by(root);
        if (!is_real(root)) slope -= divided_by(std::conj(root));
      }
      Complex step = 1.0 / slope;
      if (!std::isfinite(step.real()) || !std::isfinite(step.imag())) return std::nullopt;
      if (std::abs(step) > 0.5) step *= 0.5 / std::abs(step);
      zeta -= step;
      if (std::abs(step) < 1e-6) return polished(zeta);
    }
    return std::nullopt;
  }

  // Empty where Newton's method has not converged.
  [[nodiscard]] static std::optional<Complex> polished(const std::vector<PowerTerm>& sum, Complex zeta) {
    return polished(zeta, [&](Complex at) { return scaled_sum(sum, at); });
  }
  /// Of the sum itself.
  [[nodiscard]] std::optional<Complex> polished(Complex zeta) const {
    return polished(zeta, [&](Complex at) { return value_at(at); });
  }
  template <typename Function>
  [[nodiscard]] static std::optional<Complex> polished(Complex zeta, const Function& function) {
    for (int i = 0; i < 60; ++i) {
      const ScaledSum f = function(zeta);
      Complex step = f.value / f.slope;
      if (!std::isfinite(step.real()) || !std::isfinite(step.imag())) return std::nullopt;
      if (std::abs(step) > 0.5) step *= 0.5 / std::abs(step);
      zeta -= step;
      if (std::abs(step) < 1e-15 * (1 + std::abs(zeta))) return zeta;
      // Where rounding keeps the steps from getting smaller they are smaller than this.
      if (i >= 20 && std::abs(step) < 1e-9) return zeta;
    }
    return std::nullopt;
  }

  // Whether the terms of an expansion are rounding, so that as many roots coincide in its middle.
  [[nodiscard]] static bool coincide(const TaylorStart& start) {
    constexpr double eps = std::numeric_limits<double>::epsilon();
    for (std::size_t j = 0; j < start.coefficient.size(); ++j) {
      if (!(std::abs(start.coefficient[j]) <= 4 * eps * start.rounding[j])) return false;
    }
    return true;
  }

  // How the members lie about the middle, from the start of the expansion there.
  void resolve(RootCluster& cluster) const {
    if (coincide(taylor_start(sum_, cluster.log_s, cluster.multiplicity))) {
      cluster.spread = 0;
      return;
    }
    std::vector<Complex> members =
        polynomial_roots(taylor_start(sum_, cluster.log_s, cluster.multiplicity + 1).coefficient);
    double spread = 0;
    for (Complex& member : members) {
      const std::optional<Complex> root = polished(cluster.log_s + member);
      if (root && std::abs(*root - cluster.log_s - member) < 0.1 * std::abs(member)) member = *root - cluster.log_s;
      spread = std::max(spread, std::abs(member));
    }
    // The spread is NaN where the iteration failed.  The members that the search found are kept then.
    if (!(spread <= 4 * cluster.spread)) return;
    cluster.spread = spread;
    cluster.members.clear();
    for (const Complex member : members) cluster.members.push_back({member, 1});
  }

  // Terms evaluated in one search: some three seconds.
  static constexpr std::size_t most_work = 40'000'000;

  const std::vector<PowerTerm>& sum_;
  std::vector<double> log_size_;  // of its coefficients
  bool is_polynomial_;
  std::vector<Found> found_;
  bool complete_ = true;
  mutable std::size_t work_ = 0;
};

// ln|s| beyond which one term outweighs together all others that can point against it within the largest argument:
// those of the other sign, and those of orders that turn them by more than a right angle.  Infinite if there are none.
double dominance(const std::vector<PowerTerm>& sum, const PowerTerm& term, double sign, double largest_argument) {
  double bound = -sign * std::numeric_limits<double>::infinity();
  const auto others = static_cast<double>(sum.size());
  for (const PowerTerm& other : sum) {
    if (other.order == term.order) continue;
    const double turn = std::abs(other.order - term.order) * largest_argument;
    if ((other.coefficient > 0) == (term.coefficient > 0) && turn < std::numbers::pi / 2) continue;
    const double at = (std::log(others) + log_ratio(other.coefficient, term.coefficient)) / (term.order - other.order);
    bound = sign > 0 ? std::max(bound, at) : std::min(bound, at);
  }
  return bound;
}

std::vector<RootCluster> clustered(std::vector<Found> roots) {
  std::vector<RootCluster> clusters;
  while (!roots.empty()) {
    std::vector<Found> members{roots.back()};
    roots.pop_back();
    for (std::size_t i = 0; i < members.size(); ++i) {
      for (std::size_t j = roots.size(); j-- > 0;) {
        if (std::abs(roots[j].log_s - members[i].log_s) > one_cluster + roots[j].radius + members[i].radius) continue;
        members.push_back(roots[j]);
        roots.erase(roots.begin() + static_cast<std::ptrdiff_t>(j));
      }
    }
    RootCluster cluster{0, 0, 0, false, false, {}};
    double nearest = std::numeric_limits<double>::infinity();
    for (const Found& member : members) {
      cluster.multiplicity += member.multiplicity;
      cluster.log_s += static_cast<double>(member.multiplicity) * member.log_s;
      nearest = std::min(nearest, std::abs(member.log_s.imag()) - member.radius);
    }
    cluster.log_s /= cluster.multiplicity;
    // A pair this close to the axis is one cluster with its conjugates; a single root there is real.
    cluster.is_conjugate = nearest < one_cluster / 2;
    if (cluster.is_conjugate) cluster.log_s = cluster.log_s.real();
    for (const Found& member : members) {
      cluster.spread = std::max(cluster.spread, std::abs(member.log_s - cluster.log_s) + member.radius);
    }
    if (cluster.multiplicity == 1) cluster.spread = 0;
    if (cluster.is_conjugate || cluster.log_s.imag() > 0) clusters.push_back(cluster);
  }
  std::sort(clusters.begin(), clusters.end(), by_argument);
  return clusters;
}

}  // namespace

PowerSumRoots power_sum_roots(const std::vector<PowerTerm>& sum, double largest_argument) {
  PowerSumRoots result;
  if (sum.size() < 2) return result;
  std::vector<PowerTerm> reduced = sum;
  const double lowest = sum.back().order;
  for (PowerTerm& term : reduced) term.order -= lowest;
  if (reduced.front().order > largest_order) {
    result.complete = false;
    result.trouble = "orders that lie more than 2000 apart have roots too close together to tell them apart";
    return result;
  }
  Search search(reduced);
  const auto conclude = [&](bool cut_off) {
    result.clusters = clustered(search.found());
    for (RootCluster& cluster : result.clusters) search.polish(cluster);
    std::erase_if(result.clusters,
                  [&](const RootCluster& cluster) { return cluster.log_s.imag() > largest_argument + 1e-9; });
    result.complete = search.complete() && !search.gave_up() && !cut_off;
    if (search.gave_up()) {
      result.trouble = "their search was given up at its limit of 40 million terms evaluated";
    } else if (cut_off) {
      result.trouble = "two orders are so nearly equal that roots may lie beyond e^20000 rad/s";
    } else if (!search.complete()) {
      result.trouble = "some lie too close together for the precision of the coefficients";
    }
    return result;
  };
  // Below e^-800 |s| is 0 to a double, and beyond e^20000 the edges of the box would be too long to follow.
  constexpr double nearest = -800, farthest = 20'000;
  const Box half_plane{nearest, farthest, -one_cluster, largest_argument + one_cluster};
  if (search.find_of_power(half_plane) || search.find_of_polynomial(half_plane)) return conclude(false);
  // Edges that meet a root are moved a little.
  for (int attempt = 0; attempt < 8; ++attempt) {
    const double shift = 0.0137 * (attempt + 1);
    const double top = largest_argument + shift;
    Box box{dominance(reduced, reduced.back(), -1, top) - 1 - shift,
            dominance(reduced, reduced.front(), 1, top) + 1 + shift, -shift, top};
    if (!(box.left < box.right)) return result;  // no two terms cancel
    // Nearly equal orders move roots out of any range.
    box.left = std::max(box.left, nearest - shift);
    const bool cut_off = box.right > farthest + shift;
    box.right = std::max(std::min(box.right, farthest + shift), box.left + 1);
    const double count = search.count(box);
    if (!(std::abs(count - std::round(count)) < 0.01)) continue;
    const int expected = static_cast<int>(std::lround(count));
    if (!search.find_from_balances(box, expected)) search.divide(box, expected, 200);
    return conclude(cut_off);
  }
  result.complete = false;
  result.trouble = search.gave_up() ? "their search was given up at its limit of 40 million terms evaluated"
                                    : "rounding of the coefficients hides how many there are";
  return result;
}

}  // namespace frac::detail
