// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "frac/identification/fit.hpp"
#include "frac/identification/identify.hpp"
#include "frac/model/frequency_response_data.hpp"

namespace frac {

/// Classes of models whose economy is compared.  Coefficients K are real and of either sign.
enum class EconomyClass {
  /// K1 s^a1 + K2 s^a2 + ..., orders free: two parameters a term.  Of one component it is the component's own law, k1
  /// omega^a1 + ...: the same wherever the power has that component, and its limit where it has not (s^2 has no
  /// imaginary part).
  real_powers,
  /// K1 s^n1 + K2 s^n2 + ..., n whole: one parameter a term, as a whole number is not adjusted but picked.
  integer_powers_of_s,
  /// k1 omega^n1 + ... of one component, n whole, odd and even: what no sum of powers of s need have.
  integer_powers_of_omega,
  /// s^k b(s)/a(s), k whole from -4 to 4, no root of a(s) in the right half plane.
  rational,
  /// z^k b(z)/a(z) of z = s^q with one order q from 0.1 to 1.5, no root of a(z) in the right half of the z plane: for q
  /// <= 1 all poles are stable, and of the stable ones those with |arg z| between q pi/2 and pi/2 are left out; for q >
  /// 1 poles with |arg z| below q pi/2 are unstable and may be among them.
  commensurate,
  /// Sums of a constant, L s, 1/s, powers, arcs and modes, see TermFamily.
  terms,
  given,  // a curve that is adjusted to nothing
};
[[nodiscard]] std::string_view to_string(EconomyClass model_class);
/// For readers: "real powers", "ratios in s".
[[nodiscard]] std::string_view description(EconomyClass model_class);

/// The least relative error of a class with so many parameters.
struct EconomyPoint {
  std::size_t parameters;
  /// Root mean square over the points of |model - data|/|data|, of the component.
  double error;
  /// Whether it is the least of all beyond doubt, because every member of the class was solved for.  Else it is the
  /// least that was found, which the least of all may lie below: so many parameters are enough for it.
  bool proven;
  bool fractional;    // an order of the model is none of the whole numbers, to 1e-6
  std::string model;  // with its numbers; over omega where it is a law of one component
};

struct EconomyCurve {
  std::string name;  // of the class, or of the given curve
  EconomyClass model_class;
  /// By number of parameters, each of less error than all before.  Ends where the error is rounding.
  std::vector<EconomyPoint> points;

  /// The simplest point of no more than that error; none where the curve ends above it.
  [[nodiscard]] const EconomyPoint* within(double error) const;
};

/// What fewest parameters buy: models of whole orders, or with others.
enum class EconomyVerdict {
  fractional_cheaper,  // at none of the errors asked for more, at one at least fewer
  integer_cheaper,
  equal,
  depends,  // on the error asked for
  neither,  // no class reaches any of them
};
[[nodiscard]] std::string_view to_string(EconomyVerdict verdict);

struct EconomyOptions {
  Component component = Component::both;  // or real, or imaginary
  std::size_t most_parameters = 8;        // 1 to 8
  /// Powers lie between minus this and this, whole or not; 1 to 9.
  int largest_power = 9;
};

/// How closely each class follows data without noise, such as computed ones, and with how many parameters.
///
/// Where there is no noise no number of parameters is refuted or supported by chance: every class follows the data as
/// closely as one likes, and the question is at what price.  A parameter is a number that is adjusted to the data: a
/// coefficient, an order, a place.
struct Economy {
  Component component;
  std::size_t most_parameters;  // of those asked for as many as there are data to tell them, less one
  std::vector<EconomyCurve> curves;
  /// Errors below it are rounding.
  double rounding;
  EconomyVerdict verdict;
  std::string sentence;  // for a reader
};

/// Relative errors the verdict asks for: 1 %, 0.1 % and 0.01 %.
[[nodiscard]] std::span<const double> economy_errors();

/// @throws std::invalid_argument  a component that is neither imaginary, real nor both; a component that is 0 at a
///     frequency, which has no relative error there; a single value of a single component, which one parameter meets;
///     options out of range; a curve of another length.
[[nodiscard]] Economy economy(const FrequencyResponseData& data, const std::vector<FixedCurve>& curves,
                              const EconomyOptions& options, int threads = 0);

}  // namespace frac
