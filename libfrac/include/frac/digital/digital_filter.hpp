// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <complex>
#include <cstddef>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "frac/digital/discretise.hpp"
#include "frac/model/fractional_transfer_function.hpp"
#include "frac/state_space.hpp"

namespace frac {

/// How a whole integration is done.
enum class IntegratorRule {
  /// T/(z - 1): exact for an input that is constant between samples.
  held,
  /// T/2 (z + 1)/(z - 1).
  trapezoidal,
};

/// A recursion in first-order sections side by side:
///   y_n = z^-dead_samples (integrator)^integrators [ sections + Re sum pair_weight v ] (sum taps_k z^-k)
///         ((1 - 1/z)/T)^differences x_n,
/// with v += x - rate v for real sections and pairs alike; a pair stands for a pole and its conjugate.
struct DigitalFilterDesign {
  double sample_time = 1;  // s
  std::size_t dead_samples = 0;
  int differences = 0;
  int integrators = 0;
  IntegratorRule rule = IntegratorRule::trapezoidal;
  std::vector<double> taps = {1};
  ParallelSections sections;
  std::vector<std::complex<double>> pair_rates;
  std::vector<std::complex<double>> pair_weights;

  /// H(e^{j omega T}), omega in rad/s, in (0, pi/T).
  [[nodiscard]] std::complex<double> response(double omega) const;
  /// First-order states, a pair's two counted; samples kept for taps, dead time and differences are not.
  [[nodiscard]] std::size_t states() const noexcept { return sections.rates.size() + 2 * pair_rates.size(); }
};

/// s^order as designed.
[[nodiscard]] DigitalFilterDesign filter_design(const DigitalPower& power);

/// Any proper model, exactly but for `tolerance` for an input that is constant between samples, by the sum of
/// exponentials of respond.hpp: poles and branch cut become sections with one state each.  Chosen over powers of s
/// realised term by term inside the model because it has no algebraic loop and no band to choose, costs the same
/// whatever the number of terms (some 50 states at 1e-4, 100 at 1e-9 for the longest horizons), and is stable whenever
/// the model is.
/// @param tolerance  1e-13 to 0.1, of the largest value of the step response over the horizon.
/// @param horizon    number of samples the filter is good for, 1 to 10^12.
/// @throws std::invalid_argument  an argument out of range; the model unstable, improper, with more than one whole
///                                integration, or with one and a dead time that is
///                                no whole number of samples.
/// @throws std::domain_error      the poles could not be counted.
[[nodiscard]] DigitalFilterDesign filter_design(const FractionalTransferFunction& model, double sample_time,
                                                double tolerance = 1e-9, double horizon = 1e9);

/// A rational stand-in, exactly for an input that is constant between samples: a state per pole, which is a third to a
/// fifth of the above, for what holds on the stand-in's band only.
/// @throws std::invalid_argument  sample_time out of range; a pole not left of the imaginary axis, or multiple; a dead
///                                time that is no whole number of samples.
[[nodiscard]] DigitalFilterDesign filter_design(const RationalModel& system, double sample_time);

/// A design and what to state about it.
struct FilterChoice {
  DigitalFilterDesign design;
  /// Largest |H/G - 1| on the band; NaN for a filter that holds at all frequencies.
  double max_relative_error = std::numeric_limits<double>::quiet_NaN();
  /// A sentence on what differs from what was asked; empty if nothing does.
  std::string note = {};
};

/// c s^order on a band, by digital_power().
/// @throws std::invalid_argument  the model has more than one term in its numerator or denominator, or a dead time; as
///                                digital_power().
[[nodiscard]] FilterChoice power_filter(const FractionalTransferFunction& model, FrequencyBand band,
                                        ApproximationGoal goal, double sample_time,
                                        Discretisation discretisation = Discretisation::direct);

/// Any other model, for an input that is constant between samples: with a band the design of fewer states, one set of
/// poles for the band or the filter for all frequencies.  The latter is also taken for a model that grows with
/// frequency and, with a note, where one for the band is not possible.
/// @param tolerance  on the band, or of the step response; see filter_design() and realise().
/// @throws std::invalid_argument, std::domain_error  as filter_design() of the model, and realise().
[[nodiscard]] FilterChoice model_filter(const FractionalTransferFunction& model, std::optional<FrequencyBand> band,
                                        double sample_time, double tolerance, double horizon = 1e9);

/// The recursion in work, Real float or double, from rest.  Memory is allocated by the constructor only.
template <typename Real>
class DigitalFilter {
 public:
  /// @throws std::invalid_argument  differences or integrators not within 0 .. 7, a rate outside (0, 2), lists of
  ///                                different lengths, no tap, or a coefficient not finite.
  explicit DigitalFilter(const DigitalFilterDesign& design);

  /// Takes x_n, returns y_n.  Constant time.  A sample that is not finite is not checked for and spoils the state.
  [[nodiscard]] Real step(Real sample) noexcept;
  /// The same for many samples, faster; output[n] belongs to samples[n]; the two may be the same memory.
  /// @throws std::invalid_argument  lengths differ.
  void run(std::span<const Real> samples, std::span<Real> output);
  void reset() noexcept;
  /// First-order states; a pair counts as two.  Samples kept for taps, dead time and differences do not count.
  [[nodiscard]] std::size_t states() const noexcept { return sections_ + 2 * pairs_.size(); }

 private:
  static constexpr std::size_t most_whole = 7;
  struct Pair {
    Real rate_re, rate_im, weight_re, weight_im;
    Real re = 0, im = 0;
  };
  Real before(Real sample) noexcept;
  Real after(Real sum) noexcept;
  Real through_taps(Real sample) noexcept;
  void through_taps(Real* samples, std::size_t count) noexcept;

  std::vector<Real> taps_;  // empty, or an even number of them
  std::vector<Real> line_;  // as many past samples, the newest last, and room for a block of new ones
  std::size_t sections_ = 0;
  SectionOutput output_ = SectionOutput::state;
  Real direct_ = 0;
  std::vector<Real> rate_, weight_, state_, lost_;  // filled up to whole groups
  std::vector<Pair> pairs_;
  std::size_t differences_ = 0, integrators_ = 0;
  Real inverse_time_ = 1, time_ = 1, now_ = 0;  // now: share of the present sample in an integrator
  Real previous_[most_whole] = {};
  Real integral_[most_whole] = {};
  Real integral_lost_[most_whole] = {};
  std::vector<Real> waiting_;  // ring of samples within the dead time
  std::size_t oldest_ = 0;
};

extern template class DigitalFilter<float>;
extern template class DigitalFilter<double>;

}  // namespace frac
