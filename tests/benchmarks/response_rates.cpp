// SPDX-License-Identifier: BSD-3-Clause
// How often the 95 % intervals of response() hold the exact response, for each disturbance and number of periods, over
// seeds that nothing was tuned on.  Prints the table of tools/docs/methods/response.md.  Arguments: [seeds] [first
// seed]
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <random>
#include <string>

#include "support/simulated_records.hpp"

int main(int count, char** arguments) {
  const bool smoke = count > 1 && std::string(arguments[1]) == "--smoke";
  const int seeds = smoke ? 2 : count > 1 ? std::atoi(arguments[1]) : 200;
  const int first = count > 2 && !smoke ? std::atoi(arguments[2]) : 1000;
  std::printf(
      "| record | periods | intervals | hold %% | of the worst line %% | rms error / sigma | flagged | recognised %% "
      "|\n|---|---|---|---|---|---|---|---|\n");
  for (const auto which : support::record_cases)
    for (const int periods : {2, 3, 5, 8, 10, 20}) {
      if (periods == 8 && !support::is_stepped(which)) continue;
      if (support::is_random(which) && periods < 5) continue;
      // Edges of segments are left out: of fewer cycles too few remain.
      if (support::is_stepped(which) && periods < 8) continue;
      support::RecordCoverage coverage;
      for (int seed = first; seed < first + seeds; ++seed) {
        std::mt19937_64 generator(static_cast<unsigned>(seed));
        coverage.count(which, static_cast<std::size_t>(periods), generator);
      }
      std::printf("| %s | %d | %d | %.1f | %.1f | %.3f | %d | %.1f |\n", std::string(name_of(which)).c_str(), periods,
                  coverage.whole, coverage.percent(), coverage.percent_of_worst_line(),
                  std::sqrt(coverage.squares * 2 / std::max(coverage.whole, 1)), coverage.flagged,
                  100.0 * coverage.recognised / coverage.records);
    }
}
