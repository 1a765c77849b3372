// SPDX-License-Identifier: BSD-3-Clause
// What is measured of a system: points, noise, and the standard deviations that the noise really has.
#pragma once

#include <complex>
#include <string>
#include <vector>

#include "benchmarks/judging/random_numbers.hpp"
#include "benchmarks/judging/systems.hpp"

namespace judging {

/// How a file is measured.
struct Setting {
  int points = 60;
  double decades = 4;
  bool imaginary_only = false;
  /// `none`, `relative`, `additive`, `mixed`, `correlated`, `outliers`, `rounded` or `smooth`.
  std::string noise = "none";
  /// Root mean square of the complex error over |G| (over the median of |G| for `additive`; of the smooth one for
  /// `smooth`).
  double level = 0;
  /// The same of the white noise beside a smooth error.
  double beside = 0;
};

struct Curve {
  Setting setting;
  std::vector<double> omega;
  std::vector<Complex> exact;
  std::vector<Complex> measured;
  /// True standard deviations of the real and of the imaginary part; outliers and smooth errors do not count.
  std::vector<double> sigma_real;
  std::vector<double> sigma_imaginary;
  /// Correlation of neighbouring errors.
  double correlation = 0;
  /// Share of points that are no outliers.
  double sound = 1;
};

/// Points of `system` around its action, logarithmic or not quite, with noise.
Curve measure(const System& system, const Setting& setting, RandomNumbers& random);

}  // namespace judging
