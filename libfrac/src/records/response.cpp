// SPDX-License-Identifier: BSD-3-Clause
#include "frac/records/response.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "base/number_text.hpp"
#include "base/short_text.hpp"
#include "records/estimators.hpp"
#include "special/distributions.hpp"

namespace frac {
namespace {

using detail::Estimated;

double half_width(double sigma, double degrees) {
  return sigma / std::sqrt(detail::student_variance(degrees)) * detail::student_t_quantile(0.975, degrees);
}

void check(const std::vector<Record>& records, const ResponseOptions& options) {
  if (records.empty()) throw std::invalid_argument("records is empty; expected at least one");
  for (std::size_t i = 1; i < records.size(); ++i) {
    const std::string name = "records[" + std::to_string(i) + "]";
    if (std::abs(records[i].sample_time() / records[0].sample_time() - 1) > 1e-6)
      throw std::invalid_argument(name + " has the sample time " + detail::number_text(records[i].sample_time()) +
                                  " s and the first " + detail::number_text(records[0].sample_time()) +
                                  " s; expected the same");
    if (records[i].outputs().size() != records[0].outputs().size())
      throw std::invalid_argument(name + " has " + std::to_string(records[i].outputs().size()) +
                                  " outputs and the first " + std::to_string(records[0].outputs().size()) +
                                  "; expected as many");
  }
  if (options.harmonics < 1)
    throw std::invalid_argument("harmonics is " + std::to_string(options.harmonics) + "; expected at least 1");
  if (!options.period) return;
  for (const Record& record : records) {
    const double length = *options.period / record.sample_time(), longest = 0.5 * static_cast<double>(record.size());
    if (!(length >= 4) || !(length <= longest * (1 + 1e-9)))
      throw std::invalid_argument("period is " + detail::number_text(*options.period) + " s; expected " +
                                  detail::number_text(4 * record.sample_time()) + " s (4 samples) to " +
                                  detail::number_text(longest * record.sample_time()) + " s (half of the record)");
  }
}

/// Chance that the responses of both halves of a record differ so much by their errors alone.
double chance_of_halves(const Estimated& first, const Estimated& second) {
  double sum = 0, degrees_below = 0;
  std::size_t count = 0;
  for (std::size_t output = 0; output < first.outputs.size(); ++output) {
    const auto& a = first.outputs[output];
    const auto& b = second.outputs[output];
    if (a.size() != b.size()) return 1;
    for (std::size_t i = 0; i < a.size(); ++i) {
      const double noise = a[i].noise * a[i].noise + b[i].noise * b[i].noise;
      if (!(noise > 0)) continue;
      sum += std::norm(a[i].value - b[i].value) / (2 * noise);
      degrees_below += a[i].degrees + b[i].degrees;
      ++count;
    }
  }
  if (count == 0) return 1;
  return detail::fisher_f_above(sum / static_cast<double>(count), 2 * static_cast<double>(count), degrees_below);
}

Estimated estimate(const Record& record, Excitation excitation, double length, const ResponseOptions& options) {
  switch (excitation) {
    case Excitation::periodic:
      return detail::periodic_response(record, length);
    case Excitation::stepped_sine:
      return detail::stepped_sine_response(record, sine_segments(record.drive()), options.harmonics);
    case Excitation::arbitrary:
      break;
  }
  return detail::arbitrary_response(record);
}

/// Mean over realisations; the deviation is that of their scatter, which holds noise and distortion (Pintelon,
/// Schoukens 2012, chapter 4).
void average(const std::vector<Estimated>& all, std::vector<std::vector<ResponsePoint>>& outputs) {
  const auto count = static_cast<double>(all.size());
  for (std::size_t output = 0; output < outputs.size(); ++output) {
    auto& points = outputs[output];
    std::vector<double> scatter(points.size());
    for (std::size_t i = 0; i < points.size(); ++i) {
      std::complex<double> sum = 0;
      double noise = 0, amplitude = 0, even = 0;
      for (const auto& each : all) {
        const ResponsePoint& point = each.outputs[output][i];
        sum += point.value / count;
        noise += point.noise * point.noise / (count * count);
        amplitude += point.input_amplitude / count;
        even += point.even_distortion * point.even_distortion / count;
        if (!point.flag.empty()) points[i].flag = point.flag;
      }
      for (const auto& each : all)
        scatter[i] += std::norm(each.outputs[output][i].value - sum) / (2 * count * (count - 1));
      points[i].value = sum;
      points[i].noise = std::sqrt(noise);
      points[i].input_amplitude = amplitude;
      points[i].even_distortion = std::sqrt(even);
      points[i].correlation = 0;
    }
    // Of few realisations neighbouring lines are taken together, until there are 18 degrees of freedom.
    constexpr double enough = 18;
    const auto side = static_cast<std::size_t>(std::max(0.0, std::ceil((enough / (2 * (count - 1)) - 1) / 2)));
    for (std::size_t i = 0; i < points.size(); ++i) {
      const std::size_t begin = i < side ? 0 : i - side, end = std::min(i + side + 1, points.size());
      double sum = 0;
      for (std::size_t k = begin; k < end; ++k) sum += scatter[k];
      const auto lines = static_cast<double>(end - begin);
      ResponsePoint& point = points[i];
      point.degrees = 2 * (count - 1) * lines;
      const double whole = sum / lines;
      const double noise = point.noise * point.noise;
      point.distortion = std::sqrt(std::max(0.0, whole - noise));
      point.sigma = std::sqrt(std::max(whole * detail::student_variance(point.degrees), noise));
      if (!point.flag.empty()) point.sigma = std::numeric_limits<double>::quiet_NaN();
      point.sigma_re = point.sigma_im = point.sigma;
    }
  }
}

}  // namespace

double ResponsePoint::sigma_or_rounding() const {
  // Sums of doubles err by this share of the value.
  constexpr double rounding = 1e-15;
  return std::max(sigma, rounding * std::abs(value));
}

double ResponsePoint::half_width_re() const {
  return half_width(sigma_re, degrees);
}

double ResponsePoint::half_width_im() const {
  return half_width(sigma_im, degrees);
}

bool ResponseEstimate::usable() const {
  return std::any_of(outputs.begin(), outputs.end(), [](const auto& points) {
    return std::any_of(points.begin(), points.end(), [](const auto& point) { return std::isfinite(point.sigma); });
  });
}

ResponseEstimate response(const std::vector<Record>& records, const ResponseOptions& options) {
  check(records, options);
  ResponseEstimate result;
  result.realisations = records.size();
  const Record& first = records.front();
  result.excitation = options.excitation ? *options.excitation
                      : options.period   ? Excitation::periodic
                                         : excitation_of(first);
  double length = options.period ? *options.period / first.sample_time() : 0;
  if (result.excitation == Excitation::periodic && !options.period) {
    const auto found = period_of(first.drive());
    if (!found)
      throw std::invalid_argument(
          "period is not told, and no lag repeats the larger share of the power of the input "
          "in the record");
    length = *found;
  }
  std::vector<Estimated> all;
  for (const Record& record : records) {
    all.push_back(estimate(record, result.excitation, length, options));
    if (is_clipped(record.input())) result.remarks.emplace_back("the input is clipped: it stays at its limit");
    for (const auto& output : record.outputs())
      if (is_clipped(output)) result.remarks.emplace_back("an output is clipped: it stays at its limit");
  }
  result.outputs = all.front().outputs;
  result.periods = all.front().periods;
  result.remarks.insert(result.remarks.end(), all.front().remarks.begin(), all.front().remarks.end());
  if (result.excitation == Excitation::periodic) result.period = length * first.sample_time();
  if (result.excitation == Excitation::stepped_sine) {
    result.realisations = 1;
    for (std::size_t i = 1; i < all.size(); ++i) {
      result.periods += all[i].periods;
      for (std::size_t output = 0; output < result.outputs.size(); ++output)
        result.outputs[output].insert(result.outputs[output].end(), all[i].outputs[output].begin(),
                                      all[i].outputs[output].end());
    }
    return result;
  }
  for (const auto& each : all)
    for (std::size_t output = 0; output < result.outputs.size(); ++output) {
      const auto& here = each.outputs[output];
      const auto& there = result.outputs[output];
      if (here.size() != there.size() ||
          !std::equal(here.begin(), here.end(), there.begin(),
                      [](const auto& a, const auto& b) { return std::abs(a.omega / b.omega - 1) < 1e-6; }))
        throw std::invalid_argument(
            "records differ in the lines that they excite; expected realisations of one "
            "excitation");
    }
  if (records.size() > 1) average(all, result.outputs);
  if (result.excitation == Excitation::periodic && records.size() == 1) {
    if (all.front().all_lines_excited)
      result.remarks.emplace_back(
          "every line of the band is excited, in one realisation: sigma holds noise and no distortion");
    constexpr std::size_t fewest_samples = 16;
    const std::size_t half = first.size() / 2;
    if (result.periods >= 4 && half >= fewest_samples) {
      const double chance =
          chance_of_halves(estimate(first.part(0, half), result.excitation, length, options),
                           estimate(first.part(first.size() - half, half), result.excitation, length, options));
      constexpr double level = 1e-3;
      if (chance < level)
        result.remarks.push_back(
            "the responses of the first and of the second half of the record differ by more than "
            "their noise (chance " +
            detail::short_text(chance) + "): no steady state, or a machine that drifts");
    }
  }
  return result;
}

}  // namespace frac
