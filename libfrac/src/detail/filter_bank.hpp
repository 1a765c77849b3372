#pragma once

#include <array>
#include <cstddef>
#include <new>
#include <span>
#include <vector>

#include "exponential_sum.hpp"

namespace frac::detail {

/// Memory on cache lines, which vectors then never straddle.
template <typename T>
struct CacheLineAllocator {
  using value_type = T;
  CacheLineAllocator() = default;
  template <typename U>
  explicit CacheLineAllocator(const CacheLineAllocator<U>&) noexcept {}
  static constexpr std::align_val_t line{64};
  [[nodiscard]] T* allocate(std::size_t count) { return static_cast<T*>(::operator new(count * sizeof(T), line)); }
  void deallocate(T* memory, std::size_t) noexcept { ::operator delete(memory, line); }
  bool operator==(const CacheLineAllocator&) const = default;
};
using AlignedVector = std::vector<double, CacheLineAllocator<double>>;

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
  /// `together` blocks one after the other, gamma[(b * channels + channel) * block + j].
  static constexpr std::size_t together = 4;
  void run_blocks(const double* gamma, double* output) noexcept;
  void reset() noexcept;
  [[nodiscard]] std::size_t states() const noexcept { return real_count_ + 2 * complex_count_; }

 private:
  [[nodiscard]] bool settles(const double* gamma) const noexcept;
  void change(const std::vector<double>& by_re, const std::vector<double>& by_im) noexcept;
  void leave_constant() noexcept;
  void run_constant(double value, double* output) noexcept;

  // States: the real ones, then all real parts, then all imaginary parts, each group filled up to whole vectors.
  std::size_t channels_, real_count_, complex_count_, real_size_, complex_size_, size_, padded_size_;
  std::vector<double> state_;
  AlignedVector states_;  // before each of the blocks run together, and what their input adds
  AlignedVector driven_;
  // e^{rate T} - 1 and e^{rate block T} - 1: next to 1 the factors themselves would round the rates away.
  std::vector<double> change_re_, change_im_, block_change_re_, block_change_im_;
  std::vector<double> output_;  // by state, for one step
  std::vector<double> drive_;   // by channel and state, for one step
  std::vector<double> now_;
  AlignedVector block_output_;           // by state and sample of the block
  AlignedVector block_drive_;            // by channel, sample and state
  std::vector<double> block_drive_sum_;  // by channel and state: of a constant input
  AlignedVector kernel_;                 // by channel: block zeros, then the response within the block
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
