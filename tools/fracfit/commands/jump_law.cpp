// SPDX-License-Identifier: BSD-3-Clause
#include "backlash/identification/jump_law.hpp"

#include <algorithm>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <vector>

#include "backlash/compliant/compliant_jump.hpp"
#include "commands/subcommand.hpp"
#include "io/progress_bar.hpp"
#include "options/scene_options.hpp"
#include "output/jump_law_output.hpp"

namespace fracfit {
namespace {

// A power law over a quantity needs two different values of it.
void require_several(const std::string& option, const std::vector<double>& values, const std::string& list,
                     const std::string& grid) {
  if (std::ranges::any_of(values, [&](double value) { return value != values.front(); })) return;
  throw std::invalid_argument(option + " is one value; the laws need at least two different ones, as a list (" + list +
                              ") or a grid (" + grid + "). --constants gives what needs no law");
}

class JumpLaw : public Command {
 public:
  JumpLaw() : Command("jump-law", "Jump frequency over force and clearance, and its power laws") {
    Options& o = options();
    o.flag("--constants", constants_,
           "Instead of the laws c = w_J/sqrt(F/(M2 Delta)) over restitution, with what happens at each jump");
    // By default the grid of the paper's figs. 9 and 10.
    o.parsed("--restitution", restitution_, scene_values_of, "averaged over: list or grid")
        .otherwise("0,0.2,0.4,0.6,0.8,1");
    contact_.add(o, true);
    o.choice("--criterion", criterion_, backlash::jump_criteria());
    o.parsed("--force", force_, scene_values_of, "list or grid").otherwise("10,20,30,40,50");
    o.parsed("--clearance", clearance_, scene_values_of, "list or grid")
        .otherwise("0.01,0.025,0.05,0.1,0.2,0.3,0.4,0.5");
    add_masses(o, mass1_, mass2_);
    add_progress();
    add_common({"json", "csv", "table"});
    set_footer(
        "With contacts that take time the criterion is symmetry-loss, or saddle-node; --constants then has a row for "
        "each force, clearance and\n"
        "contact, with Lambda = K Delta M2/(m F), m = M1 M2/(M1 + M2), and the exponents of force and clearance near "
        "by.\n"
        "Examples:\n"
        "  fracfit jump-law\n"
        "  fracfit jump-law --criterion symmetry-loss --restitution 0.2,0.4,0.6,0.8 --out law.json\n"
        "  fracfit jump-law --force 10:50:9 --clearance 0.01:0.5:12log --format table\n"
        "  fracfit jump-law --contact-stiffness 1e4 --contact-damping 20 --format table\n"
        "  fracfit jump-law --force 9:11:3 --clearance 0.25:0.35:3 --contact-frequency 120 --contact-ratio 0.2 "
        "--friction1 1 --format table\n"
        "  fracfit jump-law --constants --restitution 0:1:101 --format csv --out constants.csv");
  }

 private:
  template <class Losses, class Function>
  auto over_grid(const Losses& losses, Function function) const {
    const char* const of = std::is_same_v<Losses, std::vector<double>> ? "--restitution" : "contacts";
    require_table_size({{"--force", force_.size()}, {"--clearance", clearance_.size()}, {of, losses.size()}});
    frac::Progress progress;
    const io::ProgressBar bar("jump-law", progress, progress_style());
    return function(mass1_, mass2_, force_, clearance_, losses, criterion_, threads(), &progress);
  }

  // Constants that depend on restitution alone are those of any scene; their command line names none.
  void leave_out_scene() {
    if (criterion_ == backlash::JumpCriterion::largest_discontinuity) return;
    bool scene_given = false;
    for (const char* name : {"--force", "--clearance", "--mass1", "--mass2"}) {
      scene_given |= options()[name].is_given();
      options()[name].say("");
    }
    if (scene_given)
      say("by criterion " + std::string(backlash::to_string(criterion_)) +
          " the constants depend on restitution alone; --force, --clearance, --mass1 and --mass2 do not change them");
  }

  int run_constants() {
    leave_out_scene();
    const auto grid = over_grid(restitution_, backlash::jump_grid);
    write(format() == "json"  ? jump_constants_json(command_line(), grid)
          : format() == "csv" ? jump_constants_csv(command_line(), grid)
                              : jump_constants_table(grid));
    if (averaged_count(grid) > 0) return usable_result;
    say("no restitution has a jump by this criterion");
    return no_usable_result;
  }

  int run_laws(bool takes_time) {
    require_several("--force", force_, "10,20,50", "10:50:5");
    require_several("--clearance", clearance_, "0.1,0.2,0.5", "0.1:0.5:5");
    JumpLawRun run{command_line(), mass1_, mass2_};
    if (takes_time) {
      run.contact_columns = contact_.columns();
      run.contacts = contact_.values();
      run.friction = contact_.friction();
    }
    const auto with_friction = [&](auto&&... grid) {
      return backlash::fit_contact_jump_law(grid..., contact_.friction());
    };
    const auto law = takes_time ? over_grid(contact_.contacts(mass1_, mass2_), with_friction)
                                : over_grid(restitution_, backlash::fit_jump_law);
    if (law.message.empty() || format() != "table")
      write(format() == "json"  ? jump_law_json(run, law)
            : format() == "csv" ? jump_law_csv(run, law)
                                : jump_law_table(run, law));
    if (law.message.empty()) return usable_result;
    say(law.message);
    return no_usable_result;
  }

  // Another criterion is refused by the library.
  void take_contacts() {
    options()["--restitution"].say("");
    if (options()["--criterion"].is_given()) return;
    criterion_ = backlash::JumpCriterion::symmetry_loss;
    options()["--criterion"].say(std::string(backlash::to_string(criterion_)));
  }

  int run_contact_constants() {
    const auto contacts = contact_.contacts(mass1_, mass2_);
    require_table_size({{"--force", force_.size()}, {"--clearance", clearance_.size()}, {"contacts", contacts.size()}});
    const JumpLawRun run{command_line(), mass1_, mass2_, contact_.columns(), contact_.values(), contact_.friction()};
    std::vector<ContactJump> jumps;
    for (const double clearance : clearance_)
      for (const double force : force_)
        for (const auto& contact : run.contacts) jumps.push_back({force, clearance, contact, {}});
    frac::Progress progress;
    progress.total += jumps.size();
    const io::ProgressBar bar("jump-law", progress, progress_style());
    frac::parallel_for(jumps.size(), threads(), [&](std::size_t i) {
      const backlash::CompliantBodies bodies(backlash::free_mass(mass1_), backlash::free_mass(mass2_),
                                             jumps[i].clearance, contacts[i % contacts.size()], contact_.friction());
      jumps[i].jump = backlash::compliant_jump(bodies, jumps[i].force, criterion_);
      ++progress.done;
    });
    write(contact_jumps_text(run, criterion_, jumps, format()));
    if (std::ranges::any_of(jumps, [](const auto& each) { return each.jump.similarity_constant.has_value(); }))
      return usable_result;
    say("no contact has a jump by this criterion");
    return no_usable_result;
  }

  void check() override {
    // Restitutions have a default here.
    if (contact_.are_given(options())) return;
    for (const char* name : {"--friction1", "--friction2"})
      if (options()[name].is_given())
        throw std::invalid_argument(std::string(name) + " needs --contact-stiffness or --contact-frequency");
  }

  int run() override {
    const bool takes_time = contact_.are_given(options());
    if (takes_time) take_contacts();
    if (constants_) return takes_time ? run_contact_constants() : run_constants();
    return run_laws(takes_time);
  }

  bool constants_ = false;
  std::vector<double> restitution_, force_, clearance_;
  backlash::JumpCriterion criterion_ = backlash::JumpCriterion::two_impact_loss;
  double mass1_ = 1, mass2_ = 1;
  CompliantOptions contact_;
};

}  // namespace

std::unique_ptr<Command> make_jump_law() {
  return std::make_unique<JumpLaw>();
}

}  // namespace fracfit
