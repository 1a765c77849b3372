// SPDX-License-Identifier: BSD-3-Clause
#include "backlash/loops/limit_cycles.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>
#include <stdexcept>

#include "backlash/loops/predicted_cycles.hpp"
#include "commands/pictures.hpp"
#include "commands/subcommand.hpp"
#include "frac/model/algebra.hpp"
#include "io/data_error.hpp"
#include "io/number.hpp"
#include "options/loop_options.hpp"
#include "options/scene_options.hpp"
#include "output/limit_cycles_output.hpp"
#include "report/loop_figures.hpp"

namespace fracfit {
namespace {

// NAME=FROM:TO:N of --over.
struct Variation {
  std::string name;
  std::vector<double> values;
};
Variation variation_of(std::string_view option, const std::string& text) {
  const auto equals = text.find('=');
  if (equals == std::string::npos || equals == 0) {
    throw std::invalid_argument(std::string(option) + " " + io::quoted(text) + ": expected NAME=FROM:TO:N");
  }
  return {text.substr(0, equals), numbers_of(option, text.substr(equals + 1))};
}

class LimitCyclesCommand : public Command {
 public:
  LimitCyclesCommand()
      : Command("limit-cycles",
                "Limit cycles of a loop around two bodies with backlash: exact frequency, size and stability, beside "
                "what the describing function predicts") {
    Options& o = options();
    loop_.add(o);
    loop_.add_body(o);
    o.parsed("--omega", range_, range_of, "where cycles are looked for, LOW:HIGH").default_is("wherever they can be");
    o.parsed(
        "--over", over_, variation_of,
        "One loop for each value of mass1, mass2, clearance, restitution or a name in a formula; with contacts that "
        "take time also of contact-stiffness and the like, friction1, friction2",
        "NAME=FROM:TO:N");
    o.count("--starts", starts_, 0, most_starts,
            "Motions simulated from seeded starts, which find cycles with any number of impacts or rests in contact; "
            "with --over at the "
            "values without a stable cycle, where following what they find may take minutes",
            "N")
        .default_is("3, with --over 0");
    o.flag("--branches", branches_,
           "Predict on the orbits of more impacts under a sine force too; of free masses, some seconds");
    o.text(
         "--pictures", pictures_,
         "Draw into this folder (SVG, PNG, gnuplot); the rigid loop against the lines of the describing function and a "
         "period of each motion, or with --over the frequencies",
         "FOLDER")
        .unsaid();
    contact_.add(o);
    CompliantOptions::exclude(o["--branches"],
                              "whose contacts take time and whose predictions stand on the orbit next to each cycle, "
                              "however many its contacts");
    add_common({"csv", "json", "table"});
    set_footer(
        "All symmetric cycles with two impacts per period, and others that motions from seeded starts settle on; roots "
        "of "
        "the\n"
        "equations that are no motion are listed with the reason. Multipliers count the whole memory of fractional "
        "orders. With rising values in --over the formats "
        "table\n"
        "and json tell where cycles meet, lose stability or cease between the values, refined to 1e-10, and where none "
        "is\n"
        "left.\n"
        "With contacts that take time --over gives cycles at its values alone: what the symmetric cycles of the "
        "restitution become, stable or not, and what "
        "motions\n"
        "from seeded starts settle on; impacts_per_period counts meetings of the bodies, sticks_per_period how often "
        "dry\n"
        "friction brings one to rest, and rests tells where it can hold the loop.\n"
        "Examples:\n"
        "  fracfit limit-cycles --controller '1 + s^0.5' --restitution 0.6\n"
        "  fracfit limit-cycles --controller 'exp(-0.2 s) (1 + s^0.5)' --restitution 0.6 --format json\n"
        "  fracfit limit-cycles --controller '1 + s^0.5' --contact-frequency 30 --contact-restitution 0.6 --friction1 "
        "0.01\n"
        "  fracfit limit-cycles --controller '2 + 1.5 s^a' --restitution 0.8 --over a=0.3:1:15\n"
        "  fracfit limit-cycles --controller '2 + s' --load-receptance '1/(s^2 + b s)' --restitution 0.6 --over "
        "b=0:0.5:6");
  }

 private:
  static constexpr int most_starts = 1000, harmonics_drawn = 400;

  static std::optional<backlash::FrequencyRange> range_of(std::string_view name, const std::string& text) {
    const auto [low, high] = pair_of(name, text);
    return backlash::FrequencyRange{number_of(name, low), number_of(name, high)};
  }

  // Where a motion can be simulated.
  static bool can_start(const backlash::ControlLoop& loop) {
    return loop.measured() == backlash::Output::x1 || loop.controller().delay() == 0;
  }

  // The loop where the quantity that varies has a value, if one does.
  [[nodiscard]] LoopCycles cycles_of(const std::optional<double>& varied) const {
    const backlash::ControlLoop loop = loop_.loop(varied ? over_.name : "", varied.value_or(NAN));
    backlash::LimitCycleOptions request;
    request.range = range_;
    LoopCycles result{loop, frac::analyse_closed_loop(loop.controller() * backlash::rigid_receptance(loop.bodies())),
                      backlash::symmetric_cycles(loop, request), backlash::predicted_limit_cycles(loop, range_)};
    if (branches_) {
      if (!loop.bodies().are_free()) throw std::invalid_argument("--branches is for free masses, without receptances");
      const auto further = backlash::predicted_cycles_of_more_impacts(loop, range_);
      result.predicted.insert(result.predicted.end(), further.begin(), further.end());
    }
    const int starts = starts_.value_or(3);
    if (!varied && starts > 0 && can_start(loop)) {
      backlash::ImpactCycleOptions seeded;
      seeded.starts = starts;
      result.settled = backlash::impact_cycles(loop, seeded);
    }
    if (varied) result.varied = {{over_.name, io::format_number(*varied)}};
    return result;
  }

  void check() override {
    if (!is_compliant()) loop_.check(over_.name);
  }
  [[nodiscard]] bool is_compliant() const {
    if (over_.name != "restitution") return contact_.are_given(options());
    return options()["--contact-stiffness"].is_given() || options()["--contact-frequency"].is_given();
  }

  int run_compliant() {
    backlash::CompliantCycleOptions request;
    request.starts = starts_.value_or(request.starts);
    request.range = range_;
    if (!pictures_.empty()) {
      make_picture_folder(pictures_);
      request.harmonics = harmonics_drawn;
    }
    std::vector<std::pair<backlash::CompliantLoop, io::Metadata>> loops;
    if (over_.values.empty()) loops.emplace_back(loop_.loop(contact_), io::Metadata{});
    for (const double value : over_.values)
      loops.emplace_back(loop_.loop(contact_, over_.name, value), io::Metadata{{over_.name, io::format_number(value)}});
    std::vector<CompliantLoopCycles> cycles;
    for (const auto& [loop, varied] : loops)
      cycles.push_back({loop, contact_entries(loop.bodies()),
                        frac::analyse_closed_loop(loop.controller() * backlash::rigid_receptance(loop.bodies().hard())),
                        backlash::compliant_cycles(loop, request), varied});
    if (over_.values.empty() && cycles.front().rigid.stability == frac::Stability::unstable)
      say("the loop is unstable even without clearance: its cycles do not tell what limits the motion");
    std::vector<report::Figure> figures;
    if (!pictures_.empty()) figures = figures_of(cycles);
    constexpr std::size_t listed = 5;
    for (CompliantLoopCycles& each : cycles)
      for (backlash::CompliantCycle& cycle : each.found.cycles)
        cycle.harmonics.resize(std::min(listed, cycle.harmonics.size()));
    write(format() == "json"  ? limit_cycles_json(cycles, command_line())
          : format() == "csv" ? limit_cycles_csv(cycles, command_line())
                              : limit_cycles_table(cycles));
    if (pictures_.empty()) return usable_result;
    if (figures.empty()) {
      say("no picture: no cycle was found");
      return usable_result;
    }
    return draw_pictures(*this, pictures_, figures) ? usable_result : no_usable_result;
  }

  [[nodiscard]] std::vector<report::Figure> figures_of(const std::vector<CompliantLoopCycles>& loops) const {
    std::vector<report::Figure> figures;
    if (over_.values.empty()) {
      const CompliantLoopCycles& loop = loops.front();
      for (std::size_t i = 0; i < loop.found.cycles.size(); ++i)
        figures.push_back(report::cycle_figure(loop.loop, loop.found.cycles[i], "cycle-" + std::to_string(i + 1), {}));
      return figures;
    }
    report::LoopFamilyPicture family{report::enhanced_escape(over_.name), over_.values, {}, {}};
    for (const CompliantLoopCycles& loop : loops) {
      report::LoopPicture picture{loop.loop.hard(), {}, {}};
      for (const backlash::CompliantCycle& cycle : loop.found.cycles) {
        backlash::SymmetricCycle drawn{};
        drawn.omega = cycle.omega;
        drawn.admissible = true;
        drawn.stability = cycle.stability;
        picture.exact.cycles.push_back(drawn);
        if (!cycle.predicted) continue;
        backlash::PredictedCycle predicted{};
        predicted.omega = cycle.predicted->omega;
        picture.predicted.push_back(predicted);
      }
      family.loops.push_back(std::move(picture));
    }
    figures.push_back(report::frequencies_figure(family, "cycles-frequency", {}));
    return figures;
  }

  [[nodiscard]] std::vector<report::Figure> figures_of(const std::vector<LoopCycles>& loops,
                                                       const backlash::CycleContinuation* followed) const {
    std::vector<report::Figure> figures;
    if (!over_.values.empty()) {
      report::LoopFamilyPicture family{report::enhanced_escape(over_.name), over_.values, {}, {}};
      for (const LoopCycles& loop : loops) family.loops.push_back({loop.loop, loop.exact, loop.predicted});
      if (followed) family.events = followed->events;
      figures.push_back(report::frequencies_figure(family, "cycles-frequency", {}));
      return figures;
    }
    const LoopCycles& loop = loops.front();
    if (loop.loop.bodies().are_free() && loop.loop.measured() == backlash::Output::x1) {
      figures.push_back(report::nyquist_figure({loop.loop, loop.exact, loop.predicted}, "cycles-nyquist", {}));
    }
    backlash::LimitCycleOptions request;
    request.range = range_;
    request.harmonics = harmonics_drawn;
    int number = 0;
    for (const backlash::SymmetricCycle& cycle : backlash::symmetric_cycles(loop.loop, request).cycles) {
      ++number;
      if (!cycle.admissible) continue;
      figures.push_back(report::cycle_figure(loop.loop, cycle, "cycle-" + std::to_string(number), {}));
    }
    return figures;
  }

  int run() override {
    if (is_compliant()) return run_compliant();
    // What is wrong with the loop is told before anything is made.
    static_cast<void>(over_.values.empty() ? loop_.loop() : loop_.loop(over_.name, over_.values.front()));
    if (!pictures_.empty()) make_picture_folder(pictures_);
    std::vector<LoopCycles> loops;
    if (over_.values.empty()) {
      loops.push_back(cycles_of({}));
      if (loops.front().rigid.stability == frac::Stability::unstable) {
        say("the loop is unstable even without clearance: its cycles do not tell what limits the motion");
      }
    }
    for (const double value : over_.values) loops.push_back(cycles_of(value));
    std::optional<backlash::CycleContinuation> followed;
    if ((format() != "csv" || !pictures_.empty()) && over_.values.size() > 1 &&
        std::adjacent_find(over_.values.begin(), over_.values.end(), std::greater_equal<>()) == over_.values.end()) {
      backlash::LimitCycleOptions request;
      request.range = range_;
      followed = backlash::continue_cycles([&](double value) { return loop_.loop(over_.name, value); }, over_.values,
                                           request, starts_.value_or(0));
    }
    const backlash::CycleContinuation* events = followed ? &*followed : nullptr;
    // All that can fail is computed before the first line is written.
    std::vector<report::Figure> figures;
    if (!pictures_.empty()) figures = figures_of(loops, events);
    write(format() == "json"  ? limit_cycles_json(loops, events, command_line())
          : format() == "csv" ? limit_cycles_csv(loops, command_line())
                              : limit_cycles_table(loops, events));
    if (pictures_.empty()) return usable_result;
    if (figures.empty()) {
      say("no picture: no cycle is a motion, and the lines of the describing function are those of free masses whose "
          "load is measured");
      return usable_result;
    }
    return draw_pictures(*this, pictures_, figures) ? usable_result : no_usable_result;
  }

  LoopOptions loop_;
  CompliantOptions contact_;
  std::optional<backlash::FrequencyRange> range_;
  Variation over_;
  std::optional<int> starts_;
  bool branches_ = false;
  std::string pictures_;
};

}  // namespace

std::unique_ptr<Command> make_limit_cycles() {
  return std::make_unique<LimitCyclesCommand>();
}

}  // namespace fracfit
