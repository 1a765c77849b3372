// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <complex>
#include <cstddef>
#include <limits>
#include <numbers>
#include <utility>
#include <vector>

#include "power_sum_roots.hpp"

namespace frac::detail {
namespace {

using Complex = std::complex<double>;

// A cluster of one factor, as often as the factor's power says.
struct Given {
  RootCluster cluster;
  int power;
};

RootCluster combined(const std::vector<Given>& group) {
  if (group.size() == 1 && group[0].cluster.multiplicity == 1) {
    RootCluster result = group[0].cluster;
    result.multiplicity = group[0].power;
    result.is_exact = true;
    return result;
  }
  RootCluster result{0, 0, 0, false, group.size() == 1 && group[0].cluster.is_exact, {}};
  for (const auto& [cluster, power] : group) result.is_conjugate = result.is_conjugate || cluster.is_conjugate;
  std::vector<ClusterMember> members;  // at first by their places in the plane of ln s
  for (const auto& [cluster, power] : group) {
    const auto add = [&, times = power, with_conjugate = result.is_conjugate && !cluster.is_conjugate](
                         Complex at, int multiplicity) {
      members.push_back({at, multiplicity * times});
      if (with_conjugate) members.push_back({std::conj(at), multiplicity * times});
    };
    if (cluster.members.empty()) add(cluster.log_s, cluster.multiplicity);
    for (const ClusterMember& member : cluster.members) add(cluster.log_s + member.offset, member.multiplicity);
  }
  for (const ClusterMember& member : members) {
    result.multiplicity += member.multiplicity;
    result.log_s += static_cast<double>(member.multiplicity) * member.offset;
  }
  result.log_s /= result.multiplicity;
  if (result.is_conjugate) result.log_s = result.log_s.real();
  for (ClusterMember& member : members) {
    member.offset -= result.log_s;
    result.spread = std::max(result.spread, std::abs(member.offset));
  }
  // Roots of different factors that differ by rounding alone are one.
  constexpr double rounding = 64 * std::numeric_limits<double>::epsilon();
  if (result.spread <= rounding * (1 + std::abs(result.log_s))) {
    result.spread = 0;
  } else {
    result.members = std::move(members);
  }
  return result;
}

// ln of the size of the partial fractions at cluster k over that of their sum.
double amplification(const std::vector<RootCluster>& clusters, std::size_t k, std::size_t& nearest) {
  double sum = 0;
  double closest = std::numeric_limits<double>::infinity();
  for (std::size_t j = 0; j < clusters.size(); ++j) {
    if (j == k) continue;
    const double distance = std::max(std::abs(clusters[j].log_s - clusters[k].log_s) - clusters[j].spread, 1e-300);
    sum -= clusters[j].multiplicity * std::min(0.0, std::log(distance));
    if (distance < closest) {
      closest = distance;
      nearest = j;
    }
  }
  return sum - clusters[k].multiplicity * std::min(0.0, std::log(0.5 * closest));
}

int side_of_negative_axis(const RootCluster& cluster) {
  const double beyond = cluster.log_s.imag() - std::numbers::pi;
  return std::abs(beyond) < 1e-9 ? 0 : beyond > 0 ? 1 : -1;
}

}  // namespace

PowerSumRoots power_sum_roots(const PowerProduct& product, double largest_argument, double together) {
  if (!product.is_factored()) return power_sum_roots(product.terms, largest_argument);
  PowerSumRoots result;
  std::vector<Given> all;
  for (const PowerFactor& factor : product.factors) {
    const PowerSumRoots roots = power_sum_roots(factor.sum, largest_argument);
    result.complete = result.complete && roots.complete;
    if (!roots.complete) result.trouble = roots.trouble;
    for (const RootCluster& cluster : roots.clusters) all.push_back({cluster, factor.power});
  }
  while (!all.empty()) {
    std::vector<Given> group{all.front()};
    all.erase(all.begin());
    for (std::size_t i = 0; i < group.size(); ++i) {
      for (std::size_t j = all.size(); j-- > 0;) {
        const double reach = together + all[j].cluster.spread + group[i].cluster.spread;
        if (!(std::abs(all[j].cluster.log_s - group[i].cluster.log_s) < reach)) continue;
        group.push_back(all[j]);
        all.erase(all.begin() + static_cast<std::ptrdiff_t>(j));
      }
    }
    result.clusters.push_back(combined(group));
  }
  std::sort(result.clusters.begin(), result.clusters.end(), by_argument);
  return result;
}

std::vector<RootCluster> without_crowds(std::vector<RootCluster> clusters) {
  constexpr double most_amplification = 11.5;  // 1e5
  constexpr double widest = 0.5;
  constexpr std::size_t most_clusters = 64;  // the work grows as the cube
  while (clusters.size() <= most_clusters) {
    double worst = most_amplification;
    std::size_t first = 0;
    std::size_t second = 0;
    RootCluster best;
    for (std::size_t k = 0; k < clusters.size(); ++k) {
      std::size_t nearest = k;
      const double size = amplification(clusters, k, nearest);
      if (!(size > worst) || side_of_negative_axis(clusters[k]) != side_of_negative_axis(clusters[nearest])) continue;
      RootCluster both = combined({{clusters[k], 1}, {clusters[nearest], 1}});
      if (both.spread > widest) continue;
      worst = size;
      first = std::min(k, nearest);
      second = std::max(k, nearest);
      best = std::move(both);
    }
    if (first == second) break;
    clusters[first] = std::move(best);
    clusters.erase(clusters.begin() + static_cast<std::ptrdiff_t>(second));
  }
  std::sort(clusters.begin(), clusters.end(), by_argument);
  return clusters;
}

}  // namespace frac::detail
