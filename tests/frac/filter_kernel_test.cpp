// SPDX-License-Identifier: BSD-3-Clause
// The loops as compiled here, for any processor.
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "base/instruction_set.hpp"
#include "support/random.hpp"
#include "time_response/filter_kernel_loops.hpp"

namespace {

using frac::detail::filter_block;
using frac::detail::filter_lane;
using frac::detail::FilterArrays;
using frac::detail::FilterInput;
using frac::detail::FilterLoop;
using frac::detail::InstructionSet;

// Columns in lanes of eight.
struct Matrix {
  Matrix(std::size_t rows_, std::size_t columns) : rows(rows_), value(rows_ * columns) {}
  double& at(std::size_t row, std::size_t column) {
    return value[(column / filter_lane * rows + row) * filter_lane + column % filter_lane];
  }
  std::size_t rows;
  std::vector<double> value;
};

struct Bank {
  std::size_t real_size, size, extra;
  std::vector<double> change = std::vector<double>(size), cross = change,
                      kernel = std::vector<double>(2 * filter_block), state = std::vector<double>(size),
                      before = std::vector<double>(8 * size);
  Matrix output{size, filter_block}, drive{filter_block, size}, extra_output{extra, filter_block},
      extra_drive{extra, size};

  Bank(std::size_t real, std::size_t complex, std::size_t further)
      : real_size(real), size(real + complex), extra(further) {
    support::Random random(real + 100 * complex);
    const auto fill = [&](std::vector<double>& list) {
      for (double& each : list) each = random.normal();
    };
    for (std::vector<double>* list : {&output.value, &drive.value, &extra_output.value, &extra_drive.value, &state}) {
      fill(*list);
    }
    for (std::size_t s = 0; s < size; ++s) {
      change[s] = 0.3 * random.normal();
      if (s >= real_size) cross[s] = 0.3 * random.normal();
    }
    for (std::size_t i = 0; i < filter_block; ++i) kernel[filter_block + i] = random.normal();
  }
  FilterArrays arrays(std::size_t first) {
    return {.first = first,
            .size = size,
            .extra = extra,
            .change = change.data(),
            .cross = cross.data(),
            .state_output = output.value.data(),
            .drive = drive.value.data(),
            .kernel = kernel.data(),
            .extra_output = extra_output.value.data(),
            .extra_drive = extra_drive.value.data(),
            .state = state.data(),
            .before = before.data()};
  }
};

// Straight from the meaning of the arrays.
std::vector<double> expected(Bank& bank, std::size_t first, const FilterInput* input, double offset,
                             std::size_t blocks) {
  std::vector<double> result;
  for (std::size_t b = 0; b < blocks; ++b) {
    for (std::size_t i = 0; i < filter_block; ++i) {
      double y = offset;
      for (std::size_t s = first; s < bank.size; ++s) y += bank.state[s] * bank.output.at(s, i);
      if (input != nullptr) {
        for (std::size_t l = 0; l <= i; ++l) {
          y += input->samples[b * filter_block + l] * bank.kernel[filter_block + i - l];
        }
        for (std::size_t e = 0; e < bank.extra; ++e) y += input->extra[b * bank.extra + e] * bank.extra_output.at(e, i);
      }
      result.push_back(y);
    }
    std::vector<double> next = bank.state;
    for (std::size_t s = first; s < bank.size; ++s) {
      next[s] += bank.change[s] * bank.state[s] + bank.cross[s] * bank.state[s ^ 4];
      if (input == nullptr) continue;
      for (std::size_t l = 0; l < filter_block; ++l) {
        next[s] += input->samples[b * filter_block + l] * bank.drive.at(l, s);
      }
      for (std::size_t e = 0; e < bank.extra; ++e) {
        next[s] += input->extra[b * bank.extra + e] * bank.extra_drive.at(e, s);
      }
    }
    bank.state = next;
  }
  result.insert(result.end(), bank.state.begin(), bank.state.end());
  return result;
}

void expect_as_meant(FilterLoop loop, const char* name) {
  support::Random random(7);
  std::vector<double> samples(8 * filter_block), extra(8 * 3);
  for (double& each : samples) each = random.normal();
  for (double& each : extra) each = random.normal();
  const FilterInput input{samples.data(), extra.data()};
  for (const auto& [real, complex] :
       {std::pair<std::size_t, std::size_t>{8, 0}, {24, 16}, {0, 32}, {32, 48}, {16, 8}}) {
    for (const std::size_t first : {std::size_t{0}, filter_lane}) {
      for (const FilterInput* driven : {&input, static_cast<const FilterInput*>(nullptr)}) {
        // Only states that decay are left out.
        if ((driven != nullptr || real == 0) && first > 0) continue;
        for (const std::size_t blocks : {1, 3, 4, 7, 8}) {
          Bank bank(real, complex, 3);
          Bank other = bank;
          std::vector<double> result(blocks * filter_block);
          loop(bank.arrays(first), driven, 0.25, blocks, result.data());
          result.insert(result.end(), bank.state.begin(), bank.state.end());
          const std::vector<double> exact = expected(other, first, driven, 0.25, blocks);
          double largest = 0;
          for (const double each : exact) largest = std::max(largest, std::abs(each));
          ASSERT_EQ(result.size(), exact.size());
          // Sums of some hundred products in another order, over up to eight blocks.
          for (std::size_t i = 0; i < exact.size(); ++i) {
            EXPECT_NEAR(result[i], exact[i], 1e-13 * largest) << name << " " << real << " " << complex << " " << i;
          }
        }
      }
    }
  }
}

}  // namespace

TEST(FilterKernel, EveryInstructionSetComputesWhatTheArraysMean) {
  expect_as_meant(frac::detail::Loops<16>::run, "plain");
#if defined(__x86_64__)
  const InstructionSet known = frac::detail::processor_instruction_set();
  if (known >= InstructionSet::avx2) expect_as_meant(frac::detail::avx2_filter_loop(), "avx2");
  if (known >= InstructionSet::avx512) expect_as_meant(frac::detail::avx512_filter_loop(), "avx512");
#endif
}

TEST(FilterKernel, TinyStatesFallSilent) {
  Bank bank(8, 16, 1);
  for (double& each : bank.state) each = 1e-285;
  std::vector<double> output(filter_block);
  frac::detail::run_filter(bank.arrays(0), nullptr, 0, 1, output.data());
  for (const double each : bank.state) EXPECT_EQ(each, 0);
}
