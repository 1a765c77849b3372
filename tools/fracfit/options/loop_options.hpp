// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <optional>
#include <string>

#include "backlash/compliant/compliant_loop.hpp"
#include "backlash/loops/control_loop.hpp"
#include "options/options.hpp"
#include "options/scene_options.hpp"

namespace fracfit {

/// --load-receptance and --drive-receptance, in place of masses, which are declared before.
void add_receptances(Options& options, std::string& load, std::string& drive);
/// Options for receptances that are formulas of s alone.
void add_receptances(Options& options, std::optional<frac::FractionalTransferFunction>& load,
                     std::optional<frac::FractionalTransferFunction>& drive);
/// Options for receptances whose names are parameters to estimate.
void add_open_receptances(Options& options, std::string& load, std::string& drive);

/// Two bodies with clearance under a controller, as formulas with names in them.
class LoopOptions {
 public:
  /// --controller, --mass1, --mass2, --load-receptance, --drive-receptance, --clearance, --restitution.
  void add(Options& options);
  /// --body.
  void add_body(Options& options);

  /// @param name   of a quantity that has `value` instead of what was given: mass1, mass2, clearance, restitution or a
  ///               name in a formula; empty for none
  /// @throws std::invalid_argument  no such name; a name without a value; as ControlLoop and LinearBodies.
  [[nodiscard]] backlash::ControlLoop loop(const std::string& name = {}, double value = NAN) const;
  /// The same with contacts that take time and dry friction in place of the restitution; `name` may be one of theirs.
  [[nodiscard]] backlash::CompliantLoop loop(const CompliantOptions& contact, const std::string& name = {},
                                             double value = NAN) const;
  /// s, of the set-point before the controller, see SetPoint; 0 but of a cascade.
  [[nodiscard]] double set_point_lag() const;
  /// @throws std::invalid_argument  a restitution that is missing, or given and varied.
  void check(const std::string& varied = {}) const;

 private:
  struct Parts {
    double clearance, restitution, mass1, mass2;
    frac::FractionalTransferFunction controller, load, drive;
  };
  [[nodiscard]] Parts parts(const std::string& name, double value) const;

  std::string controller_, load_, drive_;
  backlash::Output body_ = backlash::Output::x1;
  double mass1_ = NAN, mass2_ = NAN, clearance_ = 1, restitution_ = NAN;
};

}  // namespace fracfit
