// SPDX-License-Identifier: BSD-3-Clause
// What libc++ 13 of Debian's emscripten lacks of C++20 and the program uses, included before every source of the
// browser's build: numbers as text, algorithms over ranges, threads with a stop, of which
// a page has none; and where it draws other random numbers than libstdc++.
#pragma once
#if __cplusplus >= 202002L
#include <algorithm>
#include <cctype>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <condition_variable>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <functional>
#include <iterator>
#include <random>
#include <string>
#include <system_error>
#include <utility>

namespace std {

/// The general format; strtod of musl rounds correctly.
inline from_chars_result from_chars(const char* first, const char* last, double& value) {
  const char* end = first;
  while (end != last &&
         (std::isalnum(static_cast<unsigned char>(*end)) != 0 || std::strchr("+-._()", *end) != nullptr) &&
         *end != '\0')
    ++end;
  std::string text(first, end);
  const std::size_t start = text.rfind('-', 0) == 0 ? 1 : 0;
  if (start == text.size() || std::strchr("+-", text[start]) != nullptr) return {first, errc::invalid_argument};
  // Hexadecimal digits are another format: of "0x1" the zero is the number.
  if (text[start] == '0' && start + 1 < text.size() && (text[start + 1] | 0x20) == 'x') text.resize(start + 1);
  char* stop = nullptr;
  errno = 0;
  const double read = std::strtod(text.c_str(), &stop);
  if (stop == text.c_str()) return {first, errc::invalid_argument};
  const char* const after = first + (stop - text.c_str());
  if (errno == ERANGE && (read == 0 || std::isinf(read))) return {after, errc::result_out_of_range};
  value = read;
  return {after, errc{}};
}

/// The fewest digits that tell the number from its neighbours, written the shorter way.  A decimal of 15 digits
/// survives the way through a double, so that 15 digits without trailing zeros are the fewest wherever 15 are enough.
inline to_chars_result to_chars(char* first, char* last, double value) {
  char text[400];
  if (!std::isfinite(value)) {
    std::snprintf(text, sizeof text, "%s%s", std::signbit(value) ? "-" : "", std::isnan(value) ? "nan" : "inf");
  } else {
    for (int digits = std::fpclassify(value) == FP_SUBNORMAL ? 0 : 14; digits <= 16; ++digits) {
      std::snprintf(text, sizeof text, "%.*e", digits, value);
      if (std::strtod(text, nullptr) == value) break;
    }
    char* const mark = std::strchr(text, 'e');
    const int exponent = std::atoi(mark + 1);
    const std::string sign = text[0] == '-' ? "-" : "";
    std::string digits(text + sign.size(), mark);
    if (digits.size() > 1) digits.erase(1, 1);
    digits.erase(digits.find_last_not_of('0') == std::string::npos ? 1 : digits.find_last_not_of('0') + 1);
    const int count = static_cast<int>(digits.size());
    const std::string scientific = digits.substr(0, 1) + (count > 1 ? "." + digits.substr(1) : "") + std::string(mark);
    const int length = exponent >= count - 1 ? exponent + 1 : exponent >= 0 ? count + 1 : count + 1 - exponent;
    std::string chosen = scientific;
    if (length <= static_cast<int>(scientific.size())) {
      if (exponent >= count - 1) {
        std::snprintf(text, sizeof text, "%.0f", std::abs(value));
        chosen = text;
      } else if (exponent >= 0) {
        chosen = digits.substr(0, static_cast<std::size_t>(exponent) + 1) + "." +
                 digits.substr(static_cast<std::size_t>(exponent) + 1);
      } else {
        chosen = "0." + std::string(static_cast<std::size_t>(-exponent - 1), '0') + digits;
      }
    }
    std::snprintf(text, sizeof text, "%s%s", sign.c_str(), chosen.c_str());
  }
  const std::size_t size = std::strlen(text);
  if (size > static_cast<std::size_t>(last - first)) return {last, errc::value_too_large};
  std::memcpy(first, text, size);
  return {first + size, errc{}};
}

namespace ranges {

template <class Range, class Test>
constexpr bool all_of(const Range& range, Test test) {
  return std::all_of(std::begin(range), std::end(range), test);
}
template <class Range, class Test>
constexpr bool any_of(const Range& range, Test test) {
  return std::any_of(std::begin(range), std::end(range), test);
}
template <class Range, class Test>
constexpr bool none_of(const Range& range, Test test) {
  return std::none_of(std::begin(range), std::end(range), test);
}
template <class Range, class Value, class Part = identity>
constexpr auto find(Range&& range, const Value& value, Part part = {}) {
  return std::find_if(std::begin(range), std::end(range),
                      [&](const auto& each) { return std::invoke(part, each) == value; });
}
template <class Range, class Order = std::less<>, class Part = identity>
constexpr void sort(Range&& range, Order order = {}, Part part = {}) {
  std::sort(std::begin(range), std::end(range),
            [&](const auto& a, const auto& b) { return order(std::invoke(part, a), std::invoke(part, b)); });
}
template <class Range, class Order = std::less<>, class Part = identity>
void stable_sort(Range&& range, Order order = {}, Part part = {}) {
  std::stable_sort(std::begin(range), std::end(range),
                   [&](const auto& a, const auto& b) { return order(std::invoke(part, a), std::invoke(part, b)); });
}

}  // namespace ranges

/// The draws of libstdc++ (polar method of Marsaglia, the second number of each pair first), so that a seed gives the
/// same numbers in the page.
template <class Real>
class normal_distribution_of_pairs {
 public:
  template <class Engine>
  Real operator()(Engine& engine) {
    if (has_saved_) {
      has_saved_ = false;
      return saved_;
    }
    Real x, y, square;
    do {
      x = 2 * unit(engine) - 1;
      y = 2 * unit(engine) - 1;
      square = x * x + y * y;
    } while (square > 1 || square == 0);
    const Real factor = std::sqrt(-2 * std::log(square) / square);
    saved_ = x * factor;
    has_saved_ = true;
    return y * factor;
  }

 private:
  template <class Engine>
  static Real unit(Engine& engine) {
    static_assert(Engine::min() == 0 && Engine::max() == ~0ULL);
    const Real value = static_cast<Real>(engine()) / Real(18446744073709551616.0);
    return value < 1 ? value : std::nextafter(Real(1), Real(0));
  }
  Real saved_ = 0;
  bool has_saved_ = false;
};

class stop_token {
 public:
  [[nodiscard]] bool stop_requested() const noexcept { return true; }
};

/// No further thread is to be had.
class jthread {
 public:
  jthread() noexcept = default;
  template <class Work>
  explicit jthread(Work&&) {
    throw system_error(make_error_code(errc::resource_unavailable_try_again), "a page has no threads");
  }
  [[nodiscard]] bool joinable() const noexcept { return false; }
  void join() {}
  bool request_stop() noexcept { return false; }
};

class stoppable_condition : public condition_variable_any {
 public:
  template <class Lock, class Duration, class Test>
  bool wait_for(Lock&, const stop_token&, const Duration&, Test test) {
    return test();
  }
};

}  // namespace std

#define condition_variable_any stoppable_condition
#define normal_distribution normal_distribution_of_pairs
#endif
