// SPDX-License-Identifier: BSD-3-Clause
#include "local_solve.hpp"

#include <ceres/cost_function.h>
#include <ceres/loss_function.h>
#include <ceres/problem.h>
#include <ceres/solver.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>

#include "bounded_solve.hpp"
#include "frac/cancellation.hpp"
#include "normal_solve.hpp"
#include "triangular_form.hpp"

namespace frac::detail {

namespace {

/// The residuals at the theta asked for last and their Jacobian: within one step Ceres asks up to three times for the
/// same, and block by block.  The Jacobian comes at once, since most steps are taken.
class LastEvaluation {
 public:
  /// @param reduces  whether the triangular form is wanted
  LastEvaluation(const Residuals& residuals, bool reduces)
      : residuals_(residuals),
        theta_(residuals.map().free().size(), std::numeric_limits<double>::quiet_NaN()),
        residual_(residuals.count()),
        jacobian_(residuals.count() * theta_.size()),
        triangle_(reduces ? (theta_.size() + 1) * (theta_.size() + 1) : 0) {}

  [[nodiscard]] std::size_t width() const { return theta_.size(); }
  [[nodiscard]] std::size_t per_point() const { return residuals_.per_point(); }
  [[nodiscard]] const std::vector<double>& residual() const { return residual_; }
  [[nodiscard]] const std::vector<double>& jacobian() const { return jacobian_; }
  [[nodiscard]] const std::vector<double>& triangle() const { return triangle_; }

  /// False where the model is not finite.
  bool at(const double* theta) {
    if (std::equal(theta_.begin(), theta_.end(), theta)) return finite_;
    std::copy_n(theta, theta_.size(), theta_.begin());
    finite_ = !is_cancelled() && residuals_.evaluate(theta_, residual_.data(), jacobian_.data());
    if (!finite_ || triangle_.empty()) return finite_;
    triangular_form(jacobian_, residual_, triangle_);
    // Squares of finite entries may overflow.
    finite_ = std::all_of(triangle_.begin(), triangle_.end(), [](double each) { return std::isfinite(each); });
    return finite_;
  }

 private:
  const Residuals& residuals_;
  std::vector<double> theta_, residual_, jacobian_, triangle_;
  bool finite_ = false;
};

/// All points as one Ceres residual block, reduced to as many rows as there are columns: the same cost, the same
/// gradient and the same steps, and what Ceres does with them takes a time that does not grow with the points.
class ReducedCost final : public ceres::CostFunction {
 public:
  explicit ReducedCost(LastEvaluation& evaluation) : evaluation_(evaluation) {
    set_num_residuals(static_cast<int>(evaluation.width() + 1));
    mutable_parameter_block_sizes()->push_back(static_cast<int>(evaluation.width()));
  }

  bool Evaluate(const double* const* parameters, double* residual, double** jacobians) const override {
    if (!evaluation_.at(parameters[0])) return false;
    const std::size_t width = evaluation_.width();
    const double* from = evaluation_.triangle().data();
    for (std::size_t row = 0; row <= width; ++row, from += width + 1) {
      residual[row] = from[width];
      if (jacobians && jacobians[0]) std::copy_n(from, width, jacobians[0] + row * width);
    }
    return true;
  }

 private:
  LastEvaluation& evaluation_;
};

/// One point as a Ceres residual block over the whole theta.
class PointCost final : public ceres::CostFunction {
 public:
  PointCost(LastEvaluation& evaluation, std::size_t point)
      : evaluation_(evaluation), first_(point * evaluation.per_point()) {
    set_num_residuals(static_cast<int>(evaluation.per_point()));
    mutable_parameter_block_sizes()->push_back(static_cast<int>(evaluation.width()));
  }

  bool Evaluate(const double* const* parameters, double* residual, double** jacobians) const override {
    if (!evaluation_.at(parameters[0])) return false;
    const std::size_t count = evaluation_.per_point(), width = evaluation_.width();
    std::copy_n(evaluation_.residual().data() + first_, count, residual);
    if (jacobians && jacobians[0]) {
      const double* from = evaluation_.jacobian().data() + first_;
      for (std::size_t k = 0; k < width; ++k, from += evaluation_.residual().size()) {
        for (std::size_t row = 0; row < count; ++row) jacobians[0][row * width + k] = from[row];
      }
    }
    return true;
  }

 private:
  LastEvaluation& evaluation_;
  std::size_t first_;
};

/// The priors as a Ceres residual block, on which no loss acts.
class PriorCost final : public ceres::CostFunction {
 public:
  explicit PriorCost(const Residuals& residuals) : residuals_(residuals) {
    set_num_residuals(static_cast<int>(residuals.priors()->entries().size()));
    mutable_parameter_block_sizes()->push_back(static_cast<int>(residuals.map().free().size()));
  }

  bool Evaluate(const double* const* parameters, double* residual, double** jacobians) const override {
    const Priors& priors = *residuals_.priors();
    const std::size_t count = priors.entries().size(), width = residuals_.map().free().size();
    double* const jacobian = jacobians ? jacobians[0] : nullptr;
    if (!priors.evaluate(residuals_.map(), {parameters[0], width}, residual, jacobian)) return false;
    for (std::size_t row = 0; row < count; ++row) residual[row] *= residuals_.prior_weight();
    for (std::size_t i = 0; jacobian && i < count * width; ++i) jacobian[i] *= residuals_.prior_weight();
    return true;
  }

 private:
  const Residuals& residuals_;
};

std::unique_ptr<ceres::LossFunction> make_loss(Loss loss, double scale) {
  switch (loss) {
    case Loss::none:
      return nullptr;
    case Loss::huber:
      return std::make_unique<ceres::HuberLoss>(scale);
    case Loss::cauchy:
      return std::make_unique<ceres::CauchyLoss>(scale);
  }
  return nullptr;
}

}  // namespace

LocalSolution solution_at(const Residuals& residuals, const std::vector<double>& theta, const LocalOptions& options) {
  LocalSolution solution{theta, 0, 0, true};
  solution.cost = solution.objective = residuals.cost(solution.theta);
  const auto loss = make_loss(options.loss, options.loss_scale);
  if (!loss || !std::isfinite(solution.cost)) return solution;
  std::vector<double> residual(residuals.count());
  residuals.evaluate(solution.theta, residual.data(), nullptr);
  solution.objective = residuals.prior_cost(solution.theta);
  for (std::size_t i = 0; i < residual.size(); i += residuals.per_point()) {
    double square = 0, rho[3];
    for (std::size_t row = i; row < i + residuals.per_point(); ++row) square += residual[row] * residual[row];
    loss->Evaluate(square, rho);
    solution.objective += rho[0];
  }
  return solution;
}

LocalSolution local_solve(const Residuals& residuals, const std::vector<double>& start, const LocalOptions& options) {
  const auto& free = residuals.map().free();
  throw_if_cancelled();
  if (free.empty()) return solution_at(residuals, start, options);

  const auto loss = make_loss(options.loss, options.loss_scale);
  constexpr double by_normal_equations = 1e-9, scouting = 1e-7;
  std::vector<double> end = start;
  if (!loss && options.cost_tolerance >= by_normal_equations) {
    LocalSolution found = normal_solve(residuals, start, options);
    // What ends closer than scouts is an answer, as refits are: there the others have to come to rest beside one that
    // presses against its bound.
    bool presses = false;
    for (std::size_t k = 0; k < free.size(); ++k)
      presses = presses || found.theta[k] <= free[k].lower || found.theta[k] >= free[k].upper;
    if (options.cost_tolerance >= scouting || !presses) return found;
    end = std::move(found.theta);
  }
  ceres::Problem::Options problem_options;
  problem_options.loss_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  ceres::Problem problem(problem_options);
  double* theta = end.data();
  LastEvaluation evaluation(residuals, !loss);
  if (!evaluation.at(theta)) {
    LocalSolution solution = solution_at(residuals, start, options);
    solution.converged = false;
    return solution;
  }
  if (loss) {
    // A loss acts on a block, so each frequency is a block of its own.
    for (std::size_t i = 0; i < residuals.points(); ++i) {
      problem.AddResidualBlock(new PointCost(evaluation, i), loss.get(), theta);
    }
  } else {
    problem.AddResidualBlock(new ReducedCost(evaluation), nullptr, theta);
  }
  if (residuals.priors()) problem.AddResidualBlock(new PriorCost(residuals), nullptr, theta);
  for (std::size_t k = 0; k < free.size(); ++k) {
    problem.SetParameterLowerBound(theta, static_cast<int>(k), free[k].lower);
    problem.SetParameterUpperBound(theta, static_cast<int>(k), free[k].upper);
  }

  ceres::Solver::Options solver = solver_options(options.iterations, options.cost_tolerance);
  solver.initial_trust_region_radius = options.radius;
  ceres::Solver::Summary summary;
  solve_within_bounds(solver, problem, summary);
  throw_if_cancelled();
  LocalSolution solution = solution_at(residuals, end, options);
  solution.converged = summary.termination_type == ceres::CONVERGENCE;
  return solution;
}

}  // namespace frac::detail
