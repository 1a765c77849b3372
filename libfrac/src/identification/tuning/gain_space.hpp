// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <complex>
#include <vector>

#include "frac/identification/tune.hpp"
#include "loop.hpp"

namespace frac::detail {

/// The controllers among which a search goes, by coordinates between limits.  What is asked of the crossover is linear
/// in the gains for given orders and solved for; the coordinates are what it leaves free.
class GainSpace {
 public:
  GainSpace(const FractionalTransferFunction& plant, const LoopSpecification& asked, const TuningOptions& options);

  [[nodiscard]] const std::vector<double>& lower() const { return lower_; }
  [[nodiscard]] const std::vector<double>& upper() const { return upper_; }
  [[nodiscard]] bool is_order(std::size_t coordinate) const {
    return roles_[coordinate] == Role::lambda || roles_[coordinate] == Role::mu;
  }
  /// Two gains are to meet three equations: one order must give way.
  [[nodiscard]] bool is_overdetermined() const { return asked_.flat_phase && uses_[1] != uses_[2]; }
  /// A frequency about which the loop will live, rad/s.
  [[nodiscard]] double reference() const { return reference_; }

  /// NaN where the equations have no solution.
  [[nodiscard]] FractionalPidGains gains(const std::vector<double>& x) const;
  /// d arg L/d ln omega at the reference.
  [[nodiscard]] double phase_slope(const FractionalPidGains& gains) const;
  /// Magnitude in L of each term at the reference, with the sign of its gain.
  struct Shares {
    double of[3];
  };
  [[nodiscard]] Shares shares(const FractionalPidGains& gains) const;

 private:
  enum class Role { lambda, mu, phase_margin, share, kp, ki, kd };

  void add(Role role, double lower, double upper);
  [[nodiscard]] ControllerTerms terms_of(const FractionalPidGains& gains) const;
  void share_out(const ControllerTerms& terms, std::complex<double> target, double share, double (&gain)[3]) const;

  const LoopSpecification& asked_;
  const TuningOptions& options_;
  double reference_;
  std::complex<double> plant_at_reference_;
  std::complex<double> plant_slope_;
  bool uses_[3];
  std::vector<Role> roles_;
  std::vector<double> lower_, upper_;
};

}  // namespace frac::detail
