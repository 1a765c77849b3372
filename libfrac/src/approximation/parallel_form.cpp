// SPDX-License-Identifier: BSD-3-Clause
#include "parallel_form.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

#include "frac/cancellation.hpp"

namespace frac::detail {
namespace {

using Extended = long double;
using ExtendedComplex = std::complex<Extended>;

// H(s) without its whole power of s, and at a pole its residue: the factor that vanishes is left out.  The differences
// of stored roots are exact, so that the value is as good as the roots define it.  A zero is taken with a pole: on wide
// bands the product of all the zeros' factors alone would leave the range of double.
ExtendedComplex value_at(const ZeroPoleGain& system, std::complex<double> at) {
  const ExtendedComplex s(at);
  std::vector<ExtendedComplex> zeros;
  std::vector<ExtendedComplex> poles;
  for (const double root : system.zeros) zeros.emplace_back(s - static_cast<Extended>(root));
  for (const double root : system.poles) poles.emplace_back(s - static_cast<Extended>(root));
  for (const std::complex<double> root : system.zero_pairs) {
    zeros.emplace_back(s - ExtendedComplex(root));
    zeros.emplace_back(s - std::conj(ExtendedComplex(root)));
  }
  for (const std::complex<double> root : system.pole_pairs) {
    poles.emplace_back(s - ExtendedComplex(root));
    poles.emplace_back(s - std::conj(ExtendedComplex(root)));
  }
  ExtendedComplex value = static_cast<Extended>(system.gain);
  for (std::size_t i = 0; i < poles.size(); ++i) {
    value *= zeros[i];
    if (poles[i] != ExtendedComplex(0)) value /= poles[i];
  }
  return value;
}

// Largest sum of |terms| over |s|^order on the band, for the form with `constant`; each residue is divided by its pole
// and multiplied with s where that is the static gain.  Terms vary over factors of omega that are not small, so that
// two points per e-fold miss less than a tenth of the maximum.
double condition(const ParallelForm& form, const ZeroPoleGain& system, bool from_static_gain, double order,
                 FrequencyBand band) {
  struct Term {
    double size, re, im;
  };
  std::vector<Term> terms;
  const auto add = [&](std::complex<double> residue, std::complex<double> pole) {
    terms.push_back({std::abs(from_static_gain ? residue / pole : residue), pole.real(), pole.imag()});
  };
  for (std::size_t k = 0; k < system.poles.size(); ++k) add(form.residues[k], system.poles[k]);
  for (std::size_t k = 0; k < system.pole_pairs.size(); ++k) {
    add(form.pair_residues[k], system.pole_pairs[k]);
    add(std::conj(form.pair_residues[k]), std::conj(system.pole_pairs[k]));
  }
  const double width = std::log(band.upper) - std::log(band.lower);
  const int steps = static_cast<int>(std::ceil(2 * width)) + 1;
  double largest = 0;
  for (int i = 0; i <= steps; ++i) {
    const double omega = std::exp(std::log(band.lower) + width * i / steps);
    double sum = 0;
    for (const Term& term : terms) sum += term.size / std::hypot(term.re, omega - term.im);
    const double constant = std::abs(from_static_gain ? form.static_gain : form.direct);
    largest = std::max(largest, (constant + (from_static_gain ? omega : 1.0) * sum) / std::pow(omega, order));
  }
  return largest;
}

}  // namespace

ParallelForm parallel_form(const ZeroPoleGain& system, double fractional_order, FrequencyBand band,
                           double system_error) {
  ParallelForm form;
  form.direct = system.gain;
  for (const double pole : system.poles) {
    throw_if_cancelled();
    form.residues.push_back(static_cast<double>(value_at(system, pole).real()));
  }
  for (const std::complex<double> pole : system.pole_pairs) {
    form.pair_residues.emplace_back(std::complex<double>(value_at(system, pole)));
  }
  // A rounding per addition in any order, and some ten of a term: its stored residue, quotients and products.
  const auto terms = static_cast<double>(system.poles.size() + 2 * system.pole_pairs.size());
  const double rounding = 1.1 * (terms + 10) * std::numeric_limits<double>::epsilon() / 2;
  const auto error_with = [&](bool from_static_gain) {
    return system_error + rounding * condition(form, system, from_static_gain, fractional_order, band);
  };
  form.direct_error = error_with(false);
  if (std::find(system.poles.begin(), system.poles.end(), 0.0) == system.poles.end()) {
    form.static_gain = static_cast<double>(value_at(system, 0).real());
    form.static_error = error_with(true);
  }
  return form;
}

}  // namespace frac::detail
