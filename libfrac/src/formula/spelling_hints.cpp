// SPDX-License-Identifier: BSD-3-Clause
#include "spelling_hints.hpp"

#include <algorithm>
#include <array>
#include <utility>

namespace frac::detail {
namespace {

using Hint = std::pair<std::string_view, std::string_view>;

// In UTF-8; the variants of a letter stand beside it.
constexpr std::array greek_letters{
    Hint{"α", "alpha"},   Hint{"β", "beta"},   Hint{"γ", "gamma"}, Hint{"δ", "delta"}, Hint{"ε", "epsilon"},
    Hint{"ϵ", "epsilon"}, Hint{"ζ", "zeta"},   Hint{"η", "eta"},   Hint{"θ", "theta"}, Hint{"ϑ", "theta"},
    Hint{"κ", "kappa"},   Hint{"λ", "lambda"}, Hint{"μ", "mu"},    Hint{"µ", "mu"},    Hint{"ν", "nu"},
    Hint{"ξ", "xi"},      Hint{"ρ", "rho"},    Hint{"σ", "sigma"}, Hint{"τ", "tau"},   Hint{"φ", "phi"},
    Hint{"ϕ", "phi"},     Hint{"χ", "chi"},    Hint{"ψ", "psi"},   Hint{"Γ", "Gamma"}, Hint{"Δ", "Delta"},
    Hint{"Θ", "Theta"},   Hint{"Λ", "Lambda"}, Hint{"Φ", "Phi"},   Hint{"Ψ", "Psi"},   Hint{"Ω", "Omega"}};

constexpr std::array signs{Hint{"·", "for a product write * or a blank"},
                           Hint{"×", "for a product write * or a blank"},
                           Hint{"⋅", "for a product write * or a blank"},
                           Hint{"∙", "for a product write * or a blank"},
                           Hint{"−", "for a minus write -"},
                           Hint{"–", "for a minus write -"},
                           Hint{"÷", "for a quotient write /"},
                           Hint{"∕", "for a quotient write /"},
                           Hint{"²", "for a power write ^2"},
                           Hint{"³", "for a power write ^3"},
                           Hint{"¹", "for a power write ^1"},
                           Hint{"⁰", "for a power write ^0"},
                           Hint{"⁻", "for a power write ^-"},
                           Hint{"½", "write 0.5"},
                           Hint{"√", "for a root write sqrt( )"},
                           Hint{"∞", "numbers are finite"},
                           Hint{"π", "pi is no parameter; write 3.14159265358979"},
                           Hint{"ω", "for j omega write s"},
                           Hint{"[", "write parentheses ( )"},
                           Hint{"]", "write parentheses ( )"},
                           Hint{"{", "write parentheses ( )"},
                           Hint{"}", "write parentheses ( )"},
                           Hint{"\\", "LaTeX is not read; write a/b, ( ), and names such as tau"},
                           Hint{"=", "give the right-hand side alone"},
                           Hint{"'", "names are letters, digits and _"},
                           Hint{"|", "there is no magnitude in a formula; give the transfer function"}};

}  // namespace

std::string spelling_hint(std::string_view formula, std::size_t position) {
  const std::string_view rest = formula.substr(std::min(position, formula.size()));
  for (const auto& [letter, name] : greek_letters) {
    if (rest.starts_with(letter)) return "a Greek letter; spell it out: " + std::string(name);
  }
  for (const auto& [sign, hint] : signs) {
    if (rest.starts_with(sign)) return "'" + std::string(sign) + "' is not read; " + std::string(hint);
  }
  return {};
}

}  // namespace frac::detail
