#include "power_sum_roots.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>

#include "winding_number.hpp"

namespace frac::detail {
namespace {

using Complex = std::complex<double>;

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

class Search {
 public:
  explicit Search(const std::vector<PowerTerm>& sum) : sum_(sum) {}

  // NaN where an edge meets a root.
  [[nodiscard]] double count(const Box& box) const {
    return winding_number(
        [this](Complex zeta) {
          const ScaledSum f = scaled_sum(sum_, zeta);
          return ValueAndSlope{f.value, f.slope};
        },
        {{box.left, box.bottom}, {box.right, box.bottom}, {box.right, box.top}, {box.left, box.top}});
  }

  void divide(const Box& box, int expected, int depth) {
    if (expected == 0) return;
    if (expected == 1) {
      const std::optional<Complex> root = polished(sum_, box.centre());
      if (root && box.contains(*root)) {
        found_.push_back({*root, 1, 0});
        return;
      }
    }
    // A double root is only known to the square root of the rounding, a triple one to the third.
    if (box.size() < 1e-4 || depth == 0) {
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

  [[nodiscard]] const std::vector<Found>& found() const { return found_; }
  [[nodiscard]] bool complete() const { return complete_; }

  // The middle of roots that lie close together is nearly a simple root of a derivative, and known to rounding where
  // they coincide.
  void polish(RootCluster& cluster) const {
    if (cluster.multiplicity == 1) return;
    std::vector<PowerTerm> derivative = sum_;
    for (PowerTerm& term : derivative) term.coefficient *= std::pow(term.order, cluster.multiplicity - 1);
    std::erase_if(derivative, [](const PowerTerm& term) { return term.coefficient == 0; });
    const std::optional<Complex> root = polished(derivative, cluster.log_s);
    if (root && std::abs(*root - cluster.log_s) < 2 * cluster.spread) cluster.log_s = *root;
  }

 private:
  // Empty where Newton's method has not converged.
  [[nodiscard]] static std::optional<Complex> polished(const std::vector<PowerTerm>& sum, Complex zeta) {
    for (int i = 0; i < 60; ++i) {
      const ScaledSum f = scaled_sum(sum, zeta);
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

  const std::vector<PowerTerm>& sum_;
  std::vector<Found> found_;
  bool complete_ = true;
};

// ln|s| beyond which one term outweighs all others together.
double dominance(const std::vector<PowerTerm>& sum, const PowerTerm& term, double sign) {
  double bound = -sign * std::numeric_limits<double>::infinity();
  const auto others = static_cast<double>(sum.size());
  for (const PowerTerm& other : sum) {
    if (other.order == term.order) continue;
    const double at = std::log(others * std::abs(other.coefficient / term.coefficient)) / (term.order - other.order);
    bound = sign > 0 ? std::max(bound, at) : std::min(bound, at);
  }
  return bound;
}

std::vector<RootCluster> clustered(std::vector<Found> roots) {
  constexpr double gap = 1e-3;
  std::vector<RootCluster> clusters;
  while (!roots.empty()) {
    std::vector<Found> members{roots.back()};
    roots.pop_back();
    for (std::size_t i = 0; i < members.size(); ++i) {
      for (std::size_t j = roots.size(); j-- > 0;) {
        if (std::abs(roots[j].log_s - members[i].log_s) > gap + roots[j].radius + members[i].radius) continue;
        members.push_back(roots[j]);
        roots.erase(roots.begin() + static_cast<std::ptrdiff_t>(j));
      }
    }
    RootCluster cluster{0, 0, 0, false};
    double nearest = std::numeric_limits<double>::infinity();
    for (const Found& member : members) {
      cluster.multiplicity += member.multiplicity;
      cluster.log_s += static_cast<double>(member.multiplicity) * member.log_s;
      nearest = std::min(nearest, std::abs(member.log_s.imag()) - member.radius);
    }
    cluster.log_s /= cluster.multiplicity;
    // A pair this close to the axis is one cluster with its conjugates; a single root there is real.
    cluster.is_conjugate = nearest < gap / 2;
    if (cluster.is_conjugate) cluster.log_s = cluster.log_s.real();
    for (const Found& member : members) {
      cluster.spread = std::max(cluster.spread, std::abs(member.log_s - cluster.log_s) + member.radius);
    }
    if (cluster.multiplicity == 1) cluster.spread = 0;
    if (cluster.is_conjugate || cluster.log_s.imag() > 0) clusters.push_back(cluster);
  }
  std::sort(clusters.begin(), clusters.end(), [](const RootCluster& a, const RootCluster& b) {
    return a.log_s.imag() != b.log_s.imag() ? a.log_s.imag() < b.log_s.imag() : a.log_s.real() < b.log_s.real();
  });
  return clusters;
}

}  // namespace

ScaledSum scaled_sum(const std::vector<PowerTerm>& terms, Complex zeta) {
  double scale = -std::numeric_limits<double>::infinity();
  for (const PowerTerm& term : terms) {
    scale = std::max(scale, std::log(std::abs(term.coefficient)) + term.order * zeta.real());
  }
  ScaledSum sum{0, 0, scale, 0};
  for (const PowerTerm& term : terms) {
    const double modulus = std::abs(term.coefficient) * std::exp(term.order * zeta.real() - scale);
    const double signed_modulus = term.coefficient < 0 ? -modulus : modulus;
    const double angle = term.order * zeta.imag();
    const Complex value = angle == 0 ? Complex(signed_modulus)
                                     : Complex(signed_modulus * std::cos(angle), signed_modulus * std::sin(angle));
    sum.value += value;
    sum.slope += term.order * value;
    sum.magnitude += modulus;
  }
  return sum;
}

PowerSumRoots power_sum_roots(const std::vector<PowerTerm>& sum, double largest_argument) {
  PowerSumRoots result;
  if (sum.size() < 2) return result;
  std::vector<PowerTerm> reduced = sum;
  const double lowest = sum.back().order;
  for (PowerTerm& term : reduced) term.order -= lowest;
  Search search(reduced);
  // Edges that meet a root are moved a little.
  for (int attempt = 0; attempt < 8; ++attempt) {
    const double shift = 0.0137 * (attempt + 1);
    const Box box{dominance(reduced, reduced.back(), -1) - 1 - shift,
                  dominance(reduced, reduced.front(), 1) + 1 + shift, -shift, largest_argument + shift};
    const double count = search.count(box);
    if (!(std::abs(count - std::round(count)) < 0.01)) continue;
    search.divide(box, static_cast<int>(std::lround(count)), 200);
    result.clusters = clustered(search.found());
    for (RootCluster& cluster : result.clusters) search.polish(cluster);
    std::erase_if(result.clusters,
                  [&](const RootCluster& cluster) { return cluster.log_s.imag() > largest_argument + 1e-9; });
    result.complete = search.complete();
    return result;
  }
  result.complete = false;
  return result;
}

}  // namespace frac::detail
