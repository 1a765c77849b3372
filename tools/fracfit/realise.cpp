// SPDX-License-Identifier: BSD-3-Clause
#include <CLI/CLI.hpp>
#include <cmath>
#include <memory>

#include "aligned_table.hpp"
#include "choice.hpp"
#include "common_options.hpp"
#include "exit_code.hpp"
#include "frac/state_space.hpp"
#include "io/sweep_file.hpp"
#include "json_number.hpp"
#include "subcommand.hpp"

namespace fracfit {
namespace {

struct RealiseArguments {
  CommonOptions common;
  std::string model, band, tolerance, method = "joint", form = "modal";
};

Json pair_of(std::complex<double> value) {
  return {number(value.real()), number(value.imag())};
}

Json matrix(const std::vector<double>& values, std::size_t columns) {
  Json rows = Json::array();
  for (std::size_t at = 0; at < values.size(); at += columns) {
    Json row = Json::array();
    for (std::size_t i = 0; i < columns; ++i) row.push_back(number(values[at + i]));
    rows.push_back(row);
  }
  return rows;
}

std::string realised_json(const frac::RationalModel& result, const std::string& form, const std::string& command) {
  Json json{{"fracfit", io::version()}, {"command", command}, {"model", result.model.formula()}};
  json["band"] = {{"lower", number(result.band.lower)}, {"upper", number(result.band.upper)}};
  json["tolerance"] = number(result.tolerance);
  json["method"] = frac::to_string(result.method);
  json["status"] = frac::to_string(result.status);
  json["message"] = result.message;
  json["states"] = result.states;
  json["stable"] = result.stable;
  json["delay"] = number(result.delay);
  json["direct"] = number(result.direct);
  json["modes"] = Json::array();
  for (const frac::Mode& mode : result.modes) {
    Json residues = Json::array();
    for (const auto& residue : mode.residues) residues.push_back(pair_of(residue));
    json["modes"].push_back({{"pole", pair_of(mode.pole)}, {"residues", residues}});
  }
  json["max_relative_error"] = number(result.max_relative_error);
  json["omega_at_max_relative_error"] = number(result.omega_at_maximum);
  json["max_error_decibels"] = number(result.max_decibels);
  json["max_error_degrees"] = number(result.max_degrees);
  json["grid_points"] = result.grid_points;
  frac::StateSpace space;
  json["form"] = form;
  if (form == "balanced") {
    const frac::BalancedForm balanced = frac::balanced_form(result);
    json["hankel_singular_values"] = balanced.hankel_singular_values;
    json["max_relative_error_of_form"] = number(balanced.max_relative_error);
    space = balanced.system;
  } else {
    space = frac::modal_form(result);
  }
  json["A"] = matrix(space.a, space.states);
  json["B"] = matrix(space.b, 1);
  json["C"] = matrix(space.c, space.states);
  json["D"] = number(space.d);
  return json.dump(2) + "\n";
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
  for (std::size_t i = 0; i < result.modes.size(); ++i) {
    const frac::Mode& mode = result.modes[i];
    const bool pair = mode.pole.imag() != 0;
    for (std::size_t k = 0; k < mode.residues.size(); ++k) {
      modes.add({k == 0 ? std::to_string(i + 1) + (pair ? ", and conjugate" : "") : "order " + std::to_string(k + 1),
                 complex_text(mode.pole, pair), complex_text(mode.residues[k], pair)});
    }
  }
  text += modes.text() + "\ndirect " + short_number(result.direct);
  if (result.delay > 0) text += ", dead time " + short_number(result.delay) + " s in front";
  text += "\nlargest error " + short_number(result.max_relative_error) + " relative at " +
          short_number(result.omega_at_maximum) + " rad/s, " + short_number(result.max_decibels) + " dB, " +
          short_number(result.max_degrees) + " deg\n" + (result.stable ? "stable" : "not stable") + ", " +
          std::to_string(result.states) + " states\n";
  return text + result.message + "\n";
}

int run_realise(const RealiseArguments& given) {
  const io::OutputFile out(given.common.out);
  const auto [lower, upper] = range_option("--band", given.band);
  const auto result =
      frac::realise(frac::FractionalTransferFunction::parse(given.model),
                    {number_option("--band", lower), number_option("--band", upper)},
                    number_option("--tolerance", given.tolerance), frac::realisation_method(given.method));
  CommandLine command("realise");
  command.option("--model", given.model).option("--band", given.band).option("--tolerance", given.tolerance);
  command.option("--method", given.method).option("--form", given.form);
  out.write(chosen_format(given.common, "json") == "json" ? realised_json(result, given.form, command.text())
                                                          : realised_table(result));
  if (result.status == frac::RationalModelStatus::met) return usable_result;
  say(given.common, result.message);
  return no_usable_result;
}

}  // namespace

void add_realise(CLI::App& program, Run& run) {
  const auto given = std::make_shared<RealiseArguments>();
  auto* realise =
      program.add_subcommand("realise", "State space of a whole fractional transfer function, with its error");
  const auto option = [&](const char* name, std::string& value, const char* description, const char* type) {
    return realise->add_option(name, value, description)->type_name(type);
  };
  option("--model", given->model, "Formula, e.g. \"exp(-0.1 s)/(s^1.5 + 2)\"", "FORMULA")->required();
  option("--band", given->band, "Band on which the error holds, rad/s", "LOW:HIGH")->required();
  option("--tolerance", given->tolerance, "Largest relative error; the fewest states that keep it", "T")->required();
  option("--method", given->method, "One set of poles for the whole model, or a ladder per power", "METHOD")
      ->check(one_of(spellings(frac::realisation_methods())))
      ->capture_default_str();
  option("--form", given->form, "Of A, B, C, D", "FORM")->check(one_of({"modal", "balanced"}))->capture_default_str();
  add_common_options(*realise, given->common, {"json", "table"});
  realise->footer(
      "Examples:\n"
      "  fracfit realise --model \"1/(0.8 s^2.2 + 0.5 s^0.9 + 1)\" --band 1e-2:1e2 --tolerance 1e-3 --format table\n"
      "  fracfit realise --model \"exp(-0.2 s)/(s^0.5 + 1)\" --band 1e-3:1e3 --tolerance 1e-6 --form balanced --out "
      "s.json");
  realise->callback([given, &run] { run = [given] { return run_realise(*given); }; });
}

}  // namespace fracfit
