// SPDX-License-Identifier: BSD-3-Clause
#include "frac/records/multisine.hpp"

#include <cctype>
#include <cmath>
#include <cstdint>
#include <stdexcept>
#include <string>
#include <vector>

#include "commands/subcommand.hpp"
#include "io/version.hpp"
#include "options/fit_record.hpp"
#include "options/model_options.hpp"
#include "output/document.hpp"

namespace fracfit {
namespace {

class MultisineCommand : public Command {
 public:
  MultisineCommand()
      : Command("multisine", "An excitation for an experiment: a sum of sines with a low peak, or steps of a sine") {
    made_.period = made_.sample_time = NAN;  // not to be taken for defaults
    Options& o = options();
    o.parsed("--band", band_, band_of, "that is excited");
    o.text("--next-measurement", next_,
           "Result of identify, undecided, as JSON: steps of a sine where its next measurement asks for them, even in "
           "the "
           "logarithm, instead of a multisine",
           "FILE")
        .names_input();
    o.exactly_one({"--band", "--next-measurement"}, "of a multisine, or what asks for a stepped sine");
    o.number("--total-time", total_time_, "of all steps, s; what they do not settle for is shared evenly", "T")
        .only_with({"--next-measurement"})
        .needed_with({"--next-measurement"});
    o.count("--settling", settling_, 0, largest_table, "Cycles of each step before those that are measured", "N")
        .only_with({"--next-measurement"});
    o.number("--period", made_.period, "Period of the excitation, s; a whole number of samples", "T")
        .only_with({"--band"})
        .needed_with({"--band"});
    o.number("--sample-time", made_.sample_time).only_with({"--band"}).needed_with({"--band"});
    o.choice(
         "--lines", made_.lines, frac::multisine_lines(),
         "Lines of the period: all; odd ones, so that even distortion shows beside them; of four odd ones three, so "
         "that odd distortion shows too",
         "LINES")
        .only_with({"--band"});
    o.number("--peak", made_.peak, "Largest absolute value", "VALUE");
    o.count("--periods", periods_, 1, largest_table, "Periods to write", "N").only_with({"--band"});
    o.count("--rounds", made_.rounds, 0, 1'000'000, "Rounds in which the peak is lowered", "N").only_with({"--band"});
    o.count("--seed", made_.seed, 0, largest_table, "of phases and lines; another one is another realisation")
        .only_with({"--band"});
    o.text("--name", name_, "of the array").only_with({"--format", {"c"}});
    add_common({"csv", "c", "json", "table"});
    set_footer(
        "All sines have the same amplitude; the head has it with the crest factor, peak over root mean square.\n"
        "Send at least three periods; the noise is read from between the lines, see fracfit response.\n"
        "Steps measure whole cycles, six or more, and as long at each frequency as at the others.\n"
        "Examples:\n"
        "  fracfit multisine --band 1:200 --period 5 --sample-time 0.002 --peak 2 --periods 6 --out drive.csv\n"
        "  fracfit multisine --band 1:200 --period 5 --sample-time 0.002 --lines odd --format c --name drive --out "
        "drive.h\n"
        "  fracfit multisine --next-measurement identify.json --total-time 600 --peak 2 --out steps.csv");
  }

 private:
  void check() override {
    if (!next_.empty() && format() == "c")
      throw std::invalid_argument(
          "--format c is of a multisine, not with --next-measurement; expected csv, json or table");
    made_.lower = band_.lower;
    made_.upper = band_.upper;
    const bool is_name =
        !name_.empty() && std::isdigit(static_cast<unsigned char>(name_.front())) == 0 &&
        name_.find_first_not_of("abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_") == std::string::npos;
    if (!is_name) throw std::invalid_argument("--name '" + name_ + "': expected a name in C");
  }

  /// One period as an array of doubles.
  [[nodiscard]] std::string c_text(const frac::Multisine& found) const {
    std::string text = "/* fracfit " + std::string(io::version()) + ": " + command_line() +
                       "\n * One period, a sample every " + io::format_number(made_.sample_time) + " s. */\n#ifndef " +
                       name_ + "_h\n#define " + name_ + "_h\n#define " + name_ + "_count " +
                       std::to_string(found.samples.size()) + "\nstatic const double " + name_ + "[" + name_ +
                       "_count] = {\n";
    for (const double each : found.samples) text += "  " + io::format_number(each) + ",\n";
    return text + "};\n#endif\n";
  }

  int run_steps() {
    const frac::NextMeasurement next = read_next_measurement(next_);
    require_table_size({{"points of --next-measurement", next.points}});
    std::vector<double> omega;
    for (std::size_t i = 0; i < next.points; ++i)
      omega.push_back(next.lower *
                      std::pow(next.upper / next.lower,
                               next.points > 1 ? static_cast<double>(i) / static_cast<double>(next.points - 1) : 0.5));
    const auto plan = frac::stepped_sine_plan(omega, total_time_, settling_);
    Document document{
        {{"source", next_},
         {"accuracy", io::format_number(next.accuracy)},
         {"relative_accuracy", io::format_number(next.relative_accuracy)},
         {"total_time_s", io::format_number(plan.back().end)}},
        {{"omega_rad_s", "amplitude", "settling_cycles", "measuring_cycles", "begin_s", "end_s"}, plan.size(), {}},
        {}};
    document.rows.fill = [&](std::size_t i, std::vector<Cell>& cells) {
      const auto& step = plan[i];
      cells.insert(cells.end(), {step.omega, made_.peak, static_cast<std::int64_t>(step.settling),
                                 static_cast<std::int64_t>(step.measuring), step.begin, step.end});
    };
    write(text_of(document, format(), command_line()));
    return usable_result;
  }

  int run() override {
    if (!next_.empty()) return run_steps();
    const frac::Multisine found = frac::multisine(made_);
    if (format() == "c") {
      write(c_text(found));
      return usable_result;
    }
    require_table_size({{"--period", found.samples.size()}, {"--periods", periods_}});
    Document document{{{"lines", std::to_string(found.lines.size())},
                       {"first_line", std::to_string(found.lines.front())},
                       {"last_line", std::to_string(found.lines.back())},
                       {"amplitude", io::format_number(found.amplitude)},
                       {"crest_factor", io::format_number(found.crest_factor)}},
                      {{"time_s", "input"}, periods_ * found.samples.size(), {}},
                      {}};
    document.rows.fill = [&](std::size_t i, std::vector<Cell>& cells) {
      cells.insert(cells.end(), {static_cast<double>(i) * made_.sample_time, found.samples[i % found.samples.size()]});
    };
    write(text_of(document, format(), command_line()));
    return usable_result;
  }

  frac::MultisineOptions made_;
  frac::FrequencyBand band_{};
  std::size_t periods_ = 1, settling_ = 10;
  double total_time_ = NAN;
  std::string next_;
  std::string name_ = "multisine";
};

}  // namespace

std::unique_ptr<Command> make_multisine() {
  return std::make_unique<MultisineCommand>();
}

}  // namespace fracfit
