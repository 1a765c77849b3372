// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <complex>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "io/text_table.hpp"

namespace fracfit {

/// A JSON value whose members keep their order.  JSON has neither infinity nor NaN: both are written as null.
class Json {
 public:
  using Array = std::vector<Json>;
  using Object = std::vector<std::pair<std::string, Json>>;

  Json(std::nullptr_t = nullptr) {}
  // Compiled once: as part of each caller they are most of its code.
  Json(const Json&);
  Json(Json&&) noexcept;
  Json& operator=(const Json&);
  Json& operator=(Json&&) noexcept;
  ~Json();
  Json(bool value) : value_(value) {}
  Json(double value) : value_(value) {}
  template <std::signed_integral Whole>
  Json(Whole value) : value_(static_cast<std::int64_t>(value)) {}
  template <std::unsigned_integral Whole>
  requires(!std::same_as<Whole, bool>) Json(Whole value) : value_(static_cast<std::uint64_t>(value)) {}
  Json(const char* text) : value_(std::string(text)) {}
  Json(std::string_view text) : value_(std::string(text)) {}
  Json(std::string text) : value_(std::move(text)) {}
  /// [re, im].
  Json(std::complex<double> value) : value_(Array{value.real(), value.imag()}) {}
  template <class Entry>
  Json(const std::optional<Entry>& entry) : Json(entry ? Json(*entry) : Json()) {}
  template <class Entry>
  Json(const std::vector<Entry>& entries) : value_(Array(entries.begin(), entries.end())) {}
  /// An object where every entry is a pair that begins with a text, else an array.
  Json(std::initializer_list<Json> entries);

  [[nodiscard]] static Json array() { return Json(Array{}); }
  [[nodiscard]] static Json object() { return Json(Object{}); }
  /// An array of what is made of each entry.
  template <class Entries, class Make>
  [[nodiscard]] static Json list(const Entries& entries, const Make& make) {
    Array list;
    for (const auto& entry : entries) list.push_back(make(entry));
    return Json(std::move(list));
  }
  /// The same of the numbers below a count.
  template <class Make>
  [[nodiscard]] static Json list_of(std::size_t count, const Make& make) {
    Array list;
    for (std::size_t i = 0; i < count; ++i) list.push_back(make(i));
    return Json(std::move(list));
  }
  /// Empty where the text is no JSON.
  [[nodiscard]] static std::optional<Json> parse(const std::string& text);

  /// Member of an object; it is added where it is missing.
  Json& operator[](std::string_view key);
  Json& operator[](std::size_t index) { return std::get<Array>(value_)[index]; }
  /// Adds to an array. @return what was added
  Json& push_back(Json entry) { return std::get<Array>(value_).emplace_back(std::move(entry)); }
  /// Adds the members of another object.
  void update(const Json& other);

  [[nodiscard]] std::size_t size() const;
  /// nullptr where the value is of another kind, or an object without the member.
  [[nodiscard]] const Json* find(std::string_view key) const;
  [[nodiscard]] const std::string* text() const { return std::get_if<std::string>(&value_); }
  [[nodiscard]] const Array* entries() const { return std::get_if<Array>(&value_); }
  [[nodiscard]] std::optional<double> number() const;
  [[nodiscard]] bool is_object() const { return std::holds_alternative<Object>(value_); }

  /// What is no UTF-8, such as a file name may hold, is replaced.
  /// @param indent  blanks per level; -1 for a single line
  [[nodiscard]] std::string dump(int indent = 2) const;

 private:
  explicit Json(Array entries) : value_(std::move(entries)) {}
  explicit Json(Object members) : value_(std::move(members)) {}
  void append_to(std::string& text, int indent, int level) const;

  std::variant<std::nullptr_t, bool, std::int64_t, std::uint64_t, double, std::string, Array, Object> value_;
};

/// One object with rate and weight for each.
template <class Number>
[[nodiscard]] Json rates_and_weights(const std::vector<Number>& rates, const std::vector<Number>& weights) {
  return Json::list_of(rates.size(), [&](std::size_t i) { return Json{{"rate", rates[i]}, {"weight", weights[i]}}; });
}

/// Version and command, with which every JSON output begins.
[[nodiscard]] Json origin(const std::string& command);
/// An entry of a head as a number where it is one.  Whole numbers stay exact: a seed may exceed 2^53.
[[nodiscard]] Json entry(const std::string& text);
[[nodiscard]] Json object_of(const io::Metadata& entries);

}  // namespace fracfit
