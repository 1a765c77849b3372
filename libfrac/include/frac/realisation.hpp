// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <complex>
#include <cstddef>
#include <memory>
#include <string>
#include <variant>

#include "frac/approximation/zero_pole_gain.hpp"

namespace frac {

namespace detail {
class LadderTable;
}

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

/// The ladder of approximate.hpp on a band, of a given number of poles, made a smooth function of the order: poles that
/// make the mean eighth power of the error least, which on the band is at most a third above the least largest error,
/// or 1e-7 where that is more.  Continuous at all whole orders.
class LadderRealisation {
 public:
  /// Designs the ladders of all orders, which takes some milliseconds (up to a second for wide bands and many poles);
  /// copies share them.
  /// @throws std::invalid_argument  band not 0 < lower < upper < infinity, 0.5 to 24 decades apart; poles below 1 or
  /// more than take the error to 1e-8 at order 1/2.
  LadderRealisation(FrequencyBand band, int poles);

  [[nodiscard]] FrequencyBand band() const noexcept { return band_; }
  [[nodiscard]] int poles() const noexcept { return poles_; }
  [[nodiscard]] const detail::LadderTable& table() const noexcept { return *table_; }
  bool operator==(const LadderRealisation& other) const noexcept {
    return band_ == other.band_ && poles_ == other.poles_;
  }

 private:
  FrequencyBand band_;
  int poles_;
  std::shared_ptr<const detail::LadderTable> table_;
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
using Realisation =
    std::variant<ExactRealisation, OustaloupRealisation, GrunwaldLetnikovRealisation, LadderRealisation>;

/// @throws std::invalid_argument  a member is out of range; the text names it, its value and what is allowed.
void validate(const Realisation& realisation);

/// exact, oustaloup, grunwald-letnikov, ladder.
[[nodiscard]] std::string to_string(const Realisation& realisation);

/// Response of a realised s^order and its derivative by the order.
struct PowerResponse {
  std::complex<double> value;
  std::complex<double> by_order;
};

/// s^order at s = j omega through a realisation.  An Oustaloup realisation jumps where the order passes a whole number
/// other than 0, because the whole part is realised exactly.
/// @throws std::invalid_argument  order not finite, or |order| > 20 for a realisation other than the exact one;
///                                omega not positive and finite, or above pi/sample_time; the realisation
///                                not valid.
[[nodiscard]] PowerResponse power_response(const Realisation& realisation, double order, double omega);

}  // namespace frac
