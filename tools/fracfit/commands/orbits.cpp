// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <optional>
#include <stdexcept>

#include "backlash/compliant/compliant_orbits.hpp"
#include "backlash/orbit_continuation.hpp"
#include "commands/subcommand.hpp"
#include "io/number.hpp"
#include "io/progress_bar.hpp"
#include "options/scene_options.hpp"
#include "output/orbits_output.hpp"

namespace fracfit {
namespace {

class Orbits : public Command {
 public:
  Orbits()
      : Command("orbits",
                "Branches of periodic orbits over frequency, force, clearance, restitution or contact frequency, "
                "stable and unstable, "
                "with their bifurcations") {
    constexpr std::size_t most = 1000;
    constexpr const char* why = "which is what changes from --from to --to; leave it out";
    const auto changes = [](const char* parameter) { return Condition{"--parameter", {parameter}}; };
    Options& o = options();
    add_scene(o, scene_);
    o["--force"].not_with(changes("force"), why);
    o["--clearance"].not_with(changes("clearance"), why);
    o.choice("--parameter", parameter_, backlash::orbit_parameters(), "What changes", "NAME");
    o.number("--from", from_, "Its lowest value (rad/s, N, m or 1)", "VALUE").required();
    o.number("--to", to_, "Its highest value", "VALUE").required();
    o.one_number("--omega", omega_, "unless it changes")
        .not_with(changes("omega"), why)
        .needed_with({"--parameter", {"force", "clearance", "restitution", "contact-frequency"}});
    o.one_number("--restitution", restitution_, "unless it changes").not_with(changes("restitution"), why);
    contact_.add(o);
    o.choice("--body", continuation_.output, backlash::outputs());
    o.count("--longest-period", continuation_.longest_period, 1, most, "Force periods of the longest orbits kept", "N");
    o.count("--most-impacts", continuation_.most_impacts, 2, most, "Impacts of the longest orbits kept", "N");
    o.numbers("--basins-at", continuation_.basins_at,
              "Values within the range at which every orbit is followed that basins finds from its usual starts",
              "VALUES");
    add_progress();
    add_common({"csv", "json", "table"});
    set_footer(
        "With force, clearance and masses 1 the frequency is that over sqrt(F/(M2 Delta)).\n"
        "Not every orbit is promised: one that is stable over less than a ten-thousandth of the range, or that\n"
        "attracts few starts over a short piece of it, may be missed, and unstable ones are listed where a stable\n"
        "one leads to them.  A narrower range finds more, and --basins-at those that fracfit basins finds.\n"
        "Orbits in which the masses rest in contact are not followed: a branch ends at the grazing before; simulate "
        "and\nmap give them (regime chatter), each the only one that its stick leaves.\n"
        "With contacts that take time nothing rests, and an orbit goes on past a grazing as the branch that begins "
        "there.\n"
        "--parameter contact-frequency then keeps the damping ratio of the contact that is given.\n"
        "Examples:\n"
        "  fracfit orbits --restitution 0.6 --from 1.3 --to 2.5\n"
        "  fracfit orbits --parameter restitution --omega 1.6 --from 0.1 --to 0.95\n"
        "  fracfit orbits --contact-frequency 20 --contact-restitution 0.6 --friction1 0.02 --from 1.3 --to 2.5\n"
        "  fracfit orbits --restitution 0.6 --force 40 --clearance 0.3 --from 14 --to 25 --format json --out "
        "orbits.json");
  }

 private:
  void check() override {
    for (const double value : continuation_.basins_at) {
      if (!(value >= from_ && value <= to_))
        throw std::invalid_argument("--basins-at " + io::format_number(value) + " lies outside of --from to --to");
    }
  }

  [[nodiscard]] std::optional<backlash::CompliantBodies> compliant_bodies() const {
    const auto given = [&](const Option& option) { return is_compliant_option(option.name()) && option.is_given(); };
    const bool may_have_none = parameter_ == backlash::OrbitParameter::restitution;
    if (may_have_none && std::ranges::none_of(options().all(), given)) return std::nullopt;
    if (!contact_.are_given(options())) return std::nullopt;
    return contact_.bodies(backlash::free_mass(scene_.mass1), backlash::free_mass(scene_.mass2), scene_.clearance)
        .front();
  }

  int run() override {
    const bool over_restitution = parameter_ == backlash::OrbitParameter::restitution;
    const double omega = parameter_ == backlash::OrbitParameter::omega ? from_ : omega_;
    continuation_.threads = threads();
    const std::optional<backlash::CompliantBodies> bodies = compliant_bodies();
    frac::Progress progress;
    const auto diagram = [&] {
      const io::ProgressBar bar("orbits", progress, progress_style());
      const auto of = [&](const auto& bodies) {
        return backlash::orbit_diagram(bodies, scene_.force, omega, parameter_, from_, to_, continuation_, &progress);
      };
      return bodies ? of(*bodies) : of(scene_.system(over_restitution ? 0 : restitution_));
    }();
    const io::Metadata contact = bodies ? contact_entries(*bodies) : io::Metadata{};
    write(format() == "json" ? orbits_json(diagram, contact, command_line())
                             : orbits_text(diagram, contact, format(), command_line()));
    if (diagram.branches.empty()) {
      say("no periodic orbit without rests between these values");
      return no_usable_result;
    }
    const auto lost = std::count_if(diagram.branches.begin(), diagram.branches.end(), [](const auto& branch) {
      const auto failed = [](backlash::BranchEnd end) {
        return end == backlash::BranchEnd::lost || end == backlash::BranchEnd::too_long;
      };
      return failed(branch.begin) || failed(branch.end);
    });
    if (lost > 0) say(std::to_string(lost) + " branches could not be followed to their end");
    return usable_result;
  }

  Scene scene_;
  CompliantOptions contact_;
  backlash::OrbitParameter parameter_ = backlash::OrbitParameter::omega;
  double from_ = NAN, to_ = NAN, omega_ = NAN, restitution_ = NAN;
  backlash::OrbitContinuationOptions continuation_;
};

}  // namespace

std::unique_ptr<Command> make_orbits() {
  return std::make_unique<Orbits>();
}

}  // namespace fracfit
