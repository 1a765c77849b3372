// SPDX-License-Identifier: BSD-3-Clause
#include "io/decoded_text.hpp"

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <string_view>
#include <utility>

#include "io/labview.hpp"
#include "io/workbook.hpp"

namespace io {
namespace {

void append_utf8(std::string& text, std::uint32_t code) {
  const auto put = [&](std::uint32_t byte) { text += static_cast<char>(static_cast<unsigned char>(byte)); };
  if (code < 0x80) {
    put(code);
  } else if (code < 0x800) {
    put(0xC0U | (code >> 6U));
    put(0x80U | (code & 0x3FU));
  } else if (code < 0x10000) {
    put(0xE0U | (code >> 12U));
    put(0x80U | ((code >> 6U) & 0x3FU));
    put(0x80U | (code & 0x3FU));
  } else {
    put(0xF0U | (code >> 18U));
    put(0x80U | ((code >> 12U) & 0x3FU));
    put(0x80U | ((code >> 6U) & 0x3FU));
    put(0x80U | (code & 0x3FU));
  }
}

std::string from_utf16(std::string_view bytes, bool big_endian) {
  std::string text;
  text.reserve(bytes.size() / 2);
  const auto unit_at = [&](std::size_t i) {
    const auto first = static_cast<unsigned char>(bytes[i]), second = static_cast<unsigned char>(bytes[i + 1]);
    return static_cast<std::uint32_t>(big_endian ? first * 256 + second : second * 256 + first);
  };
  std::size_t i = 0;
  for (; i + 1 < bytes.size(); i += 2) {
    const std::uint32_t unit = unit_at(i);
    if (unit < 0xD800 || unit > 0xDFFF) {
      append_utf8(text, unit);
      continue;
    }
    const std::uint32_t next = i + 3 < bytes.size() ? unit_at(i + 2) : 0;
    if (unit < 0xDC00 && next >= 0xDC00 && next < 0xE000) {
      append_utf8(text, 0x10000 + ((unit - 0xD800) << 10U) + (next - 0xDC00));
      i += 2;
    } else {
      text += '?';
    }
  }
  if (i < bytes.size()) text += '?';
  return text;
}

// Text of the first 128 positions of a table: every second byte is zero.
enum class Utf16 { none, little_endian, big_endian };
Utf16 utf16_without_mark(std::string_view bytes) {
  const std::string_view start = bytes.substr(0, 256);
  std::size_t even = 0, odd = 0;
  for (std::size_t i = 0; i < start.size(); ++i)
    if (start[i] == '\0') ++(i % 2 == 0 ? even : odd);
  const std::size_t most = start.size() / 2;
  if (most < 4) return Utf16::none;
  if (even == 0 && odd * 10 >= most * 9) return Utf16::little_endian;
  if (odd == 0 && even * 10 >= most * 9) return Utf16::big_endian;
  return Utf16::none;
}

bool is_utf8(std::string_view text) {
  for (std::size_t i = 0; i < text.size();) {
    // Eight characters of ASCII at a time.
    std::uint64_t eight = 0;
    if (text.size() - i >= sizeof eight) {
      std::memcpy(&eight, text.data() + i, sizeof eight);
      if ((eight & 0x8080808080808080U) == 0) {
        i += sizeof eight;
        continue;
      }
    }
    const auto first = static_cast<unsigned char>(text[i]);
    const std::size_t length = first < 0x80                    ? 1
                               : first >= 0xC2 && first < 0xE0 ? 2
                               : first >= 0xE0 && first < 0xF0 ? 3
                               : first >= 0xF0 && first < 0xF5 ? 4
                                                               : 0;
    if (length == 0 || text.size() - i < length) return false;
    for (std::size_t k = 1; k < length; ++k)
      if ((static_cast<unsigned char>(text[i + k]) & 0xC0U) != 0x80U) return false;
    i += length;
  }
  return true;
}

std::string from_latin1(std::string_view bytes) {
  std::string text;
  text.reserve(bytes.size() + 64);
  for (const char c : bytes) append_utf8(text, static_cast<unsigned char>(c));
  return text;
}

DecodedText made(std::string text, std::string note) {
  return {std::make_shared<const std::string>(std::move(text)), std::move(note)};
}

DecodedText utf8_of(std::shared_ptr<const std::string> bytes) {
  const std::string_view view = *bytes;
  if (auto sheet = first_sheet(view)) {
    DecodedText result =
        made(std::move(sheet->text),
             "the sheet " + sheet->name +
                 (sheet->sheets == 1 ? "" : ", the first with cells of " + std::to_string(sheet->sheets)) +
                 " in a workbook");
    result.is_of_workbook = true;
    return result;
  }
  if (view.starts_with("\xFF\xFE")) return made(from_utf16(view.substr(2), false), "UTF-16");
  if (view.starts_with("\xFE\xFF")) return made(from_utf16(view.substr(2), true), "UTF-16");
  const Utf16 kind = utf16_without_mark(view);
  if (kind != Utf16::none) return made(from_utf16(view, kind == Utf16::big_endian), "UTF-16");
  if (view.starts_with("\xEF\xBB\xBF")) return utf8_of(made(std::string(view.substr(3)), "").text);
  if (!is_utf8(view)) return made(from_latin1(view), "Latin-1");
  return {std::move(bytes), ""};
}

}  // namespace

DecodedText decoded(std::shared_ptr<const std::string> bytes) {
  DecodedText text = utf8_of(std::move(bytes));
  auto segment = labview_segment(*text.text);
  if (!segment) return text;
  return made(std::move(segment->text), segment->segments == 1 ? "a LabVIEW measurement file"
                                                               : "the first of " + std::to_string(segment->segments) +
                                                                     " segments of a LabVIEW measurement file");
}

}  // namespace io
