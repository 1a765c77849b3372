// SPDX-License-Identifier: BSD-3-Clause
#include <cmath>
#include <optional>
#include <string>

#include "backlash/loops/simulate_loop.hpp"
#include "backlash/loops/simulate_sampled_loop.hpp"
#include "commands/subcommand.hpp"
#include "options/model_options.hpp"
#include "options/scene_options.hpp"
#include "output/document.hpp"

namespace fracfit {
namespace {

class LoopCommand : public Command {
 public:
  LoopCommand()
      : Command("loop",
                "Motion of a loop around two masses with backlash over time, with the controller's whole memory, exact "
                "at every impact") {
    Options& o = options();
    o.parsed("--controller", controller_, formula_of,
             "C of the force -C(s) x on body 2; a sum of powers of s with a dead time", "FORMULA")
        .required();
    add_masses(o, mass1_, mass2_);
    o.number("--clearance", clearance_);
    o.one_number("--restitution", restitution_).required();
    o.number("--setpoint-step", set_point_.step, "Step of the set-point of x1 at t = 0, m", "R");
    o.number("--setpoint-ramp", set_point_.ramp, "Its rate from t = 0 on, m/s", "RATE");
    o.number("--velocity1", start_.v1, "x1' at the start, m/s", "V");
    o.number("--velocity2", start_.v2, "x2' at the start, m/s", "V");
    o.number("--duration", options_of_run_.duration, "Time to follow, s", "T");
    o.number("--every", options_of_run_.sample_time, "Time between rows besides two per impact, s; 0: none", "DT");
    const char* const as_sampled = "as only a sampled loop follows it";
    sampled_.sample_time = NAN;
    o.number(
        "--sample-time", sampled_.sample_time,
        "run the controller as kp + ki/s^lambda + kd s^mu in a computer, its force held between samples; one row per "
        "sample");
    o.choice("--body", body_, backlash::outputs(), "that the controller gets: x1, the load, or x2, the driven body");
    o.number("--force-limit", sampled_.force_limit, "Largest force of the actuator, N", "F")
        .default_is("none")
        .only_with({"--sample-time"}, as_sampled);
    o["--body"].only_with({"--sample-time"}, as_sampled);
    o.count("--impacts", options_of_run_.most_impacts, 1, most_impacts,
            "Impacts to follow at most; the work grows as their square", "N");
    for (const char* name : {"--every", "--impacts"})
      o[name].not_with({"--sample-time"}, "which writes a row per sample and follows every impact");
    add_common({"csv", "json", "table"});
    set_footer(
        "The load x1 is measured; a sampled loop may measure x2, stop at a force limit and rest in contact. Both "
        "bodies have rested at 0, in the middle of the clearance, until t = 0.\n"
        "Column event: sample, before-impact, after-impact.\n"
        "Examples:\n"
        "  fracfit loop --controller '1 + s^0.5' --restitution 0.6 --velocity2 1 --duration 60\n"
        "  fracfit loop --controller 'exp(-0.1 s) (2 + s)' --restitution 0.6 --setpoint-step 1 --every 0.05 --out "
        "loop.csv\n"
        "  fracfit loop --controller '2 + s^0.5' --restitution 0.6 --velocity2 1 --sample-time 0.002 --force-limit "
        "0.5");
  }

 private:
  static constexpr std::size_t most_impacts = 20'000;

  void write_rows(const std::vector<backlash::LoopRow>& rows, const io::Metadata& head) {
    Document document{head, {{"time_s", "x1_m", "v1_m_s", "x2_m", "v2_m_s", "force_n", "event"}, rows.size(), {}}};
    document.rows.fill = [&](std::size_t i, std::vector<Cell>& cells) {
      const backlash::LoopRow& row = rows[i];
      for (const double value : {row.time, row.x1, row.v1, row.x2, row.v2, row.force}) cells.emplace_back(value);
      cells.emplace_back(std::string(backlash::to_string(row.event)));
    };
    write(text_of(document, format(), command_line()));
  }

  int run_sampled() {
    sampled_.duration = options_of_run_.duration;
    sampled_.velocity1 = start_.v1;
    sampled_.velocity2 = start_.v2;
    sampled_.set_point = set_point_;
    const backlash::ControlLoop loop({mass1_, mass2_, clearance_, restitution_}, *controller_, body_);
    const backlash::SampledLoopHistory history = backlash::simulate_sampled_loop(loop, sampled_);
    write_rows(history.rows, {{"impacts", std::to_string(history.impacts)}});
    const frac::FractionalPidDesign design(backlash::sampled_controller(loop, sampled_));
    if (!design.note().empty()) say(design.note());
    return usable_result;
  }

  int run() override {
    if (!std::isnan(sampled_.sample_time)) return run_sampled();
    const backlash::ControlLoop loop({mass1_, mass2_, clearance_, restitution_}, *controller_);
    const backlash::LoopHistory history = backlash::simulate_loop(loop, start_, set_point_, options_of_run_);
    write_rows(history.rows, {{"impacts", std::to_string(history.impacts.size())},
                              {"end", std::string(backlash::to_string(history.end))},
                              {"end_time_s", io::format_number(history.end_time)}});
    if (history.end == backlash::LoopEnd::rest)
      say("ended where the masses come to rest in contact, which is not followed");
    if (history.end == backlash::LoopEnd::most_impacts) say("ended early, at the most impacts allowed");
    return usable_result;
  }

  std::optional<frac::FractionalTransferFunction> controller_;
  double mass1_ = 1, mass2_ = 1, clearance_ = 1, restitution_ = NAN;
  backlash::LoopStart start_;
  backlash::SetPoint set_point_;
  backlash::LoopSimulationOptions options_of_run_;
  backlash::SampledLoopOptions sampled_;
  backlash::Output body_ = backlash::Output::x1;
};

}  // namespace

std::unique_ptr<Command> make_loop() {
  return std::make_unique<LoopCommand>();
}

}  // namespace fracfit
