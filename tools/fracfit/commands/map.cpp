// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "backlash/regime_map.hpp"
#include "commands/subcommand.hpp"
#include "io/progress_bar.hpp"
#include "options/scene_options.hpp"
#include "output/sweep_output.hpp"

namespace fracfit {
namespace {

class Map : public Command {
 public:
  Map() : Command("map", "N, regime and error of two masses with backlash over restitution and frequency") {
    Options& o = options();
    add_scene(o, scene_);
    o.parsed("--restitution", restitution_, scene_values_of, "several: FROM:TO:COUNT or a list").required();
    o.numbers("--omega", omega_, "several: FROM:TO:COUNT, FROM:TO:COUNTlog or a list").required();
    o.choice("--body", sweep_.output, backlash::outputs());
    o.choice("--protocol", sweep_.protocol, backlash::protocols());
    o.number("--orbit-tolerance", sweep_.tolerance);
    o.number("--mean-tolerance", sweep_.mean_tolerance,
             "Uncertainty over |N| at which a long-time mean ends; 0 for a thousand periods each", "T");
    o.parsed("--shard", shard_, shard_of, "the pieces are restitutions")
        .not_with({"--format", {"json"}}, "as fracfit merge joins CSV")
        .unsaid();
    add_common({"csv", "json", "table"});
    set_footer(
        "With force, clearance and masses 1 the frequency is that over sqrt(F/(M2 Delta)).\n"
        "Examples:\n"
        "  fracfit map --restitution 0:1:251 --omega 0.5:4:400log --out map.csv\n"
        "  fracfit map --force 40 --clearance 0.3 --restitution 0:0.95:20 --omega 5:35:200log --shard 1/2 --out "
        "part1.csv\n"
        "  fracfit merge part1.csv part2.csv --out map.csv");
  }

 private:
  int run() override {
    sweep_.threads = threads();
    const std::vector<double> part = io::part_of(restitution_, shard_);
    if (part.empty())
      throw std::invalid_argument("--shard " + io::text_of(shard_) + ": there are only " +
                                  std::to_string(restitution_.size()) + " restitutions to share");
    require_table_size({{"--restitution", part.size()}, {"--omega", omega_.size()}});
    frac::Progress progress;
    const auto map = [&] {
      const io::ProgressBar bar("map", progress, !is_quiet());
      return backlash::regime_map({scene_.mass1, scene_.mass2, scene_.clearance, scene_.force}, part, omega_, sweep_,
                                  &progress);
    }();
    write(text_of(document_of(map, shard_), format(), command_line()));
    const bool usable = std::all_of(map.points.begin(), map.points.end(), [](const auto& point) {
      return std::isfinite(point.value.real()) && std::isfinite(point.value.imag());
    });
    if (!usable) say("some points have no finite value, see the output");
    return usable ? usable_result : no_usable_result;
  }

  Scene scene_;
  std::vector<double> restitution_, omega_;
  backlash::SweepOptions sweep_ = backlash::map_options();
  io::Shard shard_;
};

}  // namespace

std::unique_ptr<Command> make_map() {
  return std::make_unique<Map>();
}

}  // namespace fracfit
