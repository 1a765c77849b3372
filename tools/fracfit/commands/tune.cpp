// SPDX-License-Identifier: BSD-3-Clause
#include "frac/identification/tune.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>

#include "backlash/design/tune_with_backlash.hpp"
#include "commands/subcommand.hpp"
#include "frac/digital/cascade_gains.hpp"
#include "frac/identification/plants_of_record.hpp"
#include "frac/identification/robust_tune.hpp"
#include "frac/model/algebra.hpp"
#include "frac/time_response/step_figures.hpp"
#include "io/data_error.hpp"
#include "io/number.hpp"
#include "io/time_series_file.hpp"
#include "options/fit_record.hpp"
#include "options/loop_options.hpp"
#include "options/model_options.hpp"
#include "options/scene_options.hpp"
#include "output/aligned_table.hpp"
#include "output/json.hpp"
#include "output/limit_cycles_output.hpp"

namespace fracfit {
namespace {

constexpr double degree = std::numbers::pi / 180;

// Degrees of the command line in rad.
double angle_of(std::string_view name, const std::string& text) {
  const double value = number_of(name, text);
  constexpr double straight = 180;
  if (!(value > 0 && value < straight))
    throw std::invalid_argument(std::string(name) + " " + text + ": expected an angle above 0 and below 180 degrees");
  return degree * value;
}

frac::GainBound gain_bound_of(std::string_view name, const std::string& text) {
  const auto [omega, gain] = pair_of(name, text, "W:GAIN");
  return {number_of(name, omega), number_of(name, gain)};
}

// One number holds the order.
frac::OrderRange order_range_of(std::string_view name, const std::string& text) {
  const bool is_held = text.find(':') == std::string::npos;
  const auto [lower, upper] = is_held ? std::pair(text, text) : pair_of(name, text);
  const frac::OrderRange range{number_of(name, lower), number_of(name, upper)};
  if (!(range.lower >= frac::least_controller_order && range.lower <= range.upper &&
        range.upper <= frac::largest_controller_order))
    throw std::invalid_argument(std::string(name) + " " + text + ": expected orders of " +
                                io::format_number(frac::least_controller_order) + " to " +
                                io::format_number(frac::largest_controller_order) + ", the lower one first");
  return range;
}

Json controller_json(const frac::TuningResult& result) {
  return {{"kp", result.gains.kp}, {"ki", result.gains.ki},
          {"kd", result.gains.kd}, {"lambda", result.gains.lambda},
          {"mu", result.gains.mu}, {"derivative_filter_time", result.derivative_filter_time}};
}

using Plant = frac::FractionalTransferFunction;

// What the exact loop, dead time included, does after a step of its reference; empty where it is not stable or not to
// be computed.
std::optional<frac::StepFigures> setpoint_step(const frac::TuningResult& result, const Plant& plant) {
  if (result.closed_loop != frac::Stability::stable || !(result.crossover > 0)) return std::nullopt;
  try {
    return frac::step_figures(plant * frac::controller_transfer_function(result.gains, result.derivative_filter_time),
                              result.crossover);
  } catch (const std::invalid_argument&) {
    return std::nullopt;
  } catch (const std::domain_error&) {
    return std::nullopt;
  }
}

// A derivative filter acts on the rate alone, and in a cascade on its integral too.
std::optional<frac::CascadeGains> cascade_of(const frac::TuningResult& result) {
  return result.derivative_filter_time > 0 ? std::nullopt : frac::cascade_of(result.gains);
}

Json step_json(const std::optional<frac::StepFigures>& step) {
  if (!step) return {};
  return {
      {"final_value", step->final_value},     {"overshoot", step->overshoot}, {"peak_time", step->peak_time},
      {"settling_time", step->settling_time}, {"until", step->end},           {"error_estimate", step->error_estimate}};
}

Json tuning_json(const frac::TuningResult& result, const Plant& plant, const std::string& command) {
  Json json = origin(command);
  json["plant"] = plant.formula();
  json["status"] = frac::to_string(result.status);
  json["message"] = result.message;
  json["controller"] = controller_json(result);
  json["cascade"] = Json();
  if (const auto cascade = cascade_of(result))
    json["cascade"] = {{"position_gain", cascade->position_gain},
                       {"speed_gain", cascade->speed_gain},
                       {"integral_time", cascade->integral_time}};
  json["specification"] = Json::list(result.specification, [](const auto& line) {
    return Json{{"name", line.name}, {"asked", line.asked}, {"reached", line.reached}, {"met", line.met}};
  });
  const auto found = [](const std::optional<double>& value, double unit) {
    return value ? Json(*value / unit) : Json();
  };
  json["nearby"] = {{"phase_margin_deg", found(result.nearby.phase_margin, degree)},
                    {"lower_crossover", found(result.nearby.lower_crossover, 1)},
                    {"higher_crossover", found(result.nearby.higher_crossover, 1)}};
  json["closed_loop"] = frac::to_string(result.closed_loop);
  json["crossover"] = result.crossover;
  json["phase_margin_deg"] = result.phase_margin / degree;
  json["phase_slope_deg_per_e_fold"] = result.phase_slope / degree;
  json["gain_margin"] = result.gain_margin;
  json["max_sensitivity"] = result.max_sensitivity;
  json["omega_at_max_sensitivity"] = result.omega_max_sensitivity;
  json["max_complementary_sensitivity"] = result.max_complementary_sensitivity;
  json["omega_at_max_complementary_sensitivity"] = result.omega_max_complementary_sensitivity;
  json["iae"] = result.iae;
  json["itae"] = result.itae;
  json["setpoint_step"] = step_json(setpoint_step(result, plant));
  json["evaluations"] = result.evaluations;
  return json;
}

Json region_json(const frac::RobustTuningResult& region) {
  return {{"message", region.message},
          {"plants", region.plants},
          {"not_stable", region.not_stable},
          {"max_sensitivity", region.max_sensitivity},
          {"max_complementary_sensitivity", region.max_complementary_sensitivity},
          {"least_phase_margin_deg", region.least_phase_margin / degree},
          {"crossover_lowest", region.lowest_crossover},
          {"crossover_highest", region.highest_crossover}};
}

Json motion_json(const backlash::PersistentMotion& motion) {
  Json json{{"persists", motion.swing > 0},
            {"swing_m", motion.swing},
            {"omega", motion.omega},
            {"verified", motion.verified},
            {"searched", {{"from", motion.searched.from}, {"to", motion.searched.to}, {"certain", motion.certain}}},
            {"cycles", Json::array()},
            {"simulations", Json::array()}};
  const auto add_cycle = [&](const auto& cycle, double omega, Json impacts, std::size_t rests, double speed) {
    json["cycles"].push_back({{"omega", omega},
                              {"impacts_per_period", std::move(impacts)},
                              {"rests_per_period", rests},
                              {"stable", cycle.stability.stable},
                              {"multiplier_modulus", std::abs(cycle.stability.dominant)},
                              {"impact_speed", speed},
                              {"amplitude_x1", std::abs(cycle.harmonics.front().x1)},
                              {"amplitude_x2", std::abs(cycle.harmonics.front().x2)}});
  };
  for (const auto& cycle : motion.cycles) add_cycle(cycle, cycle.omega, 2, 0, cycle.impact_speed);
  for (const auto& cycle : motion.further) {
    add_cycle(cycle, 2 * std::numbers::pi / cycle.period, has_chatter(cycle) ? Json() : Json(cycle.impacts.size()),
              cycle.rests.size(), cycle.impacts.front().speed);
  }
  for (const auto& cycle : motion.compliant) add_cycle(cycle, cycle.omega, cycle.contacts, 0, cycle.impact_speed);
  for (const auto& simulation : motion.simulations) {
    json["simulations"].push_back(
        {{"velocity2", simulation.speed}, {"swing_m", simulation.swing}, {"dies_out", simulation.dies_out}});
  }
  return json;
}

void append_backlash(Json& json, const backlash::BacklashTuning& result, const backlash::BacklashPlant& plant) {
  const auto& system = plant.bodies.system();
  json["message"] = result.message;
  json["backlash"] = {{"body", backlash::to_string(plant.measured)},
                      {"load_receptance", plant.bodies.load().formula()},
                      {"drive_receptance", plant.bodies.drive().formula()},
                      {"clearance_m", system.clearance()}};
  if (!plant.compliant) json["backlash"]["restitution"] = system.restitution();
  if (plant.compliant) {
    for (const auto& [key, value] : contact_entries(*plant.compliant))
      json["backlash"][key] = io::parse_number(value).value();
    // Of a set-point of 0.
    const backlash::RestRange rests = backlash::rest_range(
        {*plant.compliant,
         frac::controller_transfer_function(result.linear.gains, result.linear.derivative_filter_time), plant.measured},
        0);
    json["backlash"]["rest_from_m"] = rests.from;
    json["backlash"]["rest_to_m"] = rests.to;
  }
  json["backlash"].update(motion_json(result.persistent));
  json["regardless"] = {{"controller", controller_json(result.regardless)},
                        {"max_sensitivity", result.regardless.max_sensitivity}};
  json["regardless"].update(motion_json(result.of_regardless));
  json["constraints"] = Json::list(result.constraints, [](const auto& line) {
    return Json{{"name", line.name}, {"asked", line.asked}, {"reached", line.reached}, {"active", line.active}};
  });
}

/// In degrees per e-fold; what rounding leaves of a slope of 0 is shown as 0.
std::string text_of_slope(double slope) {
  constexpr double rounding = 1e-9;
  return short_number(std::abs(slope) < rounding ? 0 : slope);
}

// @param message  of the whole answer
std::string tuning_table(const frac::TuningResult& result, const Plant& plant, const std::string& message) {
  std::string text = "plant " + plant.formula() + "\n\n";
  AlignedTable controller({"", "value"});
  controller.add({"kp", short_number(result.gains.kp)});
  controller.add({"ki", short_number(result.gains.ki)});
  controller.add({"kd", short_number(result.gains.kd)});
  controller.add({"lambda", short_number(result.gains.lambda)});
  controller.add({"mu", short_number(result.gains.mu)});
  if (result.derivative_filter_time > 0) {
    controller.add({"derivative filter, s", short_number(result.derivative_filter_time)});
  }
  if (const auto cascade = cascade_of(result)) {
    std::string words = short_number(cascade->position_gain) + "," + short_number(cascade->speed_gain);
    if (std::isfinite(cascade->integral_time)) words += "," + short_number(cascade->integral_time);
    controller.add({"as a cascade K1,K2,T", words});
  }
  text += controller.text() + "\n";
  if (!result.specification.empty()) {
    AlignedTable asked({"asked for", "value", "reached", "kept"});
    for (const auto& line : result.specification) {
      asked.add({line.name, short_number(line.asked),
                 line.asked == 0 ? text_of_slope(line.reached) : short_number(line.reached), line.met ? "yes" : "no"});
    }
    text += asked.text() + "\n";
  }
  AlignedTable loop({"loop", "value", "at, rad/s"});
  loop.add({"crossover, rad/s", short_number(result.crossover), ""});
  loop.add({"phase margin, deg", short_number(result.phase_margin / degree), ""});
  loop.add({"phase slope, deg per e-fold", text_of_slope(result.phase_slope / degree), ""});
  loop.add({"gain margin", std::isinf(result.gain_margin) ? "infinite" : short_number(result.gain_margin), ""});
  loop.add({"max |S|", short_number(result.max_sensitivity), short_number(result.omega_max_sensitivity)});
  loop.add({"max |T|", short_number(result.max_complementary_sensitivity),
            short_number(result.omega_max_complementary_sensitivity)});
  if (std::isfinite(result.iae)) {
    loop.add({"IAE", short_number(result.iae), ""});
    loop.add({"ITAE", short_number(result.itae), ""});
  }
  if (const std::optional<frac::StepFigures> step = setpoint_step(result, plant)) {
    loop.add({"overshoot of a set-point step, %", short_number(100 * step->overshoot), ""});
    loop.add(
        {"its settling time to 2 %, s",
         std::isfinite(step->settling_time) ? short_number(step->settling_time) : "above " + short_number(step->end),
         ""});
  }
  return text + loop.text() + "\n" + paragraph(message);
}

std::string region_table(const frac::RobustTuningResult& region) {
  AlignedTable table({"plants of the 95 % region", "worst"});
  table.add({"loops that are not stable", std::to_string(region.not_stable) + " of " + std::to_string(region.plants)});
  table.add({"max |S|", short_number(region.max_sensitivity)});
  table.add({"max |T|", short_number(region.max_complementary_sensitivity)});
  table.add({"phase margin, deg", short_number(region.least_phase_margin / degree)});
  table.add(
      {"crossover, rad/s", short_number(region.lowest_crossover) + " to " + short_number(region.highest_crossover)});
  return "\n" + table.text() + "\n" + paragraph(region.message);
}

std::string backlash_table(const backlash::BacklashTuning& result) {
  AlignedTable constraints({"constraint", "asked", "reached", "active"});
  for (const auto& line : result.constraints)
    constraints.add({line.name, short_number(line.asked), short_number(line.reached), line.active ? "yes" : "no"});
  AlignedTable motions({"motion with clearance", "to either side, m", "rad/s", "stable"});
  for (const auto& [name, motion] :
       {std::pair{"of this controller", &result.persistent}, {"regardless of it", &result.of_regardless}}) {
    if (motion->swing == 0) {
      motions.add({std::string(name) + ": none", "0", "", ""});
      continue;
    }
    const bool is_cycle = std::isfinite(motion->omega);
    motions.add({name, short_number(motion->swing), is_cycle ? short_number(motion->omega) : "",
                 is_cycle ? "yes" : "not known"});
  }
  return "\n" + constraints.text() + "\n" + motions.text();
}

class Tune : public Command {
 public:
  Tune() : Command("tune", "Gains and orders of a fractional PID for a plant") {
    Options& o = options();
    add_model(o, plant_, "the plant");
    o.text("--fit", fit_, "|S| and |T| are kept by all plants of the joint 95 % region of its parameters")
        .names_input();
    o.text("--from-relay", relay_,
           "Plant from samples of input and output (columns time_s,input,output) of a relay experiment or any other: a "
           "lag, a fractional lag, a second order, three equal lags or an integrator with lag, each with dead time, "
           "whichever explains "
           "them "
           "best; then as --fit",
           "FILE")
        .names_input();
    o.number("--clearance", clearance_,
             "of two bodies that are the plant: no motion is to persist, or the smallest; the demands are of the loop "
             "with it closed");
    o.exactly_one({"--model", "--fit", "--from-relay", "--clearance"}, "the plant");
    o.number("--mass1", mass1_);
    o.number("--mass2", mass2_);
    add_receptances(o, load_, drive_);
    o.one_number("--restitution", restitution_);
    contact_.add(o);
    o.choice("--body", body_, backlash::outputs(), "that the controller gets: x1, the load, or x2, the driven body");
    for (const char* name : {"--mass1", "--mass2", "--load-receptance", "--drive-receptance", "--restitution", "--body",
                             "--contact-stiffness", "--contact-frequency", "--friction1", "--friction2"})
      o[name].only_with({"--clearance"});
    o.number("--crossover", asked_.crossover, "Angular frequency at which |L| = 1, rad/s", "W")
        .needed_with({"--clearance"});
    o.parsed("--phase-margin", asked_.phase_margin, angle_of, "At the crossover, degrees", "DEG");
    o.flag("--flat-phase", asked_.flat_phase, "No slope of the phase at the crossover (iso-damping)");
    o.parsed("--max-sensitivity", asked_.max_sensitivity, number_of, "Largest |S| = |1/(1 + L)|", "MS");
    o.parsed("--max-complementary-sensitivity", asked_.max_complementary_sensitivity, number_of,
             "Largest |T| = |L/(1 + L)|", "MT");
    o.parsed("--high-frequency", asked_.high_frequency, gain_bound_of, "|T| <= GAIN from W on (noise)", "W:GAIN");
    o.parsed("--low-frequency", asked_.low_frequency, gain_bound_of, "|S| <= GAIN up to W (disturbances)", "W:GAIN");
    o.choice("--structure", tuning_.structure, frac::controller_structures(),
             "Terms of the controller; series: a PID with real zeros, as of a cascade", "NAME");
    o.parsed("--lambda", tuning_.lambda, order_range_of, "or its range LOW:HIGH").default_is("0.1:1.9");
    o.parsed("--mu", tuning_.mu, order_range_of,
             "or its range LOW:HIGH. Never above what leaves the loop falling as s^-0.2 at high frequency: beyond that "
             "no dead time or lag is small enough to be left out of the plant; a derivative filter adds 1")
        .default_is("0.1:1.9");
    for (const char* order : {"--lambda", "--mu"}) o[order].not_with({"--structure", {"series"}}, "whose orders are 1");
    o.number("--derivative-filter", tuning_.derivative_filter_time);
    o.choice("--minimise", tuning_.criterion, frac::tuning_criteria(),
             "What is made least, max |S| or the integral of |error| or of t |error|", "NAME");
    o.number("--horizon", horizon_, "Length of the step response of iae and itae, s", "T");
    o.text("--step", step_, "Where that step enters", "PLACE").one_of({"setpoint", "load"});
    o.count("--seed", tuning_.seed, 0, std::numeric_limits<std::uint64_t>::max());
    add_common({"json", "table"});
    set_footer(
        "Examples:\n"
        "  fracfit tune --model \"3.13 exp(-50 s)/(433.33 s + 1)\" --crossover 0.008 --phase-margin 60 --flat-phase\n"
        "  fracfit tune --model \"1/(0.8 s^2.2 + 0.5 s^0.9 + 1)\" --crossover 2 --phase-margin 60 "
        "--max-sensitivity 1.4\n"
        "  fracfit tune --model \"exp(-0.1 s)/(s + 1)\" --minimise iae --horizon 10 --step load "
        "--max-sensitivity 1.6\n"
        "  fracfit tune --fit plant.json --crossover 2 --phase-margin 60 --max-sensitivity 1.6\n"
        "  fracfit tune --from-relay relay.csv --crossover 2 --phase-margin 60 --max-sensitivity 1.6\n"
        "  fracfit tune --clearance 0.01 --restitution 0.5 --load-receptance '1/(s^2 + 0.8 s)' --crossover 2 "
        "--phase-margin 50\n"
        "  fracfit tune --clearance 0.01 --contact-frequency 60 --contact-restitution 0.5 --friction1 0.002 "
        "--crossover 2 "
        "--phase-margin 50");
  }

 private:
  [[nodiscard]] frac::PlantsOfRecord plants_of_relay() const {
    auto plants = frac::plants_of_record(io::time_response_data(relay_, io::read_time_response(relay_)));
    if (!plants)
      throw io::DataError(relay_, 0, 0, "shows no plant: neither a lag nor a second order with dead time follows it");
    return *plants;
  }

  int run_for_region() {
    const frac::PlantsOfRecord plants = fit_.empty() ? plants_of_relay() : frac::PlantsOfRecord{read_fit(fit_), {}, {}};
    const frac::FitResult& fit = plants.best;
    const std::string& misfit = plants.misfit;
    frac::RobustTuningResult result = frac::tune_for_region(fit, asked_, tuning_, plants.others);
    if (!misfit.empty()) result.message += " " + misfit;
    const Plant plant = frac::fitted_plant(fit);
    if (format() == "json") {
      Json json = tuning_json(result.nominal, plant, command_line());
      json["status"] = frac::to_string(misfit.empty() ? result.status : frac::TuningStatus::not_met);
      json["region"] = region_json(result);
      write(json.dump() + "\n");
    } else {
      write(tuning_table(result.nominal, plant, result.nominal.message) + region_table(result));
    }
    if (!result.usable() || (!misfit.empty() && format() != "table")) say(result.message);
    return result.usable() && misfit.empty() ? usable_result : no_usable_result;
  }

  [[nodiscard]] backlash::BacklashPlant bodies() const {
    const bool takes_time = contact_.are_given(options());
    if (!takes_time && !load_ && !drive_)
      return {backlash::TwoMassSystem(mass1_, mass2_, *clearance_, restitution_), body_};
    const auto load = load_.value_or(backlash::free_mass(mass1_)), drive = drive_.value_or(backlash::free_mass(mass2_));
    if (!takes_time) return {backlash::LinearBodies(load, drive, *clearance_, restitution_), body_};
    const backlash::CompliantBodies compliant = contact_.bodies(load, drive, *clearance_).front();
    return {compliant.hard(), body_, compliant};
  }

  int run_with_backlash() {
    const backlash::BacklashPlant plant = bodies();
    const backlash::BacklashTuning result = backlash::tune_with_backlash(plant, asked_, tuning_);
    const Plant rigid = backlash::rigid_receptance(plant.bodies);
    if (format() == "json") {
      Json json = tuning_json(result.linear, rigid, command_line());
      append_backlash(json, result, plant);
      write(json.dump() + "\n");
    } else {
      write(tuning_table(result.linear, rigid, result.message) + backlash_table(result));
    }
    const bool has_news = result.persistent.swing > 0 || !result.persistent.verified;
    if (!result.usable() || (has_news && format() != "table")) say(result.message);
    return result.usable() ? usable_result : no_usable_result;
  }

  int run() override {
    tuning_.horizon = horizon_.value_or(0);
    tuning_.load_step = step_ == "load";
    if (clearance_) return run_with_backlash();
    if (!plant_) return run_for_region();
    const frac::TuningResult result = frac::tune(*plant_, asked_, tuning_);
    write(format() == "json" ? tuning_json(result, *plant_, command_line()).dump() + "\n"
                             : tuning_table(result, *plant_, result.message));
    if (result.status == frac::TuningStatus::met) {
      if (result.mu_at_limit && format() != "table") say(result.message);
      return usable_result;
    }
    say(result.message);
    return no_usable_result;
  }

  std::optional<frac::FractionalTransferFunction> plant_;
  frac::LoopSpecification asked_;
  frac::TuningOptions tuning_;
  std::optional<double> horizon_, clearance_;
  double mass1_ = 1, mass2_ = 1, restitution_ = NAN;
  std::optional<frac::FractionalTransferFunction> load_, drive_;
  CompliantOptions contact_;
  backlash::Output body_ = backlash::Output::x1;
  std::string step_ = "setpoint", fit_, relay_;
};

}  // namespace

std::unique_ptr<Command> make_tune() {
  return std::make_unique<Tune>();
}

}  // namespace fracfit
