// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "base/wide_vectors.hpp"
#include "exponential_sum.hpp"
#include "filter_kernel.hpp"

namespace frac::detail {

/// What a filter bank computes.  With U the m-fold integral of the input over T^m, from rest at the first sample,
///   y(t_j + theta T) = Re sum over terms of weight e^{rate theta T} x_j + sum_i now_i gamma_i,j,
///   x' = rate x + rate U(t),  U(t_j + tau) = sum_i gamma_i,j (tau/T)^i/i!  on [t_j, t_j + T);
/// direct terms take the input itself in place of U.
/// Up to i = m - 1 gamma_i is an integral of the input over its power of T, gamma_m the input at t_j and gamma_(m+1)
/// what it gains by t_j + T: in a straight line where `is_straight`, else in a jump at the end of the interval.
struct FilterDesign {
  std::vector<Exponential> terms;
  double sample_time = 1;
  double theta = 1;
  std::size_t integrations = 0;
  bool is_straight = false;
  std::vector<double> now;  // of m + 2 powers
  double smallest = 0;      // what an output may err by for an input of 1
};

/// Sample by sample, or block by block in loops over whole vectors, in which all that happens within the block is one
/// matrix.
class FilterBank {
 public:
  static constexpr std::size_t block = filter_block;
  static constexpr std::size_t together = filter_together;
  static constexpr std::size_t most_integrations = 8;
  static constexpr std::size_t most_powers = most_integrations + 2;  // of the input, a straight line included

  explicit FilterBank(const FilterDesign& design);

  void start(double first) noexcept { latest_ = first; }
  [[nodiscard]] double step(double next) noexcept;
  /// `blocks` times `block` samples.
  void run(const double* next, std::size_t blocks, double* output) noexcept;
  void reset() noexcept;
  [[nodiscard]] std::size_t states() const noexcept { return real_count_ + 2 * complex_count_ + integrations_; }

 private:
  struct StatePlace;
  using OwnResponse = std::array<std::array<double, most_powers>, block>;  // by interval and power

  void allocate();
  void add_state(const Exponential& term, const FilterDesign& design, const StatePlace& place, OwnResponse& own);
  void set_response(const OwnResponse& own);
  void set_gains_of_integrals();
  void set_steady_gain(double smallest);

  void add_to_integral(std::size_t q, double gain) noexcept;
  void integrate_block(const double* next, double* extra) noexcept;
  void leave_constant() noexcept;
  void run_constant(std::size_t blocks, double* output) noexcept;
  [[nodiscard]] bool is_real_part(std::size_t s) const noexcept;
  [[nodiscard]] bool settles(const double* next, double before) const noexcept;
  [[nodiscard]] FilterArrays arrays() noexcept;

  std::size_t integrations_, real_count_, complex_count_, real_size_, size_;
  bool is_straight_;
  AlignedVector<double> state_, before_;
  // e^{rate T} - 1 and e^{rate block T} - 1: next to 1 the factors themselves would round the rates away.
  AlignedVector<double> change_, block_change_;
  AlignedVector<double> cross_, block_cross_;  // what the other part of a complex state adds
  AlignedVector<double> output_;               // by state
  AlignedVector<double> drive_;                // by power and state
  std::vector<double> now_;
  AlignedVector<double> block_output_;  // by state and sample of the block
  AlignedVector<double> block_drive_;   // by sample and state
  AlignedVector<double> kernel_;        // block zeros, then the response within the block
  // What a block takes besides its samples: the sample before it and the integrals.
  AlignedVector<double> extra_, extra_output_, extra_drive_;
  // After a block, by integral: what the latest sample, the integrals and the samples of the block add to it.
  std::vector<double> gained_from_extra_, gained_from_sample_;
  std::array<double, most_integrations> integral_{};  // of the input: the (m - i)-fold one over T^(m-i)
  std::array<double, most_integrations> lost_{};      // of them, to rounding
  double latest_ = 0;
  // In a run of one constant value u a state is its end value -u plus what still decays.  Real states come by falling
  // decay, and those before first_ have decayed.
  bool may_settle_ = false;
  double steady_ = 0;
  double steady_gain_ = 0;
  double largest_ = 0;  // output weight
  std::size_t first_ = 0;
};

}  // namespace frac::detail
