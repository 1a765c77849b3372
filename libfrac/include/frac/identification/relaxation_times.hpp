// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "frac/identification/fit.hpp"
#include "frac/model/frequency_response_data.hpp"
#include "frac/structure.hpp"

namespace frac {

/// What a relaxation time tau of density g(ln tau) >= 0 contributes to a response.
enum class TimesKernel {
  falling,  // g/(1 + s tau): impedance, compliance, permittivity
  rising,   // g s tau/(1 + s tau): modulus, admittance
};
[[nodiscard]] std::string_view to_string(TimesKernel kernel);

/// A time of its own: a pole on the negative real axis.
struct TimesLine {
  double tau;                                           // s
  double area;                                          // in the unit of the response
  double tau_lower, tau_upper, area_lower, area_upper;  // see relaxation_times(), NaN where unknown
};

/// A maximum of the density between its minima.
struct TimesPeak {
  double tau;   // s, of the maximum
  double area;  // between the minima; of a formula to six decades beyond the times asked for, of data within the band
  double tau_lower, tau_upper, area_lower, area_upper;  // see relaxation_times(), NaN where unknown
};

/// Distribution of relaxation or retardation times:
///
///     Z(s) = constant + inductance s + elastance/s + sum over lines + integral g(ln tau)/(1 + s tau) d ln tau
struct TimesDistribution {
  TimesKernel kernel;
  std::vector<double> tau;           // s, rising
  std::vector<double> density;       // g per e-fold of tau, in the unit of the response
  std::vector<double> lower, upper;  // at each tau, see relaxation_times(); empty where unknown
  std::vector<TimesLine> lines;
  std::vector<TimesPeak> peaks;
  std::size_t lines_left_off;              // of a formula: the shortest of a series of more than a thousand
  double constant, inductance, elastance;  // of data only, NaN of a formula
  double constant_lower, constant_upper, inductance_lower, inductance_upper;  // see relaxation_times()
  double elastance_lower, elastance_upper;
  double smoothness;       // of data only: weight of the roughness, that is of the squared second differences
  double misfit;           // of data only: rms of what the distribution leaves, relative to |Z| at each frequency
  double misfit_in_noise;  // of data only: rms of what it leaves of each part, in standard deviations of the noise
  /// Whether it follows the data: to within 1 %, which times on a grid leave of exact data, or to within twice their
  /// noise where that leaves a response to speak of.  False of a formula.
  [[nodiscard]] bool follows_data() const;
};

/// Exactly, from the two sides of the cut of a formula along the negative real axis: g = -(1/pi) Im Z(e^{j pi}/tau),
/// and from its poles there.  Poles elsewhere (resonances) are no relaxation times and are not part of the result.
/// Lines and peaks are all those between the first and the last time, whichever are asked for between; of series of
/// more than a thousand lines the shortest are only counted.
/// @param tau  s, positive and rising, at least three
/// @throws std::invalid_argument  wrong number of parameters, or tau
[[nodiscard]] TimesDistribution relaxation_times(const Structure& structure, std::span<const double> parameters,
                                                 std::span<const double> tau, TimesKernel kernel);

/// The same of a fit, with 95 % intervals by linear propagation of its covariance and Student's t.
[[nodiscard]] TimesDistribution relaxation_times(const FitResult& fit, std::span<const double> tau, TimesKernel kernel);

/// From data without a model: the density of least misfit and roughness that is nowhere negative, beside the three
/// ends, none negative either, on 12 times per decade from 1.5 decades beyond the band, where it only falls: a peak
/// there would be a second constant (inductance, elastance), which data do not tell from the first.  The noise is that
/// of validate(), the weight of the roughness that of the largest evidence, the roughness relative to the density.
/// Bands and intervals hold 95 % of the solutions of data and prior moved by their noise (Bardsley, Fox 2012): they are
/// those of a density as smooth as the prior has it, and hold less of a line or of an arc that is nearly one
/// (tools/docs/times_coverage.md).
/// @throws std::invalid_argument  fewer than 6 points, or all at one frequency
[[nodiscard]] TimesDistribution relaxation_times(const FrequencyResponseData& data, TimesKernel kernel,
                                                 std::uint64_t seed = 1);

}  // namespace frac
