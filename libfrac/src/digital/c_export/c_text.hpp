// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <utility>
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

/// Text of C code in one precision with one name.  In templates REAL stands for the type, NAME for the name, and
/// {number} for a literal given by value.
class CText {
 public:
  /// @throws std::invalid_argument  the name is no C identifier, or too long.
  explicit CText(const CHeaderOptions& options);

  [[nodiscard]] std::string literal(double value) const;
  /// The text with REAL, NAME and the given words (written as @word@) put in.
  [[nodiscard]] std::string filled(std::string text,
                                   const std::vector<std::pair<std::string, std::string>>& words = {}) const;
  [[nodiscard]] std::string array(const std::string& name, const std::vector<double>& values) const;

  /// Comment, include guard, and what keeps compilers from fusing operations.  closed() is to follow.
  [[nodiscard]] std::string opening(const std::string& comment) const;
  /// The text from opening() on with its end, and in the guard a fingerprint of it all: another header of the same
  /// name is then an error where both are included, instead of being skipped.
  [[nodiscard]] std::string closed(std::string text) const;
  /// Arrays, and functions x = NAME_<prefix>_tapped(state, input), NAME_<prefix>_output(state, x),
  /// NAME_<prefix>_advance(state, input, x).
  [[nodiscard]] std::string section_functions(const CSections& sections) const;
  /// Members of the struct for them.
  [[nodiscard]] std::string section_members(const CSections& sections) const;
  /// Statements that set them to what `input`, a C expression, at all times leaves; with an int i where has_state().
  [[nodiscard]] std::string section_rest(const CSections& sections, const std::string& input) const;

 private:
  std::string name_;
  bool is_float_;
};

}  // namespace frac::detail
