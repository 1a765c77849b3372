// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <limits>
#include <numbers>
#include <stdexcept>
#include <utility>

#include "cut_value.hpp"
#include "frac/identification/relaxation_times.hpp"
#include "frac/identification/statistics.hpp"
#include "peaks.hpp"
#include "poles_on_cut.hpp"

namespace frac {
namespace {

using Complex = std::complex<double>;

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

/// Times about the place of a pole, from which it is read: with t = ln tau, Z = area/(t - place) + what is smooth
/// there.
class PoleTimes {
 public:
  static constexpr std::size_t count = 4;

  /// @param gap  distance to the next place
  PoleTimes(double log_tau, double gap) : log_tau_(log_tau), step_(1e-3 * gap) {}

  [[nodiscard]] double time(std::size_t i) const { return log_tau_ + steps[i] * step_; }

  struct Pole {
    Complex log_tau, area;
  };
  /// Z (t - place) is a polynomial there.  Through four points it has the degree 2, as the smooth part has the degree
  /// 1, so that the divided difference of order 3 of t Z is that of Z times the place; at the place it is the area.
  [[nodiscard]] Pole pole(std::span<const Complex> at) const {
    constexpr std::array<double, count> weights{-1.0 / 12, 1.0 / 6, -1.0 / 6, 1.0 / 12};
    Complex difference, moment, nodes = 1;
    for (std::size_t i = 0; i < count; ++i) {
      difference += weights[i] * at[i];
      moment += weights[i] * steps[i] * at[i];
    }
    const Complex place = moment / difference;
    for (const double each : steps) nodes *= place - each;
    return {log_tau_ + step_ * place, -step_ * nodes * difference};
  }

  /// Whether there is one, and where it was sought.  A double one, a power, or a place without a pole looks otherwise
  /// from twice the distance.
  template <class Value>
  [[nodiscard]] bool is_pole(const Value& value) const {
    constexpr double off = 0.5, rounding = 1e-10, other = 0.01;
    double size = 0;
    const auto seen_from = [&](const PoleTimes& about) {
      std::array<Complex, count> at;
      for (std::size_t i = 0; i < count; ++i) at[i] = value(about.time(i));
      size = std::abs(at[1]);
      return about.pole(at);
    };
    PoleTimes wider = *this;
    wider.step_ *= 2;
    const Pole far = seen_from(wider), near = seen_from(*this);
    return std::abs(near.log_tau - log_tau_) < off * step_ && std::abs(near.area) > rounding * size * step_ &&
           std::abs(far.area - near.area) < other * std::abs(near.area);
  }

 private:
  static constexpr std::array<double, count> steps{-2, -1, 1, 2};
  double log_tau_, step_;
};

/// Close enough that a sum over them is the integral of an arc of exponent up to 0.98.
std::vector<double> fine_times(double first, double last) {
  constexpr double per_e_fold = 40;
  const auto steps = static_cast<std::size_t>(std::ceil((last - first) * per_e_fold));
  std::vector<double> log_tau;
  for (std::size_t i = 0; i <= steps; ++i)
    log_tau.push_back(first + (last - first) * static_cast<double>(i) / static_cast<double>(steps));
  return log_tau;
}

/// A formula at the times shown and at those about its lines and peaks.  These are those of the range; which times are
/// shown in it, and where it cuts a flank, changes nothing.
class ExactTimes {
 public:
  ExactTimes(const Structure& structure, std::span<const double> parameters, std::vector<double> log_tau,
             TimesKernel kernel)
      : shown_(std::move(log_tau)),
        fine_(fine_times(shown_.front() - flank, shown_.back() + flank)),
        kernel_(kernel),
        lines_(lines_of(structure.expression(), parameters)),
        values_(structure.expression(), parameters, rates()) {
    const Parts parts = parts_of(values_.values());
    const std::vector<double> densities = densities_of(parts.fine);
    double beside = 0;
    for (std::size_t i = 0; i < lines_.size(); ++i) beside += std::abs(lines_[i].pole(parts.about_line(i)).area.real());
    peaks_ = detail::large_peaks(detail::peak_ranges(densities), fine_, densities, beside);
    std::erase_if(peaks_, [&](const auto& range) { return !in_range(detail::peak_place(fine_, densities, range)); });
  }

  [[nodiscard]] TimesDistribution distribution() const { return from(values_.values()); }
  /// With the same lines and peaks, wherever they have gone.
  [[nodiscard]] TimesDistribution moved(std::size_t parameter, double to) const {
    return from(values_.moved(parameter, to));
  }

 private:
  static constexpr double flank = 6 * std::numbers::ln10;

  [[nodiscard]] bool in_range(double log_tau) const { return log_tau >= shown_.front() && log_tau <= shown_.back(); }

  [[nodiscard]] std::vector<PoleTimes> lines_of(const detail::Expression& expression,
                                                std::span<const double> parameters) {
    constexpr double margin = 0.1, widest_gap = 1.0 / 40;
    const auto sought = detail::possible_poles(expression, parameters, shown_.front() - margin, shown_.back() + margin);
    lines_left_off_ = sought.left_off;
    const std::vector<double>& places = sought.log_tau;
    detail::CutValue formula(expression, parameters);
    const auto value = [&](double log_tau) {
      return formula.of(static_cast<int>(expression.nodes.size()) - 1, std::exp(-log_tau));
    };
    std::vector<PoleTimes> lines;
    for (std::size_t i = 0; i < places.size(); ++i) {
      double gap = widest_gap;
      if (i > 0) gap = std::min(gap, places[i] - places[i - 1]);
      if (i + 1 < places.size()) gap = std::min(gap, places[i + 1] - places[i]);
      const PoleTimes about(places[i], gap);
      if (in_range(places[i]) && about.is_pole(value)) lines.push_back(about);
    }
    return lines;
  }

  [[nodiscard]] std::vector<double> rates() const {
    std::vector<double> result;
    for (const auto* times : {&shown_, &fine_})
      for (const double each : *times) result.push_back(std::exp(-each));
    for (const PoleTimes& line : lines_)
      for (std::size_t i = 0; i < PoleTimes::count; ++i) result.push_back(std::exp(-line.time(i)));
    return result;
  }

  /// Values of the formula at the rates.
  struct Parts {
    std::span<const Complex> shown, fine, lines;
    [[nodiscard]] std::span<const Complex> about_line(std::size_t i) const {
      return lines.subspan(i * PoleTimes::count, PoleTimes::count);
    }
  };
  [[nodiscard]] Parts parts_of(std::span<const Complex> values) const {
    return {values.first(shown_.size()), values.subspan(shown_.size(), fine_.size()),
            values.subspan(shown_.size() + fine_.size())};
  }

  [[nodiscard]] std::vector<double> densities_of(std::span<const Complex> values) const {
    std::vector<double> result;
    for (const Complex value : values) {
      // Rounding that is left where the values on both sides agree is no density, and at a line there is none beside
      // it.
      const bool is_cut = std::isfinite(std::abs(value)) && std::abs(value.imag()) >= 1e-13 * std::abs(value);
      result.push_back(is_cut ? -sign_of(kernel_) / std::numbers::pi * value.imag() : 0);
    }
    return result;
  }

  [[nodiscard]] TimesDistribution from(std::span<const Complex> values) const {
    TimesDistribution result{};
    result.kernel = kernel_;
    result.constant = result.inductance = result.elastance = result.smoothness = nan;
    result.constant_lower = result.constant_upper = result.inductance_lower = result.inductance_upper = nan;
    result.elastance_lower = result.elastance_upper = nan;
    result.misfit = result.misfit_in_noise = nan;
    const Parts parts = parts_of(values);
    for (const double each : shown_) result.tau.push_back(std::exp(each));
    result.density = densities_of(parts.shown);
    result.lines_left_off = lines_left_off_;
    for (std::size_t i = 0; i < lines_.size(); ++i) {
      // 1 + s tau_k is t - t_k near the pole.
      const auto pole = lines_[i].pole(parts.about_line(i));
      result.lines.push_back({std::exp(pole.log_tau.real()), sign_of(kernel_) * pole.area.real(), nan, nan, nan, nan});
    }
    const std::vector<double> densities = densities_of(parts.fine);
    for (const auto& range : peaks_)
      result.peaks.push_back({std::exp(detail::peak_place(fine_, densities, range)),
                              detail::peak_area(fine_, densities, range), nan, nan, nan, nan});
    return result;
  }

  std::vector<double> shown_, fine_;
  TimesKernel kernel_;
  std::size_t lines_left_off_ = 0;
  std::vector<PoleTimes> lines_;
  detail::CutValues values_;
  std::vector<detail::PeakRange> peaks_;
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
    // Small against the distance of lines, of which there are a thousand at most, large against rounding.
    const double step = std::min(0.01 * std::sqrt(variance), 1e-6 * std::abs(values[i]) + 1e-300);
    const auto above = quantities(exact.moved(i, values[i] + step));
    const auto below = quantities(exact.moved(i, values[i] - step));
    for (std::size_t k = 0; k < centre.size(); ++k) slope[k] = (above[k] - below[k]) / (2 * step);
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
