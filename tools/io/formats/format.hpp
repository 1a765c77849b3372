// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <complex>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "frac/frequency_unit.hpp"
#include "io/text_table.hpp"

namespace io {

/// A file that is to be recognised.
struct Source {
  std::string file;                         // for messages
  std::string_view bytes;                   // as they stand in the file
  std::shared_ptr<const std::string> text;  // as UTF-8
  std::string frequency_unit = {};          // that the caller tells; empty where the file has to
};

/// A curve of a format that is no table of named columns.
struct SampledCurve {
  std::vector<double> omega;  // rad/s, in the order of the file; 0 where the file has a point at rest
  std::vector<std::complex<double>> value;
  std::string unit;                                                 // of the values; empty where the file gives none
  std::string quantity;                                             // e.g. "S11"
  frac::FrequencyUnit frequency_unit = frac::FrequencyUnit::hertz;  // of the file
};

/// One sweep of a file.
struct Sweep {
  std::string name;  // for the choice among several
  std::variant<TextLayout, SampledCurve> content;
  /// Computed from another sweep of the file, or of less interest, and read only where it is asked for.
  bool is_derived = false;
};

/// What a reader has found.
struct Recognised {
  std::string format;  // for people, e.g. "Gamry ZCURVE"
  std::vector<Sweep> sweeps;
  std::vector<std::string> notes = {};  // what was left out or assumed
  std::string unit = {};                // of the values by the rules of the format, where the names give none
  /// All columns of a table whose sweeps have some of them each: what --columns speaks of.
  std::optional<TextLayout> whole = {};
};

/// A vector of a file of named ones.
struct NamedVector {
  std::string name;
  std::vector<std::complex<double>> values;
  bool is_complex = false;
};
/// The vectors of a MAT-file of level 5, nothing of another file.
/// @throws DataError  it is damaged, of another level, or this program reads none.
[[nodiscard]] std::optional<std::vector<NamedVector>> matlab_vectors(const Source& source);

// Each reader looks at the content alone.  It returns nothing where the file is of another format, and throws DataError
// where it is of this one and damaged or without a spectrum.
[[nodiscard]] std::optional<Recognised> read_gamry(const Source& source);
[[nodiscard]] std::optional<Recognised> read_biologic(const Source& source);
[[nodiscard]] std::optional<Recognised> read_zview(const Source& source);
[[nodiscard]] std::optional<Recognised> read_versastudio(const Source& source);
[[nodiscard]] std::optional<Recognised> read_touchstone(const Source& source);
[[nodiscard]] std::optional<Recognised> read_universal58(const Source& source);
[[nodiscard]] std::optional<Recognised> read_matlab(const Source& source);
/// Tables whose names stand above the rows, wherever in the file, each of them a sweep.  One that is all at one
/// frequency is read only where it is asked for, if another is not.
[[nodiscard]] std::optional<Recognised> read_plain_table(const Source& source);
/// Three columns of numbers without names, where Bode's relation tells f, re, im from f, re, -im and from magnitude and
/// phase, and a phase below 0 that they are no modulus.
[[nodiscard]] std::optional<Recognised> read_nameless_table(const Source& source);
/// As read_plain_table() of tables whose columns the caller tells; they need no names.
/// @param columns  that have to hold numbers, counted from 0; empty where they are told by name
[[nodiscard]] std::optional<Recognised> read_told_table(const Source& source, const std::vector<std::size_t>& columns);

/// "[Hz]" -> "Hz".
[[nodiscard]] std::string_view without_brackets(std::string_view unit);
/// Names of columns from a line of them, and a line of units below it; empty where there is none.
[[nodiscard]] std::vector<TextLayout::Column> named_columns(std::string_view names, char separator, std::size_t line,
                                                            std::string_view units = {});
/// Turns decimal commas into points where the first of the rows has them; says so.
void settle_decimal_commas(TextLayout& layout, Recognised& found);

}  // namespace io
