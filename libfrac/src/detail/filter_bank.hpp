#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "exponential_sum.hpp"

namespace frac::detail {

/// y(t_j + theta T) = Re sum over exponentials of weight e^{rate theta T} x_j + sum_i now_i gamma_i,j with
///   x' = rate x + rate U(t),  U(t_j + tau) = sum_i gamma_i,j (tau/T)^i/i!  on [t_j, t_j + T):
/// one channel per power of tau.  Single steps, or blocks of 32 whose inner loops run over whole vectors.
class FilterBank {
 public:
  static constexpr std::size_t block = 32;

  /// @param now  for each channel the output at theta T to (tau/T)^i/i! from rest.
  FilterBank(std::vector<Exponential> terms, double sample_time, double theta, const std::vector<double>& now);

  [[nodiscard]] double step(std::span<const double> gamma) noexcept;
  /// gamma[channel * block + j].
  void run_block(const double* gamma, double* output) noexcept;
  void reset() noexcept;
  [[nodiscard]] std::size_t states() const noexcept { return real_count_ + 2 * complex_count_; }

 private:
  void change(const std::vector<double>& by_re, const std::vector<double>& by_im) noexcept;
  void leave_constant() noexcept;
  void run_constant(double value, double* output) noexcept;

  // States: the real ones, then all real parts, then all imaginary parts, each group filled up to whole vectors.
  std::size_t channels_, real_count_, complex_count_, real_size_, complex_size_, size_;
  std::vector<double> state_;
  // e^{rate T} - 1 and e^{rate block T} - 1: next to 1 the factors themselves would round the rates away.
  std::vector<double> change_re_, change_im_, block_change_re_, block_change_im_;
  std::vector<double> output_;  // by state, for one step
  std::vector<double> drive_;   // by channel and state, for one step
  std::vector<double> now_;
  std::vector<double> block_output_;     // by state and sample of the block
  std::vector<double> block_drive_;      // by channel, sample and state
  std::vector<double> block_drive_sum_;  // by channel and state: of a constant input
  std::vector<double> kernel_;           // by channel: block zeros, then the response within the block
  std::vector<double> kernel_sum_;       // by channel and sample: to a constant input
  // In a run of one constant value u a state is its end value -u plus what still decays.  States come by falling decay,
  // and those before first_real_ and first_complex_ have decayed.
  double steady_ = 0;
  double steady_gain_ = 0;
  double largest_ = 0;  // output weight
  std::size_t first_real_ = 0;
  std::size_t first_complex_ = 0;
};

}  // namespace frac::detail
