// SPDX-License-Identifier: BSD-3-Clause
#include "io/sweep_file.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>

#include "io/frequency_response_file.hpp"
#include "temporary_folder.hpp"

namespace {

backlash::DescribingFunctionSweep example() {
  backlash::SweepOptions options;
  options.protocol = backlash::Protocol::sweep_down;
  options.output = backlash::Output::x2;
  options.tolerance = 1e-9;
  backlash::DescribingFunctionSweep sweep{backlash::TwoMassSystem(1.0 / 3, 2, 0.3, 0.6), 40.1, options, {}};
  constexpr double infinity = std::numeric_limits<double>::infinity();
  constexpr double none = std::numeric_limits<double>::quiet_NaN();
  sweep.points = {{0.1, {-1.0 / 3, 2.0 / 7}, backlash::Regime::chatter, 1, infinity, 1e-17, 0.1},
                  {0.3, {1e-300, -5e-324}, backlash::Regime::averaged, 0, 2.5, 1e-3, 1.0 / 9},
                  {7, {-0.0, 0}, backlash::Regime::free, 1, 0, 0, none}};
  return sweep;
}

TEST(SweepFile, ReadsBackExactlyWhatWasWritten) {
  const TemporaryFolder folder;
  const auto sweep = example();
  const auto back = io::read_sweep(folder.write("sweep.csv", io::sweep_csv(sweep, "fracfit simulate --force 40.1")));
  EXPECT_EQ(back.system.mass1(), sweep.system.mass1());
  EXPECT_EQ(back.system.mass2(), sweep.system.mass2());
  EXPECT_EQ(back.system.clearance(), sweep.system.clearance());
  EXPECT_EQ(back.system.restitution(), sweep.system.restitution());
  EXPECT_EQ(back.force_amplitude, sweep.force_amplitude);
  EXPECT_EQ(back.options.protocol, sweep.options.protocol);
  EXPECT_EQ(back.options.output, sweep.options.output);
  EXPECT_EQ(back.options.tolerance, sweep.options.tolerance);
  ASSERT_EQ(back.points.size(), sweep.points.size());
  for (std::size_t i = 0; i < sweep.points.size(); ++i) {
    EXPECT_EQ(back.points[i].omega, sweep.points[i].omega);
    EXPECT_EQ(back.points[i].value, sweep.points[i].value);
    EXPECT_EQ(back.points[i].regime, sweep.points[i].regime);
    EXPECT_EQ(back.points[i].period, sweep.points[i].period);
    EXPECT_EQ(back.points[i].impacts_per_period, sweep.points[i].impacts_per_period);
    EXPECT_EQ(back.points[i].uncertainty, sweep.points[i].uncertainty);
    EXPECT_EQ(std::isnan(back.points[i].third_harmonic_ratio), std::isnan(sweep.points[i].third_harmonic_ratio));
    if (!std::isnan(sweep.points[i].third_harmonic_ratio)) {
      EXPECT_EQ(back.points[i].third_harmonic_ratio, sweep.points[i].third_harmonic_ratio);
    }
  }
}

TEST(SweepFile, DiagnosticsFollowTheBasicColumnsAndAreReadBack) {
  const TemporaryFolder folder;
  auto sweep = example();
  sweep.options.mean_tolerance = 0.01;
  for (auto& point : sweep.points) {
    point.even_harmonic_ratio = 1.0 / 3;
    point.energy_defect = 1e-15;
    point.lyapunov_exponent = -std::numeric_limits<double>::infinity();
    point.periods_followed = 1280;
    point.transient_possible = true;
    point.force_sensitivity = 1e9;
  }
  const std::string text = io::sweep_csv(sweep, "fracfit simulate", io::PointColumns::with_diagnostics);
  EXPECT_NE(text.find("third_harmonic_ratio,even_harmonic_ratio,energy_defect,lyapunov_exponent,"
                      "periods_followed,transient_possible,force_sensitivity\n"),
            std::string::npos);
  const auto back = io::read_sweep(folder.write("sweep.csv", text));
  EXPECT_EQ(back.options.mean_tolerance, 0.01);
  ASSERT_EQ(back.points.size(), sweep.points.size());
  for (std::size_t i = 0; i < back.points.size(); ++i) {
    EXPECT_EQ(back.points[i].value, sweep.points[i].value);
    EXPECT_EQ(back.points[i].even_harmonic_ratio, 1.0 / 3);
    EXPECT_EQ(back.points[i].energy_defect, 1e-15);
    EXPECT_EQ(back.points[i].lyapunov_exponent, -std::numeric_limits<double>::infinity());
    EXPECT_EQ(back.points[i].periods_followed, 1280);
    EXPECT_TRUE(back.points[i].transient_possible);
    EXPECT_EQ(back.points[i].force_sensitivity, 1e9);
  }
}

TEST(SweepFile, IsAcceptedAsMeasuredData) {
  const TemporaryFolder folder;
  const auto sweep = example();
  const auto file = io::read_frequency_response(folder.write("sweep.csv", io::sweep_csv(sweep, "fracfit simulate")));
  ASSERT_EQ(file.data.size(), sweep.points.size());
  for (std::size_t i = 0; i < sweep.points.size(); ++i) EXPECT_EQ(file.data.value()[i], sweep.points[i].value);
  EXPECT_EQ(file.value_unit, "m_per_n");
  EXPECT_EQ(io::find_value(file.metadata, "force_n"), "40.1");
  EXPECT_EQ(io::find_value(file.metadata, "fracfit"), io::version());
}

TEST(SweepFile, ColumnsAreThoseOfTheContract) {
  const auto text = io::sweep_csv(example(), "x");
  EXPECT_NE(text.find("\nomega_rad_s,re_m_per_n,im_m_per_n,regime,period,impacts_per_period,uncertainty_m_per_n,"
                      "third_harmonic_ratio\n"),
            std::string::npos);
  const auto curve = io::static_curve_csv({1, 1, 0.3, 40, {2}, {{1, 2}}}, "x");
  EXPECT_NE(curve.find("third_harmonic_ratio\n2,1,2,static,nan,nan,nan,nan\n"), std::string::npos) << curve;
}

TEST(SweepFile, WhatIsMissingOrWrongIsNamed) {
  const TemporaryFolder folder;
  const auto error_after = [&](const std::string& from, const std::string& to) -> std::string {
    auto text = io::sweep_csv(example(), "x");
    const auto at = text.find(from);
    if (at == std::string::npos) return "'" + from + "' is not in the file";
    text.replace(at, from.size(), to);
    try {
      (void)io::read_sweep(folder.write("sweep.csv", text));
    } catch (const io::DataError& error) {
      return error.what();
    }
    return "no error";
  };
  const auto expect = [&](const std::string& from, const std::string& to, const std::string& part) {
    EXPECT_NE(error_after(from, to).find(part), std::string::npos) << error_after(from, to);
  };
  expect("# force_n: 40.1\n", "", "no header line '# force_n: ...'");
  expect("# force_n: 40.1", "# force_n: much", "found 'much' for force_n");
  expect("# restitution: 0.6", "# restitution: 1.6", "restitution");
  expect("# protocol: sweep-down", "# protocol: sideways", "protocol");
  expect("# model: dynamic", "# model: static", "expected dynamic");
  expect(",regime,", ",phase,", "found columns");
  expect("chatter,1,", "chattering,1,", "sweep.csv:13:");
  expect("chatter,1,", "chatter,one,", "whole number");
}

}  // namespace
