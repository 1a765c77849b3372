// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "records/estimators.hpp"
#include "records/settling.hpp"
#include "special/distributions.hpp"

namespace frac::detail {
namespace {

/// Whether an output has lines at halves or thirds of the frequency of the input, which the noise around them does not
/// explain: then the motion repeats after so many periods. The chance of a false one is 1e-4 in each segment.
int subharmonic_of(const PeriodLines& found, std::size_t output) {
  constexpr double chance = 1e-4;
  for (const std::size_t order : {2, 3}) {
    // Two periods of the motion have a line between those of its own.
    if (found.periods / order < 2) continue;
    const std::size_t periods = found.periods;
    // The motion's own lines are no noise.
    if (periods % order != 0) continue;
    const std::size_t step = periods / order;
    LineReader reader(found.spectra, step, neighbours_for(step));
    for (std::size_t multiple = 1; multiple < 2 * order; ++multiple) {
      if (multiple % order == 0 || multiple * step >= found.spectra.front().size()) continue;
      const LineEstimate line = reader(multiple * step);
      if (line.degrees == 0) continue;
      const auto at = static_cast<Eigen::Index>(output) + 1;
      const double ratio = std::norm(line.value(at)) / line.covariance(at, at).real();
      // What is left of exact records is rounding.
      constexpr double rounding = 1e-9;
      if (std::abs(line.value(at)) > rounding * std::abs(found.spectra[output + 1][periods]) &&
          fisher_f_above(ratio, 2, 2 * line.degrees) < chance / 6)
        return static_cast<int>(order);
    }
  }
  return 1;
}

/// A point with a flag has no deviation.
void mark_unusable(ResponsePoint& point, const std::string& flag) {
  point.flag = flag;
  point.sigma = point.sigma_re = point.sigma_im = point.noise = std::numeric_limits<double>::quiet_NaN();
}

/// @param segments  of the record
/// @param folds     set where the output has harmonics up to half the sampling rate
ResponsePoint point_of(const PeriodLines& found, std::size_t output, int harmonics, std::size_t segments, bool& folds) {
  ResponsePoint point;
  const std::size_t periods = found.periods;
  point.omega = static_cast<double>(periods) * found.spacing;
  point.periods = static_cast<double>(periods);
  if (periods >= found.spectra.front().size()) {
    point.flag = "the frequency is not below half the sampling rate";
    return point;
  }
  point.subharmonic = subharmonic_of(found, output);
  const std::size_t step = periods / static_cast<std::size_t>(point.subharmonic);
  LineReader reader(found.spectra, step, neighbours_for(step));
  const LineEstimate fundamental = reader(periods);
  set_ratio(fundamental, output, point);
  const std::complex<double> input = fundamental.value(0);
  const auto at = static_cast<Eigen::Index>(output) + 1;
  for (int order = 2; order <= harmonics; ++order) {
    const std::size_t bin = static_cast<std::size_t>(order) * periods;
    if (bin >= found.spectra.front().size()) break;
    const LineEstimate line = reader(bin);
    ResponseHarmonic& harmonic = point.harmonics.emplace_back();
    harmonic.order = order;
    harmonic.value = line.value(at) * std::polar(1.0, -order * std::arg(input)) / std::abs(input);
    if (line.degrees > 0)
      harmonic.sigma =
          std::sqrt(line.covariance(at, at).real() / 2 * student_variance(2 * line.degrees)) / std::abs(input);
  }
  folds = folds || reaches_half_of_sampling(reader, found, output, point, segments);
  return point;
}

}  // namespace

Estimated stepped_sine_response(const Record& record, const std::vector<SineSegment>& segments, int harmonics) {
  Estimated estimated;
  estimated.outputs.resize(record.outputs().size());
  std::size_t shortened = 0, longest_cut = 0, folded = 0;
  for (const SineSegment& segment : segments) {
    const Record whole = record.part(segment.first, segment.count);
    const Settling settling = settling_of(whole, segment.period);
    const auto cut = static_cast<std::size_t>(std::ceil(static_cast<double>(settling.cut) * segment.period));
    const Record part = whole.part(cut, segment.count - cut);
    shortened += settling.cut > 0 ? 1 : 0;
    longest_cut = std::max(longest_cut, settling.cut);
    // Multiples of 2 and 3 have lines at half and at a third of the frequency.
    const std::size_t multiple = static_cast<double>(part.size()) > 18 * segment.period ? 6 : 2;
    const PeriodLines found = period_lines(part, segment.period, 0, multiple);
    bool folds = false;
    for (std::size_t output = 0; output < estimated.outputs.size(); ++output) {
      auto& points = estimated.outputs[output];
      points.push_back(point_of(found, output, harmonics, segments.size(), folds));
      if (settling.changes_after > 0)
        mark_unusable(points.back(), "the motion is not steady: it changes after cycle " +
                                         std::to_string(settling.changes_after) + " of " +
                                         std::to_string(settling.cycles));
    }
    folded += folds ? 1 : 0;
    estimated.periods += static_cast<double>(found.periods);
  }
  if (shortened > 0)
    estimated.remarks.push_back("the first cycles of " + std::to_string(shortened) + " of " +
                                std::to_string(segments.size()) + " segments, at most " + std::to_string(longest_cut) +
                                ", are left out: the motion still settled");
  if (folded > 0)
    estimated.remarks.push_back("an output in " + std::to_string(folded) + " of " + std::to_string(segments.size()) +
                                " segments " + folds_back);
  return estimated;
}

}  // namespace frac::detail
