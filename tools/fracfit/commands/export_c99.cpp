// SPDX-License-Identifier: BSD-3-Clause
#include "commands/subcommand.hpp"
#include "options/controller_request.hpp"

namespace fracfit {
namespace {

class ExportC99 : public Command {
 public:
  ExportC99() : Command("export c99", "Fractional PID, or any model, as a C99 header without heap or library") {
    request_.declare(options());
    code_.declare(options());
    add_common({"c"});
    set_footer(
        "Examples:\n"
        "  fracfit export c99 --kp 2 --ki 3 --lambda 0.8 --sample-time 1e-3 --band 0.1:300 --min -5 --max 5 --out "
        "pi.h\n"
        "  fracfit export c99 --model '1/(0.8 s^2.2 + 0.5 s^0.9 + 1)' --sample-time 0.01 --precision float --out "
        "plant.h");
  }

 private:
  void check() override {
    code_.check(request_.model().has_value());
    request_.check(options());
  }

  int run() override {
    const ControllerRequest::Design design = request_.design(options());
    write(code_.header(request_, design, command_line() + code_.words()));
    if (const std::string note = note_of(design); !note.empty()) say(note);
    return usable_result;
  }

  ControllerRequest request_;
  CodeRequest code_{frac::Precision::double_type};
};

}  // namespace

std::unique_ptr<Command> make_export_c99() {
  return std::make_unique<ExportC99>();
}

}  // namespace fracfit
