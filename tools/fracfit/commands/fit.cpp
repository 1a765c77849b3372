// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <optional>
#include <stdexcept>

#include "commands/subcommand.hpp"
#include "frac/identification/component_power_law.hpp"
#include "frac/identification/screened_fit.hpp"
#include "frac/structure.hpp"
#include "io/output_file.hpp"
#include "io/time_series_file.hpp"
#include "options/fit_request.hpp"
#include "options/model_choice.hpp"
#include "options/time_request.hpp"
#include "output/fit_output.hpp"
#include "output/fit_statistics.hpp"

namespace fracfit {
namespace {

std::vector<std::string> names_of_models() {
  auto names = preset_names();
  names.emplace_back(frac::component_power_law_name);
  return names;
}

class Fit : public Command {
 public:
  Fit() : Command("fit", "Fits one structure to a frequency response, or to samples of input and output over time") {
    constexpr std::size_t fewest_samples = 20;
    Options& o = options();
    add_data(o, request_);
    o.text("--model", model_, "or a preset; letters other than s are parameters")
        .suggest(names_of_models())
        .or_argument();
    o.choice("--grow", grow_, frac::growth_families(),
             "Instead of --model a family, grown by a term at a time while the data pay for it", "FAMILY");
    o.exactly_one({"--model", "--grow"}, "the structure, or the family to grow it in");
    add_residual_options(o, request_);
    add_assumptions(o, request_);
    add_time_options(o, over_time_);
    add_points_and_seed(o, request_);
    add_outliers(o, request_);
    add_parameter_options(o, parameters_);
    add_prior_options(o, parameters_);
    for (const char* name : {"--prior", "--constraint"})
      o[name].not_with({"--grow"}, "whose parameters the data choose");
    o.flag("--profile", statistics_.profile,
           "Add profile-likelihood intervals of every parameter: they follow the cost itself");
    o.count("--bootstrap", bootstrap_, fewest_samples, largest_table,
            "Add intervals from N refits to resampled residuals, N >= 20", "N")
        .not_with({"--prior"}, "which no residual can resample");
    o.text("--refits", statistics_.refits_file,
           "The parameters of each refit, as they come; after an interruption the same command goes on with "
           "FILE.partial",
           "FILE")
        .only_with({"--bootstrap"})
        .unsaid();
    o.texts("--derive", derive_).not_with({"--grow"}, "whose parameters the data choose");
    add_common({"json", "csv", "table"});
    set_footer(
        "Samples over time take --weight given (the default where the file has a column sigma) or absolute, --where\n"
        "with t (s), input or output (the input drives the model throughout), and none of --component, --realisation,\n"
        "--band, --poles, --sample-time and --memory.\n"
        "Presets:\n" +
        preset_list() + "  " + std::string(frac::component_power_law_name) +
        "  K w^b, w the frequency: of the component fitted, by itself; no transfer function\n"
        "Examples:\n"
        "  fracfit fit curve.csv --component imaginary --model power-law --where 'omega<4'\n"
        "  fracfit fit curve.csv --model component-power-law --component imaginary --quantity minus-inverse\n"
        "  fracfit fit cell.csv --model 'R0 + R1/(1 + R1 Q1 s^n1)' --bound n1=:1 --profile\n"
        "  fracfit fit cell.csv --model zarc --derive 'f1 = (R1 Q1)^(-1/n1)/(2 pi)'\n"
        "  fracfit fit cell.csv --model zarc --prior R0=0.1+-5% --prior n1=0.9+-0.05\n"
        "  fracfit fit cell.csv --model two-zarc --constraint 'Q1<Q2'\n"
        "  fracfit fit cell.csv --grow arcs\n"
        "  fracfit fit step.csv --model 'K exp(-L s)/(T s^a + 1)'      # columns time_s,input,output\n"
        "  fracfit fit curve.csv --model 'K/(T s^a + 1)' --where 'omega<4' --realisation oustaloup --band 0.01:1000 "
        "--poles 9 --out fit.json");
  }

 private:
  void check() override {
    if (grow_) {
      chosen_.constraints = constraints_of(chosen_, parameters_);
      if (!chosen_.constraints.empty() && !frac::names_persist(*grow_))
        throw std::invalid_argument("--fix, --bound and --start have no meaning with --grow " +
                                    std::string(frac::to_string(*grow_)) +
                                    ", whose parameters differ from structure to structure");
    } else {
      // What both parts mean the data tell.
      chosen_ = !is_component_law()                           ? chosen_model(model_)
                : request_.component == frac::Component::both ? law_of(frac::Component::imaginary)
                                                              : law_of(request_.component);
      // Names and ranges of the parameters of a family are known with the data only.
      if (!chosen_.is_family()) {
        const frac::Structure parsed(chosen_.formula);
        chosen_.constraints = constraints_of(chosen_, parameters_);
        // Over time a fit has the output at rest and its drift among its parameters.
        auto names = parsed.parameter_names();
        names.insert(names.end(), {"offset", "drift"});
        static_cast<void>(quantities(names));
      }
    }
    statistics_.bootstrap_samples = bootstrap_.value_or(0);
    if (statistics_.refits_file.empty()) return;
    if (statistics_.refits_file == "-") throw std::invalid_argument("--refits takes the name of a file");
    static_cast<void>(io::OutputFile(statistics_.refits_file, {request_.data}));
  }

  [[nodiscard]] bool is_component_law() const { return model_ == frac::component_power_law_name; }
  [[nodiscard]] static frac::NamedModel law_of(frac::Component component) {
    try {
      return frac::component_power_law(component);
    } catch (const std::invalid_argument& error) {
      throw std::invalid_argument("--" + std::string(error.what()));
    }
  }
  /// What of the data is fitted.
  [[nodiscard]] frac::FrequencyResponseData fitted_part(const frac::FrequencyResponseData& data) const {
    return is_component_law() ? frac::component_alone(data, request_.component) : data;
  }

  [[nodiscard]] std::vector<frac::DerivedQuantity> quantities(const std::vector<std::string>& names) const {
    return quantities_of(derive_, names);
  }

  [[nodiscard]] frac::ModelRequest asked() const {
    return {chosen_, grow_, [this](const frac::NamedModel& member) { return constraints_of(member, parameters_); },
            is_component_law()};
  }

  template <class Data, class FitOptions>
  int write_fit(const Data& data, const FitOptions& wanted, const frac::ModelFit& made, const FitRun& run) {
    const frac::FitResult& result = made.result;
    auto asked = statistics_;
    asked.command = command_line();
    auto statistics = fit_statistics(data, made.options_from(wanted), result, asked, threads());
    statistics.growth = made.growth;
    std::vector<std::string> names;
    for (const auto& parameter : result.parameters) names.push_back(parameter.name);
    statistics.derived = frac::derived_estimates(result, quantities(names));
    for (const auto& derived : statistics.derived)
      if (!std::isfinite(derived.value)) say("--derive: " + derived.formula + " is no finite number at the estimates");
    write(format() == "json"  ? fit_json(run, result, statistics)
          : format() == "csv" ? fit_csv(run, result, statistics)
                              : fit_table(run, result, statistics));
    const auto& parameters = result.parameters;
    const bool some_identified =
        result.free_parameters == 0 || std::any_of(parameters.begin(), parameters.end(),
                                                   [](const auto& each) { return each.identified && !each.fixed; });
    // As few values as parameters determine none of them unless they are met.
    if (result.termination == frac::FitTermination::converged &&
        (some_identified || result.residuals > result.free_parameters)) {
      if (!some_identified && !result.without_noise) say("none of the parameters is identified");
      return usable_result;
    }
    say("no usable result: " + result.message);
    return no_usable_result;
  }

  /// What is known of the parameters beside the data.
  void add_known(FitRun& about) const {
    if (!parameters_.prior.empty()) about.options.emplace_back("priors", joined(parameters_.prior));
    if (!parameters_.order.empty()) about.options.emplace_back("constraints", joined(parameters_.order));
  }

  int run() override {
    const auto note = [this](const std::string& text) { say(text); };
    if (io::holds_time_response(request_.data, request_.how)) {
      options().settle(samples_over_time);
      if (is_component_law())
        throw std::invalid_argument("--model " + model_ + " has no meaning with " + samples_over_time);
      const auto fit = time_fit_options(request_, over_time_, options(), chosen_.constraints);
      const auto record = read_time_record(request_, over_time_, options(), note);
      FitRun about = time_fit_run(request_, record, options(), command_line());
      add_known(about);
      // The offset is held by an option of its own.
      frac::ModelRequest request = asked();
      request.model.constraints = fit.constraints;
      return write_fit(record.data, fit, frac::fit(record.data, request, fit), about);
    }
    options().settle(frequency_response);
    auto wanted = fit_options(request_);
    const auto file = read_data(request_, note);
    settle_component(request_, options(), file.data,
                     [&](const std::string& text) { say(request_.data + ": " + text); });
    settle_weight(request_, options(), file, [&](const std::string& text) { say(request_.data + ": " + text); });
    request_.without_noise = io::is_computed(file.metadata);
    wanted = fit_options(request_);
    if (is_component_law()) {
      chosen_ = law_of(request_.component);
      chosen_.constraints = constraints_of(chosen_, parameters_);
    }
    auto points = screened(request_, file.data, note);
    const auto made = frac::fit(points, asked(), wanted);
    if (!points.taken_back().empty()) say(points.taken_back());
    auto about = fit_run(request_, options(), file, points.left_out(), command_line());
    add_known(about);
    if (is_component_law()) about.law = frac::component_power_law_sentence(request_.component);
    return write_fit(fitted_part(points.kept()), wanted, made, about);
  }

  FitRequest request_;
  std::string model_;
  std::vector<std::string> derive_;
  std::optional<frac::GrowthFamily> grow_;
  frac::NamedModel chosen_{};
  ParameterOptions parameters_;
  TimeRequest over_time_;
  StatisticsRequest statistics_;
  std::optional<std::size_t> bootstrap_;
};

}  // namespace

std::unique_ptr<Command> make_fit() {
  return std::make_unique<Fit>();
}

}  // namespace fracfit
