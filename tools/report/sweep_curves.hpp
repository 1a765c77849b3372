// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <complex>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "backlash/describing_function.hpp"
#include "report/figure.hpp"
#include "report/table.hpp"

namespace report {

/// Whether two neighbouring points lie on one smooth branch: both exact, with the same period and number of impacts.
[[nodiscard]] bool on_one_branch(const backlash::DescribingFunctionPoint& a,
                                 const backlash::DescribingFunctionPoint& b);

/// Phase in degrees, in (-180, 180].
[[nodiscard]] double phase_degrees(std::complex<double> value);
[[nodiscard]] double decibel(std::complex<double> value);

/// A sweep as curves: closed orbits joined within a branch only, single ones and long-time means as points, means with
/// bars.
/// @param place  where a point is drawn; empty: it is not drawn
[[nodiscard]] std::vector<Curve> sweep_curves(
    const backlash::DescribingFunctionSweep& sweep, const std::string& label, const std::string& colour,
    const std::function<std::optional<PlotPoint>(const backlash::DescribingFunctionPoint&)>& place);

/// The family in one table: a name, then the columns of a simulation file.
[[nodiscard]] Table sweep_table(const std::string& name, const std::string& caption,
                                const std::vector<backlash::DescribingFunctionSweep>& sweeps);

}  // namespace report
