// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "records/chirp_transform.hpp"
#include "records/estimators.hpp"
#include "records/whole_periods.hpp"
#include "special/distributions.hpp"

namespace frac::detail {
namespace {

/// Mean over one period from a sample on, a polygon between samples.
double period_mean(const double* signal, double length) {
  const auto whole = static_cast<std::size_t>(length);
  const double rest = length - static_cast<double>(whole);
  double sum = 0.5 * signal[0];
  for (std::size_t i = 1; i < whole; ++i) sum += signal[i];
  sum += 0.5 * signal[whole];
  if (rest > 0) sum += rest * (signal[whole] + 0.5 * rest * (signal[whole + 1] - signal[whole]));
  return sum / length;
}

/// Takes the mean away, and the ramp by which periods apart differ.
void level(std::vector<double>& signal, double length, double periods) {
  const std::size_t count = signal.size();
  double slope = 0;
  // The samples a period needs, its end included.
  const std::size_t needed = static_cast<std::size_t>(length) + 2;
  if (periods >= 2 && count > needed) {
    const std::size_t last = count - needed;
    slope =
        (period_mean(signal.data() + last, length) - period_mean(signal.data(), length)) / static_cast<double>(last);
  }
  double sum = 0;
  for (std::size_t i = 0; i < count; ++i) {
    signal[i] -= slope * static_cast<double>(i);
    sum += signal[i];
  }
  for (double& each : signal) each -= sum / static_cast<double>(count);
}

}  // namespace

PeriodLines period_lines(const Record& record, double length, std::size_t highest, std::size_t multiple) {
  PeriodLines lines;
  const double samples = static_cast<double>(record.size());
  lines.periods = whole_periods(record.size(), length);
  if (lines.periods > multiple) lines.periods -= lines.periods % multiple;
  const auto periods = static_cast<double>(lines.periods);
  lines.spacing = 2 * std::numbers::pi / (periods * length * record.sample_time());
  const auto used = static_cast<std::size_t>(std::min(std::round(periods * length), samples));
  // Lines below half the sampling rate, and as far above the highest that is needed as noise is looked for.
  const auto below_half = static_cast<std::size_t>(std::ceil(0.5 * periods * length));
  const std::size_t needed = highest == 0 ? below_half : (highest + 12) * lines.periods + 1;
  const ChirpTransform transform(used, periods * length, std::min(below_half, needed));
  const auto take = [&](const std::vector<double>& signal) {
    std::vector<double> part(signal.end() - static_cast<std::ptrdiff_t>(used), signal.end());
    level(part, length, periods);
    lines.spectra.push_back(transform(part.data()));
  };
  take(record.input());
  for (const auto& output : record.outputs()) take(output);
  if (!record.reference().empty()) take(record.reference());
  return lines;
}

bool reaches_half_of_sampling(LineReader& reader, const PeriodLines& found, std::size_t output,
                              const ResponsePoint& point, std::size_t segments) {
  constexpr std::size_t tested = 2;
  const std::size_t outputs = found.spectra.size() - 1;
  const double chance = 1e-3 / static_cast<double>(tested * segments * outputs);
  const std::size_t lines = (found.spectra.front().size() - 1) / found.periods;
  const auto at = static_cast<Eigen::Index>(output) + 1;
  for (std::size_t k = std::max(lines, tested) + 1 - tested; k <= lines; ++k) {
    const LineEstimate line = reader(k * found.periods);
    if (line.degrees == 0) continue;
    const double size = std::abs(line.value(at)), error = line.covariance(at, at).real();
    if (size > point.input_amplitude * point.sigma_or_rounding() &&
        fisher_f_above(size * size / error, 2, 2 * line.degrees) < chance)
      return true;
  }
  return false;
}

void DistortionLevel::add(const DistortionLevel& other, double share) {
  whole += share * other.whole;
  noise += share * other.noise;
  degrees += other.degrees;
}

void DistortionLevel::set(double& value, double& low, double& high) const {
  if (degrees == 0) return;
  const auto without_noise = [this](double times) { return std::sqrt(std::max(0.0, times * whole - noise)); };
  value = without_noise(1);
  low = without_noise(degrees / chi_squared_quantile(0.975, degrees));
  high = without_noise(degrees / chi_squared_quantile(0.025, degrees));
}

double student_variance(double degrees) {
  return degrees > 2 ? degrees / (degrees - 2) : std::numeric_limits<double>::infinity();
}

// To first order the error of Y/U is (e_y - G e_u)/U.
void set_ratio(const LineEstimate& line, std::size_t output, ResponsePoint& point) {
  const std::complex<double> input = line.value(0);
  const auto at = static_cast<Eigen::Index>(output) + 1;
  point.value = line.value(at) / input;
  point.input_amplitude = std::abs(input);
  if (line.degrees == 0) {
    point.flag = "too few lines between those of the period to tell the noise";
    return;
  }
  Eigen::VectorXcd weights = Eigen::VectorXcd::Zero(line.value.size());
  weights(0) = -point.value / input;
  weights(at) = 1.0 / input;
  const LineEstimate::Parts parts = line.parts(weights);
  point.degrees = parts.degrees;
  const double mean = 0.5 * (parts.variance_re + parts.variance_im);
  point.sigma = std::sqrt(mean * student_variance(2 * line.degrees));
  point.noise = point.sigma;
  point.sigma_re = std::sqrt(parts.variance_re * student_variance(parts.degrees));
  point.sigma_im = std::sqrt(parts.variance_im * student_variance(parts.degrees));
  if (parts.variance_re > 0 && parts.variance_im > 0)
    point.correlation = std::clamp(parts.covariance / std::sqrt(parts.variance_re * parts.variance_im), -1.0, 1.0);
}

}  // namespace frac::detail
