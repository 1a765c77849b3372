// SPDX-License-Identifier: BSD-3-Clause
// Records over time: the step response of a system by numerical inversion of the Laplace transform, inputs held between
// samples, and noise.
#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "benchmarks/judging/random_numbers.hpp"
#include "benchmarks/judging/systems.hpp"

namespace judging {

/// How a record is measured.
struct RecordSetting {
  int samples = 150;
  /// `step`, `pulse` or `staircase`.
  std::string input = "step";
  /// `none`, `white` or `correlated`.
  std::string noise = "none";
  /// Standard deviation over the largest output.
  double level = 0;
};

struct Record {
  std::vector<double> time;
  std::vector<double> input;
  /// Output with noise, and without.
  std::vector<double> output;
  std::vector<double> exact;
  /// Steps of the input: the sample at which each comes, and its height.
  std::vector<std::pair<std::size_t, double>> steps;
  /// Standard deviation of the noise, and correlation of neighbours.
  double sigma = 0;
  double correlation = 0;
};

/// True for kinds whose step response the inversion reaches: stable or integrating, without many periods of ringing.
bool has_record(const Kind& kind);

/// Response to a unit step at time t after it, 0 before and during a dead time, at 0 the limit from the right. Talbot's
/// contour with 32 nodes in double gives 1e-9 of the largest value where oscillating poles have turned by less than 20
/// rad.
double step_response(const System& system, double t);

/// Sum over the steps of the input of `response`(time since the step).
std::vector<double> respond(const Record& record, const std::function<double(double)>& response);

Record record(const System& system, const RecordSetting& setting, RandomNumbers& random);

}  // namespace judging
