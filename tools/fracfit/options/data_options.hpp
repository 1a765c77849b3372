// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>

#include "backlash/minus_inverse.hpp"
#include "io/immittance.hpp"
#include "io/measurement.hpp"
#include "options/options.hpp"

namespace fracfit {

// Kinds of data, as messages name them; see Options::settle.
constexpr const char* frequency_response = "a frequency response";
constexpr const char* samples_over_time = "samples over time";

/// --columns and --frequency-unit: what a file does not tell of itself.
void add_file_options(Options& options, io::MeasurementOptions& how);
/// --select: one of the sweeps of a file.
void add_select(Options& options, io::MeasurementOptions& how);

/// --quantity: N or -1/N, whichever of both the file holds.
void add_quantity(Options& options, std::optional<backlash::Quantity>& quantity);

/// --component of commands for which it tells impedance or admittance alone.
Option& add_immittance(Options& options, std::optional<io::Immittance>& immittance);

}  // namespace fracfit
