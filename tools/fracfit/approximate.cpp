#include "frac/approximate.hpp"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <limits>
#include <memory>
#include <stdexcept>

#include "approximate_output.hpp"
#include "common_options.hpp"
#include "exit_code.hpp"
#include "subcommand.hpp"

namespace fracfit {
namespace {

struct ApproximateArguments {
  CommonOptions common;
  std::string order, band, tolerance, poles, sample_time;
  std::string method = "ladder";
};

frac::ApproximationGoal goal_of(const ApproximateArguments& given) {
  if (given.tolerance.empty() == given.poles.empty())
    throw std::invalid_argument("expected either --tolerance or --poles");
  if (!given.tolerance.empty()) return frac::Tolerance{number_option("--tolerance", given.tolerance)};
  const std::size_t poles = count_option("--poles", given.poles, 1);
  // Whether it is too many depends on the method, which the library knows.
  constexpr std::size_t most = std::numeric_limits<int>::max();
  return frac::PoleCount{static_cast<int>(std::min(poles, most))};
}

int run_approximate(const ApproximateArguments& given) {
  const io::OutputFile out(given.common.out);
  if (!given.sample_time.empty())
    throw std::invalid_argument(
        "--sample-time is not available in this version; the result is the continuous-time approximation");
  const auto [lower, upper] = range_option("--band", given.band);
  const auto goal = goal_of(given);
  const auto result = frac::approximate(number_option("--order", given.order),
                                        {number_option("--band", lower), number_option("--band", upper)}, goal,
                                        frac::approximation_method(given.method));
  CommandLine command("approximate");
  command.option("--order", given.order).option("--band", given.band);
  command.option(given.poles.empty() ? "--tolerance" : "--poles", given.poles.empty() ? given.tolerance : given.poles);
  command.option("--method", given.method);

  const std::string format = chosen_format(given.common, "json");
  out.write(format == "json"  ? approximation_json(result, command.text())
            : format == "csv" ? approximation_csv(result, command.text())
                              : approximation_table(result));
  if (result.status != frac::ApproximationStatus::not_attainable) return usable_result;
  say(given.common, result.message);
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
  std::string names;
  for (const auto method : frac::approximation_methods())
    names += (names.empty() ? "" : ", ") + std::string(frac::to_string(method));
  approximate->add_option("--method", given->method, names)->capture_default_str()->type_name("METHOD");
  approximate->add_option("--sample-time", given->sample_time, "Sample time, s; not available in this version")
      ->type_name("TS");
  add_common_options(*approximate, given->common, {"json", "csv", "table"});
  approximate->footer(
      "Examples:\n"
      "  fracfit approximate --order 0.5 --band 1e-3:1e3 --tolerance 1e-6\n"
      "  fracfit approximate --order -0.7 --band 0.01:100 --poles 8 --format table\n"
      "  fracfit approximate --order 0.5 --band 0.01:100 --tolerance 1e-3 --method oustaloup-widened --out s.json");
  approximate->callback([given, &run] { run = [given] { return run_approximate(*given); }; });
}

}  // namespace fracfit
