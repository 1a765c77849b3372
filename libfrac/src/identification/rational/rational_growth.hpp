// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <limits>
#include <memory>
#include <mutex>
#include <optional>
#include <vector>

#include "growth.hpp"
#include "rational_problem.hpp"

namespace frac::detail {

[[nodiscard]] double schwarz(const RationalProblem& problem, const RationalFit& fit);

/// price_of_place() for each real pole, price_of_point() for each pair.
[[nodiscard]] double price_of_search(const RationalProblem& problem, const RationalShape& shape);

/// Properties that the members of a growth have in common.
struct RationalKind {
  bool delayed = false;
  bool free_order = false;  // rational in s^order instead of s
};

inline constexpr std::size_t any_zeros = std::numeric_limits<std::size_t>::max();

/// Rational fits of rising order, each started from the ones before with one or two poles more.
class RationalGrowth {
 public:
  /// @param excess  zeros that each member has more than poles
  /// @param most_zeros  of a member
  RationalGrowth(const RationalProblem& problem, const RationalKind& kind, std::size_t excess = 0,
                 std::size_t most_zeros = any_zeros);

  /// Grows by one pole.
  /// @param contained  a member of a narrower kind with as many poles, from which a search starts, too
  void extend(const RationalShape* contained = nullptr);
  [[nodiscard]] const std::vector<RationalFit>& members() const { return members_; }  // by poles, from 0

 private:
  void add_real_poles(double order, std::vector<RationalFit>& starts) const;
  void add_pairs(double order, std::vector<RationalFit>& starts) const;
  void add_steep_ends(double order, std::vector<RationalFit>& starts) const;
  [[nodiscard]] RationalShape with(const RationalShape& from, const PoleFactor& factor, double order) const;
  /// with() each of the factors, at its cost at few points; parameters are not counted.
  [[nodiscard]] std::vector<RationalFit> along(RationalShape from, const std::vector<PoleFactor>& factors,
                                               double order) const;
  [[nodiscard]] std::vector<double> orders() const;  // of s, at which poles are added

  const RationalProblem& problem_;
  RationalKind kind_;
  std::size_t excess_, most_zeros_;
  std::vector<RationalFit> members_;
};

/// The best of each order that was tried, simplest first, grown until neither of the last two orders paid by schwarz()
/// plus price_of_search(), which is a member's value.  Grown anew with one zero more than poles where it ends so.
using RationalLadder = GrowthLadder<RationalFit>;

/// Ratios in s of one problem, without and with a dead time, grown once for all families that start from them.  Several
/// threads may ask.
class RatioGrowths {
 public:
  /// @param problem  the same in each call, or an equal one
  [[nodiscard]] RationalFit member(const RationalProblem& problem, bool delayed, std::size_t poles);
  /// The member without zeros.
  [[nodiscard]] RationalFit without_zeros(const RationalProblem& problem, bool delayed, std::size_t poles);
  /// The ladder of the default family.
  [[nodiscard]] const RationalLadder& ladder(const RationalProblem& problem);
  /// Those of stable poles, of the same data.
  [[nodiscard]] RatioGrowths& stable();

 private:
  struct Growing {
    Growing(const RationalProblem& of, bool delayed, std::size_t most_zeros)
        : problem(of), growth(problem, {delayed, false}, 0, most_zeros) {}
    RationalProblem problem;
    RationalGrowth growth;
  };
  struct Slot {
    std::mutex mutex;
    std::unique_ptr<Growing> growing;
  };
  RationalFit member_of(Slot& slot, const RationalProblem& problem, bool delayed, std::size_t most_zeros,
                        std::size_t poles);

  std::array<Slot, 2> with_zeros_, without_zeros_;  // first without a dead time
  std::mutex ladder_mutex_;
  std::optional<RationalLadder> ladder_;
  std::mutex stable_mutex_;
  std::unique_ptr<RatioGrowths> stable_;
};

/// The fit without what does not pay for itself by schwarz(): zeros beyond the band or far below it, one zero more than
/// poles, poles that are integrators.
[[nodiscard]] RationalFit without_idle_parts(const RationalProblem& problem, const RationalFit& fit);

[[nodiscard]] RationalLadder grow_rational(const RationalProblem& problem, std::size_t fewest_poles,
                                           std::size_t most_poles, const RationalKind& kind, RatioGrowths& ratios);

/// The best fit of that many zeros and poles.
[[nodiscard]] RationalFit fit_rational(const RationalProblem& problem, std::size_t zeros, std::size_t poles,
                                       const RationalKind& kind);

}  // namespace frac::detail
