// SPDX-License-Identifier: BSD-3-Clause
#include "records/gaps.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "records/estimators.hpp"
#include "special/distributions.hpp"

namespace frac::detail {
namespace {

/// Variance of a weighted mean of two values from their deviations, and its degrees of freedom by Welch and
/// Satterthwaite.
struct MeanVariance {
  double variance, degrees;
  MeanVariance(double first, double degrees_of_first, double second, double degrees_of_second, double share) {
    const double a = share * share * first * first / student_variance(degrees_of_first),
                 b = (1 - share) * (1 - share) * second * second / student_variance(degrees_of_second);
    variance = a + b;
    degrees = variance > 0 ? variance * variance / (a * a / degrees_of_first + b * b / degrees_of_second)
                           : degrees_of_first + degrees_of_second;
  }
  [[nodiscard]] double deviation() const { return std::sqrt(variance * student_variance(degrees)); }
};

bool is_of_one_segment(const ResponsePoint& a, const ResponsePoint& b) {
  constexpr double frequency = 1e-3, amplitude = 0.02;
  return std::abs(a.omega / b.omega - 1) < frequency && std::abs(a.input_amplitude / b.input_amplitude - 1) < amplitude;
}

ResponsePoint joined(const ResponsePoint& a, const ResponsePoint& b) {
  if (!b.flag.empty()) return a;
  if (!a.flag.empty()) return b;
  const double share = a.periods / (a.periods + b.periods);
  const auto mean = [share](auto first, auto second) { return share * first + (1 - share) * second; };
  ResponsePoint point = a;
  point.omega = mean(a.omega, b.omega);
  point.value = mean(a.value, b.value);
  point.input_amplitude = mean(a.input_amplitude, b.input_amplitude);
  point.periods = a.periods + b.periods;
  point.subharmonic = std::max(a.subharmonic, b.subharmonic);
  const MeanVariance re(a.sigma_re, a.degrees, b.sigma_re, b.degrees, share),
      im(a.sigma_im, a.degrees, b.sigma_im, b.degrees, share);
  point.degrees = std::min(re.degrees, im.degrees);
  point.sigma_re = re.deviation();
  point.sigma_im = im.deviation();
  point.sigma = point.noise = std::sqrt(0.5 * (point.sigma_re * point.sigma_re + point.sigma_im * point.sigma_im));
  const auto covariance = [](const ResponsePoint& each) { return each.correlation * each.sigma_re * each.sigma_im; };
  const double size = point.sigma_re * point.sigma_im;
  if (size > 0)
    point.correlation =
        std::clamp((share * share * covariance(a) + (1 - share) * (1 - share) * covariance(b)) / size, -1.0, 1.0);
  point.harmonics.resize(std::min(a.harmonics.size(), b.harmonics.size()));
  for (std::size_t k = 0; k < point.harmonics.size(); ++k) {
    point.harmonics[k].value = mean(a.harmonics[k].value, b.harmonics[k].value);
    point.harmonics[k].sigma = std::hypot(share * a.harmonics[k].sigma, (1 - share) * b.harmonics[k].sigma);
  }
  constexpr double chance = 1e-3, rounding = 1e-9;
  const double apart = std::norm(a.value - b.value), of_errors = 2 * (a.noise * a.noise + b.noise * b.noise);
  if (apart > rounding * rounding * std::norm(point.value) &&
      fisher_f_above(apart / of_errors, 2, a.degrees + b.degrees) < chance) {
    point.flag = "the motion is not steady: it is another one after a gap in the record";
    point.sigma = point.sigma_re = point.sigma_im = point.noise = std::numeric_limits<double>::quiet_NaN();
  }
  return point;
}

}  // namespace

std::vector<Record> stretches(const Record& record) {
  constexpr std::size_t fewest = 16;
  std::vector<Record> found;
  std::size_t first = 0;
  const auto add_up_to = [&](std::size_t end) {
    const auto begin = record.drive().begin() + static_cast<std::ptrdiff_t>(first),
               stop = record.drive().begin() + static_cast<std::ptrdiff_t>(end);
    if (end - first >= fewest && std::any_of(begin, stop, [&](double each) { return each != *begin; }))
      found.push_back(record.part(first, end - first));
    first = end;
  };
  for (const RecordGap& gap : record.gaps()) add_up_to(gap.before);
  add_up_to(record.size());
  return found;
}

Record joined(const Record& record, std::size_t period) {
  // Samples that are kept, and the place of the next one in time.
  std::vector<std::pair<std::size_t, std::size_t>> kept;
  std::size_t first = 0, length = 0, place = 0;
  const auto add_up_to = [&](std::size_t end) {
    const std::size_t skipped = (length % period + period - place % period) % period;
    if (first + skipped < end) {
      kept.emplace_back(first + skipped, end);
      length += end - first - skipped;
    }
    place += end - first;
    first = end;
  };
  for (const RecordGap& gap : record.gaps()) {
    add_up_to(gap.before);
    place += gap.missing;
  }
  add_up_to(record.size());
  const auto of = [&](const std::vector<double>& signal) {
    std::vector<double> whole;
    if (signal.empty()) return whole;
    whole.reserve(length);
    for (const auto& [begin, end] : kept)
      whole.insert(whole.end(), signal.begin() + static_cast<std::ptrdiff_t>(begin),
                   signal.begin() + static_cast<std::ptrdiff_t>(end));
    return whole;
  };
  std::vector<std::vector<double>> outputs;
  for (const auto& output : record.outputs()) outputs.push_back(of(output));
  return {record.sample_time(), of(record.input()), std::move(outputs), of(record.reference())};
}

void join_segments(const std::vector<std::vector<ResponsePoint>>& after,
                   std::vector<std::vector<ResponsePoint>>& before) {
  for (std::size_t output = 0; output < before.size(); ++output) {
    auto& points = before[output];
    auto next = after[output].begin();
    if (!points.empty() && next != after[output].end() && is_of_one_segment(points.back(), *next)) {
      points.back() = joined(points.back(), *next);
      ++next;
    }
    points.insert(points.end(), next, after[output].end());
  }
}

}  // namespace frac::detail
