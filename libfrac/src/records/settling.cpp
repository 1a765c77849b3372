// SPDX-License-Identifier: BSD-3-Clause
#include "records/settling.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <vector>

#include "base/linear_algebra.hpp"
#include "records/whole_periods.hpp"
#include "special/distributions.hpp"

namespace frac::detail {
namespace {

/// In each segment, of each test.
constexpr double chance_of_error = 1e-3;

using Ratios = std::vector<std::complex<double>>;

/// Ratio of an output to the input in each cycle, by output.  Both are least squares through a constant and the first
/// harmonics, because a cycle is no whole number of samples.
std::vector<Ratios> ratios_by_cycle(const Record& record, double period, std::size_t cycles) {
  constexpr std::size_t most_harmonics = 5;
  const auto fewest_samples = static_cast<std::size_t>(period);
  const auto harmonics =
      static_cast<Eigen::Index>(std::clamp<std::size_t>((fewest_samples - 2) / 2, 1, most_harmonics));
  std::vector<Ratios> ratios(record.outputs().size());
  for (std::size_t cycle = 0; cycle < cycles; ++cycle) {
    const auto begin = static_cast<std::size_t>(std::ceil(static_cast<double>(cycle) * period));
    const auto end =
        std::min(static_cast<std::size_t>(std::ceil(static_cast<double>(cycle + 1) * period)), record.size());
    const auto samples = static_cast<Eigen::Index>(end - begin);
    Eigen::MatrixXd terms(samples, 1 + 2 * harmonics);
    for (Eigen::Index i = 0; i < samples; ++i) {
      const double phase =
          2 * std::numbers::pi * std::fmod(static_cast<double>(begin) + static_cast<double>(i), period) / period;
      terms(i, 0) = 1;
      for (Eigen::Index k = 1; k <= harmonics; ++k) {
        terms(i, 2 * k - 1) = std::cos(static_cast<double>(k) * phase);
        terms(i, 2 * k) = std::sin(static_cast<double>(k) * phase);
      }
    }
    const Eigen::MatrixXd squares = terms.transpose() * terms;
    const auto phasor = [&](const std::vector<double>& signal) {
      const Eigen::Map<const Eigen::VectorXd> part(signal.data() + begin, samples);
      const Eigen::VectorXd found = solve_symmetric(squares, terms.transpose() * part);
      return std::complex<double>(found(1), -found(2));
    };
    const std::complex<double> input = phasor(record.input());
    for (std::size_t output = 0; output < ratios.size(); ++output)
      ratios[output].push_back(phasor(record.outputs()[output]) / input);
  }
  return ratios;
}

struct Moments {
  double count;
  std::complex<double> mean;
  double squares;  // sum of those about the mean
};

Moments moments(const Ratios& ratios, std::size_t begin, std::size_t end) {
  Moments found{static_cast<double>(end - begin), 0, 0};
  for (std::size_t i = begin; i < end; ++i) found.mean += ratios[i] / found.count;
  for (std::size_t i = begin; i < end; ++i) found.squares += std::norm(ratios[i] - found.mean);
  return found;
}

/// Chance of a difference of two means as large as this one, where `squares` with `degrees` complex degrees of freedom
/// tell the variance of one value.  What is left of exact records is rounding.
double chance_of(std::complex<double> difference, double size, double share, double squares, double degrees) {
  constexpr double rounding = 1e-9;
  if (std::abs(difference) <= rounding * size) return 1;
  if (squares == 0) return 0;
  return fisher_f_above(std::norm(difference) / share * degrees / squares, 2, 2 * degrees);
}

/// The cycle before which the means differ most from those after it, of those that differ by more than the scatter
/// explains; 0: none.
std::size_t change_in(const std::vector<Ratios>& ratios, std::size_t begin, std::size_t end) {
  // Two cycles or more on each side.
  constexpr std::size_t side = 2;
  if (end < begin + 2 * side) return 0;
  std::size_t found = 0;
  double least = chance_of_error / static_cast<double>(ratios.size() * (end - begin - 2 * side + 1));
  for (const Ratios& each : ratios)
    for (std::size_t split = begin + side; split + side <= end; ++split) {
      const Moments before = moments(each, begin, split), after = moments(each, split, end);
      const double chance =
          chance_of(after.mean - before.mean, std::abs(after.mean), 1 / before.count + 1 / after.count,
                    before.squares + after.squares, before.count + after.count - 2);
      if (chance >= least) continue;
      least = chance;
      found = split;
    }
  return found;
}

}  // namespace

Settling settling_of(const Record& record, double period) {
  Settling found;
  found.cycles = whole_periods(record.size(), period);
  constexpr std::size_t fewest_cycles = 6;
  constexpr double fewest_samples = 4;
  if (found.cycles < fewest_cycles || period < fewest_samples) return found;
  const std::vector<Ratios> ratios = ratios_by_cycle(record, period, found.cycles);
  const auto outputs = static_cast<double>(ratios.size());
  const std::size_t half = found.cycles / 2;
  for (const Ratios& each : ratios) {
    const Moments steady = moments(each, half, found.cycles);
    for (std::size_t i = half; i-- > found.cut;) {
      if (chance_of(each[i] - steady.mean, std::abs(steady.mean), 1 + 1 / steady.count, steady.squares,
                    steady.count - 1) >= chance_of_error / (outputs * static_cast<double>(half)))
        continue;
      found.cut = i + 1;
      break;
    }
  }
  // What changes in the first half belongs to the settling too.
  while (const std::size_t split = change_in(ratios, found.cut, found.cycles)) {
    if (split > half) {
      found.changes_after = split;
      break;
    }
    found.cut = split;
  }
  return found;
}

}  // namespace frac::detail
