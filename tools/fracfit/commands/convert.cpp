// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cctype>
#include <string>
#include <vector>

#include "commands/subcommand.hpp"
#include "options/data_options.hpp"
#include "options/measured_curves.hpp"
#include "output/document.hpp"

namespace fracfit {
namespace {

// "re_ohm", or "re [m/s^2]" for a unit that is no word.
std::string column(const std::string& quantity, const std::string& unit) {
  if (unit.empty() || unit == "1") return quantity;
  const bool is_word = std::all_of(unit.begin(), unit.end(),
                                   [](unsigned char c) { return std::isalnum(c) != 0 || c == '_' || c >= 0x80; });
  if (is_word) return quantity + "_" + unit;
  std::string kept = unit;
  std::replace_if(
      kept.begin(), kept.end(), [](char c) { return std::string_view(",\"[]").find(c) != std::string_view::npos; },
      ' ');
  return quantity + " [" + kept + "]";
}

class Convert : public Command {
 public:
  Convert() : Command("convert", "Writes a measured frequency response as it was understood, as a plain table") {
    Options& o = options();
    o.text("FILE", file_, "A frequency response as a table or as an instrument writes it; - for standard input", "FILE")
        .required()
        .names_input();
    add_file_options(o, how_);
    add_select(o, how_);
    add_quantity(o, quantity_);
    add_common({"csv", "json", "table"});
    set_footer(
        "Formats, told by content: Gamry, BioLogic EC-Lab, ZView, VersaStudio, Parstat, CH Instruments, Touchstone,\n"
        "universal files of dataset 58, and tables with named columns of any other program.  Several sweeps get a\n"
        "column curve in front.\n"
        "Examples:\n"
        "  fracfit convert cell.DTA --out clean.csv\n"
        "  fracfit convert table.txt --columns f=1,re=2,-im=3 --frequency-unit Hz --out clean.csv\n"
        "  fracfit convert modal.uff --select 2 --format table");
  }

 private:
  int run() override {
    const auto curves = read_curves(file_, how_, quantity_);
    for (const auto& note : notes_of(curves)) say(file_ + ": " + note);
    const io::FrequencyResponseFile& first = curves.front().file;
    const bool has_sigma =
        std::any_of(curves.begin(), curves.end(), [](const auto& each) { return !each.file.data.sigma().empty(); });
    Document document;
    document.head.emplace_back("source", file_);
    for (const auto& [key, value] : first.metadata)
      if (key != "fracfit" && key != "command" && curves.size() == 1) document.head.emplace_back(key, value);
    auto& columns = document.rows.columns;
    if (curves.size() > 1) columns.emplace_back("curve");
    columns.insert(columns.end(), {"omega_rad_s", column("re", first.value_unit), column("im", first.value_unit)});
    if (has_sigma) columns.push_back(column("sigma", first.value_unit));
    std::vector<std::pair<const MeasuredCurve*, std::size_t>> places;
    for (const auto& curve : curves)
      for (std::size_t i = 0; i < curve.file.data.size(); ++i) places.emplace_back(&curve, i);
    document.rows.count = places.size();
    document.rows.fill = [&](std::size_t row, std::vector<Cell>& cells) {
      const auto& [curve, i] = places[row];
      const auto& data = curve->file.data;
      if (curves.size() > 1) cells.emplace_back(curve->name);
      cells.insert(cells.end(), {data.omega()[i], data.value()[i].real(), data.value()[i].imag()});
      if (has_sigma) cells.emplace_back(data.sigma().empty() ? Cell("") : Cell(data.sigma()[i]));
    };
    write(text_of(document, format(), command_line()));
    return usable_result;
  }

  std::string file_;
  io::MeasurementOptions how_;
  std::optional<backlash::Quantity> quantity_;
};

}  // namespace

std::unique_ptr<Command> make_convert() {
  return std::make_unique<Convert>();
}

}  // namespace fracfit
