// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <complex>
#include <concepts>
#include <cstddef>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

namespace frac {

// Each result has one description, a function template
//     describe(result, visit)
// that calls visit(name, unit, meaning, value) for each of its numbers, flags, texts and lists, once and in order.
// JSON, CSV, the attributes of the Python module and their pickles, its documentation and `fracfit describe` are made
// by such visitors: a new number is one line in the description of its result.  Descriptions stand in describe.hpp
// beside the headers of the results, which they do not include.

/// Name of a number in every output: key of JSON, column of CSV, attribute in Python.
struct OutputName {
  constexpr OutputName(const char* name) : key(name), attribute(name) {}
  /// Where Python needs the word for something else.
  constexpr OutputName(const char* name, const char* in_python) : key(name), attribute(in_python) {}

  const char* key;
  const char* attribute;
};

/// Two numbers that JSON keeps together, under one key: as [lower, upper], or as an object where there are keys.
/// Outputs that are flat have both by their names.
template <class Number>
struct NumberPair {
  NumberPair(const char* name, Number& number, const char* other_name, Number& other, const char* key = nullptr,
             const char* other_key = nullptr)
      : first_name(name),
        first(number),
        second_name(other_name),
        second(other),
        first_key(key),
        second_key(other_key) {}

  const char* first_name;
  Number& first;
  const char* second_name;
  Number& second;
  const char* first_key;
  const char* second_key;
};

/// Whether a description of Named takes the result, which is const where it is written and not where it is read.
template <class Result, class Named>
concept ResultOf = std::same_as<std::remove_const_t<Result>, Named>;

template <class Value>
inline constexpr bool is_number_pair = false;
template <class Number>
inline constexpr bool is_number_pair<NumberPair<Number>> = true;

namespace detail {

struct IgnoreNumbers {
  template <class Value>
  void operator()(OutputName, const char*, const char*, const Value&) const {}
};

}  // namespace detail

template <class Value>
concept Described = requires(Value& value) {
  describe(value, detail::IgnoreNumbers{});
};

/// Number, flag, text or word of a list of words, and pairs of numbers: what fits into one or two cells of a table.
template <class Value>
concept Scalar =
    std::is_arithmetic_v<Value> || std::is_enum_v<Value> || std::same_as<Value, std::string> || is_number_pair<Value>;

/// Kind of a value in words: "number", "count", "flag", "text", "complex number", "list of numbers" ...
template <class Value>
[[nodiscard]] std::string kind_of() {
  if constexpr (std::same_as<Value, bool>)
    return "flag";
  else if constexpr (std::is_integral_v<Value>)
    return "count";
  else if constexpr (std::is_floating_point_v<Value>)
    return "number";
  else if constexpr (std::same_as<Value, std::complex<double>>)
    return "complex number";
  else if constexpr (std::is_enum_v<Value> || std::is_convertible_v<Value, std::string_view>)
    return "text";
  else if constexpr (requires(Value value) { value.has_value(); })
    return kind_of<typename Value::value_type>() + " or nothing";
  else if constexpr (requires(Value value) { value.front(); }) {
    const std::string entry = kind_of<typename Value::value_type>();
    return "list of " + (entry.starts_with("list") ? entry : entry + "s");
  } else
    return is_number_pair<Value> ? "pair of numbers" : "object";
}

/// What is said of one number.
struct NumberDescription {
  std::string key, attribute, kind, unit, meaning;
  std::string entries;  // attributes of each entry, where it is a list of results
};

/// The numbers of a result, in the order of its description.
/// @param flat    pairs by their two names, as in Python and CSV
/// @param result  whose values do not matter
template <class Result>
[[nodiscard]] std::vector<NumberDescription> described_numbers(bool flat, const Result& result) {
  std::vector<NumberDescription> numbers;
  describe(result, [&]<class Value>(OutputName name, const char* unit, const char* meaning, const Value& value) {
    numbers.push_back({name.key, name.attribute, kind_of<Value>(), unit, meaning, {}});
    if constexpr (is_number_pair<Value>) {
      if (!flat) return;
      numbers.back() = {value.first_name, value.first_name, "number", unit, meaning, {}};
      numbers.push_back({value.second_name, value.second_name, "number", unit, meaning, {}});
    } else if constexpr (requires { requires Described<typename Value::value_type>; }) {
      std::string& entries = numbers.back().entries;
      for (const auto& each : described_numbers(true, typename Value::value_type{}))
        entries += (entries.empty() ? "" : ", ") + each.attribute;
    }
  });
  return numbers;
}
template <class Result>
[[nodiscard]] std::vector<NumberDescription> described_numbers(bool flat) {
  return described_numbers(flat, Result{});
}

}  // namespace frac
