// SPDX-License-Identifier: BSD-3-Clause
// BioLogic EC-Lab (.mpt): the second line tells how many lines the header has, whose last one names the columns.
#include "io/data_error.hpp"
#include "io/fields.hpp"
#include "io/formats/format.hpp"
#include "io/number.hpp"

namespace io {

std::optional<Recognised> read_biologic(const Source& source) {
  LineReader lines(*source.text);
  std::string_view line;
  if (!lines.next(line) || !trimmed(line).starts_with("EC-Lab ASCII")) return std::nullopt;
  const auto length = lines.next(line) && line.find(':') != std::string_view::npos
                          ? parse_count(trimmed(line.substr(line.find(':') + 1)))
                          : std::nullopt;
  if (!length || *length < 3)
    throw DataError(source.file, 2, 1, "found " + quoted(line) + "; expected 'Nb header lines : N'");
  while (lines.number() < *length && lines.next(line)) {
  }
  if (lines.number() < *length || lines.after() >= source.text->size())
    throw DataError(source.file, lines.number(), 0,
                    "ends within the header of " + std::to_string(*length) + " lines; the file is cut off");
  Recognised found{"BioLogic EC-Lab", {}};
  TextLayout layout{source.text, named_columns(line, '\t', lines.number())};
  layout.begin = lines.after();
  layout.end = source.text->size();
  layout.first_line = lines.number() + 1;
  settle_decimal_commas(layout, found);
  found.sweeps.push_back({"", std::move(layout)});
  return found;
}

}  // namespace io
