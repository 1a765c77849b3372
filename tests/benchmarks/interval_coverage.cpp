// SPDX-License-Identifier: BSD-3-Clause
// Coverage of the 95 % intervals by the kind of noise: white, correlated along the axis, additive, mixed,
// and a smooth error.  Prints case,noise,points,parameter,coverage,median relative half width,seconds.  Arguments:
// [trials] [kind] [seed].
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <tuple>
#include <utility>

#include "support/coverage.hpp"

namespace {

std::uint64_t seed = 20261;

void print(const support::CoverageCase& scene, const char* kind, double level, int trials) {
  const support::Coverage coverage = support::measure_coverage(scene, trials, seed);
  for (std::size_t i = 0; i < coverage.name.size(); ++i) {
    std::printf("%s,%s %g,%d,%s,%.3f,%.3g,%.2e\n", scene.model.name, kind, level, scene.points,
                coverage.name[i].c_str(), coverage.share[i], coverage.half_width[i], coverage.seconds);
  }
  std::fflush(stdout);
}

}  // namespace

int main(int argc, char** argv) {
  const int trials = argc > 1 ? std::atoi(argv[1]) : 1000;
  const std::string only = argc > 2 ? argv[2] : "";
  if (argc > 3) seed = std::strtoull(argv[3], nullptr, 10);
  std::printf("# %s, GCC %s, %d trials\ncase,noise,points,parameter,coverage,half_width,seconds\n", FRACFIT_BUILD_TYPE,
              __VERSION__, trials);
  for (const support::CoverageModel& model : support::coverage_models()) {
    if (only.empty() || only == "correlated") {
      for (const int points : {40, 60, 200}) {
        for (const double r : {0.0, 0.4, 0.7, 0.9}) {
          support::CoverageCase scene{model, points};
          scene.correlation = r;
          print(scene, "r =", r, trials);
        }
      }
    }
    // Noise that does not fall with the data, alone and beside relative noise, under the weight that learns it.
    if (only.empty() || only == "additive") {
      for (const int points : {40, 60, 200}) {
        for (const auto& [relative, additive] : {std::pair{0.01, 0.0}, std::pair{0.0, 0.003}, std::pair{0.01, 0.003}}) {
          support::CoverageCase scene{model, points, relative, additive * support::largest_value(model)};
          scene.weight = frac::Weight::learned;
          print(scene, relative == 0 ? "additive" : additive == 0 ? "relative" : "both, additive", additive, trials);
        }
      }
    }
    // A smooth error of the whole response beside white noise of .3 %.
    if (only.empty() || only == "smooth") {
      using Kind = support::SmoothDeviation::Kind;
      for (const int points : {40, 200}) {
        for (const double deviation : {0.0, 0.003, 0.01, 0.03}) {
          for (const auto& [kind, name, length] : {std::tuple{Kind::process, "process of length 1, share", 1.0},
                                                   {Kind::process, "process of length 3, share", 3.0},
                                                   {Kind::wave, "wave of quarter 3, share", 3.0},
                                                   {Kind::slope, "gain and slope, share", 1.0}}) {
            support::CoverageCase scene{model, points, 0.003};
            scene.weight = frac::Weight::learned;
            scene.smooth = {kind, deviation, length};
            print(scene, name, deviation, trials);
            if (deviation == 0) break;
          }
        }
      }
    }
    // The imaginary part alone, and what is recovered from the real part.
    if (only.empty() || only == "imaginary") {
      for (const int points : {40, 60, 200}) {
        support::CoverageCase scene{model, points};
        scene.component = frac::Component::imaginary;
        print(scene, "imaginary part", 0.01, trials);
      }
    }
  }
}
