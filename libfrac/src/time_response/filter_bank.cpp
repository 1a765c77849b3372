// SPDX-License-Identifier: BSD-3-Clause
#include "filter_bank.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>

#include "special/phi_functions.hpp"

namespace frac::detail {
namespace {

using Complex = std::complex<double>;
constexpr std::size_t block = FilterBank::block;
constexpr std::size_t lane = filter_lane;
constexpr std::size_t half = lane / 2;  // from a real part to its imaginary part
constexpr std::size_t most_powers = FilterBank::most_powers;

constexpr std::array<double, most_powers> inverse_factorials() {
  std::array<double, most_powers> values{};
  double value = 1;
  for (std::size_t n = 0; n < most_powers; ++n) {
    if (n > 0) value /= static_cast<double>(n);
    values[n] = value;
  }
  return values;
}
constexpr std::array<double, most_powers> inverse_factorial = inverse_factorials();

// Smaller numbers do not matter, and as denormal ones they are slow.
double flushed(double x) {
  return std::abs(x) < 1e-280 ? 0 : x;
}

std::size_t filled_up(std::size_t count, std::size_t to) {
  return (count + to - 1) / to * to;
}

// The effect that a unit of each power of the input has some intervals after the one in which it is the input.
template <typename Value>
class ByLag {
 public:
  using Powers = std::array<Value, most_powers>;

  ByLag(std::size_t integrations, bool is_straight) : integrations_(integrations), is_straight_(is_straight) {}

  // `own` is the effect without the integrals that each power leaves behind; those act from the next interval on.
  void append(const Powers& own) {
    value_[lags_] = own;
    if (lags_ > 0) {
      const Powers& before = value_[lags_ - 1];
      for (std::size_t q = 0; q <= integrations_ + (is_straight_ ? 1 : 0); ++q) {
        for (std::size_t i = 0; i < integrations_ && i <= q; ++i) {
          value_[lags_][q] += inverse_factorial[q - i] * before[i];
        }
      }
    }
    ++lags_;
  }
  [[nodiscard]] const Value& integral(std::size_t q, std::size_t lag) const { return value_[lag][q]; }
  // The effect of the first sample of an interval, without that of the interval that it ends.
  [[nodiscard]] Value start(std::size_t lag) const {
    return value_[lag][integrations_] - value_[lag][integrations_ + 1];
  }
  // The effect of a sample, by the number of intervals since the one that it ends.
  [[nodiscard]] Value sample(std::size_t lag) const {
    return lag == 0 ? value_[0][integrations_ + 1] : value_[lag][integrations_ + 1] + start(lag - 1);
  }

 private:
  std::size_t integrations_;
  bool is_straight_;
  std::size_t lags_ = 0;
  std::array<Powers, block> value_;
};

}  // namespace

/// Where a state stands in the vectors and matrices of the bank: a real one in one slot, a complex one in two.
struct FilterBank::StatePlace {
  std::size_t slot;  // of the real part
  std::size_t size;  // of a vector of states
  bool is_real;

  void put(AlignedVector<double>& list, std::size_t row, Complex value) const {
    put_at(list[row * size + slot], half, value);
  }
  void put_in_column(AlignedVector<double>& matrix, std::size_t rows, std::size_t row, Complex value) const {
    put_at(matrix[(slot / lane * rows + row) * lane + slot % lane], half, value);
  }
  void put_in_row(AlignedVector<double>& matrix, std::size_t column, Complex value) const {
    put_at(matrix[(column / lane * size + slot) * lane + column % lane], half * lane, value);
  }
  void put_change(AlignedVector<double>& change, AlignedVector<double>& cross, Complex value) const {
    change[slot] = value.real();
    if (is_real) return;
    change[slot + half] = value.real();
    cross[slot] = -value.imag();
    cross[slot + half] = value.imag();
  }

 private:
  void put_at(double& re, std::size_t to_imaginary, Complex value) const {
    re = flushed(value.real());
    if (!is_real) *(&re + to_imaginary) = flushed(value.imag());
  }
};

FilterBank::FilterBank(const FilterDesign& design)
    : integrations_(design.integrations), is_straight_(design.is_straight), now_(design.now) {
  std::vector<Exponential> terms = design.terms;
  std::sort(terms.begin(), terms.end(),
            [](const Exponential& a, const Exponential& b) { return a.rate.real() < b.rate.real(); });
  const auto is_real = [](const Exponential& term) { return term.rate.imag() == 0; };
  real_count_ = static_cast<std::size_t>(std::count_if(terms.begin(), terms.end(), is_real));
  complex_count_ = terms.size() - real_count_;
  real_size_ = filled_up(real_count_, lane);
  size_ = real_size_ + 2 * filled_up(complex_count_, half);
  allocate();
  // Response of the output to each power, without the integrals.
  OwnResponse own{};
  std::copy(now_.begin(), now_.end(), own[0].begin());
  std::size_t next_real = 0;
  std::size_t next_complex = 0;
  for (const Exponential& term : terms) {
    const bool real = is_real(term);
    const std::size_t s = real ? next_real++ : real_size_ + next_complex / half * lane + next_complex % half;
    if (!real) ++next_complex;
    add_state(term, design, {s, size_, real}, own);
  }
  set_response(own);
  set_gains_of_integrals();
  set_steady_gain(design.smallest);
}

void FilterBank::allocate() {
  const std::size_t extra = 1 + integrations_;
  state_.assign(size_, 0);
  before_.assign(together * size_, 0);
  change_.assign(size_, 0);
  block_change_.assign(size_, 0);
  cross_.assign(size_, 0);
  block_cross_.assign(size_, 0);
  output_.assign(size_, 0);
  drive_.assign((integrations_ + 2) * size_, 0);
  block_output_.assign(size_ * block, 0);
  block_drive_.assign(block * size_, 0);
  extra_drive_.assign(extra * size_, 0);
  extra_.assign(together * extra, 0);
  kernel_.assign(2 * block, 0);
  extra_output_.assign(extra * block, 0);
}

void FilterBank::add_state(const Exponential& term, const FilterDesign& design, const StatePlace& place,
                           OwnResponse& own) {
  const std::size_t extra = 1 + integrations_;
  const Complex z = term.rate * design.sample_time;
  place.put_change(change_, cross_, expm1(z));
  place.put_change(block_change_, block_cross_, expm1(z * static_cast<double>(block)));
  std::vector<Complex> phis(integrations_ + 2);
  phi(z, phis);
  const Complex factor = std::exp(z);
  const Complex output = std::conj(term.weight * std::exp(design.theta * z));
  place.put(output_, 0, output);
  ByLag<Complex> driven(integrations_, is_straight_);
  Complex power = 1;  // factor^i
  for (std::size_t i = 0; i < block; ++i) {
    place.put_in_row(block_output_, i, output * std::conj(power));
    std::array<Complex, most_powers> later{};
    const std::size_t first = term.is_direct ? integrations_ : 0;
    for (std::size_t q = first; q <= integrations_ + (is_straight_ ? 1 : 0); ++q) {
      later[q] = z * phis[q - first] * power;
      if (i == 0) place.put(drive_, q, later[q]);
      if (i + 1 < block) own[i + 1][q] += (std::conj(output) * later[q]).real();
    }
    driven.append(later);
    power = std::abs(power * factor) < 1e-280 ? 0 : power * factor;
  }
  for (std::size_t i = 0; i < block; ++i) place.put_in_column(block_drive_, block, i, driven.sample(block - 1 - i));
  place.put_in_column(extra_drive_, extra, 0, driven.start(block - 1));
  for (std::size_t q = 0; q < integrations_; ++q) {
    place.put_in_column(extra_drive_, extra, 1 + q, driven.integral(q, block - 1));
  }
}

void FilterBank::set_response(const OwnResponse& own) {
  const std::size_t extra = 1 + integrations_;
  ByLag<double> response(integrations_, is_straight_);
  for (const auto& each : own) response.append(each);
  for (std::size_t i = 0; i < block; ++i) {
    kernel_[block + i] = response.sample(i);
    double* column = &extra_output_[i / lane * extra * lane + i % lane];
    column[0] = response.start(i);
    for (std::size_t q = 0; q < integrations_; ++q) column[(1 + q) * lane] = response.integral(q, i);
  }
}

void FilterBank::set_gains_of_integrals() {
  for (std::size_t p = 0; p < integrations_; ++p) {
    // What each power adds to this integral by the end of its own interval.
    std::array<double, most_powers> own{};
    own[p] = 1;
    for (std::size_t q = p + 1; q <= integrations_ + (is_straight_ ? 1 : 0); ++q) own[q] = inverse_factorial[q - p];
    ByLag<double> gained(integrations_, is_straight_);
    gained.append(own);
    for (std::size_t i = 1; i < block; ++i) gained.append({});
    gained_from_extra_.push_back(gained.start(block - 1));
    for (std::size_t q = 0; q < integrations_; ++q) {
      gained_from_extra_.push_back(gained.integral(q, block - 1) - (q == p ? 1 : 0));
    }
    for (std::size_t i = 0; i < block; ++i) gained_from_sample_.push_back(gained.sample(block - 1 - i));
  }
}

// The output for a constant input of 1 after all states have reached their end values, -1.
void FilterBank::set_steady_gain(double smallest) {
  steady_gain_ = now_[integrations_];
  double total = 0;
  for (std::size_t s = 0; s < size_; ++s) {
    if (is_real_part(s)) steady_gain_ -= output_[s];
    largest_ = std::max(largest_, std::abs(output_[s]));
    total += std::abs(output_[s]);
  }
  // Before the response has risen, the gain and the decaying parts cancel, which costs digits.
  may_settle_ = integrations_ == 0 && total * std::numeric_limits<double>::epsilon() <= smallest;
}

bool FilterBank::is_real_part(std::size_t s) const noexcept {
  return s < real_size_ || s % lane < half;
}

void FilterBank::reset() noexcept {
  std::fill(state_.begin(), state_.end(), 0);
  integral_.fill(0);
  lost_.fill(0);
  latest_ = 0;
  steady_ = 0;
  first_ = 0;
}

void FilterBank::add_to_integral(std::size_t q, double gain) noexcept {
  // The part of the increment that rounding takes is added the next time.
  const double increment = lost_[q] + gain;
  const double sum = integral_[q] + increment;
  lost_[q] = increment - (sum - integral_[q]);
  integral_[q] = sum;
}

double FilterBank::step(double next) noexcept {
  leave_constant();
  const std::size_t m = integrations_;
  std::array<double, most_powers> gamma{};
  std::copy_n(integral_.begin(), m, gamma.begin());
  gamma[m] = latest_;
  gamma[m + 1] = next - latest_;
  double y = 0;
  for (std::size_t s = 0; s < size_; ++s) y += output_[s] * state_[s];
  for (std::size_t s = 0; s < real_size_; ++s) state_[s] = flushed(state_[s] + change_[s] * state_[s]);
  for (std::size_t group = real_size_; group < size_; group += lane) {
    for (std::size_t s = group; s < group + half; ++s) {
      const double re = state_[s];
      const double im = state_[s + half];
      state_[s] = flushed(re + (change_[s] * re + cross_[s] * im));
      state_[s + half] = flushed(im + (change_[s + half] * im + cross_[s + half] * re));
    }
  }
  const std::size_t last = m + (is_straight_ ? 1 : 0);
  for (std::size_t q = 0; q <= m + 1; ++q) y += now_[q] * gamma[q];
  for (std::size_t q = 0; q <= last; ++q) {
    for (std::size_t s = 0; s < size_; ++s) state_[s] += drive_[q * size_ + s] * gamma[q];
  }
  for (std::size_t p = 0; p < m; ++p) {
    double gain = 0;
    for (std::size_t q = p + 1; q <= last; ++q) gain += inverse_factorial[q - p] * gamma[q];
    add_to_integral(p, gain);
  }
  latest_ = next;
  return y;
}

void FilterBank::integrate_block(const double* next, double* extra) noexcept {
  const std::size_t count = 1 + integrations_;
  extra[0] = latest_;
  std::copy_n(integral_.begin(), integrations_, extra + 1);
  for (std::size_t p = 0; p < integrations_; ++p) {
    double gain = 0;
    for (std::size_t q = 0; q < count; ++q) gain += gained_from_extra_[p * count + q] * extra[q];
    for (std::size_t i = 0; i < block; ++i) gain += gained_from_sample_[p * block + i] * next[i];
    add_to_integral(p, gain);
  }
  latest_ = next[block - 1];
}

FilterArrays FilterBank::arrays() noexcept {
  return {.first = first_ / lane * lane,
          .size = size_,
          .extra = 1 + integrations_,
          .change = block_change_.data(),
          .cross = block_cross_.data(),
          .state_output = block_output_.data(),
          .drive = block_drive_.data(),
          .kernel = kernel_.data(),
          .extra_output = extra_output_.data(),
          .extra_drive = extra_drive_.data(),
          .state = state_.data(),
          .before = before_.data()};
}

bool FilterBank::settles(const double* next, double before) const noexcept {
  if (!may_settle_ || next[0] != before) return false;
  std::ptrdiff_t others = 0;
  for (std::size_t i = 0; i < block; ++i) others += next[i] != before ? 1 : 0;
  return others == 0;
}

void FilterBank::run(const double* next, std::size_t blocks, double* output) noexcept {
  while (blocks > 0) {
    // Takes as many blocks at once as are alike.
    const std::size_t most = std::min(blocks, together);
    const bool constant = settles(next, latest_);
    std::size_t count = 1;
    while (count < most && settles(next + count * block, next[count * block - 1]) == constant) ++count;
    if (constant) {
      run_constant(count, output);
    } else {
      leave_constant();
      for (std::size_t b = 0; b < count; ++b) integrate_block(next + b * block, &extra_[b * (1 + integrations_)]);
      // Where the output overwrites the input, samples would change that are still to be read.
      std::array<double, together * block> copy;
      const bool overlaps = output < next + count * block && next < output + count * block;
      if (overlaps) std::copy_n(next, count * block, copy.begin());
      const FilterInput input{overlaps ? copy.data() : next, extra_.data()};
      run_filter(arrays(), &input, 0, count, output);
    }
    next += count * block;
    output += count * block;
    blocks -= count;
  }
}

void FilterBank::leave_constant() noexcept {
  if (steady_ != 0) {
    for (std::size_t s = 0; s < size_; ++s) {
      if (is_real_part(s)) state_[s] -= steady_;
    }
  }
  steady_ = 0;
  first_ = 0;
}

void FilterBank::run_constant(std::size_t blocks, double* output) noexcept {
  if (steady_ != latest_) {
    leave_constant();
    steady_ = latest_;
    for (std::size_t s = 0; s < size_; ++s) {
      if (is_real_part(s)) state_[s] += steady_;
    }
  }
  run_filter(arrays(), nullptr, latest_ * steady_gain_, blocks, output);
  // 1e-22 of the largest output weight is nothing to any sum of a few hundred.
  const auto has_decayed = [&](std::size_t s) {
    return std::abs(state_[s] * output_[s]) < 1e-22 * std::abs(latest_) * largest_;
  };
  for (; first_ < real_count_ && has_decayed(first_); ++first_) state_[first_] = 0;
}

}  // namespace frac::detail
