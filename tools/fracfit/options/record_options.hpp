// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <string>

#include "backlash/rig_record.hpp"
#include "options/options.hpp"
#include "output/document.hpp"

namespace fracfit {

/// Errors of the sensors of a rig, for commands that write records: --sensor-noise, --force-noise, --quantisation,
/// --clip, --sensor-delay, --clock-jitter, --seed.
class RecordOptions {
 public:
  /// @param record  option without which these have no meaning, because it makes the output a record
  void add(Options& options, const std::string& record);
  /// @throws std::invalid_argument  a number that no sensor has; the text names the option.
  void check(const Options& options) const;
  /// Columns time_s, force_n, x1_m, x2_m, and reference_m of a loop that its set-point drives. @throws
  /// std::invalid_argument  as rig_record().
  [[nodiscard]] Rows rows(const backlash::RigMotion& motion, double sample_time) const;

 private:
  backlash::RigSensors sensors_;
  double clip_ = NAN;
};

}  // namespace fracfit
