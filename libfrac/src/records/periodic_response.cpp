// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>

#include "records/estimators.hpp"
#include "special/distributions.hpp"

namespace frac::detail {
namespace {

/// What a line that the excitation leaves out shows of one output, the answer to its own input taken away.
struct Detection {
  std::size_t line;     // of the period
  double power, noise;  // of which noise is expected
};

/// Lines of the period that the drive excites, and how many others it has above its noise.
struct ExcitedLines {
  std::vector<std::size_t> lines;
  std::size_t others = 0;
};

/// Chance that noise alone makes the line so large in the drive and an output together, the least of all outputs
/// (Hotelling's T^2 of two complex normal variables).  Noise that goes round a loop is in both alike, and counts once.
double chance_of_noise(const LineEstimate& line, Eigen::Index drive) {
  constexpr double rounding = 1e-12;
  double least = 1;
  for (Eigen::Index output = 1; output < line.value.size(); ++output) {
    const double of_output = line.covariance(output, output).real();
    if (!(of_output > 0)) return 0;
    const std::complex<double> slope = line.covariance(drive, output) / of_output;
    const double of_drive = line.covariance(drive, drive).real();
    const double rest = std::max(of_drive - std::norm(slope) * of_output, rounding * of_drive);
    const double squares =
        std::norm(line.value(output)) / of_output + std::norm(line.value(drive) - slope * line.value(output)) / rest;
    least =
        std::min(least, fisher_f_above(squares * (line.degrees - 1) / (2 * line.degrees), 4, 2 * (line.degrees - 1)));
  }
  return least;
}

/// Lines count that stand above the noise, with a chance of 1e-3 over all lines to be wrong, and are at least a
/// hundredth of the largest.  Where a gap of more than a factor of 4 parts them (the widest one), those below it are
/// distortion of the amplifier or the answer of a loop; lines of a square wave are a factor of 3 apart at most.
ExcitedLines excited_lines(const std::vector<LineEstimate>& lines, Eigen::Index drive) {
  const bool has_reference = drive != 0;
  constexpr double least_share = 0.01, chance = 1e-3, least_gap = 4;
  // A line that is noise in a loop has the response of its controller, with a deviation of rounding.
  constexpr double chance_in_loop = 1e-6;
  double largest = 0;
  for (const auto& line : lines) largest = std::max(largest, std::abs(line.value(drive)));
  std::vector<std::pair<double, std::size_t>> strong;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    const double amplitude = std::abs(lines[i].value(drive));
    if (!(amplitude >= least_share * largest) || amplitude == 0) continue;
    const double noise = lines[i].degrees > 0 ? lines[i].covariance(drive, drive).real() : 0;
    const double ratio = amplitude * amplitude / noise;
    const auto count = static_cast<double>(lines.size());
    if (std::isfinite(ratio) && (fisher_f_above(ratio, 2, 2 * lines[i].degrees) > chance / count ||
                                 (!has_reference && chance_of_noise(lines[i], drive) > chance_in_loop / count)))
      continue;
    strong.emplace_back(amplitude, i + 1);
  }
  std::sort(strong.rbegin(), strong.rend());
  std::size_t count = strong.size();
  double widest = least_gap;
  for (std::size_t i = 1; i < strong.size(); ++i)
    if (strong[i - 1].first > widest * strong[i].first) {
      widest = strong[i - 1].first / strong[i].first;
      count = i;
    }
  ExcitedLines excited;
  excited.others = strong.size() - count;
  for (std::size_t i = 0; i < count; ++i) excited.lines.push_back(strong[i].second);
  std::sort(excited.lines.begin(), excited.lines.end());
  return excited;
}

/// Level of the detection lines of a kind that are nearest to a line of the period, over the input there.
/// Six lines: twelve degrees of freedom.
DistortionLevel level_near(const std::vector<Detection>& lines, std::size_t line, double input_amplitude) {
  constexpr std::size_t most = 6;
  auto end = std::lower_bound(lines.begin(), lines.end(), line,
                              [](const Detection& each, std::size_t at) { return each.line < at; });
  auto begin = end;
  const auto distance = [line](const Detection& each) {
    return each.line > line ? each.line - line : line - each.line;
  };
  DistortionLevel level;
  const auto count = static_cast<double>(std::min(most, lines.size()));
  const double scale = 1 / (2 * count * input_amplitude * input_amplitude);
  while (level.degrees < 2 * count) {
    const bool below = end == lines.end() || (begin != lines.begin() && distance(*(begin - 1)) <= distance(*end));
    const Detection& nearest = below ? *--begin : *end++;
    level.whole += scale * nearest.power;
    level.noise += scale * nearest.noise;
    level.degrees += 2;
  }
  return level;
}

/// The distortion joins the noise in the deviations of a point: two independent variances, whose sum has the degrees of
/// freedom of Welch and Satterthwaite.
void add_distortion(const DistortionLevel& level, double degrees_of_noise, ResponsePoint& point) {
  set_distortion(level, point);
  const double added = point.distortion * point.distortion, degrees_of_added = level.degrees;
  if (!(added > 0) || std::isnan(point.sigma)) return;
  const auto join = [&](double& sigma, double degrees) {
    const double noise = sigma * sigma / student_variance(degrees), whole = noise + added;
    const double joint = whole * whole / (noise * noise / degrees + added * added / degrees_of_added);
    sigma = std::sqrt(whole * student_variance(joint));
    return joint;
  };
  const double before = point.sigma_re * point.sigma_im / student_variance(point.degrees);
  join(point.sigma, degrees_of_noise);
  const double of_re = join(point.sigma_re, point.degrees), of_im = join(point.sigma_im, point.degrees);
  const double after = point.sigma_re * point.sigma_im / std::sqrt(student_variance(of_re) * student_variance(of_im));
  point.correlation *= before / after;
  point.degrees = std::min(of_re, of_im);
}

/// Response of an output between the excited lines: 1/G along the polynomial through two lines on each side, which is
/// exact for a resonance.
class BetweenLines {
 public:
  /// @param lines  rising
  BetweenLines(std::vector<double> lines, std::vector<std::complex<double>> values)
      : lines_(std::move(lines)), inverses_(std::move(values)) {
    for (auto& each : inverses_) each = 1.0 / each;
  }
  [[nodiscard]] std::complex<double> operator()(double line) const {
    const auto above = static_cast<std::size_t>(std::lower_bound(lines_.begin(), lines_.end(), line) - lines_.begin());
    if (above == 0) return 1.0 / inverses_.front();
    if (above == lines_.size()) return 1.0 / inverses_.back();
    const std::size_t begin = above < 2 ? 0 : above - 2, end = std::min(above + 2, lines_.size());
    std::complex<double> inverse = 0;
    for (std::size_t i = begin; i < end; ++i) {
      double share = 1;
      for (std::size_t k = begin; k < end; ++k)
        if (k != i) share *= (line - lines_[k]) / (lines_[i] - lines_[k]);
      inverse += share * inverses_[i];
    }
    return 1.0 / inverse;
  }

 private:
  std::vector<double> lines_;
  std::vector<std::complex<double>> inverses_;
};

/// Around the machine a loop u = r - C y makes of a disturbance v the errors e_y = v/(1 + G C) of the output and
/// e_u = -C e_y of the input.  e_y - G e_u at a line of the period is v, while with the G of this line it is
/// v (1 + G(line) C)/(1 + G C) beside it, which has the peaks of the loop.  -C is the regression of e_u on e_y; none
/// where errors of a coherence of 0 have as large a one with a chance of 0.01, (1 - coherence)^(degrees - 1).
ShapedSum noise_of_loop(const LineEstimate& line, std::size_t bin, std::size_t output, double periods,
                        const BetweenLines& response) {
  const auto at = static_cast<Eigen::Index>(output) + 1;
  const double coherence = std::norm(line.covariance(0, at)) / (line.covariance(0, 0) * line.covariance(at, at)).real();
  constexpr double chance = 0.01;
  const bool has_loop = std::pow(std::max(1 - coherence, 0.0), line.degrees - 1) < chance;
  ShapedSum sum{
      Eigen::VectorXcd::Zero(line.value.size()), {}, has_loop ? line.covariance(0, at) / line.covariance(at, at) : 0};
  sum.response = [&response, periods](std::size_t other) { return response(static_cast<double>(other) / periods); };
  sum.weights(0) = -sum.response(bin);
  sum.weights(at) = 1;
  return sum;
}

}  // namespace

Estimated periodic_response(const Record& record, double length) {
  const PeriodLines found = period_lines(record, length, 0);
  const std::size_t periods = found.periods, outputs = record.outputs().size();
  LineReader reader(found.spectra, periods, neighbours_for(periods));
  std::vector<LineEstimate> lines;
  for (std::size_t bin = periods; bin < found.spectra.front().size(); bin += periods) lines.push_back(reader(bin));
  const bool has_reference = !record.reference().empty();
  const auto drive = static_cast<Eigen::Index>(has_reference ? outputs + 1 : 0);
  const ExcitedLines all_excited = excited_lines(lines, drive);
  const std::vector<std::size_t>& excited = all_excited.lines;
  Estimated estimated;
  estimated.periods = static_cast<double>(periods);
  estimated.outputs.resize(outputs);
  estimated.even.resize(outputs);
  if (excited.empty()) {
    estimated.remarks.push_back(
        std::string(has_reference ? "no line of the reference" : "no line of the input") +
        " stands above its noise: it has another period, or too few periods or too little power for this one");
    return estimated;
  }
  if (all_excited.others > 0)
    estimated.remarks.push_back(std::to_string(all_excited.others) +
                                " lines of the input are above its noise and less than a quarter of the others: they "
                                "are taken as distortion of the input and not as excitation");
  const bool odd_alone = std::all_of(excited.begin(), excited.end(), [](std::size_t k) { return k % 2 == 1; });
  estimated.all_lines_excited = excited.size() == excited.back() - excited.front() + 1;
  for (std::size_t output = 0; output < outputs; ++output) {
    auto& points = estimated.outputs[output];
    const auto at = static_cast<Eigen::Index>(output) + 1;
    std::vector<double> places(excited.begin(), excited.end());
    std::vector<LineEstimate> here;
    for (const std::size_t k : excited) here.push_back(lines[k - 1]);
    // Each round has the response between the lines from the lines of the one before, which at a resonance the
    // transient may have moved by a quarter; each leaves about as small a part of that.  What depends on lines that
    // move by less than a tenth of their deviation stays as it is.
    constexpr int rounds = 3;
    constexpr double least_move = 0.1;
    // Two lines beyond those that the window reaches.
    const std::size_t side = 2 + neighbours_for(periods) / std::max<std::size_t>(periods - 1, 1);
    std::vector<bool> has_moved(excited.size(), true);
    for (int round = 0; round < rounds; ++round) {
      std::vector<std::complex<double>> values;
      for (const LineEstimate& line : here) values.push_back(line.value(at) / line.value(0));
      const BetweenLines response(places, values);
      const std::vector<bool> moved_before = has_moved;
      for (std::size_t i = 0; i < excited.size(); ++i) {
        const auto first = moved_before.begin() + static_cast<std::ptrdiff_t>(i - std::min(i, side)),
                   last = moved_before.begin() + static_cast<std::ptrdiff_t>(std::min(i + side + 1, excited.size()));
        has_moved[i] =
            std::find(first, last, true) != last && here[i].degrees > 0 && here[i].covariance(at, at).real() > 0;
        if (!has_moved[i]) continue;
        const std::size_t bin = excited[i] * periods;
        const ShapedSum sum = noise_of_loop(here[i], bin, output, static_cast<double>(periods), response);
        LineEstimate line = reader(bin, &sum);
        has_moved[i] =
            std::norm(line.value(at) - here[i].value(at)) > least_move * least_move * line.covariance(at, at).real();
        here[i] = std::move(line);
      }
    }
    for (std::size_t i = 0; i < excited.size(); ++i) {
      const LineEstimate& line = here[i];
      ResponsePoint& point = points.emplace_back();
      const std::size_t bin = excited[i] * periods;
      point.omega = static_cast<double>(bin) * found.spacing;
      point.periods = static_cast<double>(bin);
      set_ratio(line, output, point);
      // Below 10 dB the mean of a ratio is no longer its value, and its error no longer normal (Pintelon, Schoukens
      // 2012, chapter 2).
      constexpr double least_ratio = 10;
      if (point.flag.empty() && !(std::norm(line.value(0)) >= least_ratio * line.covariance(0, 0).real()))
        point.flag = "the input is no stronger than its noise";
    }
    // Where the excitation itself goes so far, nothing tells what its converter makes beyond.
    if (excited.back() + 2 < lines.size() && reaches_half_of_sampling(reader, found, output, points.back(), 1)) {
      std::string remark = "an output ";
      estimated.remarks.push_back(remark += folds_back);
    }
    std::vector<Detection> even, other;
    std::size_t above = 0;
    for (std::size_t k = excited.front(); k < excited.back(); ++k) {
      while (excited[above] <= k) ++above;
      if (excited[above - 1] == k) continue;
      const LineEstimate& line = lines[k - 1];
      if (line.degrees == 0) continue;
      const auto span = static_cast<double>(excited[above] - excited[above - 1]);
      const double share = static_cast<double>(k - excited[above - 1]) / span;
      const std::complex<double> before = points[above - 1].value, after = points[above].value;
      const std::complex<double> value = (1 - share) * before + share * after;
      Eigen::VectorXcd weights = Eigen::VectorXcd::Zero(line.value.size());
      weights(0) = -value;
      weights(static_cast<Eigen::Index>(output) + 1) = 1;
      const LineEstimate::Parts parts = line.parts(weights);
      const double noise = parts.variance_re + parts.variance_im;
      const double rest = std::norm((weights.transpose() * line.value).value());
      // Straight lines through G and through 1/G differ by what either misses, to a factor of 3.  Where that share of
      // the line's own input, which a loop may have made large, can be what is left, it is no distortion.
      const std::complex<double> missed = value - 1.0 / ((1 - share) / before + share / after);
      if (9 * std::norm(missed * line.value(0)) > std::max(noise, rest)) continue;
      (odd_alone && k % 2 == 0 ? even : other).push_back({k, rest, noise});
    }
    for (std::size_t i = 0; i < excited.size(); ++i) {
      const double amplitude = points[i].input_amplitude;
      estimated.even[output].push_back(level_near(even, excited[i], amplitude));
      set_even_distortion(estimated.even[output].back(), points[i]);
      add_distortion(level_near(other, excited[i], amplitude), 2 * lines[excited[i] - 1].degrees, points[i]);
      if (points[i].flag.empty()) continue;
      for (double* each : {&points[i].sigma, &points[i].sigma_re, &points[i].sigma_im, &points[i].noise})
        *each = std::numeric_limits<double>::quiet_NaN();
    }
  }
  return estimated;
}

}  // namespace frac::detail
