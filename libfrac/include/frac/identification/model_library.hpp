// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "frac/identification/fit.hpp"
#include "frac/identification/time_fit.hpp"

namespace frac {

enum class ModelClass { fractional, integer_order, fixed_curve };
[[nodiscard]] std::string_view to_string(ModelClass model_class);

/// Models b(z)/a(z), with or without a factor exp(-L s).  z is s, or s^a with one order a for the whole model: then
/// they are the systems of commensurate order.  How many poles are real and how many come in complex pairs is found out
/// from the data, and so is what is left open here.
struct RationalFamily {
  std::optional<std::size_t> zeros;  // degree of b; unset: what pays for itself
  std::size_t fewest_poles = 0;
  std::size_t most_poles = 12;
  bool dead_time = false;
  bool free_order = false;  // z = s^a
  bool operator==(const RationalFamily&) const = default;
};

/// Sums of terms in parallel or series, chosen from the data: a constant, L s, 1/s, powers A s^q with -2 <= q <= 2,
/// arcs R/(1 + (T s)^n) with 0 < n <= 1, and up to two modes G/(s^2/w^2 + d s/w + 1) or G (s/w)/(...) with d <= 1.
/// Impedances are such sums, with arcs, inductive, capacitive and diffusive ends, of a loudspeaker with a mode; so are
/// moduli of solids.
struct TermFamily {
  std::size_t most_terms = 9;
};

/// Sums of passive elements, chosen from the data, each with a positive gain.  Where the real part of the data keeps to
/// positive values better than the imaginary part to negative ones, the sum is an impedance, a modulus or a compliance:
///     R0, L0 s, 1/(C0 s)                  resistor or spring (E0), inductor or dashpot (V0), capacitor
///     1/(Q s^n), A s^n                    constant-phase element (CPE), springpot, 0 < n < 1
///     W/sqrt(s)                           semi-infinite diffusion (W)
///     R/(1 + T s), R/(1 + (T s)^n)        resistor with a capacitor (R|C) or a constant-phase element (R|CPE) beside it
///     R T s/(1 + T s), with n             the same with an inductor (R|L); Maxwell arm, fractional Maxwell arm
///     R/sqrt(1 + T s)                     diffusion with reaction (Gerischer, G)
///     R tanh(sqrt(T s))/sqrt(T s)         diffusion through a layer to a constant (Ws)
///     R coth(sqrt(T s))/sqrt(T s)         diffusion into a layer with a closed far side (Wo)
///     G (s/w)/(s^2/w^2 + d s/w + 1)       mode: resistor, inductor and capacitor in parallel
/// Else it is the displacement of a structure per force where it acts: R0, 1/(C0 s), 1/(M0 s^2), 1/(Q s^n), 1/(Q s s^n),
/// R/(1 + T s), R/(1 + (T s)^n), modes G/(s^2/w^2 + d s/w + 1) with viscous and G/((s/w)^2 + (s/w)^q) with structural
/// damping, whose loss angle is q pi/2 at all frequencies.
struct ElementFamily {
  std::size_t most_elements = 12;
};

/// A named structure: formula, the ranges of its parameters, and what it describes.
struct NamedModel {
  std::string name;
  std::string formula;  // the name of the family for one, see resolved_model()
  ModelClass model_class;
  std::string description;
  std::vector<ParameterConstraint> constraints;
  std::optional<RationalFamily> rational = std::nullopt;
  std::optional<TermFamily> terms = std::nullopt;
  std::optional<ElementFamily> elements = std::nullopt;
  /// Whether this is the largest member that was tried of a family without a limit of the caller's.  Its last pole
  /// still paid, so that further ones might pay too.
  bool ends_its_family = false;
  /// What became of assumptions where a member of a family was chosen; one sentence, or empty.
  std::string remark = {};
  /// Whether it stands for a family, whose best member on given data resolved_model() finds.
  [[nodiscard]] bool is_family() const { return rational || terms || elements; }
};

/// All presets: power-law, two-power-laws, fractional-lag (K/(T s^a + 1)), inertia-and-power-law, cole-cole,
/// havriliak-negami, ... and the integer-order counterparts they are compared with.
[[nodiscard]] const std::vector<NamedModel>& model_library();

/// What `identify` compares unless told otherwise: all presets, rational and commensurate models of up to 12 poles,
/// with and without dead time, sums of terms, and sums of passive elements.
[[nodiscard]] std::vector<NamedModel> default_candidates();

/// The same for samples over time, where no sums of terms or elements are grown.
[[nodiscard]] std::vector<NamedModel> default_candidates_over_time();

/// The preset of that name, a rational family, or the text taken as a formula.  A formula that is a preset's structure
/// (Structure::correspondence) is that preset, with its limits, name and class, and its formula in the names of the
/// text; any other has its own text for a name, its class by its orders, and no limits but the defaults of
/// ParameterConstraint.
///
/// Rational families are written "rational" (0 to 12 poles), "rational:4" (poles), "rational:3/4" (zeros/poles) or
/// "rational:1..8" (poles), each with "+delay" behind it for a dead time; likewise "commensurate" (1 to 6 poles in
/// s^a). "terms" is the family of sums of terms, "terms:4" that of up to 4; likewise "elements" of passive
/// elements.
/// @throws FormulaError
/// @throws std::invalid_argument  a preset's name in other letters (Lag, power_law); a rational family with more than
///     12 poles, more than one zero more than poles, or an empty range.
[[nodiscard]] NamedModel find_model(std::string_view name_or_formula);

/// The model with the formula that suits the data: for a family the best member, where the order is open by BIC and a
/// price for the search over places of poles and arcs, with start values, to be fitted with
/// FitOptions::global_start = false.
///
/// Rational models are factored.  Real poles are p1, p2, ... (rad/s, s/p1 + 1), complex pairs w1, d1, ... (s^2/w1^2 +
/// d1 s/w1 + 1), coefficients of the numerator b0, b1, ..., the dead time L.  Where the imaginary part alone is fitted,
/// a constant beside the fraction is h0.  With a free order a, (s/p1)^a stands for s/p1 and s^a for s.  Sums of terms
/// have R0, L s, R1/(1 + (T1 s)^n1), A1 s^q1 and the like; gains are of either sign.  Any other model is returned as it
/// is.
/// @throws std::invalid_argument  fewer residuals than parameters, or a component other than both, imaginary and real.
[[nodiscard]] NamedModel resolved_model(const FrequencyResponseData& data, const NamedModel& model,
                                        const FitOptions& options);
/// Over time, by the same growth: its columns are what parts of the ratio answer to the input.
/// @throws std::invalid_argument  a family of sums, which are grown on frequency responses only; more zeros than poles;
///     fewer samples than parameters.
[[nodiscard]] NamedModel resolved_model(const TimeResponseData& data, const NamedModel& model,
                                        const TimeFitOptions& options);

}  // namespace frac
