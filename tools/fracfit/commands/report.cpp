// SPDX-License-Identifier: BSD-3-Clause
#include "report/report.hpp"

#include <optional>

#include "commands/subcommand.hpp"
#include "io/progress_bar.hpp"
#include "options/data_options.hpp"

namespace fracfit {
namespace {

class Report : public Command {
 public:
  Report() : Command("report", "Writes the whole study as one page with figures, tables and numbers") {
    Options& o = options();
    o.texts("DATA", data_,
            "Measured frequency responses, as tables or as instruments write them, or samples over time "
            "(time_s,input,output); without any, the paper's scenes",
            "FILE");
    add_file_options(o, how_);
    add_select(o, how_);
    o.choice("--quantity", field_, report::fields(),
             "which decides how the pictures show them; auto: as the names and units of the file tell; n and "
             "minus-inverse: "
             "N or -1/N, made of the other one where the file holds that")
        .only_with({"DATA"});
    o.text("--scene", scene_,
           "Scene as JSON: mass1, mass2, clearance, restitution, force, omega; in place of restitution "
           "contact_stiffness and "
           "contact_damping (or contact_frequency and contact_ratio or contact_restitution), friction1, friction2",
           "FILE")
        .not_with({"DATA"});
    o.text("--out", folder_, "Folder to write, made if missing", "DIR").also("-o").required();
    add_progress();
    add_common();
    set_footer(
        "Examples:\n"
        "  fracfit report --out report\n"
        "  fracfit report cell.csv --out cell-report\n"
        "  fracfit report step.csv --out step-report      # columns time_s,input,output\n"
        "  fracfit report --scene scene.json --out scene-report");
  }

 private:
  int run() override {
    frac::Progress progress;
    std::optional<io::ProgressBar> bar;
    report::ReportOptions options;
    options.out = folder_;
    options.data.assign(data_.begin(), data_.end());
    options.how = how_;
    options.field = field_;
    if (!scene_.empty()) options.scene = scene_;
    options.command = command_line();
    options.threads = threads();
    options.progress = &progress;
    options.stage = [&](std::string_view name) {
      bar.reset();
      say(std::string(name));
      bar.emplace(std::string(name), progress, progress_style());
    };
    const auto outcome = report::write_report(options);
    bar.reset();
    complain(outcome.message);
    return outcome.pictures ? usable_result : no_usable_result;
  }

  std::vector<std::string> data_;
  io::MeasurementOptions how_;
  report::Field field_ = report::Field::automatic;
  std::string scene_, folder_;
};

}  // namespace

std::unique_ptr<Command> make_report() {
  return std::make_unique<Report>();
}

}  // namespace fracfit
