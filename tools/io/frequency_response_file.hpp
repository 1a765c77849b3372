// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "backlash/minus_inverse.hpp"
#include "frac/model/frequency_response_data.hpp"
#include "io/immittance.hpp"
#include "io/measurement.hpp"
#include "io/point_filter.hpp"
#include "io/text_table.hpp"

namespace io {

/// Entry of a header that tells which quantity the values are.
constexpr std::string_view quantity_key = "quantity";

/// Entry of a header that tells where the deviations in a column sigma come from, and what it says where an experiment
/// tells them, as in the tables of `fracfit response`: they are then the whole weight of a point.
constexpr std::string_view sigma_key = "sigma", sigma_is_measured = "measured";

struct FrequencyResponseReadOptions {
  /// Column that weighs the points: a name beginning with sigma, std, standard_deviation or uncertainty holds standard
  /// deviations, any other name weights of the squared residuals (sigma = 1/sqrt(weight)).  Unset: a column named sigma
  /// or weight, if there is one.
  std::optional<std::string> weight_column;
  /// A point is kept when all of these hold.  A row that one on a column leaves out is not read at all.
  std::vector<PointFilter> where;
  /// A file without a phase (or without a magnitude) is read, its values having phase 0 (or magnitude 1); one without a
  /// real part is read with a note, its values having the real part 0.
  bool phase_may_miss = false, magnitude_may_miss = false, real_may_miss = false;
  /// Read only the rows whose columns have these values.
  Metadata rows;
  /// Label of the curve to read, one of curve_labels() without a key column; empty where the file holds one.
  std::string curve;
  /// Rows that repeat the frequencies of others are repeated measurements, not further sweeps.
  bool repeats_are_points = false;
  /// N or -1/N, whichever of both the file holds; unset: as the file has it.  Conditions are on what the file holds.
  std::optional<backlash::Quantity> quantity;
  /// Impedance or admittance, whichever of both the file holds; unset: as the file has it.  A file that does not tell
  /// is taken to hold the other one, with a note.
  std::optional<Immittance> immittance;
  /// What the caller tells of the file; its choice of a sweep is as good as `curve`.
  MeasurementOptions how = {};
};

struct FrequencyResponseFile {
  frac::FrequencyResponseData data;  // omega in rad/s, rising; values in the unit of the file
  // Header lines; of a file with several curves also options.rows, or "curve" with the label; and the scene where
  // columns tell it.
  Metadata metadata;
  std::string value_unit;          // as written in the header, e.g. "m_per_n"; empty when the header gives none
  std::vector<std::string> notes;  // what was assumed, ignored, converted or sorted, one sentence each
  std::string fingerprint;         // of the whole file, see input_text.hpp
  /// How the imaginary part is read with the other sign, as a clause for people; empty: it stands in no column.
  std::string other_sign = {};
  /// -1/N where the header says so, or the unit is N/m; else N, or any other response.
  backlash::Quantity quantity = backlash::Quantity::n;
  std::string symbol = {};       // what the names of the columns speak of, see ColumnMeaning; empty: they do not tell
  bool real_is_missing = false;  // no column holds a real part
};

/// Reads a measured or simulated frequency response.
///
/// Columns are recognised by name, upper or lower case, units after an underscore or in brackets:
///   frequency  omega, w, angular_frequency [rad/s, krad/s];  f, freq, frequency [Hz, kHz, MHz, GHz, mHz, rad/s]
///   value      re, real, re_<unit> and im, imag, im_<unit> (or -im: the negative is stored);
///              or magnitude, mag, abs, gain [any unit or dB] with phase, arg, angle [deg, rad]
///   optional   sigma or weight
/// Instruments' files and their names of columns are known too, see read_measurement() and column_meaning().
/// Units are taken from the names alone, never from the values.  Other columns are ignored, and so are rows at
/// frequency 0, which a note tells. Several curves in one file stand in columns re_<label>, im_<label> (or
/// magnitude_<label>, magnitude_db_<label> with phase_deg_<label>, phase_rad_<label>; sigma_<label>), or in rows told
/// apart by a key column.
/// @throws DataError  as TextTable; a column missing, of unknown unit, or doubled; a field that is no finite number or
/// not in its
///                    range; no point left after the filter.
/// @throws std::invalid_argument  options.weight_column is no column of the file, or the points stem from several
///                                scenes, see scenes_in().
[[nodiscard]] FrequencyResponseFile read_frequency_response(const std::string& file,
                                                            const FrequencyResponseReadOptions& options = {});
/// The same of a file already recognised; `options.how` is then that of the measurement, but for its choice of a sweep.
[[nodiscard]] FrequencyResponseFile read_frequency_response(const Measurement& measurement,
                                                            const FrequencyResponseReadOptions& options = {});

/// Whether a file has deviations that were measured, see sigma_key.
[[nodiscard]] bool has_measured_sigma(const FrequencyResponseFile& file);

/// Whether the header names a command that computes responses, which carry no noise.
[[nodiscard]] bool is_computed(const Metadata& header);

/// The same file with the other quantity in it, with a note: values, sigma, unit and the entry of the header.
/// @throws DataError  no point has one, or the real part is missing.
[[nodiscard]] FrequencyResponseFile in_quantity(FrequencyResponseFile file, backlash::Quantity quantity,
                                                const std::string& name);

/// The same file as this one of both, with a note: values, sigma, unit and symbol.
/// @throws DataError  it holds something else, no point has an inverse, or the real part is missing.
[[nodiscard]] FrequencyResponseFile in_immittance(FrequencyResponseFile file, Immittance wanted,
                                                  const std::string& name);

/// Labels of the curves in a file that holds several, in order of appearance: its sweeps; those of its columns; "Set=3"
/// and so on where rows repeat the frequencies and a column tells the sweeps apart; or the values in the key column
/// unless that is empty.  None where the file holds one curve, or has no such column.
[[nodiscard]] std::vector<std::string> curve_labels(const Measurement& measurement, const std::string& key_column);

/// Cuts a table with curves in columns, or in the rows that a key column tells apart, into a table per curve, so that
/// reading all of them takes time in proportion to the file, not to its square.
void prepare_curves(Measurement& measurement, const std::string& key_column);

/// The scenes of a table of several, as simulate and map write it: rows told apart by columns force_n, clearance_m and
/// restitution.  Each is given by those columns that vary, in order of appearance; none where no column varies.
/// @param where  rows that count, as in FrequencyResponseReadOptions
[[nodiscard]] std::vector<Metadata> scenes_in(const Measurement& measurement,
                                              const std::vector<PointFilter>& where = {});

}  // namespace io
