// SPDX-License-Identifier: BSD-3-Clause
#include "c_text.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cstdint>
#include <stdexcept>
#include <string_view>

#include "digital/section_kernel.hpp"

namespace frac {

std::string_view to_string(Precision precision) {
  return precision == Precision::float_type ? "float" : "double";
}

std::span<const Precision> precisions() {
  static constexpr Precision all[] = {Precision::float_type, Precision::double_type};
  return all;
}

Precision precision(std::string_view name) {
  for (const Precision each : precisions()) {
    if (to_string(each) == name) return each;
  }
  throw std::invalid_argument("precision \"" + std::string(name) + "\": expected float or double");
}

namespace {

constexpr std::string_view c_keywords[] = {
    "auto",   "break",    "case",   "char",     "const",    "continue", "default", "do",     "double",
    "else",   "enum",     "extern", "float",    "for",      "goto",     "if",      "inline", "int",
    "long",   "register", "return", "short",    "restrict", "signed",   "sizeof",  "static", "struct",
    "switch", "typedef",  "union",  "unsigned", "void",     "volatile", "while"};

}  // namespace

void check_c_name(const std::string& name) {
  constexpr std::size_t longest = 40;
  const auto is_letter = [](char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_'; };
  const auto is_part = [&](char c) { return is_letter(c) || (c >= '0' && c <= '9'); };
  const bool is_keyword = std::find(std::begin(c_keywords), std::end(c_keywords), name) != std::end(c_keywords);
  if (name.empty() || name.size() > longest || !is_letter(name[0]) || !std::all_of(name.begin(), name.end(), is_part) ||
      is_keyword) {
    throw std::invalid_argument("C name \"" + name + "\": expected an identifier of letters, digits and _, up to " +
                                std::to_string(longest) + " characters");
  }
}

namespace detail {
namespace {

void replace_all(std::string& text, const std::string& from, const std::string& to) {
  for (std::size_t at = text.find(from); at != std::string::npos; at = text.find(from, at + to.size())) {
    text.replace(at, from.size(), to);
  }
}

// FNV-1a (Fowler, Noll, Vo), 64 bits, as hexadecimal digits.
std::string fingerprint(const std::string& text) {
  std::uint64_t hash = 0xcbf29ce484222325;
  for (const char c : text) hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001b3;
  std::array<char, 16> digits;
  const auto end = std::to_chars(digits.data(), digits.data() + digits.size(), hash, 16);
  return std::string(digits.data(), end.ptr);
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

CText::CText(const CHeaderOptions& options)
    : name_(options.name), is_float_(options.precision == Precision::float_type) {
  check_c_name(name_);
}

std::string CText::literal(double value) const {
  return is_float_ ? shortest(static_cast<float>(value)) + "f" : shortest(value);
}

std::string CText::filled(std::string text, const std::vector<std::pair<std::string, std::string>>& words) const {
  for (const auto& [word, value] : words) replace_all(text, "@" + word + "@", value);
  replace_all(text, "REAL", is_float_ ? "float" : "double");
  replace_all(text, "NAME", name_);
  return text;
}

std::string CText::array(const std::string& name, const std::vector<double>& values) const {
  std::string text = filled("static const REAL NAME_" + name + "[" + std::to_string(values.size()) + "] = {");
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
  std::string guard = name_ + "_H";
  std::transform(guard.begin(), guard.end(), guard.begin(),
                 [](char c) { return static_cast<char>(std::toupper(static_cast<unsigned char>(c))); });
  std::string text = filled(R"(/*
@comment@
 * C99, no heap, no mathematical library.  All state is in one struct.
 */
#if defined(@guard@) && !defined(@guard@_@content@)
#error "another controller with the name 'NAME' is already included; use --name"
#endif
#ifndef @guard@
#define @guard@
#define @guard@_@content@

/* Products are not to be fused into sums: the last bits would differ. */
#if defined(__clang__)
#pragma STDC FP_CONTRACT OFF
#elif defined(__GNUC__) && !defined(__STRICT_ANSI__) && (defined(__FP_FAST_FMA) || defined(__FP_FAST_FMAF))
#pragma GCC push_options
#pragma GCC optimize("fp-contract=off")
#define @guard@_POP_OPTIONS
#endif

)",
                            {{"guard", guard}});
  replace_all(text, "@comment@", head);
  return text;
}

std::string CText::closed(std::string text) const {
  std::string guard = name_ + "_H";
  std::transform(guard.begin(), guard.end(), guard.begin(),
                 [](char c) { return static_cast<char>(std::toupper(static_cast<unsigned char>(c))); });
  text += "\n#ifdef " + guard + "_POP_OPTIONS\n#pragma GCC pop_options\n#undef " + guard +
          "_POP_OPTIONS\n#endif\n\n#endif\n";
  replace_all(text, "@content@", fingerprint(text));
  return text;
}

std::string CText::section_members(const CSections& sections) const {
  std::string text;
  if (!sections.taps.empty()) text += "  REAL @prefix@_past[@taps@]; /* inputs, the newest first */\n";
  if (!sections.rates.empty()) {
    text += "  REAL @prefix@_v[@size@];    /* states */\n  REAL @prefix@_lost[@size@]; /* of them, to rounding */\n";
  }
  return filled(text, {{"prefix", sections.prefix},
                       {"taps", std::to_string(sections.taps.size())},
                       {"size", std::to_string(sections.rates.size())}});
}

std::string CText::section_rest(const CSections& sections, const std::string& input) const {
  const bool is_zero = input == literal(0);
  std::string text;
  if (!sections.taps.empty()) text += "  for (i = 0; i < @taps@; ++i) s->@prefix@_past[i] = @input@;\n";
  if (!sections.rates.empty()) {
    text += is_zero ? "  for (i = 0; i < @size@; ++i) s->@prefix@_v[i] = s->@prefix@_lost[i] = @input@;\n"
                    : "  for (i = 0; i < @size@; ++i) {\n"
                      "    s->@prefix@_v[i] = NAME_@prefix@_tapped(s, @input@) / NAME_@prefix@_rate[i];\n"
                      "    s->@prefix@_lost[i] = @zero@;\n  }\n";
  }
  return filled(text, {{"prefix", sections.prefix},
                       {"taps", std::to_string(sections.taps.size())},
                       {"size", std::to_string(sections.rates.size())},
                       {"input", input},
                       {"zero", literal(0)}});
}

std::string CText::section_functions(const CSections& sections) const {
  const bool has_sections = !sections.rates.empty();
  const double tiny = is_float_ ? static_cast<double>(negligible_state<float>) : negligible_state<double>;
  const std::string term = sections.output == SectionOutput::state
                               ? "s->@prefix@_v[i + j]"
                               : "(x - NAME_@prefix@_rate[i + j] * s->@prefix@_v[i + j])";
  std::string arrays;
  if (!sections.taps.empty()) arrays += array(sections.prefix + "_tap", sections.taps);
  if (has_sections)
    arrays += array(sections.prefix + "_rate", sections.rates) + array(sections.prefix + "_weight", sections.weights);
  std::string text = "static inline REAL NAME_@prefix@_tapped(const NAME_state *s, REAL input)\n{\n";
  text += sections.taps.empty() ? "  (void)s;\n  return input;\n}\n" : R"(  REAL even = NAME_@prefix@_tap[0] * input;
  REAL odd = NAME_@prefix@_tap[1] * s->@prefix@_past[0];
  int k;
  for (k = 2; k < @taps@; k += 2) {
    even += NAME_@prefix@_tap[k] * s->@prefix@_past[k - 1];
    odd += NAME_@prefix@_tap[k + 1] * s->@prefix@_past[k];
  }
  return even + odd;
}
)";
  text += "\nstatic inline REAL NAME_@prefix@_output(const NAME_state *s, REAL x)\n{\n";
  text += !has_sections ? "  (void)s;\n  return @direct@ * x;\n}\n"
                        : R"(  REAL lane[8] = {@zero@, @zero@, @zero@, @zero@, @zero@, @zero@, @zero@, @zero@};
  int i, j;
  for (i = 0; i < @size@; i += 8) {
    for (j = 0; j < 8; ++j) {
      lane[j] += NAME_@prefix@_weight[i + j] * )" +
                              term + R"(;
    }
  }
  return @direct@ * x + (((lane[0] + lane[4]) + (lane[2] + lane[6])) + ((lane[1] + lane[5]) + (lane[3] + lane[7])));
}
)";
  if (sections.has_state()) {
    text += "\nstatic inline void NAME_@prefix@_advance(NAME_state *s, REAL input, REAL x)\n{\n  int i;\n";
    text += sections.taps.empty() ? "  (void)input;\n"
                                  : R"(  for (i = @taps@ - 1; i > 0; --i) s->@prefix@_past[i] = s->@prefix@_past[i - 1];
  s->@prefix@_past[0] = input;
)";
    text += !has_sections ? "  (void)x;\n}\n" : R"(  for (i = 0; i < @size@; ++i) {
    const REAL v = s->@prefix@_v[i];
    const REAL increment = (x - NAME_@prefix@_rate[i] * v) + s->@prefix@_lost[i];
    const REAL sum = v + increment;
    const REAL remainder = increment - (sum - v);
    const int matters = sum > @tiny@ || sum < -@tiny@;
    s->@prefix@_v[i] = matters ? sum : @zero@;
    s->@prefix@_lost[i] = matters ? remainder : @zero@;
  }
}
)";
  }
  return arrays + (arrays.empty() ? "" : "\n") +
         filled(text + "\n", {{"prefix", sections.prefix},
                              {"taps", std::to_string(sections.taps.size())},
                              {"size", std::to_string(sections.rates.size())},
                              {"direct", literal(sections.direct)},
                              {"zero", literal(0)},
                              {"tiny", literal(tiny)}});
}

}  // namespace detail
}  // namespace frac
