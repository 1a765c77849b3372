// SPDX-License-Identifier: BSD-3-Clause
#include <cmath>
#include <optional>
#include <stdexcept>

#include "backlash/compliant/compliant_basins.hpp"
#include "batch/basin_stream.hpp"
#include "commands/subcommand.hpp"
#include "io/progress_bar.hpp"
#include "io/shard_file.hpp"
#include "options/scene_options.hpp"
#include "output/basins_output.hpp"
#include "output/document.hpp"
#include "report/grid.hpp"

namespace fracfit {
namespace {

class Basins : public Command {
 public:
  Basins()
      : Command("basins", "Which long-run motion of two masses with backlash each start leads to, at one frequency") {
    Options& o = options();
    add_scene(o, scene_);
    o.one_number("--restitution", restitution_);
    contact_.add(o);
    o.one_number("--omega", omega_, "of the force").required();
    o.choice("--body", sweep_.output, backlash::outputs());
    o.numbers("--position", position_, "grid or list").default_is("41 from wall to wall");
    o.numbers("--velocity", velocity_, "grid or list").default_is("41 up to clearance times w either way");
    add_progress();
    add_common({"csv", "json", "table"});
    set_footer(
        "Attractors are numbered by their share of the starts and listed in the header.  At restitution 1 nothing\n"
        "attracts; the motions of the starts are listed instead.\n"
        "With contacts that take time means are of at most 1280 periods, and starts begin about the mean of the centre "
        "of\nmass as those of history.\n"
        "Into a file, FILE.partial holds what has been found until FILE stands, and the same command goes on with it "
        "after\n"
        "an interruption.\n"
        "Examples:\n"
        "  fracfit basins --restitution 0.6 --omega 1.41\n"
        "  fracfit basins --contact-frequency 30 --contact-restitution 0.6 --friction1 0.02 --omega 1.41\n"
        "  fracfit basins --force 40 --clearance 0.3 --restitution 0.4 --omega 17 --position 0:0.3:101 \\\n"
        "      --velocity -5:5:101 --out basins.csv");
  }

 private:
  int run() override {
    constexpr std::size_t starts_per_side = 41;
    if (contact_.are_given(options()))
      bodies_ = contact_.bodies(backlash::free_mass(scene_.mass1), backlash::free_mass(scene_.mass2), scene_.clearance)
                    .front();
    const backlash::TwoMassSystem system = bodies_ ? bodies_->system() : scene_.system(restitution_);
    const io::Metadata contact = bodies_ ? contact_entries(*bodies_) : io::Metadata{};
    sweep_.threads = threads();
    if (position_.empty()) position_ = report::linear_grid(0, system.clearance(), starts_per_side);
    const double speed = system.clearance() * omega_;
    if (velocity_.empty()) velocity_ = report::linear_grid(-speed, speed, starts_per_side);
    require_table_size({{"--position", position_.size()}, {"--velocity", velocity_.size()}});
    const backlash::BasinMap map = writes_file() ? search_on_disk(system, contact) : search(system, nullptr);
    write(format() == "json"    ? basins_json(map, sweep_.output, contact, command_line())
          : format() == "table" ? basins_table(map, sweep_.output, contact)
                                : text_of(basins_document(map, sweep_.output, contact), format(), command_line()));
    if (partial_) partial_->remove();
    if (!map.attracts()) say(no_attractor);
    return usable_result;
  }

  // What has been found stands in FILE.partial until FILE does.
  backlash::BasinMap search_on_disk(const backlash::TwoMassSystem& system, const io::Metadata& contact) {
    const backlash::BasinMap nothing{system, scene_.force, omega_, {}, {}, {}, {}};
    const std::string head =
        csv_head({basins_scene(nothing, sweep_.output, contact), {{"outcome"}, 0, {}}}, command_line());
    const std::string path = out() + ".partial";
    partial_.emplace(path, std::string(io::unfinished_line) + "\n" + head);
    if (!partial_->is_new()) say("goes on with " + path);
    try {
      return search(system, &*partial_);
    } catch (const std::invalid_argument&) {
      if (partial_->is_new()) partial_->remove();
      throw;
    }
  }

  backlash::BasinMap search(const backlash::TwoMassSystem& system, backlash::OutcomeStore* store) {
    frac::Progress progress;
    const io::ProgressBar bar("basins", progress, progress_style());
    const auto found = [&](const auto& bodies) {
      const double force = scene_.force;
      return store == nullptr
                 ? backlash::basins(bodies, force, omega_, position_, velocity_, sweep_, &progress)
                 : backlash::basins(bodies, force, omega_, position_, velocity_, sweep_, &progress, *store);
    };
    return bodies_ ? found(*bodies_) : found(system);
  }

  Scene scene_;
  double restitution_ = NAN, omega_ = NAN;
  std::vector<double> position_, velocity_;
  backlash::SweepOptions sweep_;
  CompliantOptions contact_;
  std::optional<backlash::CompliantBodies> bodies_;  // whose contacts take time
  std::optional<BasinStream> partial_;
};

}  // namespace

std::unique_ptr<Command> make_basins() {
  return std::make_unique<Basins>();
}

}  // namespace fracfit
