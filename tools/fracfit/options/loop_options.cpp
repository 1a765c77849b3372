// SPDX-License-Identifier: BSD-3-Clause
#include "options/loop_options.hpp"

#include <stdexcept>
#include <vector>

#include "frac/structure.hpp"
#include "io/data_error.hpp"
#include "options/drive_options.hpp"
#include "options/model_options.hpp"

namespace fracfit {
namespace {

// A formula in which one name may have a value.
class Formula {
 public:
  Formula(std::string option, const std::string& text) : option_(std::move(option)), structure_(text) {}

  [[nodiscard]] bool has(const std::string& name) const {
    for (const std::string& each : structure_.parameter_names()) {
      if (each == name) return true;
    }
    return false;
  }
  [[nodiscard]] frac::FractionalTransferFunction with(const std::string& name, double value) const {
    for (const std::string& each : structure_.parameter_names()) {
      if (each != name) {
        throw std::invalid_argument(option_ + ": " + each +
                                    " has no value; write a number in its place, or name it in --over");
      }
    }
    const std::vector<double> values(structure_.parameter_names().size(), value);
    return frac::to_transfer_function(structure_, values);
  }

 private:
  std::string option_;
  frac::Structure structure_;
};

constexpr const char* load_meaning = "Displacement per force of body 1, m/N, instead of the free mass 1/(M1 s^2)";
const std::string load_help = std::string(load_meaning) + "; e.g. '1/(2 s^2 + 0.1 s + 3)'";
constexpr const char* drive_help = "That of body 2, on which the force acts";

// Of an option that says more, the masses beside it are those that mean nothing.
void exclude_masses(Options& options) {
  const char* const why = "which has the mass in it";
  options["--mass1"].not_with({"--load-receptance"}, why);
  options["--mass2"].not_with({"--drive-receptance"}, why);
}

}  // namespace

void add_receptances(Options& options, std::string& load, std::string& drive) {
  options.text("--load-receptance", load, load_help, "FORMULA");
  options.text("--drive-receptance", drive, drive_help, "FORMULA");
  exclude_masses(options);
}

void add_receptances(Options& options, std::optional<frac::FractionalTransferFunction>& load,
                     std::optional<frac::FractionalTransferFunction>& drive) {
  options.parsed("--load-receptance", load, formula_of, load_help, "FORMULA");
  options.parsed("--drive-receptance", drive, formula_of, drive_help, "FORMULA");
  exclude_masses(options);
}

void add_open_receptances(Options& options, std::string& load, std::string& drive) {
  options.text("--load-receptance", load,
               std::string(load_meaning) + "; names are estimated; e.g. '1/(m s^2 + b s)' with friction", "FORMULA");
  options.text("--drive-receptance", drive, drive_help, "FORMULA");
}

void LoopOptions::add(Options& options) {
  options
      .text(
          "--controller", controller_,
          "C of the force -C(s) x on body 2; e.g. 'exp(-0.1 s) (2 + 1.5 s^0.9)'; or 'cascade(K1, K2, T)', the position "
          "controller K1 around the speed controller K2 (1 + 1/(T s))",
          "FORMULA")
      .required();
  options.number("--mass1", mass1_).default_is("1");
  options.number("--mass2", mass2_).default_is("1");
  add_receptances(options, load_, drive_);
  options.number("--clearance", clearance_);
  options.number("--restitution", restitution_).default_is("none: needed unless --over varies it");
}

void LoopOptions::add_body(Options& options) {
  options.choice("--body", body_, backlash::outputs(),
                 "that the controller gets: x1, the load, or x2, the driven body");
}

void LoopOptions::check(const std::string& varied) const {
  if (std::isnan(restitution_) && varied != "restitution") throw std::invalid_argument("--restitution is missing");
  if (!std::isnan(restitution_) && varied == "restitution") {
    throw std::invalid_argument("--restitution has no meaning with --over restitution=...");
  }
}

LoopOptions::Parts LoopOptions::parts(const std::string& name, double value) const {
  double mass1 = std::isnan(mass1_) ? 1 : mass1_, mass2 = std::isnan(mass2_) ? 1 : mass2_;
  double clearance = clearance_, restitution = restitution_;
  bool is_known = name.empty();
  const auto set = [&](const char* known, double& target, bool is_used) {
    if (name != known || !is_used) return;
    target = value;
    is_known = true;
  };
  set("mass1", mass1, load_.empty());
  set("mass2", mass2, drive_.empty());
  set("clearance", clearance, true);
  set("restitution", restitution, true);
  const auto formula_of = [&](const char* option, const std::string& text) {
    const Formula formula(option, text);
    is_known = is_known || formula.has(name);
    return formula.with(name, value);
  };
  const auto cascade = Cascade::of("--controller", controller_);
  const frac::FractionalTransferFunction controller =
      formula_of("--controller", cascade ? cascade->formula() : controller_);
  const frac::FractionalTransferFunction load =
      load_.empty() ? backlash::free_mass(mass1) : formula_of("--load-receptance", load_);
  const frac::FractionalTransferFunction drive =
      drive_.empty() ? backlash::free_mass(mass2) : formula_of("--drive-receptance", drive_);
  if (!is_known) {
    throw std::invalid_argument("--over " + name +
                                ": no formula has that name, and it is none of mass1, mass2 (of free masses), "
                                "clearance and restitution");
  }
  return {clearance, restitution, mass1, mass2, controller, load, drive};
}

double LoopOptions::set_point_lag() const {
  const auto cascade = Cascade::of("--controller", controller_);
  if (!cascade) return 0;
  const frac::FractionalTransferFunction gain = Formula("--controller", cascade->position_gain).with({}, NAN);
  const double value = gain.response(1).real();
  if (!(value > 0))
    throw std::invalid_argument("--controller " + io::quoted(controller_) + ": K1 is " + cascade->position_gain +
                                "; allowed is above 0");
  return 1 / value;
}

backlash::ControlLoop LoopOptions::loop(const std::string& name, double value) const {
  const Parts of = parts(name, value);
  if (load_.empty() && drive_.empty())
    return {backlash::TwoMassSystem(of.mass1, of.mass2, of.clearance, of.restitution), of.controller, body_};
  return {backlash::LinearBodies(of.load, of.drive, of.clearance, of.restitution), of.controller, body_};
}

backlash::CompliantLoop LoopOptions::loop(const CompliantOptions& contact, const std::string& name,
                                          double value) const {
  if (name == "restitution")
    throw std::invalid_argument(
        "--over restitution has no meaning with contacts that take time; give contact-restitution");
  const std::optional<CompliantOptions> varied = contact.with(name, value);
  const Parts of = parts(varied ? std::string() : name, value);
  return {(varied ? *varied : contact).bodies(of.load, of.drive, of.clearance).front(), of.controller, body_};
}

}  // namespace fracfit
