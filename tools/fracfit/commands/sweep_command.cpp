// SPDX-License-Identifier: BSD-3-Clause
#include "commands/sweep_command.hpp"

#include <string>
#include <utility>

#include "backlash/compliant/compliant_bodies.hpp"
#include "io/progress_bar.hpp"

namespace fracfit {

int SweepCommand::write_points(const backlash::SweepPieces& pieces, const SweepTable& table) {
  return exit_code_of(written(pieces, table), table.form);
}

int SweepCommand::write_points(const std::vector<LabelledScene>& scenes, const std::vector<std::string>& labels,
                               const io::Metadata& contact, const std::vector<double>& omega,
                               const backlash::SweepOptions& options, const PointForm& form) {
  // A restitution tells nothing of the time that such motions take.
  const auto part = io::part_of(scenes, shard(), std::vector<double>(scenes.size(), 1));
  require_table_size({{"scenes", part.size()}, {"--omega", omega.size()}}, streams() ? largest_stream : largest_table);
  std::vector<backlash::CompliantScene> bodies;
  for (const LabelledScene& each : part) bodies.push_back(each.scene);
  const backlash::CompliantScene& first = scenes.front().scene;
  const SweepTable table =
      compliant_table({first.bodies.system(), first.force_amplitude}, part, labels, contact, options, form, shard());
  const PointCounts counts = written(backlash::bodies_sweep_pieces(std::move(bodies), omega, options), table);
  say_what_rounding_left(counts.not_finite);
  return exit_code_of(counts, form);
}

void SweepCommand::default_to_two_impact(backlash::SweepOptions& sweep) {
  if (options()["--protocol"].is_given()) return;
  sweep.protocol = backlash::Protocol::two_impact;
  options()["--protocol"].say(std::string(backlash::to_string(sweep.protocol)));
}

void SweepCommand::say_what_rounding_left(std::size_t not_finite) const {
  if (not_finite > 0)
    say("contacts so fast, or a gap so small against them, that rounding is all that is left have no value here; "
        "--restitution is their limit");
}

PointCounts SweepCommand::written(const backlash::SweepPieces& pieces, const SweepTable& table) {
  frac::Progress progress;
  const PointCounts counts = [&] {
    const io::ProgressBar bar(name(), progress, progress_style());
    return write_sweep(pieces, table, {output(), streams() ? out() : "", format(), command_line()}, progress);
  }();
  if (counts.of_earlier_run > 0)
    say("went on with " + out() + ".partial, which held " + std::to_string(counts.of_earlier_run) + " of the points");
  return counts;
}

int SweepCommand::exit_code_of(const PointCounts& counts, const PointForm& form) const {
  const std::string place =
      form.columns == PointColumns::with_diagnostics ? "see column " : "--diagnostics adds column ";
  if (counts.not_finite > 0) say("some points have no finite value, see the output");
  if (counts.transient_possible > 0)
    say(std::to_string(counts.transient_possible) + " of the points may be means of a transient; " + place +
        "transient_possible");
  if (counts.decided_by_rounding > 0)
    say(std::to_string(counts.decided_by_rounding) +
        " of the points follow orbits that rounding decides on and are means over forces that differ in the last "
        "digits; " +
        place + "force_sensitivity");
  return has_values(counts.without_inverse, counts.all) && counts.not_finite == 0 ? usable_result : no_usable_result;
}

Option& SweepCommand::add_quantity() {
  return options()
      .choice("--quantity", quantity_, backlash::quantities(),
              "N, m/N, or -1/N, N/m, of x1 with columns frequency_ratio, omega/sqrt(F/(M2 DELTA)), and loss_factor, "
              "Im(-1/N)/((M1+M2) omega^2)")
      .default_is("n");
}

PointForm SweepCommand::form(PointColumns columns, bool has_loss_factor) const {
  return {columns, quantity(), has_loss_factor && quantity() == backlash::Quantity::minus_inverse};
}

bool SweepCommand::has_values(std::size_t without, std::size_t all) const {
  if (without > 0)
    say(std::to_string(without) + " of " + std::to_string(all) +
        " points have no -1/N, as N is 0 there: nan in the output");
  // A shard is part of a table that has others.
  return without < all || shard().count > 1;
}

}  // namespace fracfit
