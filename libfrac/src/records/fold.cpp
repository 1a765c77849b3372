// SPDX-License-Identifier: BSD-3-Clause
#include "records/fold.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <utility>

#include "frac/cancellation.hpp"
#include "records/chirp_transform.hpp"

namespace frac::detail {

std::size_t whole_samples(double period, std::size_t samples) {
  const double whole = std::round(period);
  if (!(whole >= 1)) return 0;
  // Quotients of doubles err by 1e-16 of the length.
  constexpr double rounding = 1e-6;
  const double periods = static_cast<double>(samples) / whole;
  return std::abs(period - whole) * periods < rounding ? static_cast<std::size_t>(whole) : 0;
}

std::vector<double> mean_of_blocks(const std::vector<double>& signal, std::size_t end, std::size_t length,
                                   std::size_t blocks) {
  throw_if_cancelled();
  std::vector<double> mean(length);
  const double* block = signal.data() + (end - blocks * length);
  for (std::size_t b = 0; b < blocks; ++b, block += length)
    for (std::size_t i = 0; i < length; ++i) mean[i] += block[i];
  for (double& each : mean) each /= static_cast<double>(blocks);
  return mean;
}

std::optional<FoldedRecord> folded(const Record& record, std::size_t first, std::size_t count, double period) {
  constexpr std::size_t least_periods = 50;
  const std::size_t whole = whole_samples(period, count);
  if (whole == 0 || count <= long_record) return std::nullopt;
  const std::size_t periods = count / whole, blocks = periods / least_periods;
  if (blocks < 2) return std::nullopt;
  const std::size_t length = periods / blocks * whole;
  const auto of = [&](const std::vector<double>& signal) {
    return signal.empty() ? signal : mean_of_blocks(signal, first + count, length, blocks);
  };
  std::vector<std::vector<double>> outputs;
  for (const auto& output : record.outputs()) outputs.push_back(of(output));
  return FoldedRecord{Record(record.sample_time(), of(record.input()), std::move(outputs), of(record.reference())),
                      blocks};
}

bool keeps_to(const std::vector<double>& signal, std::size_t period) {
  const std::size_t half = signal.size() / period / 2;
  if (half < 1) return false;
  const std::vector<double> late = mean_of_blocks(signal, signal.size(), period, half),
                            early = mean_of_blocks(signal, signal.size() - half * period, period, half);
  const auto length = static_cast<double>(period);
  const ChirpTransform transform(period, length, period / 2);
  const auto first = transform(early.data()), second = transform(late.data());
  // A line that turns by the angle a over the signal, and so by a/2 between its halves, loses a^2/12 of its power in
  // the mean.
  double mean = 0, whole = 0, repeated = 0, above = 0, below = 0;
  for (const double each : signal) mean += each / static_cast<double>(signal.size());
  for (const double each : signal) whole += (each - mean) * (each - mean) / static_cast<double>(signal.size());
  for (std::size_t k = 1; k < first.size(); ++k) {
    const double angle = 2 * std::numbers::pi * static_cast<double>(k) / length;
    repeated += 0.5 * std::norm(0.5 * (first[k] + second[k]));
    const double power = std::abs(first[k] * second[k]);
    above += power * angle * std::arg(second[k] * std::conj(first[k]));
    below += power * angle * angle;
  }
  const double delay = above / below, lost = 0.5 * below * (2 * delay) * (2 * delay) / 12;
  constexpr double share = 0.005, rounding = 1e-20;
  return lost <= share * std::max(0.0, whole - repeated) + rounding * whole;
}

}  // namespace frac::detail
