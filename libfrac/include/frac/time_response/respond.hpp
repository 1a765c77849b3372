// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include "frac/model/fractional_transfer_function.hpp"
#include "frac/model/hold.hpp"

namespace frac {

/// Response of a fractional transfer function to any input given by samples, from rest at the first, as a filter with a
/// fixed number of states.  With G(s) s^m bounded by 1/|s| at the origin (m = 0 without integrators; more where the
/// horizon ends before the response has risen, whose parts would cancel),
///   G(s) s^m / s = sum over poles and nodes of weight/(s - rate) + constants:
/// the residues of the poles and the integral along the branch cut by the trapezoidal rule in ln|s|, which sees a known
/// share of a pole beside the cut.  Each term answers a piecewise polynomial exactly, so that only the approximation of
/// G itself errs, by `tolerance` of the largest value of the step response over the horizon.  Sub-sample dead time is
/// exact too.
/// Not for improper G (step response infinite at its start).  One object serves one signal; copies are independent.
class ResponseFilter {
 public:
  /// @param sample_time  s, > 0.
  /// @param tolerance    1e-13 to 0.1.
  /// @param horizon      number of samples the filter is good for, 1 to 10^12; fewer states for fewer samples.
  /// @throws std::invalid_argument  an argument out of range, G improper, more than 8 integrators, or a dead time above
  ///                                10^9 samples.
  /// @throws std::domain_error      the poles could not be counted.
  ResponseFilter(const FractionalTransferFunction& model, double sample_time, double tolerance = 1e-9,
                 Hold hold = Hold::zero_order, double horizon = 1e9);
  ~ResponseFilter();
  ResponseFilter(const ResponseFilter&);
  ResponseFilter& operator=(const ResponseFilter&);
  ResponseFilter(ResponseFilter&&) noexcept;
  ResponseFilter& operator=(ResponseFilter&&) noexcept;

  /// Takes u(n T), returns y(n T).  No allocation.  A sample that is not finite is not checked for and spoils the
  /// state.
  [[nodiscard]] double step(double sample) noexcept;
  /// The same for many samples, faster; continues where the last call ended.  In place too.
  void run(std::span<const double> samples, std::span<double> output);
  /// Back to rest.
  void reset() noexcept;

  /// Real numbers of memory without the dead time.
  [[nodiscard]] std::size_t states() const noexcept;

 private:
  struct Filter;
  std::unique_ptr<Filter> filter_;
};

/// Response to samples u(0), u(T), ...; y(0) included.
/// @throws std::invalid_argument  as ResponseFilter; no sample; a sample not finite, named by its index.
[[nodiscard]] std::vector<double> respond(const FractionalTransferFunction& model, std::span<const double> samples,
                                          double sample_time, double tolerance = 1e-9, Hold hold = Hold::zero_order);

/// The same by Gruenwald-Letnikov differences of every term, full memory: first order accurate, cost proportional to
/// the square of the number of samples; what most toolboxes do, for comparison.  Dead time is rounded to samples.
/// @throws std::invalid_argument  as respond(); highest denominator order below the numerator's.
[[nodiscard]] std::vector<double> respond_grunwald_letnikov(const FractionalTransferFunction& model,
                                                            std::span<const double> samples, double sample_time);

}  // namespace frac
