// SPDX-License-Identifier: BSD-3-Clause
#include "io/point_filter.hpp"

#include <gtest/gtest.h>

#include <complex>
#include <numbers>
#include <stdexcept>

TEST(PointFilter, ComparesEachQuantity) {
  const std::complex<double> value(3, -4);
  const double omega = 2 * std::numbers::pi;  // 1 Hz
  EXPECT_TRUE(io::PointFilter("im<0")(omega, value));
  EXPECT_TRUE(io::PointFilter("re == 3")(omega, value));
  EXPECT_TRUE(io::PointFilter("magnitude>=5")(omega, value));
  EXPECT_FALSE(io::PointFilter("magnitude>5")(omega, value));
  EXPECT_TRUE(io::PointFilter("omega<=6.3")(omega, value));
  EXPECT_FALSE(io::PointFilter("omega<=6.28")(omega, value));
  EXPECT_TRUE(io::PointFilter("f<=1")(omega, value));
  EXPECT_FALSE(io::PointFilter("f!=1")(omega, value));
}

TEST(PointFilter, EachOperatorDiffersAtEquality) {
  const auto at_equality = [](const char* text) { return io::PointFilter(text)(1, {2, 0}); };
  EXPECT_FALSE(at_equality("re<2"));
  EXPECT_TRUE(at_equality("re<=2"));
  EXPECT_FALSE(at_equality("re>2"));
  EXPECT_TRUE(at_equality("re>=2"));
  EXPECT_TRUE(at_equality("re==2"));
  EXPECT_FALSE(at_equality("re!=2"));
}

TEST(PointFilter, AnythingElseIsRefused) {
  for (const char* text : {"", "im", "<0", "im<", "im<abc", "im<nan", "im=0", "im<>0", "phase<high", "im==high",
                           "force=!1", "im<0<1", "0<im", "im<0 and re>0"})
    EXPECT_THROW(io::PointFilter{text}, std::invalid_argument) << text;
}

TEST(SampleFilter, ComparesEachQuantity) {
  EXPECT_TRUE(io::SampleFilter("t < 40")(39, 0, 0));
  EXPECT_FALSE(io::SampleFilter("input!=2")(0, 2, 0));
  EXPECT_TRUE(io::SampleFilter("output>=-1")(0, 0, -1));
  for (const char* text : {"omega<x", "t", "<4", "t<x", "t==x"})
    EXPECT_THROW(io::SampleFilter{text}, std::invalid_argument) << text;
}
