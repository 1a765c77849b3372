// SPDX-License-Identifier: BSD-3-Clause
#include "backlash/loops/limit_cycles.hpp"

#include <array>
#include <utility>

#include "base/spelling.hpp"
#include "symmetric_search.hpp"

namespace backlash {
namespace {

constexpr std::array<std::pair<StabilityLoss, std::string_view>, 5> loss_names{
    {{StabilityLoss::none, "none"},
     {StabilityLoss::symmetry_breaking, "symmetry-breaking"},
     {StabilityLoss::saddle_node, "saddle-node"},
     {StabilityLoss::torus, "torus"},
     {StabilityLoss::period_doubling, "period-doubling"}}};

}  // namespace

std::string_view to_string(StabilityLoss loss) {
  return frac::detail::spelling(loss_names, loss);
}

LimitCycles symmetric_cycles(const ControlLoop& loop, const LimitCycleOptions& options) {
  const detail::SymmetricSearch search(loop, options);
  LimitCycles result{{}, search.range(), search.is_closed_form(), search.any_frequency()};
  for (const double omega : search.frequencies()) result.cycles.push_back(search.cycle_at(omega));
  return result;
}

}  // namespace backlash
