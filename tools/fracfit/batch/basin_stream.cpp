// SPDX-License-Identifier: BSD-3-Clause
#include "batch/basin_stream.hpp"

#include <bit>
#include <charconv>
#include <cstddef>
#include <cstdint>
#include <stdexcept>
#include <string_view>
#include <tuple>

namespace fracfit {
namespace {

// An outcome is a line of the bits of its numbers, in hexadecimal digits: exact, and quick to write and to read.
constexpr std::size_t digits = 16;
constexpr std::size_t line_size = digits * std::tuple_size_v<backlash::StartOutcome> + 1;

void append_bits(std::string& text, double number) {
  auto bits = std::bit_cast<std::uint64_t>(number);
  const std::size_t begin = text.size();
  text.resize(begin + digits);
  for (std::size_t i = digits; i-- > 0; bits >>= 4U) text[begin + i] = "0123456789abcdef"[bits & 15U];
}

double number_of(std::string_view text) {
  std::uint64_t bits = 0;
  const auto read = std::from_chars(text.data(), text.data() + text.size(), bits, 16);
  if (read.ptr != text.data() + text.size()) throw std::runtime_error("an unfinished search holds what is no number");
  return std::bit_cast<double>(bits);
}

}  // namespace

BasinStream::BasinStream(const std::string& path, const std::string& header) : stream_(path, header) {}

bool BasinStream::contains(const std::string& key) const {
  return stream_.contains(key);
}

std::vector<backlash::StartOutcome> BasinStream::outcomes(const std::string& key) const {
  const std::string text = stream_.text(key);
  std::vector<backlash::StartOutcome> outcomes(text.size() / line_size);
  for (std::size_t i = 0; i < outcomes.size(); ++i)
    for (std::size_t k = 0; k < outcomes[i].size(); ++k)
      outcomes[i].at(k) = number_of(std::string_view(text).substr(i * line_size + k * digits, digits));
  return outcomes;
}

void BasinStream::keep(const std::string& key, const std::vector<backlash::StartOutcome>& outcomes) {
  std::string text;
  text.reserve(outcomes.size() * line_size);
  for (const auto& outcome : outcomes) {
    for (const double number : outcome) append_bits(text, number);
    text += '\n';
  }
  stream_.append(key, text);
}

}  // namespace fracfit
