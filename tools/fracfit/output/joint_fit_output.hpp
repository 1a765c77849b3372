// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "frac/identification/derived.hpp"
#include "frac/identification/joint_fit.hpp"
#include "io/text_table.hpp"
#include "report/figure.hpp"

namespace fracfit {

/// What a joint fit was made from.
struct JointRun {
  struct Curve {
    std::size_t points;
    bool over_time;
    io::Metadata header;
    std::vector<std::pair<std::string, double>> covariates;  // numbers in the header
  };
  std::string command;
  std::string formula;                                                  // without shift factors
  std::vector<Curve> curves = {};                                       // as in the result
  double lower = 0, upper = 0;                                          // of omega over all responses, rad/s
  double longest = 0;                                                   // of all records, s
  frac::FrequencyUnit frequency_unit = frac::FrequencyUnit::rad_per_s;  // Hz where all files have it
  std::string value_unit = {};  // empty where the curves give none or not the same
  io::Metadata options = {};
  std::vector<frac::DerivedQuantity> derived = {};  // computed for each curve
  /// Names in them: parameters, shared ones and those of laws, and what the headers know of a curve.
  std::vector<std::string> derived_from = {};
};

[[nodiscard]] std::string joint_fit_table(const JointRun& run, const frac::JointFitResult& result);
/// Long form: a row per shared parameter, then a row per own parameter of each curve.
[[nodiscard]] std::string joint_fit_csv(const JointRun& run, const frac::JointFitResult& result);
/// Every point moved onto the master curve, with what the fit says there.
/// @param curves  as measured
[[nodiscard]] std::string master_curve_csv(const JointRun& run, const frac::JointFitResult& result,
                                           const std::vector<frac::JointCurve>& curves,
                                           const frac::Realisation& realisation);
[[nodiscard]] report::Figure master_curve_figure(const JointRun& run, const frac::JointFitResult& result,
                                                 const std::vector<frac::JointCurve>& curves,
                                                 const frac::Realisation& realisation);
[[nodiscard]] std::string joint_fit_json(const JointRun& run, const frac::JointFitResult& result);

}  // namespace fracfit
