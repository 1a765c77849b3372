#include "local_solve.hpp"

#include <ceres/cost_function.h>
#include <ceres/loss_function.h>
#include <ceres/problem.h>
#include <ceres/solver.h>

#include <memory>

namespace frac::detail {

namespace {

/// Points [first, first + points) as one Ceres residual block over the whole theta.
class PointsCost final : public ceres::CostFunction {
 public:
  PointsCost(const Residuals& residuals, std::size_t first, std::size_t points)
      : residuals_(residuals), first_(first), points_(points) {
    set_num_residuals(static_cast<int>(points * residuals.per_point()));
    mutable_parameter_block_sizes()->push_back(static_cast<int>(residuals.map().free().size()));
  }

  bool Evaluate(const double* const* parameters, double* residual, double** jacobians) const override {
    const std::span theta(parameters[0], residuals_.map().free().size());
    return residuals_.evaluate(theta, first_, points_, residual, jacobians ? jacobians[0] : nullptr);
  }

 private:
  const Residuals& residuals_;
  std::size_t first_, points_;
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

LocalSolution local_solve(const Residuals& residuals, const std::vector<double>& start, const LocalOptions& options) {
  LocalSolution solution{start, 0, false};
  const auto& free = residuals.map().free();
  if (free.empty()) return {start, residuals.cost(start), true};

  const auto loss = make_loss(options.loss, options.loss_scale);
  ceres::Problem::Options problem_options;
  problem_options.loss_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  ceres::Problem problem(problem_options);
  double* theta = solution.theta.data();
  if (loss) {
    // A loss acts on a block, so each frequency is a block of its own.
    for (std::size_t i = 0; i < residuals.points(); ++i) {
      problem.AddResidualBlock(new PointsCost(residuals, i, 1), loss.get(), theta);
    }
  } else {
    problem.AddResidualBlock(new PointsCost(residuals, 0, residuals.points()), nullptr, theta);
  }
  for (std::size_t k = 0; k < free.size(); ++k) {
    problem.SetParameterLowerBound(theta, static_cast<int>(k), free[k].lower);
    problem.SetParameterUpperBound(theta, static_cast<int>(k), free[k].upper);
  }

  ceres::Solver::Options solver;
  solver.linear_solver_type = ceres::DENSE_QR;
  solver.max_num_iterations = options.iterations;
  solver.function_tolerance = options.cost_tolerance;
  solver.gradient_tolerance = 1e-300;  // residuals are scaled, so only relative changes say when to stop
  solver.parameter_tolerance = 1e-14;
  solver.max_num_consecutive_invalid_steps = 20;
  solver.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  ceres::Solve(solver, &problem, &summary);
  solution.cost = residuals.cost(solution.theta);
  solution.converged = summary.termination_type == ceres::CONVERGENCE;
  return solution;
}

}  // namespace frac::detail
