// SPDX-License-Identifier: BSD-3-Clause
#include "commands/subcommand.hpp"
#include "frac/digital/fixed_point.hpp"
#include "options/controller_request.hpp"

namespace fracfit {
namespace {

frac::FixedPointRanges ranges_of(std::string_view name, const std::string& text) {
  const auto [input, output] = pair_of(name, text, "INPUT:OUTPUT");
  return {number_of(name, input), number_of(name, output)};
}

class ExportC99 : public Command {
 public:
  ExportC99() : Command("export c99", "Fractional PID, or any model, as a C99 header without heap or library") {
    request_.declare(options());
    code_.declare(options());
    options()
        .parsed("--fixed-point", ranges_, ranges_of,
                "Whole numbers of 32 bits instead, fractions of these ranges, for processors without a floating-point "
                "unit; the error is stated",
                "INPUT:OUTPUT")
        .not_with({"--precision", {"float"}}, "which it takes the place of");
    add_common({"c"});
    set_footer(
        "Examples:\n"
        "  fracfit export c99 --kp 2 --ki 3 --lambda 0.8 --sample-time 1e-3 --band 0.1:300 --min -5 --max 5 --out "
        "pi.h\n"
        "  fracfit export c99 --model '1/(0.8 s^2.2 + 0.5 s^0.9 + 1)' --sample-time 0.01 --precision float --out "
        "plant.h\n"
        "  fracfit export c99 --model 's^-0.5' --band 0.01:2 --sample-time 0.02 --discretisation tustin --fixed-point "
        "5:100 "
        "--out half.h\n"
        "  fracfit export c99 --kp 2 --ki 3 --kd 0.05 --lambda 0.8 --mu 0.6 --sample-time 1e-3 --band 0.1:300 "
        "--discretisation\n"
        "      tustin --min -5 --max 5 --fixed-point 2:10 --out pid.h");
  }

 private:
  void check() override {
    code_.check(request_.model().has_value());
    request_.check(options());
  }

  int run() override {
    const ControllerRequest::Design design = request_.design(options());
    if (ranges_) {
      const auto header = [&](const auto& of, const auto& options) {
        return frac::fixed_point_header(of, *ranges_, options);
      };
      write(code_.made_by(header, request_, design, command_line() + code_.name_in_words()).text);
    } else {
      write(code_.header(request_, design, command_line() + code_.words()));
    }
    if (const std::string note = note_of(design); !note.empty()) say(note);
    return usable_result;
  }

  ControllerRequest request_;
  CodeRequest code_{frac::Precision::double_type};
  std::optional<frac::FixedPointRanges> ranges_;
};

}  // namespace

std::unique_ptr<Command> make_export_c99() {
  return std::make_unique<ExportC99>();
}

}  // namespace fracfit
