// SPDX-License-Identifier: BSD-3-Clause
#include <cmath>
#include <stdexcept>

#include "backlash/fmu.hpp"
#include "commands/subcommand.hpp"
#include "frac/fmu.hpp"
#include "io/fmu_archive.hpp"
#include "io/version.hpp"
#include "options/controller_request.hpp"
#include "options/scene_options.hpp"

namespace fracfit {
namespace {

class ExportFmu : public Command {
 public:
  ExportFmu()
      : Command(
            "export fmu",
            "Functional mock-up unit (FMI 2.0 or 3.0) of a controller, a filter, a fractional plant or two masses") {
    Options& o = options();
    request_.declare(o, ControllerRequest::SampleTime::optional);
    o.choice("--precision", options_.precision, frac::precisions(), "of a controller or filter");
    const std::vector<std::string> of_models = names_so_far();
    o.number("--clearance", clearance_, "makes a unit of two masses");
    o.number("--mass1", mass1_).only_with({"--clearance"});
    o.number("--mass2", mass2_).only_with({"--clearance"});
    o.one_number("--restitution", restitution_).only_with({"--clearance"}).needed_with({"--clearance"});
    for (const std::string& name : of_models) o[name].not_with({"--clearance"}, "which makes a unit of two masses");
    o.text("--name", options_.name, "the unit and its library");
    o.choice("--fmi", options_.version, frac::fmi_versions(), "version of the interface");
    o.flag("--windows", windows_, "with a library for 64-bit Windows too, by x86_64-w64-mingw32-gcc");
    add_common({"fmu"});
    o["--out"].required();
    set_footer(
        "A --model with a --sample-time is a filter; without, on a --band, a continuous plant for co-simulation and "
        "model\n"
        "exchange. The unit holds C sources and, made by the compiler cc, a library for 64-bit Linux.\n"
        "Examples:\n"
        "  fracfit export fmu --kp 2 --ki 3 --lambda 0.8 --sample-time 1e-3 --band 0.1:300 --name pi --out pi.fmu\n"
        "  fracfit export fmu --model '1/(0.8 s^2.2 + 0.5 s^0.9 + 1)' --band 0.01:100 --name plant --out plant.fmu\n"
        "  fracfit export fmu --clearance 0.001 --restitution 0.6 --mass1 2 --mass2 1 --name gear --out gear.fmu");
  }

 private:
  [[nodiscard]] std::vector<std::string> names_so_far() {
    std::vector<std::string> names;
    for (const Option& option : options().all()) names.push_back(option.name());
    return names;
  }

  [[nodiscard]] bool has_masses() const { return clearance_.has_value(); }
  [[nodiscard]] bool is_plant() const { return request_.model().has_value() && !options()["--sample-time"].is_given(); }

  void check() override {
    frac::check_c_name(options_.name);
    if (has_masses()) return;
    if (!is_plant()) {
      request_.check(options());
      if (!options()["--sample-time"].is_given()) throw std::invalid_argument("--sample-time is required for a PID");
      return;
    }
    for (const char* name : {"--poles", "--discretisation", "--sample-count", "--precision"})
      if (options()[name].is_given())
        throw std::invalid_argument(std::string(name) + " has no meaning for a --model without a --sample-time");
    if (!request_.band())
      throw std::invalid_argument("--band is required for a --model without a --sample-time: LOW:HIGH in rad/s");
  }

  [[nodiscard]] frac::Fmu unit() {
    options_.tool = "fracfit " + std::string(io::version());
    if (has_masses()) {
      describe("Two masses with a clearance and impacts.");
      return backlash::fmu({mass1_, mass2_, *clearance_, restitution_}, {}, options_);
    }
    if (is_plant()) {
      const double tolerance = request_.tolerance().value_or(1e-3);
      if (!request_.tolerance()) options()["--tolerance"].say("1e-3");
      const frac::RationalModel plant = frac::realise(*request_.model(), *request_.band(), tolerance);
      if (!plant.usable()) missed_ = plant.message;
      describe(plant.summary());
      return frac::fmu(plant, options_);
    }
    const ControllerRequest::Design design = request_.design(options());
    note_ = note_of(design);
    if (const auto* pid = std::get_if<frac::FractionalPidDesign>(&design)) {
      describe("Fractional PID." + (note_.empty() ? "" : " " + note_));
      return frac::fmu(*pid, options_);
    }
    describe("Filter " + request_.model()->formula() + "." + (note_.empty() ? "" : " " + note_));
    return frac::fmu(std::get<frac::FilterChoice>(design).design, options_);
  }

  void describe(const std::string& text) { options_.description = text + " Made by: " + command_line(); }

  int run() override {
    const frac::Fmu made = unit();
    std::vector<std::pair<std::string, std::string>> sources;
    for (const frac::NamedText& file : made.files) sources.emplace_back(file.path, file.text);
    const io::FmuArchive archive = io::fmu_archive(
        sources, made.main_source, {made.linux_library, windows_ ? made.windows_library : std::string()});
    write(archive.bytes);
    if (!archive.no_library.empty()) complain("the unit holds its sources only: " + archive.no_library);
    if (!note_.empty()) say(note_);
    if (missed_.empty()) return usable_result;
    say(missed_);
    return no_usable_result;
  }

  ControllerRequest request_;
  std::optional<double> clearance_;
  double mass1_ = 1, mass2_ = 1, restitution_ = NAN;
  bool windows_ = false;
  frac::FmuOptions options_;
  std::string note_, missed_;
};

}  // namespace

std::unique_ptr<Command> make_export_fmu() {
  return std::make_unique<ExportFmu>();
}

}  // namespace fracfit
