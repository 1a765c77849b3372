// SPDX-License-Identifier: BSD-3-Clause
#include "parallel_form.hpp"

#include <cstddef>

namespace frac::detail {
namespace {

using Extended = long double;
using ExtendedComplex = std::complex<Extended>;

// The differences of stored roots are exact, so that a residue is as good as the roots define it.  A zero is taken with
// a pole: on wide bands the product of all the zeros' factors alone would leave the range of double.
ExtendedComplex residue(const ZeroPoleGain& system, std::complex<double> at) {
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

}  // namespace

ParallelForm parallel_form(const ZeroPoleGain& system) {
  ParallelForm form;
  form.direct = system.gain;
  for (const double pole : system.poles) form.residues.push_back(static_cast<double>(residue(system, pole).real()));
  for (const std::complex<double> pole : system.pole_pairs) {
    form.pair_residues.emplace_back(std::complex<double>(residue(system, pole)));
  }
  return form;
}

}  // namespace frac::detail
