// SPDX-License-Identifier: BSD-3-Clause
#include "frac/records/multisine.hpp"

#include <cctype>
#include <stdexcept>
#include <string>

#include "commands/subcommand.hpp"
#include "io/version.hpp"
#include "options/model_options.hpp"
#include "output/document.hpp"

namespace fracfit {
namespace {

class MultisineCommand : public Command {
 public:
  MultisineCommand() : Command("multisine", "An excitation for an experiment: a sum of sines with a low peak") {
    Options& o = options();
    o.parsed("--band", band_, band_of, "that is excited").required();
    o.number("--period", made_.period, "Period of the excitation, s; a whole number of samples", "T").required();
    o.number("--sample-time", made_.sample_time).required();
    o.choice(
        "--lines", made_.lines, frac::multisine_lines(),
        "Lines of the period: all; odd ones, so that even distortion shows beside them; of four odd ones three, so "
        "that odd distortion shows too",
        "LINES");
    o.number("--peak", made_.peak, "Largest absolute value", "VALUE");
    o.count("--periods", periods_, 1, largest_table, "Periods to write", "N");
    o.count("--rounds", made_.rounds, 0, 1'000'000, "Rounds in which the peak is lowered", "N");
    o.count("--seed", made_.seed, 0, largest_table, "of phases and lines; another one is another realisation");
    o.text("--name", name_, "of the array").only_with({"--format", {"c"}});
    add_common({"csv", "c", "json", "table"});
    set_footer(
        "All sines have the same amplitude; the head has it with the crest factor, peak over root mean square.\n"
        "Send at least three periods; the noise is read from between the lines, see fracfit response.\n"
        "Examples:\n"
        "  fracfit multisine --band 1:200 --period 5 --sample-time 0.002 --peak 2 --periods 6 --out drive.csv\n"
        "  fracfit multisine --band 1:200 --period 5 --sample-time 0.002 --lines odd --format c --name drive --out "
        "drive.h");
  }

 private:
  void check() override {
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

  int run() override {
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
  std::size_t periods_ = 1;
  std::string name_ = "multisine";
};

}  // namespace

std::unique_ptr<Command> make_multisine() {
  return std::make_unique<MultisineCommand>();
}

}  // namespace fracfit
