#include "section_kernel.hpp"

// Copies for processors with wider registers, chosen when the program is loaded.  Compiled without contraction to fused
// operations, so that all copies agree.
#if defined(__x86_64__) && defined(__GLIBC__) && !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
#define FRACFIT_WIDE_VECTORS __attribute__((target_clones("avx512f", "avx2", "default")))
#else
#define FRACFIT_WIDE_VECTORS
#endif
#define FRACFIT_INLINE __attribute__((always_inline)) inline

namespace frac::detail {
namespace {

// A group at any address.
typedef double DoubleGroup __attribute__((vector_size(8 * section_group), aligned(8), may_alias));
typedef float FloatGroup __attribute__((vector_size(4 * section_group), aligned(4), may_alias));

template <typename Real>
struct GroupOf;
template <>
struct GroupOf<double> {
  using type = DoubleGroup;
};
template <>
struct GroupOf<float> {
  using type = FloatGroup;
};

template <typename Real>
using Group = typename GroupOf<Real>::type;

template <typename Real>
FRACFIT_INLINE Group<Real>& group_at(Real* at) {
  return *reinterpret_cast<Group<Real>*>(at);
}
template <typename Real>
FRACFIT_INLINE const Group<Real>& group_at(const Real* at) {
  return *reinterpret_cast<const Group<Real>*>(at);
}

#define FRACFIT_LANE_SUM(g) ((((g)[0] + (g)[4]) + ((g)[2] + (g)[6])) + (((g)[1] + (g)[5]) + ((g)[3] + (g)[7])))

#define FRACFIT_ADVANCE(v, low, d, tiny)                   \
  do {                                                     \
    const auto increment = (d) + (low);                    \
    const auto sum = (v) + increment;                      \
    const auto remainder = increment - (sum - (v));        \
    const auto matters = (sum > (tiny)) | (sum < -(tiny)); \
    (v) = matters ? sum : decltype(sum){};                 \
    (low) = matters ? remainder : decltype(remainder){};   \
  } while (false)

template <typename Real>
FRACFIT_INLINE Real state_sum_of(const Real* weight, const Real* state, std::size_t size) {
  Group<Real> sum{};
  for (std::size_t s = 0; s < size; s += section_group) sum += group_at(weight + s) * group_at(state + s);
  return FRACFIT_LANE_SUM(sum);
}

template <typename Real>
FRACFIT_INLINE Real change_sum_of(const Real* rate, const Real* weight, const Real* state, std::size_t size, Real x) {
  Group<Real> sum{};
  for (std::size_t s = 0; s < size; s += section_group) {
    sum += group_at(weight + s) * (x - group_at(rate + s) * group_at(state + s));
  }
  return FRACFIT_LANE_SUM(sum);
}

template <typename Real>
FRACFIT_INLINE void advance_of(const Real* rate, Real* state, Real* lost, std::size_t size, Real x) {
  const Group<Real> tiny = Group<Real>{} + negligible_state<Real>;
  for (std::size_t s = 0; s < size; s += section_group) {
    Group<Real> v = group_at(state + s);
    Group<Real> low = group_at(lost + s);
    const Group<Real> d = x - group_at(rate + s) * v;
    FRACFIT_ADVANCE(v, low, d, tiny);
    group_at(state + s) = v;
    group_at(lost + s) = low;
  }
}

template <typename Real, bool of_changes>
FRACFIT_INLINE void run_of(const SectionArrays<Real>& bank, const Real* x, Real* y, std::size_t count) {
  const Group<Real> tiny = Group<Real>{} + negligible_state<Real>;
  Group<Real> sums[section_block];
  for (std::size_t n = 0; n < count; ++n) sums[n] = Group<Real>{};
  // Two groups at a time hide each other's latency.
  std::size_t s = 0;
  for (; s + 2 * section_group <= bank.size; s += 2 * section_group) {
    const Group<Real> rate_a = group_at(bank.rate + s), rate_b = group_at(bank.rate + s + section_group);
    const Group<Real> weight_a = group_at(bank.weight + s), weight_b = group_at(bank.weight + s + section_group);
    Group<Real> v_a = group_at(bank.state + s), v_b = group_at(bank.state + s + section_group);
    Group<Real> low_a = group_at(bank.lost + s), low_b = group_at(bank.lost + s + section_group);
    for (std::size_t n = 0; n < count; ++n) {
      const Group<Real> d_a = x[n] - rate_a * v_a;
      const Group<Real> d_b = x[n] - rate_b * v_b;
      sums[n] += weight_a * (of_changes ? d_a : v_a);
      sums[n] += weight_b * (of_changes ? d_b : v_b);
      FRACFIT_ADVANCE(v_a, low_a, d_a, tiny);
      FRACFIT_ADVANCE(v_b, low_b, d_b, tiny);
    }
    group_at(bank.state + s) = v_a;
    group_at(bank.state + s + section_group) = v_b;
    group_at(bank.lost + s) = low_a;
    group_at(bank.lost + s + section_group) = low_b;
  }
  for (; s < bank.size; s += section_group) {
    const Group<Real> rate = group_at(bank.rate + s);
    const Group<Real> weight = group_at(bank.weight + s);
    Group<Real> v = group_at(bank.state + s);
    Group<Real> low = group_at(bank.lost + s);
    for (std::size_t n = 0; n < count; ++n) {
      const Group<Real> d = x[n] - rate * v;
      sums[n] += weight * (of_changes ? d : v);
      FRACFIT_ADVANCE(v, low, d, tiny);
    }
    group_at(bank.state + s) = v;
    group_at(bank.lost + s) = low;
  }
  for (std::size_t n = 0; n < count; ++n) y[n] = FRACFIT_LANE_SUM(sums[n]);
}

}  // namespace

#define FRACFIT_KERNELS(Real)                                                                                     \
  FRACFIT_WIDE_VECTORS Real state_sum(const Real* weight, const Real* state, std::size_t size) noexcept {         \
    return state_sum_of<Real>(weight, state, size);                                                               \
  }                                                                                                               \
  FRACFIT_WIDE_VECTORS Real change_sum(const Real* rate, const Real* weight, const Real* state, std::size_t size, \
                                       Real x) noexcept {                                                         \
    return change_sum_of<Real>(rate, weight, state, size, x);                                                     \
  }                                                                                                               \
  FRACFIT_WIDE_VECTORS void advance_states(const Real* rate, Real* state, Real* lost, std::size_t size,           \
                                           Real x) noexcept {                                                     \
    advance_of<Real>(rate, state, lost, size, x);                                                                 \
  }                                                                                                               \
  FRACFIT_WIDE_VECTORS void run_states(const SectionArrays<Real>& bank, const Real* x, Real* y,                   \
                                       std::size_t count) noexcept {                                              \
    run_of<Real, false>(bank, x, y, count);                                                                       \
  }                                                                                                               \
  FRACFIT_WIDE_VECTORS void run_changes(const SectionArrays<Real>& bank, const Real* x, Real* y,                  \
                                        std::size_t count) noexcept {                                             \
    run_of<Real, true>(bank, x, y, count);                                                                        \
  }

FRACFIT_KERNELS(double)
FRACFIT_KERNELS(float)

}  // namespace frac::detail
