#include "ladder.hpp"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numbers>

#include "flux_law.hpp"

namespace frac::detail {
namespace {

using Extended = long double;
using ExtendedComplex = std::complex<Extended>;

// k-th positive zero of the Bessel function J_order, |order| < 1, by McMahon (within 0.2 %).  Where the first goes to
// zero, order -> -1, from the quotient of two Rayleigh sums, joined to McMahon at order 0: what matters more than the
// last digit is that poles and zeros, which stand at J_-a and J_a, meet neither at a -> 0 nor at a -> 1.
double bessel_zero(double order, int k) {
  const auto mcmahon = [](double of, int index) {
    const double leading = (index + of / 2 - 0.25) * std::numbers::pi;
    return leading - (4 * of * of - 1) / (8 * leading);
  };
  if (k > 1 || order >= 0) return mcmahon(order, k);
  const auto rayleigh = [](double of) { return std::sqrt(8 * (of + 1) * (of + 2) * (of + 4) / (5 * of + 11)); };
  return rayleigh(order) * (1 + (1 + order) * (mcmahon(0, 1) / rayleigh(0) - 1));
}

// Logarithms of the poles, rising.  Poles stand at equal steps of the flux; the shares next to the two ends follow the
// zeros of J_-a and J_a, as they do for the Pade approximant of s^a, whose zeros and poles are zeros of Jacobi
// polynomials.  The error is then within a factor of about three of the optimum.
std::vector<Extended> starting_poles(const UnitProblem& problem, int poles) {
  const FluxLaw law(problem.half_width);
  const auto beyond_evenly = [](double order, int k) {
    return bessel_zero(order, k) / std::numbers::pi - (k + order / 2 - 0.25);
  };
  std::vector<Extended> logarithms;
  for (int i = 0; i < poles; ++i) {
    const double even = 2 * (i + 0.75 + problem.order / 2) / (poles + 0.5) - 1;
    const double ends = beyond_evenly(problem.order, i + 1) - beyond_evenly(-problem.order, poles - i);
    logarithms.push_back(law.position(even + 2 * ends / (poles + 0.5)));
  }
  return logarithms;
}

// |e^E - 1|, and the same at the mirrored frequency, where the logarithmic error is -conj E.
double relative_error(ExtendedComplex logarithmic) {
  const double real = static_cast<double>(logarithmic.real());
  const double imaginary = static_cast<double>(logarithmic.imag());
  const double half_sine = std::sin(imaginary / 2);
  const auto at = [&](double log_gain) {
    return std::hypot(std::expm1(log_gain), 2 * std::exp(log_gain / 2) * half_sine);
  };
  return std::max(at(real), at(-real));
}

class LogPoleProblem {
 public:
  LogPoleProblem(const UnitProblem& problem, int poles)
      : order_(problem.order), poles_(poles), log_omega_(FluxLaw(problem.half_width).band_grid(grid_points(poles))) {
    for (const double t : log_omega_) omega_.push_back(std::exp(static_cast<Extended>(t)));
    weight_ = Eigen::VectorXd::Constant(points(), 1.0 / static_cast<double>(points()));
  }

  [[nodiscard]] Eigen::Index points() const { return static_cast<Eigen::Index>(omega_.size()); }

  // ln(H/(j omega)^order) at every point, H = prod (1 + j omega p)/(p + j omega).
  void evaluate(const std::vector<Extended>& log_poles) {
    std::vector<Extended> pole;
    Extended log_gain = 0;
    for (const Extended x : log_poles) {
      pole.push_back(std::exp(x));
      log_gain -= x;
    }
    const Extended quarter = std::numbers::pi_v<Extended> / 2 * static_cast<Extended>(order_);
    const ExtendedComplex turn(std::cos(quarter), -std::sin(quarter));
    error_.resize(omega_.size());
    measure_.resize(omega_.size());
    largest_ = 0;
    for (std::size_t i = 0; i < omega_.size(); ++i) {
      const Extended omega = omega_[i];
      Extended numerator_real = 1, numerator_imaginary = 0, denominator_real = 1, denominator_imaginary = 0;
      for (const Extended p : pole) {
        const Extended q = omega * p;
        const Extended r = omega / p;
        const Extended numerator = numerator_real - q * numerator_imaginary;
        numerator_imaginary += q * numerator_real;
        numerator_real = numerator;
        const Extended denominator = denominator_real - r * denominator_imaginary;
        denominator_imaginary += r * denominator_real;
        denominator_real = denominator;
      }
      const ExtendedComplex ratio = ExtendedComplex(numerator_real, numerator_imaginary) /
                                    ExtendedComplex(denominator_real, denominator_imaginary);
      error_[i] = std::log(ratio * turn) + (log_gain - static_cast<Extended>(order_) * log_omega_[i]);
      measure_[i] = relative_error(error_[i]);
      largest_ = std::max(largest_, measure_[i]);
    }
  }

  [[nodiscard]] double largest() const { return largest_; }

  // Root of the weighted mean of the squared errors.
  [[nodiscard]] double weighted_mean() const {
    double sum = 0;
    for (std::size_t i = 0; i < measure_.size(); ++i) {
      sum += weight_[static_cast<Eigen::Index>(i)] * measure_[i] * measure_[i];
    }
    return std::sqrt(sum);
  }

  // Lawson (1961): the weights that make weighted least squares a minimax solution are met by multiplying them with
  // the errors; a power above 1 hastens the first steps.
  void sharpen(double power) {
    for (std::size_t i = 0; i < measure_.size(); ++i) {
      weight_[static_cast<Eigen::Index>(i)] *= std::pow(measure_[i] / largest_, power);
    }
    weight_ /= weight_.sum();
  }

  struct Step {
    Eigen::VectorXd change;  // of the logarithms of the poles
    double predicted;        // weighted mean after it, to first order: no ladder nearby has a smaller largest error
  };

  // With more poles than the error needs, some displacements hardly change it and would be driven far by rounding and
  // curvature; a ridge proportional to the error (Yamashita, Fukushima 2001) holds them back.
  [[nodiscard]] Step gauss_newton(const std::vector<Extended>& log_poles, double damping) const {
    std::vector<double> poles;
    for (const Extended x : log_poles) poles.push_back(static_cast<double>(std::exp(x)));
    const double ridge = damping * weighted_mean();
    Eigen::MatrixXd jacobian = Eigen::MatrixXd::Zero(2 * points() + poles_, poles_);
    Eigen::VectorXd residual = Eigen::VectorXd::Zero(2 * points() + poles_);
    jacobian.bottomRows(poles_).diagonal().setConstant(ridge);
    for (Eigen::Index i = 0; i < points(); ++i) {
      const auto index = static_cast<std::size_t>(i);
      const double length = static_cast<double>(std::abs(error_[index]));
      const double scale = std::sqrt(weight_[i]) * (length > 0 ? measure_[index] / length : 1);
      residual[2 * i] = -scale * static_cast<double>(error_[index].real());
      residual[2 * i + 1] = -scale * static_cast<double>(error_[index].imag());
      const double omega = static_cast<double>(omega_[index]);
      for (Eigen::Index k = 0; k < poles_; ++k) {
        const double q = omega * poles[static_cast<std::size_t>(k)];
        const double r = omega / poles[static_cast<std::size_t>(k)];
        jacobian(2 * i, k) = scale * (1 / (1 + 1 / (q * q)) - 1 / (1 + r * r));
        jacobian(2 * i + 1, k) = scale * (1 / (q + 1 / q) + 1 / (r + 1 / r));
      }
    }
    const Eigen::ColPivHouseholderQR<Eigen::MatrixXd> factorised(jacobian);
    Step step{factorised.solve(residual), 0};
    step.predicted = (residual - jacobian * step.change).norm();
    return step;
  }

 private:
  // Four per pole in half the band: some eight per turn of the error, which turns once per pole.
  static int grid_points(int poles) { return std::max(4 * poles + 4, 24); }

  double order_;
  Eigen::Index poles_;
  std::vector<double> log_omega_;
  std::vector<Extended> omega_;
  std::vector<ExtendedComplex> error_;
  std::vector<double> measure_;
  double largest_ = 0;
  Eigen::VectorXd weight_;
};

// Poles p and zeros 1/p alternate, a zero being the smallest.
bool interlaced(const std::vector<Extended>& log_poles) {
  const std::size_t count = log_poles.size();
  for (std::size_t i = 0; i < count; ++i) {
    const Extended zero_below = -log_poles[count - 1 - i];
    if (!(log_poles[i] > zero_below)) return false;
    if (i + 1 < count && !(log_poles[i] < -log_poles[count - 2 - i])) return false;
  }
  return true;
}

std::vector<Extended> moved(const std::vector<Extended>& log_poles, const Eigen::VectorXd& change, double share) {
  std::vector<Extended> result = log_poles;
  for (std::size_t k = 0; k < result.size(); ++k) result[k] += share * change[static_cast<Eigen::Index>(k)];
  return result;
}

std::vector<Extended> optimal_log_poles(const UnitProblem& problem, int poles, double hopeless_above) {
  constexpr int most_steps = 60;
  constexpr int most_sharpenings = 18;
  constexpr double close_enough = 1.015;  // largest error by the bound on it
  // Below it the error is the rounding of the extended evaluation.
  constexpr double noise = 64 * static_cast<double>(std::numeric_limits<Extended>::epsilon());

  LogPoleProblem least(problem, poles);
  std::vector<Extended> current = starting_poles(problem, poles);
  least.evaluate(current);
  std::vector<Extended> best = current;
  double best_error = least.largest();
  double bound = 0;
  int sharpenings = 0;
  // Relative to the error, and its bounds: below the lower a displacement is not held at all in double, the upper
  // leaves a minimax step unchanged to six digits.
  double damping = 1e-5;
  constexpr double least_damping = 1e-9;
  constexpr double most_damping = 1e-3;
  for (int i = 0; i < most_steps && best_error > noise; ++i) {
    const LogPoleProblem::Step step = least.gauss_newton(current, damping);
    if (!step.change.allFinite()) break;
    const bool settled = least.largest() < 4 * step.predicted;
    if (settled) {
      bound = std::max(bound, step.predicted);
      if (best_error <= close_enough * bound || bound > hopeless_above || sharpenings == most_sharpenings) break;
    }
    const double mean = least.weighted_mean();
    double share = 1;
    bool improved = false;
    for (; share > 1e-3; share /= 2) {
      std::vector<Extended> trial = moved(current, step.change, share);
      if (!interlaced(trial)) continue;
      least.evaluate(trial);
      if (least.weighted_mean() < mean * (1 + 1e-3)) {
        current = std::move(trial);
        improved = true;
        break;
      }
    }
    if (!improved && damping == most_damping) break;
    damping = !improved || least.weighted_mean() > 0.5 * mean ? std::min(10 * damping, most_damping)
                                                              : std::max(damping / 10, least_damping);
    if (!improved) {
      least.evaluate(current);
      continue;
    }
    if (least.largest() < best_error) {
      best_error = least.largest();
      best = current;
    }
    // Weights are worth sharpening once the step no longer changes the error by orders of magnitude.
    if (least.largest() < 4 * step.predicted) {
      least.sharpen(sharpenings < 3 ? 2 : 1);
      ++sharpenings;
    }
  }
  return best;
}

}  // namespace

UnitDesign ladder_design(const UnitProblem& problem, int poles, double hopeless_above) {
  UnitDesign design;
  for (const Extended x : optimal_log_poles(problem, poles, hopeless_above)) {
    design.poles.push_back(std::exp(x));
    design.zeros.push_back(std::exp(-x));
    design.gain *= design.poles.back();
  }
  std::reverse(design.zeros.begin(), design.zeros.end());
  return design;
}

}  // namespace frac::detail
