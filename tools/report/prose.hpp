// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <initializer_list>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <utility>

#include "report/section.hpp"

namespace report {

/// The words of one chapter, as they stand in text/<name>.txt.
///
/// A line "# name" starts a passage.  The lines up to the next such line are its text: UTF-8, HTML allowed, lines
/// joined by single spaces.  "{name}" marks the place of a value that the program computes.
struct ProseText {
  std::string_view name;
  std::string_view text;
};

/// All text files, built into the program.
[[nodiscard]] std::span<const ProseText> prose_texts();

/// Passages of a text by name.
/// @throws std::logic_error  a passage is empty, is defined twice, or text stands before the first one.
[[nodiscard]] std::map<std::string, std::string> passages_of(const ProseText& text);

using ProseValues = std::initializer_list<std::pair<std::string_view, std::string>>;

/// A passage in which each "{name}" is replaced by the value of that name.
/// @throws std::logic_error  a place has no value, or a value has no place.
[[nodiscard]] std::string filled(std::string_view passage, ProseValues values);

/// Passage of a chapter, filled.
/// @throws std::logic_error  also where there is no such chapter or passage.
[[nodiscard]] std::string prose(std::string_view chapter, std::string_view passage, ProseValues values = {});

/// A chapter with the passages "title" and "reading" of its text.
[[nodiscard]] Section open_section(std::string_view chapter);

/// A paragraph of a chapter: the passage filled, between <p> and </p>.
[[nodiscard]] Html paragraph(std::string_view chapter, std::string_view passage, ProseValues values = {});

}  // namespace report
