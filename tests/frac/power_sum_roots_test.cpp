// SPDX-License-Identifier: BSD-3-Clause
#include "poles/power_sum_roots.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "formula/power_sum.hpp"
#include "poles/scaled_sum.hpp"
#include "support/random.hpp"
#include "support/step_systems.hpp"

namespace {

using Complex = std::complex<double>;
using frac::PowerTerm;
using frac::detail::RootCluster;
constexpr double pi = std::numbers::pi;

int count(const frac::detail::PowerSumRoots& roots, double largest_argument) {
  int total = 0;
  for (const RootCluster& root : roots.clusters) {
    if (root.log_s.imag() <= largest_argument) total += root.multiplicity * (root.is_conjugate ? 1 : 2);
  }
  return total;
}

}  // namespace

TEST(PowerSumRoots, AreThoseOfTheTable) {
  for (const auto& [name, system] : support::step_systems()) {
    const auto roots = frac::detail::power_sum_roots(system.model.denominator(), pi - 1e-6);
    EXPECT_TRUE(roots.complete) << name;
    std::size_t listed = 0;
    for (std::size_t at = system.poles.find('('); at != std::string::npos; at = system.poles.find('(', at + 1)) {
      ++listed;
      std::size_t used = 0;
      const double re = std::stod(system.poles.substr(at + 1), &used);
      const Complex pole(re, std::stod(system.poles.substr(at + 1 + used + 3)));
      double nearest = 1;
      for (const RootCluster& root : roots.clusters) {
        nearest = std::min(nearest, std::abs(std::exp(root.log_s) / pole - 1.0));
      }
      // 17 digits in the table, a few roundings of ln s.
      EXPECT_LE(nearest, 1e-14) << name << pole;
    }
    EXPECT_EQ(roots.clusters.size(), listed) << name;
  }
}

// prod (s^q - c_k) with c_k in conjugate pairs: every root is c_k^(1/q) on its sheet.
TEST(PowerSumRoots, OfCommensurateOrdersAreThePowersOfPolynomialRoots) {
  support::Random random(1);
  for (int trial = 0; trial < 60; ++trial) {
    const double q = trial % 3 == 0 ? 1 : random.uniform(0.2, 1.5);
    std::vector<PowerTerm> sum{{1, 0}};
    std::vector<Complex> expected;
    const std::size_t pairs = 1 + random.below(4);
    for (std::size_t k = 0; k < pairs; ++k) {
      const double radius = random.log_uniform(0.1, 10);
      const double angle = random.uniform(0.05, pi - 0.05);
      sum = frac::detail::product(sum, {{1, 2 * q}, {-2 * radius * std::cos(angle), q}, {radius * radius, 0}});
      for (int sheet = -8; sheet <= 8; ++sheet) {
        for (const double sign : {1.0, -1.0}) {
          const double argument = (sign * angle + 2 * pi * sheet) / q;
          if (argument > 0 && argument < 1.4 * pi) expected.emplace_back(std::log(radius) / q, argument);
        }
      }
    }
    const auto roots = frac::detail::power_sum_roots(sum, 1.4 * pi);
    EXPECT_TRUE(roots.complete);
    std::size_t found = 0;
    for (const RootCluster& root : roots.clusters) found += static_cast<std::size_t>(root.multiplicity);
    EXPECT_EQ(found, expected.size()) << trial;
    for (const Complex log_s : expected) {
      double nearest = 1;
      for (const RootCluster& root : roots.clusters) nearest = std::min(nearest, std::abs(root.log_s - log_s));
      // Eight factors with roots at least some 1e-2 apart condition the coefficients by 1e4 or so.
      EXPECT_LE(nearest, 1e-8) << trial;
    }
  }
}

TEST(PowerSumRoots, MultipleRootsAreClusters) {
  const auto expect_one_cluster = [](const std::vector<PowerTerm>& sum, Complex log_s, int multiplicity,
                                     bool conjugate) {
    const auto roots = frac::detail::power_sum_roots(sum, pi + 0.1);
    EXPECT_TRUE(roots.complete);
    ASSERT_EQ(roots.clusters.size(), 1u);
    EXPECT_EQ(roots.clusters[0].multiplicity, multiplicity);
    EXPECT_EQ(roots.clusters[0].is_conjugate, conjugate);
    EXPECT_LE(std::abs(roots.clusters[0].log_s - log_s), roots.clusters[0].spread + 1e-9);
  };
  expect_one_cluster({{1, 2}, {2, 1}, {1, 0}}, {0, pi}, 2, false);
  expect_one_cluster({{1, 3}, {3, 2}, {3, 1}, {1, 0}}, {0, pi}, 3, false);
  expect_one_cluster({{1, 1}, {-2, 0.5}, {1, 0}}, 0, 2, true);
  expect_one_cluster({{1, 4}, {2, 2}, {1, 0}}, {0, pi / 2}, 2, false);
  expect_one_cluster({{1, 1}, {-2, 0.5}, {1 + 1e-9, 0}}, 0, 2, true);
  // (a s + b)^n with coefficients that are rounded, from the left and the right half plane.
  for (const auto& [a, b] : {std::pair(0.37, 1.9), std::pair(2.3e-5, 7.1), std::pair(-41.3, 0.6)}) {
    for (int n = 2; n <= 7; ++n) {
      std::vector<PowerTerm> sum;
      double coefficient = std::pow(a, n);
      for (int k = n; k >= 0; --k) {
        sum.push_back({coefficient, static_cast<double>(k)});
        coefficient *= k * b / (a * (n - k + 1));
      }
      expect_one_cluster(sum, {std::log(std::abs(b / a)), a > 0 ? pi : 0}, n, a < 0);
    }
  }
}

// Two poles 0.3 to 4 % apart beside a pair: Newton's method from where two terms balance finds one of the two only.
TEST(PowerSumRoots, NeighboursAreFoundEach) {
  support::Random random(8);
  for (int trial = 0; trial < 40; ++trial) {
    const double near = random.log_uniform(0.3, 3), far = near * (1 + random.uniform(0.003, 0.04));
    const double omega = random.log_uniform(0.1, 10), damping = random.uniform(0.02, 0.8);
    const double b = near + far, c = near * far, d = 2 * damping * omega, e = omega * omega;
    const std::vector<PowerTerm> sum = {{1, 4}, {b + d, 3}, {c + b * d + e, 2}, {c * d + b * e, 1}, {c * e, 0}};
    const auto roots = frac::detail::power_sum_roots(sum, pi);
    EXPECT_TRUE(roots.complete);
    ASSERT_EQ(roots.clusters.size(), 3U);
    for (const Complex pole : {Complex(-near), Complex(-far), omega * std::polar(1.0, std::acos(-damping))}) {
      double nearest = 1;
      for (const RootCluster& root : roots.clusters) {
        nearest = std::min(nearest, std::abs(std::exp(root.log_s) / pole - 1.0));
      }
      // The rounding of the coefficients over the distance of the neighbour, with the pair at a small distance beside.
      EXPECT_LE(nearest, 1e-9) << trial;
    }
  }
}

TEST(PowerSumRoots, RealAndWidelySpreadRoots) {
  const auto roots =
      frac::detail::power_sum_roots(frac::detail::product({{1, 0.5}, {-1e-8, 0}}, {{1, 0.7}, {-1e9, 0}}), pi);
  EXPECT_TRUE(roots.complete);
  EXPECT_EQ(count(roots, pi), 2);
  for (const RootCluster& root : roots.clusters) EXPECT_TRUE(root.is_conjugate);
  EXPECT_TRUE(frac::detail::power_sum_roots({{3, 0.4}}, pi).clusters.empty());
}

// Terms of nearly equal orders outweigh each other only at e^-1e12 and e^1e4, where nothing is to be looked for: terms
// of one sign that turn by less than a right angle from each other cannot cancel.
TEST(PowerSumRoots, NearlyEqualOrdersAreNotFollowedForEver) {
  const auto none = frac::detail::power_sum_roots({{1, 2.4e-12}, {0.138, 0}}, 1.5 * pi);
  EXPECT_TRUE(none.complete);
  EXPECT_TRUE(none.clusters.empty());
  const std::vector<PowerTerm> sum{{1, 1.0001}, {2, 1}, {3, 0}};
  const auto roots = frac::detail::power_sum_roots(sum, 1.5 * pi);
  EXPECT_TRUE(roots.complete);
  ASSERT_EQ(roots.clusters.size(), 1u);
  // 3 s + 3 = 0 but for 0.0001 pi.
  EXPECT_LE(std::abs(roots.clusters[0].log_s - Complex(0, pi)), 1e-3);
  const auto value = frac::detail::scaled_sum(sum, roots.clusters[0].log_s);
  EXPECT_LE(std::abs(value.value), 1e-14);
}
