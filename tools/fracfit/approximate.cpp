// SPDX-License-Identifier: BSD-3-Clause
#include "frac/approximation/approximate.hpp"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <limits>
#include <memory>
#include <optional>
#include <stdexcept>

#include "approximate_output.hpp"
#include "choice.hpp"
#include "common_options.hpp"
#include "exit_code.hpp"
#include "frac/digital/discretise.hpp"
#include "subcommand.hpp"

namespace fracfit {
namespace {

struct ApproximateArguments {
  CommonOptions common;
  std::string order, band, tolerance, poles, sample_time;
  std::string method = "ladder";
  std::string discretisation = "direct", taps = "1000", amplification = "5";
};

frac::ApproximationGoal goal_of(const ApproximateArguments& given) {
  if (given.tolerance.empty() == given.poles.empty())
    throw std::invalid_argument("expected either --tolerance or --poles");
  if (!given.tolerance.empty()) return frac::Tolerance{number_option("--tolerance", given.tolerance)};
  // Whether it is too many depends on the method, which the library knows.
  constexpr std::size_t most = std::numeric_limits<int>::max();
  return frac::PoleCount{static_cast<int>(
      std::min(most, count_option("--poles", given.poles, 1, std::numeric_limits<std::size_t>::max())))};
}

int run_approximate(const ApproximateArguments& given) {
  const io::OutputFile out(given.common.out);
  const auto [lower, upper] = range_option("--band", given.band);
  const auto goal = goal_of(given);
  const double order = number_option("--order", given.order);
  const frac::FrequencyBand band{number_option("--band", lower), number_option("--band", upper)};
  const auto method = frac::approximation_method(given.method);
  const auto result = frac::approximate(order, band, goal, method);
  std::optional<frac::DigitalPower> digital;
  if (!given.sample_time.empty()) {
    digital =
        frac::digital_power(order, band, goal, number_option("--sample-time", given.sample_time),
                            frac::discretisation(given.discretisation), method, count_option("--taps", given.taps, 1),
                            number_option("--amplification", given.amplification));
  }
  CommandLine command("approximate");
  command.option("--order", given.order).option("--band", given.band);
  command.option(given.poles.empty() ? "--tolerance" : "--poles", given.poles.empty() ? given.tolerance : given.poles);
  command.option("--method", given.method);
  if (digital) {
    command.option("--sample-time", given.sample_time).option("--discretisation", given.discretisation);
    if (digital->method == frac::Discretisation::grunwald_letnikov) command.option("--taps", given.taps);
    if (digital->method == frac::Discretisation::direct) command.option("--amplification", given.amplification);
  }
  const frac::DigitalPower* sampled = digital ? &*digital : nullptr;

  const std::string format = chosen_format(given.common, "json");
  out.write(format == "json"  ? approximation_json(result, sampled, command.text())
            : format == "csv" ? approximation_csv(result, sampled, command.text())
                              : approximation_table(result, sampled));
  if (!missed(result, sampled)) return usable_result;
  if (result.status == frac::ApproximationStatus::not_attainable) say(given.common, result.message);
  if (sampled != nullptr && sampled->status == frac::ApproximationStatus::not_attainable)
    say(given.common, sampled->message);
  return no_usable_result;
}

}  // namespace

void add_approximate(CLI::App& program, Run& run) {
  const auto given = std::make_shared<ApproximateArguments>();
  auto* approximate = program.add_subcommand("approximate", "Rational approximation of s^order with its error");
  approximate->add_option("--order", given->order, "Order, -20 to 20; its whole part is exact")
      ->required()
      ->type_name("ORDER");
  approximate->add_option("--band", given->band, "Band on which the error holds, rad/s")
      ->required()
      ->type_name("LOW:HIGH");
  approximate->add_option("--tolerance", given->tolerance, "Largest relative error; the fewest poles that keep it")
      ->type_name("T");
  approximate->add_option("--poles", given->poles, "Number of poles, instead of a tolerance")->type_name("N");
  approximate->add_option("--method", given->method, "Design")
      ->capture_default_str()
      ->type_name("METHOD")
      ->check(one_of(spellings(frac::approximation_methods())));
  approximate
      ->add_option("--sample-time", given->sample_time,
                   "Time between samples, s: gives the recursion in the samples too")
      ->type_name("TS");
  approximate->add_option("--discretisation", given->discretisation, "How the recursion is made")
      ->capture_default_str()
      ->type_name("METHOD")
      ->check(one_of(spellings(frac::discretisations())));
  approximate
      ->add_option("--amplification", given->amplification,
                   "Of direct: most gain between the band and half the sampling frequency, over that of the power")
      ->capture_default_str()
      ->type_name("G");
  approximate->add_option("--taps", given->taps, "Memory of grunwald-letnikov, samples")
      ->capture_default_str()
      ->type_name("N");
  add_common_options(*approximate, given->common, {"json", "csv", "table"});
  approximate->footer(
      "Examples:\n"
      "  fracfit approximate --order 0.5 --band 1e-3:1e3 --tolerance 1e-6\n"
      "  fracfit approximate --order -0.7 --band 0.01:100 --poles 8 --format table\n"
      "  fracfit approximate --order 0.5 --band 0.01:100 --tolerance 1e-3 --method oustaloup-widened --out s.json\n"
      "  fracfit approximate --order 0.5 --band 0.1:300 --tolerance 1e-4 --sample-time 1e-3");
  approximate->callback([given, &run] { run = [given] { return run_approximate(*given); }; });
}

}  // namespace fracfit
