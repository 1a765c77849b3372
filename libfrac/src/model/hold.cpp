// SPDX-License-Identifier: BSD-3-Clause
#include "frac/model/hold.hpp"

#include "base/spelling.hpp"

namespace frac {
namespace {

constexpr detail::Spellings<Hold, 3> hold_names = {{
    {Hold::zero_order, "zero-order"},
    {Hold::first_order, "first-order"},
    {Hold::band_limited, "band-limited"},
}};

}  // namespace

std::string_view to_string(Hold hold) {
  return detail::spelling(hold_names, hold);
}
Hold hold_from_string(std::string_view text) {
  return detail::from_spelling(hold_names, "hold", text);
}
std::span<const Hold> holds() {
  static constexpr auto all = detail::enumerators(hold_names);
  return all;
}

}  // namespace frac
