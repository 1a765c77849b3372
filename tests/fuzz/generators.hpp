// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <complex>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "support/random.hpp"

/// Seeded generators of inputs, good and damaged, for tests that must always come out the same.
namespace fuzz {

using support::Random;

/// How many cases a test tries: `usual` times FRACFIT_FUZZ_FACTOR, which the long run sets.
[[nodiscard]] std::size_t cases(std::size_t usual);
/// `fixed`, or another one with each FRACFIT_FUZZ_SEED.
[[nodiscard]] std::uint64_t seed(std::uint64_t fixed);

/// One of some things.
template <typename Container>
const auto& one_of(Random& random, const Container& all) {
  return all[random.below(all.size())];
}

/// A formula of the grammar, nested up to `depth`; a few are no good, such as an exponent of s.
[[nodiscard]] std::string formula(Random& random, int depth);

/// A text with one to three bytes changed, lost, doubled, or cut off behind a place.
[[nodiscard]] std::string damaged(Random& random, std::string text);
/// A text cut off somewhere before its end.
[[nodiscard]] std::string cut(Random& random, std::string text);

/// A file of a frequency response in one of the accepted forms, and what it holds.
struct Table {
  std::string text;
  std::vector<double> omega;  // rad/s, in the order of the rows
  std::vector<std::complex<double>> value;
};
[[nodiscard]] Table table(Random& random);

}  // namespace fuzz
