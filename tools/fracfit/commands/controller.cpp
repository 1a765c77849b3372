// SPDX-License-Identifier: BSD-3-Clause
#include <variant>

#include "commands/subcommand.hpp"
#include "options/controller_request.hpp"
#include "output/controller_output.hpp"

namespace fracfit {
namespace {

class Controller : public Command {
 public:
  Controller() : Command("controller", "Fractional PID, or any model, as a recursion in the samples: JSON or C") {
    request_.declare(options());
    code_.declare(options());
    add_common({"json", "c", "table"});
    set_footer(
        "The format is C if FILE ends in .h; 'fracfit export c99' writes the same.\n"
        "Examples:\n"
        "  fracfit controller --kp 2 --ki 3 --kd 0.05 --lambda 0.8 --mu 0.6 --sample-time 1e-3 --band 0.1:300\n"
        "  fracfit controller --kp 2 --ki 3 --lambda 0.8 --sample-time 1e-3 --band 0.1:300 --min -5 --max 5 --out "
        "pi.h\n"
        "  fracfit controller --model '1/(0.8 s^2.2 + 0.5 s^0.9 + 1)' --sample-time 0.01 --precision float --out "
        "plant.h\n"
        "  fracfit controller --model '1/(0.8 s^2.2 + 0.5 s^0.9 + 1)' --sample-time 0.01 --band 0.01:100 --format "
        "table");
  }

 private:
  [[nodiscard]] std::string format() const override {
    return !options()["--format"].is_given() && out().ends_with(".h") ? "c" : Command::format();
  }

  void check() override {
    code_.check(request_.model().has_value());
    request_.check(options());
  }

  [[nodiscard]] std::string text_of(const ControllerRequest::Design& design) const {
    if (format() == "c") return code_.header(request_, design, command_line() + " --format c" + code_.words());
    if (const auto* pid = std::get_if<frac::FractionalPidDesign>(&design))
      return format() == "json" ? controller_json(*pid, command_line()) : controller_table(*pid);
    const auto& filter = std::get<frac::FilterChoice>(design);
    const std::string model = request_.model()->formula();
    return format() == "json" ? filter_json(filter.design, model, filter.max_relative_error, command_line())
                              : filter_table(filter.design, model, filter.max_relative_error);
  }

  int run() override {
    const ControllerRequest::Design design = request_.design(options());
    write(text_of(design));
    // The table of a PID says it itself.
    const bool is_pid = std::holds_alternative<frac::FractionalPidDesign>(design);
    const std::string note = note_of(design);
    if (!note.empty() && !(is_pid && format() == "table")) say(note);
    return usable_result;
  }

  ControllerRequest request_;
  CodeRequest code_{frac::Precision::double_type};
};

}  // namespace

std::unique_ptr<Command> make_controller() {
  return std::make_unique<Controller>();
}

}  // namespace fracfit
