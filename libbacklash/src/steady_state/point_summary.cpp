// SPDX-License-Identifier: BSD-3-Clause
#include <string>

#include "backlash/describing_function.hpp"
#include "base/counted.hpp"
#include "base/short_text.hpp"

namespace backlash {

std::string DescribingFunctionPoint::summary() const {
  using frac::detail::short_text;
  const std::string motion =
      period > 0 ? "orbit of " + frac::detail::counted(static_cast<std::size_t>(period), "period") + ", " : "";
  return "omega " + short_text(omega) + " rad/s: N = " + short_text(value.real()) + (value.imag() < 0 ? " - " : " + ") +
         short_text(std::abs(value.imag())) + "j m/N +- " + short_text(uncertainty) + ", " + motion +
         std::string(to_string(regime)) + (transient_possible ? "; may still be a transient" : "");
}

}  // namespace backlash
