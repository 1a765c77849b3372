// SPDX-License-Identifier: BSD-3-Clause
#include <cmath>
#include <filesystem>
#include <stdexcept>

#include "commands/subcommand.hpp"
#include "frac/model/algebra.hpp"
#include "frac/stability.hpp"
#include "frac/time_response/loop_response.hpp"
#include "frac/time_response/response_methods.hpp"
#include "io/number.hpp"
#include "io/time_series_file.hpp"
#include "options/model_options.hpp"
#include "output/aligned_table.hpp"
#include "output/document.hpp"

namespace fracfit {
namespace {

using Kind = frac::ResponseInput::Kind;

std::optional<Kind> named_input(const std::string& name) {
  if (name == "step") return Kind::step;
  if (name == "impulse") return Kind::impulse;
  if (name == "ramp") return Kind::ramp;
  if (name == "sine") return Kind::sine;
  return std::nullopt;
}

// The closed loop's stability, where it can be asked for: |L| falls below 1 at high frequency.
std::string_view stability_of(const frac::FractionalTransferFunction& loop) {
  try {
    return frac::to_string(frac::analyse_closed_loop(loop).stability);
  } catch (const std::invalid_argument&) {
    return frac::to_string(frac::Stability::undetermined);
  }
}

// Why the output is infinite at these instants.
std::string infinity_note(const std::vector<double>& instants, const frac::FractionalTransferFunction& model,
                          const std::string& input) {
  std::string text = "the output at " + io::format_number(instants.front()) + " s";
  if (instants.size() > 1) text += " and " + std::to_string(instants.size() - 1) + " more instants";
  if (instants.front() > model.delay()) return text + " exceeds a double";
  text += " is infinite: ";
  if (input != "impulse") return text + "the model differentiates a jump of the input there";
  const double order = model.denominator().front().order - model.numerator().front().order;
  if (order <= 0) return text + "the model passes the impulse on";
  return text + "the impulse response begins as t^" + short_number(order - 1) + " there";
}

class Respond : public Command {
 public:
  Respond() : Command("respond", "Time response of a fractional transfer function from rest") {
    Options& o = options();
    add_model(o, model_).required();
    o.parsed("--feedback", feedback_, formula_of,
             "Take the closed loop model/(1 + model FORMULA) in place of the model; dead time is welcome. 1: the model "
             "is the loop and the input its reference; a controller, with the plant as the model: the input is a "
             "disturbance in front of the plant",
             "FORMULA");
    o.text("--input", input_, "step, impulse, ramp, sine, or a file with columns time_s,input", "INPUT")
        .suggest({"step", "impulse", "ramp", "sine"})
        .names_input();
    o.one_number("--omega", omega_, "of the sine").only_with({"--input", {"sine"}}).needed_with({"--input", {"sine"}});
    o.numbers("--time", time_,
              "Instants, s: FROM:TO:COUNT, FROM:TO:COUNTlog or a list; with a file, those of the file if not given",
              "GRID")
        .needed_with({"--input", {"step", "impulse", "ramp", "sine"}});
    o.choice("--hold", hold_, frac::holds(), "of a file").not_with({"--input", {"step", "impulse", "ramp", "sine"}});
    o.choice("--method", method_, frac::response_methods(),
             "auto takes the cheaper of reference and exponential-sum that meets the tolerance");
    o.number("--tolerance", tolerance_,
             "over the largest output, 1e-15 to 0.1; of each power for ladder; without influence on reference, "
             "grunwald-letnikov and bdf2")
        .otherwise("1e-9");
    add_common({"csv", "json", "table"});
    set_footer(
        "Examples:\n"
        "  fracfit respond \"1/(0.8 s^2.2 + 0.5 s^0.9 + 1)\" --time 0:30:3001\n"
        "  fracfit respond --model \"1/(s^0.5 + 1)\" --input impulse --time 1e-6:1e3:100log\n"
        "  fracfit respond --model \"1/(s^0.5 + 1)\" --input measured.csv --hold first-order --out response.csv\n"
        "  fracfit respond --model \"1/(s^0.5 + 1)\" --time 0:1:1001 --method bdf2\n"
        "  fracfit respond \"exp(-50 s)*3.13*(1 + 0.003/s^0.9)/(433.33 s + 1)\" --feedback 1 --time 0:2500:251");
  }

 private:
  // The input; where it is a file, its instants are those of the output unless others were given.
  frac::TimeInput input() {
    if (const std::optional<Kind> kind = named_input(input_))
      return frac::ResponseInput{*kind, *kind == Kind::sine ? omega_ : 0};
    if (!std::filesystem::exists(input_) && input_ != "-")
      throw io::DataError(input_, 0, 0,
                          "cannot be read: no such file; --input takes a file, step, impulse, ramp or sine");
    io::TimeSeries series = io::read_input_signal(input_);
    for (const auto& note : series.notes) say(input_ + ": " + note);
    if (time_.empty()) time_ = series.time;
    return frac::SampledInput{std::move(series.time), std::move(series.input), hold_};
  }

  // What was computed, of an open or a closed loop.
  struct Answer {
    std::vector<double> output;
    std::string method;
    double error_estimate;
    bool meets_tolerance;
  };
  Answer answer(const frac::TimeInput& signal) {
    if (feedback_) {
      const frac::FractionalTransferFunction loop = *model_ * *feedback_;
      if (loop.delay() > 0) {
        if (method_ != frac::ResponseMethod::automatic) {
          throw std::invalid_argument("--method " + std::string(frac::to_string(method_)) +
                                      " has no meaning with --feedback around a dead time, here of " +
                                      short_number(loop.delay()) + " s: such a loop has one method");
        }
        frac::LoopResponse found = frac::respond_closed_loop(*model_, loop, signal, time_, tolerance_);
        return {std::move(found.output), "closed-loop", found.error_estimate, found.meets_tolerance};
      }
    }
    const frac::TimeResponse found =
        frac::respond(feedback_ ? frac::feedback(*model_, *feedback_) : *model_, signal, time_, tolerance_, method_);
    const std::string used(frac::to_string(found.method));
    options()["--method"].say(used);
    return {found.output, used, found.error_estimate, found.meets_tolerance};
  }

  int run() override {
    const frac::TimeInput signal = input();
    const Answer response = answer(signal);
    Document document{{{"model", model_->formula()},
                       {"method", response.method},
                       {"error_estimate", io::format_number(response.error_estimate)},
                       {"meets_tolerance", response.meets_tolerance ? "true" : "false"}},
                      {{"time_s", "output"}, time_.size(), {}}};
    if (feedback_) {
      document.head.insert(
          document.head.begin() + 1,
          {{"feedback", feedback_->formula()}, {"closed_loop", std::string(stability_of(*model_ * *feedback_))}});
    }
    document.rows.fill = [&](std::size_t i, std::vector<Cell>& cells) {
      cells.emplace_back(time_[i]);
      cells.emplace_back(response.output[i]);
    };
    write(text_of(document, format(), command_line()));
    std::vector<double> infinite;
    for (std::size_t i = 0; i < time_.size(); ++i)
      if (!std::isfinite(response.output[i])) infinite.push_back(time_[i]);
    const bool usable = infinite.size() < time_.size();
    if (!infinite.empty()) say(infinity_note(infinite, *model_, input_) + (usable ? "" : "; no value is finite"));
    if (!response.meets_tolerance)
      say("the estimated error, " + io::format_number(response.error_estimate) +
          ", exceeds the tolerance times the largest output");
    return usable ? usable_result : no_usable_result;
  }

  std::optional<frac::FractionalTransferFunction> model_, feedback_;
  std::string input_ = "step";
  frac::Hold hold_ = frac::Hold::zero_order;
  double omega_ = NAN, tolerance_ = 1e-9;
  std::vector<double> time_;
  frac::ResponseMethod method_ = frac::ResponseMethod::automatic;
};

}  // namespace

std::unique_ptr<Command> make_respond() {
  return std::make_unique<Respond>();
}

}  // namespace fracfit
