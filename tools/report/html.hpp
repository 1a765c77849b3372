// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "report/section.hpp"

namespace report {

/// Text made safe between tags and in quoted attributes.
[[nodiscard]] std::string escape_html(std::string_view text);

/// A formula of s with its powers raised.
[[nodiscard]] std::string html_formula(std::string_view formula);

/// A remark as a sentence among others: a capital letter first, a stop at the end.
[[nodiscard]] std::string html_sentence(std::string_view note);

/// A number for readers: so many significant digits, powers of ten as such, an en dash for NaN.
[[nodiscard]] std::string html_number(double value, int digits = 4);
/// A time in the unit that suits it.
[[nodiscard]] std::string html_seconds(double seconds);

/// An SVG file made fit to stand inside a page among others: prolog removed, every id and every reference to one
/// prefixed.
[[nodiscard]] std::string inline_svg(std::string_view svg, std::string_view prefix);

struct Page {
  std::string title;     // plain text
  std::string subtitle;  // HTML
  std::string notice;    // HTML, shown in a box on top; empty: none
  std::vector<Section> sections;
  std::size_t before_contents = 0;  // so many sections stand before the table of contents, and not in it
};

/// The whole page, self-contained.  Its script draws the pictures of data; others are read from figures/<name>.svg
/// under `folder`.  Where one is missing the page says so in its place.
[[nodiscard]] std::string page_html(const Page& page, const std::filesystem::path& folder);

}  // namespace report
