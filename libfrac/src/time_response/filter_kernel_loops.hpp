// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "filter_kernel.hpp"

// The loops over states and samples, for registers of `bytes` bytes.  Each file that includes this is compiled for one
// instruction set; nothing of it is shared between them.
namespace frac::detail {

/// Present on x86-64 only, and to be called only where the processor knows the instructions.
[[nodiscard]] FilterLoop avx2_filter_loop() noexcept;
[[nodiscard]] FilterLoop avx512_filter_loop() noexcept;

namespace {

// Smaller states do not matter, and as denormal numbers they are slow.
constexpr double nothing = 1e-280;

template <std::size_t bytes>
struct Register {
  // At any address.
  typedef double Numbers __attribute__((vector_size(bytes), aligned(sizeof(double)), may_alias));
};

template <std::size_t bytes>
struct Loops {
  static constexpr std::size_t width = bytes / sizeof(double);
  using Vector = typename Register<bytes>::Numbers;

  static const Vector& at(const double* place) { return *reinterpret_cast<const Vector*>(place); }
  static Vector& at(double* place) { return *reinterpret_cast<Vector*>(place); }
  static Vector flushed(Vector x) { return x < nothing && x > -nothing ? Vector{} : x; }

  static std::size_t column(std::size_t at, std::size_t rows) {
    return at / filter_lane * rows * filter_lane + at % filter_lane;
  }
  // A tile holds two registers: two lanes, or the same place in both halves of one.
  static constexpr std::size_t half = filter_lane / 2;
  static constexpr std::size_t tile_columns = 2 * width;
  static constexpr std::size_t gap(std::size_t rows) { return width < filter_lane ? half : rows * filter_lane; }
  // Calls with the first column of each tile, and with those of a last half tile.
  template <typename Whole, typename Rest>
  static void for_tiles(std::size_t from, std::size_t to, const Whole& whole, const Rest& rest) {
    if constexpr (width < filter_lane) {
      for (std::size_t lane = from; lane < to; lane += filter_lane) {
        for (std::size_t part = 0; part < half; part += width) whole(lane + part);
      }
    } else {
      for (; from + tile_columns <= to; from += tile_columns) whole(from);
      if (from < to) rest(from);
    }
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
    // sum[b] += sum_k factor[b * stride + k] row(k), the vectors of a row `apart` doubles apart.
    __attribute__((always_inline)) void add(const double* factor, std::size_t stride, std::size_t count,
                                            const double* row, std::ptrdiff_t row_stride, std::size_t apart) {
      for (std::size_t k = 0; k < count; ++k, row += row_stride) {
        Vector part[registers];
        for (std::size_t r = 0; r < registers; ++r) part[r] = at(row + r * apart);
        for (std::size_t b = 0; b < blocks; ++b) {
          for (std::size_t r = 0; r < registers; ++r) sum[b][r] += factor[b * stride + k] * part[r];
        }
      }
    }
  };

  // Next to 1 the factor itself would round the rate away.
  static Vector moved(Vector state, Vector change, Vector partner, Vector cross, Vector driven) {
    return (state + driven) + change * state + cross * partner;
  }
  static Vector swapped(Vector state) {
    if constexpr (width == filter_lane) {
      return __builtin_shufflevector(state, state, 4, 5, 6, 7, 0, 1, 2, 3);
    } else {
      return state;
    }
  }

  // The states before each block and after the last.
  template <std::size_t blocks>
  static void advance(const FilterArrays& a, const FilterInput* input, double* before) {
    const auto tile_at = [&]<std::size_t registers>(std::size_t s) {
      Tile<blocks, registers> tile;
      tile.clear(0);
      if (input != nullptr) {
        tile.add(input->samples, filter_block, filter_block, a.drive + column(s, filter_block), filter_lane,
                 gap(filter_block));
        tile.add(input->extra, a.extra, a.extra, a.extra_drive + column(s, a.extra), filter_lane, gap(a.extra));
      }
      constexpr std::size_t apart = width < filter_lane ? half : filter_lane;
      Vector state[registers];
      for (std::size_t r = 0; r < registers; ++r) state[r] = at(a.state + s + r * apart);
      for (std::size_t b = 0; b < blocks; ++b) {
        Vector partner[registers];
        for (std::size_t r = 0; r < registers; ++r) {
          at(before + b * a.size + s + r * apart) = state[r];
          partner[r] = width < filter_lane ? state[registers - 1 - r] : swapped(state[r]);
        }
        for (std::size_t r = 0; r < registers; ++r) {
          state[r] =
              moved(state[r], at(a.change + s + r * apart), partner[r], at(a.cross + s + r * apart), tile.sum[b][r]);
        }
      }
      for (std::size_t r = 0; r < registers; ++r) at(a.state + s + r * apart) = flushed(state[r]);
    };
    for_tiles(
        a.first, a.size, [&](std::size_t s) { tile_at.template operator()<2>(s); },
        [&](std::size_t s) { tile_at.template operator()<1>(s); });
  }

  template <std::size_t blocks>
  static void put_out(const FilterArrays& a, const FilterInput* input, double offset, const double* before,
                      double* output) {
    const auto tile_at = [&](std::size_t i) {
      Tile<blocks, 2> tile;
      tile.clear(offset);
      tile.add(before + a.first, a.size, a.size - a.first, a.state_output + column(i, a.size) + a.first * filter_lane,
               filter_lane, gap(a.size));
      constexpr std::size_t apart = width < filter_lane ? half : filter_lane;
      if (input != nullptr) {
        // Row l is the response moved right by l: it does not reach the first samples after as many rows.
        tile.add(input->samples, filter_block, i + apart + width, a.kernel + filter_block + i, -1, apart);
        tile.add(input->extra, a.extra, a.extra, a.extra_output + column(i, a.extra), filter_lane, gap(a.extra));
      }
      for (std::size_t b = 0; b < blocks; ++b) {
        for (std::size_t r = 0; r < 2; ++r) at(output + b * filter_block + i + r * apart) = tile.sum[b][r];
      }
    };
    for_tiles(0, filter_block, tile_at, tile_at);
  }

  template <std::size_t blocks>
  static void step(const FilterArrays& a, const FilterInput* input, double offset, double* output) {
    advance<blocks>(a, input, a.before);
    put_out<blocks>(a, input, offset, a.before, output);
  }

  static void run(const FilterArrays& a, const FilterInput* input, double offset, std::size_t blocks, double* output) {
    // A tile takes two registers for each of its blocks and two for a row; one more is spare.
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
