// SPDX-License-Identifier: BSD-3-Clause
// Verdicts on records over time whose noise is of first order, among presets that hold the true model, and of three
// lags and of an oscillator among lags, which no preset of the list describes: how often the class is right, left open,
// wrong, or no candidate is said to describe the record.  Prints model,correlation,right,undecided,wrong,no
// candidate,of.  Arguments: [records of each kind] [first seed], or --smoke.
#include <array>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <utility>
#include <vector>

#include "frac/identification/identify.hpp"
#include "frac/identification/model_library.hpp"
#include "support/periodic_records.hpp"

namespace {

struct Plant {
  const char* name;
  const char* formula;
  bool fractional;
  bool among_lags = false;
};
constexpr std::array<Plant, 6> plants{{{"lag", "2/(1.5 s + 1)", false},
                                       {"oscillator", "2/(0.5 s^2 + 0.4 s + 1)", false},
                                       {"three lags", "2/((2 s + 1) (s + 1) (0.4 s + 1))", false},
                                       {"oscillator among lags", "2/(0.5 s^2 + 0.4 s + 1)", false, true},
                                       {"fractional lag 0.6", "2/(1.5 s^0.6 + 1)", true},
                                       {"fractional lag 0.8", "2/(1.5 s^0.8 + 1)", true}}};

/// Levels that change every few samples at random, as a converter holds them; noise of 3 % of the output.
frac::TimeResponseData record_of(const Plant& plant, double correlation, support::Random& random) {
  constexpr std::size_t count = 200;
  std::vector<double> time, input;
  for (std::size_t i = 0; i < count; ++i) {
    time.push_back(0.1 * static_cast<double>(i));
    input.push_back(i > 0 && random.unit() < 0.9 ? input.back() : random.normal());
  }
  auto output = frac::respond(frac::FractionalTransferFunction::parse(plant.formula),
                              frac::SampledInput{time, input, frac::Hold::zero_order}, time, 1e-9)
                    .output;
  double square = 0;
  for (const double each : output) square += each * each;
  const double deviation = 0.03 * std::sqrt(square / count);
  const std::vector<double> noise = support::first_order_noise(count, correlation, random);
  for (std::size_t i = 0; i < count; ++i) output[i] += deviation * noise[i];
  return {time, input, output};
}

}  // namespace

int main(int argc, char** argv) {
  const bool is_smoke = argc > 1 && std::strcmp(argv[1], "--smoke") == 0;
  const int records = is_smoke ? 1 : argc > 1 ? std::atoi(argv[1]) : 50;
  const int first = argc > 2 ? std::atoi(argv[2]) : 1;
  std::vector<frac::NamedModel> models, lags;
  for (const char* name : {"lag", "lag-delay", "oscillator", "fractional-lag", "fractional-lag-delay"})
    models.push_back(frac::find_model(name));
  for (const frac::NamedModel& each : models)
    if (each.name != "oscillator") lags.push_back(each);
  std::printf("# %s, GCC %s\nmodel,correlation,right,undecided,wrong,no candidate,of\n", FRACFIT_BUILD_TYPE,
              __VERSION__);
  for (const Plant& plant : plants) {
    for (const double correlation : {0.0, 0.5, 0.8, 0.95}) {
      int right = 0, undecided = 0, wrong = 0, none = 0;
      for (int i = 0; i < records; ++i) {
        support::Random random(static_cast<std::uint64_t>(first + i) * 1000 +
                               static_cast<std::uint64_t>(100 * correlation));
        const auto result = frac::identify(record_of(plant, correlation, random), plant.among_lags ? lags : models,
                                           frac::TimeFitOptions{}, 1);
        const bool supported = result.verdict == frac::Verdict::fractional_supported;
        if (result.verdict == frac::Verdict::undecided) {
          ++undecided;
        } else if (result.verdict == frac::Verdict::no_adequate_model) {
          ++none;
        } else if (supported == plant.fractional) {
          ++right;
        } else {
          ++wrong;
        }
      }
      std::printf("%s,%g,%d,%d,%d,%d,%d\n", plant.name, correlation, right, undecided, wrong, none, records);
      std::fflush(stdout);
    }
  }
}
