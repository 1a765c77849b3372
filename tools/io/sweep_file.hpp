// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <complex>
#include <string>
#include <string_view>
#include <vector>

#include "backlash/describing_function.hpp"
#include "backlash/two_mass_system.hpp"
#include "io/shard.hpp"
#include "io/text_table.hpp"

namespace io {

/// Version of the program, e.g. "0.1.0".
[[nodiscard]] std::string_view version();

/// The scene of a sweep as key and value, in SI units: what has to be given to make it again.
[[nodiscard]] Metadata scene_of(const backlash::DescribingFunctionSweep& sweep);

/// "# key: value" lines with version, command and scene, which begin every CSV output.
[[nodiscard]] std::string header_lines(const Metadata& scene, const std::string& command);

/// Columns of a point: those that other programs rely on, or these and, after them, even_harmonic_ratio, energy_defect
/// and lyapunov_exponent.
enum class PointColumns { basic, with_diagnostics };
[[nodiscard]] std::string_view point_columns(PointColumns columns);
void append_point(std::string& text, const backlash::DescribingFunctionPoint& point, PointColumns columns);

/// CSV text of a sweep: header lines, then one row per point.
[[nodiscard]] std::string sweep_csv(const backlash::DescribingFunctionSweep& sweep, const std::string& command,
                                    PointColumns columns = PointColumns::basic);

/// CSV text of sweeps that differ in force, clearance or restitution only: header lines with what they share and the
/// shard where there is more than one, then force_n, clearance_m, restitution and the columns of a point, sweep by
/// sweep; a shard ends with its checksum.
[[nodiscard]] std::string sweeps_csv(const std::vector<backlash::DescribingFunctionSweep>& sweeps,
                                     const std::string& command, PointColumns columns, const Shard& shard);

/// The static model's curve in the same columns; what has no meaning for it is nan.
struct StaticCurve {
  double mass1, mass2;     // kg
  double clearance;        // m
  double force_amplitude;  // N
  std::vector<double> omega;
  std::vector<std::complex<double>> value;  // m/N
};
[[nodiscard]] Metadata scene_of(const StaticCurve& curve);
[[nodiscard]] std::string static_curve_csv(const StaticCurve& curve, const std::string& command);

/// Reads back what sweep_csv wrote, with either columns.
/// @throws DataError  as TextTable, or an entry of the scene or of a row missing or invalid.
[[nodiscard]] backlash::DescribingFunctionSweep read_sweep(const std::string& file);

}  // namespace io
