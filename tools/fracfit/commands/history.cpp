// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "backlash/compliant/compliant_history.hpp"
#include "backlash/rig_record.hpp"
#include "backlash/time_history.hpp"
#include "commands/subcommand.hpp"
#include "options/record_options.hpp"
#include "options/scene_options.hpp"
#include "output/document.hpp"

namespace fracfit {
namespace {

constexpr int skipped_at_once = 1000;

class History : public Command {
 public:
  History()
      : Command("history", "Positions and velocities of two masses with backlash over time, exact at every impact") {
    constexpr std::size_t longest_skip = std::numeric_limits<int>::max();
    Options& o = options();
    add_scene(o, scene_);
    o.one_number("--restitution", restitution_);
    contact_.add(o);
    o.numbers("--omega", omegas_, "of the force; several, one after the other, in a record").required();
    o.one_number("--position", position_, "of the start").default_is("mid-gap");
    o.one_number("--velocity", velocity_, "of the start");
    o.count("--skip", skip_, 0, longest_skip, "Force periods to follow before the first row", "N");
    o.count("--periods", periods_, 1, largest_table, "Periods to write; of the force, at each frequency", "N");
    o.count("--samples", samples_, 1, largest_table, "Rows per period, besides two per impact", "N")
        .not_with({"--sample-time"}, "which is the time between rows");
    o.number("--sample-time", sample_time_, "of a record as a rig writes it: time, force and positions, no events");
    record_.add(o, "--sample-time");
    add_common({"csv", "json", "table"});
    set_footer(
        "Time begins where the force F cos(w t) on mass 2 is at its peak; positions are those about the mean of the\n"
        "centre of mass.  Column event: sample, before-impact, after-impact, rest-begin, release; with contacts that\n"
        "take time sample, contact, separation (the wall presses no more), parting (the overlap has ended), and of "
        "each\n"
        "mass with friction stick-1, slide-1, reversal-1.\n"
        "With --sample-time the output is a record for fracfit response: columns time_s, force_n, x1_m, x2_m at equal\n"
        "steps.  Several --omega make a stepped sine: the force changes its frequency at its peak, and positions are "
        "in\n"
        "the frame of the first frequency.\n"
        "Examples:\n"
        "  fracfit history --force 40 --clearance 0.3 --restitution 0.6 --omega 20 --skip 200 --periods 2\n"
        "  fracfit history --force 40 --clearance 0.3 --restitution 0.6 --omega 2 --periods 2 --out chatter.csv\n"
        "  fracfit history --force 40 --clearance 0.3 --contact-stiffness 2e4 --contact-damping 50 --friction1 2 "
        "--omega 20\n"
        "  fracfit history --force 40 --clearance 0.3 --restitution 0.6 --omega 18:40:12log --periods 40 --sample-time "
        "0.001 --sensor-noise 1e-3 --out rig.csv");
  }

 private:
  void check() override {
    if (!std::isnan(sample_time_) && !(sample_time_ > 0 && std::isfinite(sample_time_)))
      throw std::invalid_argument("--sample-time " + options()["--sample-time"].text() + ": allowed is above 0");
    if (omegas_.size() > 1 && std::isnan(sample_time_))
      throw std::invalid_argument("--omega " + options()["--omega"].text() + " names " +
                                  std::to_string(omegas_.size()) +
                                  " frequencies; expected one, or --sample-time for a record of a stepped sine");
    record_.check(options());
    if (!std::isnan(sample_time_))
      require_table_size({{"--omega", omegas_.size()}, {"--periods", static_cast<std::size_t>(periods_)}},
                         largest_table / backlash::rig_steps);
    omega_ = omegas_.front();
  }

  // Follows the periods to skip, in parts, so that their impacts need not all be kept. @return false if impossible
  bool skip(const backlash::TwoMassSystem& system, backlash::RelativeState& start) const {
    for (int left = skip_; left > 0; left -= skipped_at_once) {
      const int periods = std::min(left, skipped_at_once);
      const auto before = backlash::simulate_impacts(system, scene_.force, omega_, start, periods);
      if (!before.complete) {
        say(std::to_string(periods) + " of the periods to skip hold more than " +
            std::to_string(before.impacts.size()) + " impacts");
        return false;
      }
      start = before.end;
    }
    return true;
  }

  /// Writes the record of a motion. @param contact  entries of the head that tell it
  int write_record(const backlash::RigMotion& motion, const io::Metadata& contact) {
    if (!motion.complete) {
      say("no record: the motion can be followed to " + io::format_number(motion.x1.time.back()) +
          " s, where it has too many impacts in a period or leaves the range of numbers");
      return no_usable_result;
    }
    io::Metadata head{{"mass1_kg", io::format_number(scene_.mass1)},
                      {"mass2_kg", io::format_number(scene_.mass2)},
                      {"clearance_m", io::format_number(scene_.clearance)},
                      {"force_n", io::format_number(scene_.force)}};
    head.insert(head.end(), contact.begin(), contact.end());
    if (omegas_.size() == 1) head.emplace_back("omega_rad_s", io::format_number(omega_));
    head.emplace_back("sample_time_s", io::format_number(sample_time_));
    write(text_of({head, record_.rows(motion, sample_time_), {}}, format(), command_line()));
    return usable_result;
  }

  int run_compliant() {
    const backlash::CompliantBodies bodies =
        contact_.bodies(backlash::free_mass(scene_.mass1), backlash::free_mass(scene_.mass2), scene_.clearance).front();
    const double half = 0.5 * scene_.clearance;
    const double position = std::isnan(position_) ? half : position_;
    options()["--position"].say(io::format_number(position));
    const backlash::LoopStart start =
        backlash::start_about_mean(bodies.system(), scene_.force, omega_, {position, velocity_});
    if (!std::isnan(sample_time_))
      return write_record(backlash::rig_motion(bodies, scene_.force, omegas_, start, skip_, periods_),
                          contact_entries(bodies));
    const auto history = backlash::compliant_history(bodies, scene_.force, omega_, start, skip_, periods_, samples_);
    Document document{{{"mass1_kg", io::format_number(scene_.mass1)},
                       {"mass2_kg", io::format_number(scene_.mass2)},
                       {"clearance_m", io::format_number(scene_.clearance)},
                       {"force_n", io::format_number(scene_.force)},
                       {"omega_rad_s", io::format_number(omega_)},
                       {"start_position_m", io::format_number(position)},
                       {"start_velocity_m_s", io::format_number(velocity_)},
                       {"complete", history.complete ? "yes" : "no"}},
                      {{"time_s", "x1_m", "v1_m_s", "x2_m", "v2_m_s", "event", "contact", "contact_force_n"},
                       history.rows.size(),
                       {}}};
    const io::Metadata contact = contact_entries(bodies);
    document.head.insert(document.head.begin() + 4, contact.begin(), contact.end());
    document.rows.fill = [&](std::size_t i, std::vector<Cell>& cells) {
      const auto& row = history.rows[i];
      for (const double value : {row.time, row.x1, row.v1, row.x2 + half, row.v2}) cells.emplace_back(value);
      cells.emplace_back(std::string(backlash::to_string(row.event)));
      cells.emplace_back(contact_word(row.wall));
      cells.emplace_back(row.contact_force);
    };
    write(text_of(document, format(), command_line()));
    if (!history.complete)
      say("ended early, where the motion had 10^5 events in a period or left the range of numbers");
    return history.complete ? usable_result : no_usable_result;
  }

  int run() override {
    if (contact_.are_given(options())) return run_compliant();
    const backlash::TwoMassSystem system = scene_.system(restitution_);
    const bool is_record = !std::isnan(sample_time_);
    if (!is_record)
      require_table_size(
          {{"--periods", static_cast<std::size_t>(periods_)}, {"--samples", static_cast<std::size_t>(samples_)}});
    backlash::RelativeState start{std::isnan(position_) ? 0.5 * system.clearance() : position_, velocity_};
    options()["--position"].say(io::format_number(start.position));
    if (!skip(system, start)) return no_usable_result;
    if (is_record)
      return write_record(backlash::rig_motion(system, scene_.force, omegas_, start, periods_),
                          {{"restitution", io::format_number(system.restitution())}});
    const auto history = backlash::time_history(system, scene_.force, omega_, start, periods_, samples_);
    Document document{{{"mass1_kg", io::format_number(system.mass1())},
                       {"mass2_kg", io::format_number(system.mass2())},
                       {"clearance_m", io::format_number(system.clearance())},
                       {"force_n", io::format_number(scene_.force)},
                       {"restitution", io::format_number(system.restitution())},
                       {"omega_rad_s", io::format_number(omega_)},
                       {"start_position_m", io::format_number(start.position)},
                       {"start_velocity_m_s", io::format_number(start.velocity)},
                       {"complete", history.complete ? "yes" : "no"}},
                      {{"time_s", "x1_m", "v1_m_s", "x2_m", "v2_m_s", "event", "contact"}, history.rows.size(), {}}};
    document.rows.fill = [&](std::size_t i, std::vector<Cell>& cells) {
      const auto& row = history.rows[i];
      for (const double value : {row.time, row.x1, row.v1, row.x2, row.v2}) cells.emplace_back(value);
      cells.emplace_back(std::string(backlash::to_string(row.event)));
      cells.emplace_back(contact_word(row.wall));
    };
    write(text_of(document, format(), command_line()));
    if (!history.complete) say("ended early, at the millionth impact");
    return usable_result;
  }

  Scene scene_;
  std::vector<double> omegas_;
  double restitution_ = NAN, omega_ = NAN, position_ = NAN, velocity_ = 0, sample_time_ = NAN;
  RecordOptions record_;
  CompliantOptions contact_;
  int skip_ = 0, periods_ = 5, samples_ = 100;
};

}  // namespace

std::unique_ptr<Command> make_history() {
  return std::make_unique<History>();
}

}  // namespace fracfit
