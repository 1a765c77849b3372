// SPDX-License-Identifier: BSD-3-Clause
#include "output/json.hpp"

#include <algorithm>
#include <charconv>
#include <nlohmann/json.hpp>

#include "io/number.hpp"
#include "io/version.hpp"

namespace fracfit {
namespace {

template <class Value>
std::string plain(const Value& value) {
  return nlohmann::json(value).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

Json converted(const nlohmann::ordered_json& parsed) {
  if (parsed.is_object()) {
    Json object = Json::object();
    for (const auto& [key, value] : parsed.items()) object[key] = converted(value);
    return object;
  }
  if (parsed.is_array()) {
    Json array = Json::array();
    for (const auto& value : parsed) array.push_back(converted(value));
    return array;
  }
  if (parsed.is_string()) return parsed.get<std::string>();
  if (parsed.is_boolean()) return parsed.get<bool>();
  if (parsed.is_number()) return parsed.get<double>();
  return nullptr;
}

}  // namespace

Json::Json(const Json&) = default;
Json::Json(Json&&) noexcept = default;
Json& Json::operator=(const Json&) = default;
Json& Json::operator=(Json&&) noexcept = default;
Json::~Json() = default;

Json::Json(std::initializer_list<Json> entries) {
  const bool is_object = std::all_of(entries.begin(), entries.end(), [](const Json& entry) {
    const Array* pair = entry.entries();
    return pair != nullptr && pair->size() == 2 && pair->front().text() != nullptr;
  });
  if (!is_object) {
    value_ = Array(entries.begin(), entries.end());
    return;
  }
  Object& members = value_.emplace<Object>();
  for (const Json& entry : entries) members.emplace_back(*entry.entries()->front().text(), entry.entries()->back());
}

std::optional<Json> Json::parse(const std::string& text) {
  const auto parsed = nlohmann::ordered_json::parse(text, nullptr, false);
  if (parsed.is_discarded()) return std::nullopt;
  return converted(parsed);
}

Json& Json::operator[](std::string_view key) {
  if (std::holds_alternative<std::nullptr_t>(value_)) value_ = Object{};
  Object& members = std::get<Object>(value_);
  const auto found = std::find_if(members.begin(), members.end(), [&](const auto& each) { return each.first == key; });
  return found != members.end() ? found->second : members.emplace_back(std::string(key), Json()).second;
}

void Json::update(const Json& other) {
  for (const auto& [key, value] : std::get<Object>(other.value_)) (*this)[key] = value;
}

std::size_t Json::size() const {
  if (const Array* array = entries()) return array->size();
  const Object* members = std::get_if<Object>(&value_);
  return members != nullptr ? members->size() : 0;
}

const Json* Json::find(std::string_view key) const {
  const Object* members = std::get_if<Object>(&value_);
  if (members == nullptr) return nullptr;
  const auto found =
      std::find_if(members->begin(), members->end(), [&](const auto& each) { return each.first == key; });
  return found == members->end() ? nullptr : &found->second;
}

std::optional<double> Json::number() const {
  if (const auto* value = std::get_if<double>(&value_)) return *value;
  if (const auto* value = std::get_if<std::int64_t>(&value_)) return static_cast<double>(*value);
  if (const auto* value = std::get_if<std::uint64_t>(&value_)) return static_cast<double>(*value);
  return std::nullopt;
}

std::string Json::dump(int indent) const {
  std::string text;
  append_to(text, indent, 0);
  return text;
}

void Json::append_to(std::string& text, int indent, int level) const {
  const auto new_line = [&](int at_level) {
    if (indent >= 0)
      text += "\n" + std::string(static_cast<std::size_t>(indent) * static_cast<std::size_t>(at_level), ' ');
  };
  const auto append_all = [&](const auto& all, char begin, char end, const auto& append_one) {
    text += begin;
    bool first = true;
    for (const auto& one : all) {
      if (!std::exchange(first, false)) text += ',';
      new_line(level + 1);
      append_one(one);
    }
    if (!all.empty()) new_line(level);
    text += end;
  };
  if (const Array* array = entries()) {
    append_all(*array, '[', ']', [&](const Json& each) { each.append_to(text, indent, level + 1); });
  } else if (const Object* members = std::get_if<Object>(&value_)) {
    append_all(*members, '{', '}', [&](const auto& each) {
      text += plain(each.first) + (indent >= 0 ? ": " : ":");
      each.second.append_to(text, indent, level + 1);
    });
  } else {
    std::visit(
        [&](const auto& value) {
          using Value = std::decay_t<decltype(value)>;
          if constexpr (!std::is_same_v<Value, Array> && !std::is_same_v<Value, Object>) text += plain(value);
        },
        value_);
  }
}

Json origin(const std::string& command) {
  return {{"fracfit", io::version()}, {"command", command}};
}

Json entry(const std::string& text) {
  std::uint64_t whole = 0;
  const char* const end = text.data() + text.size();
  if (const auto [stop, error] = std::from_chars(text.data(), end, whole); error == std::errc{} && stop == end)
    return whole;
  const auto value = io::parse_number(text);
  return value ? Json(*value) : Json(text);
}

Json object_of(const io::Metadata& entries) {
  Json object = Json::object();
  for (const auto& [key, value] : entries) object[key] = entry(value);
  return object;
}

}  // namespace fracfit
