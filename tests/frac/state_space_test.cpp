// SPDX-License-Identifier: BSD-3-Clause
#include "frac/state_space.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "frac/stability.hpp"
#include "support/expect_invalid_argument.hpp"
#include "support/relative_error.hpp"

namespace {

using frac::FractionalTransferFunction;
using frac::RationalModel;
using frac::RealisationMethod;
using support::expect_invalid_argument;
using support::log_grid;
using support::relative_error;
using Complex = std::complex<double>;

constexpr frac::FrequencyBand band{1e-2, 1e2};

const std::vector<std::string> models{"1/(0.8 s^2.2 + 0.5 s^0.9 + 1)",
                                      "exp(-0.3 s)/(s^0.5 + 1)",
                                      "(s^0.3 + 2)/(s^1.5 + 2 s^0.5 + 1)",
                                      "s^0.5",
                                      "(2 s^0.4 + 1)/(s^1.7 + 0.6 s^0.8 + 0.1)",
                                      "s^1.3/(s^0.9 + 1)",
                                      "1/(s^0.99 + 1)",
                                      "1/(s^1.98 + 0.02 s^0.7 + 1)"};

// The largest error on a grid of its own, against the model itself; the stated one is refined about its largest value
// on a grid at least as dense, so that nothing is found beyond it but a thousandth of it and rounding.
class RealisedModel : public testing::TestWithParam<RealisationMethod> {};

TEST_P(RealisedModel, StatesAnErrorThatHolds) {
  for (const std::string& formula : models) {
    const auto model = FractionalTransferFunction::parse(formula);
    const FractionalTransferFunction without_delay(model.numerator(), model.denominator());
    for (const double tolerance : {1e-2, 1e-5}) {
      const RationalModel result = frac::realise(model, band, tolerance, GetParam());
      EXPECT_EQ(result.status, frac::RationalModelStatus::met) << formula << ": " << result.message;
      EXPECT_LE(result.max_relative_error, tolerance);
      EXPECT_EQ(result.delay, model.delay());
      EXPECT_TRUE(result.stable) << formula;
      double largest = 0;
      for (const double omega : log_grid(band.lower, band.upper, 4001)) {
        largest = std::max(largest, relative_error(result.response(omega), without_delay.response(omega)));
      }
      EXPECT_LE(largest, 1.001 * result.max_relative_error + 1e-12) << formula;
      EXPECT_GE(largest, 0.98 * result.max_relative_error) << formula;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Methods, RealisedModel,
                         testing::Values(RealisationMethod::joint, RealisationMethod::term_by_term));

TEST(StateSpace, OneSetOfPolesTakesNoMoreStatesThanTermsOfTheirOwn) {
  std::size_t joint_states = 0;
  std::size_t separate_states = 0;
  for (const std::string& formula : models) {
    for (const double tolerance : {1e-2, 1e-5}) {
      const auto model = FractionalTransferFunction::parse(formula);
      const RationalModel joint = frac::realise(model, band, tolerance);
      const RationalModel separate = frac::realise(model, band, tolerance, RealisationMethod::term_by_term);
      EXPECT_LE(joint.states, separate.states) << formula;
      joint_states += joint.states;
      separate_states += separate.states;
    }
  }
  EXPECT_LT(static_cast<double>(joint_states), 0.7 * static_cast<double>(separate_states));
}

// The limit of rational approximation of s^a, which the ladder meets: fewer poles than one below it would be a wonder.
TEST(StateSpace, APowerTakesAsManyStatesAsItsLadder) {
  const auto model = FractionalTransferFunction::parse("s^0.5");
  for (const double tolerance : {1e-3, 1e-6}) {
    const RationalModel separate = frac::realise(model, band, tolerance, RealisationMethod::term_by_term);
    const RationalModel joint = frac::realise(model, band, tolerance);
    EXPECT_NEAR(static_cast<double>(joint.states), static_cast<double>(separate.states), 1);
  }
}

TEST(StateSpace, ModalFormHasTheSameResponse) {
  for (const std::string formula : {"1/(0.8 s^2.2 + 0.5 s^0.9 + 1)", "(s^0.3 + 2)/(s^1.5 + 2 s^0.5 + 1)", "1/(s + 1)^2",
                                    "1/(s^2 + 0.2 s + 1)^2", "1/s^1.2", "1/s^2.3"}) {
    const RationalModel result = frac::realise(FractionalTransferFunction::parse(formula), band, 1e-4);
    const frac::StateSpace form = frac::modal_form(result);
    ASSERT_EQ(form.states, result.states);
    // Blocks on the diagonal, and chains one block below it.
    for (std::size_t i = 0; i < form.states; ++i) {
      for (std::size_t j = 0; j < form.states; ++j) {
        if (j > i + 1 || i > j + 2) {
          EXPECT_EQ(form.a[i * form.states + j], 0);
        }
      }
    }
    for (const double omega : log_grid(1e-2, 1e2, 41)) {
      // Of terms that cancel at high frequency the rounding of the largest remains.
      double sum = std::abs(result.direct);
      for (const frac::Mode& mode : result.modes) {
        Complex power = 1;
        for (const Complex residue : mode.residues) {
          power /= Complex(0, omega) - mode.pole;
          sum += 2 * std::abs(residue * power);
        }
      }
      EXPECT_LT(std::abs(form.response(omega) - result.response(omega)), 1e-13 * sum) << formula << " " << omega;
    }
  }
}

TEST(StateSpace, BalancedFormHasEqualDiagonalGramians) {
  for (const std::string formula : {"1/(0.8 s^2.2 + 0.5 s^0.9 + 1)", "1/(s + 1)^2", "(s^0.3 + 2)/(s^1.5 + 2 s^0.5 + 1)",
                                    "1/((s + 1)^2 (s + 1.01)^2 (s + 3)^2)", "1/((s^2 + 0.4 s + 1)^2 (s^0.7 + 2)^3)"}) {
    const RationalModel result = frac::realise(FractionalTransferFunction::parse(formula), band, 1e-3);
    const frac::BalancedForm balanced = frac::balanced_form(result);
    const frac::StateSpace& form = balanced.system;
    const std::vector<double>& sigma = balanced.hankel_singular_values;
    ASSERT_EQ(form.states, result.states);
    EXPECT_TRUE(std::is_sorted(sigma.rbegin(), sigma.rend()));
    // A S + S A^T + B B^T = 0 and A^T S + S A + C^T C = 0 up to the rounding of each entry to double.
    for (std::size_t i = 0; i < form.states; ++i) {
      for (std::size_t j = 0; j < form.states; ++j) {
        const double ij = form.a[i * form.states + j];
        const double ji = form.a[j * form.states + i];
        const double size = std::abs(ij * sigma[j]) + std::abs(sigma[i] * ji) + std::abs(form.b[i] * form.b[j]);
        EXPECT_NEAR(ij * sigma[j] + sigma[i] * ji + form.b[i] * form.b[j], 0, 1e-14 * size) << formula;
        const double other = std::abs(ji * sigma[j]) + std::abs(sigma[i] * ij) + std::abs(form.c[i] * form.c[j]);
        EXPECT_NEAR(ji * sigma[j] + sigma[i] * ij + form.c[i] * form.c[j], 0, 1e-14 * other) << formula;
      }
    }
    // States as large as the response at low frequency cancel down to it at high frequency.
    const double fall = std::abs(result.response(band.lower) / result.response(band.upper));
    EXPECT_LE(balanced.max_relative_error, 1.01 * result.max_relative_error + 1e-10 + 1e-14 * fall) << formula;
  }
}

TEST(StateSpace, PolesOfTheModelAreKept) {
  const auto furnace = FractionalTransferFunction::parse("1/(0.8 s^2.2 + 0.5 s^0.9 + 1)");
  const RationalModel result = frac::realise(furnace, band, 1e-3);
  const Complex pole(-0.10841680291289, 1.19699224474627);
  const auto is_pole = [&](const frac::Mode& mode) { return std::abs(mode.pole - pole) < 1e-13; };
  EXPECT_EQ(std::count_if(result.modes.begin(), result.modes.end(), is_pole), 1);
  // exp(0.1 t) grows, so does its stand-in.
  const RationalModel unstable =
      frac::realise(FractionalTransferFunction::parse("1/((s - 0.1) (s^0.5 + 2))"), band, 1e-3);
  EXPECT_FALSE(unstable.stable);
  EXPECT_EQ(unstable.status, frac::RationalModelStatus::met);
  const RationalModel integrating = frac::realise(FractionalTransferFunction::parse("1/s^1.2"), band, 1e-3);
  EXPECT_EQ(integrating.modes.front().pole, Complex(0));
  EXPECT_THROW((void)frac::balanced_form(integrating), std::domain_error);
}

TEST(StateSpace, ARationalModelIsItself) {
  const auto model = FractionalTransferFunction::parse("(s + 3)/(s^2 + 0.4 s + 2)");
  for (const RealisationMethod method : {RealisationMethod::joint, RealisationMethod::term_by_term}) {
    const RationalModel result = frac::realise(model, band, 1e-9, method);
    EXPECT_EQ(result.states, 2u);
    // Least squares of three unknowns: some roundings, amplified by the 100 by which terms cancel at the upper edge.
    EXPECT_LT(result.max_relative_error, 1e-12);
  }
}

TEST(StateSpace, SaysWhatCannotBeHad) {
  const auto model = FractionalTransferFunction::parse("1/(s^0.5 + 1)");
  // At the upper edge modes of size 1e-3 cancel to 1e-12: some 1e-7 of rounding in double.
  const RationalModel result = frac::realise(
      FractionalTransferFunction({{1, 0}}, {{1, 4}, {0.4, 3}, {2.04, 2}, {0.4, 1}, {1, 0}}), {1e-3, 1e3}, 1e-11);
  EXPECT_EQ(result.status, frac::RationalModelStatus::not_attainable);
  EXPECT_NE(result.message.find("not attainable"), std::string::npos) << result.message;
  EXPECT_LT(result.max_relative_error, 1e-5);
  expect_invalid_argument([&] { (void)frac::realise(model, {1, 1}, 1e-3); }, {"band = 1 to 1 rad/s"});
  expect_invalid_argument([&] { (void)frac::realise(model, band, 0); }, {"tolerance = 0"});
  expect_invalid_argument([&] { (void)frac::realise(FractionalTransferFunction::parse("s^1.5"), band, 0.1); },
                          {"grows as s^1.5"});
  expect_invalid_argument([] { (void)frac::realisation_method_from_string("best"); },
                          {"\"best\"", "joint, term-by-term"});
  EXPECT_THROW((void)frac::realise(FractionalTransferFunction::parse("1/(s^2 + 1)"), {1, 2}, 0.1), std::domain_error);
}

}  // namespace
