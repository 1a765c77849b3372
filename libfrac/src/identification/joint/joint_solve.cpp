// SPDX-License-Identifier: BSD-3-Clause
#include "joint_solve.hpp"

#include <ceres/cost_function.h>
#include <ceres/ordered_groups.h>
#include <ceres/problem.h>
#include <ceres/solver.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>

#include "frac/cancellation.hpp"
#include "identification/residuals/loss.hpp"
#include "identification/search/bounded_solve.hpp"
#include "identification/search/triangular_form.hpp"

namespace frac::detail {
namespace {

/// One curve as a Ceres residual block over its own variables, where there are any, and the shared ones: reduced to as
/// many rows as there are columns, with the same cost, gradient and steps.  Under a loss each point counts with the
/// weight that gives its gradient, and the last row, on which no variable acts, makes up the cost.
class CurveCost final : public ceres::CostFunction {
 public:
  CurveCost(CurveResiduals& curve, std::size_t own, std::size_t shared)
      : curve_(curve),
        own_(own),
        shared_(shared),
        at_(own + shared, std::numeric_limits<double>::quiet_NaN()),
        residual_(curve.rows()),
        jacobian_(curve.rows() * width()),
        triangle_((width() + 1) * (width() + 1)) {
    set_num_residuals(static_cast<int>(width() + 1));
    if (own > 0) mutable_parameter_block_sizes()->push_back(static_cast<int>(own));
    mutable_parameter_block_sizes()->push_back(static_cast<int>(shared));
  }

  bool Evaluate(const double* const* parameters, double* residual, double** jacobians) const override {
    if (!evaluate_at(parameters)) return false;
    for (std::size_t row = 0; row <= width(); ++row) residual[row] = triangle_[row * (width() + 1) + width()];
    if (!jacobians) return true;
    std::size_t block = 0, first = 0;
    for (const std::size_t size : {own_, shared_}) {
      if (size == 0) continue;
      if (jacobians[block]) {
        for (std::size_t row = 0; row <= width(); ++row)
          std::copy_n(triangle_.data() + row * (width() + 1) + first, size, jacobians[block] + row * size);
      }
      ++block;
      first += size;
    }
    return true;
  }

 private:
  [[nodiscard]] std::size_t width() const { return own_ + shared_; }

  // Ceres asks for the cost of a step first and for its Jacobian when it is taken, which most are: both at once.
  bool evaluate_at(const double* const* parameters) const {
    std::vector<double> now(parameters[0], parameters[0] + (own_ > 0 ? own_ : shared_));
    if (own_ > 0) now.insert(now.end(), parameters[1], parameters[1] + shared_);
    if (now == at_) return finite_;
    at_ = std::move(now);
    const std::span<const double> all(at_);
    finite_ =
        !is_cancelled() && curve_.evaluate(all.subspan(own_), all.first(own_), residual_.data(), jacobian_.data());
    if (!finite_) return false;
    const double added = weighed_by_loss();
    triangular_form(jacobian_, residual_, triangle_);
    // A loss grows slower than the square, so that what it adds is not negative but by rounding.
    double& last = triangle_.back();
    if (added != 0) last = std::sqrt(std::max(0.0, last * last + added));
    finite_ = std::all_of(triangle_.begin(), triangle_.end(), [](double each) { return std::isfinite(each); });
    return finite_;
  }

  /// Multiplies each point by the root of what the loss takes of its square; the cost of the loss less that of the
  /// weighed squares.
  double weighed_by_loss() const {
    if (curve_.loss() == Loss::none) return 0;
    const double scale = curve_.loss_scale();
    double added = 0;
    for (std::size_t first = 0; first < curve_.count(); first += curve_.per_point()) {
      double square = 0;
      for (std::size_t row = first; row < first + curve_.per_point(); ++row) square += residual_[row] * residual_[row];
      const double x = std::sqrt(square) / scale;
      const LossAt loss = loss_at(curve_.loss(), x);
      const double share = x > 0 ? loss.psi / x : 1, weight = std::sqrt(share);
      added += loss.cost * scale * scale - share * square;
      for (std::size_t row = first; row < first + curve_.per_point(); ++row) {
        residual_[row] *= weight;
        for (std::size_t k = 0; k < width(); ++k) jacobian_[k * curve_.rows() + row] *= weight;
      }
    }
    return added;
  }

  CurveResiduals& curve_;
  std::size_t own_, shared_;
  mutable std::vector<double> at_, residual_, jacobian_, triangle_;
  mutable bool finite_ = false;
};

/// Priors of shared parameters over the shared variables.
class SharedPriorCost final : public ceres::CostFunction {
 public:
  SharedPriorCost(const JointLayout& layout, double weight)
      : layout_(layout), weight_(weight), own_(layout.own.size(), 0.0) {
    set_num_residuals(static_cast<int>(layout.shared_priors.size()));
    mutable_parameter_block_sizes()->push_back(static_cast<int>(layout.shared.size()));
  }

  bool Evaluate(const double* const* parameters, double* residual, double** jacobians) const override {
    const std::span<const double> shared(parameters[0], layout_.shared.size());
    for (std::size_t row = 0; row < layout_.shared_priors.size(); ++row) {
      // Shared parameters depend on no variable of a curve, so any curve and any values will do.
      const JointLayout::Pull pull = layout_.pull(layout_.shared_priors[row], shared, own_, 0);
      residual[row] = weight_ * pull.distance;
      if (!std::isfinite(residual[row])) return false;
      if (!jacobians || !jacobians[0]) continue;
      for (std::size_t k = 0; k < shared.size(); ++k)
        jacobians[0][row * shared.size() + k] = weight_ * pull.by_variable[own_.size() + k];
    }
    return true;
  }

 private:
  const JointLayout& layout_;
  double weight_;
  std::vector<double> own_;
};

void add_block(ceres::Problem& problem, double* values, const std::vector<JointVariable>& variables) {
  problem.AddParameterBlock(values, static_cast<int>(variables.size()));
  for (std::size_t k = 0; k < variables.size(); ++k) {
    problem.SetParameterLowerBound(values, static_cast<int>(k), variables[k].lower);
    problem.SetParameterUpperBound(values, static_cast<int>(k), variables[k].upper);
  }
}

}  // namespace

JointCost cost_of_data(std::vector<CurveResiduals>& curves, const JointPoint& point) {
  JointCost sum{0, 0};
  for (std::size_t c = 0; c < curves.size(); ++c) {
    const std::vector<double> residual = curves[c].of_data(point.shared, point.own[c]);
    const double scale = curves[c].loss_scale();
    for (std::size_t first = 0; first < curves[c].count(); first += curves[c].per_point()) {
      double square = 0;
      for (std::size_t row = first; row < first + curves[c].per_point(); ++row) square += residual[row] * residual[row];
      sum.squares += square;
      sum.loss += loss_at(curves[c].loss(), std::sqrt(square) / scale).cost * scale * scale;
    }
  }
  return sum;
}

JointPoint joint_solve(std::vector<CurveResiduals>& curves, const JointLayout& layout, JointPoint start,
                       double cost_tolerance) {
  throw_if_cancelled();
  // Ceres orders blocks by their addresses: in one array they stay in the order of the curves.
  std::vector<double> own;
  for (const std::vector<double>& each : start.own) own.insert(own.end(), each.begin(), each.end());
  ceres::Problem problem;
  constexpr int most_iterations = 200;
  ceres::Solver::Options solver = solver_options(most_iterations, cost_tolerance);
  solver.linear_solver_ordering = std::make_shared<ceres::ParameterBlockOrdering>();
  add_block(problem, start.shared.data(), layout.shared);
  solver.linear_solver_ordering->AddElementToGroup(start.shared.data(), 1);
  for (std::size_t c = 0; c < curves.size(); ++c) {
    std::vector<double*> blocks;
    if (!layout.own.empty()) {
      add_block(problem, own.data() + c * layout.own.size(), layout.own);
      solver.linear_solver_ordering->AddElementToGroup(own.data() + c * layout.own.size(), 0);
      blocks.push_back(own.data() + c * layout.own.size());
    }
    blocks.push_back(start.shared.data());
    problem.AddResidualBlock(new CurveCost(curves[c], layout.own.size(), layout.shared.size()), nullptr, blocks);
  }
  if (!layout.shared_priors.empty()) {
    problem.AddResidualBlock(new SharedPriorCost(layout, curves.front().prior_weight()), nullptr,
                             std::vector<double*>{start.shared.data()});
  }
  if (!layout.own.empty()) solver.linear_solver_type = ceres::DENSE_SCHUR;
  ceres::Solver::Summary summary;
  solve_within_bounds(solver, problem, summary);
  throw_if_cancelled();
  for (std::size_t c = 0; c < curves.size(); ++c)
    std::copy_n(own.data() + c * layout.own.size(), layout.own.size(), start.own[c].data());
  start.cost = 2 * summary.final_cost;
  start.converged = summary.termination_type == ceres::CONVERGENCE;
  if (summary.termination_type == ceres::FAILURE) start.cost = std::numeric_limits<double>::infinity();
  return start;
}

}  // namespace frac::detail
