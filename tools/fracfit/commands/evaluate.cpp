// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "commands/subcommand.hpp"
#include "frac/identification/statistics.hpp"
#include "frac/identification/uncertainty.hpp"
#include "frac/structure.hpp"
#include "io/data_error.hpp"
#include "options/fit_record.hpp"
#include "options/model_choice.hpp"
#include "output/document.hpp"

namespace fracfit {
namespace {

class Evaluate : public Command {
 public:
  Evaluate() : Command("evaluate", "Frequency response of any formula, or of a fit with its confidence band") {
    Options& o = options();
    o.text("--model", model_, "or a preset; letters other than s are parameters, see --fix")
        .suggest(preset_names())
        .or_argument();
    o.text("--fit", fit_).names_input();
    o.exactly_one({"--model", "--fit"}, "the formula, or the fit that has one");
    o.texts("--fix", fix_).not_with({"--fit"}, "which has the values");
    o.numbers("--omega", omega_, "several: FROM:TO:COUNT, FROM:TO:COUNTlog or a list").required();
    o.flag("--derivatives", derivatives_, "Columns with the derivatives of both parts by each parameter");
    add_common({"csv", "json", "table"});
    set_footer(
        "The band is that of 95 %, by linear propagation of the covariance and Student's t.\n"
        "Examples:\n"
        "  fracfit evaluate 'K/(1 + (T s)^a)^b' --fix K=2 --fix T=0.1 --fix a=0.8 --fix b=0.5 --omega 0.1:1000:50log\n"
        "  fracfit evaluate '1/(0.8 s^2.2 + 0.5 s^0.9 + 1)' --omega 0.1:10:20log --format table\n"
        "  fracfit evaluate --fit fit.json --omega 0.1:100:200log --out band.csv");
  }

 private:
  void check() override {
    for (const double omega : omega_)
      if (!(omega > 0)) throw std::invalid_argument("--omega: frequencies must be > 0");
    if (!model_.empty()) take_model();
  }

  // The value of every parameter stands in --fix.
  void take_model() {
    frac::NamedModel named = chosen_model(model_);
    named.constraints.clear();
    result_.model = named.formula;
    const auto given = constraints_of(named, {fix_, {}, {}});
    const frac::Structure structure(named.formula);
    for (const auto& each : given) static_cast<void>(structure.parameter_index(each.name));
    for (const auto& name : structure.parameter_names()) {
      const auto found = std::find_if(given.begin(), given.end(), [&](const auto& each) { return each.name == name; });
      if (found == given.end())
        throw std::invalid_argument("--fix " + name + "=VALUE is missing: " + named.formula + " has the parameter " +
                                    name);
      frac::ParameterEstimate estimate{};
      estimate.name = name;
      estimate.value = *found->fixed;
      result_.parameters.push_back(std::move(estimate));
    }
  }

  void take_fit() {
    result_ = read_fit(fit_);
    const auto names = frac::Structure(result_.model).parameter_names();
    const auto is_same = [](const std::string& name, const auto& estimate) { return estimate.name == name; };
    // Parameters of a record over time, its offset and drift, stand behind those of the model.
    if (result_.parameters.size() < names.size() ||
        !std::equal(names.begin(), names.end(), result_.parameters.begin(), is_same))
      throw io::DataError(fit_, 0, 0, "has other parameters than those of its model " + result_.model);
    result_.parameters.resize(names.size());
    const double freedom = static_cast<double>(result_.residuals) - static_cast<double>(result_.free_parameters);
    if (freedom >= 1) half_width_ = frac::student_t_95(freedom);
    deviation_ = frac::response_deviation(result_, frac::ExactRealisation{}, omega_);
  }

  int run() override {
    if (!fit_.empty()) take_fit();
    const frac::Structure structure(result_.model);
    std::vector<double> values;
    for (const auto& estimate : result_.parameters) values.push_back(estimate.value);
    Document document;
    document.head.emplace_back("model", result_.model);
    for (const auto& estimate : result_.parameters)
      document.head.emplace_back(estimate.name, io::format_number(estimate.value));
    auto& columns = document.rows.columns;
    columns = {"omega_rad_s", "re", "im"};
    if (!fit_.empty()) {
      columns.insert(columns.end(), {"re_ci95_lower", "re_ci95_upper", "im_ci95_lower", "im_ci95_upper"});
      document.rows.intervals = {{1, 3, 4}, {2, 5, 6}};
    }
    if (derivatives_)
      for (const auto& name : structure.parameter_names())
        columns.insert(columns.end(), {"d_re_d_" + name, "d_im_d_" + name});
    std::vector<std::complex<double>> response(omega_.size()), gradient(values.size());
    structure.response(values, omega_, frac::ExactRealisation{}, response);
    bool usable = true;
    document.rows.count = omega_.size();
    document.rows.fill = [&](std::size_t i, std::vector<Cell>& cells) {
      const std::complex<double> value = response[i];
      usable = usable && std::isfinite(value.real()) && std::isfinite(value.imag());
      cells.insert(cells.end(), {omega_[i], value.real(), value.imag()});
      if (!fit_.empty()) {
        const double real = half_width_ * deviation_[i].real, imaginary = half_width_ * deviation_[i].imaginary;
        cells.insert(cells.end(),
                     {value.real() - real, value.real() + real, value.imag() - imaginary, value.imag() + imaginary});
      }
      if (!derivatives_) return;
      structure.response_and_gradient(values, omega_[i], frac::ExactRealisation{}, gradient);
      for (const auto& each : gradient) cells.insert(cells.end(), {each.real(), each.imag()});
    };
    write(text_of(document, format(), command_line()));
    if (!usable) say("some values are not finite, see the output");
    return usable ? usable_result : no_usable_result;
  }

  std::string model_, fit_;
  std::vector<std::string> fix_;
  std::vector<double> omega_;
  bool derivatives_ = false;
  frac::FitResult result_{};
  double half_width_ = NAN;  // of the band in standard deviations
  std::vector<frac::ResponseDeviation> deviation_;
};

}  // namespace

std::unique_ptr<Command> make_evaluate() {
  return std::make_unique<Evaluate>();
}

}  // namespace fracfit
