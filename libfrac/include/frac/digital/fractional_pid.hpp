// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <complex>
#include <cstddef>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "frac/approximation/approximate.hpp"
#include "frac/digital/discretise.hpp"
#include "frac/digital/fractional_pid_gains.hpp"

namespace frac {

/// What the fractional integral does while the output is at a limit.
enum class AntiWindup {
  none,
  /// (limit - output)/tracking_time^lambda is added to its input, within the same sample.
  back_calculation,
  /// It takes in only as much as the output can follow, and nothing that pushes it further.
  conditional_integration,
};

/// none, back-calculation, conditional-integration.
[[nodiscard]] std::string_view to_string(AntiWindup method);
/// @throws std::invalid_argument  unknown name; the text lists the known ones.
[[nodiscard]] AntiWindup anti_windup_from_string(std::string_view text);
[[nodiscard]] std::span<const AntiWindup> anti_windup_methods();

/// A fractional PID for samples every sample_time seconds:
///   u = kp (b r - y) + ki s^-lambda (r - y) + kd s^mu F(s) (c r - y),   F = 1/(1 + derivative_filter_time s).
struct FractionalPidConfig {
  FractionalPidGains gains;
  /// s.
  double sample_time = 0;
  /// On which s^(1 - lambda) and s^mu hold, rad/s; not needed where all orders are 1.
  FrequencyBand band{};
  /// Largest relative error on the band, or a number of poles.
  ApproximationGoal goal = Tolerance{1e-3};
  /// Limits of the output.
  double minimum = -std::numeric_limits<double>::infinity();
  double maximum = std::numeric_limits<double>::infinity();
  AntiWindup anti_windup = AntiWindup::back_calculation;
  /// Of back_calculation, s; at least the sample time is used.  0 stands for Ti = (kp/ki)^(1/lambda), where kp is 0 for
  /// (kd/ki)^(1/(lambda + mu)), and for ten sample times with the integral alone.
  double tracking_time = 0;
  /// s.
  double derivative_filter_time = 0;
  /// b.
  double setpoint_weight = 1;
  /// c; 0 puts the derivative on the measurement.
  double derivative_setpoint_weight = 1;
  /// direct, tustin, tustin_prewarped or al_alaoui.
  Discretisation discretisation = Discretisation::direct;
  /// Of `direct`: how far the derivative's answer to a step of the set-point may rise again after its peak, over the
  /// peak, lag included (mu > 1: of the answer's running sum).  0 to 10; more is more accurate at the upper edge of the
  /// band, and rings from sample to sample.  (The rule of Al-Alaoui swings by 1/7 at mu = 1.)
  double most_swing = 0.15;
};

/// "" if the configuration can be built, else one sentence that says why not.  Throws nothing.
[[nodiscard]] std::string validate(const FractionalPidConfig& config);

/// Filter of the integral or the derivative part of a controller: sections.response() behind the taps,
/// x_n = sum taps_k input_(n-k).
struct PidFilter {
  static constexpr std::size_t most_taps = 14;
  static constexpr std::size_t most_sections = 64;
  /// An even number of them, the last may be 0; none where x is the input itself.
  std::vector<double> taps;
  /// By rising rate.
  ParallelSections sections = {.output = SectionOutput::state, .direct = 1, .rates = {}, .weights = {}};
  /// d(output)/d(input) within one sample.
  double high_gain = 1;
};

/// The numbers a FractionalPid runs on, designed outside the loop.
///  - Integral: filter for s^(1 - lambda), then a true integrator by the trapezoidal rule, so that the control error
///    vanishes at rest exactly.  With Discretisation::direct the filter makes up for the rule's gain error too.
///  - Derivative: for mu < 1 filter for s^mu behind the lag F by the backward rule; for mu >= 1 the backward difference
///    s F(s), then the filter for s^(mu - 1).
/// With lambda = mu = 1 there are no filters, and this is the classical PID.
class FractionalPidDesign {
 public:
  /// @throws std::invalid_argument  with the sentence of validate().
  explicit FractionalPidDesign(const FractionalPidConfig& config);

  /// As configured, the band as used.
  [[nodiscard]] const FractionalPidConfig& config() const noexcept { return config_; }
  /// What differs from what was asked: a band cut at Nyquist, a tolerance not kept, gain beyond the band that makes
  /// steps ring.  Empty if nothing does.
  [[nodiscard]] const std::string& note() const noexcept { return note_; }
  [[nodiscard]] const PidFilter& integral() const noexcept { return integral_; }
  [[nodiscard]] const PidFilter& derivative() const noexcept { return derivative_; }
  /// Largest relative error on the band of the filter with its integrator against s^-lambda, and of the derivative's
  /// filter against s^mu or s^(mu - 1); 0 without filter.
  [[nodiscard]] double integral_error() const noexcept { return integral_error_; }
  [[nodiscard]] double derivative_error() const noexcept { return derivative_error_; }
  /// Tracking time as used, s; 0 where there is no back calculation.
  [[nodiscard]] double tracking_time() const noexcept { return tracking_time_; }
  /// Largest |C_d/C - 1| on the band, C_d the running controller and C the exact one with its lag F, and where (rad/s);
  /// NaN where the configuration has no band.  Low values need more than good filters: the backward rule of lag and
  /// whole differentiation errs by omega T/2, the trapezoidal one at lambda = 1 by (omega T)^2/12 of their parts.
  [[nodiscard]] double error() const noexcept { return error_; }
  [[nodiscard]] double omega_at_error() const noexcept { return omega_at_error_; }
  /// C(e^{j omega T}) from control error to output, weights 1, limits aside; omega in rad/s, in (0, pi/T).
  [[nodiscard]] std::complex<double> response(double omega) const;

 private:
  FractionalPidConfig config_;
  std::string note_;
  PidFilter integral_;
  PidFilter derivative_;
  double integral_error_ = 0;
  double derivative_error_ = 0;
  double tracking_time_ = 0;
  double error_ = std::numeric_limits<double>::quiet_NaN();
  double omega_at_error_ = std::numeric_limits<double>::quiet_NaN();
};

/// What the loop multiplies by, rounded to Real.
template <typename Real>
struct PidCoefficients {
  PidCoefficients() = default;
  explicit PidCoefficients(const FractionalPidDesign& design) noexcept;

  /// Larger inputs are refused: they could drive a slow state out of range.
  static constexpr Real largest_input = sizeof(Real) == sizeof(float) ? Real(1e15) : Real(1e150);

  Real kp = 0, ki = 0, kd = 0;
  Real setpoint_weight = 1, derivative_setpoint_weight = 1;
  Real sample_time = 1, half_time = 0;
  /// T/(Tf + T) and 1/(Tf + T).
  Real lag_share = 1, inverse_lag_time = 0;
  /// mu >= 1.
  bool differentiates = false;
  Real minimum = 0, maximum = 0;
  AntiWindup anti_windup = AntiWindup::none;
  /// tracking_time^-lambda.
  Real inverse_tracking = 0;
  /// d(integral part)/d(its input) within one sample, called g below, and 1/g.
  Real integral_gain = 0;
  Real inverse_integral_gain = 0;
  /// 1/(1 + g tracking_time^-lambda).
  Real tracking_share = 1;
  /// d(what the integral's sections take in)/d(its input) within one sample.
  Real integral_tap = 1;
};

/// The controller in its loop.  step(), track(), reset() and adopt() take constant time, allocate nothing and throw
/// nothing; the object holds all it needs.  Real is float or double.  Signals are taken to have been 0 before the first
/// step unless reset() says otherwise.
template <typename Real>
class FractionalPid {
 public:
  /// @throws std::invalid_argument  with the sentence of validate().
  explicit FractionalPid(const FractionalPidConfig& config);
  explicit FractionalPid(const FractionalPidDesign& design) noexcept;
  /// The same without exceptions: empty if the configuration is not valid, `why` then says why not.
  [[nodiscard]] static std::optional<FractionalPid> try_make(const FractionalPidConfig& config, std::string& why);

  /// Output for the next sample.  Where an input is not finite, or so large that the output would not be, the last
  /// output is returned, bad_input() is set, and nothing else changes.
  [[nodiscard]] Real step(Real setpoint, Real measured) noexcept;

  /// The next output is `output` (within the limits): call it before every step while another source drives the plant,
  /// and the takeover is bumpless.  The memory of the fractional integral starts anew; without integral action the
  /// difference stays as a constant offset.  A number that is not finite is ignored and sets bad_input().
  void track(Real output) noexcept;
  /// At rest, all signals 0.
  void reset() noexcept;
  /// At rest after signals that had been constant at these values, output 0 (or the limit next to it): no kick of the
  /// derivative at the start.
  void reset(Real setpoint, Real measured) noexcept;

  /// New parameters.  Were the last inputs repeated, the next output would be what it would have been without the
  /// change: states are carried over as low-pass filtered histories, the rest is put into the integrator.  The design
  /// itself takes milliseconds and allocates, so a hard loop has it made elsewhere.
  void adopt(const FractionalPidDesign& design) noexcept;

  /// The last output was cut at a limit.
  [[nodiscard]] bool saturated() const noexcept { return saturated_; }
  /// The last input was refused.
  [[nodiscard]] bool bad_input() const noexcept { return bad_input_; }
  [[nodiscard]] Real output() const noexcept { return output_; }
  /// Output before the limits.
  [[nodiscard]] Real unlimited_output() const noexcept { return unlimited_; }

 private:
  struct Filter {
    SectionOutput output = SectionOutput::state;
    Real direct = 1;
    Real high_gain = 1;
    std::size_t tap_count = 0;
    std::size_t sections = 0;
    std::size_t size = 0;
    std::array<Real, PidFilter::most_taps> tap{};
    static constexpr std::size_t kept = 16;
    std::size_t newest = 0;
    // Inputs, a ring written twice over; from `newest` on the newest first.
    std::array<Real, 2 * kept> past{};

    alignas(64) std::array<Real, PidFilter::most_sections> rate{};
    alignas(64) std::array<Real, PidFilter::most_sections> weight{};
    alignas(64) std::array<Real, PidFilter::most_sections> state{};
    alignas(64) std::array<Real, PidFilter::most_sections> lost{};

    [[nodiscard]] const Real* inputs() const noexcept { return past.data() + newest; }
    void set(const PidFilter& design) noexcept;
    [[nodiscard]] Real through_taps(Real input) const noexcept;
    [[nodiscard]] Real output_for(Real x) const noexcept;  // x = through_taps(input)
    void advance(Real input, Real x) noexcept;
    void rest_at(Real input) noexcept;
    void inherit(const Filter& old, Real input, Real factor, Real time_ratio) noexcept;
  };
  struct Inputs {
    Real proportional = 0;
    Real derivative = 0;
    Real error = 0;
    Real setpoint = 0;
  };
  struct Parts {
    Real proportional, derivative, derivative_input, derivative_tapped, lagged;
    Real integral_input, integral_tapped, integral_filtered, integral, sum;
  };

  void set(const FractionalPidDesign& design) noexcept;
  [[nodiscard]] Parts parts(const Inputs& in) const noexcept;
  Real advance(const Inputs& in) noexcept;

  PidCoefficients<Real> c_;
  Filter integral_, derivative_;
  Real integrator_ = 0, integrator_lost_ = 0;
  Real lag_ = 0;
  bool is_tracking_ = false;
  Real track_output_ = 0;
  Inputs last_;
  Real output_ = 0, unlimited_ = 0;
  bool saturated_ = false, bad_input_ = false;
};

extern template struct PidCoefficients<float>;
extern template struct PidCoefficients<double>;
extern template class FractionalPid<float>;
extern template class FractionalPid<double>;

}  // namespace frac
