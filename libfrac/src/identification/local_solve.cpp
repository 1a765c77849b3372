#include "local_solve.hpp"

#include <ceres/cost_function.h>
#include <ceres/loss_function.h>
#include <ceres/problem.h>
#include <ceres/solver.h>

#include <algorithm>
#include <limits>
#include <memory>

namespace frac::detail {

namespace {

/// All residuals and their Jacobian at the theta asked for last: within one step Ceres asks up to three times for the
/// same, and block by block.
class LastEvaluation {
 public:
  explicit LastEvaluation(const Residuals& residuals)
      : residuals_(residuals),
        theta_(residuals.map().free().size(), std::numeric_limits<double>::quiet_NaN()),
        residual_(residuals.count()),
        jacobian_(residuals.count() * theta_.size()) {}

  [[nodiscard]] std::size_t width() const { return theta_.size(); }
  [[nodiscard]] std::size_t per_point() const { return residuals_.per_point(); }
  [[nodiscard]] const std::vector<double>& residual() const { return residual_; }
  [[nodiscard]] const std::vector<double>& jacobian() const { return jacobian_; }

  /// False where the model is not finite.
  bool at(const double* theta, bool with_jacobian) {
    const bool same = std::equal(theta_.begin(), theta_.end(), theta);
    if (same && (has_jacobian_ || !with_jacobian)) return finite_;
    std::copy_n(theta, theta_.size(), theta_.begin());
    has_jacobian_ = with_jacobian;
    finite_ = residuals_.evaluate(theta_, 0, residuals_.points(), residual_.data(),
                                  with_jacobian ? jacobian_.data() : nullptr);
    return finite_;
  }

 private:
  const Residuals& residuals_;
  std::vector<double> theta_, residual_, jacobian_;
  bool has_jacobian_ = false, finite_ = false;
};

/// Points [first, first + points) as one Ceres residual block over the whole theta.
class PointsCost final : public ceres::CostFunction {
 public:
  PointsCost(LastEvaluation& evaluation, std::size_t first, std::size_t points)
      : evaluation_(evaluation), first_(first * evaluation.per_point()), count_(points * evaluation.per_point()) {
    set_num_residuals(static_cast<int>(count_));
    mutable_parameter_block_sizes()->push_back(static_cast<int>(evaluation.width()));
  }

  bool Evaluate(const double* const* parameters, double* residual, double** jacobians) const override {
    const bool with_jacobian = jacobians && jacobians[0];
    if (!evaluation_.at(parameters[0], with_jacobian)) return false;
    std::copy_n(evaluation_.residual().data() + first_, count_, residual);
    const std::size_t width = evaluation_.width();
    if (with_jacobian) std::copy_n(evaluation_.jacobian().data() + first_ * width, count_ * width, jacobians[0]);
    return true;
  }

 private:
  LastEvaluation& evaluation_;
  std::size_t first_, count_;
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
  LastEvaluation evaluation(residuals);
  if (loss) {
    // A loss acts on a block, so each frequency is a block of its own.
    for (std::size_t i = 0; i < residuals.points(); ++i) {
      problem.AddResidualBlock(new PointsCost(evaluation, i, 1), loss.get(), theta);
    }
  } else {
    problem.AddResidualBlock(new PointsCost(evaluation, 0, residuals.points()), nullptr, theta);
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
