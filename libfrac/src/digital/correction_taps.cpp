// SPDX-License-Identifier: BSD-3-Clause
#include "correction_taps.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <complex>
#include <iterator>
#include <numbers>
#include <optional>
#include <utility>

#include "base/linear_algebra.hpp"

namespace frac::detail {
namespace {

using Complex = std::complex<double>;

constexpr int band_points = 26;
constexpr int beyond_points = 28;
constexpr int points = band_points + beyond_points;
constexpr int tap_counts[] = {3, 5, 7, 9, 13};
// More taps are tried until the gain beyond the band is below the first number; they are taken where they lower it to
// this share at least.
constexpr double small_amplification = 1.25;
constexpr double worthwhile = 0.93;

// The ratio of the discretised operator, s by the backward difference to `power` times the integrators, to the exact
// one.
Complex rules(const SplitOrder& order, double power, double x) {
  return std::polar(std::pow(std::sin(x) / x, power) * std::pow(x / std::tan(x), order.integrators), -power * x);
}

// The same beyond the band, where the sections are no longer s^fractional and are taken as they are.  A falling power
// is related to the exact one at the edge of the band.
Complex as_built(const CorrectionTask& task, double x) {
  const Complex delta = 2 * std::sin(x) * Complex(-std::sin(x), std::cos(x));
  const Complex exact = std::polar(std::pow(2 * x / task.sample_time, task.order.fractional),
                                   task.order.fractional * std::numbers::pi / 2);
  const double order = task.order.fractional + task.order.differences - task.order.integrators;
  const double fall = std::pow(x / task.edge, std::min(order, 0.0));
  return fall * rules(task.order, task.order.differences, x) * task.sections->response(delta) / exact;
}

// Makes the largest of |C R - 1| on the band and stress |C R| beyond it least, for a given number of taps.
class MinimaxTaps {
 public:
  MinimaxTaps(const CorrectionTask& task, int taps) : rows_(2 * points, taps) {
    constexpr double nyquist = std::numbers::pi / 2;
    const double edge = task.edge;
    for (int i = 0; i < points; ++i) {
      const bool is_band = i < band_points;
      // Towards the edge, where the error is largest, they lie closer; half a step keeps clear of x = 0.
      const double x = is_band ? edge * std::sin(nyquist * (i + 0.5) / (band_points - 0.5))
                               : edge + (nyquist - edge) * (i - band_points + 1.0) / beyond_points;
      const Complex left =
          is_band ? rules(task.order, task.order.fractional + task.order.differences, x) : as_built(task, x);
      for (int k = 0; k < taps; ++k) {
        const Complex value = left * std::polar(1.0, -2 * k * x);
        rows_(2 * i, k) = value.real();
        rows_(2 * i + 1, k) = value.imag();
      }
    }
  }

  [[nodiscard]] CorrectionTaps solved(double stress) const {
    Eigen::MatrixXd stressed = rows_;
    stressed.bottomRows(2 * beyond_points) *= stress;
    const PlainQr factors(stressed);
    const Eigen::MatrixXd basis = factors.basis();
    Eigen::VectorXd wanted = Eigen::VectorXd::Zero(2 * points);
    for (int i = 0; i < band_points; ++i) wanted[2 * i] = 1;

    // Weights of Lawson (1961), for complex functions Ellacott and Williams (1976): each point's is multiplied by the
    // error it is left with.
    const Eigen::Index size = rows_.cols();
    Eigen::VectorXd weight = Eigen::VectorXd::Ones(points);
    Eigen::VectorXd best = Eigen::VectorXd::Zero(size);
    Eigen::VectorXd residual(2 * points), error(points);
    Eigen::MatrixXd weighted(size, 2 * points), normal(size, size);
    double least = INFINITY;
    for (int iteration = 0; iteration < 25; ++iteration) {
      for (int i = 0; i < points; ++i) {
        weighted.middleCols<2>(2 * i) = std::sqrt(weight[i]) * basis.middleRows<2>(2 * i).transpose();
      }
      normal.setZero();
      normal.selfadjointView<Eigen::Lower>().rankUpdate(weighted);
      residual.setZero();
      for (int i = 0; i < band_points; ++i) residual[2 * i] = std::sqrt(weight[i]);
      const Eigen::VectorXd coefficients = solve_symmetric(normal, weighted * residual);
      residual = basis * coefficients - wanted;
      for (int i = 0; i < points; ++i) error[i] = residual.segment<2>(2 * i).norm();
      const double largest = error.maxCoeff();
      if (largest < least) {
        least = largest;
        best = coefficients;
      }
      if (!(largest > 0)) break;
      weight.array() *= error.array() / largest + 1e-6;
      weight *= points / weight.sum();
    }
    const Eigen::VectorXd taps = factors.solve_triangle(best);
    CorrectionTaps result{{taps.data(), taps.data() + taps.size()}, 0, 0};
    const Eigen::VectorXd values = rows_ * taps;
    for (int i = 0; i < points; ++i) {
      const Complex value(values[2 * i], values[2 * i + 1]);
      if (i < band_points) {
        result.error = std::max(result.error, std::abs(value - 1.0));
      } else {
        result.amplification = std::max(result.amplification, std::abs(value));
      }
    }
    return result;
  }

 private:
  Eigen::MatrixXd rows_;  // real and imaginary part of z^-k R
};

// Returns the taps of least error among those within `most_amplification`.
CorrectionTaps within_amplification(const MinimaxTaps& problem, double stress, CorrectionTaps wild,
                                    double most_amplification) {
  // The error rises and the amplification falls with the stress, so the stress is found as a root in logarithms; the
  // feasible end of its bracket is kept.
  const auto excess_of = [&](const CorrectionTaps& each) { return std::log(each.amplification / most_amplification); };
  double low = std::log(stress), low_excess = excess_of(wild);
  double high = low, high_excess = low_excess;
  CorrectionTaps best = std::move(wild);
  for (int i = 0; i < 10 && high_excess > 0; ++i) {
    low = high;
    low_excess = high_excess;
    // The amplification falls about as the cube root of the stress.
    high += std::max(3 * high_excess, 0.05);
    best = problem.solved(std::exp(high));
    high_excess = excess_of(best);
  }
  constexpr double close = 0.01;
  for (int i = 0; i < 4 && high_excess < -close && low_excess > 0; ++i) {
    const double middle = low + (high - low) * std::clamp(low_excess / (low_excess - high_excess), 0.1, 0.9);
    CorrectionTaps next = problem.solved(std::exp(middle));
    const double excess = excess_of(next);
    if (excess > 0) {
      low = middle;
      low_excess = excess;
    } else {
      high = middle;
      high_excess = excess;
      if (next.error < best.error) best = std::move(next);
    }
  }
  return best;
}

// Lowers the amplification while the error stays within the tolerance.  The error reaches the tolerance where stress =
// tolerance/amplification.
CorrectionTaps calmed(const MinimaxTaps& problem, CorrectionTaps result, double tolerance) {
  for (int i = 0; i < 3; ++i) {
    CorrectionTaps calmer = problem.solved(tolerance / result.amplification);
    if (!(calmer.error <= tolerance && calmer.amplification < 0.98 * result.amplification)) break;
    result = std::move(calmer);
  }
  return result;
}

// Returns the taps of least gain beyond the band, which is at most `most_amplification`.
CorrectionTaps least_amplification(const CorrectionTask& task, double tolerance, double most_amplification) {
  const int most_taps = *std::rbegin(tap_counts);
  std::optional<CorrectionTaps> best;  // within the tolerance
  for (const int taps : tap_counts) {
    const MinimaxTaps problem(task, taps);
    const double stress = tolerance / (best ? worthwhile * best->amplification : most_amplification);
    CorrectionTaps next = problem.solved(stress);
    if (next.error <= tolerance) {
      best = calmed(problem, std::move(next), tolerance);
      if (best->amplification <= small_amplification) break;
    } else if (taps == most_taps && !best) {
      return next.amplification <= most_amplification
                 ? next
                 : within_amplification(problem, stress, std::move(next), most_amplification);
    }
  }
  return *best;
}

}  // namespace

CorrectionTaps correction_taps(const CorrectionTask& task, double tolerance, const DirectLimits& limits) {
  const SplitOrder& order = task.order;
  if (order.fractional == 0 && order.differences == 0 && order.integrators == 0) return {{1}, 0, 1};
  CorrectionTaps widest = least_amplification(task, tolerance, limits.amplification);
  if (!std::isfinite(limits.swing) || order.fractional <= 0) return widest;
  const auto swing_of = [&](const CorrectionTaps& each) {
    return step_swing(*task.sections, each.taps, limits.lag_share);
  };
  double swing = swing_of(widest);
  if (swing <= limits.swing) return widest;
  // Less gain swings less, down to where the response ahead of the edge begins to bend; there is no order beyond that.
  std::vector<std::pair<double, CorrectionTaps>> tried{{swing, widest}};
  for (const double amplification : {3.0, 2.2, 1.7, 1.5, 1.35, 1.25, 1.15, 1.07}) {
    if (amplification >= widest.amplification) continue;
    CorrectionTaps next = least_amplification(task, tolerance, amplification);
    swing = swing_of(next);
    if (swing <= limits.swing) return next;
    tried.emplace_back(swing, std::move(next));
  }
  // They stand by rising error: takes the first that is about as calm as the calmest.
  constexpr double about = 1.1;
  const double calmest = std::min_element(tried.begin(), tried.end(), [](const auto& one, const auto& other) {
                           return one.first < other.first;
                         })->first;
  return std::find_if(tried.begin(), tried.end(), [&](const auto& each) { return each.first <= about * calmest; })
      ->second;
}

double step_swing(const ParallelSections& sections, const std::vector<double>& taps, double lag_share) {
  constexpr std::size_t samples = 48;
  std::vector<double> state(sections.rates.size(), 0.0);
  double x = 0, lagged = 0, peak = 0, least = 0, swing = 0;
  for (std::size_t n = 0; n < samples; ++n) {
    if (n < taps.size()) x += taps[n];
    double value = sections.direct * x;
    for (std::size_t i = 0; i < state.size(); ++i) {
      const double change = x - sections.rates[i] * state[i];
      value += sections.weights[i] * (sections.output == SectionOutput::state ? state[i] : change);
      state[i] += change;
    }
    lagged += lag_share * (value - lagged);
    if (lagged > peak) {
      peak = least = lagged;
      swing = 0;
    }
    least = std::min(least, lagged);
    swing = std::max(swing, lagged - least);
  }
  return peak > 0 ? swing / peak : 0;
}

}  // namespace frac::detail
