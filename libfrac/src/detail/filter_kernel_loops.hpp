#pragma once

#include "filter_kernel.hpp"

// The loops over states and samples, for registers of `bytes` bytes.  Each file that includes this is compiled for one
// instruction set; nothing of it is shared between them.
namespace frac::detail {

/// Present on x86-64 only, and to be called only where the processor knows the instructions.
[[nodiscard]] FilterLoop avx2_filter_loop() noexcept;
[[nodiscard]] FilterLoop avx512_filter_loop() noexcept;

namespace {

// Below this a state is worth nothing and, denormal, slow.
constexpr double nothing = 1e-280;

template <std::size_t bytes>
struct Loops {
  static constexpr std::size_t width = bytes / sizeof(double);
  // At any address.
  typedef double Vector __attribute__((vector_size(bytes), aligned(sizeof(double)), may_alias));

  static const Vector& at(const double* place) { return *reinterpret_cast<const Vector*>(place); }
  static Vector& at(double* place) { return *reinterpret_cast<Vector*>(place); }
  static Vector flushed(Vector x) { return x < nothing && x > -nothing ? Vector{} : x; }

  // From one register of a tile to the next in a matrix of so many rows, its columns in lanes.
  static constexpr std::size_t apart(std::size_t rows) { return width < filter_lane ? width : rows * filter_lane; }
  static std::size_t column(std::size_t at, std::size_t rows) {
    return at / filter_lane * rows * filter_lane + at % filter_lane;
  }

  // Sums for a few blocks at once, `registers` vectors each: they stay in registers, and a row is read once for all
  // blocks.
  template <std::size_t blocks, std::size_t registers>
  struct Tile {
    Vector sum[blocks][registers];

    void clear(double value) {
      for (std::size_t b = 0; b < blocks; ++b) {
        for (std::size_t r = 0; r < registers; ++r) sum[b][r] = Vector{} + value;
      }
    }
    // sum[b] += sum_k factor[b * stride + k] row(k), the vectors of a row `gap` doubles apart.
    __attribute__((always_inline)) void add(const double* factor, std::size_t stride, std::size_t count,
                                            const double* row, std::ptrdiff_t row_stride, std::size_t gap) {
      for (std::size_t k = 0; k < count; ++k, row += row_stride) {
        Vector part[registers];
        for (std::size_t r = 0; r < registers; ++r) part[r] = at(row + r * gap);
        for (std::size_t b = 0; b < blocks; ++b) {
          for (std::size_t r = 0; r < registers; ++r) sum[b][r] += factor[b * stride + k] * part[r];
        }
      }
    }
  };

  // What the input adds to the states from `from` on, the second register `states_apart` after the first.
  template <std::size_t blocks, std::size_t registers>
  static Tile<blocks, registers> driven(const FilterArrays& a, const FilterInput* input, std::size_t from,
                                        std::size_t states_apart) {
    Tile<blocks, registers> tile;
    tile.clear(0);
    if (input != nullptr) {
      const auto gap = [&](std::size_t rows) { return column(from + states_apart, rows) - column(from, rows); };
      tile.add(input->samples, filter_block, filter_block, a.drive + column(from, filter_block), filter_lane,
               gap(filter_block));
      tile.add(input->extra, a.extra, a.extra, a.extra_drive + column(from, a.extra), filter_lane, gap(a.extra));
    }
    return tile;
  }

  // The states before each block and after the last.
  template <std::size_t blocks>
  static void advance(const FilterArrays& a, const FilterInput* input, std::size_t size, double* before) {
    const auto real = [&]<std::size_t registers>(std::size_t from) {
      const auto tile = driven<blocks, registers>(a, input, from, width);
      for (std::size_t r = 0; r < registers; ++r) {
        const std::size_t s = from + r * width;
        const Vector change = at(a.change + s);
        Vector state = at(a.state + s);
        for (std::size_t b = 0; b < blocks; ++b) {
          at(before + b * size + s) = state;
          // Next to 1 the factor itself would round the rate away.
          state += change * state + tile.sum[b][r];
        }
        at(a.state + s) = flushed(state);
      }
    };
    std::size_t s = a.first_real;
    for (; s + 2 * width <= a.real_size; s += 2 * width) real.template operator()<2>(s);
    for (; s < a.real_size; s += width) real.template operator()<1>(s);
    for (std::size_t group = a.first_complex; group < a.complex_size; group += 2 * filter_lane) {
      for (std::size_t part = 0; part < filter_lane; part += width) {
        const std::size_t re_at = a.real_size + group + part;
        const std::size_t im_at = re_at + filter_lane;
        const auto tile = driven<blocks, 2>(a, input, re_at, filter_lane);
        const Vector change_re = at(a.change + re_at);
        const Vector change_im = at(a.change + im_at);
        Vector re = at(a.state + re_at);
        Vector im = at(a.state + im_at);
        for (std::size_t b = 0; b < blocks; ++b) {
          at(before + b * size + re_at) = re;
          at(before + b * size + im_at) = im;
          const Vector gain_re = (change_re * re - change_im * im) + tile.sum[b][0];
          const Vector gain_im = (change_im * re + change_re * im) + tile.sum[b][1];
          re += gain_re;
          im += gain_im;
        }
        at(a.state + re_at) = flushed(re);
        at(a.state + im_at) = flushed(im);
      }
    }
  }

  template <std::size_t blocks>
  static void put_out(const FilterArrays& a, const FilterInput* input, double offset, std::size_t size,
                      const double* before, double* output) {
    constexpr std::size_t wide = 2 * width;
    for (std::size_t i = 0; i < filter_block; i += wide) {
      Tile<blocks, 2> tile;
      tile.clear(offset);
      const auto add_states = [&](std::size_t from, std::size_t to) {
        tile.add(before + from, size, to - from, a.state_output + column(i, size) + from * filter_lane, filter_lane,
                 apart(size));
      };
      add_states(a.first_real, a.real_size);
      add_states(a.real_size + a.first_complex, size);
      if (input != nullptr) {
        // Row l is the response moved right by l: it does not reach the first samples after as many rows.
        tile.add(input->samples, filter_block, i + wide, a.kernel + filter_block + i, -1, width);
        tile.add(input->extra, a.extra, a.extra, a.extra_output + column(i, a.extra), filter_lane, apart(a.extra));
      }
      for (std::size_t b = 0; b < blocks; ++b) {
        for (std::size_t r = 0; r < 2; ++r) at(output + b * filter_block + i + r * width) = tile.sum[b][r];
      }
    }
  }

  template <std::size_t blocks>
  static void step(const FilterArrays& a, const FilterInput* input, double offset, double* output) {
    const std::size_t size = a.real_size + a.complex_size;
    advance<blocks>(a, input, size, a.before);
    put_out<blocks>(a, input, offset, size, a.before, output);
  }

  static void run(const FilterArrays& a, const FilterInput* input, double offset, std::size_t blocks, double* output) {
    // Two registers for each block of a tile, two for a row and one to spare.
    constexpr std::size_t tile_blocks = bytes == 64 ? 8 : 4;
    FilterInput now = input != nullptr ? *input : FilterInput{};
    const auto take = [&]<std::size_t count>() {
      step<count>(a, input != nullptr ? &now : nullptr, offset, output);
      if (input != nullptr) now = {now.samples + count * filter_block, now.extra + count * a.extra};
      output += count * filter_block;
      blocks -= count;
    };
    while (blocks >= tile_blocks) take.template operator()<tile_blocks>();
    while (blocks > 0) take.template operator()<1>();
  }
};

}  // namespace
}  // namespace frac::detail
