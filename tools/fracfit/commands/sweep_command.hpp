// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <optional>

#include "backlash/minus_inverse.hpp"
#include "batch/sweep_stream.hpp"
#include "options/command.hpp"

namespace fracfit {

/// A command that writes a table of many curves.
class SweepCommand : public Command {
 protected:
  using Command::Command;

  /// Rows reach the disk as they come.
  [[nodiscard]] bool streams() const { return writes_file() && format() == "csv"; }
  /// Computes, writes, and says what of the points a user should know. @return the exit code
  int write_points(const backlash::SweepPieces& pieces, const SweepTable& table);
  /// Of bodies whose contacts take time, by the orbits of two contacts unless a protocol was given.
  /// @param labels  columns that tell the curves apart
  int write_points(const std::vector<LabelledScene>& scenes, const std::vector<std::string>& labels,
                   const io::Metadata& contact, const std::vector<double>& omega, const backlash::SweepOptions& options,
                   const PointForm& form);
  /// Makes two-impact the protocol unless one was given.
  void default_to_two_impact(backlash::SweepOptions& options);
  /// Says why, where points have no value.
  void say_what_rounding_left(std::size_t not_finite) const;
  [[nodiscard]] int exit_code_of(const PointCounts& counts, const PointForm& form) const;

  /// --quantity.
  Option& add_quantity();
  [[nodiscard]] backlash::Quantity quantity() const { return quantity_.value_or(backlash::Quantity::n); }
  /// @param has_loss_factor  what is written is x1 of two free masses
  [[nodiscard]] PointForm form(PointColumns columns, bool has_loss_factor) const;
  /// Says how many points have no -1/N. @return whether others have
  [[nodiscard]] bool has_values(std::size_t without, std::size_t all) const;

 private:
  PointCounts written(const backlash::SweepPieces& pieces, const SweepTable& table);

  std::optional<backlash::Quantity> quantity_;
};

}  // namespace fracfit
