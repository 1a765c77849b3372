// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "frac/digital/c_header.hpp"

namespace frac::detail {

/// Coefficients of one filter as it runs: taps to an even number, first-order sections filled up to whole groups.
struct CSections {
  std::string prefix;        // of the arrays, e.g. "integral"
  std::vector<double> taps;  // empty: none
  SectionOutput output;
  double direct;
  std::vector<double> rates;    // whole groups
  std::vector<double> weights;  // whole groups
  [[nodiscard]] bool has_state() const { return !taps.empty() || !rates.empty(); }
};

/// Taps and sections as designed, filled up.
[[nodiscard]] CSections c_sections(std::string prefix, std::vector<double> taps, const ParallelSections& design);

/// Values of the identifiers in a C text, e.g. KP, and truth of the conditions it is written with, e.g. HAS_PAIRS.
using CWords = std::map<std::string, std::string, std::less<>>;
using CConditions = std::map<std::string, bool, std::less<>>;

/// Text of C code in one precision with one name.  The texts of runtime_text.hpp are C themselves: REAL stands for the
/// type, NAME in an identifier for the name of the export, other identifiers in capitals for values.
class CText {
 public:
  /// @throws std::invalid_argument  the name is no C identifier, or too long.
  explicit CText(const CHeaderOptions& options);

  [[nodiscard]] std::string literal(double value) const;
  /// The text, but for its head comment, which ends at the first empty line: identifiers replaced by their words, lines
  /// between #if, #elif, #else and #endif kept as the conditions say.  Conditions that are no single identifier are for
  /// the user's compiler and stay.
  [[nodiscard]] std::string filled(std::string_view text, CWords words, const CConditions& conditions) const;
  [[nodiscard]] std::string array(const std::string& name, const std::vector<double>& values) const;

  /// Comment, include guard, and what keeps compilers from fusing operations.  closed() is to follow.
  [[nodiscard]] std::string opening(const std::string& comment) const;
  /// The text from opening() on with its end, and in the guard a fingerprint of it all: another header of the same
  /// name is then an error where both are included, instead of being skipped.
  [[nodiscard]] std::string closed(std::string text) const;
  /// Arrays, and functions x = NAME_<prefix>_tapped(state, input), NAME_<prefix>_output(state, x),
  /// NAME_<prefix>_advance(state, input, x).
  /// @param has_vectors  also in vectors, for compilers that are told of registers for them
  [[nodiscard]] std::string section_functions(const CSections& sections, bool has_vectors) const;

 private:
  [[nodiscard]] std::string guard() const;
  [[nodiscard]] std::string identifier(std::string_view word, const CWords& words) const;

  std::string name_;
  bool is_float_;
};

/// FNV-1a (Fowler, Noll, Vo), 64 bits, as hexadecimal digits.
[[nodiscard]] std::string fingerprint(const std::string& text);

/// Adds the sizes of a filter under its prefix in capitals, e.g. INTEGRAL_TAPS and HAS_INTEGRAL_TAPS.
void describe(const CSections& sections, CWords& words, CConditions& conditions);

}  // namespace frac::detail
