// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <complex>
#include <cstddef>
#include <functional>
#include <string>
#include <vector>

#include "backlash/compliant/compliant_bodies.hpp"
#include "backlash/describing_function.hpp"
#include "backlash/minus_inverse.hpp"
#include "backlash/regime_map.hpp"
#include "io/shard.hpp"
#include "output/document.hpp"

namespace fracfit {

/// Columns of a point: those that other programs rely on, or these followed by the ones of --diagnostics.
enum class PointColumns { basic, with_diagnostics };

/// How points are written.
struct PointForm {
  PointColumns columns = PointColumns::basic;
  /// -1/N has columns of its own unit, nan where N is 0.
  backlash::Quantity quantity = backlash::Quantity::n;
  /// Of -1/N also frequency ratio and loss factor, which x1 of free masses has.
  bool loss_factor = false;
};

/// Describing function of the model without inertia.
struct StaticCurve {
  double mass1, mass2;     // kg
  double clearance;        // m
  double force_amplitude;  // N
  std::vector<double> omega;
  std::vector<std::complex<double>> value;  // m/N
};

/// A table of curves, whether they are computed already or not: what stands around their points.
struct SweepTable {
  io::Metadata head;
  std::vector<std::string> columns;
  PointForm form;
  std::vector<backlash::SweepScene> scenes;  // of each curve
  /// What tells the curve from the others, in front of each of its rows.
  std::function<std::vector<Cell>(std::size_t curve)> in_front;
  io::Shard shard;
};

/// Table of the curves of one scene over restitution, with all columns of a point.
[[nodiscard]] SweepTable map_table(const backlash::MapScene& scene, const std::vector<double>& restitution,
                                   const backlash::SweepOptions& options, const PointForm& form,
                                   const io::Shard& shard);
/// Table of one curve, or of several told apart by force, clearance and restitution.
/// @param all   scenes of all shards
/// @param part  those of this one
[[nodiscard]] SweepTable sweep_table(const std::vector<backlash::SweepScene>& all,
                                     const std::vector<backlash::SweepScene>& part,
                                     const backlash::SweepOptions& options, const PointForm& form,
                                     const io::Shard& shard);

/// Entries of a file about dry friction.
[[nodiscard]] io::Metadata friction_entries(const backlash::CoulombFriction& friction);

/// A curve of bodies whose contacts take time, with the values that tell it from the others of its table.
struct LabelledScene {
  backlash::CompliantScene scene;
  std::vector<double> labels;
};
/// Table of such curves.
/// @param scene    one of them: what of it is no label stands in the head
/// @param part     curves of this shard
/// @param labels   columns of their values
/// @param contact  entries of all of them, see contact_entries() and friction_entries()
[[nodiscard]] SweepTable compliant_table(const backlash::SweepScene& scene, const std::vector<LabelledScene>& part,
                                         const std::vector<std::string>& labels, const io::Metadata& contact,
                                         const backlash::SweepOptions& options, const PointForm& form,
                                         const io::Shard& shard);

// The rows refer to what they are made from, which has to outlive them.

/// Rows of curves of the same width.
/// @param first   curve of the first row
/// @param points  of one curve after the other
[[nodiscard]] Document document_of(const SweepTable& table, std::size_t first, std::size_t width,
                                   const std::vector<backlash::DescribingFunctionPoint>& points);
/// The columns of a sweep; what the closed form does not know is nan.
[[nodiscard]] Document document_of(const StaticCurve& curve, backlash::Quantity quantity);

/// JSON has the points of each sweep below its scene, with all columns of the form.
/// @param contact,contacts  entries in place of the restitution, of each sweep: see contact_entries()
[[nodiscard]] std::string sweep_json(const backlash::DescribingFunctionSweep& sweep, const PointForm& form,
                                     const std::string& command, const io::Metadata& contact = {});
[[nodiscard]] std::string sweeps_json(const std::vector<backlash::DescribingFunctionSweep>& sweeps,
                                      const PointForm& form, const std::string& command,
                                      const std::vector<io::Metadata>& contacts = {});
[[nodiscard]] std::string static_curve_json(const StaticCurve& curve, backlash::Quantity quantity,
                                            const std::string& command);

}  // namespace fracfit
