// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <complex>
#include <vector>

#include "frac/structure.hpp"
#include "support/count_allocations.hpp"

namespace {

// A solver evaluates a structure some 10^5 times a second; the second call of a kind finds its working memory in place.
TEST(Structure, AllocatesNothingOnRepeatedEvaluation) {
  const frac::Structure structure("K exp(-L s)/(T s^a + 1) + R tanh((tau s)^0.5) + (1 + s^a)^b");
  std::vector<double> parameters{1, 0.2, 0.3, 0.8, 2, 0.5, 0.7};
  std::vector<double> omega(100, 1.5);
  std::vector<std::complex<double>> value(omega.size());
  std::vector<std::complex<double>> gradient(omega.size() * parameters.size());
  structure.response_and_gradient(parameters, omega, frac::ExactRealisation{}, value, gradient);
  const long before = support::allocations;
  for (int i = 0; i < 10; ++i) {
    parameters[3] += 0.01;
    structure.response_and_gradient(parameters, omega, frac::ExactRealisation{}, value, gradient);
    (void)structure.response(parameters, 2.5);
  }
  EXPECT_EQ(support::allocations - before, 0);
}

}  // namespace
