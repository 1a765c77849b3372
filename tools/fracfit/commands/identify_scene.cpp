// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <stdexcept>

#include "backlash/identification/bodies_identification.hpp"
#include "commands/subcommand.hpp"
#include "io/data_error.hpp"
#include "io/frequency_response_file.hpp"
#include "io/number.hpp"
#include "options/data_options.hpp"
#include "options/fit_request.hpp"
#include "options/loop_options.hpp"
#include "options/model_choice.hpp"
#include "output/identify_scene_output.hpp"
#include "output/scene_export.hpp"

namespace fracfit {
namespace {

// m1 and m2 stand for mass1 and mass2.  Without a limit a parameter keeps the range that the data suggest for it.
std::vector<frac::ParameterConstraint> constraints_of(const ParameterOptions& given) {
  auto constraints = constraints_of(frac::NamedModel{}, given);
  for (auto& constraint : constraints) {
    if (constraint.name == "m1" || constraint.name == "m2") constraint.name.replace(0, 1, "mass");
    for (auto* limit : {&constraint.lower, &constraint.upper})
      if (*limit && std::isinf(**limit)) limit->reset();
  }
  return constraints;
}

// One curve of the data: a file, or the rows of a scene in it.
struct CurveSource {
  std::string file;
  io::Metadata rows;
};

class IdentifyScene : public Command {
 public:
  IdentifyScene()
      : Command("identify-scene",
                "Estimates clearance, restitution and masses from describing functions of two masses") {
    Options& o = options();
    o.texts("DATA", data_,
            "Frequency responses in m/N, one per force amplitude: CSV or TSV as for `fit`, or tables of several "
            "forces as simulate writes them",
            "FILE")
        .required()
        .names_input();
    add_file_options(o, reading_.how);
    add_select(o, reading_.how);
    o.numbers("--force", force_, "one per file or one for all").default_is("the files' lines '# force_n: VALUE'");
    o.choice("--body", body_, backlash::outputs()).default_is("as the files say, else x1");
    o.choice("--component", scene_.component,
             std::array{frac::Component::both, frac::Component::real, frac::Component::imaginary});
    o.choice("--weight", scene_.weight, std::array{frac::Weight::relative, frac::Weight::given, frac::Weight::absolute},
             "relative |data|; given the files' sigma or weight column, without it that of tables of fracfit response; "
             "absolute nothing");
    o.choice("--contact", scene_.contact, backlash::contact_models(),
             "auto and compliant estimate the contact time; auto holds for hard contacts too")
        .not_with({"--load-receptance"}, "which knows hard contacts only")
        .not_with({"--drive-receptance"}, "which knows hard contacts only");
    o.choice("--friction", scene_.friction, backlash::friction_models(),
             "auto estimates it where the data tell it from none, estimate always")
        .not_with({"--load-receptance"}, "which knows viscous friction only")
        .not_with({"--drive-receptance"}, "which knows viscous friction only");
    o.numbers("--harmonic-orders", orders_,
              "Harmonics to use beside the fundamental, of tables of fracfit response with one output: 3, 5 or both",
              "LIST")
        .default_is("none")
        .not_with({"--columns"}, "as the harmonics stand in columns of their own")
        .not_with({"--load-receptance"}, "whose motion is followed in its fundamental")
        .not_with({"--drive-receptance"}, "whose motion is followed in its fundamental");
    add_open_receptances(o, load_, drive_);
    o.texts("--fix", given_.fix,
            "of mass1, mass2, clearance, restitution, contact_time, friction1 and friction2, or of names in the "
            "receptances; x1 needs a mass or the clearance");
    o.texts("--bound", given_.bound);
    o.texts("--where", where_, "of re, im, magnitude, omega or f, or of any column of the files");
    o.flag("--compare", compare_,
           "Also rank static backlash, fractional and integer-order structures on the same points")
        .not_with({"--load-receptance"}, "the ranking is against free masses")
        .not_with({"--drive-receptance"}, "the ranking is against free masses");
    o.choice("--print", print_, all_scene_words)
        .not_with({"--load-receptance"}, "which prints two masses")
        .not_with({"--drive-receptance"}, "which prints two masses")
        .not_with({"--compare"}, "whose ranking it leaves out")
        .not_with({"--format"}, "whose text it replaces");
    add_common({"json", "table"});
    set_footer(
        "Examples:\n"
        "  fracfit identify-scene f10.csv f30.csv f50.csv --fix mass1=1\n"
        "  fracfit identify-scene a.csv b.csv --force 10,50 --body x2 --component imaginary --fix mass1=1\n"
        "  fracfit identify-scene f*.csv --fix mass1=1 --fix mass2=1 --compare --format table\n"
        "  fracfit identify-scene f10.csv f30.csv --fix mass1=1 --contact compliant --print modelica\n"
        "  fracfit identify-scene f20.csv f40.csv --load-receptance '1/(m1 s^2 + b1 s)' --drive-receptance "
        "'1/(1.5 s^2 + b2 s)'");
  }

 private:
  [[nodiscard]] bool has_receptances() const { return !load_.empty() || !drive_.empty(); }

  [[nodiscard]] backlash::BodiesStructure receptances() const {
    const auto formula = [](const std::string& text, const char* free_mass) {
      return frac::Structure(text.empty() ? free_mass : text);
    };
    return {formula(load_, "1/(mass1 s^2)"), formula(drive_, "1/(mass2 s^2)")};
  }

  void check() override {
    scene_.constraints = has_receptances() ? constraints_of(frac::NamedModel{}, given_) : constraints_of(given_);
    // A formula that does not parse is told before files are read.
    if (has_receptances()) static_cast<void>(receptances());
    // The scene is one of N; a file of -1/N tells it.
    reading_.quantity = backlash::Quantity::n;
    for (const auto& text : where_) reading_.where.emplace_back(text);
    for (const double order : orders_)
      if ((order != 3 && order != 5) || std::count(orders_.begin(), orders_.end(), order) > 1)
        throw std::invalid_argument("--harmonic-orders " + options()["--harmonic-orders"].text() +
                                    ": allowed are 3 and 5, each once");
    if (force_.size() > 1 && force_.size() != data_.size())
      throw std::invalid_argument("--force names " + std::to_string(force_.size()) + " amplitudes for " +
                                  std::to_string(data_.size()) + " files; expected one for all or one per file");
  }

  [[nodiscard]] std::vector<CurveSource> sources() const {
    std::vector<CurveSource> all;
    for (const auto& file : data_) {
      const auto scenes = io::scenes_in(io::read_measurement(file, reading_.how), reading_.where);
      if (scenes.empty()) all.push_back({file, {}});
      for (const auto& scene : scenes) {
        for (const auto& [column, value] : scene)
          if (column != "force_n")
            throw std::invalid_argument(file + " holds curves of different pairs of masses, told apart by column " +
                                        column + "; take one pair by --where '" + column + "==" + value + "'");
        all.push_back({file, scene});
      }
      if (!scenes.empty() && !force_.empty())
        throw std::invalid_argument("--force has no meaning with " + file + ", whose column force_n tells the forces");
    }
    return all;
  }

  [[nodiscard]] double force_of(std::size_t i, const std::string& name, const io::FrequencyResponseFile& file) const {
    if (!force_.empty()) return force_.size() == 1 ? force_.front() : force_[i];
    const auto header = io::find_value(file.metadata, "force_n");
    if (!header)
      throw std::invalid_argument(name + " has no line '# force_n: VALUE'; give the force amplitudes by --force");
    const auto value = io::parse_number(*header);
    if (!value || !(*value > 0) || *value == std::numeric_limits<double>::infinity())
      throw io::DataError(name, 0, 0, "has force_n " + io::quoted(*header) + "; expected a positive number of newtons");
    return *value;
  }

  // x1 or x2, as the file names what was measured; empty where it has another name for it.
  static std::string body_of(const io::FrequencyResponseFile& file) {
    const std::string name{io::find_value(file.metadata, "output").value_or(std::string_view{})};
    for (const auto output : backlash::outputs()) {
      const std::string body(backlash::to_string(output));
      // `response` gives the column of the record, such as x1_m.
      if (name == body || name == body + "_m") return body;
    }
    return {};
  }

  // Reads the files; completes the curves, their force amplitudes and the body measured.
  std::vector<backlash::MeasuredDescribingFunction> read(SceneRun& run) {
    std::vector<backlash::MeasuredDescribingFunction> curves;
    bool all_measured = true;
    std::size_t source = 0;
    std::string body = body_ ? std::string(backlash::to_string(*body_)) : "";
    for (const CurveSource& of : sources()) {
      const std::string& name = of.file;
      reading_.rows = of.rows;
      auto file = io::read_frequency_response(name, reading_);
      for (const auto& note : file.notes) say(name + ": " + note);
      if (scene_.weight == frac::Weight::given && file.data.sigma().empty())
        throw io::DataError(name, 0, 0, "has no column sigma or weight; expected one with --weight given");
      all_measured = all_measured && io::has_measured_sigma(file);
      // Masses come out in kg only of metres per newton.
      const auto& unit = file.value_unit;
      if (unit.empty()) say(name + ": the names of its columns give no unit; the values are taken as m/N");
      if (!unit.empty() && unit != "m/N" && unit != "m_per_n" && unit != "m_per_N")
        throw io::DataError(name, 0, 0,
                            "has values in " + io::quoted(unit) + "; expected a motion over a force in m/N");
      const std::string measured = body_of(file);
      if (!measured.empty() && body.empty()) body = measured;
      if (!measured.empty() && measured != body)
        throw std::invalid_argument(name + " is of " + measured + ", not of " + body +
                                    "; all files must be of the same mass");
      const double force = force_of(source++, name, file);
      const auto add = [&](frac::FrequencyResponseData data, int harmonic) {
        run.files.push_back(name);
        run.forces.push_back(force);
        run.harmonics.push_back(harmonic);
        curves.push_back({std::move(data), force, harmonic});
      };
      add(std::move(file.data), 1);
      for (const double order : orders_) add(harmonic_of(name, static_cast<int>(order)), static_cast<int>(order));
    }
    if (all_measured && !options()["--weight"].is_given()) {
      scene_.weight = frac::Weight::given;
      options()["--weight"].say(std::string(to_string(scene_.weight)));
      say(weighed_by_measured_sigma);
    }
    scene_.sigma_is_measured = all_measured && scene_.weight == frac::Weight::given;
    scene_.output = backlash::output_from_string(body.empty() ? "x1" : body);
    return curves;
  }

  /// A harmonic from the columns that `response` writes.
  [[nodiscard]] frac::FrequencyResponseData harmonic_of(const std::string& name, int order) const {
    auto reading = reading_;
    const std::string column = "harmonic" + std::to_string(order);
    reading.how.columns = "omega=omega_rad_s,re=" + column + "_re,im=" + column + "_im,sigma=" + column + "_sigma";
    return io::read_frequency_response(name, reading).data;
  }

  int run() override {
    scene_.threads = threads();
    SceneRun run{};
    const auto curves = read(run);
    if (has_receptances()) {
      const auto result = backlash::identify_bodies(curves, receptances(), scene_);
      complete(run);
      write(format() == "json" ? bodies_json(run, result) : bodies_table(run, result));
      return outcome(result);
    }
    const auto result = backlash::identify_scene(curves, scene_);
    std::optional<backlash::SceneComparison> comparison;
    if (compare_ && result.termination != frac::FitTermination::no_usable_start)
      comparison = backlash::compare_explanations(curves, scene_, result);

    complete(run);
    if (print_) {
      const int code = outcome(result);
      if (code == usable_result) write(printed(result, run.command));
      return code;
    }
    write(format() == "json" ? scene_json(run, result, comparison) : scene_table(run, result, comparison));
    return outcome(result);
  }

  [[nodiscard]] std::string printed(const backlash::SceneIdentification& scene, const std::string& command) const {
    const auto contact = scene.compliant_contact();
    if (!contact && *print_ != SceneWords::options)
      throw std::runtime_error("no model of " + std::string(to_string(*print_)) +
                               ": the contact of the estimate takes no time, and those of a simulator have a "
                               "stiffness; give one by --fix contact_time=T");
    backlash::CoulombFriction friction;
    for (const auto& each : scene.friction) (each.name == "friction1" ? friction.body1 : friction.body2) = each.value;
    return scene_in(*print_, scene.system(), contact, friction, command);
  }

  // Says what was read from the files.
  void complete(SceneRun& run) {
    std::string forces;
    for (const double force : run.forces) forces += (forces.empty() ? "" : ",") + io::format_number(force);
    const std::string body(backlash::to_string(scene_.output));
    // A table of several forces has them in its column.
    if (run.files.size() == data_.size() && orders_.empty()) options()["--force"].say(forces);
    options()["--body"].say(body);
    run.command = command_line();
    run.options = {{"output", body}};
    for (auto& entry : options().entries({"--component", "--weight"})) run.options.push_back(std::move(entry));
    if (has_receptances()) return;
    run.options.push_back({"contact", std::string(backlash::to_string(scene_.contact))});
    run.options.push_back({"friction", std::string(backlash::to_string(scene_.friction))});
  }

  template <typename Identification>
  [[nodiscard]] int outcome(const Identification& result) const {
    const auto is_fixed = [](const auto& parameter) { return parameter.fixed; };
    const auto is_determined = [](const auto& parameter) { return parameter.identified && !parameter.fixed; };
    const auto& parameters = result.parameters;
    const bool found = result.usable() && (std::any_of(parameters.begin(), parameters.end(), is_determined) ||
                                           std::all_of(parameters.begin(), parameters.end(), is_fixed));
    if (!found) say("no usable result: " + result.message);
    return found ? usable_result : no_usable_result;
  }

  std::vector<std::string> data_, where_;
  std::string load_, drive_;
  ParameterOptions given_;
  std::vector<double> force_, orders_;
  std::optional<backlash::Output> body_;
  backlash::SceneIdentificationOptions scene_;
  io::FrequencyResponseReadOptions reading_;
  bool compare_ = false;
  std::optional<SceneWords> print_;
};

}  // namespace

std::unique_ptr<Command> make_identify_scene() {
  return std::make_unique<IdentifyScene>();
}

}  // namespace fracfit
