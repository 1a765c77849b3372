// SPDX-License-Identifier: BSD-3-Clause
// Records of periodic inputs and of inputs held constant or straight: how often 95 % intervals hold the truth and how
// often the message speaks against the hold, by the samples in a period of the highest line.  Prints
// record,fitted,samples,parameter or sentence,share,of.  Arguments: [trials] [first seed], or --smoke.
#include "support/periodic_records.hpp"

#include <array>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <map>
#include <string>

#include "frac/identification/time_fit.hpp"
#include "frac/model/algebra.hpp"

namespace {

using frac::FitResult;
using frac::Hold;
using frac::TimeResponseData;
using support::PeriodicExperiment;

bool speaks_against_hold(const FitResult& result) {
  for (const frac::Advice& each : result.advice) {
    if (each.remedy == frac::Remedy::hold_zero_order || each.remedy == frac::Remedy::hold_first_order ||
        each.remedy == frac::Remedy::hold_band_limited)
      return true;
  }
  return false;
}

/// Steps or straight lines between random levels, which a converter gives.
TimeResponseData held_record(Hold hold, double samples_per_time, support::Random& random) {
  constexpr std::size_t count = 200;
  std::vector<double> time, input, output;
  for (std::size_t i = 0; i < count; ++i) {
    time.push_back(1.5 * static_cast<double>(i) / samples_per_time);
    input.push_back(random.normal());
  }
  const auto exact = frac::respond(frac::FractionalTransferFunction::parse("2/(1.5 s^0.7 + 1)"),
                                   frac::SampledInput{time, input, hold}, time, 1e-10);
  double square = 0;
  for (const double each : exact.output) square += each * each;
  const double deviation = 0.01 * std::sqrt(square / count);
  for (const double each : exact.output) output.push_back(each + 0.3 + deviation * random.normal());
  return {time, input, output, {}, hold};
}

class Table {
 public:
  void add(const std::string& row, bool hit) {
    auto& [hits, of] = count_[row];
    hits += hit ? 1 : 0;
    ++of;
  }
  void print() const {
    for (const auto& [row, each] : count_)
      std::printf("%s,%.3f,%d\n", row.c_str(), 1.0 * each.first / each.second, each.second);
    std::fflush(stdout);
  }

 private:
  std::map<std::string, std::pair<int, int>> count_;
};

/// Intervals of a fit that starts at the truth; of every tenth record the message of a fit that searches.
void judge(Table& table, const std::string& row, const TimeResponseData& data, bool earlier_input, bool searched) {
  static const frac::Structure structure("K/(T s^a + 1)");
  static const std::map<std::string, double> truth{{"K", 2}, {"T", 1.5}, {"a", 0.7}};
  frac::TimeFitOptions options;
  options.earlier_input = earlier_input;
  if (searched) table.add(row + ",against the hold", speaks_against_hold(frac::fit(data, structure, options)));
  options.global_start = false;
  for (const auto& [name, value] : truth) options.constraints.push_back({name, {}, {}, {}, value});
  const FitResult result = frac::fit(data, structure, options);
  for (const frac::ParameterEstimate& each : result.parameters) {
    const auto exact = truth.find(each.name);
    if (exact != truth.end())
      table.add(row + "," + each.name, each.ci95_lower <= exact->second && exact->second <= each.ci95_upper);
  }
}

}  // namespace

int main(int argc, char** argv) {
  const bool is_smoke = argc > 1 && std::strcmp(argv[1], "--smoke") == 0;
  const int trials = is_smoke ? 1 : argc > 1 ? std::atoi(argv[1]) : 200;
  const int first = argc > 2 ? std::atoi(argv[2]) : 1;
  std::printf("# %s, GCC %s, %d trials\nrecord,fitted,samples,what,share,of\n", FRACFIT_BUILD_TYPE, __VERSION__,
              trials);
  for (const double samples : {3.0, 3.4, 5.0, 8.0, 12.0, 20.0}) {
    Table table;
    for (int trial = 0; trial < trials; ++trial) {
      const bool searched = trial % 10 == 0;
      support::Random random(static_cast<std::uint64_t>(1000 * (first + trial)) +
                             static_cast<std::uint64_t>(10 * samples));
      PeriodicExperiment scene;
      scene.samples_per_period = samples;
      const std::string count = std::to_string(samples).substr(0, 4);
      const TimeResponseData whole = support::periodic_record(scene, Hold::band_limited, random);
      judge(table, "steady 2 periods,band-limited," + count, whole, false, searched);
      judge(table, "steady 2 periods,first-order earlier," + count, support::with_hold(whole, Hold::first_order), true,
            searched);
      scene.periods = 1;
      judge(table, "steady 1 period,band-limited," + count, support::periodic_record(scene, Hold::band_limited, random),
            false, searched);
      scene.periods = 2.6;
      judge(table, "steady 2.6 periods,band-limited," + count,
            support::periodic_record(scene, Hold::band_limited, random), false, searched);
      scene.periods = 2;
      scene.from_rest = true;
      const TimeResponseData rest = support::periodic_record(scene, Hold::band_limited, random);
      judge(table, "from rest 2 periods,band-limited earlier," + count, rest, true, searched);
      judge(table, "held,zero-order," + count, held_record(Hold::zero_order, samples, random), false, searched);
      judge(table, "straight,first-order," + count, held_record(Hold::first_order, samples, random), false, searched);
      judge(table, "held,first-order," + count,
            support::with_hold(held_record(Hold::zero_order, samples, random), Hold::first_order), false, searched);
    }
    table.print();
  }
}
