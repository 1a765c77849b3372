// SPDX-License-Identifier: BSD-3-Clause
#include "frac/records/response.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "base/number_text.hpp"
#include "base/short_text.hpp"
#include "records/estimators.hpp"
#include "records/fold.hpp"
#include "records/gaps.hpp"
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
  if (!std::isfinite(options.sensor_delay))
    throw std::invalid_argument("sensor_delay is " + detail::number_text(options.sensor_delay) +
                                " s; expected a finite number");
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

/// Of a record that may be long: its periods are folded onto some of them.
Estimated periodic_estimate(const Record& record, std::size_t first, std::size_t count, double length) {
  const auto fold = detail::folded(record, first, count, length);
  if (!fold) return detail::periodic_response(count == record.size() ? record : record.part(first, count), length);
  Estimated estimated = detail::periodic_response(fold->record, length);
  const auto blocks = static_cast<double>(fold->blocks);
  estimated.periods *= blocks;
  for (auto& points : estimated.outputs)
    for (ResponsePoint& point : points) point.periods *= blocks;
  return estimated;
}

Estimated estimate(const Record& record, Excitation excitation, double length, const ResponseOptions& options) {
  switch (excitation) {
    case Excitation::periodic:
      return periodic_estimate(record, 0, record.size(), length);
    case Excitation::stepped_sine:
      return detail::stepped_sine_response(record, sine_segments(record.drive()), options.harmonics);
    case Excitation::arbitrary:
      break;
  }
  return detail::arbitrary_response(record);
}

/// Mean over realisations; the deviation is that of their scatter, which holds noise and distortion (Pintelon,
/// Schoukens 2012, chapter 4).
void average(const std::vector<Estimated>& all, Excitation excitation,
             std::vector<std::vector<ResponsePoint>>& outputs) {
  const auto count = static_cast<double>(all.size());
  for (std::size_t output = 0; output < outputs.size(); ++output) {
    auto& points = outputs[output];
    std::vector<double> scatter(points.size());
    for (std::size_t i = 0; i < points.size(); ++i) {
      std::complex<double> sum = 0;
      double noise = 0, amplitude = 0;
      detail::DistortionLevel even;
      for (const auto& each : all) {
        const ResponsePoint& point = each.outputs[output][i];
        sum += point.value / count;
        noise += point.noise * point.noise / (count * count);
        amplitude += point.input_amplitude / count;
        if (excitation == Excitation::periodic) even.add(each.even[output][i], 1 / count);
        if (!point.flag.empty()) points[i].flag = point.flag;
      }
      for (const auto& each : all)
        scatter[i] += std::norm(each.outputs[output][i].value - sum) / (2 * count * (count - 1));
      points[i].value = sum;
      points[i].noise = std::sqrt(noise);
      points[i].input_amplitude = amplitude;
      detail::set_even_distortion(even, points[i]);
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
      detail::set_distortion({whole, noise, point.degrees}, point);
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

namespace {

const Record& longest_of(const std::vector<Record>& records) {
  return *std::max_element(records.begin(), records.end(),
                           [](const Record& a, const Record& b) { return a.size() < b.size(); });
}

std::string gaps_text(const Record& record) {
  std::size_t missing = 0;
  for (const RecordGap& gap : record.gaps()) missing += gap.missing;
  const std::size_t count = record.gaps().size();
  return (count == 1 ? "a gap" : std::to_string(count) + " gaps") + " of " + std::to_string(missing) +
         (missing == 1 ? " sample" : " samples") + (count == 1 ? "" : " in all");
}

/// Pieces of each record between its gaps.
using Stretches = std::vector<std::vector<Record>>;

/// A period goes on over gaps; one of no whole number of samples is not followed, so that the longest stretch counts.
ResponseEstimate periodic_over_gaps(const std::vector<Record>& records, const Stretches& parts, ResponseOptions told,
                                    std::vector<std::string>& remarks) {
  const Record& longest = longest_of(parts.front());
  const auto period = told.period ? std::optional(*told.period / longest.sample_time()) : period_of(longest.drive());
  const std::size_t whole = period ? detail::whole_samples(*period, longest.size()) : 0;
  std::vector<Record> bridged;
  for (std::size_t i = 0; i < records.size(); ++i) {
    if (records[i].gaps().empty()) {
      bridged.push_back(records[i]);
    } else if (whole > 0) {
      bridged.push_back(detail::joined(records[i], whole));
      remarks.push_back("the record has " + gaps_text(records[i]) +
                        ": the period goes on over it, and both sides count");
    } else {
      bridged.push_back(longest_of(parts[i]));
      remarks.push_back(
          "the record has " + gaps_text(records[i]) +
          ", over which a period that is no whole number of samples is not followed: the longest stretch counts, " +
          std::to_string(bridged.back().size()) + " samples");
    }
  }
  if (whole > 0) told.period = static_cast<double>(whole) * longest.sample_time();
  return response(bridged, told);
}

/// A segment of one frequency that goes on after a gap is one point.
ResponseEstimate stepped_over_gaps(const std::vector<Record>& records, const Stretches& parts,
                                   const ResponseOptions& told, std::vector<std::string>& remarks) {
  ResponseEstimate result;
  result.outputs.resize(records.front().outputs().size());
  result.excitation = Excitation::stepped_sine;
  for (std::size_t i = 0; i < records.size(); ++i) {
    ResponseEstimate of_record;
    of_record.outputs.resize(result.outputs.size());
    for (const Record& part : parts[i]) {
      const ResponseEstimate of_part = response({part}, told);
      detail::join_segments(of_part.outputs, of_record.outputs);
      result.periods += of_part.periods;
      for (const auto& remark : of_part.remarks)
        if (std::find(remarks.begin(), remarks.end(), remark) == remarks.end()) remarks.push_back(remark);
    }
    for (std::size_t output = 0; output < result.outputs.size(); ++output)
      result.outputs[output].insert(result.outputs[output].end(), of_record.outputs[output].begin(),
                                    of_record.outputs[output].end());
    if (!records[i].gaps().empty())
      remarks.push_back("the record has " + gaps_text(records[i]) + ": a segment that goes on after it is one point");
  }
  return result;
}

/// Of records some of which have gaps.
ResponseEstimate response_over_gaps(const std::vector<Record>& records, const ResponseOptions& options) {
  Stretches parts;
  for (const Record& record : records) {
    parts.push_back(detail::stretches(record));
    if (parts.back().empty())
      throw std::invalid_argument("the record has " + gaps_text(record) +
                                  ", and no stretch of 16 samples between them; expected one");
  }
  ResponseOptions told = options;
  told.sensor_delay = 0;  // of the whole, once
  if (!told.excitation) told.excitation = told.period ? Excitation::periodic : excitation_of(longest_of(parts.front()));
  if (*told.excitation == Excitation::arbitrary)
    throw std::invalid_argument("the record has " + gaps_text(records.front()) +
                                ", over which an arbitrary excitation does not go on; expected a record for each side");
  std::vector<std::string> remarks;
  ResponseEstimate result = *told.excitation == Excitation::periodic ? periodic_over_gaps(records, parts, told, remarks)
                                                                     : stepped_over_gaps(records, parts, told, remarks);
  result.remarks.insert(result.remarks.begin(), remarks.begin(), remarks.end());
  return result;
}

ResponseEstimate response_as_read(const std::vector<Record>& records, const ResponseOptions& options) {
  if (std::any_of(records.begin(), records.end(), [](const Record& each) { return !each.gaps().empty(); }))
    return response_over_gaps(records, options);
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
  if (result.excitation == Excitation::arbitrary && !options.excitation) {
    if (const auto lag = repeats_once_after(first.drive()))
      result.remarks.push_back("the input repeats itself after " + detail::short_text(*lag * first.sample_time()) +
                               " s, of which the record holds " +
                               detail::short_text(static_cast<double>(first.size()) / *lag) +
                               " periods: it is taken as arbitrary; from two periods on the noise between its lines is "
                               "told from the transient");
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
  if (records.size() > 1) average(all, result.excitation, result.outputs);
  if (result.excitation == Excitation::periodic && records.size() == 1) {
    if (all.front().all_lines_excited)
      result.remarks.emplace_back(
          "every line of the band is excited, in one realisation: sigma holds noise and no distortion");
    constexpr std::size_t fewest_samples = 16;
    const std::size_t half = first.size() / 2;
    if (result.periods >= 4 && half >= fewest_samples) {
      const double chance = chance_of_halves(periodic_estimate(first, 0, half, length),
                                             periodic_estimate(first, first.size() - half, half, length));
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

/// Value and errors under a turn of the phase by `angle`, of a harmonic by as many times that.
void turn(ResponsePoint& point, double angle) {
  const std::complex<double> by = std::polar(1.0, angle);
  point.value *= by;
  point.windowed *= by;
  for (ResponseHarmonic& harmonic : point.harmonics) harmonic.value *= std::polar(1.0, harmonic.order * angle);
  const double re = point.sigma_re * point.sigma_re, im = point.sigma_im * point.sigma_im,
               both = point.correlation * point.sigma_re * point.sigma_im;
  const double c = by.real(), s = by.imag();
  point.sigma_re = std::sqrt(std::max(0.0, re * c * c + im * s * s - 2 * both * c * s));
  point.sigma_im = std::sqrt(std::max(0.0, re * s * s + im * c * c + 2 * both * c * s));
  const double size = point.sigma_re * point.sigma_im;
  if (size > 0) point.correlation = std::clamp(((re - im) * c * s + both * (c * c - s * s)) / size, -1.0, 1.0);
}

void say_stuck(const std::string& name, const std::vector<double>& signal, std::vector<std::string>& remarks) {
  if (const auto stuck = stuck_samples(signal))
    remarks.push_back(name + " stands still for " + std::to_string(stuck->count) + " samples from sample " +
                      std::to_string(stuck->first + 1) + " on and then jumps, as a stuck reading does");
}

}  // namespace

ResponseEstimate response(const std::vector<Record>& records, const ResponseOptions& options) {
  check(records, options);
  ResponseEstimate result = response_as_read(records, options);
  for (const Record& record : records) {
    say_stuck("the input", record.input(), result.remarks);
    for (const auto& output : record.outputs()) say_stuck("an output", output, result.remarks);
  }
  if (options.sensor_delay != 0)
    for (auto& points : result.outputs)
      for (ResponsePoint& point : points) turn(point, point.omega * options.sensor_delay);
  return result;
}

}  // namespace frac
