// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <optional>
#include <stdexcept>

#include "backlash/minus_inverse.hpp"
#include "backlash/static_backlash.hpp"
#include "commands/subcommand.hpp"
#include "frac/identification/cross_validation.hpp"
#include "frac/identification/economy.hpp"
#include "frac/identification/screened_fit.hpp"
#include "frac/structure.hpp"
#include "io/number.hpp"
#include "io/time_series_file.hpp"
#include "options/fit_request.hpp"
#include "options/model_choice.hpp"
#include "options/time_request.hpp"
#include "output/fit_output.hpp"

namespace fracfit {
namespace {

// rms of cross-validation for each candidate.
template <class Data, class Options>
std::vector<double> prediction_rms(const Data& data, const Options& options, const frac::IdentificationResult& result,
                                   std::size_t folds, const Command& command) {
  const auto found = frac::cross_validations(data, options, result, folds, command.threads());
  for (const auto& note : found.notes) command.say(note);
  return found.rms;
}

class Identify : public Command {
 public:
  Identify()
      : Command("identify",
                "Ranks fractional, integer-order and static-backlash structures on a frequency response, or the first "
                "two on samples of input and output over time") {
    Options& o = options();
    add_data(o, request_);
    o.text("--models", models_text_,
           "and families such as rational:1..8, rational:2/4, rational:1..4+delay, commensurate:1..3, terms:5, "
           "elements:6")
        .default_is("all presets, rational, rational+delay, commensurate, commensurate+delay, terms and elements");
    add_residual_options(o, request_);
    add_assumptions(o, request_);
    over_time_.noise = frac::RecordNoise::coloured;
    add_time_options(o, over_time_);
    add_points_and_seed(o, request_);
    add_outliers(o, request_);
    o.texts("--bound", bounds_, "of every candidate that is a preset or a formula and has the parameter");
    const auto of_static_backlash = [&](const char* name, std::optional<double>& value) -> Option& {
      return o.number(name, value, "of the static-backlash candidate").only_for(frequency_response);
    };
    of_static_backlash("--clearance", clearance_);
    of_static_backlash("--force", force_);
    of_static_backlash("--mass1", mass1_).default_is("1");
    of_static_backlash("--mass2", mass2_).default_is("1");
    o.count("--folds", folds_, 2, largest_table,
            "Cross-validate each candidate: predict each of K blocks of neighbouring points from the others", "K");
    add_common({"json", "csv", "table"});
    set_footer(
        "Samples over time take and refuse the same options as in fit, and none of --clearance, --force, --mass1 and "
        "--mass2.\n"
        "Examples:\n"
        "  fracfit identify curve.csv --component imaginary --where 'omega<4'\n"
        "  fracfit identify step.csv --models 'lag,lag-delay,oscillator,fractional-lag,fractional-lag-delay'\n"
        "  fracfit identify cell.csv --models 'zarc,two-zarc,r-rc,two-rc' --out ranking.json\n"
        "  fracfit identify curve.csv --component imaginary --where 'omega<4' --clearance 0.3 --force 40 --format "
        "table");
  }

 private:
  void check() override { models_ = bounded(chosen_models(models_text_)); }

  /// The candidates with the limits of --bound, each with those of its own parameters.
  [[nodiscard]] std::vector<frac::NamedModel> bounded(std::vector<frac::NamedModel> models) const {
    for (const auto& text : bounds_) {
      const std::string name = text.substr(0, text.find('='));
      bool known = false;
      for (auto& model : models) {
        if (model.is_family()) continue;
        const auto names = frac::Structure(model.formula).parameter_names();
        if (std::find(names.begin(), names.end(), name) == names.end()) continue;
        known = true;
        ParameterOptions given;
        given.bound = {text};
        model.constraints = constraints_of(model, given);
      }
      if (!known)
        throw std::invalid_argument("--bound " + io::quoted(text) +
                                    ": no candidate that is a preset or a formula has a parameter " + io::quoted(name));
    }
    return models;
  }

  // Takes from the header that `simulate` writes what the options leave open.
  // @return whether there is a static-backlash candidate
  bool complete_scene(const io::Metadata& header) {
    const bool in_header = io::find_value(header, "force_n") && io::find_value(header, "clearance_m");
    if (!force_ && !clearance_ && !in_header) {
      if (mass1_ || mass2_)
        throw std::invalid_argument(
            "--mass1 and --mass2 have no meaning without --force and --clearance, which add the static-backlash curve");
      return false;
    }
    std::string taken;
    const auto complete = [&](const char* name, std::optional<double>& value, const char* key) {
      if (value) return;
      const auto found = io::find_value(header, key);
      if (!found) return;
      value = number_of(name, std::string(*found));
      options()[name].say(std::string(*found));
      taken += (taken.empty() ? "" : ", ") + std::string(key) + " = " + std::string(*found);
    };
    complete("--force", force_, "force_n");
    complete("--clearance", clearance_, "clearance_m");
    complete("--mass1", mass1_, "mass1_kg");
    complete("--mass2", mass2_, "mass2_kg");
    if (!force_) throw std::invalid_argument("--clearance needs --force for the static-backlash curve");
    if (!clearance_) throw std::invalid_argument("--force needs --clearance for the static-backlash curve");
    for (const auto& [name, value] : {std::pair{"--mass1", &mass1_}, std::pair{"--mass2", &mass2_}}) {
      if (*value) continue;
      *value = 1;
      options()[name].say("1");
    }
    if (!taken.empty()) say(request_.data + ": the static-backlash curve takes from the header " + taken);
    return true;
  }

  template <class Data, class FitOptions>
  int write_ranking(const Data& data, const FitOptions& fit, const frac::IdentificationResult& result,
                    const FitRun& run) {
    for (const auto& skipped : result.skipped) say("skipped " + skipped);
    const auto predictions = folds_ ? prediction_rms(data, fit, result, *folds_, *this) : std::vector<double>{};
    write(format() == "json"  ? identification_json(run, result, predictions)
          : format() == "csv" ? identification_csv(run, result, predictions)
                              : identification_table(run, result, predictions));
    if (result.ranking.at(result.chosen).fit.termination == frac::FitTermination::converged) return usable_result;
    say("no usable result: " + result.ranking.at(result.chosen).fit.message);
    return no_usable_result;
  }

  void check_folds(std::size_t points) const {
    if (folds_ && *folds_ > points)
      throw std::invalid_argument("--folds " + std::to_string(*folds_) + ": more than the " + std::to_string(points) +
                                  " points of " + request_.data);
  }

  int run_over_time() {
    options().settle(samples_over_time);
    auto fit = time_fit_options(request_, over_time_, options(), {});
    const auto record =
        read_time_record(request_, over_time_, options(), [this](const std::string& note) { say(note); });
    check_folds(record.data.observed().size());
    if (models_text_.empty()) models_ = bounded(frac::default_candidates_over_time());
    const auto result = frac::identify(record.data, models_, fit, threads());
    fit.noise = frac::RecordNoise::white;  // of the correlation that was found
    fit.noise_correlation = result.noise_correlation;
    return write_ranking(record.data, fit, result, time_fit_run(request_, record, options(), command_line()));
  }

  std::optional<frac::Economy> economy_of(const frac::FrequencyResponseData& data,
                                          const std::vector<frac::FixedCurve>& curves) {
    frac::EconomyOptions asked;
    asked.component = request_.component;
    try {
      return frac::economy(data, curves, asked, threads());
    } catch (const std::invalid_argument& error) {
      say(request_.data +
          ": these data carry no noise, but nothing is said about the economy of models: " + error.what());
      return std::nullopt;
    }
  }

  int run() override {
    if (io::holds_time_response(request_.data, request_.how)) return run_over_time();
    options().settle(frequency_response);
    auto fit = fit_options(request_);
    const auto note = [this](const std::string& text) { say(text); };
    const auto file = read_data(request_, note);
    settle_component(request_, options(), file.data,
                     [&](const std::string& text) { say(request_.data + ": " + text); });
    settle_weight(request_, options(), file, [&](const std::string& text) { say(request_.data + ": " + text); });
    request_.without_noise = io::is_computed(file.metadata);
    fit = fit_options(request_);
    check_folds(file.data.size());
    auto points = screened(request_, file.data, note);
    const bool static_backlash = complete_scene(file.metadata);
    const bool inverse = file.quantity == backlash::Quantity::minus_inverse;
    if (static_backlash && io::find_value(file.metadata, "output") == "x2")
      say(request_.data + ": the data are of x2, while the static-backlash curve describes x1");
    std::optional<double> obstacle;  // frequency at which the static curve has no -1/N
    std::vector<frac::FixedCurve> curves;
    if (static_backlash) {
      const auto& omega = file.data.omega();
      auto n = backlash::static_describing_function(*mass1_, *mass2_, *clearance_, *force_, omega);
      for (std::size_t i = 0; i < n.size() && inverse && !obstacle; ++i) {
        if (const auto of_n = backlash::minus_inverse(n[i], 0))
          n[i] = of_n->value;
        else
          obstacle = omega[i];
      }
      if (!obstacle) curves.push_back({"static-backlash", std::move(n)});
    }
    const auto result = frac::identify(points, models_, curves, fit, threads());
    if (!points.taken_back().empty()) say(points.taken_back());
    if (obstacle)
      say("no static-backlash candidate: at " + io::format_number(*obstacle) +
          " rad/s static backlash passes no motion on, so that N is 0 and -1/N infinite");
    if (request_.weight == frac::to_string(frac::Weight::learned)) fit.noise_floor = result.noise_floor;
    FitRun about = fit_run(request_, options(), file, points.left_out(), command_line());
    if (fit.without_noise || result.without_noise())
      about.economy = economy_of(points.kept(), frac::at_kept(points, curves));
    return write_ranking(points.kept(), fit, result, about);
  }

  FitRequest request_;
  TimeRequest over_time_;
  std::string models_text_;
  std::vector<std::string> bounds_;
  std::vector<frac::NamedModel> models_;
  std::optional<double> force_, clearance_, mass1_, mass2_;
  std::optional<std::size_t> folds_;
};

}  // namespace

std::unique_ptr<Command> make_identify() {
  return std::make_unique<Identify>();
}

}  // namespace fracfit
