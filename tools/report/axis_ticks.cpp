// SPDX-License-Identifier: BSD-3-Clause
#include "report/axis_ticks.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdlib>
#include <optional>

namespace report {

namespace {

// digits 10^exponent.  What a label says is then what the tick is at, without rounding.
struct Decimal {
  long long digits;
  int exponent;
  [[nodiscard]] double value() const {
    return std::strtod((std::to_string(digits) + "e" + std::to_string(exponent)).c_str(), nullptr);
  }
};

constexpr const char* minus = "\u2212";

// Decimal text of digits 10^-places without zeros at its end.
std::string with_point(std::string digits, int places) {
  if (places <= 0) return digits + std::string(static_cast<std::size_t>(-places), '0');
  const auto count = static_cast<std::size_t>(places);
  if (digits.size() <= count) digits.insert(0, count + 1 - digits.size(), '0');
  std::string fraction = digits.substr(digits.size() - count);
  digits.resize(digits.size() - count);
  while (!fraction.empty() && fraction.back() == '0') fraction.pop_back();
  return fraction.empty() ? digits : digits + "." + fraction;
}

std::string power_of_ten(int exponent) {
  return "10^{" + (exponent < 0 ? minus : std::string()) + std::to_string(std::abs(exponent)) + "}";
}

std::string label_of(const Decimal& number, bool scientific) {
  if (number.digits == 0) return "0";
  const std::string sign = number.digits < 0 ? minus : "";
  const std::string digits = std::to_string(std::abs(number.digits));
  if (!scientific) return sign + with_point(digits, -number.exponent);
  const int places = static_cast<int>(digits.size()) - 1;
  return sign + with_point(digits, places) + "\u00d7" + power_of_ten(number.exponent + places);
}

// Characters of a label; those of an exponent are smaller.
double width_of(const std::string& label) {
  double width = 0;
  bool raised = false;
  for (const char c : label) {
    if (c == '^') raised = true;
    const bool markup = c == '^' || c == '{' || c == '}';
    if (!markup && (static_cast<unsigned char>(c) & 0xC0U) != 0x80U) width += raised ? 0.8 : 1;
  }
  return width;
}

// One notation for all labels of an axis: powers of ten where they save two characters.
std::vector<Tick> labelled(const std::vector<Decimal>& numbers) {
  std::vector<Tick> with[2];
  double width[2] = {0, 0};
  for (const bool scientific : {false, true}) {
    for (const Decimal& number : numbers) {
      with[scientific].push_back({number.value(), label_of(number, scientific)});
      width[scientific] = std::max(width[scientific], width_of(with[scientific].back().label));
    }
  }
  return with[width[true] + 2 <= width[false]];
}

// Px of a character of the wider of the two fonts in use, and what stays free between labels.
constexpr double character_width = 8.5;
constexpr double gap_beside = 12;
constexpr double line_height = 20;
constexpr std::size_t most_labels = 10;

double place_of(const DrawnAxis& axis, double value) {
  const double share = axis.logarithmic ? std::log(value / axis.from) / std::log(axis.to / axis.from)
                                        : (value - axis.from) / (axis.to - axis.from);
  return share * axis.length;
}

bool stand_free(const DrawnAxis& axis, const Tick& one, const Tick& next) {
  const double needed =
      axis.vertical ? line_height : gap_beside + character_width * (width_of(one.label) + width_of(next.label)) / 2;
  return place_of(axis, next.value) - place_of(axis, one.value) >= needed;
}

bool fits(const DrawnAxis& axis, const std::vector<Tick>& ticks) {
  if (ticks.size() < 2 || ticks.size() > most_labels) return false;
  for (std::size_t i = 1; i < ticks.size(); ++i)
    if (!stand_free(axis, ticks[i - 1], ticks[i])) return false;
  return true;
}

// The first, the last, and of those between what stands free.
std::vector<Tick> freed(const DrawnAxis& axis, const std::vector<Tick>& ticks) {
  if (ticks.size() < 2) return ticks;
  std::vector<Tick> kept{ticks.front()};
  for (std::size_t i = 1; i + 1 < ticks.size(); ++i)
    if (stand_free(axis, kept.back(), ticks[i]) && stand_free(axis, ticks[i], ticks.back())) kept.push_back(ticks[i]);
  kept.push_back(ticks.back());
  return kept;
}

// Rounding must not lose a tick at an end.
bool is_inside(const DrawnAxis& axis, double value) {
  if (axis.logarithmic && value <= 0) return false;
  const double share = place_of(axis, value) / axis.length;
  return share > -1e-9 && share < 1 + 1e-9;
}

// Mantissa in tenths times a power of ten, over all decades of the axis.
std::vector<Decimal> in_each_decade(const DrawnAxis& axis, const std::vector<int>& tenths) {
  std::vector<Decimal> numbers;
  for (int decade = static_cast<int>(std::floor(std::log10(axis.from))) - 1; decade <= std::log10(axis.to) + 1;
       ++decade) {
    for (const int mantissa : tenths) {
      const Decimal number{mantissa, decade - 1};
      if (is_inside(axis, number.value())) numbers.push_back(number);
    }
  }
  return numbers;
}

// Adds small ticks where no labelled one stands.
std::vector<Tick> with_small_ticks(std::vector<Tick> ticks, const std::vector<Decimal>& small) {
  for (const Decimal& number : small) {
    const double value = number.value();
    const auto same = [value](const Tick& tick) { return std::abs(tick.value - value) <= 1e-9 * std::abs(value); };
    if (std::none_of(ticks.begin(), ticks.end(), same)) ticks.push_back({value, ""});
  }
  std::sort(ticks.begin(), ticks.end(), [](const Tick& a, const Tick& b) { return a.value < b.value; });
  return ticks;
}

std::vector<Tick> powers_of_ten(const DrawnAxis& axis) {
  const std::vector<Decimal> powers = in_each_decade(axis, {10});
  // "10^{-12}" with what stays free beside it takes 50 px.
  const double most = std::clamp(axis.length / (axis.vertical ? 40 : 50), 3.0, static_cast<double>(most_labels));
  const int step = static_cast<int>(std::ceil(std::log10(axis.to / axis.from) / most));
  const auto every = [&](int remainder) {
    std::vector<Tick> ticks;
    for (const Decimal& power : powers) {
      const int exponent = power.exponent + 1;
      if ((exponent % step + step) % step == remainder) ticks.push_back({power.value(), power_of_ten(exponent)});
    }
    return ticks;
  };
  std::vector<Tick> ticks = every(0);
  // Multiples of the step, unless only one is on the axis; counted from the lowest power there are two.
  if (ticks.size() < 2) ticks = every(((powers.front().exponent + 1) % step + step) % step);
  return with_small_ticks(std::move(ticks), step > 1 ? powers : in_each_decade(axis, {20, 30, 40, 50, 60, 70, 80, 90}));
}

std::vector<TickStep> rising_steps(double span, bool degrees) {
  const int highest = static_cast<int>(std::floor(std::log10(span)));
  std::vector<TickStep> steps;
  // Parts of a right angle, and of more than one turn whole ones.
  if (degrees && span > 1 && highest < 4) {
    for (const int tenths : {1, 2, 5}) steps.push_back({tenths, -1});
    for (const int step : {1, 2, 5, 15, 45, 90, 180, 360}) steps.push_back({step, 0});
    for (const int turns : {2, 5, 10}) steps.push_back({360 * turns, 0});
    return steps;
  }
  for (int exponent = highest - 2; exponent <= highest; ++exponent)
    for (const int mantissa : {1, 2, 5}) steps.push_back({mantissa, exponent});
  return steps;
}

}  // namespace

double TickStep::value() const {
  return Decimal{mantissa, exponent}.value();
}

TickStep tick_step(const DrawnAxis& axis) {
  const double span = axis.to - axis.from;
  std::optional<TickStep> coarsest;
  for (const TickStep& step : rising_steps(span, axis.degrees)) {
    if (span > 200 * step.value()) continue;
    const std::vector<Tick> ticks = ticks_at(axis, step);
    if (coarsest && ticks.size() < 2) break;
    coarsest = step;
    if (fits(axis, ticks)) break;
  }
  return *coarsest;
}

std::vector<Tick> ticks_at(const DrawnAxis& axis, const TickStep& step) {
  const double length = step.value();
  std::vector<Decimal> numbers;
  const auto last = static_cast<long long>(std::floor(axis.to / length)) + 1;
  for (auto index = static_cast<long long>(std::ceil(axis.from / length)) - 1; index <= last; ++index) {
    const Decimal number{index * step.mantissa, step.exponent};
    if (is_inside(axis, number.value())) numbers.push_back(number);
  }
  return labelled(numbers);
}

std::vector<Tick> axis_ticks(const DrawnAxis& axis) {
  if (axis.logarithmic && axis.to / axis.from > 400) return powers_of_ten(axis);
  std::vector<std::vector<Tick>> candidates;
  if (axis.logarithmic)
    for (const auto& tenths : {std::vector<int>{10, 15, 20, 30, 40, 50, 70}, std::vector<int>{10, 20, 50},
                               std::vector<int>{10, 30}, std::vector<int>{10}})
      candidates.push_back(labelled(in_each_decade(axis, tenths)));
  const std::size_t in_decades = candidates.size();
  for (const TickStep& step : rising_steps(axis.to - axis.from, axis.degrees))
    candidates.push_back(ticks_at(axis, step));
  // The first whose labels all stand free; a third label tells a logarithmic axis from a linear one.
  const std::size_t fewest = axis.logarithmic ? 3 : 2;
  std::size_t chosen = 0;
  while (chosen < candidates.size() && !(candidates[chosen].size() >= fewest && fits(axis, candidates[chosen])))
    ++chosen;
  if (chosen == candidates.size()) {
    // Long labels on a short axis: the most that can stand.
    chosen = 0;
    std::size_t most = 0;
    for (std::size_t i = 0; i < candidates.size(); ++i) {
      candidates[i] = freed(axis, candidates[i]);
      if (candidates[i].size() <= most || !fits(axis, candidates[i])) continue;
      most = candidates[i].size();
      chosen = i;
    }
  }
  if (chosen >= in_decades) return candidates[chosen];
  return with_small_ticks(std::move(candidates[chosen]), in_each_decade(axis, {10, 20, 30, 40, 50, 60, 70, 80, 90}));
}

}  // namespace report
