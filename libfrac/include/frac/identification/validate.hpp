// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <complex>
#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "frac/model/frequency_response_data.hpp"

namespace frac {

/// Whether data can be the response of one linear, causal, stable system that stayed the same during the measurement.
enum class Validity {
  valid,      // nothing that matters speaks against it
  suspect,    // single points do: outliers or mains; the others are consistent
  invalid,    // the points as a whole do, by more than matters: drift, or misses that follow each other
  undecided,  // band, points or noise leave too little to judge by
};
[[nodiscard]] std::string_view to_string(Validity validity);

/// What is tested.  The chance of each comes from the noise that the data themselves show.
enum class ValidityTest {
  neighbours,      // residuals of neighbouring points follow each other: no consistent response goes through the data
  neighbourhoods,  // the same over a twelfth of the points
  drift_even,      // the response scaled up or down during the sweep, each point taking as long as the others
  drift_periods,   // the same, each point taking as many periods as the others
  step,            // the response scaled up or down from one point on
  outliers,        // the largest residual
  // Where points are dense, the three nearest to each harmonic.
  mains_50,        // residuals within 2 % of 50 Hz, of its odd harmonics besides, or of its first ten
  mains_60,
};
[[nodiscard]] std::string_view to_string(ValidityTest test);

struct ValidityFinding {
  ValidityTest test;
  double p_value;  // chance of as much by noise alone; NaN where the test does not apply
  bool alarm;      // p_value < level / 10, so that all tests together keep the level
};

struct ValidationOptions {
  double level = 0.05;  // chance that data without a fault are not called valid, 0 < level < 1
  /// Systematic error of the instrument as share of the response, >= 0: residuals that are no larger (root mean square
  /// of all, or each single one) are no fault.  Exact data of a fractional system are followed to some 1e-5.
  double accuracy = 1e-4;
  /// Departures of the points as a whole that are significant but no larger, as share of the response, do not make the
  /// data invalid, >= 0; see ValidationResult::consistent_to.
  double tolerance = 1e-2;
  /// Of more points every k-th is judged, so that no more are left; 0: all are.
  std::size_t most_points = 0;
};
/// Points for which a judgement beside other work costs some hundredths of a second.
inline constexpr std::size_t points_in_passing = 120;

/// Kramers-Kronig consistency: the response of a linear, causal and stable system, its real and its imaginary part
/// together, is followed by a sum of poles
///
///     c_0 + c_1 s + c_2/s + sum r_k/(1 + s tau_k),   tau_k on a logarithmic grid, r_k of either sign
///
/// as closely as wanted, and real poles and pairs at free places take over where these do not follow the data
/// (resonances), times a dead time where the points ask for one.  The number of poles is that of the best AICc.  What
/// is left is noise if the data are consistent.  How much white noise such residuals show by themselves follows from
/// the projection that made them, in closed form.
///
/// An amplitude-dependent but stationary response can be consistent: linearity is tested only as far as it shows here.
struct ValidationResult {
  Validity validity;
  double level, accuracy, tolerance;  // as asked for
  std::vector<ValidityFinding> findings;
  double largest_residual;  // of the judged points, share of the model
  /// Whether the points as a whole depart from every consistent response by more than noise explains.
  bool departs;
  /// How far they may depart, share of the response, noise included: the largest root mean square of the residuals over
  /// a twelfth of the points, or a drift or step that explains them if that is larger.  NaN where nothing is
  /// judged.
  double consistent_to;

  std::size_t every = 1;                    // one point in so many was judged
  std::size_t real_poles, pole_pairs;       // of the consistent model
  double dead_time;                         // of it, s; 0: none is needed
  std::vector<std::complex<double>> model;  // NaN at points not judged or set aside
  std::vector<double> deviation;  // of the noise of real and imaginary part each, per point, in the unit of the data

  double noise;        // root mean square of deviation / |model| over the points
  double noise_floor;  // additive part of the noise relative to |model|: deviation ~ sqrt(|model|^2 + floor^2); 0: none
  double noise_slope;  // d ln deviation / d ln omega beside that; 0 where no slope is clear
  double correlation;  // of residuals of neighbouring points, less what white noise would show
  double drift;        // change of the response during the sweep, share of its size, towards low frequencies
  double drift_deviation;             // standard deviation of `drift`
  ValidityTest drift_law;             // drift_even or drift_periods: the one with the smaller chance
  bool drift_explains;                // without the drift no residuals follow each other
  double detectable_drift;            // drift that is found in nine of ten such measurements
  double step;                        // change of the response between two points, share of its size, upwards
  double step_deviation;              // standard deviation of `step`
  double step_below, step_above;      // omega of the points on either side of it
  FrequencyUnit frequency_unit;       // in which summary() gives them
  bool step_explains;                 // without the step no residuals follow each other
  double drift_share, step_share;     // of the squares of the residuals that go with drift or step
  bool reversed_sign;                 // invalid as they are, the points are consistent with imaginary parts reversed
  double freedom;                     // residuals less parameters
  std::vector<std::size_t> outliers;  // points, by index
  std::vector<std::size_t> mains;     // points at a mains frequency that has an alarm

  /// Decided.
  [[nodiscard]] bool usable() const { return validity != Validity::undecided; }
  /// The verdict in one sentence with its figures.
  [[nodiscard]] std::string summary() const;
};

/// @throws std::invalid_argument  level outside of (0, 1), or accuracy or tolerance below 0 or not finite
[[nodiscard]] ValidationResult validate(const FrequencyResponseData& data, const ValidationOptions& options = {});

}  // namespace frac
