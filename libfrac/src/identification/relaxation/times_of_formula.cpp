// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>
#include <utility>

#include "cut_value.hpp"
#include "frac/identification/relaxation_times.hpp"
#include "frac/identification/statistics.hpp"
#include "peaks.hpp"

namespace frac {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

std::vector<double> logarithms(std::span<const double> tau) {
  if (tau.size() < 3) throw std::invalid_argument("tau needs at least 3 values");
  std::vector<double> result;
  for (std::size_t i = 0; i < tau.size(); ++i) {
    if (!(tau[i] > 0) || !std::isfinite(tau[i]) || (i > 0 && !(tau[i] > tau[i - 1])))
      throw std::invalid_argument("tau[" + std::to_string(i) + "] = " + std::to_string(tau[i]) +
                                  " must be positive and rising");
    result.push_back(std::log(tau[i]));
  }
  return result;
}

double sign_of(TimesKernel kernel) {
  return kernel == TimesKernel::falling ? 1 : -1;
}

/// Real poles: zeros of 1/Z on the cut.  Beside a continuous part Im 1/Z does not vanish, and Re 1/Z changes sign
/// without a pole.
class Lines {
 public:
  Lines(detail::CutValue value, double sign) : value_(std::move(value)), sign_(sign) {}

  /// All of a range.
  /// @param at  values of the formula there
  [[nodiscard]] std::vector<TimesLine> between(std::span<const double> log_tau,
                                               std::span<const std::complex<double>> at) {
    std::vector<TimesLine> lines;
    std::complex<double> before = inverse_of(at[0]);
    for (std::size_t i = 1; i < log_tau.size(); ++i) {
      const std::complex<double> here = inverse_of(at[i]);
      search({log_tau[i - 1], before}, {log_tau[i], here}, 0, lines);
      before = here;
    }
    return lines;
  }

 private:
  struct Place {
    double log_tau;
    std::complex<double> inverse;
  };

  /// Without a continuous part 1/Z rises with tau all along but for its own poles, as lines and these alternate
  /// (Foster): where it has fallen without a change of sign one of each lies between.
  void search(const Place& low, const Place& high, int depth, std::vector<TimesLine>& lines) {
    constexpr int deepest = 6;
    if ((low.inverse.real() < 0) != (high.inverse.real() < 0)) {
      add(low.log_tau, high.log_tau, low.inverse.real() < 0, lines);
      return;
    }
    const auto is_real = [](const Place& at) { return std::abs(at.inverse.imag()) < 1e-9 * std::abs(at.inverse); };
    if (depth == deepest || !is_real(low) || !is_real(high)) return;
    if (!(sign_ * (high.inverse.real() - low.inverse.real()) < 0)) return;
    const double middle = (low.log_tau + high.log_tau) / 2;
    const Place between{middle, inverse(middle)};
    search(low, between, depth + 1, lines);
    search(between, high, depth + 1, lines);
  }

  static std::complex<double> inverse_of(std::complex<double> value) {
    // At a pole itself a formula is no number.
    return std::isfinite(value.real()) && std::isfinite(value.imag()) ? 1.0 / value : 0.0;
  }
  [[nodiscard]] std::complex<double> inverse(double log_tau) { return inverse_of(value_(std::exp(-log_tau))); }

  void add(double low, double high, bool low_is_negative, std::vector<TimesLine>& lines) {
    const double width = high - low;
    const double size = std::max(std::abs(inverse(low)), std::abs(inverse(high)));
    for (int i = 0; i < 60 && high - low > 1e-15 * (1 + std::abs(low)); ++i) {
      const double middle = (low + high) / 2;
      ((inverse(middle).real() < 0) == low_is_negative ? low : high) = middle;
    }
    const double place = (low + high) / 2;
    // Rounding of the exponent leaves 1e-15 of the slope; a jump through infinity or an imaginary part leaves much
    // more.
    if (!(std::abs(inverse(place)) < 1e-9 * size)) return;
    // With t = ln tau, 1 + s tau_k is t - t_k near the pole, so 1/Z = (t - t_k)/area.
    const double step = 1e-5 * width;
    const double slope = ((inverse(place + step) - inverse(place - step)) / (2 * step)).real();
    lines.push_back({std::exp(place), sign_ / slope, nan, nan, nan, nan});
  }

  detail::CutValue value_;
  double sign_;
};

/// Close enough that a sum over them is the integral of an arc of exponent 0.98 and more, and that lines stand apart.
std::vector<double> fine_times(double first, double last) {
  constexpr double per_e_fold = 40;
  const auto steps = std::max<std::size_t>(2, static_cast<std::size_t>(std::ceil((last - first) * per_e_fold)));
  std::vector<double> log_tau;
  for (std::size_t i = 0; i <= steps; ++i)
    log_tau.push_back(first + (last - first) * static_cast<double>(i) / static_cast<double>(steps));
  return log_tau;
}

/// A formula at the times shown and at those close enough to each other for lines and peaks.  These are those of the
/// range; which times are shown in it, and where it cuts a flank, changes nothing.
class ExactTimes {
 public:
  ExactTimes(const Structure& structure, std::span<const double> parameters, std::vector<double> log_tau,
             TimesKernel kernel)
      : structure_(structure),
        parameters_(parameters.begin(), parameters.end()),
        shown_(std::move(log_tau)),
        fine_(fine_times(shown_.front() - flank, shown_.back() + flank)),
        kernel_(kernel),
        values_(structure.expression(), parameters, rates()) {}

  [[nodiscard]] TimesDistribution distribution() const { return from(parameters_, values_.values()); }
  [[nodiscard]] TimesDistribution moved(std::size_t parameter, double to) const {
    std::vector<double> parameters = parameters_;
    parameters[parameter] = to;
    return from(parameters, values_.moved(parameter, to));
  }

 private:
  static constexpr double flank = 6 * std::numbers::ln10;

  [[nodiscard]] std::vector<double> rates() const {
    std::vector<double> result;
    for (const auto* times : {&shown_, &fine_})
      for (const double each : *times) result.push_back(std::exp(-each));
    return result;
  }

  [[nodiscard]] double density(std::complex<double> value) const {
    // What rounding leaves where the values on both sides agree is no density.
    const bool is_real = std::abs(value.imag()) < 1e-13 * std::abs(value);
    return is_real ? 0 : -sign_of(kernel_) / std::numbers::pi * value.imag();
  }

  [[nodiscard]] bool in_range(double tau) const {
    return std::log(tau) >= shown_.front() && std::log(tau) <= shown_.back();
  }

  [[nodiscard]] TimesDistribution from(std::span<const double> parameters,
                                       std::span<const std::complex<double>> values) const {
    TimesDistribution result{};
    result.kernel = kernel_;
    result.constant = result.inductance = result.elastance = result.smoothness = nan;
    result.misfit = result.misfit_in_noise = nan;
    for (std::size_t i = 0; i < shown_.size(); ++i) {
      result.tau.push_back(std::exp(shown_[i]));
      result.density.push_back(density(values[i]));
    }
    const auto at_fine = values.subspan(shown_.size());
    const auto first = std::upper_bound(fine_.begin(), fine_.end(), shown_.front()) - fine_.begin() - 1;
    const auto last = std::lower_bound(fine_.begin(), fine_.end(), shown_.back()) - fine_.begin();
    const auto from_index = static_cast<std::size_t>(first), count = static_cast<std::size_t>(last - first + 1);
    Lines lines({structure_.expression(), parameters}, sign_of(kernel_));
    result.lines = lines.between(std::span(fine_).subspan(from_index, count), at_fine.subspan(from_index, count));
    std::erase_if(result.lines, [&](const TimesLine& line) { return !in_range(line.tau); });
    std::vector<double> densities;
    for (const auto& each : at_fine) densities.push_back(density(each));
    double beside = 0;
    for (const TimesLine& line : result.lines) beside += std::abs(line.area);
    for (const auto& range : detail::large_peaks(detail::peak_ranges(densities), fine_, densities, beside)) {
      const double tau = std::exp(detail::peak_place(fine_, densities, range));
      if (in_range(tau)) result.peaks.push_back({tau, detail::peak_area(fine_, densities, range), nan, nan, nan, nan});
    }
    return result;
  }

  const Structure& structure_;
  std::vector<double> parameters_, shown_, fine_;
  TimesKernel kernel_;
  detail::CutValues values_;
};

void check_parameters(const Structure& structure, std::size_t count) {
  if (count != structure.parameter_names().size())
    throw std::invalid_argument(structure.formula() + " has " + std::to_string(structure.parameter_names().size()) +
                                " parameters, not " + std::to_string(count));
}

}  // namespace

std::string_view to_string(TimesKernel kernel) {
  return kernel == TimesKernel::falling ? "falling" : "rising";
}

TimesDistribution relaxation_times(const Structure& structure, std::span<const double> parameters,
                                   std::span<const double> tau, TimesKernel kernel) {
  check_parameters(structure, parameters.size());
  return ExactTimes(structure, parameters, logarithms(tau), kernel).distribution();
}

TimesDistribution relaxation_times(const FitResult& fit, std::span<const double> tau, TimesKernel kernel) {
  const Structure structure(fit.model);
  check_parameters(structure, fit.parameters.size());
  std::vector<double> values;
  for (const auto& each : fit.parameters) values.push_back(each.value);
  const ExactTimes exact(structure, values, logarithms(tau), kernel);
  TimesDistribution result = exact.distribution();
  const double freedom = static_cast<double>(fit.residuals) - static_cast<double>(fit.free_parameters);
  if (!(freedom >= 1) || fit.covariance.size() != values.size()) return result;

  // Everything that has an interval, as one list; the logarithm of a time.
  const auto quantities = [](const TimesDistribution& of) {
    std::vector<double> list = of.density;
    for (const auto& line : of.lines) list.insert(list.end(), {std::log(line.tau), line.area});
    for (const auto& peak : of.peaks) list.insert(list.end(), {std::log(peak.tau), peak.area});
    return list;
  };
  const std::vector<double> centre = quantities(result);
  std::vector<std::vector<double>> slopes;
  for (std::size_t i = 0; i < values.size(); ++i) {
    std::vector<double>& slope = slopes.emplace_back(centre.size(), 0.0);
    const double variance = fit.covariance[i][i];
    if (!(variance > 0)) continue;  // held
    // Small against the curvature, large against rounding.
    const double step = std::min(0.01 * std::sqrt(variance), 1e-3 * std::abs(values[i]) + 1e-300);
    const auto above = quantities(exact.moved(i, values[i] + step));
    const auto below = quantities(exact.moved(i, values[i] - step));
    // A peak or a line that comes or goes has no slope.
    for (std::size_t k = 0; k < centre.size(); ++k)
      slope[k] =
          above.size() == centre.size() && below.size() == centre.size() ? (above[k] - below[k]) / (2 * step) : nan;
  }
  std::vector<double> half(centre.size());
  const double t = student_t_95(freedom);
  for (std::size_t k = 0; k < centre.size(); ++k) {
    double variance = 0;
    for (std::size_t i = 0; i < values.size(); ++i)
      for (std::size_t j = 0; j < values.size(); ++j)
        if (std::isfinite(fit.covariance[i][j])) variance += slopes[i][k] * fit.covariance[i][j] * slopes[j][k];
    half[k] = t * std::sqrt(std::max(variance, 0.0));
  }
  std::size_t at = 0;
  for (; at < result.density.size(); ++at) {
    result.lower.push_back(centre[at] - half[at]);
    result.upper.push_back(centre[at] + half[at]);
  }
  const auto put = [&](auto& of) {
    of.tau_lower = std::exp(centre[at] - half[at]);
    of.tau_upper = std::exp(centre[at] + half[at]);
    of.area_lower = centre[at + 1] - half[at + 1];
    of.area_upper = centre[at + 1] + half[at + 1];
    at += 2;
  };
  for (auto& line : result.lines) put(line);
  for (auto& peak : result.peaks) put(peak);
  return result;
}

}  // namespace frac
