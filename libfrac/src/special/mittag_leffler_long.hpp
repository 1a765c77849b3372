// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <complex>
#include <map>
#include <utility>
#include <vector>

namespace frac::detail {

/// E_{alpha,beta} for 0 < alpha <= 2 and beta < -1 in long double.  The nodes of the contour weigh as much as
/// Gamma(1 + alpha - beta), while the function may be smaller by the sine of a reflected gamma function; with
///   sum a/(v - z) = -sum_{j=1..m} z^-j/Gamma(beta - alpha j) + z^-m sum a v^m/(v - z)     (far out, m > 0)
///   sum a/(v - z) = sum_{j<k} z^j/Gamma(beta + alpha j) + z^k sum a v^-k/(v - z)          (near 0, m = -k)
/// the terms on the left are exact, and m is taken where the nodes that remain weigh least.
class LongMittagLeffler {
 public:
  LongMittagLeffler(double alpha, double beta) : alpha_(alpha), beta_(beta) {}
  [[nodiscard]] bool is(double alpha, double beta) const noexcept { return alpha == alpha_ && beta == beta_; }

  struct ValueAndDerivative {
    std::complex<double> value;
    std::complex<double> derivative;
  };
  /// z not 0.  Infinite or NaN parts where the function or its parts outgrow a long double.
  [[nodiscard]] ValueAndDerivative operator()(std::complex<double> z);

 private:
  using Real = long double;
  using Complex = std::complex<Real>;
  struct Node {
    Complex weight, v;
  };
  struct Sum {
    Complex value, slope;
    void add(Complex part, Complex part_slope) {
      value += part;
      slope += part_slope;
    }
  };
  struct Pole {
    Real argument, log_radius;  // of s
  };
  [[nodiscard]] int chosen_power(Real log_modulus) const;
  [[nodiscard]] std::vector<Pole> poles(Complex z) const;
  [[nodiscard]] const std::vector<Node>& nodes(int power, bool shifted);
  [[nodiscard]] Real coefficient(int j);
  void add_terms(Complex z, int power, Sum& sum);
  void add_nodes(Complex z, int power, bool shifted, Sum& sum);
  void add_pole(Complex z, const Pole& pole, bool shifted, Sum& sum) const;

  double alpha_, beta_;
  std::vector<Real> rising_, falling_;  // 1/Gamma(beta + alpha j), j = 0, 1, ... and j = -1, -2, ...
  std::map<std::pair<int, bool>, std::vector<Node>> nodes_;  // by power and shift
};

}  // namespace frac::detail
