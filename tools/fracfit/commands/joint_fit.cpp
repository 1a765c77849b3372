// SPDX-License-Identifier: BSD-3-Clause
#include "frac/identification/joint_fit.hpp"

#include <algorithm>
#include <limits>
#include <optional>
#include <sstream>
#include <stdexcept>
#include <utility>

#include "batch/batch_fit.hpp"
#include "commands/subcommand.hpp"
#include "io/data_error.hpp"
#include "io/input_files.hpp"
#include "io/number.hpp"
#include "io/output_file.hpp"
#include "io/time_series_file.hpp"
#include "options/model_choice.hpp"
#include "options/time_request.hpp"
#include "output/joint_fit_output.hpp"
#include "report/picture.hpp"

namespace fracfit {
namespace {

std::vector<std::string> names_in(const std::string& list) {
  std::vector<std::string> names;
  std::istringstream text(list);
  for (std::string name; std::getline(text, name, ',');) names.push_back(name);
  return names;
}

bool has(const std::vector<std::string>& names, const std::string& name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

/// A command of its own and no option of `fit`: what profiles, bootstraps and grown structures mean there has no
/// meaning for many curves, and the result is one of another shape.
class JointFit : public Command {
 public:
  JointFit() : Command("joint-fit", "Fits one structure to many curves together, with shared parameters") {
    Options& o = options();
    o.texts("DATA", data_,
            "Frequency responses or samples over time, as tables or as instruments write them, or folders of them",
            "FILE|FOLDER")
        .required()
        .names_input();
    o.text("--model", model_, "or a preset; letters other than s are parameters").suggest(preset_names()).required();
    o.text("--shared", shared_, "Parameters that all curves have in common; of the others each has its own", "LIST");
    o.text("--each", each_, "Parameters of which each curve has its own; the others are shared", "LIST");
    o["--each"].not_with({"--shared"}, "which says the same the other way round");
    o.text("--shift", shift_,
           "Lay the curves on one master curve by factors of each, aT on the frequency and with both bT on the value, "
           "which --law may name; all else is shared unless told otherwise",
           "DIRECTION")
        .one_of({"horizontal", "both"});
    o.text("--reference", reference_, "Curve that the others are laid on", "CURVE")
        .only_with({"--shift"})
        .default_is("the first one");
    o.text("--master", master_, "Every point on the master curve, as CSV", "FILE").only_with({"--shift"}).unsaid();
    o.text("--picture", picture_, "A picture beside the result, SVG or PNG by its ending; here the master curve",
           "FILE")
        .only_with({"--shift"})
        .unsaid();
    o.texts("--law", fit_.laws,
            "A parameter as a law of what a file's header or the column of --by knows of its curve, e.g. "
            "'T = T0 exp(E/(8.314 temperature))'; its other names are fitted; repeatable",
            "LAW");
    o.text("--by", request_.key_column,
           "Column whose value tells apart the curves that follow each other in one file, e.g. force_n", "COLUMN");
    add_file_options(o, request_.how);
    add_residual_options(o, request_);
    add_time_options(o, over_time_);
    add_points_and_seed(o, request_);
    add_parameter_options(o, parameters_);
    add_prior_options(o, parameters_);
    o.texts("--derive", derive_);
    add_common({"json", "csv", "table"});
    set_footer(
        "Records over time (columns time_s,input,output) and frequency responses may stand side by side.\n"
        "Several curves in one file stand in columns re_<label>,im_<label> or in rows told apart by --by, as in "
        "batch.\n"
        "--fix, --bound, --start and --prior hold in every curve; but for --fix they take parameters of a law too.\n"
        "--derive takes these as well, and what a header knows of its curve.\n"
        "With --shift neighbours should overlap: give the curves in the order of their temperature.\n"
        "Curves count by their noise.  The chance in the output is small where the curves do not share what they are\n"
        "told to.\n"
        "Examples:\n"
        "  fracfit joint-fit cold.csv warm.csv hot.csv --model 'K/(T s^a + 1)' --shared K,a\n"
        "  fracfit joint-fit step.csv spectrum.csv --model 'K/(T s^a + 1)' --shared K,T,a\n"
        "  fracfit joint-fit all.csv --by force_n --model power-law --each K --out joint.json\n"
        "  fracfit joint-fit all.csv --by force_n --model power-law --shared a --law 'K = K0 force_n^p'\n"
        "  fracfit joint-fit 20C.csv 40C.csv 60C.csv --model fractional-zener --shift horizontal "
        "--master master.csv");
  }

 private:
  void check() override {
    if (shared_.empty() && each_.empty() && shift_.empty())
      throw std::invalid_argument(
          "--shared, --each or --shift is required: which parameters the curves have in common");
    for (const auto& text : request_.where) static_cast<void>(io::PointFilter(text));
    chosen_ = chosen_model(model_);
    if (chosen_.is_family())
      throw std::invalid_argument("--model " + model_ + " is a family, whose parameters differ from curve to curve");
    fit_.fit = fit_options(request_);
    fit_.over_time = time_fit_options(request_, over_time_, options(), constraints_of(chosen_, parameters_));
    fit_.fit.constraints = std::exchange(fit_.over_time.constraints, {});
    const frac::Structure structure(chosen_.formula);
    const bool names_own = shared_.empty();
    if (!shift_.empty()) fit_.shift = frac::CurveShift{0, shift_ == "both"};
    const auto named = names_in(names_own ? each_ : shared_);
    for (const auto& name : named)
      if (!has(structure.parameter_names(), name))
        throw std::invalid_argument((names_own ? "--each: " : "--shared: ") + io::quoted(name) +
                                    " is no parameter of " + chosen_.formula);
    const auto is_fixed = [&](const std::string& name) {
      return std::any_of(fit_.fit.constraints.begin(), fit_.fit.constraints.end(),
                         [&](const auto& each) { return each.name == name && each.fixed; });
    };
    fit_.shared = names_own ? std::vector<std::string>{} : named;
    for (const auto& name : structure.parameter_names())
      if (names_own && !has(named, name) && !is_fixed(name) && !has_law(name)) fit_.shared.push_back(name);
    if (fit_.shared.empty() && fit_.laws.empty() && !fit_.shift)
      throw std::invalid_argument("--each " + each_ + " leaves no parameter that is shared; use fracfit batch");
    fit_.threads = threads();
    const auto fitted = fit_.shift ? frac::shifted(structure, *fit_.shift) : structure;
    derived_from_ = fitted.parameter_names();
    if (!derive_.empty()) add_names_in_laws();
    quantities_ = quantities_of(derive_, derived_from_);
    try {
      if (!picture_.empty()) drawing_.emplace(picture_, options().input_files());
    } catch (const std::invalid_argument& error) {
      throw std::invalid_argument(std::string("--picture: ") + error.what());
    }
    if (!master_.empty()) master_file_.emplace(master_, options().input_files());
  }

  /// Parameters of the laws, and what the headers know of the curves.
  void add_names_in_laws() {
    for (const std::string& law : fit_.laws) {
      const frac::Structure formula(law.substr(law.find('=') + 1));
      for (const std::string& name : formula.parameter_names())
        if (name != "pi" && !has(derived_from_, name)) derived_from_.push_back(name);
    }
  }

  [[nodiscard]] bool has_law(const std::string& name) const {
    return std::any_of(fit_.laws.begin(), fit_.laws.end(), [&](const std::string& law) {
      std::string left = law.substr(0, law.find('='));
      std::erase(left, ' ');
      return left == name;
    });
  }

  /// Index of the curve that --reference names, by its name or the file's.
  [[nodiscard]] std::size_t reference_of(const std::vector<frac::JointCurve>& curves) const {
    if (reference_.empty()) return 0;
    std::string names;
    for (std::size_t c = 0; c < curves.size(); ++c) {
      if (curves[c].name == reference_) return c;
      names += (names.empty() ? "" : ", ") + curves[c].name;
    }
    throw std::invalid_argument("--reference " + io::quoted(reference_) + " is no curve; there are " + names);
  }

  /// Options that have a meaning with one kind of data are refused where there is none of it.
  /// @param weight  that records were read with
  void settle_kind(const JointRun& run, const std::string& weight, bool weight_is_for_records) {
    const auto records =
        std::count_if(run.curves.begin(), run.curves.end(), [](const auto& each) { return each.over_time; });
    if (records == 0) options().settle(frequency_response);
    if (records < static_cast<std::ptrdiff_t>(run.curves.size())) return;
    options().settle(samples_over_time);
    if (options()["--weight"].is_given() && !weight_is_for_records)
      throw std::invalid_argument("--weight " + io::quoted(request_.weight) +
                                  ": expected given or absolute with samples over time");
    options()["--weight"].say(weight);
  }

  int run() override {
    std::vector<frac::JointCurve> curves;
    JointRun run{
        .command = command_line(), .formula = chosen_.formula, .derived = quantities_, .derived_from = derived_from_};
    const auto note = [this](const std::string& text) { say(text); };
    bool same_unit = true, in_hertz = true, all_measured = true, computed = true;
    run.lower = std::numeric_limits<double>::infinity();
    const auto add = [&](const std::string& name, auto data, std::size_t points, io::Metadata header) -> auto& {
      frac::JointCurve& added = curves.emplace_back(frac::JointCurve{name, std::move(data)});
      for (const auto& [key, text] : header)
        if (const auto value = io::parse_number(text)) added.covariates.emplace_back(key, *value);
      run.curves.push_back({points, added.record() != nullptr, std::move(header), added.covariates});
      return added;
    };
    std::string weight_over_time;
    const bool is_for_records = request_.weight == "given" || request_.weight == "absolute";
    const auto add_record = [&](const std::string& file) {
      FitRequest request = request_;
      request.data = file;
      auto record = read_time_record(request, over_time_, options()["--weight"].is_given() && is_for_records, note);
      weight_over_time = record.weight;
      const auto& time = record.data.time();
      run.longest = std::max(run.longest, time.back() - time.front());
      const std::size_t points = record.data.observed().size();
      computed = false;
      static_cast<void>(add(file, std::move(record.data), points, std::move(record.header)));
    };
    const auto add_response = [&](const BatchCurve& curve) {
      auto file = read_curve(request_, curve, note);
      same_unit = same_unit && (run.upper == 0 || file.value_unit == run.value_unit);
      all_measured = all_measured && io::has_measured_sigma(file);
      computed = computed && io::is_computed(file.metadata);
      in_hertz = in_hertz && file.data.frequency_unit() == frac::FrequencyUnit::hertz;
      run.value_unit = file.value_unit;
      run.lower = std::min(run.lower, file.data.omega().front());
      run.upper = std::max(run.upper, file.data.omega().back());
      const std::size_t points = file.data.size();
      const frac::JointCurve& added = add(curve.name, std::move(file.data), points, std::move(file.metadata));
      settle_component(request_, options(), *added.response(),
                       [&](const std::string& text) { say(curve.name + ": " + text + " in all curves"); });
    };
    for (const auto& file : io::input_files(data_, writes_file() ? out() : "")) {
      if (io::holds_time_response(file, request_.how)) {
        add_record(file);
        continue;
      }
      for (const auto& curve : curves_of({file}, request_)) add_response(curve);
    }
    settle_kind(run, weight_over_time, is_for_records);
    const bool all_over_time =
        std::all_of(run.curves.begin(), run.curves.end(), [](const auto& each) { return each.over_time; });
    if (all_measured && !all_over_time && !options()["--weight"].is_given()) {
      fit_.fit.weight = frac::Weight::given;
      options()["--weight"].say(std::string(to_string(fit_.fit.weight)));
      run.command = command_line();
      say(weighed_by_measured_sigma);
    }
    fit_.fit.component = request_.component;
    fit_.fit.without_noise = computed;
    if (!same_unit) run.value_unit.clear();
    run.frequency_unit = in_hertz ? frac::FrequencyUnit::hertz : frac::FrequencyUnit::rad_per_s;
    run.options = options().entries({"--component", "--weight", "--realisation", "--band", "--poles", "--sample-time",
                                     "--memory", "--seed", "--by", "--loss", "--shift", "--hold", "--offset",
                                     "--input-at-rest", "--trend", "--earlier-input", "--noise"});
    run.options.emplace_back("where", where_text(request_));
    if (!fit_.laws.empty()) run.options.emplace_back("laws", joined(fit_.laws));
    if (!parameters_.prior.empty()) run.options.emplace_back("priors", joined(parameters_.prior));
    if (!parameters_.order.empty()) run.options.emplace_back("constraints", joined(parameters_.order));
    if (fit_.shift) {
      fit_.shift->reference = reference_of(curves);
      // Laws say by themselves which curve is not moved.
      if (!has_law(frac::horizontal_shift) || (fit_.shift->vertical && !has_law(frac::vertical_shift)))
        run.options.emplace_back("reference", curves.at(fit_.shift->reference).name);
    }
    const auto result = frac::joint_fit(curves, frac::Structure(chosen_.formula), fit_);
    // All that can fail is computed before the first line is written.
    std::optional<std::string> master;
    std::optional<report::Figure> figure;
    if (master_file_ && !result.curves.empty()) master = master_curve_csv(run, result, curves, fit_.fit.realisation);
    if (drawing_ && !result.curves.empty()) figure = master_curve_figure(run, result, curves, fit_.fit.realisation);
    write(format() == "json"  ? joint_fit_json(run, result)
          : format() == "csv" ? joint_fit_csv(run, result)
                              : joint_fit_table(run, result));
    if (master) master_file_->write(*master);
    if (figure) drawing_->write(std::move(*figure));
    if (result.usable()) return usable_result;
    say("no usable result: " + result.message);
    return no_usable_result;
  }

  FitRequest request_;
  TimeRequest over_time_;
  std::vector<std::string> data_, derive_;
  std::vector<frac::DerivedQuantity> quantities_;
  std::vector<std::string> derived_from_;
  std::string model_, shared_, each_, shift_, reference_, master_, picture_;
  std::optional<report::PictureFile> drawing_;
  std::optional<io::OutputFile> master_file_;
  ParameterOptions parameters_;
  frac::NamedModel chosen_{};
  frac::JointFitOptions fit_{};
};

}  // namespace

std::unique_ptr<Command> make_joint_fit() {
  return std::make_unique<JointFit>();
}

}  // namespace fracfit
