// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cassert>
#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "frac/describe.hpp"
#include "output/document.hpp"
#include "output/json.hpp"

namespace fracfit {

/// A value, or all that the description of a result names.  An interval is [lower, upper].
template <class Value>
[[nodiscard]] Json json_of(const Value& value) {
  if constexpr (frac::Described<const Value>) {
    Json json = Json::object();
    describe(value, [&](frac::OutputName name, const char*, const char*, const auto& each) {
      json[name.key] = json_of(each);
    });
    return json;
  } else if constexpr (frac::is_number_pair<Value>) {
    if (value.first_key != nullptr) return {{value.first_key, value.first}, {value.second_key, value.second}};
    return {value.first, value.second};
  } else if constexpr (std::is_enum_v<Value>) {
    return to_string(value);
  } else if constexpr (requires { value.lower, value.upper; }) {
    return {value.lower, value.upper};
  } else if constexpr (requires { value.has_value(); }) {
    return value ? json_of(*value) : Json();
  } else if constexpr (requires { value.front(); } && !std::is_convertible_v<Value, std::string_view>) {
    return Json::list(value, [](const auto& each) { return json_of(each); });
  } else {
    return value;
  }
}

/// Adds what is no list and no result by itself: these a caller writes who has something to say with them.
template <class Result>
void add_scalars(Json& json, const Result& result) {
  describe(result, [&]<class Value>(frac::OutputName name, const char*, const char*, const Value& value) {
    if constexpr (frac::Scalar<Value>) json[name.key] = json_of(value);
  });
}

template <class Value>
[[nodiscard]] Cell cell_of(const Value& value) {
  if constexpr (std::is_enum_v<Value>)
    return std::string(to_string(value));
  else if constexpr (std::is_integral_v<Value> && !std::is_same_v<Value, bool>)
    return static_cast<std::int64_t>(value);
  else
    return value;
}

/// Adds the cells of some columns of a table, which are numbers of the result.
template <class Result>
void add_cells(std::vector<Cell>& cells, const Result& result, std::initializer_list<std::string_view> columns) {
  for (const std::string_view column : columns) {
    [[maybe_unused]] const std::size_t before = cells.size();
    describe(result, [&]<class Value>(frac::OutputName name, const char*, const char*, const Value& value) {
      if constexpr (frac::is_number_pair<Value>) {
        if (column == value.first_name) cells.emplace_back(value.first);
        if (column == value.second_name) cells.emplace_back(value.second);
      } else if constexpr (frac::Scalar<Value>) {
        if (column == name.key) cells.push_back(cell_of(value));
      }
    });
    assert(cells.size() == before + 1);
  }
}

}  // namespace fracfit
