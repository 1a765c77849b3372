// SPDX-License-Identifier: BSD-3-Clause
#include "frac/identification/validate.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "commands/subcommand.hpp"
#include "io/data_error.hpp"
#include "io/number.hpp"
#include "options/data_options.hpp"
#include "options/measured_curves.hpp"
#include "output/aligned_table.hpp"
#include "output/document.hpp"
#include "report/measured.hpp"
#include "report/picture.hpp"

namespace fracfit {
namespace {

struct Judged {
  std::string file, curve;
  frac::FrequencyResponseData data;
  frac::ValidationResult result;
  std::string sentence;
};

// A file among others that cannot be read.
struct Unreadable {
  std::string file, problem;
};

using Outcome = std::variant<Judged, Unreadable>;

std::string frequencies(const Judged& judged, const std::vector<std::size_t>& points) {
  std::string text;
  for (const std::size_t i : points) text += (text.empty() ? "" : " ") + io::format_number(judged.data.omega()[i]);
  return text;
}

std::string short_frequencies(const Judged& judged, const std::vector<std::size_t>& points) {
  const frac::FrequencyUnit unit = judged.data.frequency_unit();
  const auto frequency = [&](std::size_t i) { return short_number(in_unit(judged.data.omega()[i], unit)); };
  const std::string unit_text = " " + std::string(to_string(unit));
  // More are no list that anybody reads.
  constexpr std::size_t most = 12;
  if (points.size() > most)
    return std::to_string(points.size()) + " points from " + frequency(points.front()) + " to " +
           frequency(points.back()) + unit_text;
  std::string text;
  for (const std::size_t i : points) text += (text.empty() ? "" : ", ") + frequency(i);
  return text + unit_text;
}

// Residuals over frequency with the band that holds 95 % of the noise.
report::Panel panel_of(const Judged& judged) {
  const auto& result = judged.result;
  const frac::FrequencyUnit unit = judged.data.frequency_unit();
  std::vector<double> axis, real, imaginary, lower, upper;
  for (std::size_t i = 0; i < result.model.size(); ++i) {
    const double size = std::abs(result.model[i]);
    if (!(size > 0)) continue;
    const auto rest = (judged.data.value()[i] - result.model[i]) / size;
    axis.push_back(in_unit(judged.data.omega()[i], unit));
    real.push_back(100 * rest.real());
    imaginary.push_back(100 * rest.imag());
    upper.push_back(196 * result.deviation[i] / size);
    lower.push_back(-upper.back());
  }
  std::string title = judged.file + (judged.curve.empty() ? "" : ", " + judged.curve);
  title += ": " + std::string(to_string(result.validity));
  report::Panel panel{report::enhanced_escape(title),
                      {unit == frac::FrequencyUnit::hertz ? "f (Hz)" : "{/Symbol w} (rad/s)", true},
                      {"data - model (% of model)"}};
  panel.key = true;
  panel.curves.push_back(report::make_band("95 % of noise", "#bbbbbb", axis, lower, upper));
  panel.curves.push_back(
      report::make_curve("real part", report::category_colour(0), report::Mark::line_points, axis, real));
  panel.curves.push_back(
      report::make_curve("imaginary part", report::category_colour(1), report::Mark::line_points, axis, imaginary));
  return panel;
}

class Validate : public Command {
 public:
  Validate()
      : Command("validate",
                "Checks whether measured frequency responses can be those of a linear, stable, steady system") {
    Options& o = options();
    o.texts("FILE", files_, "Frequency responses as tables or as instruments write them; - for standard input", "FILE")
        .required()
        .names_input();
    add_file_options(o, how_);
    add_select(o, how_);
    add_immittance(o, immittance_);
    o.number("--level", level_, "Chance that data without a fault are not called valid, between 0 and 1", "P");
    o.number(
        "--accuracy", accuracy_,
        "Systematic error that the instrument may have, as share of the response; departures within it are no fault",
        "SHARE");
    o.number("--tolerance", tolerance_,
             "of the points as a whole: what departs by less is named and does not make the data invalid");
    o.flag("--all-points", all_points_,
           "Judge every point of a long sweep, which can take a minute, and not one in so many of more than 300");
    o.text("--picture", picture_, "A picture beside the result, SVG or PNG by its ending; here the residuals", "FILE");
    add_common({"csv", "json", "table"});
    set_footer(
        "Real and imaginary part of a linear, causal, stable, steady response belong together (Kramers, Kronig).  The\n"
        "best sum of poles, their number told by evidence, is such a response; what it leaves must be noise.\n"
        "Verdicts: valid; suspect (outliers or mains, the other points are consistent); invalid (drift, step, or "
        "residuals\n"
        "that follow each other, by more than --tolerance); undecided (band, points or noise leave too little to judge "
        "by;\n"
        "exit code 1 if all are).  consistent_to is how far the points may depart from a consistent response, noise "
        "included,\n"
        "departs whether they do by more than noise explains.\n"
        "A response that depends on amplitude but stays the same during the sweep can pass.\n"
        "Examples:\n"
        "  fracfit validate cell.DTA --format table\n"
        "  fracfit validate sweep1.mpt sweep2.mpt --out validity.csv\n"
        "  fracfit validate film.csv --tolerance 0.03\n"
        "  fracfit validate cell.DTA --component admittance    # of a cell whose voltage was held\n"
        "  fracfit validate cell.csv --picture residuals.svg");
  }

 private:
  void check() override {
    if (!(level_ >= 1e-15 && level_ < 1))
      throw std::invalid_argument("--level " + io::format_number(level_) + ": allowed is 1e-15 up to 1");
    if (!(accuracy_ >= 0 && accuracy_ < 1))
      throw std::invalid_argument("--accuracy " + io::format_number(accuracy_) + ": allowed is 0 up to 1");
    if (!(tolerance_ >= 0 && tolerance_ < 1))
      throw std::invalid_argument("--tolerance " + io::format_number(tolerance_) + ": allowed is 0 up to 1");
    if (picture_.empty()) return;
    try {
      drawing_.emplace(picture_, files_);
    } catch (const std::invalid_argument& error) {
      throw std::invalid_argument(std::string("--picture: ") + error.what());
    }
  }

  int run() override {
    const std::vector<Outcome> all = outcomes();
    write(format() == "table" ? sentences(all) : text_of(document_of(all), format(), command_line()));
    std::vector<const Judged*> judged;
    for (const auto& each : all)
      if (const auto* one = std::get_if<Judged>(&each)) judged.push_back(one);
    if (drawing_) draw(judged);
    const bool usable =
        std::any_of(judged.begin(), judged.end(), [](const auto* each) { return each->result.usable(); });
    if (!usable) say("nothing can be judged");
    return usable ? usable_result : no_usable_result;
  }

  // A file that cannot be read does not keep the others from being judged; where none can be read, that is the error.
  [[nodiscard]] std::vector<Outcome> outcomes() const {
    std::vector<Outcome> all;
    std::vector<io::DataError> problems;
    for (const auto& file : files_) {
      try {
        auto curves = read_curves(file, how_, {}, immittance_);
        for (const auto& note : notes_of(curves)) say(file + ": " + note);
        for (auto& curve : curves) {
          auto result = frac::validate(curve.file.data, {level_, accuracy_, tolerance_, all_points_ ? 0 : most_points});
          std::string sentence = report::validity_sentence(result, curve.file);
          all.emplace_back(
              Judged{file, curve.name, std::move(curve.file.data), std::move(result), std::move(sentence)});
        }
      } catch (const io::DataError& problem) {
        problems.push_back(problem);
        all.emplace_back(Unreadable{file, problem.what()});
      }
    }
    const bool any_read = problems.size() < files_.size();
    for (std::size_t i = any_read ? 0 : 1; i < problems.size(); ++i) say(problems[i].what());
    if (!any_read) throw io::DataError(problems.front());
    return all;
  }

  [[nodiscard]] Document document_of(const std::vector<Outcome>& all) const {
    Document document;
    document.head.emplace_back("level", io::format_number(level_));
    document.head.emplace_back("accuracy", io::format_number(accuracy_));
    document.head.emplace_back("tolerance", io::format_number(tolerance_));
    if (immittance_) document.head.emplace_back("component", to_string(*immittance_));
    auto& columns = document.rows.columns;
    columns = {"file",
               "curve",
               "validity",
               "points",
               "decades",
               "noise",
               "noise_floor",
               "noise_slope",
               "correlation",
               "drift",
               "drift_law",
               "drift_deviation",
               "detectable_drift",
               "outliers_rad_s",
               "mains_rad_s",
               "real_poles",
               "pole_pairs",
               "step",
               "step_deviation",
               "step_below_rad_s",
               "step_above_rad_s",
               "largest_residual",
               "dead_time_s",
               "reversed_sign",
               "departs",
               "consistent_to"};
    const auto first =
        std::find_if(all.begin(), all.end(), [](const Outcome& each) { return std::holds_alternative<Judged>(each); });
    for (const auto& finding : std::get<Judged>(*first).result.findings) {
      std::string name(to_string(finding.test));
      std::replace(name.begin(), name.end(), '-', '_');
      columns.push_back("p_" + name);
    }
    columns.emplace_back("summary");
    document.rows.count = all.size();
    document.rows.fill = [&all, names = columns](std::size_t row, std::vector<Cell>& cells) {
      if (const auto* judged = std::get_if<Judged>(&all[row]))
        fill(*judged, cells);
      else
        fill(std::get<Unreadable>(all[row]), names, cells);
    };
    return document;
  }

  static void fill(const Unreadable& unread, const std::vector<std::string>& columns, std::vector<Cell>& cells) {
    constexpr std::array<std::string_view, 3> texts{"drift_law", "outliers_rad_s", "mains_rad_s"};
    cells.insert(cells.end(), {unread.file, std::string(), std::string("unreadable"), std::int64_t{0}});
    while (cells.size() + 1 < columns.size()) {
      const bool is_text = std::find(texts.begin(), texts.end(), columns[cells.size()]) != texts.end();
      cells.push_back(is_text ? Cell(std::string()) : Cell(std::numeric_limits<double>::quiet_NaN()));
    }
    cells.emplace_back(unread.problem);
  }

  static void fill(const Judged& judged, std::vector<Cell>& cells) {
    const auto& result = judged.result;
    const auto& omega = judged.data.omega();
    cells.insert(cells.end(), {judged.file,
                               judged.curve,
                               std::string(to_string(result.validity)),
                               static_cast<std::int64_t>(omega.size()),
                               std::log10(omega.back() / omega.front()),
                               result.noise,
                               result.noise_floor,
                               result.noise_slope,
                               result.correlation,
                               result.drift,
                               std::string(to_string(result.drift_law)),
                               result.drift_deviation,
                               result.detectable_drift,
                               frequencies(judged, result.outliers),
                               frequencies(judged, result.mains),
                               static_cast<std::int64_t>(result.real_poles),
                               static_cast<std::int64_t>(result.pole_pairs),
                               result.step,
                               result.step_deviation,
                               result.step_below,
                               result.step_above,
                               result.largest_residual,
                               result.dead_time,
                               static_cast<std::int64_t>(result.reversed_sign),
                               static_cast<std::int64_t>(result.departs),
                               result.consistent_to});
    for (const auto& finding : result.findings) cells.emplace_back(finding.p_value);
    cells.emplace_back(judged.sentence);
  }

  // For people: the verdicts, and what they rest on.
  [[nodiscard]] static std::string sentences(const std::vector<Outcome>& all) {
    std::string text;
    for (const auto& outcome : all) {
      if (const auto* unread = std::get_if<Unreadable>(&outcome)) {
        text += unread->file + ": unreadable, see the message\n";
        continue;
      }
      const auto& each = std::get<Judged>(outcome);
      text += each.file + (each.curve.empty() ? "" : ", " + each.curve) + ": " + each.sentence + "\n";
      for (const auto& [points, name] : {std::pair{&each.result.outliers, "outliers"}, {&each.result.mains, "mains"}})
        if (!points->empty()) text += std::string("  ") + name + " at " + short_frequencies(each, *points) + "\n";
    }
    return text;
  }

  void draw(const std::vector<const Judged*>& all) const {
    report::Figure figure;
    constexpr std::size_t most_panels = 12;
    for (std::size_t i = 0; i < std::min(all.size(), most_panels); ++i)
      if (!all[i]->result.model.empty()) figure.panels.push_back(panel_of(*all[i]));
    if (all.size() > most_panels) say("the picture shows the first 12 curves of " + std::to_string(all.size()));
    if (figure.panels.empty()) {
      say("no picture: no curve has points enough");
      return;
    }
    drawing_->write(std::move(figure));
  }

  std::vector<std::string> files_;
  io::MeasurementOptions how_;
  std::optional<io::Immittance> immittance_;
  double level_ = 0.05;
  double accuracy_ = frac::ValidationOptions{}.accuracy;
  double tolerance_ = frac::ValidationOptions{}.tolerance;
  // Judged in about two seconds at most.
  static constexpr std::size_t most_points = 300;
  bool all_points_ = false;
  std::string picture_;
  std::optional<report::PictureFile> drawing_;
};

}  // namespace

std::unique_ptr<Command> make_validate() {
  return std::make_unique<Validate>();
}

}  // namespace fracfit
