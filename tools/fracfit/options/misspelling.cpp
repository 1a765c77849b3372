// SPDX-License-Identifier: BSD-3-Clause
#include "options/misspelling.hpp"

#include <algorithm>

namespace fracfit {
namespace {

// Optimal string alignment distance: rows of the usual table, each from the two before it.
std::size_t distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> before, last(b.size() + 1), row(b.size() + 1);
  for (std::size_t j = 0; j <= b.size(); ++j) last[j] = j;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      row[j] = std::min({last[j] + 1, row[j - 1] + 1, last[j - 1] + (a[i - 1] == b[j - 1] ? 0U : 1U)});
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1]) row[j] = std::min(row[j], before[j - 2] + 1);
    }
    before = last;
    last = row;
  }
  return last[b.size()];
}

}  // namespace

std::string suggestion(std::string_view text, const std::vector<std::string>& known) {
  constexpr std::size_t letters_per_mistake = 3;
  std::size_t least = text.size() / letters_per_mistake + 1;
  std::string_view nearest;
  for (const std::string& word : known) {
    const std::size_t mistakes = distance(text, word);
    if (mistakes >= least) continue;
    least = mistakes;
    nearest = word;
  }
  return nearest.empty() ? "" : " (did you mean " + std::string(nearest) + "?)";
}

}  // namespace fracfit
