// SPDX-License-Identifier: BSD-3-Clause
#include <cmath>
#include <numbers>
#include <optional>
#include <stdexcept>

#include "commands/pictures.hpp"
#include "commands/subcommand.hpp"
#include "frac/model/algebra.hpp"
#include "frac/stability.hpp"
#include "options/model_options.hpp"
#include "output/aligned_table.hpp"
#include "output/json.hpp"
#include "report/model_figures.hpp"

namespace fracfit {
namespace {

struct Analysis {
  frac::FractionalTransferFunction model;
  frac::StabilityAnalysis stability;
  frac::PeakGain peak;
  double h2;
  bool is_closed;                                        // the model is a closed loop
  frac::Margins margins;                                 // of the loop that was closed, or of the model as one
  std::optional<frac::ClosedLoopStability> closed_loop;  // empty where the loop does not fall below 1
};

Analysis analysis_of(const frac::FractionalTransferFunction& model, const frac::FractionalTransferFunction& loop,
                     bool is_closed) {
  Analysis result{model,
                  frac::analyse_stability(model),
                  frac::h_infinity_norm(model),
                  frac::h2_norm(model),
                  is_closed,
                  frac::margins(loop),
                  std::nullopt};
  try {
    result.closed_loop = frac::analyse_closed_loop(loop);
  } catch (const std::invalid_argument&) {
    result.closed_loop.reset();
  }
  return result;
}

Json complex_number(std::complex<double> value) {
  return {{"re", value.real()}, {"im", value.imag()}};
}

bool is_unstable_when_closed(const Analysis& result) {
  return result.closed_loop && result.closed_loop->stability == frac::Stability::unstable;
}

// Of a stable loop the distance from the loss of stability; of an unstable one, which has no reserve, with the sign at
// its crossover.
double phase_margin(const Analysis& result) {
  const double smallest = result.margins.phase_margin;
  if (!is_unstable_when_closed(result)) return smallest;
  for (const auto& crossover : result.margins.phase)
    if (std::abs(crossover.margin) == smallest) return crossover.margin;
  return smallest;
}

// G tends to gain s^order towards the origin.  A pole there is no point of the surface of ln s and stands in no list.
struct Origin {
  double gain, order;
};
Origin origin_of(const frac::FractionalTransferFunction& model) {
  const auto &top = model.numerator().back(), &bottom = model.denominator().back();
  return {top.coefficient / bottom.coefficient, top.order - bottom.order};
}

Json crossovers(const std::vector<frac::Crossover>& list, const char* margin) {
  return Json::list(list, [&](const auto& each) { return Json{{"omega", each.omega}, {margin, each.margin}}; });
}

std::string json_text(const Analysis& result, const std::string& command) {
  Json json = origin(command);
  json["model"] = result.model.formula();
  json["stability"] = frac::to_string(result.stability.stability);
  if (!result.stability.remark.empty()) json["stability_remark"] = result.stability.remark;
  Json& poles = json["poles"] = Json::array();
  for (const auto& pole : result.stability.poles) {
    Json entry = complex_number(pole.value);
    entry["multiplicity"] = pole.multiplicity;
    entry["cancelled"] = pole.cancelled;
    poles.push_back(entry);
  }
  const Origin at_origin = origin_of(result.model);
  json["towards_origin"] = {{"gain", at_origin.gain}, {"order", at_origin.order}};
  json["commensurate_order"] = result.stability.commensurate_order;
  Json& sheet_roots = json["sheet_roots"] = Json::array();
  for (const auto& root : result.stability.sheet_roots) {
    Json entry = complex_number(root.lambda);
    entry["multiplicity"] = root.multiplicity;
    entry["on_principal_sheet"] = root.on_principal_sheet;
    entry["stable"] = root.stable;
    sheet_roots.push_back(entry);
  }
  json["h2_norm"] = result.h2;
  json["h_infinity_norm"] = {{"gain", result.peak.gain}, {"omega", result.peak.omega}};
  json["margins"] = {{"gain_margin", result.margins.gain_margin},
                     {"gain_reduction", result.margins.gain_reduction},
                     {"phase_margin_rad", phase_margin(result)},
                     {"delay_margin_s", result.margins.delay_margin},
                     {"gain_crossovers", crossovers(result.margins.phase, "phase_margin_rad")},
                     {"phase_crossovers", crossovers(result.margins.gain, "gain_margin")},
                     {"remark", result.margins.remark}};
  json["unity_feedback"] = nullptr;
  if (result.closed_loop) {
    json["unity_feedback"] = {{"stability", frac::to_string(result.closed_loop->stability)},
                              {"unstable_poles", result.closed_loop->unstable_poles}};
  }
  return json.dump() + "\n";
}

std::string complex_text(std::complex<double> value) {
  std::string text = short_number(value.real());
  if (value.imag() != 0) text += " +- " + short_number(value.imag()) + " i";
  return text;
}

std::string table_text(const Analysis& result) {
  std::string text = result.model.formula() +
                     "\nstability: " + std::string(frac::to_string(result.stability.stability)) + "\n" +
                     (result.stability.remark.empty() ? "" : result.stability.remark + "\n") + "\n";
  if (result.stability.poles.empty()) {
    text += "no poles on the principal sheet\n";
  } else {
    AlignedTable table({"pole [rad/s]", "natural frequency [rad/s]", "damping ratio", "multiplicity", ""});
    for (const auto& pole : result.stability.poles) {
      const double modulus = std::abs(pole.value);
      table.add({complex_text(pole.value), short_number(modulus), short_number(-pole.value.real() / modulus),
                 std::to_string(pole.multiplicity), pole.cancelled ? "cancelled" : ""});
    }
    text += table.text();
  }
  if (const Origin at_origin = origin_of(result.model); at_origin.order < 0) {
    text +=
        "towards the origin it grows as " + short_number(at_origin.gain) + " s^" + short_number(at_origin.order) + "\n";
  }
  if (result.stability.commensurate_order) {
    text += "commensurate order: " + short_number(*result.stability.commensurate_order) + ", " +
            std::to_string(result.stability.sheet_roots.size()) + " roots in the upper half of all sheets\n";
  } else {
    text += "orders not commensurate above 1/1000\n";
  }
  text += "\nH2 norm: " + short_number(result.h2) + "\nH-infinity norm: " + short_number(result.peak.gain);
  if (std::isfinite(result.peak.omega)) text += " at " + short_number(result.peak.omega) + " rad/s";
  text += result.is_closed ? "\n\nthe loop that was closed: " : "\n\nas a loop under unity feedback: ";
  text += result.closed_loop ? std::string(frac::to_string(result.closed_loop->stability))
                             : "not judged, |L| does not fall below 1 at high frequency";
  if (is_unstable_when_closed(result)) {
    text += "\nthe closed loop is unstable: the margins below are those of an unstable loop, no reserve of stability";
  }
  text += "\ngain margin: factor " + short_number(result.margins.gain_margin) + " up, " +
          short_number(result.margins.gain_reduction) +
          " down\nphase margin: " + short_number(phase_margin(result) * 180 / std::numbers::pi) +
          " deg\ndelay margin: " + short_number(result.margins.delay_margin) + " s\n";
  if (!result.margins.remark.empty()) text += result.margins.remark + "\n";
  return text;
}

class Analyse : public Command {
 public:
  Analyse() : Command("analyse", "Poles, stability, norms and margins of a fractional transfer function") {
    Options& o = options();
    add_model(o, model_).required();
    o.parsed(
        "--feedback", feedback_, formula_of,
        "Take the closed loop model/(1 + model FORMULA) in place of the model; margins are those of the loop model "
        "FORMULA; with dead time, give the loop as the model: its analysis says whether it is stable when closed",
        "FORMULA");
    o.text("--pictures", pictures_,
           "Draw into this folder (SVG, PNG, gnuplot); Bode, Nyquist and Nichols diagrams and the step response",
           "FOLDER")
        .unsaid();
    add_common({"json", "table"});
    set_footer(
        "Examples:\n"
        "  fracfit analyse \"1/(0.8 s^2.2 + 0.5 s^0.9 + 1)\" --format table\n"
        "  fracfit analyse --model \"exp(-0.5 s)*2/(s^0.8 (s + 1))\" --out loop.json\n"
        "  fracfit analyse --model \"(2 + 1/s^0.9)/(s^1.5 + s)\" --feedback 1");
  }

 private:
  int run() override {
    if (!pictures_.empty()) make_picture_folder(pictures_);
    const Analysis result =
        feedback_ ? analysis_of(frac::simplified(frac::feedback(*model_, *feedback_)), *model_ * *feedback_, true)
                  : analysis_of(*model_, *model_, false);
    std::vector<report::Figure> figures;
    if (!pictures_.empty()) figures = report::model_figures(result.model, "model");
    write(format() == "table" ? table_text(result) : json_text(result, command_line()));
    if (result.stability.stability == frac::Stability::undetermined)
      say("the stability is undetermined: the " + std::to_string(result.stability.poles.size()) +
          " poles found are not as many as the argument principle counts, as where poles lie too close together to be "
          "told apart");
    const bool drawn = pictures_.empty() || draw_pictures(*this, pictures_, figures);
    return drawn && result.stability.stability != frac::Stability::undetermined ? usable_result : no_usable_result;
  }

  std::optional<frac::FractionalTransferFunction> model_, feedback_;
  std::string pictures_;
};

}  // namespace

std::unique_ptr<Command> make_analyse() {
  return std::make_unique<Analyse>();
}

}  // namespace fracfit
