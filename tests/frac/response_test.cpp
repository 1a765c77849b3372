// SPDX-License-Identifier: BSD-3-Clause
#include "frac/records/response.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <functional>
#include <limits>
#include <map>
#include <numbers>
#include <numeric>
#include <random>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "records/chirp_transform.hpp"
#include "support/simulated_records.hpp"

namespace {

using Complex = std::complex<double>;
using frac::Excitation;
using frac::Record;
using frac::ResponseOptions;
using std::numbers::pi;
using support::Multisine;
using support::RecordCase;
using support::ResonantFilter;

std::vector<std::size_t> lines_to(std::size_t last, std::size_t step = 1) {
  std::vector<std::size_t> lines;
  for (std::size_t k = 1; k <= last; k += step) lines.push_back(k);
  return lines;
}

std::vector<double> sampled(std::size_t count, const std::function<double(double)>& signal) {
  std::vector<double> samples(count);
  for (std::size_t i = 0; i < count; ++i) samples[i] = signal(static_cast<double>(i));
  return samples;
}

std::vector<double> through(const std::vector<double>& input, const std::function<double(double)>& characteristic) {
  std::vector<double> output;
  for (const double u : input) output.push_back(characteristic(u));
  return output;
}

// Both sums have rounding errors of n samples in turn: 1e-16 sqrt(n) of the largest, some 1e-14; prime lengths and
// lengths that are not whole go the same way.
TEST(ChirpTransform, IsTheFourierSumAtEveryLength) {
  std::mt19937_64 generator(1);
  std::normal_distribution<double> normal;
  for (const std::size_t samples : {16U, 101U, 500U})
    for (const double length : {static_cast<double>(samples), 97.0, 250.37}) {
      std::vector<double> signal(samples);
      for (double& each : signal) each = normal(generator);
      const auto found = frac::detail::ChirpTransform(samples, length, 60)(signal.data());
      for (std::size_t k = 0; k < 60; ++k) {
        Complex sum = 0;
        for (std::size_t m = 0; m < samples; ++m)
          sum += signal[m] * std::polar(2.0 / static_cast<double>(samples),
                                        -2 * pi * std::fmod(static_cast<double>(k * m), length) / length);
        EXPECT_LT(std::abs(found[k] - sum), 1e-13) << samples << " " << length << " " << k;
      }
    }
}

// Without noise the lines hold the response alone; rounding of 1280 samples, over the smallest line of the output.
TEST(PeriodicResponse, IsExactWithoutNoise) {
  std::mt19937_64 generator(2);
  const ResonantFilter filter;
  const auto sines = Multisine::random(128, lines_to(40), generator);
  const auto record = Record(
      0.01, sampled(1280, [&](double t) { return sines.value(t); }),
      {sampled(1280, [&](double t) { return sines.value(t, [&](double turns) { return filter.response(turns); }); })});
  const auto found = frac::response({record});
  EXPECT_EQ(found.excitation, Excitation::periodic);
  EXPECT_DOUBLE_EQ(found.period, 1.28);
  EXPECT_EQ(found.periods, 10);
  ASSERT_EQ(found.outputs[0].size(), 40U);
  for (std::size_t i = 0; i < 40; ++i) {
    const auto& point = found.outputs[0][i];
    EXPECT_NEAR(point.omega, 2 * pi * static_cast<double>(i + 1) / 1.28, 1e-9);
    EXPECT_LT(std::abs(point.value - filter.response(static_cast<double>(i + 1) / 128)), 1e-12);
    EXPECT_NEAR(point.input_amplitude, 1, 1e-12);
  }
}

// A long record is folded: 400 periods of 500 samples onto 50.  Sums of 200 000 samples err by rounding, 1e-16 times
// the root of their number, over the smallest line of the output.
TEST(PeriodicResponse, OfALongRecordIsThatOfItsMeanPeriods) {
  std::mt19937_64 generator(21);
  const ResonantFilter filter;
  const auto sines = Multisine::random(500, lines_to(99, 2), generator);
  const auto input = sampled(500, [&](double t) { return sines.value(t); });
  const auto exact =
      sampled(500, [&](double t) { return sines.value(t, [&](double turns) { return filter.response(turns); }); });
  std::normal_distribution<double> normal;
  std::vector<double> u, y, noisy, changed;
  constexpr std::size_t count = 200'123;
  for (std::size_t i = 0; i < count; ++i) {
    u.push_back(input[i % 500]);
    y.push_back(exact[i % 500]);
    noisy.push_back(y.back() + normal(generator));
    changed.push_back((i < count / 2 ? 1 : 1.01) * y.back() + 0.1 * normal(generator));
  }
  const auto found = frac::response({Record(1, u, {y})});
  EXPECT_EQ(found.period, 500);
  EXPECT_EQ(found.periods, 400);
  ASSERT_EQ(found.outputs[0].size(), 50U);
  for (const auto& point : found.outputs[0]) {
    EXPECT_LT(std::abs(point.value - filter.response(point.omega / (2 * pi))), 1e-12);
    EXPECT_NEAR(point.periods, 400 * std::round(point.omega / (2 * pi) * 500), 1e-6);
  }
  // White noise of deviation s leaves sqrt(2/n) s in each part of a line of amplitude 1; its estimate has 21 degrees of
  // freedom, and a mean over 50 lines scatters by sqrt(1/(2 21 50)), two per cent.
  const auto of_noisy = frac::response({Record(1, u, {noisy})});
  double squares = 0, errors = 0;
  for (const auto& point : of_noisy.outputs[0]) {
    const double shrunk = 19.0 / 21;  // of Student's deviation to the estimate of the normal one
    squares += shrunk * point.sigma * point.sigma / 50;
    errors += std::norm(point.value - filter.response(point.omega / (2 * pi))) / 100;
  }
  EXPECT_NEAR(squares / (2.0 / 200'000), 1, 0.12);
  // A hundred squares of normal errors: their mean scatters by sqrt(2/100).
  EXPECT_NEAR(errors / (2.0 / 200'000), 1, 0.45);
  EXPECT_TRUE(of_noisy.remarks.size() == 1 || of_noisy.remarks.empty());
  const auto of_changed = frac::response({Record(1, u, {changed})});
  EXPECT_TRUE(std::any_of(of_changed.remarks.begin(), of_changed.remarks.end(),
                          [](const auto& remark) { return remark.find("second half") != std::string::npos; }));
}

// 400 periods that are a thousandth of a sample longer run away by 0.4 samples, which costs lines k of power 1/2 the
// share (2 pi k 0.4/500)^2/12 of it, 0.17 of all 50 together: seen beside noise of power 1, of which half a per cent is
// allowed.
TEST(Period, OfALongSignalIsNoWholeNumberWhereTheSignalRunsAway) {
  std::mt19937_64 generator(22);
  std::normal_distribution<double> normal;
  const auto sines = Multisine::random(500, lines_to(99, 2), generator);
  for (const double noise : {0.0, 1.0}) {
    const auto signal =
        sampled(200'000, [&](double t) { return sines.value(t * 500 / 500.001) + noise * normal(generator); });
    const auto found = frac::period_of(signal);
    ASSERT_TRUE(found);
    EXPECT_NEAR(*found, 500.001, 1e-4) << noise;
  }
}

// The period is a fraction of a sample: what the last half sample leaves of 40 lines in each other is smooth and goes
// with the transient, but for its fourth difference, (12/10/127)^3/2 of it, which is itself 1/(2 n) of a line.
TEST(PeriodicResponse, FindsAPeriodThatIsNoWholeNumberOfSamples) {
  std::mt19937_64 generator(3);
  const ResonantFilter filter;
  constexpr double period = 127.37;
  std::vector<double> phases;
  for (int k = 0; k < 40; ++k) phases.push_back(std::uniform_real_distribution<double>(0, 2 * pi)(generator));
  const auto signal = [&](double time, bool filtered) {
    double sum = 0;
    for (std::size_t k = 1; k <= 40; ++k) {
      const double turns = static_cast<double>(k) / period;
      sum +=
          ((filtered ? filter.response(turns) : 1.0) * std::polar(1.0, phases[k - 1] + 2 * pi * turns * time)).real();
    }
    return sum;
  };
  const Record record(1, sampled(1400, [&](double t) { return signal(t, false); }),
                      {sampled(1400, [&](double t) { return signal(t, true); })});
  const auto found = frac::response({record});
  // 40 lines over 10 periods turn by 2 pi 400 times the relative error.
  EXPECT_NEAR(found.period / period, 1, 1e-5);
  ASSERT_EQ(found.outputs[0].size(), 40U);
  for (std::size_t i = 0; i < 40; ++i) {
    const Complex exact = filter.response(static_cast<double>(i + 1) / period);
    // An error of the period moves each line by its share; at the resonance the response turns 20 times as fast.
    EXPECT_LT(std::abs(found.outputs[0][i].value - exact), 2e-3 * std::abs(exact)) << i;
  }
}

// sigma^2 of each part is that of 2/n of white noise in a line, and of the polynomial through the 12 to 24 lines around
// (1 + h), over the input; its mean over 40 lines of 20 records scatters by sqrt(1/(9 * 800)) at most, 1.2 %, and the
// degrees of freedom of Student's distribution make it 18/16 or less as large.
TEST(PeriodicResponse, DeviationIsThatOfTheNoise) {
  double squares = 0, expected = 0, count = 0;
  for (unsigned seed = 1; seed <= 20; ++seed) {
    std::mt19937_64 generator(seed);
    const auto record = support::simulated_record(RecordCase::white, 20, generator);
    ResponseOptions options;
    options.period = 128;
    // Twelve lines on each side; sums of r^2 and r^4 for r = 1 .. 12.
    constexpr double n = 24, s2 = 2 * 650, s4 = 2 * 60710, h = s4 / (n * s4 - s2 * s2);
    const auto found = frac::response({record}, options);
    for (std::size_t i = 0; i < found.outputs[0].size(); ++i) {
      const auto& point = found.outputs[0][i];
      squares += point.sigma * point.sigma * (2 * 21 - 2) / (2 * 21);
      // 0.5^2 (2/n)^2 n/2 for each part of a line of amplitude 1.
      expected += 0.25 * 2 / (20 * 128) * (1 + h);
      ++count;
    }
  }
  EXPECT_NEAR(squares / expected, 1, 4 * std::sqrt(1 / (21 * count)) + 0.01);
}

// Half of 40 seeds' intervals are of one record each, and lines are independent but for the windows they share; a tenth
// of them is taken as independent: four deviations of the rate.
TEST(Response, IntervalsHoldWhatTheySay) {
  for (const RecordCase which : support::record_cases) {
    support::RecordCoverage coverage;
    for (unsigned seed = 1; seed <= 25; ++seed) {
      std::mt19937_64 generator(seed);
      coverage.count(which, 10, generator);
    }
    const double independent = std::min(coverage.whole, 25 * 12);
    EXPECT_NEAR(coverage.percent(), 95, 4 * 100 * std::sqrt(0.05 * 0.95 / independent)) << name_of(which);
    EXPECT_GE(coverage.recognised, coverage.records - 1) << name_of(which);
  }
}

// Noise goes round the loop, so that it is seven times as large at line 8 as far from it and a quarter at line 6.  360
// intervals of the three lines about its peak or more, of which those of a window share their noise: half as many count
// as independent, and four deviations of the rate are 6.5 %.  Over all lines the mean square of error over sigma is 1
// to within 4 sqrt(2 (1 + 3/9) / (60 * 40 / 5)), with five lines to a window.  Noise taken as even over the window
// holds 44 to 72 % at line 8, and lines whose input is weak, taken for distortion, make sigma twice as large.
TEST(Response, IntervalsHoldAtTheNoisePeakOfALoop) {
  for (const auto& [which, periods] :
       {std::pair{RecordCase::closed_loop, 2}, std::pair{RecordCase::closed_loop, 3},
        std::pair{RecordCase::closed_loop, 5}, std::pair{RecordCase::arbitrary_loop, 20}}) {
    support::RecordCoverage coverage;
    for (unsigned seed = 501; seed <= 560; ++seed) {
      std::mt19937_64 generator(seed);
      coverage.count(which, static_cast<std::size_t>(periods), generator);
    }
    int held = 0, whole = 0;
    for (const int line : {7, 8, 9}) {
      held += coverage.of_line[line][0];
      whole += coverage.of_line[line][1];
    }
    EXPECT_GE(100.0 * held / whole, 88.5) << name_of(which) << periods;
    EXPECT_NEAR(2 * coverage.squares / coverage.whole, 1, 0.3) << name_of(which) << periods;
  }
}

// Where a resonance is narrow beside the window: of a start from rest over two and three periods, whose transient has
// the pole 0.6 and 1 lines above the axis at line 6.4; and of a random reference in a loop, where half of the window of
// line 6 is 2.5 half widths of the resonance.  Four deviations of the rate, each part independent.  A polynomial alone
// holds 78, 94 and 81 % (1000 other seeds).
TEST(Response, IntervalsHoldBesideANarrowResonance) {
  for (const auto& [which, periods] : {std::pair{RecordCase::transient, 2}, std::pair{RecordCase::transient, 3},
                                       std::pair{RecordCase::arbitrary_loop, 10}}) {
    support::RecordCoverage coverage;
    for (unsigned seed = 701; seed <= 820; ++seed) {
      std::mt19937_64 generator(seed);
      coverage.count(which, static_cast<std::size_t>(periods), generator);
    }
    int held = 0, whole = 0;
    for (const int line : {6, 7}) {
      held += coverage.of_line[line][0];
      whole += coverage.of_line[line][1];
    }
    ASSERT_GE(whole, 240);
    EXPECT_GE(100.0 * held / whole, 95 - 4 * 100 * std::sqrt(0.05 * 0.95 / whole)) << name_of(which) << periods;
  }
}

// Expected power of u^3 on a line, but for what is in phase with the line itself: sines of equal amplitude and random
// phases; of each set of three signed lines with that sum all orders add up, and different sets are independent.  A set
// that holds a line with both signs has the phase of the third.
double power_of_cube(const std::vector<std::size_t>& lines, int at, double amplitude) {
  std::vector<int> sides;
  for (const auto line : lines) {
    sides.push_back(static_cast<int>(line));
    sides.push_back(-static_cast<int>(line));
  }
  std::map<std::vector<int>, double> orders;
  for (const int a : sides)
    for (const int b : sides) {
      const int c = at - a - b;
      if (std::find(sides.begin(), sides.end(), c) == sides.end()) continue;
      if (a + b == 0 || b + c == 0 || c + a == 0) continue;
      std::vector<int> set{a, b, c};
      std::sort(set.begin(), set.end());
      ++orders[set];
    }
  double power = 0;
  for (const auto& [set, count] : orders) power += std::pow(count * amplitude * amplitude * amplitude / 4, 2);
  return power;
}

// The same of u^2; line 0 is the mean.
double power_of_square(const std::vector<std::size_t>& lines, int at, double amplitude) {
  std::vector<int> sides;
  for (const auto line : lines)
    for (const int sign : {-1, 1}) sides.push_back(sign * static_cast<int>(line));
  double power = 0;
  for (const int a : sides)
    if (std::find(sides.begin(), sides.end(), at - a) != sides.end())
      power += (2 * a == at ? 1 : 2) * std::pow(amplitude * amplitude / 2, 2);
  return power;
}

// Odd lines, every fourth of which is left out at a random place.
std::vector<std::size_t> odd_lines_with_holes(std::mt19937_64& generator) {
  std::vector<std::size_t> lines;
  for (std::size_t group = 0; group < 12; ++group) {
    const auto hole = std::uniform_int_distribution<std::size_t>(0, 3)(generator);
    for (std::size_t i = 0; i < 4; ++i)
      if (i != hole || group == 0) lines.push_back(8 * group + 2 * i + 1);
  }
  return lines;
}

// The mean over 60 records and 30 points, of which those of a record share their six lines: 60 * 12/6 independent means
// of 12 degrees of freedom scatter by sqrt(2/12/120), 4 %; 20 % is what is promised.
TEST(PeriodicResponse, TellsDistortionOfAStaticCubic) {
  double found_power = 0, expected_power = 0, largest_even = 0;
  constexpr double share = 0.05, amplitude = 0.3;
  for (unsigned seed = 1; seed <= 60; ++seed) {
    std::mt19937_64 generator(seed);
    const auto lines = odd_lines_with_holes(generator);
    const auto sines = Multisine::random(512, lines, generator);
    std::normal_distribution<double> normal;
    const auto input = sampled(512 * 4, [&](double t) { return amplitude * sines.value(t); });
    auto output = through(input, [](double u) { return u + share * u * u * u; });
    for (double& each : output) each += 1e-4 * normal(generator);
    const auto found = frac::response({Record(1, input, {output})});
    ASSERT_EQ(found.outputs[0].size(), lines.size());
    std::vector<std::size_t> holes;
    for (std::size_t k = lines.front(); k < lines.back(); k += 2)
      if (std::find(lines.begin(), lines.end(), k) == lines.end()) holes.push_back(k);
    std::map<std::size_t, double> power;
    for (const auto hole : holes)
      power[hole] = std::pow(share, 2) * power_of_cube(lines, static_cast<int>(hole), amplitude);
    for (std::size_t i = 0; i < lines.size(); ++i) {
      const auto& point = found.outputs[0][i];
      found_power += std::pow(point.distortion * point.input_amplitude, 2);
      largest_even = std::max(largest_even, point.even_distortion / point.noise);
      auto near = holes;
      std::stable_sort(near.begin(), near.end(), [&](std::size_t a, std::size_t b) {
        const auto distance = [&](std::size_t k) { return k > lines[i] ? k - lines[i] : lines[i] - k; };
        return distance(a) < distance(b);
      });
      for (std::size_t k = 0; k < 6; ++k) expected_power += power[near[k]] / 2 / 6;
    }
  }
  EXPECT_NEAR(found_power / expected_power, 1, 0.2);
  // No even distortion: its level is the scatter of noise, six lines of 2 degrees each.
  EXPECT_LT(largest_even, 3);
}

// Distortion of u + c (u^2 + u^3) at each line of 100 records against its expectation over the phases.  The lines of a
// record share their 12 odd ones that are left out, six to each: two independent intervals; so do its 47 even ones,
// four deviations of the rate. All lines of a record share a factor of their odd distortion: of a cubic of K lines its
// variance is about 18/K (var <x^4> of normal x, 24 s^8/(3 K), times (9 s^2)^2 over (6 s^6)^2).  So the level of this
// record counts, which the errors of its 37 points tell, with 74 degrees of freedom: the ratio is Fisher's with 12 and
// 74, of which the interval of chi-square holds 92.9 %.  An even level is within 20 % of its expectation with the
// chance 67.0 % that chi-square of 12 degrees lies between 12 0.8^2 and 12 1.2^2; an odd one of that of its record
// with 63.4 %.
TEST(PeriodicResponse, IntervalsOfDistortionHoldWhatTheySay) {
  constexpr double share = 0.05, amplitude = 0.3;
  constexpr int records = 100;
  std::array<int, 2> held{}, near{};
  int whole = 0;
  for (unsigned seed = 101; seed <= 100 + records; ++seed) {
    std::mt19937_64 generator(seed);
    const auto lines = odd_lines_with_holes(generator);
    const auto sines = Multisine::random(512, lines, generator);
    std::normal_distribution<double> normal;
    const auto input = sampled(512 * 4, [&](double t) { return amplitude * sines.value(t); });
    const auto output =
        through(input, [&](double u) { return u + share * (u * u + u * u * u) + 1e-4 * normal(generator); });
    const auto found = frac::response({Record(1, input, {output})});
    ASSERT_EQ(found.outputs[0].size(), lines.size());
    const auto count = static_cast<double>(lines.size());
    const double linear = 1 + share * amplitude * amplitude * (0.75 + 1.5 * (count - 1));
    const auto deviation = [&](double power) { return share * std::sqrt(power / 2) / amplitude; };
    std::vector<double> odd;
    double of_record = 0;
    for (std::size_t i = 0; i < lines.size(); ++i) {
      odd.push_back(deviation(power_of_cube(lines, static_cast<int>(lines[i]), amplitude)));
      of_record += std::norm(found.outputs[0][i].value - linear) / (2 * odd[i] * odd[i] * count);
    }
    for (std::size_t i = 0; i < lines.size(); ++i) {
      const auto& point = found.outputs[0][i];
      const int at = static_cast<int>(lines[i]);
      // Even lines lie beside it on both sides.
      const std::array exact{
          odd[i] * std::sqrt(of_record),
          deviation((power_of_square(lines, at - 1, amplitude) + power_of_square(lines, at + 1, amplitude)) / 2)};
      held[0] += point.distortion_low <= exact[0] && exact[0] <= point.distortion_high;
      held[1] += point.even_distortion_low <= exact[1] && exact[1] <= point.even_distortion_high;
      near[0] += std::abs(point.distortion / exact[0] - 1) <= 0.2;
      near[1] += std::abs(point.even_distortion / exact[1] - 1) <= 0.2;
      ++whole;
    }
  }
  const auto expect = [&](int count, double rate) {
    EXPECT_NEAR(static_cast<double>(count) / whole, rate, 4 * std::sqrt(rate * (1 - rate) / (2 * records)));
  };
  expect(held[0], 0.929);
  expect(held[1], 0.95);
  expect(near[0], 0.634);
  expect(near[1], 0.670);
}

// u^2 of sines on odd lines lies on even ones alone, on which the response has no line.
TEST(PeriodicResponse, EvenDistortionIsNoPartOfSigma) {
  std::mt19937_64 generator(4);
  const auto sines = Multisine::random(512, lines_to(99, 2), generator);
  const auto input = sampled(512 * 4, [&](double t) { return 0.3 * sines.value(t); });
  const auto found = frac::response({Record(1, input, {through(input, [](double u) { return u + 0.1 * u * u; })})});
  ASSERT_EQ(found.outputs[0].size(), 50U);
  for (const auto& point : found.outputs[0]) {
    EXPECT_LT(std::abs(point.value - 1.0), 1e-12);
    EXPECT_GT(point.even_distortion, 1e-3);
    EXPECT_TRUE(std::isnan(point.distortion));
    EXPECT_LT(point.sigma, 1e-12);
  }
}

// The best linear approximation of u + c u^3 for K sines of amplitude A and random phases is
// 1 + c A^2 (3/4 + 3/2 (K - 1)): the terms whose phase is that of the line.  Intervals of the scatter over 6
// realisations hold it; neighbours share their scatter, so that a third of them counts as independent.
TEST(Response, RealisationsTellTheBestLinearApproximation) {
  int held = 0, whole = 0;
  constexpr double share = 0.05, amplitude = 0.3;
  constexpr std::size_t lines = 40;
  for (unsigned seed = 1; seed <= 20; ++seed) {
    std::mt19937_64 generator(seed);
    std::vector<Record> records;
    for (int realisation = 0; realisation < 6; ++realisation) {
      const auto sines = Multisine::random(256, lines_to(lines), generator);
      const auto input = sampled(512, [&](double t) { return amplitude * sines.value(t); });
      records.push_back(Record(1, input, {through(input, [](double u) { return u + share * u * u * u; })}));
    }
    const auto found = frac::response(records);
    ASSERT_EQ(found.realisations, 6U);
    const double exact = 1 + share * amplitude * amplitude * (0.75 + 1.5 * (lines - 1));
    for (const auto& point : found.outputs[0]) {
      held += std::abs(point.value.real() - exact) <= point.half_width_re();
      held += std::abs(point.value.imag()) <= point.half_width_im();
      whole += 2;
    }
  }
  EXPECT_NEAR(100.0 * held / whole, 95, 4 * 100 * std::sqrt(0.05 * 0.95 / (whole / 3.0)));
}

// Under F cos(w t + p) u + c u^3 answers with (1 + 3/4 c F^2) F cos and c F^3/4 cos 3(w t + p).
TEST(SteppedSineResponse, HarmonicsOfACubicAreExact) {
  std::vector<double> input;
  for (const double force : {1.0, 2.0})
    for (const std::size_t cycle : {40U, 32U, 25U})
      for (std::size_t i = 0; i < 12 * cycle; ++i)
        input.push_back(force * std::sin(2 * pi * static_cast<double>(i) / static_cast<double>(cycle)));
  ResponseOptions options;
  options.harmonics = 4;
  const auto found =
      frac::response({Record(1e-3, input, {through(input, [](double u) { return u + 0.1 * u * u * u; })})}, options);
  EXPECT_EQ(found.excitation, Excitation::stepped_sine);
  ASSERT_EQ(found.outputs[0].size(), 6U);
  const double cycles[] = {40, 32, 25};
  for (std::size_t i = 0; i < 6; ++i) {
    const auto& point = found.outputs[0][i];
    const double force = i < 3 ? 1 : 2;
    // The period is found to rounding of its phase; the sums err by 300 roundings.
    EXPECT_NEAR(point.omega * 1e-3 * cycles[i % 3] / (2 * pi), 1, 1e-9);
    EXPECT_NEAR(point.input_amplitude, force, 1e-9);
    EXPECT_LT(std::abs(point.value - (1 + 0.075 * force * force)), 1e-9);
    ASSERT_EQ(point.harmonics.size(), 3U);
    EXPECT_LT(std::abs(point.harmonics[0].value), 1e-9);
    EXPECT_LT(std::abs(point.harmonics[1].value - 0.025 * force * force), 1e-9);
    EXPECT_LT(std::abs(point.harmonics[2].value), 1e-9);
    EXPECT_EQ(point.subharmonic, 1);
  }
}

TEST(SteppedSineResponse, SaysSubharmonics) {
  std::mt19937_64 generator(5);
  std::normal_distribution<double> normal;
  std::vector<double> input, output;
  for (std::size_t i = 0; i < 2000; ++i) {
    const double phase = 2 * pi * static_cast<double>(i) / 40;
    input.push_back(std::cos(phase));
    output.push_back(0.5 * std::cos(phase - 1) + 0.1 * std::cos(phase / 2) + 0.01 * normal(generator));
  }
  const auto found = frac::response({Record(1, input, {output})});
  ASSERT_EQ(found.outputs[0].size(), 1U);
  const auto& point = found.outputs[0][0];
  EXPECT_EQ(point.subharmonic, 2);
  EXPECT_LT(std::abs(point.value - std::polar(0.5, -1.0)), 5 * point.sigma);
  EXPECT_LT(point.sigma, 0.002);
}

// Records that begin at rest and end before the transient is over: 1024 samples, resonances of damping 2 to 5 % between
// 0.02 and 0.2 of the sampling rate.
TEST(ArbitraryResponse, ErrsAtMostATenthOfWindowedH1) {
  std::vector<double> ratios;
  for (unsigned seed = 1; seed <= 20; ++seed) {
    std::mt19937_64 generator(seed);
    std::normal_distribution<double> normal;
    std::uniform_real_distribution<double> unit(0, 1);
    ResonantFilter filter(0.02 + 0.03 * unit(generator), 0.02 * std::pow(10, unit(generator)));
    std::vector<double> input, output;
    for (int i = 0; i < 1024; ++i) {
      input.push_back(normal(generator));
      output.push_back(filter.step(input.back()));
    }
    const auto found = frac::response({Record(1, input, {output})});
    EXPECT_EQ(found.excitation, Excitation::arbitrary);
    double local = 0, windowed = 0;
    for (const auto& point : found.outputs[0]) {
      const Complex exact = filter.response(point.omega / (2 * pi));
      local += std::norm(point.value - exact);
      windowed += std::norm(point.windowed - exact);
    }
    ratios.push_back(std::sqrt(local / windowed));
  }
  std::sort(ratios.begin(), ratios.end());
  EXPECT_LT(ratios[ratios.size() / 2], 0.1);
  EXPECT_LT(ratios.back(), 0.3);
}

TEST(Excitation, IsRecognised) {
  std::mt19937_64 generator(6);
  std::normal_distribution<double> normal;
  const auto kind = [](std::vector<double> input) {
    const std::vector<double> output = input;
    return frac::excitation_of(Record(1, std::move(input), {output}));
  };
  EXPECT_EQ(kind(sampled(2000, [&](double) { return normal(generator); })), Excitation::arbitrary);
  // A sweep from 0.002 to 0.1 of the sampling rate, a step, a square wave, one sine.
  EXPECT_EQ(kind(sampled(4000, [](double t) { return std::sin(2 * pi * t * (0.002 + 0.049 * t / 4000)); })),
            Excitation::arbitrary);
  EXPECT_EQ(kind(sampled(2000, [](double t) { return t < 500 ? 0.0 : 1.0; })), Excitation::arbitrary);
  EXPECT_EQ(kind(sampled(2000, [](double t) { return std::fmod(t, 100) < 50 ? 0.0 : 1.0; })), Excitation::periodic);
  EXPECT_EQ(kind(sampled(2000, [](double t) { return 3 + std::sin(0.1 * t); })), Excitation::stepped_sine);
}

// Every kind of excitation in as few samples as a record may have, and of few samples per cycle, ends without a value
// or with one, never in between.
// Less than two periods, with noise of 5 % on the input or none, are said with their number, which the noise of a
// summit tells to a sample of 400; inputs that come back nowhere are not, with a chance of 1e-6 each: noise of three
// colours, a sweep, a step, a hammer.
TEST(Excitation, SaysWhereARecordHoldsLessThanTwoPeriods) {
  std::mt19937_64 generator(61);
  std::normal_distribution<double> normal;
  for (const double periods : {1.15, 1.2, 1.5, 1.9})
    for (const double noise : {0.0, 0.05})
      for (const double length : {400.0, 400.4}) {
        const auto sines = Multisine::random(1000, lines_to(79, 2), generator);
        const auto input = sampled(static_cast<std::size_t>(periods * length), [&](double t) {
          return sines.value(t * 1000 / length) + noise * std::sqrt(20) * normal(generator);
        });
        const auto found = frac::repeats_once_after(input);
        ASSERT_TRUE(found) << periods << ", " << noise << ", " << length;
        EXPECT_NEAR(*found, length, 0.5);
        EXPECT_NE(frac::response({Record(1, input, {input})}).remarks.front().find("repeats itself after 400"),
                  std::string::npos);
      }
  for (int seed = 0; seed < 200; ++seed)
    for (const int kind : {0, 1, 2, 3, 4, 5}) {
      double low = 0;
      const double rate = 0.5 + 0.01 * seed;
      const auto input = sampled(600, [&](double t) {
        low = (kind == 1 ? 0.9 : 0.98) * low + normal(generator);
        if (kind == 3) return std::sin(rate * t * t / 1000);
        if (kind == 4) return t < 3 * seed ? 0.0 : 1.0;
        if (kind == 5) return (t > 100 && t < 105 ? 30.0 : 0.0) + 0.01 * normal(generator);
        return kind == 0 ? normal(generator) : low;
      });
      EXPECT_FALSE(frac::repeats_once_after(input)) << kind << ", " << seed;
    }
}

TEST(Response, ShortRecordsGiveNothingOrADeviation) {
  const auto expect_whole = [](const frac::ResponseEstimate& found) {
    for (const auto& point : found.outputs[0]) EXPECT_TRUE(std::isfinite(point.sigma) != !point.flag.empty());
  };
  std::mt19937_64 generator(7);
  std::normal_distribution<double> normal;
  for (const std::size_t count : {16U, 17U, 31U, 64U})
    for (const double cycle : {2.0, 2.5, 3.0, 4.0, 5.3, 8.0})
      for (const double noise : {0.0, 0.1, 10.0}) {
        const auto input =
            sampled(count, [&](double t) { return std::cos(2 * pi * t / cycle + 0.3) + noise * normal(generator); });
        const Record record(1, input, {input});
        for (const auto kind : {Excitation::periodic, Excitation::stepped_sine, Excitation::arbitrary}) {
          ResponseOptions options;
          options.excitation = kind;
          if (kind == Excitation::periodic) options.period = std::min(4 * cycle, static_cast<double>(count) / 2);
          expect_whole(frac::response({record}, options));
        }
        expect_whole(frac::response({record}));
      }
}

/// A record without the samples from `first` to `first + missing - 1`.
Record without(const Record& record, std::vector<std::pair<std::size_t, std::size_t>> missing) {
  std::vector<frac::RecordGap> gaps;
  const auto cut = [&](const std::vector<double>& signal) {
    std::vector<double> kept;
    gaps.clear();
    std::size_t next = 0;
    for (const auto& [first, count] : missing) {
      kept.insert(kept.end(), signal.begin() + static_cast<std::ptrdiff_t>(next),
                  signal.begin() + static_cast<std::ptrdiff_t>(first));
      next = first + count;
      gaps.push_back({kept.size(), count});
    }
    kept.insert(kept.end(), signal.begin() + static_cast<std::ptrdiff_t>(next), signal.end());
    return kept;
  };
  std::vector<std::vector<double>> outputs;
  for (const auto& output : record.outputs()) outputs.push_back(cut(output));
  auto input = cut(record.input());
  return {record.sample_time(), std::move(input), std::move(outputs), {}, gaps};
}

bool says(const frac::ResponseEstimate& found, const std::string& text) {
  return std::any_of(found.remarks.begin(), found.remarks.end(),
                     [&](const auto& remark) { return remark.find(text) != std::string::npos; });
}

// A periodic record goes on over its gaps: exact without noise, as the whole record is.  With noise the intervals of 40
// records of 40 lines, 3200 in all, hold as often as they say: 95 %, three deviations of it are 1.2 %.
TEST(Gaps, OfAPeriodicRecordLeaveItExactAndItsIntervalsTrue) {
  int held = 0, whole = 0;
  for (unsigned seed = 1; seed <= 40; ++seed) {
    std::mt19937_64 generator(seed);
    std::normal_distribution<double> normal;
    const ResonantFilter filter;
    const auto sines = Multisine::random(128, lines_to(40), generator);
    const auto input = sampled(1280, [&](double t) { return sines.value(t); });
    const auto exact =
        sampled(1280, [&](double t) { return sines.value(t, [&](double turns) { return filter.response(turns); }); });
    const std::vector<std::pair<std::size_t, std::size_t>> missing{{401, 1}, {555 + seed, 77}, {900, 130}};
    if (seed == 1) {
      const auto found = frac::response({without(Record(1, input, {exact}), missing)});
      EXPECT_EQ(found.excitation, Excitation::periodic);
      EXPECT_TRUE(says(found, "3 gaps of 208 samples in all: the period goes on"));
      ASSERT_EQ(found.outputs[0].size(), 40U);
      for (const auto& point : found.outputs[0])
        EXPECT_LT(std::abs(point.value - filter.response(point.omega / (2 * pi))), 1e-12);
    }
    const auto noisy = through(exact, [&](double y) { return y + 0.5 * normal(generator); });
    const auto found = frac::response({without(Record(1, input, {noisy}), missing)});
    for (const auto& point : found.outputs[0]) {
      const Complex error = point.value - filter.response(point.omega / (2 * pi));
      held += std::abs(error.real()) <= point.half_width_re();
      held += std::abs(error.imag()) <= point.half_width_im();
      whole += 2;
    }
  }
  EXPECT_EQ(whole, 3200);
  EXPECT_NEAR(100.0 * held / whole, 95, 1.2);
}

// Segments of 40, 50 and 40 cycles; the second has the gap.  Its point holds both sides, its intervals are true (600
// records, 1200 intervals: three deviations are 1.9 %), and a gain that changes in the gap is said.
TEST(Gaps, OfASteppedSineLeaveOnePointForASegment) {
  constexpr std::array cycles{23.7, 20.0, 17.3};
  const auto record = [&](double noise, double gain_after, std::mt19937_64& generator) {
    std::normal_distribution<double> normal;
    std::vector<double> input, output;
    double phase = 0;
    for (std::size_t k = 0; k < cycles.size(); ++k)
      for (int i = 0; i < 900; ++i) {
        input.push_back(std::cos(phase));
        const double gain = k == 1 && i > 500 ? gain_after : 1;
        output.push_back(gain * 0.5 * std::cos(phase - 1) + noise * normal(generator));
        phase += 2 * pi / cycles[k];
      }
    return without(Record(1, input, {output}), {{1330, 101}});
  };
  std::mt19937_64 generator(7);
  const auto exact = frac::response({record(0, 1, generator)});
  EXPECT_EQ(exact.excitation, Excitation::stepped_sine);
  EXPECT_TRUE(says(exact, "a gap of 101 samples"));
  ASSERT_EQ(exact.outputs[0].size(), 3U);
  for (const auto& point : exact.outputs[0]) EXPECT_LT(std::abs(point.value - std::polar(0.5, -1.0)), 1e-6);
  // 18 cycles before, the last one of which may be cut, and 21 after.
  EXPECT_GE(exact.outputs[0][1].periods, 34);
  int held = 0, whole = 0;
  for (int i = 0; i < 600; ++i) {
    const auto found = frac::response({record(0.1, 1, generator)});
    if (found.outputs[0].size() != 3) continue;
    const auto& point = found.outputs[0][1];
    if (!point.flag.empty()) continue;
    const Complex error = point.value - std::polar(0.5, -1.0);
    held += std::abs(error.real()) <= point.half_width_re();
    held += std::abs(error.imag()) <= point.half_width_im();
    whole += 2;
  }
  // Three tests in each record that are wrong once in a thousand.
  EXPECT_GE(whole, 2 * 590);
  EXPECT_NEAR(100.0 * held / whole, 95, 1.9);
  const auto changed = frac::response({record(0.01, 1.1, generator)});
  ASSERT_EQ(changed.outputs[0].size(), 3U);
  EXPECT_NE(changed.outputs[0][1].flag.find("after a gap"), std::string::npos);
  EXPECT_TRUE(std::isnan(changed.outputs[0][1].sigma));
}

// An output that is read 3.7 samples late has the response of one that is not, to the rounding of the sums: exact
// records, whole and with a gap.  Under noise a turn of the phase leaves the sum of both variances, and the covariance
// within what it may be.
TEST(SensorDelay, IsTakenOutOfTheResponse) {
  constexpr double delay = 3.7;
  std::mt19937_64 generator(11);
  std::normal_distribution<double> normal;
  const ResonantFilter filter;
  const auto sines = Multisine::random(128, lines_to(40), generator);
  const auto input = sampled(1280, [&](double t) { return sines.value(t); });
  const auto late = sampled(
      1280, [&](double t) { return sines.value(t - delay, [&](double turns) { return filter.response(turns); }); });
  frac::ResponseOptions told;
  told.sensor_delay = delay;
  for (const Record& record : {Record(1, input, {late}), without(Record(1, input, {late}), {{555, 77}})}) {
    const auto found = frac::response({record}, told);
    ASSERT_EQ(found.outputs[0].size(), 40U);
    for (const auto& point : found.outputs[0])
      EXPECT_LT(std::abs(point.value - filter.response(point.omega / (2 * pi))), 1e-11);
  }
  const Record noisy(1, input, {through(late, [&](double y) { return y + 0.5 * normal(generator); })});
  const auto as_read = frac::response({noisy}), turned = frac::response({noisy}, told);
  for (std::size_t i = 0; i < 40; ++i) {
    const auto &before = as_read.outputs[0][i], &after = turned.outputs[0][i];
    EXPECT_NEAR(std::hypot(after.sigma_re, after.sigma_im), std::hypot(before.sigma_re, before.sigma_im), 1e-12);
    // The determinant of the covariance.
    const auto free = [](const auto& p) {
      return p.sigma_re * p.sigma_im * std::sqrt(1 - p.correlation * p.correlation);
    };
    EXPECT_NEAR(free(after), free(before), 1e-9 * free(before));
  }
  told.sensor_delay = std::numeric_limits<double>::infinity();
  EXPECT_THROW(static_cast<void>(frac::response({noisy}, told)), std::invalid_argument);
}

TEST(Gaps, AreRefusedWhereNothingGoesOnOverThem) {
  std::mt19937_64 generator(3);
  std::normal_distribution<double> normal;
  const auto noise = sampled(600, [&](double) { return normal(generator); });
  EXPECT_THROW(static_cast<void>(frac::response({without(Record(1, noise, {noise}), {{300, 5}})})),
               std::invalid_argument);
  for (const frac::RecordGap& gap : {frac::RecordGap{0, 1}, frac::RecordGap{600, 1}, frac::RecordGap{5, 0}})
    EXPECT_THROW(Record(1, noise, {noise}, {}, {gap}), std::invalid_argument);
  EXPECT_THROW(Record(1, noise, {noise}, {}, {{9, 1}, {9, 1}}), std::invalid_argument);
}

TEST(Clipping, IsSaidOfSignalsThatStayAtALimit) {
  const auto sine = sampled(5000, [](double t) { return std::sin(0.0377 * t); });
  const auto at_most = [&](double limit, double step) {
    return through(sine, [=](double u) { return step * std::round(std::clamp(u, -limit, limit) / step); });
  };
  EXPECT_FALSE(frac::is_clipped(sine));
  for (const double bits : {6, 8, 10, 12}) EXPECT_FALSE(frac::is_clipped(at_most(1, std::pow(2, -bits)))) << bits;
  EXPECT_TRUE(frac::is_clipped(at_most(0.95, 1.0 / 128)));
  EXPECT_TRUE(frac::is_clipped(at_most(0.99, 1e-9)));
  EXPECT_FALSE(frac::is_clipped(through(sine, [](double u) { return u > 0 ? 1.0 : -1.0; })));
}

bool says_folding(const frac::ResponseEstimate& found) {
  return std::any_of(found.remarks.begin(), found.remarks.end(),
                     [](const auto& remark) { return remark.find("aliasing") != std::string::npos; });
}

// A linear machine has no lines up to half the sampling rate; each record may be called so once in 1000: 0.1 of 90
// stepped sines and 0.2 of 180 multisines, of which 2 are four deviations or more.  A relay, whose
// harmonics fall as 1/k, has them: its eighth or thirteenth harmonic is ten times the noise of a line or more.
TEST(Aliasing, IsSaidOfHarmonicsAtHalfTheSamplingRate) {
  std::mt19937_64 generator(41);
  int stepped = 0, periodic = 0;
  for (int seed = 0; seed < 30; ++seed)
    for (const auto which : {RecordCase::stepped, RecordCase::stepped_coloured, RecordCase::stepped_jitter,
                             RecordCase::white, RecordCase::coloured, RecordCase::input_noise, RecordCase::closed_loop,
                             RecordCase::jitter, RecordCase::transient}) {
      ResponseOptions options;
      options.excitation = support::is_stepped(which) ? Excitation::stepped_sine : Excitation::periodic;
      if (!support::is_stepped(which)) options.period = 128;
      const bool said = says_folding(frac::response({support::simulated_record(which, 10, generator)}, options));
      (support::is_stepped(which) ? stepped : periodic) += said ? 1 : 0;
    }
  EXPECT_LE(stepped, 2);
  EXPECT_LE(periodic, 2);
  std::normal_distribution<double> normal;
  for (int seed = 0; seed < 20; ++seed) {
    const auto input = sampled(2000, [](double t) { return std::sin(2 * pi * t / 16.3 + 0.2); });
    const auto relay = through(input, [&](double u) { return (u > 0 ? 1.0 : -1.0) + 0.05 * normal(generator); });
    EXPECT_TRUE(says_folding(frac::response({Record(1, input, {relay})})));
    const auto sines = Multisine::random(100, lines_to(10), generator);
    const auto drive = sampled(2000, [&](double t) { return sines.value(t); });
    const auto switched = through(drive, [&](double u) { return (u > 0 ? 1.0 : -1.0) + 0.05 * normal(generator); });
    EXPECT_TRUE(says_folding(frac::response({Record(1, drive, {switched})})));
  }
}

// Signals of a converter of so many bits (0: none), with noise of some of its steps: a sine of 200 samples per cycle,
// the staircase of a held command, a hammer that hits now and then, noise that is low in frequency.
std::vector<double> reading(int kind, int bits, double noise_steps, std::mt19937_64& generator) {
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> unit(0, 1);
  const double step = std::pow(2.0, -bits), phase = 6 * unit(generator);
  double low = 0, lower = 0, held = 0;
  return sampled(5000, [&](double t) {
    low = 0.99 * low + normal(generator);
    lower = 0.99 * lower + 0.001 * low;
    if (std::fmod(t, 20) == 0) held = unit(generator);
    const double since = std::fmod(t, 700) - 300;
    const double value = kind == 0   ? std::sin(0.0314159 * t + phase)
                         : kind == 1 ? held
                         : kind == 2 ? (since >= 0 && since < 6 ? std::sin(0.6 * since) : 0.0)
                                     : lower;
    const double noisy = value + noise_steps * step * normal(generator);
    return bits > 0 ? step * std::round(noisy / step) : noisy;
  });
}

// No false alarm in 1040 readings that stand still by nature.  Stuck ones are found, and where they are, but where the
// sine has come back to within four steps by the end: x(t + 20) - x(t) goes as 0.62 cos, which at 8 bits lies within
// four of its 158 steps in 1.6 % of all cases, in longer standstills and finer steps less often.  Of 200 these are 3.2,
// and four deviations more are 10.
TEST(StuckSamples, AreFoundAndNothingElseIs) {
  std::mt19937_64 generator(31);
  std::uniform_real_distribution<double> unit(0, 1);
  for (int kind = 0; kind < 4; ++kind)
    for (const int bits : {0, 8, 12, 16})
      for (const double noise : {0.0, 0.3, 1.0, 3.0}) {
        if (bits == 0 && noise > 0) continue;
        for (int seed = 0; seed < 20; ++seed)
          EXPECT_FALSE(frac::stuck_samples(reading(kind, bits, noise, generator))) << kind << bits << noise;
      }
  for (const std::size_t count : {20U, 100U})
    for (const int bits : {0, 8, 12, 16}) {
      int found = 0;
      for (int seed = 0; seed < 200; ++seed) {
        auto signal = reading(0, bits, bits == 0 ? 0 : 0.3, generator);
        const auto first = static_cast<std::size_t>(100 + 4500 * unit(generator));
        for (std::size_t i = 0; i < count; ++i) signal[first + i] = signal[first];
        const auto stuck = frac::stuck_samples(signal);
        // Samples before and after may have the same reading.
        if (stuck && stuck->first <= first && stuck->first + stuck->count >= first + count) ++found;
      }
      EXPECT_GE(found, 190) << bits << " " << count;
    }
}

// The instants of pulses of one sample, which come at the first sample after a passage, are known to half a sample, and
// so are those of a line through them; of a sine chords err by h^3 sqrt(3)/108 rad, h = 2 pi/37.3.
TEST(Trigger, TellsPeriodAndPhase) {
  const double period = 37.3, phase = 0.5;
  const auto turns = [&](double t) { return t / period + phase / (2 * pi); };
  const auto pulses =
      sampled(4000, [&](double t) { return std::floor(turns(t)) > std::floor(turns(t - 1)) ? 5.0 : 0.1; });
  const auto sine = sampled(4000, [&](double t) { return std::sin(2 * pi * turns(t)); });
  for (const auto* trigger : {&pulses, &sine}) {
    const auto instants = frac::trigger_instants(*trigger);
    ASSERT_NEAR(static_cast<double>(instants.size()), 107, 1);
    const double half = trigger == &pulses ? 0.5 : 0.001;
    for (const double each : instants) {
      const double turn = turns(each);
      EXPECT_LE(std::abs(turn - std::round(turn)) * period, half + 1e-9);
    }
    // A mean of 107 instants errs by 0.29 samples over the root of 107; four of it.
    const auto cosine = frac::cosine_of(instants, sine);
    for (std::size_t i = 0; i < 4000; i += 13)
      EXPECT_NEAR(cosine[i], std::cos(2 * pi * turns(static_cast<double>(i))), 2 * pi / period * 4 * 0.29 / 10.3);
    const auto found = frac::period_of(sine, instants);
    ASSERT_TRUE(found);
    EXPECT_NEAR(*found, period, 1e-3);
  }
  // A frequency that rises by a fifth: the phase follows, half a sample beside it at most where the pulse is; between
  // pulses the frequency changes by 0.2/120 of itself, which turns by 2 pi 0.2/120/8.
  const auto rising = [&](double t) { return t / period * (1 + 0.1 * t / 4000); };
  const auto swept =
      sampled(4000, [&](double t) { return std::floor(rising(t)) > std::floor(rising(t - 1)) ? 1.0 : 0.0; });
  const auto instants = frac::trigger_instants(swept);
  EXPECT_FALSE(frac::period_of(swept, instants));
  const auto cosine = frac::cosine_of(instants, swept);
  for (std::size_t i = 40; i < 3950; ++i)
    EXPECT_NEAR(cosine[i], std::cos(2 * pi * rising(static_cast<double>(i))), 2 * pi * 1.2 / period * 0.5 + 0.002) << i;
  EXPECT_THROW(static_cast<void>(frac::trigger_instants({0, 1, 0, 0, 1, 0})), std::invalid_argument);
}

// Of 1000 loops over three periods this one has noise on line 53 that stands above that of the input with the chance
// that a line is allowed; it goes round the loop, and its ratio would be that of the controller, -2, with a deviation
// of rounding.  The 40 lines that are driven remain, but for those at the peak that the loop leaves an eighth of the
// others.
TEST(PeriodicResponse, NoiseThatGoesRoundALoopIsNoLine) {
  std::mt19937_64 generator(300'828);
  const Record record = support::simulated_record(RecordCase::closed_loop, 3, generator);
  ResponseOptions options;
  options.period = 128;
  const auto found = frac::response({record}, options);
  EXPECT_GE(found.outputs[0].size(), 38U);
  for (const auto& point : found.outputs[0]) EXPECT_LT(point.omega * 128 / (2 * pi), 40.5);
}

// Noise under a period that is told: no line is above it, with a chance of 1e-3 to be wrong.
TEST(PeriodicResponse, SaysWhereTheInputIsNoiseAlone) {
  std::mt19937_64 generator(11);
  std::normal_distribution<double> normal;
  const auto noise = sampled(1280, [&](double) { return normal(generator); });
  ResponseOptions options;
  options.period = 128;
  const auto found = frac::response({Record(1, noise, {noise})}, options);
  EXPECT_FALSE(found.usable());
  ASSERT_EQ(found.remarks.size(), 1U);
  EXPECT_NE(found.remarks[0].find("no line of the input stands above its noise"), std::string::npos);
}

TEST(Record, RefusesWhatIsNoRecord) {
  const std::vector<double> good = sampled(20, [](double t) { return std::sin(t); });
  auto bad = good;
  bad[7] = NAN;
  EXPECT_THROW(Record(0, good, {good}), std::invalid_argument);
  EXPECT_THROW(Record(1, good, {}), std::invalid_argument);
  EXPECT_THROW(Record(1, good, {bad}), std::invalid_argument);
  EXPECT_THROW(Record(1, std::vector<double>(20, 3.0), {good}), std::invalid_argument);
  EXPECT_THROW(Record(1, good, {std::vector<double>(19)}), std::invalid_argument);
  EXPECT_THROW(Record(1, {1, 2, 3}, {{1, 2, 3}}), std::invalid_argument);
  ResponseOptions options;
  options.period = 12;
  EXPECT_THROW(static_cast<void>(frac::response({Record(1, good, {good})}, options)), std::invalid_argument);
  EXPECT_THROW(static_cast<void>(frac::response({})), std::invalid_argument);
}

}  // namespace
