// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <complex>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "frac/model/frequency_response_data.hpp"
#include "frac/power_term.hpp"
#include "frac/realisation.hpp"
#include "frac/structure.hpp"

namespace frac {

/// G(s) = e^{-delay s} sum numerator / sum denominator: sums of real powers of s, orders need not be commensurate.
/// Terms are kept by falling order, equal orders (to 1e-13) added up, zero coefficients dropped; a denominator of a
/// single term has the coefficient 1.
class FractionalTransferFunction {
 public:
  /// @param delay  dead time in s, >= 0.
  /// @throws std::invalid_argument  no numerator or denominator term left, an entry not finite, delay negative.
  FractionalTransferFunction(std::vector<PowerTerm> numerator, std::vector<PowerTerm> denominator, double delay = 0);

  /// From a formula of numbers such as "1/(0.8 s^2.2 + 0.5 s^0.9 + 1)".
  /// @throws FormulaError  it does not parse.
  /// @throws std::invalid_argument  a parameter has no value, or the formula is no ratio of sums of powers.
  [[nodiscard]] static FractionalTransferFunction parse(std::string_view formula);

  [[nodiscard]] const std::vector<PowerTerm>& numerator() const noexcept { return numerator_; }
  [[nodiscard]] const std::vector<PowerTerm>& denominator() const noexcept { return denominator_; }
  [[nodiscard]] double delay() const noexcept { return delay_; }
  bool operator==(const FractionalTransferFunction&) const = default;

  /// Formula that parses back to the same value, e.g. "exp(-0.2 s) (2 s^0.5 + 1)/(s^1.5 + 1)"; coefficients round-trip.
  [[nodiscard]] std::string formula() const;

  /// G(j omega), omega > 0 in rad/s, exactly or through a realisation of each power; the delay is exact always.  Not
  /// finite at a pole.
  /// @throws std::invalid_argument  as power_response().
  [[nodiscard]] std::complex<double> response(double omega, const Realisation& realisation = ExactRealisation{}) const;
  /// On a grid. @throws std::invalid_argument  as power_response(), or as FrequencyResponseData: grid not in order, a
  /// value not finite.
  [[nodiscard]] FrequencyResponseData response(const std::vector<double>& omega,
                                               const Realisation& realisation = ExactRealisation{}) const;

 private:
  std::vector<PowerTerm> numerator_;
  std::vector<PowerTerm> denominator_;
  double delay_;
};

/// The structure at given parameter values as a ratio of sums of powers.
/// @throws std::invalid_argument  the formula is none (tanh, coth, a fractional power of a sum, delays that differ by
///                                term); the text says which part.
[[nodiscard]] FractionalTransferFunction to_transfer_function(const Structure& structure,
                                                              std::span<const double> parameters);

}  // namespace frac
