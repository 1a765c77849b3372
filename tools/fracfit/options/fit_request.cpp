// SPDX-License-Identifier: BSD-3-Clause
#include "options/fit_request.hpp"

#include <algorithm>
#include <limits>
#include <stdexcept>

#include "frac/identification/outliers.hpp"
#include "io/data_error.hpp"
#include "options/model_options.hpp"
#include "report/measured.hpp"

namespace fracfit {
namespace {

bool names_weight(const std::string& text) {
  const auto weights = frac::weights();
  return std::any_of(weights.begin(), weights.end(),
                     [&](frac::Weight weight) { return text == frac::to_string(weight); });
}

frac::Realisation realisation_of(const FitRequest& request) {
  if (request.realisation == "exact") return frac::ExactRealisation{};
  if (request.realisation == "grunwald-letnikov")
    return frac::GrunwaldLetnikovRealisation{*request.sample_time, request.memory};
  const int poles = static_cast<int>(*request.poles);
  if (request.realisation == "ladder") return frac::LadderRealisation(*request.band, poles);
  return frac::OustaloupRealisation{*request.band, poles};
}

}  // namespace

void add_data(Options& options, FitRequest& request) {
  options
      .text("DATA", request.data,
            "A frequency response as CSV, TSV or as an instrument writes it, or samples over time "
            "(time_s,input,output); - for standard input",
            "FILE")
      .required()
      .names_input();
  add_file_options(options, request.how);
  add_select(options, request.how);
}

void add_residual_options(Options& options, FitRequest& request) {
  constexpr std::size_t most_poles = 1000;
  add_quantity(options, request.quantity);
  auto parts = spellings(frac::components());
  for (auto& immittance : spellings(io::immittances())) parts.push_back(std::move(immittance));
  options
      .parsed(
          "--component", request.component,
          [&request](std::string_view, const std::string& text) {
            request.immittance = io::immittance_from_string(text);
            return request.immittance ? frac::Component::both : frac::component_from_string(text);
          },
          "of data without a real part both is the imaginary one; impedance and admittance are both parts of that one, "
          "made of the other where the file holds that, and the model is one of it")
      .one_of(std::move(parts))
      .otherwise(std::string(frac::to_string(request.component)))
      .only_for(frequency_response);
  options["--quantity"].not_with({"--component", spellings(io::immittances())}, "which are no describing functions");
  options
      .text("--weight", request.weight,
            "relative |data|; absolute nothing; given the file's sigma or weight column, or any column by its name; "
            "smoothed-relative |data| as up to eight neighbours tell it; log-complex: ln of the magnitude ratio and "
            "angle; repeats: the spread of repeated values at each frequency; learned: relative above a floor that the "
            "residuals tell, absolute below it; without it tables of fracfit response are weighed by their sigma")
      .suggest(spellings(frac::weights()));
  options.choice("--loss", request.loss, frac::losses(), "Robust loss", "LOSS");
  const Condition rational{"--realisation", {"oustaloup", "ladder"}}, sampled{"--realisation", {"grunwald-letnikov"}};
  options.text("--realisation", request.realisation, "How powers of s are evaluated", "R")
      .one_of({"exact", "oustaloup", "ladder", "grunwald-letnikov"})
      .only_for(frequency_response);
  options.parsed("--band", request.band, band_of, "of the oustaloup or ladder realisation")
      .only_for(frequency_response)
      .only_with(rational)
      .needed_with(rational);
  options.count("--poles", request.poles, 1, most_poles, "of that realisation")
      .only_for(frequency_response)
      .only_with(rational)
      .needed_with(rational);
  options.number("--sample-time", request.sample_time, "of the Gruenwald-Letnikov realisation")
      .only_for(frequency_response)
      .only_with(sampled)
      .needed_with(sampled);
  options.count("--memory", request.memory, 0, largest_table, "Samples it keeps, 0 for all", "N")
      .only_for(frequency_response)
      .only_with(sampled);
}

void add_assumptions(Options& options, FitRequest& request) {
  options.text("--stable", request.stable, "yes: whatever the data say")
      .one_of({"yes", "no"})
      .default_is("yes, unless the data speak against it")
      .only_for(frequency_response);
  options.text("--dead-time", request.dead_time, "yes: as likely as none; no: no model has one")
      .one_of({"yes", "no"})
      .default_is("where the data speak for one")
      .only_for(frequency_response);
  options.flag("--passive", request.passive).only_for(frequency_response);
}

void add_outliers(Options& options, FitRequest& request) {
  options
      .text("--outliers", request.outliers,
            "What becomes of points that contradict their neighbours on both sides; a robust loss keeps them", "HOW")
      .one_of({"leave-out", "keep"})
      .only_for(frequency_response);
}

void add_points_and_seed(Options& options, FitRequest& request) {
  options.texts("--where", request.where,
                "of re, im, magnitude, omega or f (over time of t, input or output), or of any column of the file");
  options.count("--seed", request.seed, 0, std::numeric_limits<std::uint64_t>::max());
}

frac::FitOptions fit_options(const FitRequest& request) {
  frac::FitOptions options;
  options.component = request.component;
  options.weight = names_weight(request.weight) ? frac::weight_from_string(request.weight) : frac::Weight::given;
  options.loss = request.loss;
  options.realisation = realisation_of(request);
  frac::validate(options.realisation);
  options.seed = request.seed;
  const auto said = [](const std::string& text) { return text.empty() ? std::nullopt : std::optional(text == "yes"); };
  options.assumptions = {said(request.stable), said(request.dead_time), request.passive};
  options.without_noise = request.without_noise;
  return options;
}

io::FrequencyResponseFile read_data(const FitRequest& request, const std::function<void(const std::string&)>& note) {
  return read_data(request, io::read_measurement(request.data, request.how), note);
}

io::FrequencyResponseFile read_data(const FitRequest& request, const io::Measurement& measurement,
                                    const std::function<void(const std::string&)>& note) {
  io::FrequencyResponseReadOptions options;
  if (!names_weight(request.weight)) options.weight_column = request.weight;
  for (const auto& text : request.where) options.where.emplace_back(text);
  options.phase_may_miss = request.component == frac::Component::magnitude;
  options.magnitude_may_miss = request.component == frac::Component::phase;
  options.real_may_miss = request.component == frac::Component::imaginary || request.component == frac::Component::both;
  options.quantity = request.quantity;
  options.immittance = request.immittance;
  options.how = request.how;
  options.repeats_are_points = request.weight == frac::to_string(frac::Weight::repeats);
  if (request.key_column.empty())
    options.curve = request.curve;
  else
    options.rows = {{request.key_column, request.curve}};
  auto file = io::read_frequency_response(measurement, options);
  if (request.weight == "given" && file.data.sigma().empty())
    throw io::DataError(request.data, 0, 0, "has no column sigma or weight; expected one with --weight given");
  for (const auto& text : file.notes) note(request.data + ": " + text);
  return file;
}

void settle_component(FitRequest& request, Options& options, const frac::FrequencyResponseData& data,
                      const std::function<void(const std::string&)>& note) {
  const frac::Component fitted = frac::fitted_component(data, request.component);
  if (fitted == request.component) return;
  request.component = fitted;
  // Of an impedance or admittance the word says what its parts are those of.
  if (!request.immittance) options["--component"].say(std::string(frac::to_string(fitted)));
  note(std::string(frac::imaginary_part_alone));
}

void settle_weight(FitRequest& request, Options& options, const io::FrequencyResponseFile& file,
                   const std::function<void(const std::string&)>& note) {
  if (options["--weight"].is_given() || !io::has_measured_sigma(file)) return;
  request.weight = frac::to_string(frac::Weight::given);
  options["--weight"].say(request.weight);
  note(weighed_by_measured_sigma);
}

std::string where_text(const FitRequest& request) {
  std::string text;
  for (const auto& test : request.where) text += (text.empty() ? "" : " and ") + test;
  return text.empty() ? "all points" : text;
}

frac::ScreenedData screened(const FitRequest& request, const frac::FrequencyResponseData& data,
                            const std::function<void(const std::string&)>& note) {
  frac::ScreenedData result(data, fit_options(request), request.outliers == "keep");
  if (!result.left_out().empty()) note(result.sentence() + ", and taken in with --outliers keep");
  return result;
}

FitRun fit_run(const FitRequest& request, const Options& options, const io::FrequencyResponseFile& file,
               const std::vector<std::size_t>& left_out, std::string command) {
  auto entries = options.entries({"--component", "--weight", "--loss", "--realisation", "--band", "--poles",
                                  "--sample-time", "--memory", "--seed", "--outliers"});
  entries.emplace_back("where", where_text(request));
  FitRun run{std::move(command),       request.data,    file.data.size(), file.data.omega().front(),
             file.data.omega().back(), file.value_unit, file.metadata,    std::move(entries)};
  // Real and imaginary part are judged together, and repeats at one frequency are not points of a sweep.
  if (request.component == frac::Component::both && request.weight != frac::to_string(frac::Weight::repeats)) {
    auto result = frac::validate(file.data, {.most_points = frac::points_in_passing});
    if (!result.model.empty()) {
      run.validity_sentence = report::validity_sentence(result, file);
      run.validity = std::move(result);
    }
  }
  run.assumptions = fit_options(request).assumptions;
  run.frequency_unit = file.data.frequency_unit();
  for (const std::size_t index : left_out) run.left_out.push_back({index, file.data.omega()[index]});
  return run;
}

}  // namespace fracfit
