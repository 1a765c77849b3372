// Replaces the global operator new by one that counts.
#include <gtest/gtest.h>

#include <atomic>
#include <complex>
#include <cstdlib>
#include <new>
#include <vector>

#include "frac/structure.hpp"

namespace {
std::atomic<long> allocations = 0;
}

// Not inlined, or the compiler takes malloc and delete for a mismatched pair.
[[gnu::noinline]] void* operator new(std::size_t size) {
  ++allocations;
  if (void* const memory = std::malloc(size > 0 ? size : 1)) return memory;
  throw std::bad_alloc();
}
[[gnu::noinline]] void operator delete(void* memory) noexcept {
  std::free(memory);
}
[[gnu::noinline]] void operator delete(void* memory, std::size_t) noexcept {
  std::free(memory);
}

namespace {

// A solver evaluates a structure some 10^5 times a second; the second call of a kind finds its working memory in place.
TEST(Structure, AllocatesNothingOnRepeatedEvaluation) {
  const frac::Structure structure("K exp(-L s)/(T s^a + 1) + R tanh((tau s)^0.5) + (1 + s^a)^b");
  std::vector<double> parameters{1, 0.2, 0.3, 0.8, 2, 0.5, 0.7};
  std::vector<double> omega(100, 1.5);
  std::vector<std::complex<double>> value(omega.size());
  std::vector<std::complex<double>> gradient(omega.size() * parameters.size());
  structure.response_and_gradient(parameters, omega, frac::ExactRealisation{}, value, gradient);
  const long before = allocations;
  for (int i = 0; i < 10; ++i) {
    parameters[3] += 0.01;
    structure.response_and_gradient(parameters, omega, frac::ExactRealisation{}, value, gradient);
    (void)structure.response(parameters, 2.5);
  }
  EXPECT_EQ(allocations - before, 0);
}

}  // namespace
