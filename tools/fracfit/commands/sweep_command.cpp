// SPDX-License-Identifier: BSD-3-Clause
#include "commands/sweep_command.hpp"

#include <string>

#include "io/progress_bar.hpp"

namespace fracfit {

int SweepCommand::write_points(const backlash::SweepPieces& pieces, const SweepTable& table) {
  frac::Progress progress;
  const PointCounts counts = [&] {
    const io::ProgressBar bar(name(), progress, progress_style());
    return write_sweep(pieces, table, {output(), streams() ? out() : "", format(), command_line()}, progress);
  }();
  if (counts.of_earlier_run > 0)
    say("went on with " + out() + ".partial, which held " + std::to_string(counts.of_earlier_run) + " of the points");
  return exit_code_of(counts, table.points);
}

int SweepCommand::exit_code_of(const PointCounts& counts, PointColumns columns) const {
  const std::string place = columns == PointColumns::with_diagnostics ? "see column " : "--diagnostics adds column ";
  if (counts.not_finite > 0) say("some points have no finite value, see the output");
  if (counts.transient_possible > 0)
    say(std::to_string(counts.transient_possible) + " of the points may be means of a transient; " + place +
        "transient_possible");
  if (counts.decided_by_rounding > 0)
    say(std::to_string(counts.decided_by_rounding) +
        " of the points follow orbits that rounding decides on and are means over forces that differ in the last "
        "digits; " +
        place + "force_sensitivity");
  return counts.not_finite == 0 ? usable_result : no_usable_result;
}

}  // namespace fracfit
