// SPDX-License-Identifier: BSD-3-Clause
#include "window_mean.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <limits>
#include <numbers>
#include <numeric>

namespace backlash::detail {
namespace {

constexpr double pi = std::numbers::pi;
constexpr double nan = std::numeric_limits<double>::quiet_NaN();

// A window is lengthened to this many times window_records periods at most, one with few impacts to half as many.
constexpr std::int64_t longest_stride = 128;

// Batches that the window is divided into, and 95 % quantiles F(1, batches - 1) and F(2, 2 (batches - 1)) of the
// squared error of a complex mean over its estimated variance: for errors along a line, and for errors alike in all
// directions.
struct BatchSize {
  int batches;
  double line_quantile;
  double plane_quantile;
};
constexpr std::array<BatchSize, 2> batch_sizes = {
    {{16, 4.543077165217305, 3.3158295010135213}, {8, 5.5914478512207371, 3.7388918324407374}}};

Harmonics mean_harmonics(const WindowRecord& from, const WindowRecord& to, double gamma) {
  // Two integrations by parts over whole periods leave the velocity jumps and the difference of the end states.
  Harmonics result;
  const double scale = 1 / (pi * static_cast<double>(to.period - from.period));
  for (std::size_t i = 0; i < harmonic_orders.size(); ++i) {
    const double k = harmonic_orders[i];
    const std::complex<double> jumps = quarter_turns(harmonic_orders[i], to.jumps.sums()[i] - from.jumps.sums()[i]);
    const std::complex<double> ends(to.strobe.position_rate - from.strobe.position_rate,
                                    k * (to.strobe.position - from.strobe.position));
    result.u[i] = (ends - jumps) * (scale / (k * k));
  }
  result.u1_plus_gamma = result.u[0];
  result.u[0] -= gamma;
  return result;
}

}  // namespace

bool Window::add(const WindowRecord& record, std::int64_t wanted) {
  if (records_.empty()) records_.reserve(window_records + 1);
  if (!takes(record.period)) return true;
  records_.push_back(record);
  const std::int64_t length = record.period - records_.front().period;
  const std::int64_t impacts = record.strobe.impacts - records_.front().strobe.impacts;
  if (records_.size() > window_records / 2 && length >= wanted && impacts >= enough_impacts) return false;
  if (records_.size() <= window_records) return true;
  if (stride_ >= (length >= wanted ? longest_stride / 2 : longest_stride)) return false;
  for (std::size_t i = 0; 2 * i < records_.size(); ++i) records_[i] = records_[2 * i];
  records_.resize(window_records / 2 + 1);
  stride_ *= 2;
  return true;
}

double half_width_of_mean(std::span<const std::complex<double>> deviations) {
  const BatchSize& size = *std::ranges::find(batch_sizes, static_cast<int>(deviations.size()), &BatchSize::batches);
  double squares = 0;               // sum of |deviation|^2
  std::complex<double> pseudo = 0;  // sum of deviation^2, which tells a line from a plane
  for (const std::complex<double> deviation : deviations) {
    squares += std::norm(deviation);
    pseudo += deviation * deviation;
  }
  // The variances along the principal axes are (squares +- |pseudo|)/2: degrees of freedom (sum)^2/(sum of squares)
  // between 1 and 2 (Satterthwaite 1946).
  const double ratio = squares > 0 ? std::norm(pseudo) / (squares * squares) : 1;
  const double degrees = 2 / (1 + std::min(1.0, ratio));
  const double quantile = size.line_quantile + (degrees - 1) * (size.plane_quantile - size.line_quantile);
  return std::sqrt(quantile * squares / (size.batches - 1.0) / size.batches);
}

PeriodMean mean_of_periods(std::span<const std::complex<double>> periods) {
  const auto mean_of = [](std::span<const std::complex<double>> of) {
    return std::accumulate(of.begin(), of.end(), std::complex<double>()) / static_cast<double>(of.size());
  };
  PeriodMean mean{mean_of(periods), 0};
  for (const BatchSize& size : batch_sizes) {
    const std::size_t batches = static_cast<std::size_t>(size.batches), length = periods.size() / batches;
    if (length == 0) continue;
    std::vector<std::complex<double>> deviations;
    for (std::size_t i = 0; i < batches; ++i)
      deviations.push_back(mean_of(periods.subspan(i * length, length)) - mean.value);
    mean.half_width = std::max(mean.half_width, half_width_of_mean(deviations));
  }
  return mean;
}

SteadyState averaged(const std::vector<WindowRecord>& window, const GapMotion& motion) {
  const double gamma = motion.gamma();
  SteadyState steady;
  steady.regime = Regime::averaged;
  steady.period = 0;
  steady.spectral_radius = nan;
  steady.energy_defect = nan;
  steady.lyapunov = nan;
  const auto periods = static_cast<std::int64_t>(window.size()) - 1;
  if (periods < batch_sizes.back().batches) {
    // Too few periods to judge: |U_1| of a motion between the walls lies in [0, 2/pi].
    steady.uncertainty = 4 / pi;
    if (periods < 1) {
      steady.harmonics.u1_plus_gamma = gamma;  // U_1 = 0, the middle of what is possible
      steady.impacts_per_period = nan;
      return steady;
    }
  }
  const WindowRecord& first = window.front();
  const WindowRecord& last = window.back();
  steady.harmonics = mean_harmonics(first, last, gamma);
  const double followed = static_cast<double>(last.period - first.period);
  steady.impacts_per_period = static_cast<double>(last.strobe.impacts - first.strobe.impacts) / followed;
  // The work of the force changes the kinetic energy too, and the mean of a motion that does not close has ends.
  const double squared_speeds = last.jumps.squared_speeds() - first.jumps.squared_speeds();
  const double kinetic = 0.5 * (last.strobe.position_rate * last.strobe.position_rate -
                                first.strobe.position_rate * first.strobe.position_rate);
  const double ends = gamma * (last.strobe.position - first.strobe.position);
  const double work = ends - pi * followed * gamma * steady.harmonics.u[0].imag();
  const double loss = 0.5 * (1 - motion.restitution() * motion.restitution()) * squared_speeds;
  steady.energy_defect = squared_speeds > 0 ? std::abs(work - loss - kinetic) / (0.5 * squared_speeds) : 0;
  steady.lyapunov = (last.log_growth - first.log_growth) / followed;
  if (last.strobe.impacts == first.strobe.impacts) {
    // Nothing was met: so far the motion is free, give or take the drift over the window.
    steady.harmonics = {};
    steady.harmonics.u[0] = -gamma;
  }
  // The ends of a motion that does not close move its mean by as much: two integrations by parts leave (u + j u')/(pi
  // periods) at each.  A slow drift has them the same in every batch, where scatter cannot show them.
  const double drift = (std::abs(last.strobe.position - first.strobe.position) +
                        std::abs(last.strobe.position_rate - first.strobe.position_rate)) /
                       (pi * followed);
  if (periods < batch_sizes.back().batches) return steady;
  steady.uncertainty = 0;
  for (const BatchSize& size : batch_sizes) {
    const std::int64_t length = periods / size.batches;
    if (length == 0) continue;
    std::vector<std::complex<double>> deviations;
    for (int i = 0; i < size.batches; ++i) {
      const auto from = static_cast<std::size_t>(i * length);
      const auto to = static_cast<std::size_t>((i + 1) * length);
      deviations.push_back(mean_harmonics(window[from], window[to], gamma).u[0] - steady.harmonics.u[0]);
    }
    steady.uncertainty = std::max(steady.uncertainty, half_width_of_mean(deviations));
  }
  const double impacts = static_cast<double>(last.strobe.impacts - first.strobe.impacts);
  // Many impacts make the ends part of the scatter that the batches show.
  if (impacts < 2 * followed) steady.uncertainty += drift;
  return steady;
}

}  // namespace backlash::detail
