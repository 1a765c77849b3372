// SPDX-License-Identifier: BSD-3-Clause
#include "backlash/basins.hpp"

#include <cmath>
#include <optional>
#include <stdexcept>

#include "batch/basin_stream.hpp"
#include "commands/subcommand.hpp"
#include "io/number.hpp"
#include "io/progress_bar.hpp"
#include "io/shard_file.hpp"
#include "options/scene_options.hpp"
#include "output/document.hpp"
#include "output/json.hpp"
#include "report/grid.hpp"

namespace fracfit {
namespace {

io::Metadata scene_of(const backlash::BasinMap& map, backlash::Output output) {
  return {
      {"mass1_kg", io::format_number(map.system.mass1())},          {"mass2_kg", io::format_number(map.system.mass2())},
      {"clearance_m", io::format_number(map.system.clearance())},   {"force_n", io::format_number(map.force_amplitude)},
      {"restitution", io::format_number(map.system.restitution())}, {"omega_rad_s", io::format_number(map.omega)},
      {"output", std::string(backlash::to_string(output))}};
}

// What the starts are told apart by.
std::string motion_name(const backlash::BasinMap& map) {
  return map.attracts() ? "attractor" : "motion";
}

constexpr const char* no_attractor =
    "at restitution 1 impacts lose no energy and nothing attracts: the motions listed are those of these starts, told "
    "apart by their long-time means; other starts have others";

double share_of(const backlash::BasinMap& map, const backlash::Attractor& attractor) {
  return static_cast<double>(attractor.starts) / static_cast<double>(map.attractor.size());
}

Document document(const backlash::BasinMap& map, backlash::Output output) {
  Document result{scene_of(map, output), {{"position_m", "velocity_m_s", motion_name(map)}, map.attractor.size(), {}}};
  if (!map.attracts()) result.head.emplace_back("note", no_attractor);
  for (std::size_t i = 0; i < map.attractors.size(); ++i) {
    const auto& [point, symmetric, starts] = map.attractors[i];
    result.head.emplace_back(
        motion_name(map) + " " + std::to_string(i),
        "share " + io::format_number(share_of(map, map.attractors[i])) + ", regime " +
            std::string(backlash::to_string(point.regime)) + ", period " + std::to_string(point.period) +
            ", impacts per period " + io::format_number(point.impacts_per_period) +
            (symmetric ? ", symmetric" : ", asymmetric") + ", N " + io::format_number(point.value.real()) +
            (std::signbit(point.value.imag()) ? " - " : " + ") + io::format_number(std::abs(point.value.imag())) +
            " j m/N, uncertainty " + io::format_number(point.uncertainty) +
            (point.transient_possible
                 ? ", transient not excluded after " + io::format_number(point.periods_followed) + " periods"
                 : "") +
            (std::isnan(point.force_sensitivity)
                 ? ""
                 : ", lost in rounding: mean over forces that differ in the last digits, N changes by up to " +
                       io::format_number(point.force_sensitivity) + " times the relative change of the force"));
  }
  result.rows.fill = [&map](std::size_t i, std::vector<Cell>& cells) {
    cells.emplace_back(map.position[i / map.velocity.size()]);
    cells.emplace_back(map.velocity[i % map.velocity.size()]);
    cells.emplace_back(static_cast<std::int64_t>(map.attractor[i]));
  };
  return result;
}

std::string json(const backlash::BasinMap& map, backlash::Output output, const std::string& command) {
  Json result = origin(command);
  for (const auto& [key, value] : scene_of(map, output)) {
    const auto parsed = io::parse_number(value);
    result["scene"][key] = parsed ? Json(*parsed) : Json(value);
  }
  if (!map.attracts()) result["note"] = no_attractor;
  Json& motions = result[motion_name(map) + "s"] = Json::array();
  for (const auto& attractor : map.attractors)
    motions.push_back({{"share", share_of(map, attractor)},
                       {"starts", attractor.starts},
                       {"regime", backlash::to_string(attractor.point.regime)},
                       {"period", attractor.point.period},
                       {"impacts_per_period", attractor.point.impacts_per_period},
                       {"symmetric", attractor.symmetric},
                       {"re_m_per_n", attractor.point.value.real()},
                       {"im_m_per_n", attractor.point.value.imag()},
                       {"uncertainty_m_per_n", attractor.point.uncertainty},
                       {"lyapunov_exponent", attractor.point.lyapunov_exponent},
                       {"periods_followed", attractor.point.periods_followed},
                       {"transient_possible", attractor.point.transient_possible},
                       {"force_sensitivity", attractor.point.force_sensitivity}});
  result["position_m"] = map.position;
  result["velocity_m_s"] = map.velocity;
  result[motion_name(map)] = map.attractor;
  return result.dump(-1) + "\n";
}

class Basins : public Command {
 public:
  Basins()
      : Command("basins", "Which long-run motion of two masses with backlash each start leads to, at one frequency") {
    Options& o = options();
    add_scene(o, scene_);
    o.one_number("--restitution", restitution_).required();
    o.one_number("--omega", omega_, "of the force").required();
    o.choice("--body", sweep_.output, backlash::outputs());
    o.numbers("--position", position_, "grid or list").default_is("41 from wall to wall");
    o.numbers("--velocity", velocity_, "grid or list").default_is("41 up to clearance times w either way");
    add_progress();
    add_common({"csv", "json", "table"});
    set_footer(
        "Attractors are numbered by their share of the starts and listed in the header.  At restitution 1 nothing\n"
        "attracts; the motions of the starts are listed instead.\n"
        "Into a file, FILE.partial holds what has been found until FILE stands, and the same command goes on with it "
        "after\n"
        "an interruption.\n"
        "Examples:\n"
        "  fracfit basins --restitution 0.6 --omega 1.41\n"
        "  fracfit basins --force 40 --clearance 0.3 --restitution 0.4 --omega 17 --position 0:0.3:101 \\\n"
        "      --velocity -5:5:101 --out basins.csv");
  }

 private:
  int run() override {
    constexpr std::size_t starts_per_side = 41;
    const backlash::TwoMassSystem system = scene_.system(restitution_);
    sweep_.threads = threads();
    if (position_.empty()) position_ = report::linear_grid(0, system.clearance(), starts_per_side);
    const double speed = system.clearance() * omega_;
    if (velocity_.empty()) velocity_ = report::linear_grid(-speed, speed, starts_per_side);
    require_table_size({{"--position", position_.size()}, {"--velocity", velocity_.size()}});
    const backlash::BasinMap map = writes_file() ? search_on_disk(system) : search(system, nullptr);
    write(format() == "json" ? json(map, sweep_.output, command_line())
                             : text_of(document(map, sweep_.output), format(), command_line()));
    if (partial_) partial_->remove();
    if (!map.attracts()) say(no_attractor);
    return usable_result;
  }

  // What has been found stands in FILE.partial until FILE does.
  backlash::BasinMap search_on_disk(const backlash::TwoMassSystem& system) {
    const backlash::BasinMap nothing{system, scene_.force, omega_, {}, {}, {}, {}};
    const std::string head = csv_head({scene_of(nothing, sweep_.output), {{"outcome"}, 0, {}}}, command_line());
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
    const double force = scene_.force;
    return store == nullptr ? backlash::basins(system, force, omega_, position_, velocity_, sweep_, &progress)
                            : backlash::basins(system, force, omega_, position_, velocity_, sweep_, &progress, *store);
  }

  Scene scene_;
  double restitution_ = NAN, omega_ = NAN;
  std::vector<double> position_, velocity_;
  backlash::SweepOptions sweep_;
  std::optional<BasinStream> partial_;
};

}  // namespace

std::unique_ptr<Command> make_basins() {
  return std::make_unique<Basins>();
}

}  // namespace fracfit
