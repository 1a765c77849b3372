// SPDX-License-Identifier: BSD-3-Clause
#include "joint_confidence.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/gram_schmidt.hpp"
#include "base/linear_algebra.hpp"
#include "frac/identification/statistics.hpp"
#include "identification/residuals/loss.hpp"
#include "identification/statistics/confidence.hpp"
#include "identification/statistics/correlated_noise.hpp"

namespace frac::detail {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

bool is_at_bound(const JointVariable& variable, double value) {
  return detail::is_at_bound(value, variable.lower, variable.upper);
}

/// One curve at the minimum.  With own columns A and shared columns B of the Jacobian the own variables follow the
/// shared ones by -A^+ B, and what the curve knows of the shared ones stands in the part of B outside the space of A.
struct Curve {
  Eigen::VectorXd residual;
  Eigen::MatrixXd jacobian;         // own columns, shared columns; the last rows are those of own priors
  std::vector<Eigen::Index> inner;  // own variables that are seen and not at a bound
  Eigen::MatrixXd own_influence;    // what an own variable moves by for each residual, the shared ones held
  Eigen::MatrixXd follows;          // d own / d shared
  Eigen::MatrixXd rest;             // of the shared columns
  Eigen::MatrixXd fitted;           // all inner columns
  CorrelatedNoise noise;
};

/// Inverse of a symmetric matrix with unit diagonal, and its condition.
Eigen::MatrixXd inverse_of(const Eigen::MatrixXd& matrix, double& condition) {
  const auto [values, vectors] = right_singular_vectors(matrix);
  const double smallest = std::numeric_limits<double>::epsilon() * values[0];
  condition = values[0] / std::max(values[values.size() - 1], smallest);
  return vectors * values.cwiseMax(smallest).cwiseInverse().asDiagonal() * vectors.transpose();
}

/// Residuals under a loss, all curves together: the variance of one, and the unit of the loss, each times the degrees
/// of freedom (Huber 1981, sect. 7.6); and, in place of the residuals, what they pull with.
struct Pulls {
  double variance, loss_unit;
  double slope;  // mean of psi'
  std::vector<Eigen::VectorXd> residual;
};
Pulls pulls_of(const std::vector<CurveResiduals>& curves, const std::vector<Curve>& at) {
  Pulls pulls{0, 0, 0, {}};
  double count = 0;
  for (std::size_t c = 0; c < curves.size(); ++c) {
    const double scale = curves[c].loss_scale();
    Eigen::VectorXd& pull = pulls.residual.emplace_back(at[c].residual);
    for (std::size_t row = 0; row < curves[c].count(); ++row) {
      double& each = pull[static_cast<Eigen::Index>(row)];
      const LossAt loss = loss_at(curves[c].loss(), each / scale);
      each = loss.psi * scale;
      pulls.variance += each * each;
      pulls.slope += loss.slope;
      ++count;
    }
  }
  pulls.slope /= count;
  pulls.loss_unit = pulls.variance / pulls.slope;
  pulls.variance /= pulls.slope * pulls.slope;
  return pulls;
}

/// What the correlation of neighbours adds to the covariance of variables, for residuals of unit variance.
/// @param influence  of the residuals of a curve, and behind these of priors, which no noise correlates
Eigen::MatrixXd added_by(const CorrelatedNoise& noise, const Eigen::MatrixXd& influence, std::size_t residuals) {
  const auto of_residuals = influence.topRows(static_cast<Eigen::Index>(residuals));
  return noise.covariance(of_residuals) - of_residuals.transpose() * of_residuals;
}

/// Factors of standard errors.
Eigen::VectorXd widening(const Eigen::MatrixXd& covariance, const Eigen::MatrixXd& in_white_noise) {
  const Eigen::ArrayXd white = in_white_noise.diagonal();
  return (white > 0).select((covariance.diagonal().array() / white).sqrt(), 1.0);
}

JointConfidence nothing_known(std::size_t curves, const JointLayout& layout) {
  const auto own = static_cast<Eigen::Index>(layout.own.size()),
             shared = static_cast<Eigen::Index>(layout.shared.size());
  JointConfidence result{};
  result.shared = Eigen::MatrixXd::Constant(shared, shared, nan);
  result.curve.assign(curves, Eigen::MatrixXd::Constant(own + shared, own + shared, nan));
  result.shared_widening.assign(layout.shared.size(), 1.0);
  result.own_widening.assign(curves, std::vector<double>(layout.own.size(), 1.0));
  result.own_at_bound.assign(curves, std::vector<bool>(layout.own.size(), false));
  result.condition = 1;
  return result;
}

/// The errors of all variables, found in the order of the functions below; each notes its part of the result.
class JointErrors {
 public:
  JointErrors(std::vector<CurveResiduals>& curves, const JointLayout& layout, const JointPoint& point)
      : curves_(curves),
        layout_(layout),
        point_(point),
        own_(static_cast<Eigen::Index>(layout.own.size())),
        shared_(static_cast<Eigen::Index>(layout.shared.size())),
        own_priors_(static_cast<Eigen::Index>(layout.own_priors.size())),
        at_(curves.size()),
        result_(nothing_known(curves.size(), layout)) {}

  JointConfidence found() {
    linearise();
    pulls_ = pulls_of(curves_, at_);
    weigh_priors_and_choose_shared();
    Eigen::MatrixXd known = shared_priors_.transpose() * shared_priors_;
    for (std::size_t c = 0; c < curves_.size(); ++c) {
      split_off_own(c);
      known += at_[c].rest.transpose() * at_[c].rest;
      find_noise(c);
    }
    const Eigen::MatrixXd unit_covariance = inverse_of_known(known);
    measure_spread(unit_covariance);
    set_shared_errors(unit_covariance);
    for (std::size_t c = 0; c < curves_.size(); ++c) set_own_errors(c);
    return std::move(result_);
  }

 private:
  void linearise() {
    for (std::size_t c = 0; c < curves_.size(); ++c) {
      const auto rows = static_cast<Eigen::Index>(curves_[c].rows());
      at_[c].residual.resize(rows);
      at_[c].jacobian.resize(rows, own_ + shared_);
      curves_[c].evaluate(point_.shared, point_.own[c], at_[c].residual.data(), at_[c].jacobian.data());
    }
  }

  void weigh_priors_and_choose_shared() {
    // The cost weighs priors by the unit of the loss; squares of residuals weigh by their variance.
    const double prior_weight = curves_.front().prior_weight() * std::sqrt(1 / pulls_.slope);
    const Eigen::MatrixXd priors = shared_prior_rows(prior_weight);
    Eigen::VectorXd size = Eigen::VectorXd::Zero(shared_);
    for (const Curve& curve : at_) size += curve.jacobian.rightCols(shared_).colwise().squaredNorm().transpose();
    size += priors.colwise().squaredNorm().transpose();
    choose_shared(size.cwiseSqrt());
    shared_priors_ = chosen_columns(priors, inner_);
    for (std::size_t c = 0; c < curves_.size(); ++c)
      at_[c].jacobian.bottomRows(own_priors_) *= prior_weight / curves_[c].prior_weight();
  }

  [[nodiscard]] Eigen::MatrixXd shared_prior_rows(double weight) const {
    Eigen::MatrixXd rows(static_cast<Eigen::Index>(layout_.shared_priors.size()), shared_);
    for (Eigen::Index row = 0; row < rows.rows(); ++row) {
      const JointLayout::Pull pull =
          layout_.pull(layout_.shared_priors[static_cast<std::size_t>(row)], point_.shared, point_.own.front(), 0);
      for (Eigen::Index k = 0; k < shared_; ++k)
        rows(row, k) = weight * pull.by_variable[static_cast<std::size_t>(own_ + k)];
    }
    return rows;
  }

  void choose_shared(const Eigen::VectorXd& size) {
    for (Eigen::Index k = 0; k < shared_; ++k) {
      const auto index = static_cast<std::size_t>(k);
      result_.shared_at_bound.push_back(is_at_bound(layout_.shared[index], point_.shared[index]));
      if (result_.shared_at_bound.back()) {
        ++result_.rank;
      } else if (size[k] > unseen_column * size.maxCoeff()) {
        inner_.push_back(k);
      }
    }
    result_.rank += inner_.size();
  }

  void choose_own(std::size_t c) {
    Curve& curve = at_[c];
    const Eigen::VectorXd norm = curve.jacobian.leftCols(own_).colwise().norm();
    for (Eigen::Index k = 0; k < own_; ++k) {
      const auto index = static_cast<std::size_t>(k);
      const bool at_bound = is_at_bound(layout_.own[index], point_.own[c][index]);
      result_.own_at_bound[c][index] = at_bound;
      if (at_bound)
        ++result_.rank;
      else if (norm[k] > unseen_column * norm.maxCoeff())
        curve.inner.push_back(k);
    }
    result_.rank += curve.inner.size();
  }

  /// What a curve tells of its own variables, and of the shared ones beside them.
  void split_off_own(std::size_t c) {
    choose_own(c);
    Curve& curve = at_[c];
    curve.rest = chosen_columns(curve.jacobian.rightCols(shared_), inner_);
    curve.fitted = curve.rest;
    curve.follows = Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(curve.inner.size()), width());
    curve.own_influence = Eigen::MatrixXd::Zero(curve.rest.rows(), curve.follows.rows());
    if (curve.inner.empty()) return;
    Eigen::MatrixXd columns = chosen_columns(curve.jacobian, curve.inner);
    const Eigen::VectorXd scale = columns.colwise().norm().transpose();
    columns = columns * scale.cwiseInverse().asDiagonal();
    const PlainQr qr(columns);
    const Eigen::MatrixXd basis = qr.basis();
    result_.from_priors += basis.bottomRows(own_priors_).squaredNorm();
    curve.own_influence = qr.dual() * scale.cwiseInverse().asDiagonal();
    curve.follows = -curve.own_influence.transpose() * curve.rest;
    remove_span(basis, curve.rest);
    curve.fitted.conservativeResize(Eigen::NoChange, width() + columns.cols());
    curve.fitted.rightCols(columns.cols()) = columns;
  }

  /// The noise is what is left of the residuals once the curve is fitted alone, without what sharing adds.
  void find_noise(std::size_t c) {
    Curve& curve = at_[c];
    const auto count = static_cast<Eigen::Index>(curves_[c].count());
    const Eigen::MatrixXd eliminated = curves_[c].eliminated_columns();
    Eigen::MatrixXd fitted(count, curve.fitted.cols() + eliminated.cols());
    fitted << curve.fitted.topRows(count), eliminated;
    const Eigen::VectorXd scale = fitted.colwise().norm().transpose();
    for (Eigen::Index k = 0; k < fitted.cols(); ++k)
      if (scale[k] > 0) fitted.col(k) /= scale[k];
    const Eigen::MatrixXd basis = PivotedQr(fitted).basis();
    Eigen::MatrixXd alone = pulls_.residual[c].head(count);
    remove_span(basis, alone);
    const Eigen::VectorXd left = alone.col(0);
    curve.noise = {std::span(left.data(), curves_[c].count()), basis, curves_[c].axis(point_.shared, point_.own[c])};
    result_.noise_correlation += curve.noise.correlation() / static_cast<double>(curves_.size());
  }

  /// The covariance of the shared variables for residuals of unit variance.
  [[nodiscard]] Eigen::MatrixXd inverse_of_known(const Eigen::MatrixXd& known) {
    if (width() == 0) return known;
    const Eigen::VectorXd scale =
        known.diagonal().cwiseSqrt().cwiseMax(std::numeric_limits<double>::min()).cwiseInverse();
    return scale.asDiagonal() * inverse_of(scale.asDiagonal() * known * scale.asDiagonal(), result_.condition) *
           scale.asDiagonal();
  }

  void measure_spread(const Eigen::MatrixXd& unit_covariance) {
    const auto told_by = [&](const Eigen::MatrixXd& priors) {
      return (priors * unit_covariance).cwiseProduct(priors).sum();
    };
    result_.from_priors += told_by(shared_priors_);
    std::size_t residuals = 0, eliminated = 0;
    for (std::size_t c = 0; c < curves_.size(); ++c) {
      eliminated += curves_[c].eliminated();
      result_.from_priors += told_by(at_[c].rest.bottomRows(own_priors_));
      residuals += curves_[c].count();
    }
    const double degrees =
        static_cast<double>(residuals) - static_cast<double>(result_.rank + eliminated) + result_.from_priors;
    result_.half_width = student_t_95(degrees);
    result_.deviation = degrees > 0 ? std::sqrt(pulls_.variance / degrees) : nan;
    result_.loss_unit = degrees > 0 ? pulls_.loss_unit / degrees : nan;
    variance_ = result_.deviation * result_.deviation;
  }

  void set_shared_errors(const Eigen::MatrixXd& unit_covariance) {
    covariance_ = unit_covariance;
    for (std::size_t c = 0; c < at_.size(); ++c)
      covariance_ += added_by(at_[c].noise, at_[c].rest * unit_covariance, curves_[c].count());
    covariance_ *= variance_;
    white_ = variance_ * unit_covariance;
    const Eigen::VectorXd factors = widening(covariance_, white_);
    for (Eigen::Index k = 0; k < width(); ++k)
      result_.shared_widening[static_cast<std::size_t>(inner_[static_cast<std::size_t>(k)])] = factors[k];
    result_.shared(inner_, inner_) = covariance_;
  }

  void set_own_errors(std::size_t c) {
    const Curve& curve = at_[c];
    // Errors with the shared variables held, and those that these bring along, have nothing to do with each other.
    const Eigen::MatrixXd held_in_white_noise = curve.own_influence.transpose() * curve.own_influence;
    const Eigen::MatrixXd held =
        variance_ * (held_in_white_noise + added_by(curve.noise, curve.own_influence, curves_[c].count()));
    const Eigen::MatrixXd mixed = curve.follows * covariance_;
    const Eigen::MatrixXd carried = mixed * curve.follows.transpose();
    const Eigen::VectorXd factors =
        widening(held + carried, variance_ * held_in_white_noise + curve.follows * white_ * curve.follows.transpose());
    std::vector<Eigen::Index> places;
    for (const Eigen::Index k : inner_) places.push_back(own_ + k);
    Eigen::MatrixXd& all = result_.curve[c];
    all(places, places) = covariance_;
    all(curve.inner, curve.inner) = held + carried;
    all(curve.inner, places) = mixed;
    all(places, curve.inner) = mixed.transpose();
    for (std::size_t k = 0; k < curve.inner.size(); ++k)
      result_.own_widening[c][static_cast<std::size_t>(curve.inner[k])] = factors[static_cast<Eigen::Index>(k)];
  }

  [[nodiscard]] Eigen::Index width() const { return static_cast<Eigen::Index>(inner_.size()); }

  std::vector<CurveResiduals>& curves_;
  const JointLayout& layout_;
  const JointPoint& point_;
  Eigen::Index own_, shared_, own_priors_;
  std::vector<Curve> at_;
  Pulls pulls_{};
  std::vector<Eigen::Index> inner_;     // shared variables that are seen and not at a bound
  Eigen::MatrixXd shared_priors_;       // derivatives of the shared priors by these
  double variance_ = 0;                 // of a residual
  Eigen::MatrixXd white_, covariance_;  // of the inner shared variables: in white noise, in the noise there is
  JointConfidence result_;
};

}  // namespace

JointConfidence joint_confidence(std::vector<CurveResiduals>& curves, const JointLayout& layout,
                                 const JointPoint& point) {
  return JointErrors(curves, layout, point).found();
}

}  // namespace frac::detail
