// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <limits>

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
    o.one_number("--restitution", restitution_).required();
    o.one_number("--omega", omega_, "of the force").required();
    o.one_number("--position", position_, "of the start").default_is("mid-gap");
    o.one_number("--velocity", velocity_, "of the start");
    o.count("--skip", skip_, 0, longest_skip, "Force periods to follow before the first row", "N");
    o.count("--periods", periods_, 1, largest_table, "Periods to write; of the force", "N");
    o.count("--samples", samples_, 1, largest_table, "Rows per period, besides two per impact", "N");
    add_common({"csv", "json", "table"});
    set_footer(
        "Time begins where the force F cos(w t) on mass 2 is at its peak; positions are those about the mean of the\n"
        "centre of mass.  Column event: sample, before-impact, after-impact, rest-begin, release.\n"
        "Examples:\n"
        "  fracfit history --force 40 --clearance 0.3 --restitution 0.6 --omega 20 --skip 200 --periods 2\n"
        "  fracfit history --force 40 --clearance 0.3 --restitution 0.6 --omega 2 --periods 2 --out chatter.csv");
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

  int run() override {
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
      cells.emplace_back(std::string(!row.wall ? "none" : *row.wall == backlash::Wall::near ? "near" : "far"));
    };
    write(text_of(document, format(), command_line()));
    if (!history.complete) say("ended early, at the millionth impact");
    return usable_result;
  }

  Scene scene_;
  double restitution_ = NAN, omega_ = NAN, position_ = NAN, velocity_ = 0;
  int skip_ = 0, periods_ = 5, samples_ = 100;
};

}  // namespace

std::unique_ptr<Command> make_history() {
  return std::make_unique<History>();
}

}  // namespace fracfit
