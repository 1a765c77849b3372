// SPDX-License-Identifier: BSD-3-Clause
#include "frac/records/record.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>
#include <utility>

#include "base/number_text.hpp"

namespace frac {
namespace {

void require_signal(const std::string& name, const std::vector<double>& signal, std::size_t size) {
  if (signal.size() != size)
    throw std::invalid_argument(name + " has " + std::to_string(signal.size()) + " samples and input " +
                                std::to_string(size) + "; expected as many");
  for (std::size_t i = 0; i < size; ++i)
    if (!std::isfinite(signal[i]))
      throw std::invalid_argument(name + "[" + std::to_string(i) + "] is " + detail::number_text(signal[i]) +
                                  "; expected a finite number");
}

}  // namespace

Record::Record(double sample_time, std::vector<double> input, std::vector<std::vector<double>> outputs,
               std::vector<double> reference, std::vector<RecordGap> gaps)
    : sample_time_(sample_time),
      input_(std::move(input)),
      outputs_(std::move(outputs)),
      reference_(std::move(reference)),
      gaps_(std::move(gaps)) {
  if (!(sample_time > 0) || !std::isfinite(sample_time))
    throw std::invalid_argument("sample_time is " + detail::number_text(sample_time) +
                                "; expected a finite number > 0");
  constexpr std::size_t fewest = 16;
  if (input_.size() < fewest)
    throw std::invalid_argument("input has " + std::to_string(input_.size()) + " samples; expected at least " +
                                std::to_string(fewest));
  if (outputs_.empty()) throw std::invalid_argument("outputs is empty; expected at least one signal");
  require_signal("input", input_, input_.size());
  for (std::size_t i = 0; i < outputs_.size(); ++i)
    require_signal("outputs[" + std::to_string(i) + "]", outputs_[i], input_.size());
  if (!reference_.empty()) require_signal("reference", reference_, input_.size());
  std::size_t earlier = 0;
  for (std::size_t i = 0; i < gaps_.size(); earlier = gaps_[i].before, ++i)
    if (gaps_[i].before <= earlier || gaps_[i].before >= size() || gaps_[i].missing == 0)
      throw std::invalid_argument("gaps[" + std::to_string(i) + "] is " + std::to_string(gaps_[i].missing) +
                                  " samples before sample " + std::to_string(gaps_[i].before) +
                                  "; expected at least one sample, before one of " + std::to_string(earlier + 1) +
                                  " to " + std::to_string(size() - 1));
  const auto [least, most] = std::minmax_element(drive().begin(), drive().end());
  if (*least == *most)
    throw std::invalid_argument((reference_.empty() ? "input is " : "reference is ") + detail::number_text(*least) +
                                " throughout; expected a signal that changes");
}

Record Record::part(std::size_t first, std::size_t count) const {
  const auto cut = [&](const std::vector<double>& signal) {
    if (signal.empty()) return signal;
    const auto begin = signal.begin() + static_cast<std::ptrdiff_t>(first);
    return std::vector<double>(begin, begin + static_cast<std::ptrdiff_t>(count));
  };
  std::vector<std::vector<double>> outputs;
  for (const auto& output : outputs_) outputs.push_back(cut(output));
  return {sample_time_, cut(input_), std::move(outputs), cut(reference_)};
}

// The outermost step of a converter holds at most sqrt(2)/(2 - sqrt(2)) = 2.4 times the samples of a sinusoid that the
// next one holds, arcs of cosine of height q and 2 q; of signals of several lines it holds fewer.
bool is_clipped(const std::vector<double>& signal) {
  constexpr std::size_t few_levels = 8;
  constexpr double most_of_sinusoid = 2.42;
  std::vector<double> levels;  // the first ones met
  // Value and count of the outermost level and of the next one, on either side.
  struct Level {
    double value, count = 0;
  };
  constexpr double infinity = std::numeric_limits<double>::infinity();
  Level least{infinity}, above_least{infinity}, most{-infinity}, below_most{-infinity};
  for (const double value : signal) {
    if (levels.size() < few_levels && std::find(levels.begin(), levels.end(), value) == levels.end())
      levels.push_back(value);
    if (value < least.value) {
      above_least = least;
      least = {value};
    } else if (value > least.value && value < above_least.value) {
      above_least = {value};
    }
    if (value > most.value) {
      below_most = most;
      most = {value};
    } else if (value < most.value && value > below_most.value) {
      below_most = {value};
    }
    for (Level* each : {&least, &above_least, &most, &below_most})
      if (value == each->value) ++each->count;
  }
  if (levels.size() < few_levels) return false;
  // Counts scatter by their root: four deviations of the difference.
  const auto sticks = [](double outermost, double next) {
    return outermost - most_of_sinusoid * next > 4 * std::sqrt(outermost + most_of_sinusoid * most_of_sinusoid * next);
  };
  return sticks(most.count, below_most.count) || sticks(least.count, above_least.count);
}

std::optional<Standstill> stuck_samples(const std::vector<double>& signal) {
  constexpr std::size_t fewest = 14;
  constexpr double steps = 4, most_share = 0.25;
  double motion = 0, converter_step = std::numeric_limits<double>::infinity();
  for (std::size_t i = 1; i < signal.size(); ++i) {
    const double step = std::abs(signal[i] - signal[i - 1]);
    motion += step;
    if (step > 0) converter_step = std::min(converter_step, step);
  }
  // Differences of decimal numbers err by rounding.
  const double jump = (1 - 1e-6) * steps * converter_step;
  double out_of_rest = 0;
  std::vector<Standstill> runs;  // before a jump
  std::vector<double> rests;     // values of all runs
  for (std::size_t first = 0, end = 1; end <= signal.size(); ++end) {
    if (end < signal.size() && signal[end] == signal[first]) continue;
    const double step = end < signal.size() ? std::abs(signal[end] - signal[first]) : 0;
    const std::size_t count = end - first;
    if (count > 1 && step >= jump) out_of_rest += step;
    if (count >= fewest) rests.push_back(signal[first]);
    if (count >= fewest && first > 0 && step >= jump) runs.push_back({first, count});
    first = end;
  }
  std::optional<Standstill> longest;
  if (out_of_rest > most_share * motion) return longest;
  std::sort(rests.begin(), rests.end());
  for (const Standstill& run : runs) {
    const auto [begin, end] = std::equal_range(rests.begin(), rests.end(), signal[run.first]);
    if (end - begin == 1 && (!longest || run.count > longest->count)) longest = run;
  }
  return longest;
}

}  // namespace frac
