// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <stdexcept>
#include <string>
#include <tuple>
#include <vector>

#include "commands/subcommand.hpp"
#include "frac/identification/relaxation_times.hpp"
#include "io/data_error.hpp"
#include "io/frequency_response_file.hpp"
#include "io/unit_name.hpp"
#include "options/data_options.hpp"
#include "options/fit_record.hpp"
#include "output/aligned_table.hpp"
#include "output/document.hpp"
#include "report/picture.hpp"
#include "report/times_figure.hpp"

namespace fracfit {
namespace {

constexpr std::array kernels{frac::TimesKernel::falling, frac::TimesKernel::rising};

class Drt : public Command {
 public:
  Drt() : Command("drt", "Distribution of relaxation times, of a fit exactly or of measured data without a model") {
    Options& o = options();
    o.texts("--data", data_, "Frequency responses as tables or as instruments write them", "FILE")
        .or_argument()
        .names_input();
    add_file_options(o, read_.how);
    add_select(o, read_.how);
    o.texts("--where", where_, "of re, im, magnitude, omega or f, or of any column of the file").only_with({"--data"});
    o.text("--fit", fit_, "Result of fracfit fit as JSON: its model, parameters and their covariance", "FILE")
        .names_input();
    o.numbers("--tau", tau_, "Times at which a fit is shown, s; FROM:TO:COUNTlog", "TAU").only_with({"--fit"});
    o.choice("--kernel", kernel_, kernels, "falling: impedance, compliance, permittivity; rising: modulus, admittance",
             "KERNEL")
        .default_is("falling, or rising where only that follows the data or makes the density of a fit positive");
    o.text("--picture", picture_, "A picture beside the result, SVG or PNG by its ending; here the distributions",
           "FILE");
    add_common({"csv", "json", "table"});
    set_footer(
        "Z(s) = constant + inductance s + elastance/s + lines + integral of g/(1 + s tau) d ln tau; g per e-fold of "
        "tau.\n"
        "A fit gives g and the lines exactly, through the cut and the poles of its formula, with 95 % intervals by "
        "its\n"
        "covariance.  Data give the smoothest g >= 0 that follows them to within their noise, with the three ends and "
        "the\n"
        "range of 95 % of such g: it holds smooth densities, but may miss the maximum of an arc that is nearly a "
        "line.\n"
        "The area of a peak of data is that within the band, beyond which g only falls: what is faster than the band "
        "is\n"
        "part of the constant.  Kinds of rows: peak and line, whose value is an area, the three ends of data, and "
        "density,\n"
        "in the unit of the response.  Several files stand one after another, each by its name in the column source.\n"
        "The misfit is the rms of what the distribution leaves of the data, relative to their magnitude and in units\n"
        "of their noise, fit_misfit that of the formula of a fit beside data; data that no distribution follows (a\n"
        "resonance, a reversed sign) are named, with exit code 1.\n"
        "Examples:\n"
        "  fracfit drt cell.csv --out times.csv --picture times.svg\n"
        "  fracfit drt fresh.csv aged.csv --picture both.svg\n"
        "  fracfit drt --fit fit.json --tau 1e-6:100:161log\n"
        "  fracfit drt cell.csv --fit fit.json --tau 1e-6:100:161log --picture both.svg");
  }

 private:
  void check() override {
    if (data_.empty() && fit_.empty())
      throw std::invalid_argument("--data or --fit is required: what has the distribution");
    if (!fit_.empty() && tau_.empty()) throw std::invalid_argument("--fit needs --tau, the times at which it is shown");
    if (!fit_.empty() && data_.size() > 1)
      throw std::invalid_argument("--fit goes with one file of --data, not with " + std::to_string(data_.size()));
    for (const auto& text : where_) read_.where.emplace_back(text);
    if (picture_.empty()) return;
    try {
      drawing_.emplace(picture_, options().input_files());
    } catch (const std::invalid_argument& error) {
      throw std::invalid_argument(std::string("--picture: ") + error.what());
    }
  }

  struct Row {
    std::string source, kind;
    double tau, tau_lower, tau_upper, value, lower, upper;
  };

  /// What is to be read first stands first: peaks, lines, and at the end the density.
  struct RowLists {
    std::vector<Row> peaks, lines, ends, densities;

    [[nodiscard]] std::vector<Row> all() const {
      std::vector<Row> rows = peaks;
      rows.insert(rows.end(), lines.begin(), lines.end());
      rows.insert(rows.end(), ends.begin(), ends.end());
      rows.insert(rows.end(), densities.begin(), densities.end());
      return rows;
    }
  };

  static void add_rows(const std::string& source, const frac::TimesDistribution& of, RowLists& rows) {
    const bool has_band = !of.lower.empty();
    for (std::size_t i = 0; i < of.tau.size(); ++i)
      rows.densities.push_back({source, "density", of.tau[i], of.tau[i], of.tau[i], of.density[i],
                                has_band ? of.lower[i] : NAN, has_band ? of.upper[i] : NAN});
    const auto add = [&](std::vector<Row>& to, const char* kind, const auto& each) {
      to.push_back(
          {source, kind, each.tau, each.tau_lower, each.tau_upper, each.area, each.area_lower, each.area_upper});
    };
    if (!std::isnan(of.constant)) {
      rows.ends.push_back({source, "constant", NAN, NAN, NAN, of.constant, of.constant_lower, of.constant_upper});
      rows.ends.push_back(
          {source, "inductance", NAN, NAN, NAN, of.inductance, of.inductance_lower, of.inductance_upper});
      rows.ends.push_back({source, "elastance", NAN, NAN, NAN, of.elastance, of.elastance_lower, of.elastance_upper});
    }
    for (const auto& line : of.lines) add(rows.lines, "line", line);
    for (const auto& peak : of.peaks) add(rows.peaks, "peak", peak);
  }

  /// By the kernel that was asked for, or else the falling one unless the rising one alone follows the data.
  [[nodiscard]] frac::TimesDistribution of_data(const frac::FrequencyResponseData& data) const {
    auto falling = frac::relaxation_times(data, kernel_.value_or(frac::TimesKernel::falling));
    if (kernel_ || falling.follows_data()) return falling;
    auto rising = frac::relaxation_times(data, frac::TimesKernel::rising);
    return rising.follows_data() ? rising : falling;
  }

  static double area(const frac::TimesDistribution& of) {
    double sum = 0;
    for (std::size_t i = 1; i < of.tau.size(); ++i)
      sum += 0.5 * (of.density[i] + of.density[i - 1]) * std::log(of.tau[i] / of.tau[i - 1]);
    for (const auto& line : of.lines) sum += line.area;
    return sum;
  }

  /// By the kernel that was asked for or that the data told, or else by that which makes the area positive: the two
  /// densities differ by their sign.
  [[nodiscard]] frac::TimesDistribution of_fit(const frac::FitResult& fit,
                                               const std::optional<frac::TimesKernel>& told) const {
    auto falling = frac::relaxation_times(fit, tau_, told.value_or(frac::TimesKernel::falling));
    if (told || area(falling) >= 0) return falling;
    return frac::relaxation_times(fit, tau_, frac::TimesKernel::rising);
  }

  /// Says why a distribution is none of relaxation times.
  bool data_are_followed(const std::string& file, const frac::TimesDistribution& times) const {
    if (times.follows_data()) return true;
    say(file + ": no distribution of relaxation times" +
        (kernel_ ? " with the kernel " + std::string(to_string(*kernel_)) : " with either kernel") +
        " follows the data: it misses them by " + short_number(100 * times.misfit) + " % (rms), " +
        short_number(times.misfit_in_noise) + " times their noise" +
        (kernel_ ? "; try the other --kernel" : "; a resonance, or a reversed sign of the imaginary part, does that"));
    return false;
  }
  bool density_is_positive(const frac::TimesDistribution& times) const {
    const auto [least, most] = std::minmax_element(times.density.begin(), times.density.end());
    constexpr double rounding = 1e-6;
    if (*least >= -rounding * std::abs(*most) && area(times) >= 0) return true;
    say(fit_ + ": the density is negative at some times, down to " + short_number(*least) + " beside " +
        short_number(*most) + " at most, with the kernel " + std::string(to_string(times.kernel)) +
        (area(times) < 0 ? "; the other --kernel makes its area positive" : ""));
    return area(times) >= 0;
  }

  /// Of the formula, as that of a distribution of data: rms of what it leaves, relative to their magnitude.
  static double misfit_of(const frac::FitResult& fit, const frac::FrequencyResponseData& data) {
    const frac::Structure structure(fit.model);
    std::vector<double> values;
    for (const auto& parameter : fit.parameters) values.push_back(parameter.value);
    double largest = 0, sum = 0;
    for (const auto& value : data.value()) largest = std::max(largest, std::abs(value));
    for (std::size_t i = 0; i < data.size(); ++i) {
      const double size = std::abs(data.value()[i]);
      sum += std::norm((structure.response(values, data.omega()[i]) - data.value()[i]) / (size > 0 ? size : largest));
    }
    return std::sqrt(sum / static_cast<double>(data.size()));
  }

  struct Read {
    std::string name;
    io::FrequencyResponseFile content;
  };

  /// A file that cannot be read does not keep the others from being shown; where none can be read, that is the error.
  /// Areas are compared, so that all have one unit.
  [[nodiscard]] std::vector<Read> read_files() const {
    std::vector<Read> files;
    std::optional<io::DataError> problem;
    for (const std::string& name : data_) {
      try {
        files.push_back({name, io::read_frequency_response(name, read_)});
      } catch (const io::DataError& error) {
        if (data_.size() > 1) say(error.what());
        if (!problem) problem = error;
        continue;
      }
      const io::FrequencyResponseFile& file = files.back().content;
      for (const auto& note : file.notes) say(name + ": " + note);
      if (file.value_unit != files.front().content.value_unit)
        throw io::DataError(name, 0, 0,
                            "has values in " + io::quoted(file.value_unit) + ", " + files.front().name + " in " +
                                io::quoted(files.front().content.value_unit) + "; expected one unit");
    }
    if (files.empty() && problem) throw io::DataError(*problem);
    return files;
  }

  int run() override {
    Document document;
    bool usable = true;
    std::optional<frac::TimesKernel> told = kernel_;
    RowLists lists;
    std::string unit;
    std::optional<frac::FrequencyResponseData> data;
    report::Panel panel{"", {"{/Symbol t} (s)", true}, {"density per e-fold"}};
    panel.key = true;
    std::vector<Read> files = read_files();
    const bool one = data_.size() == 1;
    usable = files.empty();
    for (std::size_t i = 0; i < files.size(); ++i) {
      const io::FrequencyResponseFile& file = files[i].content;
      const auto times = of_data(file.data);
      told = times.kernel;
      const bool followed = data_are_followed(files[i].name, times);
      usable = usable || followed;
      const std::string source = one ? "data" : files[i].name;
      add_rows(source, times, lists);
      unit = file.value_unit;
      // More than two ranges hide each other.
      report::add_times(one ? "data" : report::enhanced_escape(source), i, report::within_band(times, file.data),
                        data_.size() < 3, panel);
      if (!one) continue;
      for (const auto& [name, value, lower, upper] :
           {std::tuple{"constant", times.constant, times.constant_lower, times.constant_upper},
            {"inductance", times.inductance, times.inductance_lower, times.inductance_upper},
            {"elastance", times.elastance, times.elastance_lower, times.elastance_upper}}) {
        document.head.emplace_back(name, io::format_number(value));
        document.head.emplace_back(name + std::string("_lower"), io::format_number(lower));
        document.head.emplace_back(name + std::string("_upper"), io::format_number(upper));
      }
      document.head.emplace_back("smoothness", io::format_number(times.smoothness));
      document.head.emplace_back("misfit", io::format_number(times.misfit));
      document.head.emplace_back("misfit_in_noise", io::format_number(times.misfit_in_noise));
      data = file.data;
    }
    if (!unit.empty()) panel.y.label += " (" + report::enhanced_escape(io::written_unit(unit)) + ")";
    if (!fit_.empty()) {
      const auto fit = read_fit(fit_);
      const auto times = of_fit(fit, told);
      told = times.kernel;
      usable = density_is_positive(times) && usable;
      document.head.emplace_back("model", fit.model);
      if (data) document.head.emplace_back("fit_misfit", io::format_number(misfit_of(fit, *data)));
      add_rows("fit", times, lists);
      if (times.lines_left_off > 0) {
        document.head.emplace_back("lines_left_off", std::to_string(times.lines_left_off));
        say(fit_ + ": " + std::to_string(times.lines_left_off) +
            " further lines of a series, shorter than those listed, are left off");
      }
      report::add_times("fit", 1, times, true, panel);
    }
    report::make_room_for_ranges(panel);
    document.head.emplace_back("kernel", std::string(to_string(*told)));
    if (!unit.empty()) document.head.emplace_back("value_unit", unit);
    const std::vector<Row> rows = lists.all();
    options()["--kernel"].say(std::string(to_string(*told)));
    document.rows.columns = {"source", "kind", "tau_s", "tau_lower", "tau_upper", "value", "lower", "upper"};
    document.rows.intervals = {{2, 3, 4}, {5, 6, 7}};
    document.rows.count = rows.size();
    document.rows.fill = [&](std::size_t i, std::vector<Cell>& cells) {
      const Row& row = rows[i];
      cells.insert(cells.end(),
                   {row.source, row.kind, row.tau, row.tau_lower, row.tau_upper, row.value, row.lower, row.upper});
    };
    write(text_of(document, format(), command_line()));
    if (drawing_) drawing_->write({"times", "", {std::move(panel)}});
    return usable ? usable_result : no_usable_result;
  }

  std::string fit_, picture_;
  std::vector<std::string> data_, where_;
  io::FrequencyResponseReadOptions read_;
  std::vector<double> tau_;
  std::optional<frac::TimesKernel> kernel_;
  std::optional<report::PictureFile> drawing_;
};

}  // namespace

std::unique_ptr<Command> make_drt() {
  return std::make_unique<Drt>();
}

}  // namespace fracfit
