#pragma once

#include <complex>
#include <vector>

namespace frac::detail {

/// C(z) = constant + sum weight_j w/(w + corner_j),  w = (z - 1)/(z + 1): stable, as all corners are positive.
struct GainCorrection {
  double constant = 1;
  std::vector<double> corners;
  std::vector<double> weights;
  double error = 0;  // largest |C/target - 1| on the band

  [[nodiscard]] std::complex<double> response(std::complex<double> w) const;
};

/// What the sections s^a = w^a (2/T)^a and `differences` backward differences leave to be made up for at x = omega T/2:
///   (x/tan x)^gain_order (x e^{jx}/sin x)^differences.
struct CorrectionTarget {
  double gain_order;
  int differences;
  [[nodiscard]] std::complex<double> operator()(double x) const;
};

/// The correction with the fewest corners whose error on 0 < x <= edge is at most `tolerance`; if there is none, the
/// one of least error among those whose |C| up to the Nyquist frequency stays within `most_gain`: a filter without
/// delay pays for accuracy up to a frequency with gain beyond it.
/// @param occupied  poles -w of the sections, which the corners keep clear of.
[[nodiscard]] GainCorrection gain_correction(const CorrectionTarget& target, double edge, double tolerance,
                                             double most_gain, const std::vector<double>& occupied);

}  // namespace frac::detail
