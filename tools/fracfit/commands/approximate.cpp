// SPDX-License-Identifier: BSD-3-Clause
#include "frac/approximation/approximate.hpp"

#include <cmath>

#include "commands/subcommand.hpp"
#include "frac/digital/discretise.hpp"
#include "options/model_options.hpp"
#include "output/approximate_output.hpp"

namespace fracfit {
namespace {

class Approximate : public Command {
 public:
  Approximate() : Command("approximate", "Rational approximation of s^order with its error") {
    Options& o = options();
    o.number("--order", order_, "Order, -20 to 20; its whole part is exact", "ORDER").required();
    o.parsed("--band", band_, band_of, "the error holds there").required();
    add_goal(o, goal_, "on the band; the fewest poles that keep it", "instead of a tolerance");
    o.exactly_one({"--tolerance", "--poles"}, "the error, or the size");
    o.choice("--method", method_, frac::approximation_methods());
    o.number("--sample-time", sample_time_, "gives the recursion in the samples too");
    o.choice("--discretisation", discretisation_, frac::discretisations()).only_with({"--sample-time"});
    o.number("--amplification", amplification_,
             "Most gain between the band and half the sampling frequency, over that of the power; of a falling one "
             "over that at the band's edge",
             "G")
        .only_with({"--discretisation", {"direct"}})
        .only_with({"--sample-time"});
    o.count("--taps", taps_, 1, largest_table, "Memory of grunwald-letnikov, samples", "N")
        .only_with({"--discretisation", {"grunwald-letnikov"}})
        .only_with({"--sample-time"});
    add_common({"json", "csv", "table"});
    set_footer(
        "Examples:\n"
        "  fracfit approximate --order 0.5 --band 1e-3:1e3 --tolerance 1e-6\n"
        "  fracfit approximate --order -0.7 --band 0.01:100 --poles 8 --format table\n"
        "  fracfit approximate --order 0.5 --band 0.01:100 --tolerance 1e-3 --method oustaloup-widened --out s.json\n"
        "  fracfit approximate --order 0.5 --band 0.1:300 --tolerance 1e-4 --sample-time 1e-3");
  }

 private:
  int run() override {
    const frac::ApproximationGoal goal = goal_.goal().value();
    const auto result = frac::approximate(order_, *band_, goal, method_);
    std::optional<frac::DigitalPower> digital;
    if (sample_time_)
      digital =
          frac::digital_power(order_, *band_, goal, *sample_time_, discretisation_, method_, taps_, amplification_);
    const frac::DigitalPower* sampled = digital ? &*digital : nullptr;
    write(format() == "json"  ? approximation_json(result, sampled, command_line())
          : format() == "csv" ? approximation_csv(result, sampled, command_line())
                              : approximation_table(result, sampled));
    if (!missed(result, sampled)) return usable_result;
    if (result.status == frac::ApproximationStatus::not_attainable) say(result.message);
    if (sampled != nullptr && sampled->status == frac::ApproximationStatus::not_attainable) say(sampled->message);
    return no_usable_result;
  }

  double order_ = NAN, amplification_ = 5;
  std::optional<frac::FrequencyBand> band_;
  GoalOptions goal_;
  frac::ApproximationMethod method_ = frac::ApproximationMethod::ladder;
  std::optional<double> sample_time_;
  frac::Discretisation discretisation_ = frac::Discretisation::direct;
  std::size_t taps_ = 1000;
};

}  // namespace

std::unique_ptr<Command> make_approximate() {
  return std::make_unique<Approximate>();
}

}  // namespace fracfit
