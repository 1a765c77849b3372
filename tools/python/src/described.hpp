// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <string>
#include <string_view>
#include <type_traits>

#include "frac/describe.hpp"

namespace python {

/// A value as Python keeps it, or a result as the dict of all that its description names.
template <class Value>
[[nodiscard]] pybind11::object object_of(const Value& value) {
  if constexpr (frac::Described<const Value>) {
    pybind11::dict dict;
    describe(value, [&]<class Each>(frac::OutputName name, const char*, const char*, const Each& each) {
      if constexpr (frac::is_number_pair<Each>) {
        dict[each.first_name] = each.first;
        dict[each.second_name] = each.second;
      } else {
        dict[name.attribute] = object_of(each);
      }
    });
    return dict;
  } else if constexpr (std::is_enum_v<Value>) {
    return pybind11::str(std::string(to_string(value)));
  } else if constexpr (requires { value.lower, value.upper; }) {
    return pybind11::make_tuple(value.lower, value.upper);
  } else if constexpr (requires { value.front(); } && !std::is_convertible_v<Value, std::string_view>) {
    pybind11::list list;
    for (const auto& each : value) list.append(object_of(each));
    return list;
  } else {
    return pybind11::cast(value);
  }
}
template <class Result>
[[nodiscard]] pybind11::dict dict_of(const Result& result) {
  return object_of(result).template cast<pybind11::dict>();
}

/// Back from what object_of() has made.  Words of an enumeration need `from_text(text, value)`.
template <class Value>
void read(const pybind11::handle& given, Value& value) {
  if constexpr (frac::Described<Value>) {
    describe(value, [&]<class Each>(frac::OutputName name, const char*, const char*, Each&& each) {
      if constexpr (frac::is_number_pair<std::remove_cvref_t<Each>>) {
        read(given[each.first_name], each.first);
        read(given[each.second_name], each.second);
      } else {
        read(given[name.attribute], each);
      }
    });
  } else if constexpr (std::is_enum_v<Value>) {
    from_text(given.cast<std::string>(), value);
  } else if constexpr (requires { value.emplace_back(); } && !std::is_convertible_v<Value, std::string_view>) {
    for (const pybind11::handle each : given) read(each, value.emplace_back());
  } else {
    value = given.cast<Value>();
  }
}

/// (attribute, kind, meaning with its unit, keys of its entries) of each number, for the documentation.
template <class Result>
[[nodiscard]] pybind11::list attributes_of() {
  pybind11::list list;
  for (const auto& each : frac::described_numbers<Result>(true))
    list.append(pybind11::make_tuple(
        each.attribute, each.kind, each.meaning + (each.unit.empty() || each.unit == "1" ? "" : " (" + each.unit + ")"),
        each.entries));
  return list;
}

}  // namespace python
