// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cmath>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "backlash/compliant/compliant_bodies.hpp"
#include "backlash/impact_simulation.hpp"
#include "backlash/two_mass_system.hpp"
#include "io/text_table.hpp"
#include "options/options.hpp"

namespace fracfit {

/// Two masses and their force; dimensionless by default.
struct Scene {
  double force = 1, clearance = 1, mass1 = 1, mass2 = 1;

  /// @throws std::invalid_argument  as TwoMassSystem.
  [[nodiscard]] backlash::TwoMassSystem system(double restitution) const {
    return {mass1, mass2, clearance, restitution};
  }
};

/// --mass1 and --mass2.
void add_masses(Options& options, double& mass1, double& mass2);
/// --force, --clearance, --mass1, --mass2.
void add_scene(Options& options, Scene& scene);

/// Contacts that take time, and dry friction, where a command takes them beside --restitution: --contact-stiffness with
/// --contact-damping, or --contact-frequency with --contact-ratio or --contact-restitution, and --friction1,
/// --friction2.
class CompliantOptions {
 public:
  /// After --restitution is declared, which then may be left out.
  /// @param several  whether those of contacts may be lists
  void add(Options& options, bool several = false);
  /// Refuses the option where contacts take time.
  static void exclude(Option& option, const std::string& why);
  /// Which of the two kinds of contact was given. @throws std::invalid_argument  none.
  [[nodiscard]] bool are_given(const Options& options) const;
  /// The same with a value for contact-stiffness, ..., friction1 or friction2 in place of the one given; empty for
  /// another name, and for an option of contacts that was not given.
  [[nodiscard]] std::optional<CompliantOptions> with(std::string_view name, double value) const;
  /// Of each contact, every combination of the two options that give it, the first of them slowest.
  /// @throws std::invalid_argument  as CompliantContact.
  [[nodiscard]] std::vector<backlash::CompliantContact> contacts(double mass1, double mass2) const;
  /// @throws std::invalid_argument  as CompliantBodies.
  [[nodiscard]] std::vector<backlash::CompliantBodies> bodies(const frac::FractionalTransferFunction& load,
                                                              const frac::FractionalTransferFunction& drive,
                                                              double clearance) const;
  /// Names of these two in contact_entries(), and their values for each contact: what tells contacts apart.
  [[nodiscard]] std::array<std::string, 2> columns() const;
  [[nodiscard]] std::vector<std::array<double, 2>> values() const;
  [[nodiscard]] const backlash::CoulombFriction& friction() const { return friction_; }

 private:
  std::vector<double> stiffness_, damping_, frequency_, ratio_, restitution_;
  backlash::CoulombFriction friction_;
};
/// Entries of a file in place of that of a restitution.
[[nodiscard]] io::Metadata contact_entries(const backlash::CompliantBodies& bodies);
/// "near", "far" or "none".
[[nodiscard]] std::string contact_word(const std::optional<backlash::Wall>& wall);
/// Whether only commands with CompliantOptions take an option of that name.
[[nodiscard]] bool is_compliant_option(std::string_view name);

/// Values of which each makes a scene of its own: a list or grid without repetition.
/// @throws std::invalid_argument  also where a list of two looks like one number with a decimal comma.
[[nodiscard]] std::vector<double> scene_values_of(std::string_view name, const std::string& text);

}  // namespace fracfit
