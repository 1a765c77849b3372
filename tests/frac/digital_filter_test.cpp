// SPDX-License-Identifier: BSD-3-Clause
#include "frac/digital/digital_filter.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "frac/time_response/respond.hpp"
#include "support/expect_invalid_argument.hpp"
#include "support/filter_in_quadruple.hpp"
#include "support/random.hpp"

namespace {

using frac::DigitalFilter;
using frac::FractionalTransferFunction;
using support::Quad;
using support::worst_difference;
using support::worst_share;

std::vector<double> noise(std::size_t count, unsigned seed) {
  support::Random random(seed);
  std::vector<double> samples;
  for (std::size_t n = 0; n < count; ++n) samples.push_back(random.normal());
  return samples;
}

frac::DigitalFilterDesign parallel_of(const frac::ZeroPoleGain& system, double sample_time) {
  frac::DigitalFilterDesign design;
  design.sample_time = sample_time;
  design.sections = frac::discretise(system, sample_time).parallel;
  return design;
}

std::vector<double> filtered(const frac::DigitalFilterDesign& design, const std::vector<double>& samples) {
  DigitalFilter<double> filter(design);
  std::vector<double> output(samples.size());
  filter.run(samples, output);
  return output;
}

// Each rate, weight and direct term is one rounding of a long double (u = 2^-53), which itself is a product of up to
// 2 x 30 factors of 6 roundings each, 2^-11 u apiece: off by 1.2 u.  What the sections add to that is bounded sample by
// sample.  Most bounds are 1e-15 to 4e-15 of full scale; sections that ring at rates near 2 raise them to 6e-14.
TEST(DigitalFilter, KeepsFullPrecisionAtAnyRatioOfSampleRateToBand) {
  const std::vector<double> samples = noise(10'000, 7);
  const std::vector<double> steps = [] {
    std::vector<double> values(10'000);
    for (std::size_t n = 0; n < values.size(); ++n) values[n] = n < 5000 ? 1 : -0.3;
    return values;
  }();
  for (const double order : {0.5, -0.5, 0.9}) {
    for (const double ratio : {1e3, 1e6, 1e10}) {
      for (const int poles : {9, 30}) {
        const double sample_time = 1e-3;
        const double top = 300;
        const auto system =
            frac::approximate(order, {2 * 3.14159 / sample_time / ratio, top}, frac::PoleCount{poles}).system;
        for (const auto& input : {samples, steps}) {
          const auto design = parallel_of(system, sample_time);
          EXPECT_LT(worst_share(support::filter_in_quadruple(system, sample_time, input), filtered(design, input),
                                support::rounding_bound(design, input, 1.2)),
                    1)
              << order << " " << ratio << " " << poles;
        }
      }
    }
  }
}

// The reference takes the coefficients as they are stored.
TEST(DigitalFilter, DirectDesignsKeepFullPrecisionToo) {
  const std::vector<double> samples = noise(3000, 11);
  for (const double order : {0.1, 0.3, 0.5, 0.7, 0.9, -0.1, -0.5, -0.9}) {
    for (const double share : {0.05, 0.25}) {
      for (const double ratio : {1e3, 1e10}) {
        const double upper = share * 2 * 3.14159 / 1e-3;
        const auto design =
            filter_design(frac::digital_power(order, {upper / ratio, upper}, frac::PoleCount{30}, 1e-3));
        const std::vector<Quad> exact = support::design_in_quadruple(design, samples);
        EXPECT_LT(worst_share(exact, filtered(design, samples), support::rounding_bound(design, samples, 0)), 1)
            << order << " " << share << " " << ratio;
      }
    }
  }
}

TEST(DigitalFilter, CascadeOfDeltaSectionsIsTheSameFilter) {
  const std::vector<double> samples = noise(20'000, 8);
  const auto system = frac::approximate(0.5, {1e-6, 300}, frac::PoleCount{20}).system;
  const auto sections = frac::discretise(system, 1e-3).cascade;
  std::vector<double> signal = samples;
  for (const frac::DeltaSection& section : sections.sections) {
    double v = 0;
    for (double& value : signal) {
      const double x = value;
      value = x + section.feed * v;
      v += x - section.rate * v;
    }
  }
  for (double& value : signal) value *= sections.gain;
  EXPECT_LT(worst_difference(support::filter_in_quadruple(system, 1e-3, samples), signal), 2e-14);
}

TEST(DigitalFilter, SampleBySampleAndInBlocksAreTheSameBits) {
  const std::vector<double> samples = noise(1000, 9);
  for (const double order : {0.4, -0.4, 1.3, -1.6}) {
    const auto design = filter_design(frac::digital_power(order, {0.1, 100}, frac::PoleCount{11}, 1e-3));
    DigitalFilter<double> single(design);
    DigitalFilter<float> narrow(design), narrow_single(design);
    const std::vector<double> blocks = filtered(design, samples);
    const std::vector<float> narrow_samples(samples.begin(), samples.end());
    std::vector<float> narrow_blocks(samples.size());
    narrow.run(narrow_samples, narrow_blocks);
    for (std::size_t n = 0; n < samples.size(); ++n) {
      ASSERT_EQ(single.step(samples[n]), blocks[n]);
      ASSERT_EQ(narrow_single.step(narrow_samples[n]), narrow_blocks[n]);
    }
    single.reset();
    EXPECT_EQ(single.step(samples[0]), blocks[0]);
  }
}

// A constant through s^-0.5 with its slowest pole at 1e-7 per sample: a state that loses what it cannot hold stalls
// short of its end value by eps/rate.
// Powers of two scale every product and sum alike, so that the outputs are the same digits.
TEST(DigitalFilter, ScalesWithSamplesOfAnySize) {
  const auto design = filter_design(frac::digital_power(0.5, {0.1, 1500}, frac::Tolerance{1e-3}, 1e-3));
  std::vector<double> samples = noise(500, 13), large = samples, small = samples;
  for (double& x : large) x = std::ldexp(x, 990);  // some 1e298
  for (double& x : small) x = std::ldexp(x, -850);
  const std::vector<double> output = filtered(design, samples);
  const std::vector<double> of_large = filtered(design, large), of_small = filtered(design, small);
  for (std::size_t n = 0; n < samples.size(); ++n) {
    EXPECT_EQ(of_large[n], std::ldexp(output[n], 990));
    EXPECT_EQ(of_small[n], std::ldexp(output[n], -850));
  }
  // Denormal samples come and go without a trace.
  DigitalFilter<double> filter(design);
  for (int n = 0; n < 100; ++n) EXPECT_LT(std::abs(filter.step(5e-324)), 1e-300);
  EXPECT_EQ(filter.step(0), 0);
}

TEST(DigitalFilter, SlowStatesReachTheirEndValue) {
  frac::DigitalFilterDesign design;
  design.sections = {.output = frac::SectionOutput::state, .direct = 0, .rates = {1e-5}, .weights = {1e-5}};
  DigitalFilter<float> filter(design);
  float y = 0;
  for (int n = 0; n < 3'000'000; ++n) y = filter.step(1);
  // e^-30 from the end; the weight is rounded to 6e-8, and so is the rate.
  EXPECT_NEAR(y, 1, 2e-7);
}

TEST(DigitalFilter, RunsAModelAsRespondDoes) {
  const std::vector<double> samples = noise(3000, 10);
  for (const char* formula :
       {"1/(0.8 s^2.2 + 0.5 s^0.9 + 1)", "1/(s^0.5 + 1)", "(s^0.7 + 2)/(3 s^0.7 + 1)", "1/(s^1.2 + s)", "1/s^1.5",
        "exp(-0.05 s)/(s^0.5 + 1)", "exp(-0.034 s)/(s^0.5 + 1)", "1/(s + 1)"}) {
    const auto model = FractionalTransferFunction::parse(formula);
    const auto expected = frac::respond(model, samples, 0.01, 1e-10);
    const auto output = filtered(filter_design(model, 0.01, 1e-10, 3000), samples);
    double worst = 0, scale = 0;
    for (std::size_t n = 0; n < samples.size(); ++n) {
      worst = std::max(worst, std::abs(expected[n] - output[n]));
      scale = std::max(scale, std::abs(expected[n]));
    }
    // Both keep 1e-10 of the step response for a step; noise changes 3000 times, at random: sqrt(3000) times that.
    EXPECT_LT(worst, 1e-8 * scale) << formula;
  }
}

// A first-order lag under a zero-order hold, in closed form.
TEST(DigitalFilter, ModelFilterIsTheHoldEquivalent) {
  const auto design = filter_design(FractionalTransferFunction::parse("2/(0.5 s + 1)"), 0.1, 1e-12);
  const double keep = std::exp(-0.2);
  for (const double omega : {0.01, 1.0, 20.0}) {
    const auto z = std::polar(1.0, omega * 0.1);
    EXPECT_LT(std::abs(design.response(omega) - 2 * (1 - keep) / (z - keep)), 1e-11);
  }
}

TEST(DigitalFilter, ShortMemoryRunsAsTheSumOfItsWeights) {
  const std::vector<double> samples = noise(300, 12);
  const auto power =
      frac::digital_power(0.6, {10, 100}, frac::PoleCount{1}, 1e-3, frac::Discretisation::grunwald_letnikov,
                          frac::ApproximationMethod::ladder, 50);
  const std::vector<double> output = filtered(filter_design(power), samples);
  for (std::size_t n = 0; n < samples.size(); ++n) {
    double sum = 0, size = 0, weight = std::pow(1e-3, -0.6);
    for (std::size_t k = 0; k <= std::min<std::size_t>(50, n); ++k) {
      sum += weight * samples[n - k];
      size += std::abs(weight * samples[n - k]);
      weight *= (static_cast<double>(k) - 0.6) / static_cast<double>(k + 1);
    }
    EXPECT_NEAR(output[n], sum, 60 * 2.2e-16 * size);
  }
}

// t^1.5/Gamma(2.5) after 10^7 samples of a constant: fifty states and an integrator, none of which may drift.
TEST(DigitalFilter, DoesNotDriftOverTenMillionSamples) {
  constexpr std::size_t part = 10'000;
  DigitalFilter<double> filter(filter_design(FractionalTransferFunction::parse("1/s^1.5"), 1e-3, 1e-12, 1e7));
  const std::vector<double> ones(part, 1.0);
  std::vector<double> output(part);
  for (int i = 1; i <= 1000; ++i) {
    filter.run(ones, output);
    // Output n holds the n samples before it.
    const double time = (static_cast<double>(i) * part - 1) * 1e-3;
    // 1e-12 of the largest value over the horizon, which grows as t^1.5.
    const double exact = std::pow(time, 1.5) / std::tgamma(2.5);
    ASSERT_NEAR(output.back(), exact, 1e-12 * std::pow(1e4, 1.5) / std::tgamma(2.5) + 1e-13 * exact) << i;
  }
}

// Of a rational model the stand-in is the model itself, so that both designs are its hold equivalent.
TEST(DigitalFilter, StandInOfARationalModelIsTheSameFilter) {
  for (const char* formula : {"2/(0.5 s + 1)", "(s + 3)/(s^2 + 0.2 s + 1)", "exp(-0.3 s)/((s + 1)*(s + 5))"}) {
    const auto model = FractionalTransferFunction::parse(formula);
    const auto by_exponentials = filter_design(model, 0.1, 1e-12);
    const auto by_poles = filter_design(frac::realise(model, {1e-2, 10}, 1e-10), 0.1);
    for (const double omega : {0.01, 1.0, 20.0}) {
      EXPECT_LT(std::abs(by_poles.response(omega) / by_exponentials.response(omega) - 1.0), 1e-9) << formula;
    }
  }
}

// A smooth input that lies on the band: the stand-in errs by its tolerance there, twice that allows for the ends.
TEST(DigitalFilter, StandInOnABandTakesAThirdOfTheStates) {
  const auto model = FractionalTransferFunction::parse("1/(0.8 s^2.2 + 0.5 s^0.9 + 1)");
  const double tolerance = 1e-4;
  const auto all = filter_design(model, 0.01, tolerance);
  const auto on_band = filter_design(frac::realise(model, {1e-2, 1e2}, tolerance), 0.01);
  EXPECT_LT(3 * on_band.states(), all.states());
  std::vector<double> samples(20'000);
  for (std::size_t n = 0; n < samples.size(); ++n) {
    const double t = 0.01 * static_cast<double>(n);
    samples[n] = 1 - std::exp(-t) + 0.5 * std::sin(3 * t) * std::exp(-0.05 * t);
  }
  const auto expected = frac::respond(model, samples, 0.01, 1e-10);
  const auto output = filtered(on_band, samples);
  double worst = 0, scale = 0;
  for (std::size_t n = 0; n < samples.size(); ++n) {
    worst = std::max(worst, std::abs(expected[n] - output[n]));
    scale = std::max(scale, std::abs(expected[n]));
  }
  EXPECT_LT(worst, 2 * tolerance * scale);
}

TEST(DigitalFilter, SaysWhatItCannotDo) {
  const auto model = [](const char* formula) { return FractionalTransferFunction::parse(formula); };
  support::expect_invalid_argument([&] { (void)filter_design(model("s^0.5 + 1"), 0.1); }, {"grows as s^0.5", "proper"});
  support::expect_invalid_argument([&] { (void)filter_design(model("1/s^2.5"), 0.1); }, {"more than once", "s^-2.5"});
  support::expect_invalid_argument([&] { (void)filter_design(model("1/s^2"), 0.1); }, {"more than once", "s^-2"});
  support::expect_invalid_argument([&] { (void)filter_design(model("exp(-0.25 s)/s"), 0.1); }, {"2.5 samples"});
  support::expect_invalid_argument([&] { (void)filter_design(model("1/(s + 1)"), 0); }, {"sample_time = 0 s"});
  support::expect_invalid_argument([&] { (void)filter_design(model("1/(s + 1)"), 0.1, 0); }, {"tolerance = 0"});
  support::expect_invalid_argument([&] { (void)filter_design(model("1/(s + 1)"), 0.1, 1e-9, 0); }, {"horizon = 0"});
  const auto on_band = [&](const char* formula) {
    return filter_design(frac::realise(model(formula), {0.01, 10}, 1e-3), 0.1);
  };
  support::expect_invalid_argument([&] { (void)on_band("1/(s^2 + s)"); }, {"pole at", "left of the imaginary axis"});
  support::expect_invalid_argument([&] { (void)on_band("1/(s^2 + 2 s + 1)"); }, {"multiple pole at -", "simple poles"});
  support::expect_invalid_argument([&] { (void)on_band("exp(-0.25 s)/(s + 1)"); }, {"2.5 samples", "whole number"});
  frac::DigitalFilterDesign design;
  design.sections = {.output = frac::SectionOutput::state, .direct = 0, .rates = {2}, .weights = {1}};
  support::expect_invalid_argument([&] { DigitalFilter<double> filter(design); }, {"rates[0] = 2"});
  design.sections.rates = {0.5};
  design.sections.weights = {1e300};
  EXPECT_NO_THROW(DigitalFilter<double>{design});
  support::expect_invalid_argument([&] { DigitalFilter<float> filter(design); }, {"weights[0] = 1e+300"});
  design.sections.weights = {1, 2};
  support::expect_invalid_argument([&] { DigitalFilter<double> filter(design); }, {"as many rates as weights"});
  design.sections.weights = {1};
  design.taps = {};
  support::expect_invalid_argument([&] { DigitalFilter<double> filter(design); }, {"no taps"});
  design.taps = {1, 1e300};
  support::expect_invalid_argument([&] { DigitalFilter<float> filter(design); }, {"taps[1] = 1e+300"});
  design.taps = {1};
  design.differences = 8;
  support::expect_invalid_argument([&] { DigitalFilter<double> filter(design); }, {"differences = 8"});
  std::vector<double> three(3), two(2);
  design.differences = 0;
  DigitalFilter<double> filter(design);
  support::expect_invalid_argument([&] { filter.run(three, two); }, {"3 samples but room for 2"});
}

// The larger of the gains 3 and 3/7 of c s^order carries over to the filter, on and off the method's own choice of
// taps.
TEST(FilterChoice, APowerKeepsItsCoefficientAndItsError) {
  for (const double factor : {3.0, 3.0 / 7}) {
    for (const auto method : {frac::Discretisation::direct, frac::Discretisation::tustin}) {
      const frac::FractionalTransferFunction model({{factor, 0.6}}, {{1, 0}});
      const auto choice = frac::power_filter(model, {0.1, 100}, frac::PoleCount{9}, 1e-3, method);
      double largest = 0;
      for (int i = 0; i <= 2000; ++i) {
        const double omega = 0.1 * std::pow(1000, i / 2000.0);
        largest = std::max(largest, std::abs(choice.design.response(omega) / model.response(omega) - 1.0));
      }
      // Steps of 0.0035 e-folds see the top of a ripple of half an e-fold to (0.0035/0.5 pi)^2/2.
      EXPECT_NEAR(largest / choice.max_relative_error, 1, 1e-3);
    }
  }
  EXPECT_THROW((void)frac::power_filter(frac::FractionalTransferFunction::parse("1/(s + 1)"), {0.1, 100},
                                        frac::PoleCount{9}, 1e-3),
               std::invalid_argument);
}

TEST(FilterChoice, AModelTakesTheFewerStates) {
  const auto model = frac::FractionalTransferFunction::parse("1/(0.8 s^2.2 + 0.5 s^0.9 + 1)");
  const auto all = frac::model_filter(model, {}, 0.01, 1e-4);
  EXPECT_TRUE(std::isnan(all.max_relative_error));
  const auto on_band = frac::model_filter(model, frac::FrequencyBand{0.01, 100}, 0.01, 1e-4);
  EXPECT_LT(on_band.design.states(), all.design.states());
  EXPECT_LE(on_band.max_relative_error, 1e-4);
  EXPECT_EQ(on_band.note, "");
  // An integrator has no filter on a band alone: the one for all frequencies is taken, and says so.
  const auto integrating = frac::FractionalTransferFunction::parse("1/(s^1.5 + s)");
  const auto instead = frac::model_filter(integrating, frac::FrequencyBand{0.01, 100}, 0.01, 1e-4);
  EXPECT_TRUE(std::isnan(instead.max_relative_error));
  EXPECT_NE(instead.note.find("all frequencies"), std::string::npos);
}

}  // namespace
