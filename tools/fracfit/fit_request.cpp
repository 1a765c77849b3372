// SPDX-License-Identifier: BSD-3-Clause
#include "fit_request.hpp"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <limits>
#include <stdexcept>

#include "choice.hpp"
#include "io/data_error.hpp"
#include "io/number.hpp"

namespace fracfit {
namespace {

bool names_weight(const std::string& text) {
  const auto weights = frac::weights();
  return std::any_of(weights.begin(), weights.end(),
                     [&](frac::Weight weight) { return text == frac::to_string(weight); });
}

void refuse(const std::string& realisation, std::initializer_list<std::pair<const char*, const std::string*>> options) {
  for (const auto& [name, text] : options)
    if (!text->empty())
      throw std::invalid_argument(std::string(name) + " has no meaning with --realisation " + realisation);
}

void require(const std::string& realisation,
             std::initializer_list<std::pair<const char*, const std::string*>> options) {
  for (const auto& [name, text] : options)
    if (text->empty()) throw std::invalid_argument("--realisation " + realisation + " needs " + name);
}

frac::Realisation realisation_of(const FitRequest& request) {
  const auto& kind = request.realisation;
  if (kind == "exact") {
    refuse(kind, {{"--band", &request.band},
                  {"--poles", &request.poles},
                  {"--sample-time", &request.sample_time},
                  {"--memory", &request.memory}});
    return frac::ExactRealisation{};
  }
  if (kind == "oustaloup" || kind == "ladder") {
    refuse(kind, {{"--sample-time", &request.sample_time}, {"--memory", &request.memory}});
    require(kind, {{"--band", &request.band}, {"--poles", &request.poles}});
    const auto [lower, upper] = range_option("--band", request.band);
    constexpr std::size_t most_poles = 1000;
    const std::size_t poles = count_option("--poles", request.poles, 1, most_poles);
    const frac::FrequencyBand band{number_option("--band", lower), number_option("--band", upper)};
    if (kind == "ladder") return frac::LadderRealisation(band, static_cast<int>(poles));
    return frac::OustaloupRealisation{band, static_cast<int>(poles)};
  }
  refuse(kind, {{"--band", &request.band}, {"--poles", &request.poles}});
  require(kind, {{"--sample-time", &request.sample_time}});
  const std::size_t memory = request.memory.empty() ? 0 : count_option("--memory", request.memory, 0);
  return frac::GrunwaldLetnikovRealisation{number_option("--sample-time", request.sample_time), memory};
}

io::Metadata realisation_entries(const frac::Realisation& realisation) {
  io::Metadata entries{{"realisation", frac::to_string(realisation)}};
  const auto add_ladder = [&](const frac::FrequencyBand& band, int poles) {
    entries.emplace_back("band", io::format_number(band.lower) + ":" + io::format_number(band.upper));
    entries.emplace_back("poles", std::to_string(poles));
  };
  if (const auto* oustaloup = std::get_if<frac::OustaloupRealisation>(&realisation)) {
    add_ladder(oustaloup->band, oustaloup->poles);
  }
  if (const auto* ladder = std::get_if<frac::LadderRealisation>(&realisation)) {
    add_ladder(ladder->band(), ladder->poles());
  }
  if (const auto* difference = std::get_if<frac::GrunwaldLetnikovRealisation>(&realisation)) {
    entries.emplace_back("sample-time", io::format_number(difference->sample_time));
    entries.emplace_back("memory", std::to_string(difference->memory_length));
  }
  return entries;
}

}  // namespace

void add_fit_options(CLI::App& subcommand, FitRequest& request) {
  subcommand
      .add_option("DATA", request.data,
                  "CSV or TSV with a header naming columns and units: a frequency response, or samples over time "
                  "(time_s,input,output); - for standard input")
      ->required()
      ->type_name("FILE");
  add_residual_options(subcommand, request);
}

void add_residual_options(CLI::App& subcommand, FitRequest& request) {
  subcommand.add_option("--component", request.component, "Part fitted (default imaginary)")
      ->type_name("PART")
      ->check(one_of(spellings(frac::components())));
  subcommand
      .add_option(
          "--weight", request.weight,
          "Residuals are divided by: relative |data|; absolute nothing; given the file's sigma or weight column, or "
          "any column by its name; smoothed-relative |data| as up to eight neighbours tell it; log-complex: ln of "
          "the magnitude ratio and angle; repeats: the spread of repeated values at each frequency")
      ->each([&request](const std::string&) { request.weight_is_given = true; })
      ->capture_default_str()
      ->type_name("WEIGHT")
      ->check(suggest(spellings(frac::weights())));
  subcommand.add_option("--loss", request.loss, "Robust loss")
      ->capture_default_str()
      ->type_name("LOSS")
      ->check(one_of(spellings(frac::losses())));
  subcommand.add_option("--realisation", request.realisation, "How powers of s are evaluated")
      ->capture_default_str()
      ->type_name("R")
      ->check(one_of({"exact", "oustaloup", "ladder", "grunwald-letnikov"}));
  subcommand.add_option("--band", request.band, "Band of the oustaloup or ladder realisation, rad/s")
      ->type_name("LOW:HIGH");
  subcommand.add_option("--poles", request.poles, "Poles of that realisation per power of s")->type_name("N");
  subcommand.add_option("--sample-time", request.sample_time, "Sample time of the Gruenwald-Letnikov realisation, s")
      ->type_name("T");
  subcommand.add_option("--memory", request.memory, "Samples it keeps, 0 for all (default)")->type_name("N");
  add_repeatable(
      subcommand, "--where", request.where,
      "Use only points that satisfy a comparison of re, im, magnitude, omega or f (over time: t, input or output), or "
      "of any column of the file, with a number; repeatable",
      "TEST");
  subcommand.add_option("--seed", request.seed, "Seed of the random starts; same seed, same result")
      ->capture_default_str()
      ->type_name("N");
}

std::uint64_t seed_of(const FitRequest& request) {
  return count_option("--seed", request.seed, 0, std::numeric_limits<std::uint64_t>::max());
}

frac::FitOptions fit_options(const FitRequest& request) {
  frac::FitOptions options;
  if (!request.component.empty()) options.component = frac::component_from_string(request.component);
  options.weight = names_weight(request.weight) ? frac::weight_from_string(request.weight) : frac::Weight::given;
  options.loss = frac::loss_from_string(request.loss);
  options.realisation = realisation_of(request);
  frac::validate(options.realisation);
  options.seed = seed_of(request);
  return options;
}

io::FrequencyResponseFile read_data(const FitRequest& request, const CommonOptions& common) {
  io::FrequencyResponseReadOptions options;
  if (!names_weight(request.weight)) options.weight_column = request.weight;
  for (const auto& text : request.where) options.where.emplace_back(text);
  options.phase_may_miss = request.component == frac::to_string(frac::Component::magnitude);
  options.magnitude_may_miss = request.component == frac::to_string(frac::Component::phase);
  if (request.key_column.empty())
    options.curve = request.curve;
  else
    options.rows = {{request.key_column, request.curve}};
  auto file = io::read_frequency_response(request.data, options);
  if (request.weight == "given" && file.data.sigma().empty())
    throw io::DataError(request.data, 0, 0, "has no column sigma or weight; expected one with --weight given");
  for (const auto& note : file.notes) say(common, request.data + ": " + note);
  return file;
}

void append_to(CommandLine& command, const FitRequest& request, const frac::FitOptions& options) {
  command.option("--component", std::string(frac::to_string(options.component)))
      .option("--weight", request.weight)
      .option("--loss", request.loss);
  for (const auto& [key, value] : realisation_entries(options.realisation)) command.option("--" + key, value);
  for (const auto& test : request.where) command.option("--where", test);
  command.option("--seed", request.seed);
}

FitRun fit_run(const FitRequest& request, const frac::FitOptions& options, const io::FrequencyResponseFile& file,
               std::string command) {
  io::Metadata entries{{"component", std::string(frac::to_string(options.component))},
                       {"weight", request.weight},
                       {"loss", request.loss}};
  for (auto& entry : realisation_entries(options.realisation)) entries.push_back(std::move(entry));
  entries.emplace_back("seed", std::to_string(options.seed));
  std::string where;
  for (const auto& test : request.where) where += (where.empty() ? "" : " and ") + test;
  entries.emplace_back("where", where.empty() ? "all points" : where);
  return {std::move(command),       request.data,    file.data.size(), file.data.omega().front(),
          file.data.omega().back(), file.value_unit, file.metadata,    std::move(entries)};
}

}  // namespace fracfit
