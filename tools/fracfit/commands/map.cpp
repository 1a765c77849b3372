// SPDX-License-Identifier: BSD-3-Clause
#include "backlash/regime_map.hpp"
#include "commands/subcommand.hpp"
#include "commands/sweep_command.hpp"
#include "options/scene_options.hpp"
#include "output/sweep_output.hpp"

namespace fracfit {
namespace {

class Map : public SweepCommand {
 public:
  Map() : SweepCommand("map", "N, regime and error of two masses with backlash over restitution and frequency") {
    Options& o = options();
    add_scene(o, scene_);
    o.parsed("--restitution", restitution_, scene_values_of, "several: FROM:TO:COUNT or a list");
    contact_.add(o, true);
    o.numbers("--omega", omega_, "several: FROM:TO:COUNT, FROM:TO:COUNTlog or a list").required();
    o.choice("--body", sweep_.output, backlash::outputs());
    add_quantity();
    o.choice("--protocol", sweep_.protocol, backlash::protocols());
    o.number("--orbit-tolerance", sweep_.tolerance);
    CompliantOptions::exclude(o["--orbit-tolerance"], "whose closed orbits are solved to rounding");
    o.number("--mean-tolerance", sweep_.mean_tolerance,
             "Uncertainty over |N| at which a long-time mean ends; 0 for a thousand periods each", "T");
    add_shard("restitutions or contacts").not_with({"--format", {"json"}}, "as fracfit merge joins CSV");
    add_progress();
    add_common({"csv", "json", "table"});
    set_footer(
        "With force, clearance and masses 1 the frequency is that over sqrt(F/(M2 Delta)).\n"
        "With contacts that take time each row begins with the two options that give them, and --protocol is "
        "two-impact unless given.\n"
        "Into a file the rows go as they come: FILE.partial holds them until FILE stands, and the same command goes "
        "on\n"
        "with it after an interruption.\n"
        "Examples:\n"
        "  fracfit map --restitution 0:1:251 --omega 0.5:4:400log --out map.csv\n"
        "  fracfit map --force 40 --clearance 0.3 --restitution 0:0.95:20 --omega 5:35:200log --shard 1/2 --out "
        "part1.csv\n"
        "  fracfit map --contact-frequency 8,16,32 --contact-restitution 0.4,0.6 --omega 1.7:2.3:60 --out soft.csv\n"
        "  fracfit merge part1.csv part2.csv --out map.csv");
  }

 private:
  int run() override {
    sweep_.threads = threads();
    if (contact_.are_given(options())) return run_compliant();
    const backlash::MapScene scene{scene_.mass1, scene_.mass2, scene_.clearance, scene_.force};
    const std::vector<backlash::SweepScene> scenes = backlash::map_scenes(scene, restitution_);
    const std::vector<double> cost = expected_costs(scenes);
    const std::vector<double> part = io::part_of(restitution_, shard(), cost);
    // More shards than restitutions leave some without any.
    require_table_size({{"--restitution", part.size()}, {"--omega", omega_.size()}},
                       streams() ? largest_stream : largest_table);
    return write_points(
        {io::part_of(scenes, shard(), cost), omega_, sweep_},
        map_table(scene, part, sweep_, form(PointColumns::with_diagnostics, sweep_.output == backlash::Output::x1),
                  shard()));
  }

  int run_compliant() {
    const auto bodies =
        contact_.bodies(backlash::free_mass(scene_.mass1), backlash::free_mass(scene_.mass2), scene_.clearance);
    const auto values = contact_.values();
    std::vector<LabelledScene> scenes;
    for (std::size_t i = 0; i < bodies.size(); ++i)
      scenes.push_back({{bodies[i], scene_.force}, {values[i].begin(), values[i].end()}});
    const auto columns = contact_.columns();
    default_to_two_impact(sweep_);
    return write_points(
        scenes, {columns.begin(), columns.end()}, friction_entries(contact_.friction()), omega_, sweep_,
        form(PointColumns::with_diagnostics, sweep_.output == backlash::Output::x1 && bodies.front().are_free()));
  }

  Scene scene_;
  CompliantOptions contact_;
  std::vector<double> restitution_, omega_;
  backlash::SweepOptions sweep_ = backlash::map_options();
};

}  // namespace

std::unique_ptr<Command> make_map() {
  return std::make_unique<Map>();
}

}  // namespace fracfit
