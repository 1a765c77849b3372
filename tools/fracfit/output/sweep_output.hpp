// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <complex>
#include <string>
#include <vector>

#include "backlash/describing_function.hpp"
#include "backlash/regime_map.hpp"
#include "io/shard.hpp"
#include "output/document.hpp"

namespace fracfit {

/// Columns of a point: those that other programs rely on, or these followed by the ones of --diagnostics.
enum class PointColumns { basic, with_diagnostics };

/// Describing function of the model without inertia.
struct StaticCurve {
  double mass1, mass2;     // kg
  double clearance;        // m
  double force_amplitude;  // N
  std::vector<double> omega;
  std::vector<std::complex<double>> value;  // m/N
};

// The rows refer to what they are made from, which has to outlive them.

/// One row per point.
[[nodiscard]] Document document_of(const backlash::DescribingFunctionSweep& sweep, PointColumns columns);
/// Sweeps that differ in force, clearance or restitution only, told apart by three columns in front.
[[nodiscard]] Document document_of(const std::vector<backlash::DescribingFunctionSweep>& sweeps, PointColumns columns,
                                   const io::Shard& shard);
/// Restitution slowest, all columns of a point.
[[nodiscard]] Document document_of(const backlash::RegimeMap& map, const io::Shard& shard);
/// The columns of a sweep; what the closed form does not know is nan.
[[nodiscard]] Document document_of(const StaticCurve& curve);

/// JSON has the points of each sweep below its scene, with all columns.
[[nodiscard]] std::string sweep_json(const backlash::DescribingFunctionSweep& sweep, const std::string& command);
[[nodiscard]] std::string sweeps_json(const std::vector<backlash::DescribingFunctionSweep>& sweeps,
                                      const std::string& command);
[[nodiscard]] std::string static_curve_json(const StaticCurve& curve, const std::string& command);

}  // namespace fracfit
