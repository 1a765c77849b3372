// SPDX-License-Identifier: BSD-3-Clause
#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <limits>
#include <random>
#include <stdexcept>
#include <tuple>
#include <utility>
#include <vector>

#include "base/linear_algebra.hpp"
#include "frac/identification/relaxation_times.hpp"
#include "frac/identification/validate.hpp"
#include "nonnegative.hpp"
#include "peaks.hpp"

namespace frac {
namespace {

using Complex = std::complex<double>;

constexpr Eigen::Index ends = 3;
constexpr double per_decade = 12;
constexpr double margin = 1.5;        // decades beyond the band
constexpr double least_noise = 1e-3;  // share of the response
constexpr double low = 0.025, high = 0.975;

/// Weighted rows of a response that is linear in its ends and in the density at each time.
struct Equations {
  std::vector<double> log_tau;
  std::size_t first_seen, last_seen;  // times within the band
  Eigen::MatrixXd columns;            // at the ends of the size of the others, so that no unit matters
  Eigen::VectorXd end_scale;
  Eigen::VectorXd target;
  Eigen::VectorXd relative;   // what turns a weighted residual into one relative to the response
  Eigen::MatrixXd roughness;  // second differences, the density being 0 beyond the times
  Eigen::MatrixXd shape;      // the density is shape times unknowns, none of them negative
};

/// Beyond the band the density only falls: what the unknowns add holds from a time on to that end of the band.  A peak
/// there would be one more constant (or inductance, or elastance), which the data do not tell from it.
Eigen::MatrixXd falling_beyond(Eigen::Index times, Eigen::Index first_seen, Eigen::Index last_seen) {
  Eigen::MatrixXd shape = Eigen::MatrixXd::Identity(times, times);
  for (Eigen::Index k = 0; k < first_seen; ++k) shape.col(k).segment(k, first_seen - k + 1).setOnes();
  for (Eigen::Index k = last_seen + 1; k < times; ++k) shape.col(k).segment(last_seen, k - last_seen + 1).setOnes();
  return shape;
}

Equations equations(const FrequencyResponseData& data, TimesKernel kernel) {
  const ValidationResult noise = validate(data);
  if (noise.model.empty())
    throw std::invalid_argument("a distribution of times needs 6 points at different frequencies");
  std::vector<std::size_t> kept;
  for (std::size_t i = 0; i < data.size(); ++i)
    if (std::isfinite(noise.deviation[i])) kept.push_back(i);
  double largest = 0;
  for (const Complex& each : data.value()) largest = std::max(largest, std::abs(each));

  Equations made;
  // The ends of the band are times of the grid, so that areas within it end there.
  const double band = std::log(data.omega().back() / data.omega().front());
  const auto steps = static_cast<std::size_t>(std::ceil(band / std::log(10.0) * per_decade));
  const double spacing = band / static_cast<double>(steps);
  made.first_seen = static_cast<std::size_t>(std::ceil(margin * std::log(10.0) / spacing));
  made.last_seen = made.first_seen + steps;
  const auto times = static_cast<Eigen::Index>(made.last_seen + made.first_seen + 1);
  for (Eigen::Index j = 0; j < times; ++j)
    made.log_tau.push_back(-std::log(data.omega().back()) +
                           spacing * static_cast<double>(j - static_cast<Eigen::Index>(made.first_seen)));

  const auto rows = 2 * static_cast<Eigen::Index>(kept.size());
  made.columns.resize(rows, ends + times);
  made.target.resize(rows);
  made.relative.resize(rows);
  for (std::size_t i = 0; i < kept.size(); ++i) {
    const double omega = data.omega()[kept[i]];
    // Times on a grid follow exact data to no better than that.
    const double weight =
        1 / std::max(noise.deviation[kept[i]], least_noise * std::abs(data.value()[kept[i]]) + 1e-12 * largest);
    const auto put = [&](Eigen::Index column, Complex value) {
      made.columns(2 * static_cast<Eigen::Index>(i), column) = weight * value.real();
      made.columns(2 * static_cast<Eigen::Index>(i) + 1, column) = weight * value.imag();
    };
    // A response of 0 is compared with the largest.
    const double size = std::abs(data.value()[kept[i]]);
    made.relative.segment(2 * static_cast<Eigen::Index>(i), 2).setConstant(1 / (weight * (size > 0 ? size : largest)));
    put(0, 1);
    put(1, Complex(0, omega));
    put(2, Complex(0, -1 / omega));
    for (Eigen::Index j = 0; j < times; ++j) {
      const Complex s_tau(0, omega * std::exp(made.log_tau[static_cast<std::size_t>(j)]));
      put(ends + j, spacing * (kernel == TimesKernel::falling ? 1.0 / (1.0 + s_tau) : s_tau / (1.0 + s_tau)));
    }
    made.target(2 * static_cast<Eigen::Index>(i)) = weight * data.value()[kept[i]].real();
    made.target(2 * static_cast<Eigen::Index>(i) + 1) = weight * data.value()[kept[i]].imag();
  }
  const Eigen::RowVectorXd sizes = made.columns.colwise().norm();
  made.end_scale = sizes.tail(times).mean() * sizes.head(ends).cwiseInverse();
  made.columns.leftCols(ends) *= made.end_scale.asDiagonal();
  made.roughness = Eigen::MatrixXd::Zero(times + 2, ends + times);
  for (Eigen::Index i = 0; i < times + 2; ++i)
    for (const auto& [shift, weight] : {std::pair<Eigen::Index, double>{-2, 1}, {-1, -2}, {0, 1}})
      if (i + shift >= 0 && i + shift < times) made.roughness(i, ends + i + shift) = weight / (spacing * spacing);
  // The squares are summed over ln tau.
  made.roughness *= std::sqrt(spacing);
  made.shape =
      falling_beyond(times, static_cast<Eigen::Index>(made.first_seen), static_cast<Eigen::Index>(made.last_seen));
  for (Eigen::MatrixXd* of_density : {&made.columns, &made.roughness})
    of_density->rightCols(times) = (of_density->rightCols(times) * made.shape).eval();
  return made;
}

/// Weights of the roughness: the best, and those that the evidence hardly tells from it.
struct Smoothness {
  double least, best, most;
};

/// The weight of the roughness of the largest evidence: a normal prior on the second differences, noise as given, ends
/// anywhere.  -2 ln p = misfit + smoothness roughness + ln |A'A + smoothness D'D| - times ln smoothness.
Smoothness best_smoothness(const Equations& of, const Eigen::MatrixXd& normal, const Eigen::MatrixXd& rough) {
  const Eigen::VectorXd right = of.columns.transpose() * of.target;
  const double times = static_cast<double>(of.log_tau.size());
  const double scale =
      normal.diagonal().tail(normal.cols() - ends).mean() / rough.diagonal().tail(rough.cols() - ends).mean();
  std::vector<std::pair<double, double>> tried;  // smoothness, -2 ln p
  std::pair<double, double> best{scale, std::numeric_limits<double>::infinity()};
  for (double exponent = -10; exponent <= 4; exponent += 0.5) {
    const double smoothness = scale * std::pow(10, exponent);
    const detail::CholeskyFactor factor(normal + smoothness * rough);
    if (!factor.exists()) continue;
    const double explained = right.dot(factor.solve(right));
    const double log_determinant = 2 * factor.diagonal().array().log().sum();
    const double value = of.target.squaredNorm() - explained + log_determinant - times * std::log(smoothness);
    tried.emplace_back(smoothness, value);
    if (value < best.second) best = tried.back();
  }
  // Two standard deviations of one parameter.
  constexpr double hardly_told = 4;
  Smoothness found{best.first, best.first, best.first};
  for (const auto& [smoothness, value] : tried) {
    if (!(value < best.second + hardly_told)) continue;
    found.least = std::min(found.least, smoothness);
    found.most = std::max(found.most, smoothness);
  }
  return found;
}

/// The smoothest density that follows the data.
struct Solution {
  Eigen::MatrixXd roughness;  // of the prior
  Smoothness smoothness;
  Eigen::MatrixXd hessian;
  Eigen::VectorXd x;
  std::vector<bool> free;
};

Eigen::MatrixXd hessian_of(const Eigen::MatrixXd& normal, const Eigen::MatrixXd& rough, double smoothness) {
  Eigen::MatrixXd hessian = normal + smoothness * rough;
  // Ends that no point sees stay at 0.
  hessian.diagonal().array() += 1e-13 * hessian.diagonal().maxCoeff();
  return hessian;
}

Solution solution(const Equations& of, const Eigen::MatrixXd& normal, Eigen::MatrixXd roughness) {
  Solution made{std::move(roughness), {}, {}, {}, {}};
  const Eigen::MatrixXd rough = made.roughness.transpose() * made.roughness;
  made.smoothness = best_smoothness(of, normal, rough);
  made.hessian = hessian_of(normal, rough, made.smoothness.best);
  made.free.assign(static_cast<std::size_t>(made.hessian.cols()), true);
  made.x = detail::nonnegative_minimum(made.hessian, of.columns.transpose() * of.target, made.free);
  return made;
}

/// Second differences in units of the density around them: that of an arc falls as a power of tau, so that its
/// curvature is in proportion to itself, and one roughness for all would cut its maximum.
Eigen::MatrixXd relative_roughness(const Equations& of, const Eigen::VectorXd& density) {
  constexpr double floor = 0.02;  // of the maximum: less is not told from nothing
  const double top = density.maxCoeff();
  Eigen::MatrixXd result = of.roughness;
  if (!(top > 0)) return result;
  const Eigen::Index last = density.size() - 1;
  for (Eigen::Index i = 0; i < result.rows(); ++i) {
    const Eigen::Index from = std::max<Eigen::Index>(i - 2, 0), to = std::min(i, last);
    result.row(i) *= top / std::max(density.segment(from, to - from + 1).maxCoeff(), floor * top);
  }
  return result;
}

double quantile(std::vector<double> values, double share) {
  std::sort(values.begin(), values.end());
  const double place = share * static_cast<double>(values.size() - 1);
  const auto below = static_cast<std::size_t>(place);
  const std::size_t above = std::min(below + 1, values.size() - 1);
  return values[below] + (place - static_cast<double>(below)) * (values[above] - values[below]);
}

/// A density and its ends.
struct Found {
  std::vector<double> density;
  std::array<double, ends> end;  // constant, inductance, elastance
};

Found found_of(const Equations& of, const Eigen::VectorXd& x) {
  const Eigen::VectorXd density = of.shape * x.tail(of.shape.cols());
  Found found{{density.begin(), density.end()}, {}};
  for (Eigen::Index i = 0; i < ends; ++i) found.end[static_cast<std::size_t>(i)] = x(i) * of.end_scale(i);
  return found;
}

/// Densities that the data, with other noise, and the prior allow as well.
std::vector<Found> drawn_solutions(const Equations& of, const Solution& of_data, std::uint64_t seed) {
  constexpr std::size_t samples = 100;
  std::mt19937_64 engine(seed);
  std::normal_distribution<double> normal_draw;
  std::vector<Found> drawn;
  for (std::size_t k = 0; k < samples; ++k) {
    Eigen::VectorXd moved = of.target, prior(of_data.roughness.rows());
    for (double& each : moved) each += normal_draw(engine);
    for (double& each : prior) each = std::sqrt(of_data.smoothness.best) * normal_draw(engine);
    std::vector<bool> guess = of_data.free;
    drawn.push_back(found_of(
        of, detail::nonnegative_minimum(
                of_data.hessian, of.columns.transpose() * moved + of_data.roughness.transpose() * prior, guess)));
  }
  return drawn;
}

/// Standard deviation of an unknown by data and prior, those at 0 held there.  The prior of a density that may not be
/// negative draws mass into the tails, which an end would pay for: solutions drawn from it lie to one side.
double deviation_of(const Solution& solved, Eigen::Index which) {
  std::vector<Eigen::Index> free;
  Eigen::Index place = -1;
  for (Eigen::Index i = 0; i < solved.x.size(); ++i) {
    if (i == which) place = static_cast<Eigen::Index>(free.size());
    if (i == which || solved.free[static_cast<std::size_t>(i)]) free.push_back(i);
  }
  const Eigen::MatrixXd part = solved.hessian(free, free);
  const Eigen::VectorXd unit = Eigen::VectorXd::Unit(part.rows(), place);
  const Eigen::VectorXd column = detail::CholeskyFactor(part).solve(unit);
  return std::sqrt(column(place));
}

/// With the weights of roughness that the evidence hardly tells from the best.
std::vector<Found> solutions_of_other_weights(const Equations& of, const Eigen::MatrixXd& normal,
                                              const Solution& of_data) {
  const Eigen::MatrixXd rough = of_data.roughness.transpose() * of_data.roughness;
  std::vector<Found> result;
  for (const double smoothness : {of_data.smoothness.least, of_data.smoothness.most}) {
    std::vector<bool> guess = of_data.free;
    result.push_back(found_of(of, detail::nonnegative_minimum(hessian_of(normal, rough, smoothness),
                                                              of.columns.transpose() * of.target, guess)));
  }
  return result;
}

/// A range, with the side to which smoothing has lost something reaching as much further.
std::pair<double, double> widened(std::pair<double, double> range, const std::vector<double>& losses) {
  for (const double lost : losses) (lost > 0 ? range.second : range.first) += lost;
  range.first = std::max(range.first, 0.0);
  return range;
}

/// 95 % of some values.
std::pair<double, double> middle_of(const std::vector<double>& values) {
  return {quantile(values, low), quantile(values, high)};
}

// Found by trial (seeds 20001 to 20060 of tests/benchmarks/times_coverage): what the choice of a prior leaves open.
constexpr double of_prior = 1.4;

/// The range of an area or an end.
/// @param losses  by smoothing, and to other weights of roughness
std::pair<double, double> range_of(double found, const std::pair<double, double>& by_noise,
                                   const std::vector<double>& losses) {
  const auto [lower, upper] = widened(by_noise, losses);
  return {std::max(found - of_prior * (found - std::min(lower, found)), 0.0),
          found + of_prior * (std::max(upper, found) - found)};
}

/// The peaks of a density with the ranges in which those of the drawn ones lie.
/// @param again  the solution as smoothing makes it from its own response
/// @param others  solutions of other weights of roughness; areas reach as far as theirs
std::vector<TimesPeak> peaks_of(const Equations& of, const TimesDistribution& found, const std::vector<Found>& drawn,
                                const Found& again, const std::vector<Found>& others) {
  auto ranges = detail::large_peaks(
      detail::joined_peaks(detail::peak_ranges(found.density), found.density, found.lower, found.upper), of.log_tau,
      found.density);
  // Beyond the band stands what the prior continues, and a density that is largest at an end of the band falls beyond
  // it because it has to.
  std::erase_if(ranges, [&](const auto& range) { return range.top <= of.first_seen || range.top >= of.last_seen; });
  const auto area_of = [&](const std::vector<double>& density, const detail::PeakRange& range) {
    return detail::peak_area(of.log_tau, density,
                             {std::max(range.first, of.first_seen), range.top, std::min(range.last, of.last_seen)});
  };
  std::vector<TimesPeak> peaks;
  for (std::size_t i = 0; i < ranges.size(); ++i) {
    std::vector<double> place, area;
    for (const auto& solution : drawn) {
      const std::vector<double>& each = solution.density;
      // The place of a minimum is as uncertain as the density: each solution has its own.
      const auto minimum_between = [&](std::size_t from, std::size_t to) {
        const auto first = each.begin() + static_cast<std::ptrdiff_t>(from);
        return static_cast<std::size_t>(std::min_element(first, each.begin() + static_cast<std::ptrdiff_t>(to) + 1) -
                                        each.begin());
      };
      detail::PeakRange range = ranges[i];
      if (i > 0) range.first = minimum_between(ranges[i - 1].top, range.top);
      if (i + 1 < ranges.size()) range.last = minimum_between(range.top, ranges[i + 1].top);
      place.push_back(detail::peak_place(of.log_tau, each, range));
      area.push_back(area_of(each, range));
    }
    const double found_area = area_of(found.density, ranges[i]);
    std::vector<double> losses{found_area - area_of(again.density, ranges[i])};
    for (const auto& other : others) losses.push_back(area_of(other.density, ranges[i]) - found_area);
    const auto [lower, upper] = range_of(found_area, middle_of(area), losses);
    // Two nodes in place of a time between them spread it by a variance of up to a quarter of their distance squared,
    // and the response takes such a spread for a time off by as much.
    const std::size_t top = ranges[i].top;
    const double step = of.log_tau[top + 1] - of.log_tau[top];
    const double of_grid = detail::is_narrow(found.density, top) ? step * step / 4 : 0;
    const double at = detail::peak_place(of.log_tau, found.density, ranges[i]);
    peaks.push_back({std::exp(at), found_area, std::exp(std::min(at, quantile(place, low)) - of_grid),
                     std::exp(std::max(at, quantile(place, high)) + of_grid), lower, upper});
  }
  return peaks;
}

}  // namespace

bool TimesDistribution::follows_data() const {
  constexpr double of_grid = 0.01, of_noise = 2, no_response_left = 0.3;
  return misfit <= of_grid || (misfit_in_noise <= of_noise && misfit <= no_response_left);
}

TimesDistribution relaxation_times(const FrequencyResponseData& data, TimesKernel kernel, std::uint64_t seed) {
  const Equations of = equations(data, kernel);
  const Eigen::MatrixXd normal = of.columns.transpose() * of.columns;
  Solution of_data = solution(of, normal, of.roughness);
  constexpr int rounds = 3;  // the scale of the density settles
  for (int round = 0; round < rounds; ++round)
    of_data = solution(of, normal, relative_roughness(of, of.shape * of_data.x.tail(of.shape.cols())));
  const Eigen::VectorXd& best = of_data.x;

  TimesDistribution result{};
  result.kernel = kernel;
  result.smoothness = of_data.smoothness.best;
  const Eigen::VectorXd left = of.columns * best - of.target;
  const auto rows = static_cast<double>(left.size());
  result.misfit_in_noise = std::sqrt(left.squaredNorm() / rows);
  // Both parts of a point make one departure.
  result.misfit = std::sqrt(left.cwiseProduct(of.relative).squaredNorm() / (rows / 2));
  const Found found = found_of(of, best);
  for (const double each : of.log_tau) result.tau.push_back(std::exp(each));
  result.density = found.density;
  const std::vector<Found> drawn = drawn_solutions(of, of_data, seed);
  const std::vector<Found> others = solutions_of_other_weights(of, normal, of_data);
  // The loss of the density by smoothing shows in the loss of its own result: the density found anew
  // from the response of the one that was found.
  std::vector<bool> guess = of_data.free;
  const Found again = found_of(of, detail::nonnegative_minimum(of_data.hessian, normal * best, guess));
  for (std::size_t j = 0; j < result.density.size(); ++j) {
    std::vector<double> values;
    for (const auto& each : drawn) values.push_back(each.density[j]);
    const auto [lower, upper] = widened(middle_of(values), {result.density[j] - again.density[j]});
    result.lower.push_back(lower);
    result.upper.push_back(upper);
  }
  result.peaks = peaks_of(of, result, drawn, again, others);
  const auto range_of_end = [&](std::size_t i) {
    const double deviation =
        of.end_scale(static_cast<Eigen::Index>(i)) * deviation_of(of_data, static_cast<Eigen::Index>(i));
    constexpr double normal_95 = 1.96;
    std::vector<double> losses{found.end[i] - again.end[i]};
    for (const auto& other : others) losses.push_back(other.end[i] - found.end[i]);
    return range_of(found.end[i], {found.end[i] - normal_95 * deviation, found.end[i] + normal_95 * deviation}, losses);
  };
  std::tie(result.constant, result.inductance, result.elastance) = std::tie(found.end[0], found.end[1], found.end[2]);
  std::tie(result.constant_lower, result.constant_upper) = range_of_end(0);
  std::tie(result.inductance_lower, result.inductance_upper) = range_of_end(1);
  std::tie(result.elastance_lower, result.elastance_upper) = range_of_end(2);
  return result;
}

}  // namespace frac
