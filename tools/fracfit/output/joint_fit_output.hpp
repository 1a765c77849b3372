// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "frac/identification/derived.hpp"
#include "frac/identification/joint_fit.hpp"
#include "io/text_table.hpp"

namespace fracfit {

/// What a joint fit was made from.
struct JointRun {
  struct Curve {
    std::size_t points;
    io::Metadata header;
  };
  std::string command;
  std::vector<Curve> curves;  // as in the result
  std::string value_unit;     // empty where the curves give none or not the same
  io::Metadata options;
  std::vector<frac::DerivedQuantity> derived;  // computed for each curve
};

[[nodiscard]] std::string joint_fit_table(const JointRun& run, const frac::JointFitResult& result);
/// Long form: a row per shared parameter, then a row per own parameter of each curve.
[[nodiscard]] std::string joint_fit_csv(const JointRun& run, const frac::JointFitResult& result);
[[nodiscard]] std::string joint_fit_json(const JointRun& run, const frac::JointFitResult& result);

}  // namespace fracfit
