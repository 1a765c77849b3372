#pragma once

#include <complex>
#include <cstddef>
#include <string>
#include <variant>

#include "frac/zero_pole_gain.hpp"

namespace frac {

/// (j omega)^order itself.
struct ExactRealisation {
  bool operator==(const ExactRealisation&) const = default;
};

/// Oustaloup's zeros and poles on a band, see oustaloup.hpp.
struct OustaloupRealisation {
  FrequencyBand band;
  int poles;
  bool operator==(const OustaloupRealisation&) const = default;
};

/// Gruenwald-Letnikov difference at a sample time (s); memory_length = 0 keeps all samples, else it
/// is at most 10^7; see grunwald_letnikov.hpp.
struct GrunwaldLetnikovRealisation {
  double sample_time;
  std::size_t memory_length;
  bool operator==(const GrunwaldLetnikovRealisation&) const = default;
};

/// How each power of s of a model (s itself included) is put into practice.  A model fitted through a realisation
/// absorbs its error.
using Realisation = std::variant<ExactRealisation, OustaloupRealisation, GrunwaldLetnikovRealisation>;

/// @throws std::invalid_argument  a member is out of range; the text names it, its value and what is allowed.
void validate(const Realisation& realisation);

/// Name as on the command line: exact, oustaloup, grunwald-letnikov.
[[nodiscard]] std::string to_string(const Realisation& realisation);

/// Response of a realised s^order and its derivative by the order.
struct PowerResponse {
  std::complex<double> value;
  std::complex<double> by_order;
};

/// s^order at s = j omega through a realisation.  An Oustaloup realisation jumps where the order passes a whole number
/// other than 0, because the whole part is realised exactly.
/// @throws std::invalid_argument  order not finite, or |order| > 20 for a realisation other than the exact one; omega
/// not
///                                positive and finite, or above pi/sample_time; the realisation not valid.
[[nodiscard]] PowerResponse power_response(const Realisation& realisation, double order, double omega);

}  // namespace frac
