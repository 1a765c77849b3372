// SPDX-License-Identifier: BSD-3-Clause
#include "frac/records/sensor.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "support/expect_invalid_argument.hpp"

namespace {

using frac::sampling_instants;
using frac::sensor_readings;
using frac::SensorErrors;
using frac::SignalPath;
using std::numbers::pi;
using support::expect_invalid_argument;

// sin t by a hundred entries per period.
SignalPath sine_path() {
  SignalPath path;
  for (int i = 0; i <= 1000; ++i) {
    const double t = 2 * pi * i / 100;
    path.add(t, std::sin(t), std::cos(t));
  }
  return path;
}

double mean_square(const std::vector<double>& values) {
  double sum = 0;
  for (const double value : values) sum += value * value / static_cast<double>(values.size());
  return sum;
}

std::vector<double> less(std::vector<double> values, const std::vector<double>& others) {
  for (std::size_t i = 0; i < values.size(); ++i) values[i] -= others[i];
  return values;
}

const std::vector<double>& instants() {
  static const auto all = sampling_instants(2, 0.0137, 4000, 0, 1);
  return all;
}

std::vector<double> sine_at(const std::vector<double>& times, double delay = 0) {
  std::vector<double> values;
  for (const double t : times) values.push_back(std::sin(t - delay));
  return values;
}

// The cubic of a step h errs by h^4/384 at most: (2 pi/100)^4/384 = 4.06e-8.  A delay is a shift of the argument.
TEST(Sensor, ReadsASignalAndADelayedOne) {
  const double bound = std::pow(2 * pi / 100, 4) / 384;
  for (const double delay : {0.0, 0.7}) {
    SensorErrors errors;
    errors.delay = delay;
    const auto error = less(sensor_readings(sine_path(), instants(), errors, 1), sine_at(instants(), delay));
    EXPECT_LE(std::sqrt(mean_square(error)), bound);
    EXPECT_LE(std::abs(*std::max_element(error.begin(), error.end())), 1.01 * bound);
  }
}

// A parabola between two jumps is met exactly, and a jump is none of its smoothing.
TEST(Sensor, KeepsJumps) {
  SignalPath path;
  path.add(0, 0, 0);
  path.add(1, 1, 2);
  path.add(1, 5, -1);
  path.add(2, 4, -1);
  const auto found = sensor_readings(path, {0, 0.5, 0.999, 1, 1.5, 2}, {}, 1);
  const std::vector<double> expected{0, 0.25, 0.998001, 5, 4.5, 4};
  for (std::size_t i = 0; i < expected.size(); ++i) EXPECT_NEAR(found[i], expected[i], 1e-15 * 8) << i;
}

// White noise of deviation s: the mean square of n readings is s^2 to within 4 sqrt(2/n), and neighbours have no
// correlation to within 4/sqrt(n).
TEST(Sensor, NoiseHasItsDeviationAndIsWhite) {
  SensorErrors errors;
  errors.noise = 0.03;
  const auto noise = less(sensor_readings(sine_path(), instants(), errors, 5), sine_at(instants()));
  const double n = static_cast<double>(noise.size()), variance = mean_square(noise);
  EXPECT_NEAR(variance / (0.03 * 0.03), 1, 4 * std::sqrt(2 / n));
  double correlation = 0;
  for (std::size_t i = 1; i < noise.size(); ++i) correlation += noise[i] * noise[i - 1] / (n * variance);
  EXPECT_NEAR(correlation, 0, 4 / std::sqrt(n));
  EXPECT_EQ(sensor_readings(sine_path(), instants(), errors, 5), sensor_readings(sine_path(), instants(), errors, 5));
  EXPECT_NE(sensor_readings(sine_path(), instants(), errors, 5), sensor_readings(sine_path(), instants(), errors, 6));
}

// Readings are multiples of the step, off by half of one at most; that error is nearly uniform: q^2/12, and its mean
// square over n readings scatters by sqrt(4/5/n) of that.
TEST(Sensor, QuantisationRoundsToMultiplesOfTheStep) {
  SensorErrors errors;
  errors.quantisation = 0.01;
  const auto readings = sensor_readings(sine_path(), instants(), errors, 1);
  for (const double reading : readings) EXPECT_NEAR(reading / 0.01, std::round(reading / 0.01), 1e-10);
  const auto error = less(readings, sine_at(instants()));
  EXPECT_LE(*std::max_element(error.begin(), error.end()), 0.005 + 1e-7);
  EXPECT_NEAR(mean_square(error) / (0.01 * 0.01 / 12), 1, 4 * std::sqrt(0.8 / static_cast<double>(error.size())));
}

TEST(Sensor, ClipsAtItsLimit) {
  SensorErrors errors;
  errors.clip = 0.5;
  const auto readings = sensor_readings(sine_path(), instants(), errors, 1);
  EXPECT_EQ(*std::max_element(readings.begin(), readings.end()), 0.5);
  EXPECT_EQ(*std::min_element(readings.begin(), readings.end()), -0.5);
  // Above 1/2 in absolute value a sine is for two thirds of the time; 55 s are 8.7 periods, whose ends make 0.3/8.7.
  const auto at_limit = std::count_if(readings.begin(), readings.end(), [](double x) { return std::abs(x) == 0.5; });
  EXPECT_NEAR(static_cast<double>(at_limit) / static_cast<double>(readings.size()), 2.0 / 3, 0.04);
}

// An instant that errs by j reads a signal off by j times its rate, whose mean square is 1/2; of n readings the mean
// square scatters by sqrt((3 * 3/8 - 1/4)/n)/(1/2), 1.87/sqrt(n).
TEST(Sensor, JitterOfTheClockShowsAsTheRateOfTheSignal) {
  const auto jittered = sampling_instants(2, 0.0137, 4000, 1e-3, 3);
  EXPECT_TRUE(std::is_sorted(jittered.begin(), jittered.end()));
  const auto error = less(sensor_readings(sine_path(), jittered, {}, 1), sine_at(instants()));
  EXPECT_NEAR(mean_square(error) / (1e-6 / 2), 1, 4 * 1.87 / std::sqrt(4000.0));
}

TEST(Sensor, RefusesWhatIsNoSensor) {
  const auto path = sine_path();
  const auto with = [&](double SensorErrors::*member, double value) {
    SensorErrors errors;
    errors.*member = value;
    return [=] { static_cast<void>(sensor_readings(path, instants(), errors, 1)); };
  };
  expect_invalid_argument(with(&SensorErrors::noise, -1), {"noise is -1", ">= 0"});
  expect_invalid_argument(with(&SensorErrors::delay, NAN), {"delay is nan"});
  expect_invalid_argument(with(&SensorErrors::quantisation, INFINITY), {"quantisation is inf"});
  expect_invalid_argument(with(&SensorErrors::clip, 0), {"clip is 0", "> 0"});
  expect_invalid_argument(with(&SensorErrors::delay, 3), {"instant 2 s less the delay"});
  expect_invalid_argument([&] { static_cast<void>(sensor_readings({}, instants(), {}, 1)); }, {"path has 0 times"});
  expect_invalid_argument([] { static_cast<void>(sampling_instants(0, 0, 5, 0, 1)); }, {"sample_time is 0"});
  expect_invalid_argument([] { static_cast<void>(sampling_instants(0, 1, 5, 0.2, 1)); },
                          {"clock_jitter is 0.2", "0 to 0.1 s"});
}

}  // namespace
