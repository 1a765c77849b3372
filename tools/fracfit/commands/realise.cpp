// SPDX-License-Identifier: BSD-3-Clause
#include <cmath>

#include "commands/subcommand.hpp"
#include "frac/state_space.hpp"
#include "options/model_options.hpp"
#include "output/aligned_table.hpp"
#include "output/json.hpp"

namespace fracfit {
namespace {

Json matrix(const std::vector<double>& values, std::size_t columns) {
  if (columns == 0) return Json::array();
  return Json::list_of(values.size() / columns, [&](std::size_t row) {
    return Json::list_of(columns, [&](std::size_t i) { return values[row * columns + i]; });
  });
}

Json modes_json(const std::vector<frac::Mode>& modes) {
  return Json::list(modes, [](const auto& mode) { return Json{{"pole", mode.pole}, {"residues", mode.residues}}; });
}

std::string realised_json(const frac::RationalModel& result, const std::string& form, const std::string& command) {
  Json json = origin(command);
  json["model"] = result.model.formula();
  json["band"] = {{"lower", result.band.lower}, {"upper", result.band.upper}};
  json["tolerance"] = result.tolerance;
  json["method"] = frac::to_string(result.method);
  json["status"] = frac::to_string(result.status);
  json["message"] = result.message;
  json["states"] = result.states;
  json["stable"] = result.stable;
  json["delay"] = result.delay;
  json["direct"] = result.direct;
  json["modes"] = modes_json(result.modes);
  json["series"] = Json::list(result.series, [](const auto& stage) {
    return Json{{"direct", stage.direct}, {"modes", modes_json(stage.modes)}};
  });
  json["max_relative_error"] = result.max_relative_error;
  json["omega_at_max_relative_error"] = result.omega_at_maximum;
  json["max_error_decibels"] = result.max_decibels;
  json["max_error_degrees"] = result.max_degrees;
  json["grid_points"] = result.grid_points;
  frac::StateSpace space;
  json["form"] = form;
  if (form == "balanced") {
    const frac::BalancedForm balanced = frac::balanced_form(result);
    json["hankel_singular_values"] = balanced.hankel_singular_values;
    json["max_relative_error_of_form"] = balanced.max_relative_error;
    space = balanced.system;
  } else {
    space = frac::modal_form(result);
  }
  json["A"] = matrix(space.a, space.states);
  json["B"] = matrix(space.b, 1);
  json["C"] = matrix(space.c, space.states);
  json["D"] = space.d;
  return json.dump() + "\n";
}

std::string realised_table(const frac::RationalModel& result) {
  std::string text = result.model.formula() + " on " + short_number(result.band.lower) + " .. " +
                     short_number(result.band.upper) + " rad/s, " + std::string(frac::to_string(result.method)) +
                     "\n\n";
  const auto complex_text = [](std::complex<double> value, bool pair) {
    if (!pair) return short_number(value.real());
    return short_number(value.real()) + (value.imag() < 0 ? " - " : " + ") + short_number(std::abs(value.imag())) + "j";
  };
  AlignedTable modes({"", "pole, rad/s", "residue"});
  std::size_t number = 0;
  const auto add = [&](const std::vector<frac::Mode>& list, const std::string& stage) {
    for (const frac::Mode& mode : list) {
      ++number;
      const bool pair = mode.pole.imag() != 0;
      for (std::size_t k = 0; k < mode.residues.size(); ++k) {
        modes.add({k == 0 ? std::to_string(number) + (pair ? ", and conjugate" : "") + stage
                          : "order " + std::to_string(k + 1),
                   complex_text(mode.pole, pair), complex_text(mode.residues[k], pair)});
      }
    }
  };
  add(result.modes, result.series.empty() ? "" : ", stage 1");
  for (std::size_t i = 0; i < result.series.size(); ++i) {
    const std::string stage = ", stage " + std::to_string(i + 2);
    add(result.series[i].modes, stage);
    if (result.series[i].direct != 0) modes.add({"direct" + stage, "", short_number(result.series[i].direct)});
  }
  text += modes.text() + "\ndirect " + short_number(result.direct);
  if (result.delay > 0) text += ", dead time " + short_number(result.delay) + " s in front";
  text += "\nlargest error " + short_number(result.max_relative_error) + " relative at " +
          short_number(result.omega_at_maximum) + " rad/s, " + short_number(result.max_decibels) + " dB, " +
          short_number(result.max_degrees) + " deg\n" + (result.stable ? "stable" : "not stable") + ", " +
          std::to_string(result.states) + " states\n";
  return text + result.message + "\n";
}

class Realise : public Command {
 public:
  Realise() : Command("realise", "State space of a whole fractional transfer function, with its error") {
    Options& o = options();
    add_model(o, model_).required();
    o.parsed("--band", band_, band_of, "the error holds there").required();
    o.number("--tolerance", tolerance_, "on the band; the fewest states that keep it").required();
    o.choice("--method", method_, frac::realisation_methods(),
             "one set of poles for the whole model, or a ladder per power");
    o.text("--form", form_, "Form of A, B, C, D", "FORM").one_of({"modal", "balanced"});
    add_common({"json", "table"});
    set_footer(
        "Examples:\n"
        "  fracfit realise --model \"1/(0.8 s^2.2 + 0.5 s^0.9 + 1)\" --band 1e-2:1e2 --tolerance 1e-3 --format table\n"
        "  fracfit realise --model \"exp(-0.2 s)/(s^0.5 + 1)\" --band 1e-3:1e3 --tolerance 1e-6 --form balanced --out "
        "s.json");
  }

 private:
  int run() override {
    const auto result = frac::realise(*model_, *band_, tolerance_, method_);
    write(format() == "json" ? realised_json(result, form_, command_line()) : realised_table(result));
    if (result.status == frac::RationalModelStatus::met) return usable_result;
    say(result.message);
    return no_usable_result;
  }

  std::optional<frac::FractionalTransferFunction> model_;
  std::optional<frac::FrequencyBand> band_;
  double tolerance_ = NAN;
  frac::RealisationMethod method_ = frac::RealisationMethod::joint;
  std::string form_ = "modal";
};

}  // namespace

std::unique_ptr<Command> make_realise() {
  return std::make_unique<Realise>();
}

}  // namespace fracfit
