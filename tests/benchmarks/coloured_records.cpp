// SPDX-License-Identifier: BSD-3-Clause
// Verdicts on records over time whose noise is of first order, among presets that hold the true model, and of three
// lags and of an oscillator among lags, which no preset of the list describes: how often the class is right, left open,
// wrong, or no candidate is said to describe the record.  Prints model,correlation,right,undecided,wrong,no
// candidate,of.  Arguments: [records of each kind] [first seed], or --smoke.
// With --fit before them: fits of the true structure in white and in coloured noise, how often their 95 % intervals
// hold the truth, and the root mean square of the errors of the latter over that of the former.
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

/// Parameters are in the order of the formula.
void compare_fits(const Plant& plant, const char* formula, const std::vector<double>& truth, int records, int first) {
  const frac::Structure structure(formula);
  for (const double correlation : {0.0, 0.5, 0.8, 0.95}) {
    std::vector<std::array<int, 2>> held(truth.size(), {0, 0});
    std::vector<std::array<double, 2>> square(truth.size(), {0, 0});
    for (int i = 0; i < records; ++i) {
      support::Random random(static_cast<std::uint64_t>(first + i) * 1000 +
                             static_cast<std::uint64_t>(100 * correlation));
      const frac::TimeResponseData data = record_of(plant, correlation, random);
      for (const frac::RecordNoise noise : frac::record_noises()) {
        const std::size_t at = noise == frac::RecordNoise::coloured ? 1 : 0;
        frac::TimeFitOptions options;
        options.noise = noise;
        const frac::FitResult result = frac::fit(data, structure, options);
        for (std::size_t k = 0; k < truth.size(); ++k) {
          const frac::ParameterEstimate& each = result.parameters[k];
          held[k][at] += each.ci95_lower <= truth[k] && truth[k] <= each.ci95_upper ? 1 : 0;
          square[k][at] += std::pow(each.value - truth[k], 2);
        }
      }
    }
    for (std::size_t k = 0; k < truth.size(); ++k) {
      std::printf("%s,%g,%s,%d,%d,%d,%.3f\n", plant.name, correlation, structure.parameter_names()[k].c_str(),
                  held[k][0], held[k][1], records, std::sqrt(square[k][1] / square[k][0]));
    }
    std::fflush(stdout);
  }
}

int compare_fits(int records, int first) {
  std::printf("# %s, GCC %s\nmodel,correlation,parameter,held in white,held in coloured,of,error over that in white\n",
              FRACFIT_BUILD_TYPE, __VERSION__);
  compare_fits(plants[0], "K/(T s + 1)", {2, 1.5}, records, first);
  compare_fits(plants[5], "K/(T s^a + 1)", {2, 1.5, 0.8}, records, first);
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  const bool fits = argc > 1 && std::strcmp(argv[1], "--fit") == 0;
  if (fits) return compare_fits(argc > 2 ? std::atoi(argv[2]) : 50, argc > 3 ? std::atoi(argv[3]) : 1);
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
