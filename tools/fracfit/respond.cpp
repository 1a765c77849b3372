// SPDX-License-Identifier: BSD-3-Clause
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>
#include <optional>
#include <stdexcept>

#include "aligned_table.hpp"
#include "choice.hpp"
#include "common_options.hpp"
#include "exit_code.hpp"
#include "frac/time_response/response_methods.hpp"
#include "io/data_error.hpp"
#include "io/number.hpp"
#include "io/number_list.hpp"
#include "io/sweep_file.hpp"
#include "io/time_series_file.hpp"
#include "subcommand.hpp"

namespace fracfit {
namespace {

struct RespondOptions {
  CommonOptions common;
  std::string model, input = "step", omega, time, method = "auto", tolerance = "1e-9", hold = "zero-order";
};

using Kind = frac::ResponseInput::Kind;

std::optional<Kind> named_input(const std::string& name) {
  if (name == "step") return Kind::step;
  if (name == "impulse") return Kind::impulse;
  if (name == "ramp") return Kind::ramp;
  if (name == "sine") return Kind::sine;
  return std::nullopt;
}

struct Request {
  frac::TimeInput input;
  std::vector<double> time;
};

Request request_of(const RespondOptions& given) {
  const std::optional<Kind> kind = named_input(given.input);
  if ((kind == Kind::sine) != !given.omega.empty())
    throw std::invalid_argument("--omega belongs to --input sine and is required there");
  if (kind) {
    if (given.time.empty()) throw std::invalid_argument("--time is required with --input " + given.input);
    return {frac::ResponseInput{*kind, given.omega.empty() ? 0 : number_option("--omega", given.omega)},
            io::parse_grid(given.time, "--time")};
  }
  if (!std::filesystem::exists(given.input) && given.input != "-")
    throw io::DataError(given.input, 0, 0,
                        "cannot be read: no such file; --input takes a file, step, impulse, ramp or sine");
  io::TimeSeries series = io::read_input_signal(given.input);
  for (const auto& note : series.notes) say(given.common, given.input + ": " + note);
  std::vector<double> time = given.time.empty() ? series.time : io::parse_grid(given.time, "--time");
  return {frac::SampledInput{std::move(series.time), std::move(series.input),
                             given.hold == "first-order" ? frac::Hold::first_order : frac::Hold::zero_order},
          std::move(time)};
}

// Why the output is infinite at these instants.
std::string infinity_note(const std::vector<double>& instants, const frac::FractionalTransferFunction& model,
                          const RespondOptions& given) {
  std::string text = "the output at " + io::format_number(instants.front()) + " s";
  if (instants.size() > 1) text += " and " + std::to_string(instants.size() - 1) + " more instants";
  if (instants.front() > model.delay()) return text + " exceeds a double";
  text += " is infinite: ";
  if (given.input != "impulse") return text + "the model differentiates a jump of the input there";
  const double order = model.denominator().front().order - model.numerator().front().order;
  if (order <= 0) return text + "the model passes the impulse on";
  return text + "the impulse response begins as t^" + short_number(order - 1) + " there";
}

int respond(const RespondOptions& given) {
  const bool reads_file = !named_input(given.input);
  const io::OutputFile file(given.common.out, reads_file ? std::vector{given.input} : std::vector<std::string>{});
  const auto model = frac::FractionalTransferFunction::parse(given.model);
  const double tolerance = number_option("--tolerance", given.tolerance);
  const auto method = frac::response_method_from_string(given.method);
  const Request request = request_of(given);
  const frac::TimeResponse response = frac::respond(model, request.input, request.time, tolerance, method);

  const std::string used(frac::to_string(response.method));
  CommandLine command("respond");
  command.option("--model", given.model).option("--input", given.input);
  if (!given.omega.empty()) command.option("--omega", given.omega);
  if (!given.time.empty()) command.option("--time", given.time);
  if (!named_input(given.input)) command.option("--hold", given.hold);
  command.option("--method", used).option("--tolerance", given.tolerance);
  std::string text = "# fracfit: " + std::string(io::version()) + "\n# command: " + command.text() +
                     "\n# model: " + model.formula() + "\n# method: " + used + "\n# error_estimate: ";
  io::append_number(text, response.error_estimate);
  text += std::string("\n# meets_tolerance: ") + (response.meets_tolerance ? "true" : "false") + "\ntime_s,output\n";
  std::vector<double> infinite;
  for (std::size_t n = 0; n < request.time.size(); ++n) {
    io::append_number(text, request.time[n]);
    text += ',';
    io::append_number(text, response.output[n]);
    text += '\n';
    if (!std::isfinite(response.output[n])) infinite.push_back(request.time[n]);
  }
  file.write(text);
  const bool usable = infinite.size() < request.time.size();
  if (!infinite.empty())
    say(given.common, infinity_note(infinite, model, given) + (usable ? "" : "; no value is finite"));
  if (!response.meets_tolerance) {
    say(given.common, "the estimated error, " + io::format_number(response.error_estimate) +
                          ", exceeds the tolerance times the largest output");
  }
  return usable ? usable_result : no_usable_result;
}

}  // namespace

void add_respond(CLI::App& program, Run& run) {
  const auto given = std::make_shared<RespondOptions>();
  auto* response = program.add_subcommand("respond", "Time response of a fractional transfer function from rest");
  response->add_option("--model", given->model, "Formula, e.g. \"exp(-0.1 s)/(s^1.5 + 2)\"")
      ->required()
      ->type_name("FORMULA");
  response->add_option("--input", given->input, "step, impulse, ramp, sine, or a file with columns time_s,input")
      ->capture_default_str()
      ->type_name("INPUT")
      ->check(suggest({"step", "impulse", "ramp", "sine"}));
  response->add_option("--omega", given->omega, "Angular frequency of the sine, rad/s")->type_name("W");
  response
      ->add_option("--time", given->time,
                   "Instants, s: FROM:TO:COUNT, FROM:TO:COUNTlog or a list; with a file, those of the file if "
                   "not given")
      ->type_name("GRID");
  response
      ->add_option(
          "--method", given->method,
          "How it is computed; auto takes the cheaper of reference and exponential-sum that meets the tolerance")
      ->capture_default_str()
      ->type_name("METHOD")
      ->check(one_of(spellings(frac::response_methods())));
  response
      ->add_option(
          "--tolerance", given->tolerance,
          "Allowed error over the largest output, 1e-15 to 0.1; of each power for ladder; without influence on "
          "reference, grunwald-letnikov and bdf2")
      ->capture_default_str()
      ->type_name("T");
  response->add_option("--hold", given->hold, "How a file's input runs between samples")
      ->capture_default_str()
      ->check(one_of({"zero-order", "first-order"}))
      ->type_name("HOLD");
  response->add_option("--out", given->common.out, "Output file; standard output if not given")
      ->type_name("FILE")
      ->check(not_empty());
  add_common_options(*response, given->common, {});
  response->footer(
      "Examples:\n"
      "  fracfit respond --model \"1/(0.8 s^2.2 + 0.5 s^0.9 + 1)\" --time 0:30:3001\n"
      "  fracfit respond --model \"1/(s^0.5 + 1)\" --input impulse --time 1e-6:1e3:100log\n"
      "  fracfit respond --model \"1/(s^0.5 + 1)\" --input measured.csv --hold first-order --out response.csv\n"
      "  fracfit respond --model \"1/(s^0.5 + 1)\" --time 0:1:1001 --method bdf2");
  response->callback([given, &run] { run = [given] { return respond(*given); }; });
}

}  // namespace fracfit
