#pragma once

#include <string>
#include <vector>

namespace io {

/// Samples of a signal at equal steps.
struct Signal {
  std::vector<double> time;  // s, as in the file
  std::vector<double> value;
  double sample_time;  // s
};

/// Reads the columns time_s (or t_s, time, t: seconds) and input (or u, value) of a CSV file; others are ignored.
/// @throws DataError  as TextTable; a column missing; a field that is no finite number; fewer than two rows; steps that
///                    differ by more than a millionth.
[[nodiscard]] Signal read_signal(const std::string& file);

}  // namespace io
