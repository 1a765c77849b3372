// SPDX-License-Identifier: BSD-3-Clause
#include "frac/identification/joint_fit.hpp"

#include <algorithm>
#include <sstream>
#include <stdexcept>

#include "batch/batch_fit.hpp"
#include "commands/subcommand.hpp"
#include "io/data_error.hpp"
#include "io/input_files.hpp"
#include "io/number.hpp"
#include "options/model_choice.hpp"
#include "output/joint_fit_output.hpp"

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

/// A command of its own and no option of `fit`: what profiles, bootstraps, grown structures and samples over time mean
/// there has no meaning for many curves, and the result is one of another shape.
class JointFit : public Command {
 public:
  JointFit() : Command("joint-fit", "Fits one structure to many curves together, with shared parameters") {
    request_.weight = "learned";
    Options& o = options();
    o.texts("DATA", data_, "Frequency responses as tables or as instruments write them, or folders of them",
            "FILE|FOLDER")
        .required()
        .names_input();
    o.text("--model", model_, "or a preset; letters other than s are parameters").suggest(preset_names()).required();
    o.text("--shared", shared_, "Parameters that all curves have in common; of the others each has its own", "LIST");
    o.text("--each", each_, "Parameters of which each curve has its own; the others are shared", "LIST");
    o.exactly_one({"--shared", "--each"}, "which parameters the curves have in common");
    o.texts("--law", fit_.laws,
            "A parameter as a law of what a file's header or the column of --by knows of its curve, e.g. "
            "'T = T0 exp(E/(8.314 temperature))'; its other names are fitted; repeatable",
            "LAW");
    o.text("--by", request_.key_column,
           "Column whose value tells apart the curves that follow each other in one file, e.g. force_n", "COLUMN");
    add_file_options(o, request_.how);
    add_residual_options(o, request_);
    add_points_and_seed(o, request_);
    add_parameter_options(o, parameters_);
    o.texts("--derive", derive_);
    add_common({"json", "csv", "table"});
    set_footer(
        "Several curves in one file stand in columns re_<label>,im_<label> or in rows told apart by --by, as in "
        "batch.\n"
        "--fix, --bound and --start hold in every curve; --bound and --start take parameters of a law too.\n"
        "Curves count by their noise.  The chance in the output is small where the curves do not share what they are\n"
        "told to.\n"
        "Examples:\n"
        "  fracfit joint-fit cold.csv warm.csv hot.csv --model 'K/(T s^a + 1)' --shared K,a --component both\n"
        "  fracfit joint-fit all.csv --by force_n --model power-law --each K --out joint.json\n"
        "  fracfit joint-fit all.csv --by force_n --model power-law --shared a --law 'K = K0 force_n^p'");
  }

 private:
  void check() override {
    if (request_.loss != frac::Loss::none)
      throw std::invalid_argument("--loss has no meaning with joint-fit, which takes the plain sum of squares");
    for (const auto& text : request_.where) static_cast<void>(io::PointFilter(text));
    chosen_ = chosen_model(model_);
    if (chosen_.is_family())
      throw std::invalid_argument("--model " + model_ + " is a family, whose parameters differ from curve to curve");
    fit_.fit = fit_options(request_);
    fit_.fit.constraints = constraints_of(chosen_, parameters_);
    const frac::Structure structure(chosen_.formula);
    const bool names_own = shared_.empty();
    const auto named = names_in(names_own ? each_ : shared_);
    for (const auto& name : named)
      if (!has(structure.parameter_names(), name))
        throw std::invalid_argument((names_own ? "--each: " : "--shared: ") + io::quoted(name) +
                                    " is no parameter of " + chosen_.formula);
    const auto is_fixed = [&](const std::string& name) {
      return std::any_of(fit_.fit.constraints.begin(), fit_.fit.constraints.end(),
                         [&](const auto& each) { return each.name == name && each.fixed; });
    };
    const auto has_law = [&](const std::string& name) {
      return std::any_of(fit_.laws.begin(), fit_.laws.end(), [&](const std::string& law) {
        std::string left = law.substr(0, law.find('='));
        std::erase(left, ' ');
        return left == name;
      });
    };
    fit_.shared = names_own ? std::vector<std::string>{} : named;
    for (const auto& name : structure.parameter_names())
      if (names_own && !has(named, name) && !is_fixed(name) && !has_law(name)) fit_.shared.push_back(name);
    if (fit_.shared.empty() && fit_.laws.empty())
      throw std::invalid_argument("--each " + each_ + " leaves no parameter that is shared; use fracfit batch");
    fit_.threads = threads();
    quantities_ = quantities_of(derive_, structure.parameter_names());
  }

  int run() override {
    std::vector<frac::JointCurve> curves;
    JointRun run{command_line(), {}, {}, {}, quantities_};
    const auto note = [this](const std::string& text) { say(text); };
    bool same_unit = true;
    for (const auto& curve : curves_of(io::input_files(data_, writes_file() ? out() : ""), request_)) {
      auto file = read_curve(request_, curve, note);
      same_unit = same_unit && (curves.empty() || file.value_unit == run.value_unit);
      run.value_unit = file.value_unit;
      frac::JointCurve& added = curves.emplace_back(frac::JointCurve{curve.name, std::move(file.data)});
      for (const auto& [key, text] : file.metadata)
        if (const auto value = io::parse_number(text)) added.covariates.emplace_back(key, *value);
      run.curves.push_back({added.data.size(), std::move(file.metadata)});
    }
    if (!same_unit) run.value_unit.clear();
    run.options = options().entries({"--component", "--weight", "--realisation", "--band", "--poles", "--sample-time",
                                     "--memory", "--seed", "--by"});
    run.options.emplace_back("where", where_text(request_));
    std::string laws;
    for (const auto& law : fit_.laws) laws += (laws.empty() ? "" : "; ") + law;
    if (!laws.empty()) run.options.emplace_back("laws", laws);
    const auto result = frac::joint_fit(curves, frac::Structure(chosen_.formula), fit_);
    write(format() == "json"  ? joint_fit_json(run, result)
          : format() == "csv" ? joint_fit_csv(run, result)
                              : joint_fit_table(run, result));
    if (result.usable()) return usable_result;
    say("no usable result: " + result.message);
    return no_usable_result;
  }

  FitRequest request_;
  std::vector<std::string> data_, derive_;
  std::vector<frac::DerivedQuantity> quantities_;
  std::string model_, shared_, each_;
  ParameterOptions parameters_;
  frac::NamedModel chosen_{};
  frac::JointFitOptions fit_{};
};

}  // namespace

std::unique_ptr<Command> make_joint_fit() {
  return std::make_unique<JointFit>();
}

}  // namespace fracfit
