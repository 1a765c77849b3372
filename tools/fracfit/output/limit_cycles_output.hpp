// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "backlash/compliant/compliant_cycles.hpp"
#include "backlash/loops/cycle_continuation.hpp"
#include "backlash/loops/impact_cycles.hpp"
#include "backlash/loops/limit_cycles.hpp"
#include "backlash/loops/predicted_cycles.hpp"
#include "frac/describe.hpp"
#include "frac/stability.hpp"
#include "io/text_table.hpp"

namespace fracfit {

/// Everything that is known about the cycles of one loop.
struct LoopCycles {
  backlash::ControlLoop loop;
  frac::ClosedLoopStability rigid;  // the same loop without clearance
  backlash::LimitCycles exact;
  std::vector<backlash::PredictedCycle> predicted;
  backlash::ImpactCycles settled = {};  // what motions from seeded starts come to
  io::Metadata varied = {};             // name and value of a quantity that changes from loop to loop
};

/// The same of a loop whose contacts take time.
struct CompliantLoopCycles {
  backlash::CompliantLoop loop;
  io::Metadata contact;  // entries that tell contact and friction
  frac::ClosedLoopStability rigid;
  backlash::CompliantCycles found;
  io::Metadata varied = {};  // as of LoopCycles
};

/// The numbers of a cycle, as JSON has them.
[[nodiscard]] std::vector<frac::NumberDescription> described_limit_cycle(bool flat);

/// Impacts follow each other without end before a rest, so that they have no count.
[[nodiscard]] bool has_chatter(const backlash::ImpactCycle& cycle);

/// @param followed  what happens between the loops; nullptr for a single loop and where values have no order
[[nodiscard]] std::string limit_cycles_json(const std::vector<LoopCycles>& loops,
                                            const backlash::CycleContinuation* followed, const std::string& command);
/// One row per cycle.
[[nodiscard]] std::string limit_cycles_csv(const std::vector<LoopCycles>& loops, const std::string& command);
/// For people.
[[nodiscard]] std::string limit_cycles_table(const std::vector<LoopCycles>& loops,
                                             const backlash::CycleContinuation* followed);

/// Of one loop, or of several in which a quantity is varied.
[[nodiscard]] std::string limit_cycles_json(const std::vector<CompliantLoopCycles>& loops, const std::string& command);
[[nodiscard]] std::string limit_cycles_csv(const std::vector<CompliantLoopCycles>& loops, const std::string& command);
[[nodiscard]] std::string limit_cycles_table(const std::vector<CompliantLoopCycles>& loops);

}  // namespace fracfit
