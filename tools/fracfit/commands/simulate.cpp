// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <optional>
#include <stdexcept>

#include "backlash/describing_function.hpp"
#include "backlash/loops/forced_bodies.hpp"
#include "backlash/static_backlash.hpp"
#include "commands/subcommand.hpp"
#include "io/progress_bar.hpp"
#include "options/loop_options.hpp"
#include "options/scene_options.hpp"
#include "output/sweep_output.hpp"

namespace fracfit {
namespace {

class Simulate : public Command {
 public:
  Simulate() : Command("simulate", "Describing function N(F, w) of two masses with backlash on a frequency grid") {
    Options& o = options();
    o.parsed("--force", force_, scene_values_of, "several: FROM:TO:COUNT or a list").required();
    o.parsed("--clearance", clearance_, scene_values_of, ">= 0; several too").required();
    o.parsed("--restitution", restitution_, scene_values_of, "several too").needed_with({"--motion", {"dynamic"}});
    o.number("--mass1", mass1_).default_is("1");
    o.number("--mass2", mass2_).default_is("1");
    add_receptances(o, load_, drive_);
    o.numbers("--omega", omega_, "several: FROM:TO:COUNT, FROM:TO:COUNTlog or a list").required();
    o.text("--motion", motion_, "Motion with impacts, or the closed form without inertia", "MOTION")
        .one_of({"dynamic", "static"})
        .was("--model");
    const Condition is_static{"--motion", {"static"}};
    o.choice("--body", sweep_.output, backlash::outputs()).not_with(is_static, "whose closed form gives x1 alone");
    o.choice("--protocol", sweep_.protocol, backlash::protocols()).not_with(is_static, "which is a closed form");
    o.number("--orbit-tolerance", sweep_.tolerance).not_with(is_static, "which is a closed form");
    for (const char* receptance : {"--load-receptance", "--drive-receptance"}) {
      o[receptance].not_with(is_static, "which knows masses alone");
      for (const char* other : {"--protocol", "--orbit-tolerance"})
        o[other].not_with({receptance}, "whose symmetric two-impact orbit is exact");
    }
    o.flag("--diagnostics", diagnostics_,
           "More columns: even-harmonic ratio, energy defect, Lyapunov exponent, periods followed, whether it may be a "
           "transient, sensitivity to the force")
        .not_with(is_static, "which is a closed form");
    o.parsed("--shard", shard_, shard_of, "the pieces are scenes")
        .not_with(is_static, "which is a closed form of one scene")
        .not_with({"--format", {"json"}}, "as fracfit merge joins CSV")
        .unsaid();
    add_common({"csv", "json", "table"});
    set_footer(
        "Several forces, clearances or restitutions give every combination in one table, with columns force_n, "
        "clearance_m, restitution in front.\n"
        "Examples:\n"
        "  fracfit simulate --force 40 --clearance 0.3 --restitution 0.6 --omega 5:35:200log\n"
        "  fracfit simulate --force 40 --clearance 0.3 --restitution 0.6 --omega 0.5:25:200log --body x2 --out "
        "curve.csv\n"
        "  fracfit simulate --force 40 --clearance 0.3 --omega 0.5:25:200log --motion static --format json\n"
        "  fracfit simulate --force 10:50:5 --clearance 0.1:0.3:2 --restitution 0.6 --omega 5:35:200log --shard 1/2 "
        "--out part1.csv\n"
        "  fracfit simulate --force 40 --clearance 0.3 --restitution 0.6 --omega 15:40:50 --load-receptance '1/(s^2 + "
        "0.2 "
        "s^0.5)'");
  }

 private:
  int run() override {
    if (std::isnan(mass1_)) mass1_ = 1;
    if (std::isnan(mass2_)) mass2_ = 1;
    if (!load_ && !drive_) return motion_ == "static" ? run_static() : run_dynamic();
    return run_bodies();
  }

  int run_bodies() {
    if (force_.size() * clearance_.size() * restitution_.size() > 1 || shard_.count > 1) {
      throw std::invalid_argument("with receptances simulate takes one force, one clearance and one restitution");
    }
    const backlash::LinearBodies bodies(load_.value_or(backlash::free_mass(mass1_)),
                                        drive_.value_or(backlash::free_mass(mass2_)), clearance_.front(),
                                        restitution_.front());
    const std::vector<backlash::DescribingFunctionSweep> sweeps{
        backlash::bodies_describing_function(bodies, force_.front(), omega_, sweep_.output)};
    write_sweeps(sweeps, true);
    const auto missing = std::count_if(sweeps.front().points.begin(), sweeps.front().points.end(),
                                       [](const backlash::DescribingFunctionPoint& point) { return !point.usable(); });
    if (missing == 0) return usable_result;
    say(std::to_string(missing) +
        " of the points have no value: there no symmetric two-impact orbit is stable, and other motions of bodies with "
        "friction or springs are not followed");
    return no_usable_result;
  }

  int run_static() {
    for (const auto& [name, values] : {std::pair{"--force", &force_}, std::pair{"--clearance", &clearance_}})
      if (values->size() > 1)
        throw std::invalid_argument(std::string(name) + " has several values; --motion static takes a single one");
    StaticCurve curve{mass1_, mass2_, clearance_.front(), force_.front(), omega_, {}};
    curve.value = backlash::static_describing_function(mass1_, mass2_, curve.clearance, curve.force_amplitude, omega_);
    write(format() == "json" ? static_curve_json(curve, command_line())
                             : text_of(document_of(curve), format(), command_line()));
    return usable_result;
  }

  // Every combination, force slowest.
  [[nodiscard]] std::vector<backlash::SweepScene> scenes() const {
    require_table_size(
        {{"--force", force_.size()}, {"--clearance", clearance_.size()}, {"--restitution", restitution_.size()}});
    std::vector<backlash::SweepScene> scenes;
    for (const double force : force_) {
      for (const double clearance : clearance_) {
        for (const double restitution : restitution_)
          scenes.push_back({backlash::TwoMassSystem(mass1_, mass2_, clearance, restitution), force});
      }
    }
    return scenes;
  }

  void write_sweeps(const std::vector<backlash::DescribingFunctionSweep>& sweeps, bool single) {
    const auto columns = diagnostics_ ? PointColumns::with_diagnostics : PointColumns::basic;
    if (format() == "json") {
      write(single ? sweep_json(sweeps.front(), command_line()) : sweeps_json(sweeps, command_line()));
    } else {
      const Document document = single ? document_of(sweeps.front(), columns) : document_of(sweeps, columns, shard_);
      write(text_of(document, format(), command_line()));
    }
  }

  int run_dynamic() {
    sweep_.threads = threads();
    const std::vector<backlash::SweepScene> all = scenes();
    if (shard_.index > all.size())
      throw std::invalid_argument("--shard " + io::text_of(shard_) + ": there are only " + std::to_string(all.size()) +
                                  " scenes to share");
    const std::vector<backlash::SweepScene> part = io::part_of(all, shard_);
    require_table_size({{"scenes", part.size()}, {"--omega", omega_.size()}});
    frac::Progress progress;
    const auto sweeps = [&] {
      const io::ProgressBar bar("simulate", progress, !is_quiet());
      return backlash::describing_function_sweeps(part, omega_, sweep_, &progress);
    }();
    write_sweeps(sweeps, all.size() == 1);
    const bool usable = std::all_of(sweeps.begin(), sweeps.end(), [](const auto& sweep) {
      return std::all_of(sweep.points.begin(), sweep.points.end(), [](const auto& point) {
        return std::isfinite(point.value.real()) && std::isfinite(point.value.imag());
      });
    });
    if (!usable) say("some points have no finite value, see the output");
    const auto warn = [&](const auto& concerns, const std::string& what) {
      std::ptrdiff_t count = 0;
      for (const auto& sweep : sweeps) count += std::count_if(sweep.points.begin(), sweep.points.end(), concerns);
      if (count > 0) say(std::to_string(count) + " of the points " + what);
    };
    using Point = backlash::DescribingFunctionPoint;
    warn([](const Point& point) { return point.transient_possible; },
         "may be means of a transient; --diagnostics shows which (transient_possible)");
    warn([](const Point& point) { return !std::isnan(point.force_sensitivity); },
         "follow orbits that rounding decides on and are means over forces that differ in the last digits; "
         "--diagnostics shows which (force_sensitivity)");
    return usable ? usable_result : no_usable_result;
  }

  std::vector<double> force_, clearance_, restitution_, omega_;
  double mass1_ = NAN, mass2_ = NAN;
  std::optional<frac::FractionalTransferFunction> load_, drive_;
  std::string motion_ = "dynamic";
  backlash::SweepOptions sweep_;
  bool diagnostics_ = false;
  io::Shard shard_;
};

}  // namespace

std::unique_ptr<Command> make_simulate() {
  return std::make_unique<Simulate>();
}

}  // namespace fracfit
