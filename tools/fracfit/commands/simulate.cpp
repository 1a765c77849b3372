// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <complex>
#include <optional>
#include <stdexcept>

#include "backlash/describing_function.hpp"
#include "backlash/loops/forced_bodies.hpp"
#include "backlash/static_backlash.hpp"
#include "commands/subcommand.hpp"
#include "commands/sweep_command.hpp"
#include "io/progress_bar.hpp"
#include "options/loop_options.hpp"
#include "options/scene_options.hpp"
#include "output/scene_export.hpp"
#include "output/sweep_output.hpp"

namespace fracfit {
namespace {

class Simulate : public SweepCommand {
 public:
  Simulate() : SweepCommand("simulate", "Describing function N(F, w) of two masses with backlash on a frequency grid") {
    Options& o = options();
    o.parsed("--force", force_, scene_values_of, "several: FROM:TO:COUNT or a list").required();
    o.parsed("--clearance", clearance_, scene_values_of, ">= 0; several too").required();
    o.parsed("--restitution", restitution_, scene_values_of, "several too");
    contact_.add(o, true);
    o.number("--mass1", mass1_).default_is("1");
    o.number("--mass2", mass2_).default_is("1");
    add_receptances(o, load_, drive_);
    o.numbers("--omega", omega_, "several: FROM:TO:COUNT, FROM:TO:COUNTlog or a list").required();
    o.text("--motion", motion_, "Motion with impacts, or the closed form without inertia", "MOTION")
        .one_of({"dynamic", "static"});
    const Condition is_static{"--motion", {"static"}};
    o.choice("--body", sweep_.output, backlash::outputs()).not_with(is_static, "whose closed form gives x1 alone");
    add_quantity();
    o.choice("--protocol", sweep_.protocol, backlash::protocols()).not_with(is_static, "which is a closed form");
    o.number("--orbit-tolerance", sweep_.tolerance).not_with(is_static, "which is a closed form");
    for (const char* receptance : {"--load-receptance", "--drive-receptance"}) {
      o[receptance].not_with(is_static, "which knows masses alone");
      o["--orbit-tolerance"].not_with({receptance}, "whose closed orbits are solved to rounding");
    }
    for (const char* contact : {"--contact-stiffness", "--contact-frequency", "--friction1", "--friction2"})
      o[contact].not_with(is_static, "which knows no contact but a rigid one");
    CompliantOptions::exclude(o["--orbit-tolerance"], "whose closed orbits are solved to rounding");
    o.flag("--diagnostics", diagnostics_,
           "More columns: even-harmonic ratio, energy defect, Lyapunov exponent, periods followed, whether it may be a "
           "transient, sensitivity to the force")
        .not_with(is_static, "which is a closed form");
    add_shard("scenes")
        .not_with(is_static, "which is a closed form of one scene")
        .not_with({"--format", {"json"}}, "as fracfit merge joins CSV");
    add_progress();
    add_common({"csv", "json", "table"});
    o.choice("--print", print_, all_scene_words, "without --force and --omega")
        .not_with(is_static, "which has no motion to print");
    for (const char* sweeps : {"--force", "--omega", "--body", "--quantity", "--protocol", "--orbit-tolerance",
                               "--diagnostics", "--shard", "--progress", "--format"})
      o[sweeps].not_with({"--print"}, "which prints the masses alone");
    for (const char* receptance : {"--load-receptance", "--drive-receptance"})
      o[receptance].not_with({"--print"}, "which prints two masses");
    set_footer(
        "Into a file the rows go as they come: FILE.partial holds them until FILE stands, and the same command goes "
        "on\n"
        "with it after an interruption.\n"
        "Several forces, clearances or restitutions give every combination in one table, with columns force_n, "
        "clearance_m, restitution in front; several contacts with columns of the two options that give them.\n"
        "With receptances or compliant contacts --protocol is two-impact unless given.\n"
        "Examples:\n"
        "  fracfit simulate --force 40 --clearance 0.3 --restitution 0.6 --omega 5:35:200log\n"
        "  fracfit simulate --force 40 --clearance 0.3 --restitution 0.6 --omega 0.5:25:200log --body x2 --out "
        "curve.csv\n"
        "  fracfit simulate --force 40 --clearance 0.3 --restitution 0.6 --omega 19.1:35:160 --quantity minus-inverse "
        "--out loss.csv\n"
        "  fracfit simulate --force 40 --clearance 0.3 --omega 0.5:25:200log --motion static --format json\n"
        "  fracfit simulate --force 10:50:5 --clearance 0.1:0.3:2 --restitution 0.6 --omega 5:35:200log --shard 1/2 "
        "--out part1.csv\n"
        "  fracfit simulate --force 40 --clearance 0.3 --restitution 0.6 --omega 15:40:50 --load-receptance "
        "'1/(s^2 + 0.2 s^0.5)'\n"
        "  fracfit simulate --force 40 --clearance 0.3 --contact-frequency 600 --contact-restitution 0.6 --friction1 2 "
        "--omega 15:40:50");
  }

 private:
  int run() override {
    if (std::isnan(mass1_)) mass1_ = 1;
    if (std::isnan(mass2_)) mass2_ = 1;
    if (print_) return print();
    if (motion_ == "dynamic" && contact_.are_given(options())) return run_compliant();
    if (!load_ && !drive_) return motion_ == "static" ? run_static() : run_dynamic();
    return run_bodies();
  }

  int print() {
    const auto refuse = [this](const char* why) {
      throw std::invalid_argument("--print " + std::string(to_string(*print_)) + why);
    };
    const bool is_compliant = contact_.are_given(options());
    if (clearance_.size() > 1 || restitution_.size() > 1 || (is_compliant && contact_.values().size() > 1))
      refuse(" takes one clearance and one contact");
    if (!is_compliant && *print_ != SceneWords::options)
      refuse(": contacts of a simulator have a stiffness; give one in place of --restitution");
    std::optional<backlash::CompliantContact> contact;
    backlash::CoulombFriction friction;
    if (is_compliant) {
      const auto bodies =
          contact_.bodies(backlash::free_mass(mass1_), backlash::free_mass(mass2_), clearance_.front()).front();
      contact = bodies.contact();
      friction = bodies.friction();
    }
    const backlash::TwoMassSystem system(mass1_, mass2_, clearance_.front(), is_compliant ? 1 : restitution_.front());
    write(scene_in(*print_, system, contact, friction, command_line()));
    return usable_result;
  }

  [[nodiscard]] PointColumns columns() const {
    return diagnostics_ ? PointColumns::with_diagnostics : PointColumns::basic;
  }
  // JSON has all columns.
  [[nodiscard]] PointForm json_form() const { return form(PointColumns::with_diagnostics, has_loss_factor()); }
  [[nodiscard]] bool has_loss_factor() const { return sweep_.output == backlash::Output::x1 && !load_ && !drive_; }

  // Every combination, force slowest.
  int run_compliant() {
    const auto values = contact_.values();
    const std::size_t contacts = values.size();
    require_table_size({{"--force", force_.size()}, {"--clearance", clearance_.size()}, {"contacts", contacts}});
    std::vector<LabelledScene> scenes;
    std::vector<io::Metadata> entries;
    io::Metadata shared;
    for (const double force : force_) {
      for (const double clearance : clearance_) {
        const std::vector<backlash::CompliantBodies> bodies = contact_.bodies(
            load_.value_or(backlash::free_mass(mass1_)), drive_.value_or(backlash::free_mass(mass2_)), clearance);
        shared = contacts == 1 ? contact_entries(bodies.front()) : friction_entries(contact_.friction());
        for (std::size_t i = 0; i < bodies.size(); ++i) {
          scenes.push_back({{bodies[i], force}, {force, clearance}});
          entries.push_back(contact_entries(bodies[i]));
          if (contacts == 1) continue;
          scenes.back().labels.insert(scenes.back().labels.end(), values[i].begin(), values[i].end());
        }
      }
    }
    std::vector<std::string> labels;
    if (scenes.size() > 1) labels = {"force_n", "clearance_m"};
    if (scenes.size() == 1) scenes.front().labels.clear();
    if (contacts > 1)
      for (const std::string& column : contact_.columns()) labels.push_back(column);
    default_to_two_impact(sweep_);
    sweep_.threads = threads();
    const bool has_loss = has_loss_factor() && scenes.front().scene.bodies.are_free();
    if (format() != "json") return write_points(scenes, labels, shared, omega_, sweep_, form(columns(), has_loss));

    require_table_size({{"scenes", scenes.size()}, {"--omega", omega_.size()}});
    std::vector<backlash::CompliantScene> bodies;
    for (const LabelledScene& each : scenes) bodies.push_back(each.scene);
    frac::Progress progress;
    const auto sweeps = [&] {
      const io::ProgressBar bar(name(), progress, progress_style());
      return backlash::bodies_describing_functions(bodies, omega_, sweep_, &progress);
    }();
    const PointForm all = form(PointColumns::with_diagnostics, has_loss);
    write(sweeps.size() == 1 ? sweep_json(sweeps.front(), all, command_line(), entries.front())
                             : sweeps_json(sweeps, all, command_line(), entries));
    PointCounts counts;
    for (const auto& sweep : sweeps) counts.add(sweep.points, quantity());
    say_what_rounding_left(counts.not_finite);
    return exit_code_of(counts, all);
  }

  int run_bodies() {
    if (force_.size() * clearance_.size() * restitution_.size() > 1 || shard().count > 1) {
      throw std::invalid_argument("with receptances simulate takes one force, one clearance and one restitution");
    }
    const backlash::LinearBodies bodies(load_.value_or(backlash::free_mass(mass1_)),
                                        drive_.value_or(backlash::free_mass(mass2_)), clearance_.front(),
                                        restitution_.front());
    default_to_two_impact(sweep_);
    const backlash::DescribingFunctionSweep sweep =
        backlash::bodies_describing_function(bodies, force_.front(), omega_, sweep_);
    if (format() == "json") {
      write(sweep_json(sweep, json_form(), command_line()));
    } else {
      const std::vector<backlash::SweepScene> scene{{bodies.system(), sweep.force_amplitude}};
      const SweepTable table = sweep_table(scene, scene, sweep.options, form(columns(), has_loss_factor()), shard());
      write(text_of(document_of(table, 0, omega_.size(), sweep.points), format(), command_line()));
    }
    PointCounts counts;
    counts.add(sweep.points, quantity());
    return exit_code_of(counts, form(columns(), has_loss_factor()));
  }

  int run_static() {
    for (const auto& [name, values] : {std::pair{"--force", &force_}, std::pair{"--clearance", &clearance_}})
      if (values->size() > 1)
        throw std::invalid_argument(std::string(name) + " has several values; --motion static takes a single one");
    StaticCurve curve{mass1_, mass2_, clearance_.front(), force_.front(), omega_, {}};
    curve.value = backlash::static_describing_function(mass1_, mass2_, curve.clearance, curve.force_amplitude, omega_);
    write(format() == "json" ? static_curve_json(curve, quantity(), command_line())
                             : text_of(document_of(curve, quantity()), format(), command_line()));
    const auto without = std::count(curve.value.begin(), curve.value.end(), std::complex<double>(0));
    const bool inverse = quantity() == backlash::Quantity::minus_inverse;
    return has_values(inverse ? static_cast<std::size_t>(without) : 0, omega_.size()) ? usable_result
                                                                                      : no_usable_result;
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

  // JSON has a scene with each curve.
  int run_json(const std::vector<backlash::SweepScene>& all) {
    frac::Progress progress;
    const auto sweeps = [&] {
      const io::ProgressBar bar(name(), progress, progress_style());
      return backlash::describing_function_sweeps(all, omega_, sweep_, &progress);
    }();
    write(sweeps.size() == 1 ? sweep_json(sweeps.front(), json_form(), command_line())
                             : sweeps_json(sweeps, json_form(), command_line()));
    PointCounts counts;
    for (const auto& sweep : sweeps) counts.add(sweep.points, quantity());
    return exit_code_of(counts, json_form());
  }

  int run_dynamic() {
    sweep_.threads = threads();
    const std::vector<backlash::SweepScene> all = scenes();
    const std::vector<backlash::SweepScene> part = io::part_of(all, shard(), expected_costs(all));
    require_table_size({{"scenes", part.size()}, {"--omega", omega_.size()}},
                       streams() ? largest_stream : largest_table);
    if (format() == "json") return run_json(all);
    return write_points({part, omega_, sweep_},
                        sweep_table(all, part, sweep_, form(columns(), has_loss_factor()), shard()));
  }

  std::vector<double> force_, clearance_, restitution_, omega_;
  double mass1_ = NAN, mass2_ = NAN;
  CompliantOptions contact_;
  std::optional<frac::FractionalTransferFunction> load_, drive_;
  std::string motion_ = "dynamic";
  backlash::SweepOptions sweep_;
  bool diagnostics_ = false;
  std::optional<SceneWords> print_;
};

}  // namespace

std::unique_ptr<Command> make_simulate() {
  return std::make_unique<Simulate>();
}

}  // namespace fracfit
