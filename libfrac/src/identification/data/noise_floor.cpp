// SPDX-License-Identifier: BSD-3-Clause
#include "noise_floor.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>
#include <vector>

#include "base/median.hpp"
#include "base/wide_vectors.hpp"
#include "identification/data/fit_data.hpp"
#include "identification/data/local_curve.hpp"
#include "identification/data/residual_rule.hpp"

namespace frac::detail {
namespace {

constexpr double degrees = 4;  // of Student's t

/// A weighted sum of values at neighbouring points, which is small for a smooth curve.
struct Change {
  std::complex<double> size;
  std::array<std::pair<std::size_t, double>, 1 + LocalCurve::most_neighbours> shares;  // of its variance, by point
  std::size_t count;
};

// Changes are handed on one after the other: kept, they would take a hundred times the memory of the data.

/// Visits the distances of residuals from the line through both neighbours.
template <typename Visit>
void for_each_change(const FrequencyResponseData& data, std::span<const std::complex<double>> model,
                     const Visit& visit) {
  const auto& omega = data.omega();
  for (std::size_t i = 1; i + 1 < omega.size(); ++i) {
    const double width = std::log(omega[i + 1] / omega[i - 1]);
    const double right = width > 0 ? std::log(omega[i] / omega[i - 1]) / width : 0.5, left = 1 - right;
    const auto rest = [&](std::size_t k) { return model[k] - data.value()[k]; };
    visit(Change{rest(i) - left * rest(i - 1) - right * rest(i + 1),
                 {{{i, 1}, {i - 1, left * left}, {i + 1, right * right}}},
                 3});
  }
}

/// Changes that tell a floor to some per cent.
constexpr std::size_t enough = 40'000;

/// Visits the distances of values from the curve through their neighbours; of very many those of some, for a first
/// floor.
template <typename Visit>
void for_each_change(const FrequencyResponseData& data, const Visit& visit) {
  std::vector<double> log_omega;
  std::vector<std::size_t> all;
  for (const double omega : data.omega()) {
    all.push_back(log_omega.size());
    log_omega.push_back(std::log(omega));
  }
  for (std::size_t i = 2, every = 1 + all.size() / enough; i + 2 < all.size(); i += every) {
    const LocalCurve curve = local_curve(log_omega, all, i);
    if (!std::isfinite(curve.noise)) continue;  // among repeats
    Change change{data.value()[i], {{{i, 1}}}, 1};
    for (std::size_t k = 0; k < curve.count; ++k) {
      change.size -= curve.weight[k] * data.value()[curve.neighbour[k]];
      change.shares[change.count++] = {curve.neighbour[k], curve.weight[k] * curve.weight[k]};
    }
    visit(change);
  }
}

/// Squares of changes, and their variances for noise of the size of the values and for noise of size 1.
struct Squares {
  std::vector<double> size, relative, absolute;
};

/// About `count` of them, spread evenly.
Squares spread_over(const Squares& all, std::size_t count) {
  // Odd, so that real and imaginary parts, which take turns, are both among them.
  const std::size_t every = all.size.size() / count | 1;
  Squares some;
  for (std::size_t i = 0; i < all.size.size(); i += every) {
    some.size.push_back(all.size[i]);
    some.relative.push_back(all.relative[i]);
    some.absolute.push_back(all.absolute[i]);
  }
  return some;
}

/// Sum of logarithms of numbers from 1e-30 to 1e30, eight of which take one logarithm.
class LogSum {
 public:
  void add(double number) {
    product_ *= number;
    if (++count_ % 8 == 0) {
      sum_ += std::log(product_);
      product_ = 1;
    }
  }
  [[nodiscard]] double value() const { return sum_ + std::log(product_); }

 private:
  double product_ = 1, sum_ = 0;
  int count_ = 0;
};

/// The scale of Student's t that fits squares best.  The likelihood is concave in its logarithm, so that Newton's steps
/// from the median, some three of them, end there.
double scale_of(std::span<const double> ratio) {
  constexpr double median_of_t = 0.55, largest_step = 2, smallest_step = 1e-3;
  constexpr int most_steps = 50;
  constexpr std::size_t lanes = 8;
  // That of some thousand is known to some per cent, a fraction of the first step.
  constexpr std::size_t enough = 4000;
  std::vector<double> some;
  for (std::size_t i = 0, every = 1 + ratio.size() / enough; i < ratio.size(); i += every) some.push_back(ratio[i]);
  double scale = median(std::move(some)) / median_of_t;
  for (int count = 0; count < most_steps; ++count) {
    std::array<double, lanes> slopes{}, bends{};
    with_wide_vectors([&]() FRACFIT_INLINE {
      const auto add = [&](std::size_t i, std::size_t lane) FRACFIT_INLINE {
        const double share = ratio[i] / (degrees * scale + ratio[i]);
        slopes[lane] += share;
        bends[lane] += share * (1 - share);
      };
      std::size_t i = 0;
      for (; i + lanes <= ratio.size(); i += lanes)
        for (std::size_t lane = 0; lane < lanes; ++lane) add(i + lane, lane);
      for (; i < ratio.size(); ++i) add(i, 0);
    });
    const double slope = std::accumulate(slopes.begin(), slopes.end(), 0.0),
                 bend = std::accumulate(bends.begin(), bends.end(), 0.0);
    const double step = (slope - static_cast<double>(ratio.size()) / (degrees + 1)) / bend;
    scale *= std::exp(std::clamp(step, -largest_step, largest_step));
    if (std::abs(step) < smallest_step) break;
  }
  return scale;
}

/// Logarithm of the likelihood of changes at its best r.
double likelihood(const Squares& all, double floor) {
  std::vector<double> ratio(all.size.size());  // squared size over its variance for r = 1
  LogSum variances, tails;
  for (std::size_t i = 0; i < ratio.size(); ++i) {
    const double variance = all.relative[i] + floor * floor * all.absolute[i];
    ratio[i] = all.size[i] / variance;
    variances.add(variance);
  }
  const double scale = scale_of(ratio);
  for (const double each : ratio) tails.add(1 + each / (degrees * scale));
  return -0.5 *
         (variances.value() + static_cast<double>(ratio.size()) * std::log(scale) + (degrees + 1) * tails.value());
}

/// The step that real and imaginary parts are whole numbers of, as an instrument with an analogue-to-digital converter
/// writes them; 0 where there is none that a fit could notice.
double step_of(const FrequencyResponseData& data, double largest) {
  constexpr double unnoticed = 1e-6;  // of the largest value
  constexpr double rounding = 1e-3;   // of a step, of numbers in text
  std::vector<double> parts;
  const auto smallest_difference = [&](std::size_t every) {
    parts.assign(1, 0);
    for (std::size_t i = 0; i < data.size(); i += every) {
      parts.push_back(std::abs(data.value()[i].real()));
      parts.push_back(std::abs(data.value()[i].imag()));
    }
    std::sort(parts.begin(), parts.end());
    double smallest = 0;
    for (std::size_t i = 1; i < parts.size(); ++i) {
      const double difference = parts[i] - parts[i - 1];
      if (difference > 1e-9 * largest && (smallest == 0 || difference < smallest)) smallest = difference;
    }
    return smallest;
  };
  // Some thousand values on no step are that near to each other, which spares sorting all of very many.
  constexpr std::size_t enough = 4000;
  const std::size_t every = 1 + data.size() / enough;
  const double among_some = every > 1 ? smallest_difference(every) : 0;
  if (among_some > 0 && among_some <= unnoticed * largest) return 0;
  const double step = smallest_difference(1);
  const auto is_multiple = [&](double part) { return std::abs(part / step - std::round(part / step)) < rounding; };
  return step > unnoticed * largest && std::all_of(parts.begin(), parts.end(), is_multiple) ? step : 0;
}

/// Whether neighbouring changes, in units of their deviations, are alike.  Those of noise are not: distances from the
/// line through both neighbours have a correlation of -2/3 where the noise is white and of -1/2 where its own is nearly
/// 1.  What a model misses smoothly makes neighbouring distances alike.
/// @param parts  interleaved, the real and the imaginary one
bool are_alike(const Squares& all, std::span<const double> change, std::size_t parts, double floor) {
  const auto over = [&](std::size_t i) {
    return change[i] / std::sqrt(all.relative[i] + floor * floor * all.absolute[i]);
  };
  double product = 0;
  for (std::size_t i = parts; i < change.size(); ++i) product += over(i) * over(i - parts);
  return product > 0;
}

/// @param size     of the values, whose noise is sought
/// @param of_residuals  whether changes are those of residuals
/// @param changes  hands each change to what it is given
template <typename Changes>
double floor_of(const FrequencyResponseData& data, std::span<const std::complex<double>> size, Component component,
                bool of_residuals, const Changes& changes) {
  // In units of the largest value, so that no square overflows.
  double largest = 0;
  for (const std::complex<double> each : data.value()) largest = std::max(largest, std::abs(each));
  std::vector<double> square;
  double smallest = largest;
  for (std::size_t i = 0; i < data.size(); ++i) {
    const double of_model = std::max(std::abs(size[i]), 1e-12 * largest);
    smallest = std::min({smallest, of_model, std::max(std::abs(data.value()[i]), 1e-12 * largest)});
    square.push_back(std::pow(of_model / largest, 2));
  }
  // Where values stay on one step, changes hide the rounding, whose error is even within half a step.
  const double rounded = std::pow(step_of(data, largest) / largest, 2) / 12;
  std::vector<double> changed, change;
  Squares all;
  changes([&](const Change& each) {
    double relative = 0, absolute = 0;
    for (std::size_t k = 0; k < each.count; ++k) {
      relative += each.shares[k].second * square[each.shares[k].first];
      absolute += each.shares[k].second;
    }
    for (const bool real : {true, false}) {
      if (component == (real ? Component::imaginary : Component::real)) continue;
      change.push_back((real ? each.size.real() : each.size.imag()) / largest);
      all.size.push_back(std::max(std::pow(change.back(), 2), rounded * absolute));
      all.relative.push_back(relative);
      all.absolute.push_back(absolute);
      changed.push_back(all.size.back() / square[each.shares[0].first]);
    }
  });
  // Values that follow a curve to within rounding show no noise.
  constexpr double rounding = 1e-10;
  if (changed.empty() || !(median(std::move(changed)) > rounding * rounding)) return 0;

  // Some of very many changes tell about where the likelihood of all is highest.
  const Squares some = spread_over(all, enough);
  constexpr double no_floor = -std::numeric_limits<double>::infinity();
  double best = no_floor, highest = likelihood(some, 0);  // best: the logarithm of the floor
  const auto try_floor = [&](const Squares& among, double log_floor) {
    const double here = likelihood(among, std::exp(log_floor));
    if (!(here > highest)) return;
    highest = here;
    best = log_floor;
  };
  // A likelihood has no finer structure than the floor's own uncertainty, which is no less than a twentieth.
  const double first = std::log(smallest / largest / 10), last = std::log(30.0);
  const int steps = static_cast<int>(last - first) + 1;
  for (int i = 0; i <= steps; ++i) try_floor(some, first + (last - first) * i / steps);
  if (best == no_floor) return 0;
  const double about = best;
  for (const double shift : {-0.75, -0.5, -0.25, 0.25, 0.5, 0.75}) try_floor(some, about + shift);
  const double near = best, none = likelihood(all, 0);
  highest = likelihood(all, std::exp(near));
  for (const double shift : {-0.12, 0.12}) try_floor(all, near + shift);
  // A floor that is found where there is none is small and does little harm; one that is missed makes intervals wrong.
  constexpr double clearly = 2;
  if (!(highest - none > clearly)) return 0;
  // Changes of residuals that follow each other are no noise, and tell no floor of it.  Those of the values themselves
  // are also what the curve through few neighbours misses, and a first floor of them does little harm.
  const bool misfit = of_residuals && are_alike(all, change, component == Component::both ? 2 : 1, std::exp(best));
  return misfit ? 0 : std::exp(best) * largest;
}

bool tells_a_floor(const FrequencyResponseData& data, Component component) {
  constexpr std::size_t fewest = 12;
  return data.size() >= fewest && component != Component::magnitude && component != Component::phase;
}

}  // namespace

double noise_floor(const FrequencyResponseData& data, std::span<const std::complex<double>> model,
                   Component component) {
  if (!tells_a_floor(data, component)) return 0;
  const ResidualForm form = residual_form(component, Weight::learned);
  std::vector<std::complex<double>> size;
  for (std::size_t i = 0; i < model.size(); ++i) size.push_back(seen_of(form, model[i], data.value()[i]));
  return floor_of(data, size, component, true, [&](const auto& visit) { for_each_change(data, model, visit); });
}

double noise_floor(const FrequencyResponseData& data, Component component) {
  if (!tells_a_floor(data, component)) return 0;
  return floor_of(data, data.value(), component, false, [&](const auto& visit) { for_each_change(data, visit); });
}

}  // namespace frac::detail
