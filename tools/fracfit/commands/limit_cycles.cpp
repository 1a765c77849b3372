// SPDX-License-Identifier: BSD-3-Clause
#include "backlash/loops/limit_cycles.hpp"

#include <cmath>
#include <optional>
#include <stdexcept>

#include "backlash/loops/predicted_cycles.hpp"
#include "commands/subcommand.hpp"
#include "frac/model/algebra.hpp"
#include "io/data_error.hpp"
#include "io/number.hpp"
#include "options/scene_options.hpp"
#include "output/limit_cycles_output.hpp"

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
                "Limit cycles of a loop around two masses with backlash: exact frequency, size and stability, beside "
                "what the describing function predicts") {
    Options& o = options();
    o.text("--controller", controller_, "C of the force -C(s) x on mass 2; e.g. 'exp(-0.1 s) (2 + 1.5 s^0.9)'",
           "FORMULA")
        .required();
    o.choice("--body", body_, backlash::outputs(), "that the controller gets: x1, the load, or x2, the driven mass");
    add_masses(o, mass1_, mass2_);
    o.number("--clearance", clearance_);
    o.number("--restitution", restitution_);
    o.parsed("--omega", range_, range_of, "where cycles are looked for, LOW:HIGH").default_is("wherever they can be");
    o.parsed("--over", over_, variation_of,
             "One loop for each value of mass1, mass2, clearance, restitution or a name in the controller's formula",
             "NAME=FROM:TO:N");
    add_common({"csv", "json", "table"});
    set_footer(
        "Cycles are symmetric, with two impacts per period; roots of the equations that are no motion are listed with\n"
        "the reason. Multipliers count the whole memory of fractional orders.\n"
        "Examples:\n"
        "  fracfit limit-cycles --controller '1 + s^0.5' --restitution 0.6\n"
        "  fracfit limit-cycles --controller 'exp(-0.2 s) (1 + s^0.5)' --restitution 0.6 --format json\n"
        "  fracfit limit-cycles --controller '2 + 1.5 s^a' --restitution 0.8 --over a=0.3:1:15");
  }

 private:
  static std::optional<backlash::FrequencyRange> range_of(std::string_view name, const std::string& text) {
    const auto [low, high] = pair_of(name, text);
    return backlash::FrequencyRange{number_of(name, low), number_of(name, high)};
  }

  // The loop where the quantity that varies has a value, if one does.
  [[nodiscard]] LoopCycles cycles_of(const std::optional<double>& varied) const {
    double mass1 = mass1_, mass2 = mass2_, clearance = clearance_, restitution = restitution_;
    const frac::Structure structure(controller_);
    std::vector<double> parameters(structure.parameter_names().size(), NAN);
    if (varied) {
      if (over_.name == "mass1") {
        mass1 = *varied;
      } else if (over_.name == "mass2") {
        mass2 = *varied;
      } else if (over_.name == "clearance") {
        clearance = *varied;
      } else if (over_.name == "restitution") {
        restitution = *varied;
      } else {
        parameters[structure.parameter_index(over_.name)] = *varied;
      }
    }
    for (std::size_t i = 0; i < parameters.size(); ++i) {
      if (std::isnan(parameters[i])) {
        throw std::invalid_argument("--controller: " + structure.parameter_names()[i] +
                                    " has no value; write a number in its place, or name it in --over");
      }
    }
    const backlash::ControlLoop loop({mass1, mass2, clearance, restitution},
                                     frac::to_transfer_function(structure, parameters), body_);
    const frac::FractionalTransferFunction rigid_masses({{1, 0}}, {{mass1 + mass2, 2}});
    backlash::LimitCycleOptions request;
    request.range = range_;
    LoopCycles result{loop, frac::analyse_closed_loop(loop.controller() * rigid_masses),
                      backlash::symmetric_cycles(loop, request), backlash::predicted_limit_cycles(loop, range_)};
    if (varied) result.varied = {{over_.name, io::format_number(*varied)}};
    return result;
  }

  void check() override {
    if (std::isnan(restitution_) && over_.name != "restitution") {
      throw std::invalid_argument("--restitution is missing");
    }
    if (!std::isnan(restitution_) && over_.name == "restitution") {
      throw std::invalid_argument("--restitution has no meaning with --over restitution=...");
    }
  }

  int run() override {
    std::vector<LoopCycles> loops;
    if (over_.values.empty()) {
      loops.push_back(cycles_of({}));
      if (loops.front().rigid.stability == frac::Stability::unstable) {
        say("the loop is unstable even without clearance: its cycles do not tell what limits the motion");
      }
    }
    for (const double value : over_.values) loops.push_back(cycles_of(value));
    write(format() == "json"  ? limit_cycles_json(loops, command_line())
          : format() == "csv" ? limit_cycles_csv(loops, command_line())
                              : limit_cycles_table(loops));
    return usable_result;
  }

  std::string controller_;
  backlash::Output body_ = backlash::Output::x1;
  double mass1_ = 1, mass2_ = 1, clearance_ = 1, restitution_ = NAN;
  std::optional<backlash::FrequencyRange> range_;
  Variation over_;
};

}  // namespace

std::unique_ptr<Command> make_limit_cycles() {
  return std::make_unique<LimitCyclesCommand>();
}

}  // namespace fracfit
