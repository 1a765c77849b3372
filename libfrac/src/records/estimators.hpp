// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "frac/records/response.hpp"
#include "records/line_noise.hpp"

namespace frac::detail {

/// Variance of each part of a response that several lines or realisations show, and what of it is noise.
struct DistortionLevel {
  double whole = 0, noise = 0;
  double degrees = 0;  // of freedom of `whole`; 0: nothing tells it

  void add(const DistortionLevel& other, double share);
  /// The deviation without the noise, and the ends of its 95 % interval: `whole` over its expectation is chi-square
  /// over its degrees of freedom, and the noise has so many more of them that it counts as known.
  void set(double& value, double& low, double& high) const;
};

/// Points by output, and what is to be said of them.
struct Estimated {
  std::vector<std::vector<ResponsePoint>> outputs;
  std::vector<std::vector<DistortionLevel>> even;  // of each point, where lines tell it
  std::vector<std::string> remarks;
  double periods = 0;
  /// Nothing tells the distortion.
  bool all_lines_excited = false;
};

/// The last whole periods of a record as lines of their Fourier sum, without ramp: input, outputs, reference.
struct PeriodLines {
  std::vector<Spectrum> spectra;
  std::size_t periods = 0;
  double spacing = 0;  // rad/s between lines of the spectra
};
/// @param length   of the period in samples
/// @param highest   line of the period up to which lines are needed; 0: all
/// @param multiple  of which the number of periods is to be one, where the record holds so many
[[nodiscard]] PeriodLines period_lines(const Record& record, double length, std::size_t highest,
                                       std::size_t multiple = 1);

/// @param length  of the period in samples
[[nodiscard]] Estimated periodic_response(const Record& record, double length);
[[nodiscard]] Estimated stepped_sine_response(const Record& record, const std::vector<SineSegment>& segments,
                                              int harmonics);
[[nodiscard]] Estimated arbitrary_response(const Record& record);

/// Whether the last two lines of the period below half the sampling rate hold more of an output than the noise around
/// them explains, by chance once in 1000 records of so many segments, and more than the deviation of a point: then
/// lines above fold back into it.
[[nodiscard]] bool reaches_half_of_sampling(LineReader& reader, const PeriodLines& found, std::size_t output,
                                            const ResponsePoint& point, std::size_t segments);
inline constexpr const char* folds_back =
    "has lines up to half the sampling rate, stronger than its noise: what lies above them folds back (aliasing); "
    "sample faster or through a filter";

/// Sets value, amplitude and the deviations of an output from the lines of all channels, of which 0 is the input.
void set_ratio(const LineEstimate& line, std::size_t output, ResponsePoint& point);
inline void set_distortion(const DistortionLevel& level, ResponsePoint& point) {
  level.set(point.distortion, point.distortion_low, point.distortion_high);
}
inline void set_even_distortion(const DistortionLevel& level, ResponsePoint& point) {
  level.set(point.even_distortion, point.even_distortion_low, point.even_distortion_high);
}
/// Variance of Student's distribution over that of the normal one: from 2 degrees down there is none.
[[nodiscard]] double student_variance(double degrees);

}  // namespace frac::detail
