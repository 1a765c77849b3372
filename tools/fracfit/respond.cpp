#include "frac/respond.hpp"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <optional>
#include <stdexcept>

#include "common_options.hpp"
#include "exit_code.hpp"
#include "frac/reference_response.hpp"
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

struct Response {
  std::vector<double> time, output;
  std::string method;
  double error_estimate = std::numeric_limits<double>::quiet_NaN();  // unit of the output
  bool usable = true;
};

using Kind = frac::ResponseInput::Kind;

std::optional<Kind> named_input(const std::string& name) {
  if (name == "step") return Kind::step;
  if (name == "impulse") return Kind::impulse;
  if (name == "ramp") return Kind::ramp;
  if (name == "sine") return Kind::sine;
  return std::nullopt;
}

// Step of a grid 0, T, 2 T, ...; 0 for any other.
double sample_time_of(const std::vector<double>& time) {
  if (time.size() < 2 || time[0] != 0) return 0;
  const double step = time.back() / static_cast<double>(time.size() - 1);
  for (std::size_t n = 0; n < time.size(); ++n) {
    if (std::abs(time[n] - static_cast<double>(n) * step) > 1e-9 * step) return 0;
  }
  return step;
}

Response by_reference(const frac::FractionalTransferFunction& model, frac::ResponseInput input,
                      std::vector<double> time) {
  Response result{std::move(time), {}, "reference", 0, true};
  for (const frac::ReferenceValue& value : frac::reference_response(model, input, result.time)) {
    result.output.push_back(value.value);
    result.error_estimate = std::max(result.error_estimate, value.error_estimate);
    result.usable = result.usable && value.status != frac::ResponseStatus::inaccurate;
  }
  return result;
}

std::vector<double> by_filter(const std::string& method, const frac::FractionalTransferFunction& model,
                              const std::vector<double>& samples, double sample_time, double tolerance,
                              frac::Hold hold) {
  return method == "grunwald-letnikov" ? frac::respond_grunwald_letnikov(model, samples, sample_time)
                                       : frac::respond(model, samples, sample_time, tolerance, hold);
}

// Largest difference from the reference at some forty samples.
double judged(const frac::FractionalTransferFunction& model, frac::ResponseInput input, const Response& response) {
  const frac::ReferenceResponse reference(model, input);
  double worst = 0;
  for (std::size_t n = 0; n < response.time.size(); n = n < 10 ? n + 1 : n + n / 5) {
    worst = std::max(worst, std::abs(response.output[n] - reference(response.time[n]).value));
  }
  return worst;
}

Response to_named_input(const RespondOptions& given, const frac::FractionalTransferFunction& model, Kind kind,
                        double tolerance) {
  if (given.time.empty()) throw std::invalid_argument("--time is required with --input " + given.input);
  if ((kind == Kind::sine) != !given.omega.empty())
    throw std::invalid_argument("--omega belongs to --input sine and is required there");
  const frac::ResponseInput input{kind, kind == Kind::sine ? number_option("--omega", given.omega) : 0};
  std::vector<double> time = io::parse_grid(given.time, "--time");
  const double sample_time = sample_time_of(time);
  const bool samples_exactly = sample_time > 0 && (kind == Kind::step || kind == Kind::ramp);
  constexpr std::size_t few = 200;
  if (given.method == "reference" || (given.method == "auto" && (!samples_exactly || time.size() < few)))
    return by_reference(model, input, std::move(time));
  if (!samples_exactly)
    throw std::invalid_argument("--method " + given.method +
                                " needs --input step or ramp and --time 0:T:N, or a file of samples");
  std::vector<double> samples(time.size(), 1.0);
  if (kind == Kind::ramp) samples = time;
  // Between its samples a ramp is straight.
  const frac::Hold hold = kind == Kind::ramp ? frac::Hold::first_order : frac::Hold::zero_order;
  Response result;
  result.method = given.method == "auto" ? "exponential-sum" : given.method;
  result.output = by_filter(result.method, model, samples, sample_time, tolerance, hold);
  result.time = std::move(time);
  result.error_estimate = judged(model, input, result);
  return result;
}

Response to_file(const RespondOptions& given, const frac::FractionalTransferFunction& model, double tolerance) {
  if (!given.time.empty()) throw std::invalid_argument("--time is taken from the file; leave it out");
  if (!given.omega.empty()) throw std::invalid_argument("--omega belongs to --input sine");
  if (given.method == "reference") throw std::invalid_argument("--method reference needs a named --input");
  io::TimeSeries signal = io::read_input_signal(given.input);
  const double sample_time = (signal.time.back() - signal.time.front()) / static_cast<double>(signal.time.size() - 1);
  Response result;
  result.method = given.method == "auto" ? "exponential-sum" : given.method;
  result.output = by_filter(result.method, model, signal.input, sample_time, tolerance,
                            given.hold == "first-order" ? frac::Hold::first_order : frac::Hold::zero_order);
  result.time = std::move(signal.time);
  return result;
}

int respond(const RespondOptions& given) {
  const io::OutputFile file(given.common.out);
  const auto model = frac::FractionalTransferFunction::parse(given.model);
  const double tolerance = number_option("--tolerance", given.tolerance);
  const std::optional<Kind> kind = named_input(given.input);
  const Response result = kind ? to_named_input(given, model, *kind, tolerance) : to_file(given, model, tolerance);

  CommandLine command("respond");
  command.option("--model", given.model).option("--input", given.input);
  if (!given.omega.empty()) command.option("--omega", given.omega);
  if (!given.time.empty()) command.option("--time", given.time);
  command.option("--method", result.method);
  if (result.method == "exponential-sum") command.option("--tolerance", given.tolerance);
  if (!kind) command.option("--hold", given.hold);
  std::string text = "# fracfit: " + std::string(io::version()) + "\n# command: " + command.text() +
                     "\n# model: " + model.formula() + "\n# method: " + result.method + "\n# error_estimate: ";
  io::append_number(text, result.error_estimate);
  text += "\ntime_s,output\n";
  bool finite = true;
  for (std::size_t n = 0; n < result.time.size(); ++n) {
    io::append_number(text, result.time[n]);
    text += ',';
    io::append_number(text, result.output[n]);
    text += '\n';
    finite = finite && std::isfinite(result.output[n]);
  }
  file.write(text);
  if (!finite) say(given.common, "some values are infinite");
  if (!result.usable) say(given.common, "the two reference methods differ by more than their rounding");
  return finite && result.usable ? usable_result : no_usable_result;
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
      ->type_name("INPUT");
  response->add_option("--omega", given->omega, "Angular frequency of the sine, rad/s")->type_name("W");
  response->add_option("--time", given->time, "Instants, s: FROM:TO:COUNT, FROM:TO:COUNTlog or a list")
      ->type_name("GRID");
  response
      ->add_option("--method", given->method,
                   "auto (the cheapest that meets the tolerance), reference, exponential-sum or grunwald-letnikov")
      ->capture_default_str()
      ->check(CLI::IsMember({"auto", "reference", "exponential-sum", "grunwald-letnikov"}))
      ->type_name("METHOD");
  response
      ->add_option("--tolerance", given->tolerance,
                   "Of the exponential sum, relative to the largest value of the step response; 1e-13 to 0.1")
      ->capture_default_str()
      ->type_name("T");
  response->add_option("--hold", given->hold, "How a file's input runs between samples: zero-order or first-order")
      ->capture_default_str()
      ->check(CLI::IsMember({"zero-order", "first-order"}))
      ->type_name("HOLD");
  response->add_option("--out", given->common.out, "Output file; standard output if not given")->type_name("FILE");
  add_common_options(*response, given->common, {});
  response->footer(
      "Examples:\n"
      "  fracfit respond --model \"1/(0.8 s^2.2 + 0.5 s^0.9 + 1)\" --time 0:30:3001\n"
      "  fracfit respond --model \"1/(s^0.5 + 1)\" --input impulse --time 1e-6:1e3:100log\n"
      "  fracfit respond --model \"1/(s^0.5 + 1)\" --input measured.csv --hold first-order --out response.csv");
  response->callback([given, &run] { run = [given] { return respond(*given); }; });
}

}  // namespace fracfit
