// SPDX-License-Identifier: BSD-3-Clause
#include "scene_solver.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/linear_algebra.hpp"
#include "frac/cancellation.hpp"
#include "scene_evidence.hpp"

namespace backlash::detail {
namespace {

struct Evaluation {
  double cost = 0;
  std::vector<std::size_t> ended;  // points whose motion does not exist there
};

// deviation: of each point; null: that of the model at theta
NormalEquations products(const SceneData& data, const SceneMotions& motions, const Coordinates& theta,
                         const PointChoices& choices, const std::vector<double>* deviation) {
  const auto size = static_cast<Eigen::Index>(theta.size());
  NormalEquations result{Eigen::MatrixXd::Zero(size, size), Eigen::VectorXd::Zero(size), 0, 0, {}};
  const auto gradients = motions.gradients(theta, choices);
  for (std::size_t i = 0; i < choices.size(); ++i) {
    const auto& model = gradients[i];
    if (!model) continue;
    const MeasuredPoint& point = data.points[i];
    const double scale = 1 / (deviation != nullptr ? (*deviation)[i] : data.deviation(point, model->value));
    PointResiduals residuals{data.parts((model->value - point.value) * scale), {size, 2}};
    for (Eigen::Index k = 0; k < size; ++k) {
      const auto parts = data.parts(model->gradient[static_cast<std::size_t>(k)] * scale);
      residuals.gradient.row(k) << parts[0], parts[1];
    }
    for (std::size_t part = 0; part < data.residuals_per_point(); ++part) {
      const auto column = residuals.gradient.col(static_cast<Eigen::Index>(part));
      result.cost += residuals.value[part] * residuals.value[part];
      ++result.residuals;
      result.gradient += column * residuals.value[part];
      result.matrix += column * column.transpose();
    }
    result.points.push_back(std::move(residuals));
  }
  return result;
}

class Solver {
 public:
  Solver(const SceneFamily& family, Effort effort, Motions which)
      : family_(family),
        data_(family.data()),
        motions_(family.motions(effort, which)),
        pace_(motions_->pace()),
        choices_(data_.points.size()) {}

  LocalScene run(const Coordinates& start) {
    LocalScene result;
    theta_ = start;
    for (int round = 0; round < pace_.rounds; ++round) {
      const PointChoices before = choices_;
      choose(round);
      if (count_used() * data_.residuals_per_point() < family_.least_residuals()) break;
      if (round > pace_.rounds_that_differ && settled(before) && moved_ < pace_.last_step &&
          !finds_more_motions(round)) {
        result.converged = least_squares_converged_ || pace_.has_kinks;
        break;
      }
      least_squares();
    }
    choose(pace_.rounds);
    result.usable = count_used() * data_.residuals_per_point() >= std::max<std::size_t>(1, family_.least_residuals());
    result.theta = theta_;
    result.deviance = scene_evidence(data_, choices_, family_.free_count(), motions_->accuracy()).deviance;
    result.choices = std::move(choices_);
    result.motions = std::move(motions_);
    return result;
  }

 private:
  [[nodiscard]] std::size_t count_used() const {
    return static_cast<std::size_t>(
        std::count_if(choices_.begin(), choices_.end(), [](const PointChoice& choice) { return choice.used; }));
  }
  [[nodiscard]] bool settled(const PointChoices& before) const {
    for (std::size_t i = 0; i < choices_.size(); ++i) {
      if (choices_[i].used != before[i].used) return false;
      if (choices_[i].used && choices_[i].kind != before[i].kind) return false;
    }
    return true;
  }

  // Motions that were given up on the way may exist at its end.
  bool finds_more_motions(int round) {
    if (!motions_->look_again()) return false;
    const PointChoices before = choices_;
    choose(round);
    return !settled(before);
  }

  void choose(int round) {
    motions_->choose(theta_, round, choices_);
    use_by_evidence(data_, choices_, family_.free_count(), motions_->accuracy());
  }

  [[nodiscard]] std::vector<double> deviations() const {
    std::vector<double> result(choices_.size());
    for (std::size_t i = 0; i < choices_.size(); ++i) {
      result[i] = data_.deviation(data_.points[i], choices_[i].model);
    }
    return result;
  }

  [[nodiscard]] Evaluation evaluate(const Coordinates& theta, const std::vector<double>& deviation, bool all) const {
    Evaluation result;
    const auto values = motions_->values(theta, choices_, all);
    for (std::size_t i = 0; i < choices_.size(); ++i) {
      if (!choices_[i].used) continue;
      if (!values[i]) {
        result.ended.push_back(i);
        if (!all) return result;
        continue;
      }
      const double misfit = data_.size(*values[i] - data_.points[i].value) / deviation[i];
      result.cost += misfit * misfit;
    }
    return result;
  }

  void drop(const std::vector<std::size_t>& points) {
    for (const std::size_t i : points) choices_[i].used = false;
  }

  void least_squares();
  [[nodiscard]] double way_in_standard_errors(const Coordinates& start, const NormalEquations& end) const;

  const SceneFamily& family_;
  const SceneData& data_;
  std::shared_ptr<SceneMotions> motions_;
  Pace pace_;
  PointChoices choices_;
  Coordinates theta_;
  double moved_ = 0;
  bool least_squares_converged_ = false;
};

// How much Levenberg and Marquardt's steps are shortened.
struct Damping {
  double value = 1e-4;
  int rejected = 0;

  void accept() {
    value = std::max(value * 0.1, 1e-15);
    rejected = 0;
  }
  /// After a step that was no gain: whether shorter ones have been so for too long.
  [[nodiscard]] bool is_in_vain() {
    value = std::max(value * 8, 1e-10);
    return ++rejected > 12;
  }
};

// The normal equations of those parameters that no bound holds: one at a bound that the gradient presses against it
// stays there.
class BoxedEquations {
 public:
  BoxedEquations(const NormalEquations& equations, const Coordinates& theta, const SceneBounds& bounds)
      : matrix_(equations.matrix), gradient_(equations.gradient) {
    for (std::size_t k = 0; k < theta.size(); ++k) {
      const auto row = static_cast<Eigen::Index>(k);
      const bool pressed =
          (theta[k] <= bounds.lower[k] && gradient_[row] > 0) || (theta[k] >= bounds.upper[k] && gradient_[row] < 0);
      if (bounds.is_free(k) && !pressed) {
        largest_ = std::max(largest_, matrix_(row, row));
        continue;
      }
      gradient_[row] = 0;
      matrix_.row(row).setZero();
      matrix_.col(row).setZero();
      held_.push_back(row);
    }
  }

  /// Whether nothing is left that the data would move.
  [[nodiscard]] bool is_flat() const { return !(largest_ > 0); }

  [[nodiscard]] Eigen::VectorXd step(double damping) const {
    Eigen::MatrixXd matrix = matrix_;
    matrix.diagonal() += damping * matrix_.diagonal().cwiseMax(1e-12 * largest_);
    for (const Eigen::Index row : held_) matrix(row, row) = 1;
    return -frac::detail::PivotedQr(matrix).solve(gradient_);
  }

 private:
  Eigen::MatrixXd matrix_;
  Eigen::VectorXd gradient_;
  std::vector<Eigen::Index> held_;
  double largest_ = 0;
};

struct Trial {
  Coordinates theta;
  double change;  // of the parameter that moved most
};
Trial step_within(const SceneBounds& bounds, const Coordinates& theta, const Eigen::VectorXd& step) {
  Trial trial{theta, 0};
  for (std::size_t k = 0; k < theta.size(); ++k) {
    trial.theta[k] = std::clamp(theta[k] + step[static_cast<Eigen::Index>(k)], bounds.lower[k], bounds.upper[k]);
    trial.change = std::max(trial.change, std::abs(trial.theta[k] - theta[k]));
  }
  return trial;
}

// Levenberg and Marquardt's method in a box.
void Solver::least_squares() {
  const Coordinates start = theta_;
  const std::vector<double> deviation = deviations();
  Damping damping;
  least_squares_converged_ = false;
  Evaluation current = evaluate(theta_, deviation, true);
  drop(current.ended);
  for (int iteration = 0; iteration < pace_.iterations && !least_squares_converged_;) {
    frac::throw_if_cancelled();
    const BoxedEquations equations(products(data_, *motions_, theta_, choices_, &deviation), theta_, family_.bounds());
    if (equations.is_flat()) {
      least_squares_converged_ = true;
      break;
    }
    bool moved = false;
    while (!moved && iteration < pace_.iterations) {
      const Trial trial = step_within(family_.bounds(), theta_, equations.step(damping.value));
      if (!(trial.change > 1e-13)) {
        least_squares_converged_ = true;
        break;
      }
      ++iteration;
      const Evaluation next = evaluate(trial.theta, deviation, false);
      moved = next.ended.empty() && next.cost <= current.cost;
      if (moved) {
        // Rounding of the cost hides steps this small.
        least_squares_converged_ = trial.change < 1e-11 || current.cost - next.cost <= 1e-6 * current.cost;
        theta_ = trial.theta;
        current = next;
        damping.accept();
      } else if (damping.is_in_vain()) {
        // A motion ends right here, or the differences in cost are rounding.
        damping = {};
        least_squares_converged_ = next.ended.empty();
        if (!least_squares_converged_) {
          drop(evaluate(trial.theta, deviation, true).ended);
          current = evaluate(theta_, deviation, true);
        }
        break;
      }
    }
  }
  moved_ = way_in_standard_errors(start, products(data_, *motions_, theta_, choices_, &deviation));
}

// Length of the way from the start in units of the standard errors, rounding aside.
double Solver::way_in_standard_errors(const Coordinates& start, const NormalEquations& end) const {
  double square = 0;
  for (std::size_t k = 0; k < theta_.size(); ++k) {
    for (std::size_t l = 0; l < theta_.size(); ++l)
      square += (theta_[k] - start[k]) * end.matrix(static_cast<Eigen::Index>(k), static_cast<Eigen::Index>(l)) *
                (theta_[l] - start[l]);
  }
  const double count = static_cast<double>(std::max<std::size_t>(1, end.residuals));
  const double accuracy = 1e-9 * data_.typical_misfit;
  return std::sqrt(std::max(square, 0.0) / (end.cost / count + accuracy * accuracy));
}

}  // namespace

NormalEquations normal_equations(const SceneData& data, const LocalScene& local) {
  return products(data, *local.motions, local.theta, local.choices, nullptr);
}

LocalScene solve_scene(const SceneFamily& family, const Coordinates& start, Effort effort, Motions motions) {
  return Solver(family, effort, motions).run(start);
}

}  // namespace backlash::detail
