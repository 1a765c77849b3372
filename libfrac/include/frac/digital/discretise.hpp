// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <complex>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "frac/approximation/approximate.hpp"

namespace frac {

/// How a continuous-time operator becomes a recursion in the samples.  tan x/x stands for the stretching of the
/// frequency axis by the bilinear rule, x = omega T/2.
enum class Discretisation {
  /// Designed in z: sections by the backward difference, and ahead of them some taps that make up for the gain and the
  /// phase of that rule up to the edge of the band.  The default.
  direct,
  /// Bilinear rule: the gain of s^a is (tan x/x)^a too large, its phase exact.
  tustin,
  /// The same times the factor that makes it exact at the upper edge of the band.
  tustin_prewarped,
  /// s = 8 (z - 1)/(7 T (z + 1/7)), Al-Alaoui (1993); for comparison.
  al_alaoui,
  /// The first `memory_length` + 1 weights of (1 - 1/z)^a as a transversal filter; for comparison.
  grunwald_letnikov,
};

/// Names as on the command line: direct, tustin, tustin-prewarped, al-alaoui, grunwald-letnikov.
[[nodiscard]] std::string_view to_string(Discretisation method);
/// @throws std::invalid_argument  unknown name; the text lists the known ones.
[[nodiscard]] Discretisation discretisation_from_string(std::string_view text);
[[nodiscard]] std::span<const Discretisation> discretisations();

/// First-order section 1 + feed/(z - 1 + rate):   y = x + feed v,   v += x - rate v.
/// The distance `rate` of the pole from z = 1 is kept, never the pole itself, so that slow sections lose no digits.
struct DeltaSection {
  double rate;
  double feed;
};

/// gain times the product of first-order sections.
struct DeltaCascade {
  double gain = 1;
  std::vector<DeltaSection> sections;
};

/// What the sum of parallel sections is taken over.
enum class SectionOutput {
  /// y = direct x + sum weight v.
  state,
  /// y = direct x + sum weight (x - rate v); `direct` is the gain at omega = 0, exactly.
  change,
};

/// First-order sections v += x - rate v side by side.  Of the two outputs that one is used whose terms cancel less.
struct ParallelSections {
  SectionOutput output = SectionOutput::state;
  double direct = 0;
  std::vector<double> rates;  // in (0, 2)
  std::vector<double> weights;

  /// Transfer function at z = 1 + delta.
  [[nodiscard]] std::complex<double> response(std::complex<double> delta) const;
};

/// A rational function in first-order sections, by the bilinear rule (or Al-Alaoui's).
struct DigitalSections {
  DeltaCascade cascade;
  ParallelSections parallel;
};

/// @param method  tustin or al_alaoui.
/// @throws std::invalid_argument  a zero or pole not real, negative and finite (a zero may be 0), numbers of zeros and
/// poles different, poles not distinct, integer_order not 0, sample_time not positive and finite, another method.
[[nodiscard]] DigitalSections discretise(const ZeroPoleGain& system, double sample_time,
                                         Discretisation method = Discretisation::tustin);

/// s^order for samples every sample_time seconds,
///   H(z) = ((1 - 1/z)/T)^differences (T/2 (z + 1)/(z - 1))^integrators (sum taps_k z^-k) F(z),
/// the whole part trunc(order) as differences (order > 0; the bilinear rule would put poles on z = -1) or trapezoidal
/// integrators (order < 0), and F in first-order sections in either form, cascade or parallel.  Stable: all rates are
/// in (0, 2).
struct DigitalPower {
  /// The tolerance is kept, where one was asked for.
  [[nodiscard]] bool usable() const noexcept { return status != ApproximationStatus::not_attainable; }
  /// Order, band, sample time, method, states and error.
  [[nodiscard]] std::string summary() const;

  double order;
  /// As asked, rad/s.
  FrequencyBand band;
  /// s.
  double sample_time;
  Discretisation method;
  /// Design of the fractional part, in the variable that the rule puts for s, on the band as it is in that variable.
  Approximation prototype = {};
  int differences = 0;
  int integrators = 0;
  DeltaCascade cascade = {};
  ParallelSections parallel = {.output = SectionOutput::state, .direct = 1, .rates = {}, .weights = {}};
  /// Used by `direct`, and by `grunwald_letnikov`, which has no sections.
  std::vector<double> taps = {1};
  /// Deviation of H(e^{j omega T})/(j omega)^order from 1 on the band.
  ApproximationError error = {};
  /// Largest |H| between the upper edge of the band and pi/T, divided by |(j omega)^order|; for a falling power, by its
  /// value at the edge.
  double most_amplification = 1;
  ApproximationStatus status = ApproximationStatus::as_asked;
  /// One sentence.
  std::string message = {};

  /// H(e^{j omega T}), omega in rad/s, in (0, pi/T).
  [[nodiscard]] std::complex<double> response(double omega) const;
};

/// @param band  upper edge below pi/T; for `direct` at most pi/(2 T), a quarter of the sampling frequency.
/// @param memory_length  of grunwald_letnikov, 1 to 10^7 samples.
/// @param most_amplification  of `direct`, 1.1 to 1000: bound of the gain beyond the band, with which accuracy up to
/// its edge is paid.  The least that the tolerance takes is used.  Up to about 1.5 the answer to a step hardly rings
/// from sample to sample.
/// @throws std::invalid_argument  as approximate(); order not within (-8, 8); an argument out of range; band and sample
/// time too close to each other: the text gives them and what is allowed.
[[nodiscard]] DigitalPower digital_power(double order, FrequencyBand band, ApproximationGoal goal, double sample_time,
                                         Discretisation method = Discretisation::direct,
                                         ApproximationMethod approximation = ApproximationMethod::ladder,
                                         std::size_t memory_length = 1000, double most_amplification = 5);

}  // namespace frac
