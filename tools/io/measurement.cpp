// SPDX-License-Identifier: BSD-3-Clause
#include "io/measurement.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <stdexcept>

#include "io/data_error.hpp"
#include "io/decoded_text.hpp"
#include "io/fields.hpp"
#include "io/fingerprint.hpp"
#include "io/input_text.hpp"
#include "io/number.hpp"

namespace io {
namespace {

constexpr std::array<std::string_view, 11> keys{
    "f", "omega", "re", "im", "-im", "magnitude", "magnitude_db", "phase_deg", "phase_rad", "sigma", "weight"};

std::vector<std::size_t> columns_with_numbers(const MeasurementOptions& how) {
  std::vector<std::size_t> columns;
  for (const auto& [key, column] : columns_told(how.columns))
    if (const auto number = parse_count(column)) columns.push_back(static_cast<std::size_t>(*number) - 1);
  return columns;
}

std::optional<Recognised> recognised(const Source& source, const MeasurementOptions& how) {
  // Cheap tests of the first lines come first.
  for (const auto read :
       {read_matlab, read_universal58, read_gamry, read_biologic, read_versastudio, read_touchstone, read_zview})
    if (auto found = read(source)) return found;
  if (!how.columns.empty()) return read_told_table(source, columns_with_numbers(how));
  if (auto found = read_plain_table(source)) return found;
  return read_nameless_table(source);
}

// A stray control character is an error of its field; many are a picture, an archive or a program's own format.
bool is_binary(std::string_view text) {
  constexpr std::ptrdiff_t stray = 8;
  const std::string_view begin = text.substr(0, 1000);
  return std::count_if(begin.begin(), begin.end(),
                       [](unsigned char c) { return std::iscntrl(c) != 0 && std::isspace(c) == 0; }) > stray;
}

// What a file is that no reader here knows, and how its program writes what one does; empty for others.
std::string foreign_format(std::string_view bytes) {
  const std::string_view head = bytes.substr(0, 200);
  const auto has = [](std::string_view text, std::string_view part) {
    return text.find(part) != std::string_view::npos;
  };
  if (bytes.starts_with("BIO-LOGIC MODULAR FILE"))
    return "is EC-Lab's binary format (.mpr); expected its text (.mpt), which EC-Lab exports";
  if (has(head, "Version=11") && has(head, std::string_view("\0", 1)))
    return "is IviumSoft's binary format (.idf); expected a table, which IviumSoft exports as text";
  // JSON of PSTrace, as text or in UTF-16.
  if (has(head, "PalmSens") || has(head, std::string_view("P\0a\0l\0m\0S\0e\0n\0s\0", 16)))
    return "is a session of PSTrace (.pssession); expected a table, which PSTrace exports as CSV";
  if (head.starts_with("version8.0") || head.starts_with("Version8.0"))
    return "is a file of Autolab's FRA (.dfr), one number in each line; expected a table, which FRA exports as text";
  if (bytes.starts_with("TDSm"))
    return "is National Instruments' TDMS; expected a table, as NI's TDM Excel Add-In makes one, or text (.lvm), as "
           "LabVIEW's Write "
           "To Measurement File writes it";
  if (bytes.starts_with("\x89HDF\r\n\x1A\n"))
    return "is an HDF5 file; expected a table, or a MAT-file, as MATLAB and Octave save one with -v7";
  if (bytes.starts_with("\xD0\xCF\x11\xE0"))
    return "is a workbook of the old kind (.xls) or another file of Office; expected .xlsx, or a sheet saved as CSV";
  if (bytes.starts_with("PK\x03\x04")) {
    if (has(bytes, "xl/workbook.xml"))
      return "is a workbook (.xlsx) that is damaged or has no cells, or this fracfit was built without libzip; "
             "expected a sheet saved as CSV";
    return "is an archive (zip) and no workbook of Excel; expected the file within, or a sheet saved as CSV";
  }
  return "";
}

/// Of a table that holds several quantities one remains: that which --select names or the first; all columns where
/// --columns tells them.  Sweeps of such a table are told by a column, and --select chooses one of these.
void settle_columns(Recognised& found, Measurement& measurement) {
  const MeasurementOptions& how = measurement.how;
  if (!how.columns.empty()) {
    found.sweeps = {{"", std::move(*found.whole)}};
    found.notes.clear();
    return;
  }
  const auto named = std::find_if(found.sweeps.begin(), found.sweeps.end(),
                                  [&](const Sweep& sweep) { return !sweep.name.empty() && sweep.name == how.select; });
  Sweep chosen = std::move(named == found.sweeps.end() ? found.sweeps.front() : *named);
  if (named != found.sweeps.end()) {
    measurement.notes.push_back("read is " + chosen.name);
    measurement.is_selected = true;
  }
  chosen.name.clear();
  chosen.is_derived = false;
  found.sweeps.clear();
  found.sweeps.push_back(std::move(chosen));
}

}  // namespace

std::vector<std::pair<std::string, std::string>> columns_told(const std::string& text) {
  std::vector<std::pair<std::string, std::string>> pairs;
  for (std::size_t begin = 0; begin < text.size();) {
    const auto end = std::min(text.find(',', begin), text.size());
    const std::string part(trimmed(std::string_view(text).substr(begin, end - begin)));
    const auto sign = part.find('=');
    const std::string key = part.substr(0, sign);
    const std::string column = sign == std::string::npos ? "" : part.substr(sign + 1);
    if (std::find(keys.begin(), keys.end(), key) == keys.end() || column.empty() || column == "0")
      throw std::invalid_argument(
          "--columns " + quoted(part) +
          ": expected KEY=COLUMN, a column by its number from 1 or its name; keys are f, omega, "
          "re, im, -im, magnitude, magnitude_db, phase_deg, phase_rad, sigma and weight");
    for (const auto& [other, of_other] : pairs)
      if (other == key || of_other == column)
        throw std::invalid_argument("--columns " + quoted(part) + ": " + (other == key ? key : column) +
                                    " is given twice");
    pairs.emplace_back(key, column);
    begin = end + 1;
  }
  return pairs;
}

Measurement read_measurement(const std::string& file, const MeasurementOptions& how) {
  const auto bytes = input_text(file);
  const DecodedText text = decoded(bytes);
  Measurement measurement;
  measurement.file = file == "-" ? "standard input" : file;
  measurement.fingerprint = Fingerprint(*bytes).text();
  measurement.how = how;
  if (!text.note.empty() && text.note != "Latin-1") measurement.notes.push_back("text is " + text.note);
  if (!text.is_of_workbook)
    if (const std::string what = foreign_format(*bytes); !what.empty()) throw DataError(measurement.file, 0, 0, what);
  auto found = recognised({measurement.file, *bytes, text.text, how.frequency_unit}, how);
  if (!found) {
    if (is_binary(*text.text))
      throw DataError(measurement.file, 0, 0,
                      "is no text, and no binary file of a known kind (universal file 58b, MAT-file); expected "
                      "a table, as a spreadsheet saves it as CSV");
    measurement.sweeps.push_back({"", false, std::make_shared<const TextTable>(measurement.file, text.text), {}});
    return measurement;
  }
  measurement.format = std::move(found->format);
  measurement.unit = std::move(found->unit);
  for (auto& note : found->notes) measurement.notes.push_back(std::move(note));
  if (found->whole) settle_columns(*found, measurement);
  for (auto& sweep : found->sweeps) {
    Measurement::Sweep& added = measurement.sweeps.emplace_back();
    added.name = std::move(sweep.name);
    added.is_derived = sweep.is_derived;
    if (auto* layout = std::get_if<TextLayout>(&sweep.content)) {
      added.table = std::make_shared<const TextTable>(measurement.file, std::move(*layout));
    } else
      added.curve = std::get<SampledCurve>(std::move(sweep.content));
  }
  return measurement;
}

}  // namespace io
