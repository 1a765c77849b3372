// SPDX-License-Identifier: BSD-3-Clause
#include "commands/subcommand.hpp"
#include "frac/digital/arduino_library.hpp"
#include "options/controller_request.hpp"
#include "report/staged_folder.hpp"

namespace fracfit {
namespace {

class ExportArduino : public Command {
 public:
  ExportArduino() : Command("export arduino", "Fractional PID, or any model, as an Arduino library with a sketch") {
    request_.declare(options());
    code_.declare(options());
    options().text("--out", folder_, "Folder to write, made if missing", "DIR").also("-o").required();
    add_common();
    set_footer(
        "Example:\n"
        "  fracfit export arduino --kp 2 --ki 3 --lambda 0.8 --sample-time 0.02 --band 0.1:70 --min 0 --max 1 --name "
        "heater --out heater");
  }

 private:
  void check() override {
    code_.check(request_.model().has_value());
    request_.check(options());
  }

  int run() override {
    const ControllerRequest::Design design = request_.design(options());
    report::StagedFolder folder(folder_);
    const auto library = [](const auto& of, const auto& options) { return frac::arduino_library(of, options); };
    for (const frac::NamedText& file : code_.made_by(library, request_, design, command_line() + code_.words()))
      folder.write(file.path, file.text);
    folder.publish("library.properties");
    if (const std::string note = note_of(design); !note.empty()) say(note);
    return usable_result;
  }

  ControllerRequest request_;
  CodeRequest code_{frac::Precision::float_type};
  std::string folder_;
};

}  // namespace

std::unique_ptr<Command> make_export_arduino() {
  return std::make_unique<ExportArduino>();
}

}  // namespace fracfit
