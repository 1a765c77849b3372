// SPDX-License-Identifier: BSD-3-Clause
#include "frac/records/excitation.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <numeric>
#include <stdexcept>
#include <string>
#include <unsupported/Eigen/FFT>

#include "base/median.hpp"
#include "frac/cancellation.hpp"
#include "records/chirp_transform.hpp"
#include "records/fold.hpp"
#include "records/sine_period.hpp"
#include "records/whole_periods.hpp"
#include "special/distributions.hpp"

namespace frac {
namespace {

double mean_of(const std::vector<double>& signal) {
  return std::accumulate(signal.begin(), signal.end(), 0.0) / static_cast<double>(signal.size());
}

/// Sums of the products of a signal without its mean and itself so many samples later, by lag.
std::vector<std::complex<double>> lagged_products(const std::vector<double>& signal) {
  const std::size_t count = signal.size();
  const double mean = mean_of(signal);
  std::vector<std::complex<double>> time(detail::fast_length(2 * count)), spectrum;
  for (std::size_t i = 0; i < count; ++i) time[i] = signal[i] - mean;
  Eigen::FFT<double> fft;
  fft.fwd(spectrum, time);
  for (auto& each : spectrum) each = std::norm(each);
  fft.inv(time, spectrum);
  return time;
}

/// Correlation of a signal without its mean at lags up to half of its length, over that at lag 0; each as a mean over
/// the pairs of samples it has.
std::vector<double> correlation_of(const std::vector<double>& signal) {
  const std::size_t count = signal.size();
  const auto products = lagged_products(signal);
  std::vector<double> correlation(count / 2 + 2);
  for (std::size_t lag = 0; lag < correlation.size(); ++lag)
    correlation[lag] =
        products[lag].real() / products[0].real() * static_cast<double>(count) / static_cast<double>(count - lag);
  return correlation;
}

struct Summit {
  double lag, height;
};

/// Of the parabola through three neighbours, of which the middle one is highest.
Summit summit_at(const std::vector<double>& curve, std::size_t middle) {
  const double before = curve[middle - 1], at = curve[middle], after = curve[middle + 1];
  const double bend = before - 2 * at + after;
  const double shift = bend < 0 ? 0.5 * (before - after) / bend : 0;
  return {static_cast<double>(middle) + shift, at - 0.25 * (before - after) * shift};
}

/// Powers of the lines of a signal over whole periods.
class LinePowers {
 public:
  LinePowers(const std::vector<double>& signal, double period)
      : periods_(detail::whole_periods(signal.size(), period)) {
    const auto exact = static_cast<double>(periods_) * period;
    const auto length = std::min(static_cast<std::size_t>(std::lround(exact)), signal.size());
    std::vector<double> part(signal.end() - static_cast<std::ptrdiff_t>(length), signal.end());
    const double mean = mean_of(part);
    for (double& each : part) each -= mean;
    for (const auto& line : detail::ChirpTransform(length, exact, length / 2)(part.data()))
      powers_.push_back(std::norm(line));
  }
  /// Power of the lines that are none of the period.
  [[nodiscard]] double between() const {
    double sum = 0;
    for (std::size_t i = 1; i < powers_.size(); ++i)
      if (i % periods_ != 0) sum += powers_[i];
    return sum;
  }
  /// Whether every n-th line of the period alone is stronger than what lies beside it: three lines on each side, twelve
  /// degrees of freedom.  The chance to be wrong is 1e-3 over all lines.
  [[nodiscard]] bool repeat_in(std::size_t parts) const {
    constexpr double rounding = 1e-12, chance = 1e-3;
    constexpr std::size_t wanted = 6;
    const double largest = *std::max_element(powers_.begin(), powers_.end());
    const std::size_t line_count = powers_.size() / periods_;
    const auto lines = static_cast<double>(line_count);
    for (std::size_t i = periods_; i < powers_.size(); i += periods_) {
      if (i / periods_ % parts == 0 || powers_[i] < rounding * largest) continue;
      double beside = 0;
      std::size_t count = 0;
      for (std::size_t distance = 1; count < wanted && distance < powers_.size(); ++distance) {
        if (distance % periods_ == 0) continue;
        for (const std::size_t at : {i - distance, i + distance}) {
          if (at == 0 || at >= powers_.size()) continue;  // also below 0
          beside += powers_[at];
          ++count;
        }
      }
      if (count == 0 || beside == 0) return false;
      const auto degrees = 2 * static_cast<double>(count);
      if (detail::fisher_f_above(powers_[i] * static_cast<double>(count) / beside, 2, degrees) < chance / lines)
        return false;
    }
    return true;
  }

 private:
  std::size_t periods_;
  std::vector<double> powers_;
};

/// A period from the phases of its lines between both halves of the signal: those of another one run away with the
/// line.
double phased(double period, const std::vector<double>& signal) {
  for (int round = 0; round < 4; ++round) {
    if (!(period >= 1)) return period;
    const std::size_t periods = detail::whole_periods(signal.size(), period) / 2;
    if (periods < 1) return period;
    const auto half = static_cast<std::size_t>(std::lround(static_cast<double>(periods) * period));
    if (2 * half > signal.size()) return period;
    const detail::ChirpTransform transform(half, period, static_cast<std::size_t>(period / 2));
    const auto first = transform(signal.data()), second = transform(signal.data() + half);
    const double turned = std::fmod(static_cast<double>(half), period) / period;
    double above = 0, below = 0;
    for (std::size_t k = 1; k < first.size(); ++k) {
      const double line = static_cast<double>(k), power = std::abs(first[k] * second[k]);
      const double phase = std::arg(second[k] * std::conj(first[k]) *
                                    std::polar(1.0, -2 * std::numbers::pi * std::fmod(line * turned, 1)));
      above += power * line * phase;
      below += power * line * line;
    }
    const double rate = above / below / (2 * std::numbers::pi * static_cast<double>(half));
    if (!std::isfinite(rate) || std::abs(rate) * period > 0.01) return period;
    period = 1 / (1 / period + rate);
  }
  return period;
}

/// The period as a whole number of samples where that leaves as little between the lines: a clock that runs with the
/// generator.  Half a per cent is within the scatter of both powers.
double with_whole_samples(double period, const std::vector<double>& signal) {
  period = phased(period, signal);
  const double whole = std::round(period);
  if (whole == period || !(std::abs(period - whole) <= 0.1) || whole < 1) return period;
  return LinePowers(signal, whole).between() <= 1.005 * LinePowers(signal, period).between() ? whole : period;
}

/// The lag of a summit, from its multiples: the parabola errs by the same part of a sample at every one of them.
double refined(const std::vector<double>& correlation, double period, const std::vector<double>& signal) {
  for (double multiple = 2; multiple * period + 2 < static_cast<double>(correlation.size()); multiple *= 2) {
    auto lag = static_cast<std::size_t>(std::lround(multiple * period));
    if (correlation[lag + 1] > correlation[lag]) ++lag;
    if (correlation[lag - 1] > correlation[lag]) --lag;
    if (lag + 1 >= correlation.size()) break;
    period = summit_at(correlation, lag).lag / multiple;
  }
  return with_whole_samples(period, signal);
}

/// Slope of a straight line through instants, where all are nearer to it than a sample.
std::optional<double> equal_distance(const std::vector<double>& instants) {
  const double middle = 0.5 * static_cast<double>(instants.size() - 1), mean = mean_of(instants);
  double above = 0, below = 0;
  for (std::size_t i = 0; i < instants.size(); ++i) {
    const double place = static_cast<double>(i) - middle;
    above += place * (instants[i] - mean);
    below += place * place;
  }
  const double slope = above / below;
  for (std::size_t i = 0; i < instants.size(); ++i)
    if (std::abs(instants[i] - mean - (static_cast<double>(i) - middle) * slope) >= 1) return std::nullopt;
  return slope;
}

}  // namespace

std::string_view to_string(Excitation excitation) {
  switch (excitation) {
    case Excitation::periodic:
      return "periodic";
    case Excitation::stepped_sine:
      return "stepped-sine";
    case Excitation::arbitrary:
      break;
  }
  return "arbitrary";
}

std::optional<double> period_of(const std::vector<double>& signal) {
  constexpr double larger_share = 0.5;
  if (signal.size() > detail::long_record) {
    // The beginning tells a period of whole samples as well.
    const auto found = period_of({signal.begin(), signal.begin() + detail::long_record});
    if (found && *found == std::round(*found) && detail::keeps_to(signal, static_cast<std::size_t>(*found)))
      return found;
  }
  const std::vector<double> correlation = correlation_of(signal);
  std::size_t first = 0;
  while (first < correlation.size() && correlation[first] > larger_share) ++first;
  std::vector<Summit> summits;
  Summit best{0, larger_share};
  for (std::size_t lag = std::max<std::size_t>(first, 1); lag + 1 < correlation.size(); ++lag) {
    if (correlation[lag] < larger_share || correlation[lag] < correlation[lag - 1] ||
        correlation[lag] < correlation[lag + 1])
      continue;
    summits.push_back(summit_at(correlation, lag));
    if (summits.back().height >= best.height) best = summits.back();
  }
  if (summits.empty()) return std::nullopt;
  const double longest = refined(correlation, best.lag, signal);
  if (!(longest >= 1)) return std::nullopt;
  // Multiples of the period correlate as well as itself.  A part of the longest lag is the period where the lines of
  // the longest that it has not are no stronger than those between.
  const LinePowers powers(signal, longest);
  for (const Summit& summit : summits) {
    const double parts = std::round(longest / summit.lag);
    if (parts > 1 && std::abs(longest / parts - summit.lag) < 1 && powers.repeat_in(static_cast<std::size_t>(parts)))
      return with_whole_samples(longest / parts, signal);
  }
  return longest;
}

std::optional<double> repeats_once_after(const std::vector<double>& signal) {
  const std::size_t count = signal.size();
  if (count < 16 || count > detail::long_record) return std::nullopt;
  const double mean = mean_of(signal);
  // Of the first samples: their squares, and how often they cross the mean.
  std::vector<double> squares{0};
  std::vector<std::size_t> crossings{0};
  for (std::size_t i = 0; i < count; ++i) {
    squares.push_back(squares.back() + (signal[i] - mean) * (signal[i] - mean));
    crossings.push_back(crossings.back() + (i > 0 && (signal[i - 1] < mean) != (signal[i] < mean) ? 1 : 0));
  }
  const auto products = lagged_products(signal);
  std::vector<double> alike(count);
  for (std::size_t lag = count / 2; lag < count; ++lag) {
    const double both = squares[count - lag] + squares[count] - squares[lag];
    alike[lag] = both > 0 ? 2 * products[lag].real() / both : 0;
  }
  constexpr double chance = 1e-6, rounding = 1e-12;
  double least = std::log(chance / static_cast<double>(count));
  std::optional<double> found;
  for (std::size_t lag = count / 2 + 1; lag + 1 < count; ++lag) {
    if (alike[lag] < 0.5 || alike[lag] < alike[lag - 1] || alike[lag] < alike[lag + 1]) continue;
    const Summit summit = summit_at(alike, lag);
    // A stretch that crosses its mean n times has n degrees of freedom or more; that the directions of two such ones
    // agree so far has at most this chance.
    const double exponent = 0.5 * (static_cast<double>(crossings[count - lag]) - 1);
    const double logarithm = exponent * std::log(2 * std::max(1 - summit.height, rounding));
    if (logarithm >= least) continue;
    least = logarithm;
    found = summit.lag;
  }
  return found;
}

std::vector<SineSegment> sine_segments(const std::vector<double>& signal) {
  const double mean = mean_of(signal);
  std::vector<double> bends;
  double power = 0;
  // Of a long signal some tell the noise.
  const std::size_t stride = 1 + signal.size() / detail::long_record;
  for (std::size_t i = 0; i < signal.size(); ++i) {
    power += (signal[i] - mean) * (signal[i] - mean);
    if (i > 0 && i + 1 < signal.size() && i % stride == 0)
      bends.push_back(std::abs(signal[i - 1] - 2 * signal[i] + signal[i + 1]) / std::sqrt(6.0));
  }
  // A passage counts where the signal then leaves the noise; of few samples per cycle the bends are the signal's own.
  const double hysteresis =
      std::min(4 * detail::robust_deviation(bends), 0.3 * std::sqrt(power / static_cast<double>(signal.size())));
  struct Cycle {
    double begin, length, height;
  };
  std::vector<Cycle> cycles;
  std::optional<double> passage, last;
  bool armed = false;
  double least = 0, most = 0;
  for (std::size_t i = 1; i < signal.size(); ++i) {
    const double before = signal[i - 1] - mean, at = signal[i] - mean;
    least = std::min(least, at);
    most = std::max(most, at);
    if (at < -hysteresis) armed = true;
    if (armed && before < 0 && at >= 0) passage = static_cast<double>(i - 1) + before / (before - at);
    if (!armed || !passage || at <= hysteresis) continue;
    if (last) cycles.push_back({*last, *passage - *last, most - least});
    last = passage;
    passage.reset();
    armed = false;
    least = most = 0;
  }
  if (cycles.size() < 4) return {};
  // A quarter of the neighbours or more belong to one segment, of whose normal scatter that quantile is 0.3186
  // deviations; a sweep has no second difference.
  const auto scatter_of = [&](double Cycle::*member) {
    std::vector<double> differences;
    for (std::size_t i = 1; i + 1 < cycles.size(); ++i)
      differences.push_back(std::abs(cycles[i - 1].*member - 2 * cycles[i].*member + cycles[i + 1].*member) /
                            (std::sqrt(6.0) * cycles[i].*member));
    const auto quarter = differences.begin() + static_cast<std::ptrdiff_t>(differences.size() / 4);
    std::nth_element(differences.begin(), quarter, differences.end());
    return *quarter / 0.3186;
  };
  constexpr double most_scatter = 0.03, deviations = 6;
  const double of_length = scatter_of(&Cycle::length), of_height = scatter_of(&Cycle::height);
  if (of_length > most_scatter || of_height > most_scatter) return {};
  // A chord misses the passage of a sine by up to h^3 sqrt(3)/108 rad, samples its summit by up to h^2/8, where h rad
  // are between two samples.
  const auto is_like = [&](const Cycle& cycle, double length, double height) {
    const double step = 2 * std::numbers::pi / length;
    return std::abs(cycle.length - length) <=
               (deviations * of_length + 4 * step * step * step * std::sqrt(3) / 108 / (2 * std::numbers::pi)) *
                   length &&
           std::abs(cycle.height - height) <= (deviations * of_height + step * step / 8) * height;
  };
  std::vector<SineSegment> segments;
  for (std::size_t begin = 0; begin < cycles.size();) {
    throw_if_cancelled();
    double length = 0, height = 0;
    std::size_t end = begin;
    while (end < cycles.size()) {
      const auto count = static_cast<double>(end - begin);
      if (end > begin && !is_like(cycles[end], length / count, height / count)) break;
      length += cycles[end].length;
      height += cycles[end].height;
      ++end;
    }
    // The cycles beside another segment may hold its end or its beginning.
    const std::size_t next = end;
    if (begin > 0) ++begin;
    if (end < cycles.size()) --end;
    if (end >= begin + 3) {
      SineSegment segment;
      segment.first = static_cast<std::size_t>(std::ceil(cycles[begin].begin));
      const double stop = cycles[end - 1].begin + cycles[end - 1].length;
      segment.count = static_cast<std::size_t>(std::floor(stop)) - segment.first + 1;
      segment.period = detail::sine_period(signal.data() + segment.first, segment.count,
                                           (stop - cycles[begin].begin) / static_cast<double>(end - begin));
      // As many as a record needs.
      constexpr std::size_t fewest_samples = 16;
      if (segment.count >= fewest_samples &&
          detail::share_of_sine(signal.data() + segment.first, segment.count, segment.period) >= 0.9)
        segments.push_back(segment);
    }
    begin = next;
  }
  return segments;
}

Excitation excitation_of(const Record& record) {
  std::size_t covered = 0;
  for (const SineSegment& segment : sine_segments(record.drive())) covered += segment.count;
  if (2 * covered > record.size()) return Excitation::stepped_sine;
  return period_of(record.drive()) ? Excitation::periodic : Excitation::arbitrary;
}

std::vector<double> trigger_instants(const std::vector<double>& trigger) {
  const auto [least, most] = std::minmax_element(trigger.begin(), trigger.end());
  const double middle = 0.5 * (*least + *most), quarter = 0.25 * (*most - *least);
  std::vector<double> instants;
  double passage = 0;
  bool armed = false, passed = false;
  for (std::size_t i = 0; i < trigger.size(); ++i) {
    if (trigger[i] < middle - quarter) armed = true;
    if (armed && i > 0 && trigger[i - 1] < middle && trigger[i] >= middle) {
      passed = true;
      passage = static_cast<double>(i - 1) + (middle - trigger[i - 1]) / (trigger[i] - trigger[i - 1]);
    }
    if (!armed || !passed || trigger[i] <= middle + quarter) continue;
    instants.push_back(passage);
    armed = passed = false;
  }
  constexpr std::size_t fewest = 3;
  if (instants.size() < fewest)
    throw std::invalid_argument("trigger rises " + std::to_string(instants.size()) +
                                " times; expected at least 3, one in each period");
  return instants;
}

std::optional<double> period_of(const std::vector<double>& signal, const std::vector<double>& instants) {
  const auto period = equal_distance(instants);
  return period ? std::optional(with_whole_samples(*period, signal)) : std::nullopt;
}

std::vector<double> cosine_of(std::vector<double> instants, const std::vector<double>& answer) {
  if (const auto period = period_of(answer, instants)) {
    const double middle = 0.5 * static_cast<double>(instants.size() - 1), mean = mean_of(instants);
    for (std::size_t i = 0; i < instants.size(); ++i) instants[i] = mean + (static_cast<double>(i) - middle) * *period;
  }
  std::vector<double> cosine(answer.size());
  std::size_t next = 1;
  for (std::size_t i = 0; i < cosine.size(); ++i) {
    const auto at = static_cast<double>(i);
    while (next + 1 < instants.size() && at >= instants[next]) ++next;
    cosine[i] = std::cos(2 * std::numbers::pi * (at - instants[next - 1]) / (instants[next] - instants[next - 1]));
  }
  return cosine;
}

}  // namespace frac
