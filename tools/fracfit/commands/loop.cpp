// SPDX-License-Identifier: BSD-3-Clause
#include <cmath>
#include <optional>
#include <stdexcept>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "backlash/compliant/compliant_loop.hpp"
#include "backlash/loops/loop_record.hpp"
#include "backlash/loops/simulate_loop.hpp"
#include "backlash/loops/simulate_sampled_loop.hpp"
#include "commands/subcommand.hpp"
#include "io/time_series_file.hpp"
#include "options/loop_options.hpp"
#include "options/record_options.hpp"
#include "options/scene_options.hpp"
#include "output/aligned_table.hpp"
#include "output/document.hpp"

namespace fracfit {
namespace {

class LoopCommand : public Command {
 public:
  LoopCommand()
      : Command("loop",
                "Motion of a loop around two bodies with backlash over time: impacts, rests in contact, limits of the "
                "actuator") {
    Options& o = options();
    loop_.add(o);
    loop_.add_body(o);
    o["--restitution"].default_is("none: needed unless contacts take time");
    contact_.add(o);
    o.number("--setpoint-step", set_point_.step, "Step of the set-point of the measured position at t = 0, m", "R");
    o.number("--setpoint-ramp", set_point_.ramp, "Its rate from t = 0 on, m/s", "RATE");
    o.parsed("--setpoint-sine", sine_, sine_of, "A sine in it, m and rad/s", "AMPLITUDE:OMEGA").default_is("none");
    o.text("--setpoint-file", set_point_file_,
           "Columns time_s, input (m); straight from row to row, the first at time 0", "FILE");
    o.number("--disturbance1", options_of_run_.disturbance.body1,
             "Constant force on body 1 from t = 0 on, N; with --sample-time where contacts take time", "F");
    o.number("--disturbance2", options_of_run_.disturbance.body2, "That on body 2, N", "F");
    o.number("--velocity1", start_.v1, "x1' at the start, m/s", "V");
    o.number("--velocity2", start_.v2, "x2' at the start, m/s", "V");
    o.number("--duration", options_of_run_.duration, "Time to follow, s", "T");
    o.number("--every", options_of_run_.sample_time, "Time between rows besides two per impact, s; 0: none", "DT");
    sampled_.sample_time = NAN;
    o.number(
        "--sample-time", sampled_.sample_time,
        "run the controller as kp + ki/s^lambda + kd s^mu in a computer, its force held between samples; one row per "
        "sample");
    o.number("--encoder-step", sampled_.encoder_step, "Step of the position that the computer reads, m; 0: none", "Q")
        .only_with({"--sample-time"}, "whose computer reads an encoder");
    o.number("--force-limit", options_of_run_.force_limit, "Largest force of the actuator, N", "F").default_is("none");
    o.number("--tolerance", options_of_run_.tolerance, "of fractional powers of s, which are sums of exponentials");
    o.flag("--whole-memory", options_of_run_.whole_memory,
           "Sums over all earlier impacts instead, exact; the work grows as their square");
    o.count("--impacts", options_of_run_.most_impacts, 1, most_impacts, "Impacts to follow at most", "N");
    const char* const has_rows = "which writes a row per sample and follows every impact";
    for (const char* name : {"--every", "--impacts"}) o[name].not_with({"--sample-time"}, has_rows);
    const char* const is_digital = "whose controller is a digital filter";
    for (const char* name : {"--tolerance", "--whole-memory"}) o[name].not_with({"--sample-time"}, is_digital);
    const char* const has_line = "whose set-point is a step and a ramp";
    for (const char* name : {"--setpoint-sine", "--setpoint-file"}) o[name].not_with({"--sample-time"}, has_line);
    o["--tolerance"].not_with({"--whole-memory"}, "which is exact");
    CompliantOptions::exclude(o["--whole-memory"], "whose contacts take time");
    o.flag("--record", is_record_, "Write a record as a rig does: time, force and positions every DT, no events")
        .not_with({"--sample-time"}, "whose rows are the samples of its computer");
    record_.add(o, "--record");
    add_common({"csv", "json", "table"});
    set_footer(
        "Both bodies have rested at 0, in the middle of the clearance, until t = 0. Powers of whole order are exact; "
        "for "
        "fractional ones the error reached stands in the head.\n"
        "Column event: sample, before-impact, after-impact; contact: the bodies stay together from there on, release: "
        "until there.\n"
        "With contacts that take time: contact, separation (the wall presses no more), parting (the overlap has "
        "ended), and\n"
        "of each body with dry friction stick-1, slide-1, reversal-1; the head then tells where dry friction can hold "
        "the\n"
        "measured body, rest_from_m to rest_to_m.\n"
        "With --record the output is one for fracfit response: columns time_s, force_n, x1_m, x2_m every DT, as "
        "sensors\n"
        "read them, and reference_m, the set-point, where a sine or a file drives it.\n"
        "Examples:\n"
        "  fracfit loop --controller '1 + s^0.5' --restitution 0.6 --velocity2 1 --duration 60\n"
        "  fracfit loop --controller 'exp(-0.1 s) (2 + s)' --restitution 0.6 --setpoint-step 1 --every 0.05 --out "
        "loop.csv\n"
        "  fracfit loop --controller '2 + s' --load-receptance '1/(s^2 + 0.3 s)' --restitution 0 --setpoint-sine 1:0.5 "
        "--force-limit 2\n"
        "  fracfit loop --controller '40 + 9 s' --body x2 --clearance 0.1 --contact-stiffness 5000 --contact-damping "
        "20 "
        "--friction1 2 --setpoint-step 1 --force-limit 30\n"
        "  fracfit loop --controller '2 + s^0.5' --restitution 0.6 --velocity2 1 --sample-time 0.002 --force-limit "
        "0.5\n"
        "  fracfit loop --controller 'cascade(8, 0.9, 0.5)' --body x2 --inertia1 0.2 --inertia2 0.01 --gear-ratio 5 "
        "--gap-degrees 0.1 --restitution 0.3 --step-degrees 1 --load-torque -0.05 --duration 3");
  }

 private:
  static constexpr std::size_t most_impacts = 5'000'000;

  static std::pair<double, double> sine_of(std::string_view name, const std::string& text) {
    const auto [amplitude, omega] = pair_of(name, text, "AMPLITUDE:OMEGA");
    return {number_of(name, amplitude), number_of(name, omega)};
  }

  void check() override {
    if (!contact_.are_given(options())) loop_.check();
    record_.check(options());
    if (is_record_ && !(options_of_run_.sample_time > 0))
      throw std::invalid_argument("--every " + options()["--every"].text() +
                                  ": a record needs the time between its samples, above 0");
    if (is_record_ && options_of_run_.duration < options_of_run_.sample_time)
      throw std::invalid_argument("--duration " + options()["--duration"].text() + ": shorter than --every " +
                                  options()["--every"].text() + ", the time between samples of the record");
  }

  void write_rows(const std::vector<backlash::LoopRow>& rows, const io::Metadata& head) {
    Document document{head, {{"time_s", "x1_m", "v1_m_s", "x2_m", "v2_m_s", "force_n", "event"}, rows.size(), {}}};
    document.rows.fill = [&](std::size_t i, std::vector<Cell>& cells) {
      const backlash::LoopRow& row = rows[i];
      for (const double value : {row.time, row.x1, row.v1, row.x2, row.v2, row.force}) cells.emplace_back(value);
      cells.emplace_back(std::string(backlash::to_string(row.event)));
    };
    write(text_of(document, format(), command_line()));
  }

  void write_rows(const std::vector<backlash::CompliantLoopRow>& rows, const io::Metadata& head) {
    Document document{head,
                      {{"time_s", "x1_m", "v1_m_s", "x2_m", "v2_m_s", "force_n", "event", "contact", "contact_force_n"},
                       rows.size(),
                       {}}};
    document.rows.fill = [&](std::size_t i, std::vector<Cell>& cells) {
      const backlash::CompliantLoopRow& row = rows[i];
      for (const double value : {row.time, row.x1, row.v1, row.x2, row.v2, row.force}) cells.emplace_back(value);
      cells.emplace_back(std::string(backlash::to_string(row.event)));
      cells.emplace_back(contact_word(row.wall));
      cells.emplace_back(row.contact_force);
    };
    write(text_of(document, format(), command_line()));
  }

  int run_sampled() {
    sampled_.duration = options_of_run_.duration;
    sampled_.velocity1 = start_.v1;
    sampled_.velocity2 = start_.v2;
    sampled_.set_point = set_point_;
    sampled_.force_limit = options_of_run_.force_limit;
    sampled_.disturbance = options_of_run_.disturbance;
    const auto say_note = [&](const backlash::ControlLoop& loop) {
      const frac::FractionalPidDesign design(backlash::sampled_controller(loop, sampled_));
      if (!design.note().empty()) say(design.note());
    };
    if (contact_.are_given(options())) {
      const backlash::CompliantLoop loop = loop_.loop(contact_);
      const backlash::CompliantLoopHistory history = backlash::simulate_sampled_loop(loop, sampled_);
      write_rows(history.rows, head_of(loop, history));
      say_end(history.end, history.end_time, history.realisation_error);
      say_note(loop.hard());
      return usable_result;
    }
    const backlash::ControlLoop loop = loop_.loop();
    const backlash::SampledLoopHistory history = backlash::simulate_sampled_loop(loop, sampled_);
    write_rows(history.rows, {{"impacts", std::to_string(history.impacts)}});
    say_note(loop);
    return usable_result;
  }

  void read_set_point() {
    if (sine_) std::tie(set_point_.sine_amplitude, set_point_.sine_omega) = *sine_;
    if (set_point_file_.empty()) return;
    const io::TimeSeries series = io::read_input_signal(set_point_file_);
    for (std::size_t i = 0; i < series.time.size(); ++i) set_point_.knots.push_back({series.time[i], series.input[i]});
  }

  /// What a history of either kind says at its head, and its record.
  template <class History>
  void begin_head(const History& history, io::Metadata& head) const {
    head.emplace_back("end", std::string(backlash::to_string(history.end)));
    head.emplace_back("end_time_s", io::format_number(history.end_time));
    if (history.realisation_error > 0)
      head.emplace_back("realisation_error", io::format_number(history.realisation_error));
  }
  template <class History>
  void write_record(const History& history, const io::Metadata& head, double every) {
    write(text_of({head, record_.rows(backlash::rig_motion(history.rows, set_point_), every), {}}, format(),
                  command_line()));
  }

  void say_end(backlash::LoopEnd end, double end_time, double realisation_error) const {
    if (end == backlash::LoopEnd::rest) {
      say("ended where the bodies come to rest in contact, which is not followed " +
          std::string(options_of_run_.whole_memory ? "with the whole memory" : "with a dead time"));
    }
    if (end == backlash::LoopEnd::most_impacts) say("ended early, at the most impacts allowed");
    if (end == backlash::LoopEnd::most_flights)
      say("ended early: the loop moves too fast for --duration " + io::format_number(options_of_run_.duration) +
          ", of which it was followed to " + io::format_number(end_time) + " s");
    if (end == backlash::LoopEnd::diverged) say("ended early: the motion grows without bound");
    if (realisation_error > 10 * options_of_run_.tolerance) {
      say("the exponentials of the fractional powers err by " + short_number(realisation_error) +
          ", more than the tolerance asked for");
    }
  }

  /// Where dry friction can hold the loop, of a set-point that does not move and forces that the actuator has.
  [[nodiscard]] io::Metadata rest_entries(const backlash::CompliantLoop& loop) const {
    const bool moves = set_point_.ramp != 0 || set_point_.sine_amplitude != 0 || !set_point_.knots.empty();
    const backlash::CoulombFriction& friction = loop.bodies().friction();
    const backlash::Disturbance& disturbance = options_of_run_.disturbance;
    if (disturbance.body1 != 0 || disturbance.body2 != 0) return {};
    if (moves || (friction.body1 == 0 && friction.body2 == 0) || std::isfinite(options_of_run_.force_limit)) return {};
    const backlash::RestRange range = backlash::rest_range(loop, set_point_.step);
    if (!std::isfinite(range.from) || !std::isfinite(range.to)) return {};
    return {{"rest_from_m", io::format_number(range.from)}, {"rest_to_m", io::format_number(range.to)}};
  }

  [[nodiscard]] io::Metadata head_of(const backlash::CompliantLoop& loop,
                                     const backlash::CompliantLoopHistory& history) const {
    io::Metadata head{{"contacts", std::to_string(history.contacts)}};
    begin_head(history, head);
    for (auto& entry : contact_entries(loop.bodies())) head.push_back(std::move(entry));
    for (auto& entry : rest_entries(loop)) head.push_back(std::move(entry));
    return head;
  }

  int run_compliant() {
    const backlash::CompliantLoop loop = loop_.loop(contact_);
    const double every = options_of_run_.sample_time;
    if (is_record_) options_of_run_.sample_time = every / backlash::loop_rows_per_sample;
    const backlash::CompliantLoopHistory history = backlash::simulate_loop(loop, start_, set_point_, options_of_run_);
    const io::Metadata head = head_of(loop, history);
    if (is_record_) {
      write_record(history, head, every);
    } else {
      write_rows(history.rows, head);
    }
    say_end(history.end, history.end_time, history.realisation_error);
    return usable_result;
  }

  int run() override {
    const bool rests_there = set_point_.step == 0 && set_point_.ramp == 0 && !sine_ && set_point_file_.empty();
    const backlash::Disturbance& disturbance = options_of_run_.disturbance;
    if (!rests_there) set_point_.lag = loop_.set_point_lag();
    if (rests_there && start_.v1 == 0 && start_.v2 == 0 && disturbance.body1 == 0 && disturbance.body2 == 0)
      say("nothing moves: both bodies rest at the set-point; give --velocity2, a --setpoint-... or a --disturbance...");
    if (!std::isnan(sampled_.sample_time)) return run_sampled();
    read_set_point();
    if (contact_.are_given(options())) return run_compliant();
    const backlash::ControlLoop loop = loop_.loop();
    const double every = options_of_run_.sample_time;
    if (is_record_) options_of_run_.sample_time = every / backlash::loop_rows_per_sample;
    const backlash::LoopHistory history = backlash::simulate_loop(loop, start_, set_point_, options_of_run_);
    io::Metadata head{{"impacts", std::to_string(history.impacts.size())}};
    begin_head(history, head);
    if (is_record_)
      write_record(history, head, every);
    else
      write_rows(history.rows, head);
    say_end(history.end, history.end_time, history.realisation_error);
    return usable_result;
  }

  LoopOptions loop_;
  CompliantOptions contact_;
  std::optional<std::pair<double, double>> sine_;
  std::string set_point_file_;
  backlash::LoopStart start_;
  backlash::SetPoint set_point_;
  backlash::LoopSimulationOptions options_of_run_;
  backlash::SampledLoopOptions sampled_;
  bool is_record_ = false;
  RecordOptions record_;
};

}  // namespace

std::unique_ptr<Command> make_loop() {
  return std::make_unique<LoopCommand>();
}

}  // namespace fracfit
