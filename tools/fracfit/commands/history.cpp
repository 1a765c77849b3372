// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "backlash/compliant/compliant_history.hpp"
#include "backlash/time_history.hpp"
#include "commands/subcommand.hpp"
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
    o.one_number("--omega", omega_, "of the force").required();
    o.one_number("--position", position_, "of the start").default_is("mid-gap");
    o.one_number("--velocity", velocity_, "of the start");
    o.count("--skip", skip_, 0, longest_skip, "Force periods to follow before the first row", "N");
    o.count("--periods", periods_, 1, largest_table, "Periods to write; of the force", "N");
    o.count("--samples", samples_, 1, largest_table, "Rows per period, besides two per impact", "N");
    add_common({"csv", "json", "table"});
    set_footer(
        "Time begins where the force F cos(w t) on mass 2 is at its peak; positions are those about the mean of the\n"
        "centre of mass.  Column event: sample, before-impact, after-impact, rest-begin, release; with contacts that\n"
        "take time sample, contact, separation (the wall presses no more), parting (the overlap has ended), and of "
        "each\n"
        "mass with friction stick-1, slide-1, reversal-1.\n"
        "Examples:\n"
        "  fracfit history --force 40 --clearance 0.3 --restitution 0.6 --omega 20 --skip 200 --periods 2\n"
        "  fracfit history --force 40 --clearance 0.3 --restitution 0.6 --omega 2 --periods 2 --out chatter.csv\n"
        "  fracfit history --force 40 --clearance 0.3 --contact-stiffness 2e4 --contact-damping 50 --friction1 2 "
        "--omega 20");
  }

 private:
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

  // About the mean of the centre of mass, as without friction; the gap is told from one wall on.
  [[nodiscard]] backlash::LoopStart start_of(const backlash::TwoMassSystem& system, double position) const {
    const double total = system.mass1() + system.mass2();
    const double centre = -scene_.force / (total * omega_ * omega_);
    const double share1 = system.mass2() / total, share2 = system.mass1() / total;
    return {centre - share1 * position, 0 - share1 * velocity_, centre + share2 * position, share2 * velocity_};
  }

  int run_compliant() {
    const backlash::CompliantBodies bodies =
        contact_.bodies(backlash::free_mass(scene_.mass1), backlash::free_mass(scene_.mass2), scene_.clearance).front();
    const double half = 0.5 * scene_.clearance;
    const double position = std::isnan(position_) ? half : position_;
    options()["--position"].say(io::format_number(position));
    // The library counts the gap from its middle.
    backlash::LoopStart start = start_of(bodies.system(), position);
    start.x2 -= half;
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
      cells.emplace_back(contact_of(row.wall));
      cells.emplace_back(row.contact_force);
    };
    write(text_of(document, format(), command_line()));
    if (!history.complete)
      say("ended early, where the motion had 10^5 events in a period or left the range of numbers");
    return history.complete ? usable_result : no_usable_result;
  }

  static std::string contact_of(const std::optional<backlash::Wall>& wall) {
    return !wall ? "none" : *wall == backlash::Wall::near ? "near" : "far";
  }

  int run() override {
    if (contact_.are_given(options())) return run_compliant();
    const backlash::TwoMassSystem system = scene_.system(restitution_);
    require_table_size(
        {{"--periods", static_cast<std::size_t>(periods_)}, {"--samples", static_cast<std::size_t>(samples_)}});
    backlash::RelativeState start{std::isnan(position_) ? 0.5 * system.clearance() : position_, velocity_};
    options()["--position"].say(io::format_number(start.position));
    if (!skip(system, start)) return no_usable_result;
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
      cells.emplace_back(contact_of(row.wall));
    };
    write(text_of(document, format(), command_line()));
    if (!history.complete) say("ended early, at the millionth impact");
    return usable_result;
  }

  Scene scene_;
  double restitution_ = NAN, omega_ = NAN, position_ = NAN, velocity_ = 0;
  CompliantOptions contact_;
  int skip_ = 0, periods_ = 5, samples_ = 100;
};

}  // namespace

std::unique_ptr<Command> make_history() {
  return std::make_unique<History>();
}

}  // namespace fracfit
