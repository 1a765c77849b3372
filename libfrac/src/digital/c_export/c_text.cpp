// SPDX-License-Identifier: BSD-3-Clause
#include "c_text.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cstdint>
#include <stdexcept>
#include <string_view>
#include <utility>

#include "base/identifier.hpp"
#include "base/spelling.hpp"
#include "digital/section_kernel.hpp"
#include "digital/tap_line.hpp"
#include "runtime_text.hpp"

namespace frac {

namespace {

constexpr detail::Spellings<Precision, 2> precision_names{
    {{Precision::float_type, "float"}, {Precision::double_type, "double"}}};

}  // namespace

std::string_view to_string(Precision value) {
  return detail::spelling(precision_names, value);
}

Precision precision_from_string(std::string_view name) {
  return detail::from_spelling(precision_names, "precision", name);
}

std::span<const Precision> precisions() {
  static constexpr auto all = detail::enumerators(precision_names);
  return all;
}

namespace {

constexpr std::string_view c_keywords[] = {
    "auto",   "break",    "case",   "char",     "const",    "continue", "default", "do",     "double",
    "else",   "enum",     "extern", "float",    "for",      "goto",     "if",      "inline", "int",
    "long",   "register", "return", "short",    "restrict", "signed",   "sizeof",  "static", "struct",
    "switch", "typedef",  "union",  "unsigned", "void",     "volatile", "while"};

}  // namespace

void check_c_name(const std::string& name) {
  const bool is_keyword = std::find(std::begin(c_keywords), std::end(c_keywords), name) != std::end(c_keywords);
  detail::check_identifier("C name", name);
  if (is_keyword)
    throw std::invalid_argument("C name \"" + name + "\": is a keyword of C; expected another identifier");
}

namespace detail {
namespace {

void replace_all(std::string& text, const std::string& from, const std::string& to) {
  for (std::size_t at = text.find(from); at != std::string::npos; at = text.find(from, at + to.size())) {
    text.replace(at, from.size(), to);
  }
}

// Stands for the fingerprint until the whole text is known.
constexpr const char* content_mark = "@content@";

std::string capitals(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(),
                 [](char c) { return static_cast<char>(std::toupper(static_cast<unsigned char>(c))); });
  return text;
}

template <typename Real>
std::string shortest(Real value) {
  std::array<char, 40> buffer;
  const auto end = std::to_chars(buffer.data(), buffer.data() + buffer.size(), value);
  std::string text(buffer.data(), end.ptr);
  if (text.find_first_of(".e") == std::string::npos) text += ".0";
  return text;
}

}  // namespace

std::string fingerprint(const std::string& text) {
  std::uint64_t hash = 0xcbf29ce484222325;
  for (const char c : text) hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001b3;
  std::array<char, 16> digits;
  const auto end = std::to_chars(digits.data(), digits.data() + digits.size(), hash, 16);
  return std::string(digits.data(), end.ptr);
}

CText::CText(const CHeaderOptions& options)
    : name_(options.name), is_float_(options.precision == Precision::float_type) {
  check_c_name(name_);
}

std::string CText::literal(double value) const {
  return is_float_ ? shortest(static_cast<float>(value)) + "f" : shortest(value);
}

std::string CText::identifier(std::string_view word, const CWords& words) const {
  if (word == "REAL") return is_float_ ? "float" : "double";
  if (const auto known = words.find(word); known != words.end()) return known->second;
  std::string text(word);
  replace_all(text, "NAME", name_);
  if (const auto prefix = words.find("PREFIX"); prefix != words.end()) replace_all(text, "PREFIX", prefix->second);
  return text;
}

std::string CText::filled(std::string_view text, CWords words, const CConditions& conditions) const {
  text.remove_prefix(text.find("\n\n") + 2);
  words.emplace("ZERO", literal(0));
  words.emplace("TINY", literal(is_float_ ? static_cast<double>(negligible_state<float>) : negligible_state<double>));
  // A condition around a line: whether it is ours, whether its present branch is kept, and whether one was.
  struct Condition {
    bool ours, kept, taken;
  };
  std::vector<Condition> open;
  std::string result;
  while (!text.empty()) {
    const std::string_view line = text.substr(0, text.find('\n') + 1);
    text.remove_prefix(line.size());
    const auto condition_after = [&](std::string_view directive) {
      return std::string(line.substr(directive.size(), line.size() - directive.size() - 1));
    };
    const bool is_ours = !open.empty() && open.back().ours;
    if (line.starts_with("#if")) {
      const auto known = line.starts_with("#if ") ? conditions.find(condition_after("#if ")) : conditions.end();
      const bool ours = known != conditions.end();
      open.push_back({ours, !ours || known->second, !ours || known->second});
      if (ours) continue;
    } else if (is_ours && (line.starts_with("#elif ") || line.starts_with("#else"))) {
      Condition& here = open.back();
      here.kept = !here.taken && (line.starts_with("#else") || conditions.at(condition_after("#elif ")));
      here.taken = here.taken || here.kept;
      continue;
    } else if (line.starts_with("#endif")) {
      // A condition that the head of a header leaves open is closed by the text of its end.
      if (!open.empty()) open.pop_back();
      if (is_ours) continue;
    }
    if (!std::all_of(open.begin(), open.end(), [](const Condition& each) { return each.kept; })) continue;
    for (std::size_t at = 0; at < line.size();) {
      const auto is_part = [&](std::size_t i) {
        return i < line.size() && (std::isalnum(static_cast<unsigned char>(line[i])) != 0 || line[i] == '_');
      };
      std::size_t end = at;
      while (is_part(end)) ++end;
      result += end > at ? identifier(line.substr(at, end - at), words) : std::string(1, line[at]);
      at = std::max(end, at + 1);
    }
  }
  return result;
}

std::string CText::array(const std::string& name, const std::vector<double>& values) const {
  std::string text = std::string("static const ") + (is_float_ ? "float " : "double ") + name_ + "_" + name + "[" +
                     std::to_string(values.size()) + "] = {";
  constexpr std::size_t per_line = 4;
  for (std::size_t i = 0; i < values.size(); ++i) {
    text += i == 0 ? "\n    " : i % per_line == 0 ? ",\n    " : ", ";
    text += literal(values[i]);
  }
  return text + "};\n";
}

std::string CText::opening(const std::string& comment) const {
  std::string head = " * " + (comment.empty() ? "Written by fracfit." : comment);
  replace_all(head, "\n", "\n * ");
  // What would end the comment early.
  replace_all(head, "*/", "* /");
  replace_all(head, "/*", "/ *");
  return filled(runtime::guard_open,
                {{"COMMENT", head},
                 {"GUARD", guard()},
                 {"GUARD_CONTENT", guard() + "_" + content_mark},
                 {"GUARD_POP_OPTIONS", guard() + "_POP_OPTIONS"}},
                {{"IS_DOUBLE", !is_float_}});
}

std::string CText::closed(std::string text) const {
  text += filled(runtime::guard_close, {{"GUARD", guard()}, {"GUARD_POP_OPTIONS", guard() + "_POP_OPTIONS"}}, {});
  replace_all(text, content_mark, fingerprint(text));
  return text;
}

std::string CText::guard() const {
  return capitals(name_) + "_H";
}

CSections c_sections(std::string prefix, std::vector<double> taps, const ParallelSections& design) {
  CSections sections{std::move(prefix), std::move(taps), design.output, design.direct, design.rates, design.weights};
  const std::size_t size = whole_groups(design.rates.size());
  sections.taps.resize(even_count(sections.taps.size()), 0);
  sections.rates.resize(size, 1);
  sections.weights.resize(size, 0);
  return sections;
}

void describe(const CSections& sections, CWords& words, CConditions& conditions) {
  const std::string prefix = capitals(sections.prefix);
  words[prefix + "_TAPS"] = std::to_string(sections.taps.size());
  words[prefix + "_SIZE"] = std::to_string(sections.rates.size());
  conditions["HAS_" + prefix + "_TAPS"] = !sections.taps.empty();
  conditions["HAS_" + prefix + "_SECTIONS"] = !sections.rates.empty();
  conditions["HAS_" + prefix + "_LEAK"] = !sections.rates.empty() && sections.output == SectionOutput::change;
  conditions["HAS_" + prefix + "_STATE"] = sections.has_state();
}

std::string CText::section_functions(const CSections& sections, bool has_vectors) const {
  std::string arrays;
  if (!sections.taps.empty()) arrays += array(sections.prefix + "_tap", sections.taps);
  if (!sections.rates.empty())
    arrays += array(sections.prefix + "_rate", sections.rates) + array(sections.prefix + "_weight", sections.weights);
  CSections any = sections;
  any.prefix = "prefix";
  CWords words{{"PREFIX", sections.prefix},
               {"PREFIX_DIRECT", literal(sections.direct)},
               {"VECTOR_INTEGER", is_float_ ? "int" : "long long"}};
  CConditions conditions{{"PREFIX_GIVES_STATES", sections.output == SectionOutput::state}};
  describe(any, words, conditions);
  return arrays + (arrays.empty() ? "" : "\n") + filled(runtime::section_filter, words, conditions) +
         (has_vectors && !sections.rates.empty() ? filled(runtime::section_vector, words, conditions) : "");
}

}  // namespace detail
}  // namespace frac
