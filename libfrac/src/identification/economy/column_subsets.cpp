// SPDX-License-Identifier: BSD-3-Clause
#include "column_subsets.hpp"

#include <algorithm>

#include "base/linear_algebra.hpp"
#include "frac/cancellation.hpp"

namespace frac::detail {
namespace {

using Index = Eigen::Index;

class Search {
 public:
  Search(const Eigen::MatrixXd& columns, const Eigen::VectorXd& target, std::size_t most, std::size_t kept)
      : kept_(kept), best_(most) {
    // In the space of all columns, with the distance of the target from it in one more row: as many numbers per column
    // as columns, however many points.
    const Eigen::MatrixXd basis = PlainQr(columns).basis();
    Level first;
    first.columns.resize(basis.cols() + 1, columns.cols());
    first.columns.topRows(basis.cols()) = basis.transpose() * columns;
    first.columns.bottomRows(1).setZero();
    first.residual.resize(basis.cols() + 1);
    const Eigen::VectorXd share = basis.transpose() * target;
    first.residual << share, (target - basis * share).norm();
    levels_.assign(most + 1, first);
  }

  std::vector<std::vector<ColumnSubset>> run() {
    descend(0, 0);
    for (auto& of_size : best_) std::stable_sort(of_size.begin(), of_size.end(), cheaper);
    return std::move(best_);
  }

 private:
  struct Level {
    Eigen::MatrixXd columns;  // less the space of the chosen ones
    Eigen::VectorXd residual;
  };

  static bool cheaper(const ColumnSubset& a, const ColumnSubset& b) { return a.cost < b.cost; }

  void keep(std::size_t size, double cost) {
    auto& heap = best_[size - 1];
    if (heap.size() == kept_) {
      if (!(cost < heap.front().cost)) return;
      std::pop_heap(heap.begin(), heap.end(), cheaper);
      heap.pop_back();
    }
    heap.push_back({members_, cost});
    std::push_heap(heap.begin(), heap.end(), cheaper);
  }

  void descend(std::size_t depth, Index first) {
    throw_if_cancelled();
    const Level& here = levels_[depth];
    const double cost = here.residual.squaredNorm();
    const Index count = here.columns.cols();
    for (Index j = first; j < count; ++j) {
      constexpr double dependent = 1e-11;
      const double square = here.columns.col(j).squaredNorm();
      if (!(square > dependent * dependent)) continue;
      const double product = here.columns.col(j).dot(here.residual);
      members_.push_back(static_cast<std::size_t>(j));
      keep(depth + 1, std::max(0.0, cost - product * product / square));
      if (depth + 1 < best_.size() && j + 1 < count) {
        Level& next = levels_[depth + 1];
        const auto taken = here.columns.col(j);
        next.residual.noalias() = here.residual - taken * (product / square);
        for (Index k = j + 1; k < count; ++k) {
          const double share = taken.dot(here.columns.col(k)) / square;
          next.columns.col(k).noalias() = here.columns.col(k) - share * taken;
        }
        descend(depth + 1, j + 1);
      }
      members_.pop_back();
    }
  }

  std::size_t kept_;
  std::vector<std::vector<ColumnSubset>> best_;  // by size, heaps with the worst in front
  std::vector<Level> levels_;
  std::vector<std::size_t> members_;
};

}  // namespace

std::vector<std::vector<ColumnSubset>> best_subsets(const Eigen::MatrixXd& columns, const Eigen::VectorXd& target,
                                                    std::size_t most, std::size_t kept) {
  if (most == 0) return {};
  return Search(columns, target, most, kept).run();
}

}  // namespace frac::detail
