#include "filter_bank.hpp"

#include <algorithm>
#include <cmath>
#include <complex>

#include "phi_functions.hpp"

// Copies for processors with wider registers, chosen when the program is loaded.
#if defined(__x86_64__) && defined(__GLIBC__) && !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
#define FRACFIT_WIDE_VECTORS __attribute__((target_clones("avx512f", "fma", "default")))
#else
#define FRACFIT_WIDE_VECTORS
#endif

namespace frac::detail {
namespace {

using Complex = std::complex<double>;
constexpr std::size_t width = 8;
constexpr std::size_t block = FilterBank::block;
// Eight doubles, at any address.
typedef double Vector __attribute__((vector_size(8 * width), aligned(8), may_alias));

Vector& vector_at(double* at) {
  return *reinterpret_cast<Vector*>(at);
}
const Vector& vector_at(const double* at) {
  return *reinterpret_cast<const Vector*>(at);
}

// output[0..block) += sum_k factor[k] row(k)[0..block), rows `stride` doubles apart.
FRACFIT_WIDE_VECTORS void add_rows(const double* factor, std::size_t count, const double* row, std::ptrdiff_t stride,
                                   double* output) {
  Vector a = vector_at(output), b = vector_at(output + 8), c = vector_at(output + 16), d = vector_at(output + 24);
  for (std::size_t k = 0; k < count; ++k, row += stride) {
    const double x = factor[k];
    a += x * vector_at(row);
    b += x * vector_at(row + 8);
    c += x * vector_at(row + 16);
    d += x * vector_at(row + 24);
  }
  vector_at(output) = a;
  vector_at(output + 8) = b;
  vector_at(output + 16) = c;
  vector_at(output + 24) = d;
}

// For each of four factors: output[b][0..16) += sum_k factor[b][k] row(k)[0..16).  Sixteen results times four factors
// stay in registers, and a row is read once for all four.
FRACFIT_WIDE_VECTORS void add_tile(const double* const* factor, std::size_t count, const double* row,
                                   std::ptrdiff_t stride, double* const* output) {
  const double *f0 = factor[0], *f1 = factor[1], *f2 = factor[2], *f3 = factor[3];
  Vector a0 = vector_at(output[0]), b0 = vector_at(output[0] + 8), a1 = vector_at(output[1]),
         b1 = vector_at(output[1] + 8), a2 = vector_at(output[2]), b2 = vector_at(output[2] + 8),
         a3 = vector_at(output[3]), b3 = vector_at(output[3] + 8);
  for (std::size_t k = 0; k < count; ++k, row += stride) {
    const Vector a = vector_at(row), b = vector_at(row + 8);
    a0 += f0[k] * a;
    b0 += f0[k] * b;
    a1 += f1[k] * a;
    b1 += f1[k] * b;
    a2 += f2[k] * a;
    b2 += f2[k] * b;
    a3 += f3[k] * a;
    b3 += f3[k] * b;
  }
  vector_at(output[0]) = a0;
  vector_at(output[0] + 8) = b0;
  vector_at(output[1]) = a1;
  vector_at(output[1] + 8) = b1;
  vector_at(output[2]) = a2;
  vector_at(output[2] + 8) = b2;
  vector_at(output[3]) = a3;
  vector_at(output[3] + 8) = b3;
}

// sum[0..size) += sum_l gamma[l] drive[l * size + ..], a few vectors of states at a time.
FRACFIT_WIDE_VECTORS void add_drive(const double* gamma, const double* drive, std::size_t size, double* sum) {
  std::size_t s = 0;
  for (; s + 4 * width <= size; s += 4 * width) {
    Vector a = vector_at(sum + s), b = vector_at(sum + s + 8), c = vector_at(sum + s + 16), d = vector_at(sum + s + 24);
    for (std::size_t l = 0; l < block; ++l) {
      const double x = gamma[l];
      const double* row = drive + l * size + s;
      a += x * vector_at(row);
      b += x * vector_at(row + 8);
      c += x * vector_at(row + 16);
      d += x * vector_at(row + 24);
    }
    vector_at(sum + s) = a;
    vector_at(sum + s + 8) = b;
    vector_at(sum + s + 16) = c;
    vector_at(sum + s + 24) = d;
  }
  for (; s < size; s += width) {
    Vector a = vector_at(sum + s);
    for (std::size_t l = 0; l < block; ++l) a += gamma[l] * vector_at(drive + l * size + s);
    vector_at(sum + s) = a;
  }
}

bool is_constant(const double* samples) {
  return std::all_of(samples, samples + block, [samples](double each) { return each == samples[0]; });
}

// Below this a state is worth nothing and, denormal, slow.
double flushed(double x) {
  return std::abs(x) < 1e-280 ? 0 : x;
}

std::size_t filled_up(std::size_t count) {
  return (count + width - 1) / width * width;
}

}  // namespace

FilterBank::FilterBank(std::vector<Exponential> terms, double sample_time, double theta, const std::vector<double>& now)
    : channels_(now.size()), now_(now) {
  std::sort(terms.begin(), terms.end(),
            [](const Exponential& a, const Exponential& b) { return a.rate.real() < b.rate.real(); });
  const auto is_real = [](const Exponential& term) { return term.rate.imag() == 0; };
  real_count_ = static_cast<std::size_t>(std::count_if(terms.begin(), terms.end(), is_real));
  complex_count_ = terms.size() - real_count_;
  real_size_ = filled_up(real_count_);
  complex_size_ = filled_up(complex_count_);
  size_ = real_size_ + 2 * complex_size_;
  state_.assign(size_, 0);
  // Tiles of sixteen states may reach beyond the last.
  padded_size_ = size_ + width;
  states_.assign(together * padded_size_, 0);
  driven_.assign(together * padded_size_, 0);
  change_re_.assign(real_size_ + complex_size_, 0);
  change_im_.assign(complex_size_, 0);
  block_change_re_ = change_re_;
  block_change_im_ = change_im_;
  output_.assign(size_, 0);
  drive_.assign(channels_ * size_, 0);
  block_output_.assign(size_ * block, 0);
  block_drive_.assign(channels_ * block * size_ + width, 0);
  block_drive_sum_.assign(channels_ * size_, 0);
  kernel_.assign(channels_ * 2 * block, 0);
  kernel_sum_.assign(channels_ * block, 0);
  for (std::size_t channel = 0; channel < channels_; ++channel) kernel_[channel * 2 * block + block] = now_[channel];

  std::vector<Complex> phis(channels_);
  std::size_t next_real = 0;
  std::size_t next_complex = real_size_;
  for (const Exponential& term : terms) {
    const bool real = is_real(term);
    const std::size_t s = real ? next_real++ : next_complex++;
    const std::size_t s_im = s + complex_size_;
    const Complex z = term.rate * sample_time;
    const Complex factor = std::exp(z);
    phi(z, phis);
    const Complex change = expm1(z);
    const Complex block_change = expm1(z * static_cast<double>(block));
    change_re_[s] = change.real();
    block_change_re_[s] = block_change.real();
    if (!real) {
      change_im_[s - real_size_] = change.imag();
      block_change_im_[s - real_size_] = block_change.imag();
    }
    Complex output = term.weight * std::exp(theta * z);
    output_[s] = output.real();
    if (!real) output_[s_im] = -output.imag();
    Complex power = 1;  // factor^i
    for (std::size_t i = 0; i < block; ++i) {
      const Complex at = output * power;
      block_output_[s * block + i] = flushed(at.real());
      if (!real) block_output_[s_im * block + i] = flushed(-at.imag());
      for (std::size_t channel = 0; channel < channels_; ++channel) {
        const Complex drive = z * phis[channel];
        const Complex later = drive * power;
        double* row = &block_drive_[(channel * block + block - 1 - i) * size_];
        row[s] = flushed(later.real());
        if (!real) row[s_im] = flushed(later.imag());
        if (i + 1 < block) kernel_[channel * 2 * block + block + 1 + i] += (at * drive).real();
        if (i == 0) {
          drive_[channel * size_ + s] = drive.real();
          if (!real) drive_[channel * size_ + s_im] = drive.imag();
        }
      }
      power = std::abs(power * factor) < 1e-280 ? 0 : power * factor;
    }
  }
  // To a constant input from its end values: the instantaneous part less what the states withdraw.
  steady_gain_ = now_[0];
  for (std::size_t s = 0; s < real_size_ + complex_size_; ++s) steady_gain_ -= output_[s];
  for (const double output : output_) largest_ = std::max(largest_, std::abs(output));
  for (std::size_t channel = 0; channel < channels_; ++channel) {
    double sum = 0;
    for (std::size_t i = 0; i < block; ++i) {
      sum += kernel_[channel * 2 * block + block + i];
      kernel_sum_[channel * block + i] = sum;
      for (std::size_t s = 0; s < size_; ++s) {
        block_drive_sum_[channel * size_ + s] += block_drive_[(channel * block + i) * size_ + s];
      }
    }
  }
}

void FilterBank::reset() noexcept {
  std::fill(state_.begin(), state_.end(), 0);
  steady_ = 0;
  first_real_ = first_complex_ = 0;
}

void FilterBank::change(const std::vector<double>& by_re, const std::vector<double>& by_im) noexcept {
  for (std::size_t s = 0; s < real_size_; ++s) state_[s] = flushed(state_[s] + by_re[s] * state_[s]);
  for (std::size_t k = 0; k < complex_size_; ++k) {
    double& re = state_[real_size_ + k];
    double& im = state_[real_size_ + complex_size_ + k];
    const double a = by_re[real_size_ + k];
    const double b = by_im[k];
    const double next = re + (a * re - b * im);
    im = flushed(im + (b * re + a * im));
    re = flushed(next);
  }
}

double FilterBank::step(std::span<const double> gamma) noexcept {
  leave_constant();
  double y = 0;
  for (std::size_t s = 0; s < size_; ++s) y += output_[s] * state_[s];
  change(change_re_, change_im_);
  for (std::size_t channel = 0; channel < channels_; ++channel) {
    y += now_[channel] * gamma[channel];
    for (std::size_t s = 0; s < size_; ++s) state_[s] += drive_[channel * size_ + s] * gamma[channel];
  }
  return y;
}

void FilterBank::leave_constant() noexcept {
  if (steady_ != 0) {
    for (std::size_t s = 0; s < real_size_ + complex_size_; ++s) state_[s] -= steady_;
  }
  steady_ = 0;
  first_real_ = first_complex_ = 0;
}

void FilterBank::run_constant(double value, double* output) noexcept {
  if (steady_ != value) {
    leave_constant();
    steady_ = value;
    for (std::size_t s = 0; s < real_size_ + complex_size_; ++s) state_[s] += steady_;
  }
  std::fill(output, output + block, value * steady_gain_);
  const auto add = [&](std::size_t from, std::size_t to) {
    add_rows(state_.data() + from, to - from, block_output_.data() + from * block, block, output);
  };
  const std::size_t imaginary = real_size_ + complex_size_;
  add(first_real_, real_size_);
  add(real_size_ + first_complex_, imaginary);
  add(imaginary + first_complex_, size_);
  for (std::size_t s = first_real_; s < real_size_; ++s) {
    state_[s] = flushed(state_[s] + block_change_re_[s] * state_[s]);
  }
  for (std::size_t k = first_complex_; k < complex_size_; ++k) {
    double& re = state_[real_size_ + k];
    double& im = state_[imaginary + k];
    const double a = block_change_re_[real_size_ + k];
    const double b = block_change_im_[k];
    const double next = re + (a * re - b * im);
    im = flushed(im + (b * re + a * im));
    re = flushed(next);
  }
  // 1e-22 of the largest output weight is nothing to any sum of a few hundred.
  const auto has_decayed = [&](double state, std::size_t s) {
    return std::abs(state) * std::hypot(output_[s], s < real_size_ ? 0 : output_[s + complex_size_]) <
           1e-22 * std::abs(value) * largest_;
  };
  while (first_real_ < real_count_ && has_decayed(state_[first_real_], first_real_)) state_[first_real_++] = 0;
  while (first_complex_ < complex_count_) {
    const std::size_t s = real_size_ + first_complex_;
    if (!has_decayed(std::hypot(state_[s], state_[s + complex_size_]), s)) break;
    state_[s] = state_[s + complex_size_] = 0;
    ++first_complex_;
  }
}

bool FilterBank::settles(const double* gamma) const noexcept {
  if (gamma[0] == 0 || !is_constant(gamma)) return false;
  for (std::size_t channel = 1; channel < channels_; ++channel) {
    if (gamma[channel * block] != 0 || !is_constant(gamma + channel * block)) return false;
  }
  return true;
}

void FilterBank::run_blocks(const double* gamma, double* output) noexcept {
  const std::size_t stride = channels_ * block;
  bool any_settles = false;
  for (std::size_t b = 0; b < together; ++b) any_settles = any_settles || settles(gamma + b * stride);
  if (any_settles) {
    for (std::size_t b = 0; b < together; ++b) run_block(gamma + b * stride, output + b * block);
    return;
  }
  leave_constant();
  constexpr std::size_t half = block / 2;
  const double* factor[together];
  double* result[together];
  std::fill(driven_.begin(), driven_.end(), 0);
  std::fill(output, output + together * block, 0);
  for (std::size_t channel = 0; channel < channels_; ++channel) {
    for (std::size_t b = 0; b < together; ++b) factor[b] = gamma + b * stride + channel * block;
    if (std::all_of(factor, factor + together, is_constant)) {
      for (std::size_t b = 0; b < together; ++b) {
        const double in = factor[b][0];
        if (in == 0) continue;
        for (std::size_t i = 0; i < block; ++i) output[b * block + i] += in * kernel_sum_[channel * block + i];
        for (std::size_t s = 0; s < size_; ++s) {
          driven_[b * padded_size_ + s] += in * block_drive_sum_[channel * size_ + s];
        }
      }
      continue;
    }
    for (std::size_t s = 0; s < size_; s += half) {
      for (std::size_t b = 0; b < together; ++b) result[b] = &driven_[b * padded_size_ + s];
      add_tile(factor, block, &block_drive_[channel * block * size_ + s], static_cast<std::ptrdiff_t>(size_), result);
    }
    // Row l of the convolution is the kernel moved right by l: it does not reach the first half after half the rows.
    const double* kernel = &kernel_[channel * 2 * block + block];
    for (std::size_t b = 0; b < together; ++b) result[b] = output + b * block;
    add_tile(factor, half, kernel, -1, result);
    for (std::size_t b = 0; b < together; ++b) result[b] = output + b * block + half;
    add_tile(factor, block, kernel + half, -1, result);
  }
  for (std::size_t b = 0; b < together; ++b) {
    std::copy(state_.begin(), state_.end(), &states_[b * padded_size_]);
    change(block_change_re_, block_change_im_);
    for (std::size_t s = 0; s < size_; ++s) state_[s] += driven_[b * padded_size_ + s];
  }
  for (std::size_t b = 0; b < together; ++b) factor[b] = &states_[b * padded_size_];
  for (const std::size_t from : {std::size_t{0}, half}) {
    for (std::size_t b = 0; b < together; ++b) result[b] = output + b * block + from;
    add_tile(factor, size_, block_output_.data() + from, block, result);
  }
}

void FilterBank::run_block(const double* gamma, double* output) noexcept {
  if (settles(gamma)) {
    run_constant(gamma[0], output);
    return;
  }
  leave_constant();
  std::fill(output, output + block, 0);
  add_rows(state_.data(), size_, block_output_.data(), block, output);
  change(block_change_re_, block_change_im_);
  for (std::size_t channel = 0; channel < channels_; ++channel) {
    const double* in = gamma + channel * block;
    if (is_constant(in)) {
      if (in[0] == 0) continue;
      for (std::size_t i = 0; i < block; ++i) output[i] += in[0] * kernel_sum_[channel * block + i];
      for (std::size_t s = 0; s < size_; ++s) state_[s] += in[0] * block_drive_sum_[channel * size_ + s];
    } else {
      // Row l of the convolution is the kernel moved right by l.
      add_rows(in, block, &kernel_[channel * 2 * block + block], -1, output);
      add_drive(in, block_drive_.data() + channel * block * size_, size_, state_.data());
    }
  }
}

}  // namespace frac::detail
