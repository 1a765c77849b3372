// SPDX-License-Identifier: BSD-3-Clause
// How often the band and the intervals of relaxation_times() of data hold the density that made the data, which the
// formula gives exactly.  Prints a table for tools/docs/times_coverage.md.  Arguments: [seeds] [first seed]
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <string>
#include <utility>
#include <vector>

#include "frac/identification/relaxation_times.hpp"
#include "support/validity_cases.hpp"

namespace {

using frac::TimesKernel;
using support::NoiseKind;
using support::Random;

struct Counts {
  int measurements = 0, places = 0, held = 0, tops = 0, held_tops = 0;
  int same_peaks = 0, false_peaks = 0, peaks = 0, held_times = 0, held_areas = 0;
  double seconds = 0;
};

double percent(int part, int whole) {
  return 100.0 * part / std::max(whole, 1);
}

void count(const support::ValidityModel& model, const support::Sweep& sweep, const std::vector<double>& parameters,
           TimesKernel kernel, Counts& counts) {
  const auto data = sweep.data();
  const std::clock_t start = std::clock();
  const auto found = frac::relaxation_times(data, kernel);
  counts.seconds += static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
  ++counts.measurements;
  const auto exact_on = [&](const std::vector<double>& tau) {
    return frac::relaxation_times(frac::Structure(model.formula), parameters, tau, kernel);
  };
  const auto truth = exact_on(found.tau);
  const auto holds = [&](std::size_t i) {
    return found.lower[i] <= truth.density[i] && truth.density[i] <= found.upper[i];
  };
  // Times that the band of frequencies sees; what lies beyond is the prior alone.
  for (std::size_t i = 0; i < found.tau.size(); ++i) {
    if (found.tau[i] < 1 / sweep.omega.back() || found.tau[i] > 1 / sweep.omega.front()) continue;
    ++counts.places;
    counts.held += holds(i);
  }
  ++counts.tops;
  counts.held_tops += holds(
      static_cast<std::size_t>(std::max_element(truth.density.begin(), truth.density.end()) - truth.density.begin()));
  // Peaks of the truth on a fine grid, for the areas within the band as those of data are.
  std::vector<double> fine;
  for (int i = 0; i <= 1000; ++i)
    fine.push_back(std::pow(sweep.omega.front() / sweep.omega.back(), -i / 1000.0) / sweep.omega.back());
  const auto peaks = exact_on(fine).peaks;
  counts.false_peaks += found.peaks.size() > peaks.size();
  if (found.peaks.size() != peaks.size()) return;
  ++counts.same_peaks;
  for (std::size_t k = 0; k < peaks.size(); ++k) {
    const auto &peak = found.peaks[k], &exact = peaks[k];
    ++counts.peaks;
    counts.held_times += peak.tau_lower <= exact.tau && exact.tau <= peak.tau_upper;
    counts.held_areas += peak.area_lower <= exact.area && exact.area <= peak.area_upper;
  }
}

}  // namespace

int main(int argc, char** argv) {
  const int seeds = argc > 1 ? std::atoi(argv[1]) : 20, first = argc > 2 ? std::atoi(argv[2]) : 1;
  const std::vector<std::pair<NoiseKind, const char*>> kinds{{NoiseKind::relative, "relative"},
                                                             {NoiseKind::additive, "additive"}};
  std::printf(
      "| model | noise | measurements | band | band at the maximum | number of peaks right | too many | times | areas "
      "| ms each "
      "|\n"
      "|---|---|---|---|---|---|---|---|---|---|\n");
  Counts all;
  for (const auto& model : support::impedance_models()) {
    // Those with a density that is nowhere negative and without lines.
    const bool modulus = model.name == "modulus (fractional Zener)";
    if (!modulus && model.name != "arc" && model.name != "Havriliak-Negami" && model.name != "two arcs, inductance")
      continue;
    const auto kernel = modulus ? TimesKernel::rising : TimesKernel::falling;
    for (const auto& [kind, name] : kinds) {
      Counts counts;
      for (int seed = first; seed < first + seeds; ++seed) {
        auto [random, noise, per_decade] = support::seeded_measurement(seed, kind);
        // The parameters are the first that sweep() draws.
        Random same = random;
        const auto parameters = model.parameters(same);
        auto sweep = support::sweep(model, per_decade, kind, noise, random);
        support::add_noise(sweep, random);
        count(model, sweep, parameters, kernel, counts);
      }
      std::printf("| %s | %s | %d | %.1f %% | %.0f %% | %.0f %% | %.1f %% | %.0f %% | %.0f %% | %.0f |\n",
                  model.name.c_str(), name, counts.measurements, percent(counts.held, counts.places),
                  percent(counts.held_tops, counts.tops), percent(counts.same_peaks, counts.measurements),
                  percent(counts.false_peaks, counts.measurements), percent(counts.held_times, counts.peaks),
                  percent(counts.held_areas, counts.peaks), 1000 * counts.seconds / counts.measurements);
      std::fflush(stdout);
      all.held += counts.held;
      all.places += counts.places;
    }
  }
  std::printf("\nband, all: %.1f %%\n", percent(all.held, all.places));
}
