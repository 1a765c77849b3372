// SPDX-License-Identifier: BSD-3-Clause
// How often what tune_with_backlash() says of the motion that remains is what independent simulations show.
//   tune_with_backlash_rates [FROM TO]     seeds, 0 23 by default
// Prints a line per plant and the rates; a swing agrees within 6 %, none where less than 3 % of the clearance remains.
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <string>

#include "support/simulated_swing.hpp"

int main(int argc, char** argv) {
  const bool is_smoke = argc == 2 && std::string(argv[1]) == "--smoke";
  const auto number = [&](int i, unsigned otherwise) {
    return argc > i ? static_cast<unsigned>(std::strtoul(argv[i], nullptr, 10)) : otherwise;
  };
  const unsigned from = is_smoke ? 0 : number(1, 0), to = is_smoke ? 0 : number(2, 23);
  int usable = 0, without = 0, agreed_without = 0, with = 0, agreed_with = 0, smaller = 0;
  std::printf("seed,clearance,swing,shown,regardless,agrees\n");
  for (unsigned seed = from; seed <= to; ++seed) {
    const support::TunedPlant drawn = support::drawn_plant(seed);
    const auto result = backlash::tune_with_backlash(drawn.plant, drawn.asked, drawn.options);
    if (!result.usable()) {
      std::printf("%u,,,,,not usable: %s\n", seed, result.message.c_str());
      continue;
    }
    ++usable;
    const double clearance = drawn.plant.bodies.system().clearance();
    const double swing = result.persistent.swing;
    const double shown = support::shown_swing(drawn, result);
    const bool agrees = swing == 0 ? shown < 0.03 * clearance : std::abs(shown - swing) < 0.06 * swing;
    (swing == 0 ? without : with) += 1;
    (swing == 0 ? agreed_without : agreed_with) += agrees ? 1 : 0;
    smaller += swing < 0.98 * result.of_regardless.swing ? 1 : 0;
    std::printf("%u,%g,%g,%g,%g,%s\n", seed, clearance, swing, shown, result.of_regardless.swing,
                agrees ? "yes" : "no");
    std::fflush(stdout);
  }
  std::printf(
      "# usable %d of %u; nothing remains: %d, shown by the other simulation %d; a swing remains: %d, shown %d; "
      "smaller than regardless of the clearance: %d\n",
      usable, to - from + 1, without, agreed_without, with, agreed_with, smaller);
  return usable > 0 ? EXIT_SUCCESS : EXIT_FAILURE;
}
