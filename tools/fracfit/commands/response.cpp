// SPDX-License-Identifier: BSD-3-Clause
#include "frac/records/response.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>
#include <set>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "commands/subcommand.hpp"
#include "io/data_error.hpp"
#include "io/frequency_response_file.hpp"
#include "io/record_file.hpp"
#include "output/document.hpp"
#include "report/picture.hpp"
#include "report/response_figure.hpp"

namespace fracfit {
namespace {

class Response : public Command {
 public:
  Response()
      : Command("response", "Raw records of an experiment become a frequency response, each value with its error") {
    Options& o = options();
    o.texts("RECORD", files_,
            "Samples of input and outputs over time, as a table or MAT-file; several: realisations of one periodic or "
            "random excitation, or further steps of a stepped sine",
            "FILE")
        .required()
        .names_input();
    o.parsed(
        "--columns", read_.columns,
        [](std::string_view, const std::string& text) {
          static_cast<void>(io::record_columns_told(text));
          return text;
        },
        "Which column is what, by number or name; e.g. time=1,input=2,output=3,output=5, keys time, input, reference "
        "(what drives a closed loop), trigger (rises once a period; without an input it is that, a cosine), output",
        "LIST");
    o.texts("--input-file", input_files_,
            "Times and input of RECORD, which then holds the outputs; joined by time, one for each RECORD", "FILE")
        .names_input();
    o.number("--sample-time", read_.sample_time, "instead of a column of times").default_is("by the column of times");
    o.choice("--excitation", choice_.excitation, frac::excitations(), "What drove the experiment", "KIND")
        .default_is("found");
    o.number("--period", choice_.period, "Period of the excitation, s", "T")
        .default_is("found, to a fraction of a sample")
        .not_with({"--excitation", {"stepped-sine", "arbitrary"}}, "which have no common period");
    o.count("--harmonics", choice_.harmonics, 1, 1000,
            "Harmonics of the output under a stepped sine, the first included", "H")
        .not_with({"--excitation", {"periodic", "arbitrary"}}, "whose lines mix");
    o.number("--sensor-delay", choice_.sensor_delay, "outputs, against the input; it is taken out");
    o.text("--picture", picture_, "A picture beside the result, SVG or PNG by its ending: response, noise, distortion",
           "FILE");
    add_common({"csv", "json", "table"});
    set_footer(
        "Periodic: whole periods as one Fourier sum, transient and noise by the lines between those of the period.\n"
        "Stepped sine: the same segment by segment, with harmonics: a describing function, its force in the head.\n"
        "Arbitrary (random, swept, step): the local polynomial method; h1 is the usual windowed estimate beside it.\n"
        "sigma is the standard deviation of each part, noise and distortion together: +-1.98 sigma hold 95 %.  Points\n"
        "without it are left out and named in the head.  fit, identify and identify-scene weigh the file with it.\n"
        "Examples:\n"
        "  fracfit response record.csv --out n.csv --picture n.svg\n"
        "  fracfit response bench.mat --columns input=iq_adx,output=theta_mx --sample-time 4e-4 --out motor.csv\n"
        "  fracfit response encoder.csv --input-file force.csv --columns output=angle,input=force\n"
        "  fracfit response r1.csv r2.csv r3.csv --columns time=1,input=2,output=3 --format json");
  }

 private:
  void check() override {
    if (read_.sample_time && !(*read_.sample_time > 0 && std::isfinite(*read_.sample_time)))
      throw std::invalid_argument("--sample-time " + options()["--sample-time"].text() + ": allowed is above 0");
    if (!input_files_.empty() && input_files_.size() != files_.size())
      throw std::invalid_argument("--input-file names " + std::to_string(input_files_.size()) + " files for " +
                                  std::to_string(files_.size()) + " records; expected one for each");
    if (picture_.empty()) return;
    try {
      drawing_.emplace(picture_, options().input_files());
    } catch (const std::invalid_argument& error) {
      throw std::invalid_argument(std::string("--picture: ") + error.what());
    }
  }

  /// Rows of all outputs that have a deviation, in order of frequency.
  struct Table {
    std::vector<std::size_t> points;
    std::vector<std::pair<double, std::string>> left_out;  // frequency and why
  };

  static Table table_of(const frac::ResponseEstimate& found) {
    Table table;
    const auto& first = found.outputs.front();
    for (std::size_t i = 0; i < first.size(); ++i) {
      std::string why;
      for (const auto& points : found.outputs)
        if (!std::isfinite(points[i].sigma)) why = points[i].flag.empty() ? "no deviation" : points[i].flag;
      if (why.empty())
        table.points.push_back(i);
      else
        table.left_out.emplace_back(first[i].omega, why);
    }
    std::stable_sort(table.points.begin(), table.points.end(),
                     [&](std::size_t a, std::size_t b) { return first[a].omega < first[b].omega; });
    return table;
  }

  /// Means of amplitudes that agree to within 2 %, by point: a command repeats its levels closer than that.
  static std::vector<double> levels(const std::vector<frac::ResponsePoint>& points, const Table& table) {
    std::vector<std::size_t> order = table.points;
    std::sort(order.begin(), order.end(),
              [&](std::size_t a, std::size_t b) { return points[a].input_amplitude < points[b].input_amplitude; });
    std::vector<double> level(points.size());
    constexpr double apart = 1.02;
    for (std::size_t begin = 0, end = 0; begin < order.size(); begin = end) {
      double sum = 0;
      while (end < order.size() && points[order[end]].input_amplitude <= apart * points[order[begin]].input_amplitude)
        sum += points[order[end++]].input_amplitude;
      for (std::size_t i = begin; i < end; ++i) level[order[i]] = sum / static_cast<double>(end - begin);
    }
    return level;
  }

  static std::string joined(const std::string& name, const std::string& ending) {
    return ending.empty() ? name : name + "_" + ending;
  }

  /// Columns of one output and what stands in them.
  struct Columns {
    std::vector<std::string> names;
    std::vector<Cell (*)(const frac::ResponsePoint&)> values;

    void add(const std::string& name, Cell (*value)(const frac::ResponsePoint&)) {
      names.push_back(name);
      values.push_back(value);
    }
  };

  static Columns columns_of(frac::Excitation excitation, const std::string& label, const std::string& unit) {
    using Point = frac::ResponsePoint;
    // Readers take the ending of re and im for the label of a curve, or else for a unit.
    const std::string ending = label.empty() ? unit : label;
    Columns columns;
    columns.add(joined("re", ending), [](const Point& p) { return Cell(p.value.real()); });
    columns.add(joined("im", ending), [](const Point& p) { return Cell(p.value.imag()); });
    columns.add(joined("sigma", ending), [](const Point& p) { return Cell(p.sigma_or_rounding()); });
    const auto other = [&](const std::string& name, Cell (*value)(const Point&)) {
      columns.add(joined(name, label), value);
    };
    other("deviation_re", [](const Point& p) { return Cell(p.sigma_re); });
    other("deviation_im", [](const Point& p) { return Cell(p.sigma_im); });
    other("correlation", [](const Point& p) { return Cell(p.correlation); });
    other("degrees_of_freedom", [](const Point& p) { return Cell(p.degrees); });
    other("noise", [](const Point& p) { return Cell(p.noise); });
    const auto add_distortion = [&] {
      other("distortion", [](const Point& p) { return Cell(p.distortion); });
      other("distortion_low", [](const Point& p) { return Cell(p.distortion_low); });
      other("distortion_high", [](const Point& p) { return Cell(p.distortion_high); });
    };
    switch (excitation) {
      case frac::Excitation::periodic:
        add_distortion();
        other("even_distortion", [](const Point& p) { return Cell(p.even_distortion); });
        other("even_distortion_low", [](const Point& p) { return Cell(p.even_distortion_low); });
        other("even_distortion_high", [](const Point& p) { return Cell(p.even_distortion_high); });
        break;
      case frac::Excitation::stepped_sine:
        other("subharmonic", [](const Point& p) { return Cell(std::int64_t{p.subharmonic}); });
        break;
      case frac::Excitation::arbitrary:
        add_distortion();
        other("coherence", [](const Point& p) { return Cell(p.coherence); });
        other("h1_re", [](const Point& p) { return Cell(p.windowed.real()); });
        other("h1_im", [](const Point& p) { return Cell(p.windowed.imag()); });
        break;
    }
    return columns;
  }

  [[nodiscard]] io::Metadata head_of(const io::RecordFile& file, double sample_time,
                                     const frac::ResponseEstimate& found, const Table& table) const {
    io::Metadata head;
    for (const auto& name : files_) head.emplace_back("source", name);
    for (const auto& name : input_files_) head.emplace_back("source", name);
    head.emplace_back("input", file.input);
    for (const auto& name : file.outputs) head.emplace_back("output", name);
    head.emplace_back("excitation", std::string(to_string(found.excitation)));
    head.emplace_back("sample_time_s", io::format_number(sample_time));
    if (found.excitation == frac::Excitation::periodic) head.emplace_back("period_s", io::format_number(found.period));
    if (found.excitation != frac::Excitation::arbitrary) head.emplace_back("periods", io::format_number(found.periods));
    head.emplace_back(io::sigma_key, io::sigma_is_measured);
    if (found.realisations > 1) head.emplace_back("realisations", std::to_string(found.realisations));
    for (const auto& remark : found.remarks) head.emplace_back("remark", remark);
    if (!table.left_out.empty()) {
      head.emplace_back("points_left_out", std::to_string(table.left_out.size()));
      std::set<std::string> said;
      for (const auto& [omega, why] : table.left_out)
        if (said.insert(why).second) head.emplace_back("left_out", io::format_number(omega) + " rad/s: " + why);
    }
    return head;
  }

  /// A trigger tells the period, and another file the lateness of its input.
  void learn_from(const io::RecordFile& file) {
    if (!choice_.period && choice_.excitation.value_or(frac::Excitation::periodic) == frac::Excitation::periodic)
      choice_.period = file.period;
    choice_.sensor_delay += file.sensor_delay;
  }

  [[nodiscard]] frac::ResponseEstimate estimated(const std::vector<frac::Record>& records) const {
    // Where nothing is told of the excitation, a record with gaps that is refused is at fault.
    const bool is_told =
        choice_.excitation || choice_.period ||
        std::all_of(records.begin(), records.end(), [](const auto& each) { return each.gaps().empty(); });
    if (is_told) return frac::response(records, choice_);
    try {
      return frac::response(records, choice_);
    } catch (const std::invalid_argument& error) {
      throw io::DataError(files_.front(), 0, 0, error.what());
    }
  }

  int run() override {
    std::vector<frac::Record> records;
    std::optional<io::RecordFile> first;
    for (const auto& name : files_) {
      if (!input_files_.empty()) read_.input_file = input_files_[records.size()];
      io::RecordFile file = io::read_record(name, read_);
      for (const auto& note : file.notes) say(name + ": " + note);
      if (!first)
        learn_from(file);
      else if (std::abs(file.sensor_delay - first->sensor_delay) > 1e-3 * file.record.sample_time())
        throw io::DataError(name, 0, 0,
                            "its instants are " + io::format_number(file.sensor_delay) +
                                " s before those of its input, and those of the first record " +
                                io::format_number(first->sensor_delay) + " s; expected the same, or one record");
      records.push_back(std::move(file.record));
      if (!first) first.emplace(std::move(file));
    }
    const frac::ResponseEstimate found = estimated(records);
    options()["--excitation"].say(std::string(to_string(found.excitation)));
    if (found.excitation == frac::Excitation::periodic) options()["--period"].say(io::format_number(found.period));
    for (const auto& remark : found.remarks) say(files_.front() + ": " + remark);
    const Table table = table_of(found);
    if (table.points.empty()) {
      say(files_.front() + ": no point has a value with its deviation" +
          (table.left_out.empty() ? std::string(": no line or segment of the excitation was found")
                                  : ": " + table.left_out.front().second));
      return no_usable_result;
    }
    if (!table.left_out.empty())
      say(files_.front() + ": " + std::to_string(table.left_out.size()) + " points are left out, the first at " +
          io::format_number(table.left_out.front().first) + " rad/s: " + table.left_out.front().second);

    Document document{head_of(*first, records.front().sample_time(), found, table), {}, {}};
    const auto& points = found.outputs.front();
    const bool is_stepped = found.excitation == frac::Excitation::stepped_sine;
    const std::vector<double> level = levels(points, table);
    const bool is_force = first->input_unit == "n" || first->input_unit == "N";
    const bool is_one_level = std::all_of(table.points.begin(), table.points.end(),
                                          [&](std::size_t i) { return level[i] == level[table.points.front()]; });
    auto& names = document.rows.columns;
    const bool has_force_column = is_stepped && is_force && !is_one_level;
    if (is_stepped && is_force && is_one_level)
      document.head.emplace_back("force_n", io::format_number(level[table.points.front()]));
    if (has_force_column) names.emplace_back("force_n");
    names.insert(names.end(), {"omega_rad_s"});
    std::vector<Columns> columns;
    for (std::size_t output = 0; output < found.outputs.size(); ++output) {
      const std::string label = found.outputs.size() > 1 ? first->outputs[output] : "";
      columns.push_back(columns_of(found.excitation, label, first->units[output]));
      names.insert(names.end(), columns.back().names.begin(), columns.back().names.end());
      if (!is_stepped) continue;
      for (int order = 2; order <= choice_.harmonics; ++order)
        for (const char* part : {"re", "im", "sigma"})
          names.push_back(joined("harmonic" + std::to_string(order) + "_" + part, label));
    }
    names.push_back(joined("input_amplitude", first->input_unit));
    names.emplace_back("periods");
    std::vector<std::size_t> order = table.points;
    if (has_force_column)
      std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return level[a] < level[b]; });
    document.rows.count = order.size();
    document.rows.fill = [&](std::size_t row, std::vector<Cell>& cells) {
      const std::size_t i = order[row];
      if (has_force_column) cells.emplace_back(level[i]);
      cells.emplace_back(points[i].omega);
      for (std::size_t output = 0; output < found.outputs.size(); ++output) {
        const frac::ResponsePoint& point = found.outputs[output][i];
        for (const auto& value : columns[output].values) cells.push_back(value(point));
        if (!is_stepped) continue;
        for (std::size_t k = 0; k + 1 < static_cast<std::size_t>(choice_.harmonics); ++k) {
          constexpr double none = std::numeric_limits<double>::quiet_NaN();
          const bool has = k < point.harmonics.size();
          cells.emplace_back(has ? point.harmonics[k].value.real() : none);
          cells.emplace_back(has ? point.harmonics[k].value.imag() : none);
          cells.emplace_back(has ? point.harmonics[k].sigma : none);
        }
      }
      cells.emplace_back(points[i].input_amplitude);
      cells.emplace_back(points[i].periods);
    };
    if (format() == "table") keep_for_people(document.rows);
    write(text_of(document, format(), command_line()));
    if (drawing_) drawing_->write(report::response_figure(found, first->outputs, first->units.front()));
    return usable_result;
  }

  /// Leaves out columns that a terminal has no room for.
  static void keep_for_people(Rows& rows) {
    std::vector<bool> is_kept;
    std::vector<std::string> names;
    for (const std::string& name : rows.columns) {
      is_kept.push_back(true);
      for (const char* begin : {"deviation_", "correlation", "degrees_of_freedom", "h1_", "harmonic", "periods",
                                "distortion_", "even_distortion_"})
        if (name.starts_with(begin)) is_kept.back() = false;
      if (is_kept.back()) names.push_back(name);
    }
    rows.columns = std::move(names);
    rows.fill = [fill = rows.fill, is_kept](std::size_t row, std::vector<Cell>& cells) {
      std::vector<Cell> all;
      fill(row, all);
      for (std::size_t i = 0; i < all.size(); ++i)
        if (is_kept[i]) cells.push_back(std::move(all[i]));
    };
  }

  std::vector<std::string> files_, input_files_;
  std::string picture_;
  std::optional<report::PictureFile> drawing_;
  io::RecordReadOptions read_;
  frac::ResponseOptions choice_;
};

}  // namespace

std::unique_ptr<Command> make_response() {
  return std::make_unique<Response>();
}

}  // namespace fracfit
