// SPDX-License-Identifier: BSD-3-Clause
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <set>

#include "frac/cancellation.hpp"
#include "frac/time_response/response_methods.hpp"
#include "special/reciprocal_gamma.hpp"
#include "time_response/sample_checks.hpp"

namespace frac {
namespace {

// Coefficients of (3/2 - 2 z + z^2/2)^order, by Miller's recurrence.
std::vector<double> bdf2_weights(double order, std::size_t count) {
  std::vector<double> weight{std::pow(1.5, order)};
  for (std::size_t n = 1; n < count; ++n) {
    const auto k = static_cast<double>(n);
    double sum = (order + 1 - k) * -2 * weight[n - 1];
    if (n > 1) sum += (2 * (order + 1) - k) * 0.5 * weight[n - 2];
    weight.push_back(sum / (1.5 * k));
  }
  return weight;
}

// sum of coefficient h^-order times those.
std::vector<double> weights_of(const std::vector<PowerTerm>& terms, double sample_time, std::size_t count) {
  std::vector<double> sum(count, 0);
  for (const PowerTerm& term : terms) {
    const std::vector<double> each = bdf2_weights(term.order, count);
    const double factor = term.coefficient * std::pow(sample_time, -term.order);
    for (std::size_t k = 0; k < count; ++k) sum[k] += factor * each[k];
  }
  return sum;
}

// What the terms make of t^exponent at t = n h, over h^exponent.
double exact_at(const std::vector<PowerTerm>& terms, double sample_time, double exponent, double n) {
  double sum = 0;
  for (const PowerTerm& term : terms) {
    sum += term.coefficient * std::pow(sample_time, -term.order) * std::tgamma(exponent + 1) *
           detail::reciprocal_gamma(exponent + 1 - term.order) * std::pow(n, exponent - term.order);
  }
  return sum;
}

constexpr std::size_t most_exponents = 8;
constexpr double close = 1e-9;

// Powers e of t in the expansion of the response at t = 0: the relative degree of a numerator term plus any sum of the
// distances of denominator terms from the highest, plus the whole powers that the input begins with.  The quadrature of
// s^q errs on t^e by n^(-q-1) h^(e-q) at sample n, the solution then by h^(e-q+1): those below q + 1, q the highest
// order, are made exact.
std::vector<double> starting_exponents(const FractionalTransferFunction& model, bool input_jumps, bool input_moves) {
  const double highest = model.denominator().front().order;
  std::set<double> found;
  std::vector<double> open;
  for (const PowerTerm& term : model.numerator()) open.push_back(highest - term.order + (input_jumps ? 0 : 1));
  while (!open.empty()) {
    const double exponent = open.back();
    open.pop_back();
    if (exponent > highest + 1 - close) continue;
    const auto near = found.lower_bound(exponent - close);
    if (near != found.end() && *near < exponent + close) continue;
    found.insert(exponent);
    if (found.size() > most_exponents) {
      throw std::invalid_argument("respond_bdf2: the response begins with more than 8 powers of t below " +
                                  detail::number_text(highest + 1) +
                                  "; weights that make them all exact would only amplify rounding");
    }
    if (input_moves) open.push_back(exponent + 1);
    for (const PowerTerm& term : model.denominator()) {
      if (term.order < highest) open.push_back(exponent + highest - term.order);
    }
  }
  return {found.begin(), found.end()};
}

// Weights of the samples first_sample, first_sample + 1, ... that make the quadrature with `weights` of the terms exact
// for as many powers of t.
class StartingWeights {
 public:
  StartingWeights(const std::vector<PowerTerm>& terms, const std::vector<double>& weights, double sample_time,
                  const std::vector<double>& exponents, Eigen::Index first_sample) {
    const auto starts = static_cast<Eigen::Index>(exponents.size());
    const std::size_t count = weights.size();
    lacking_.setZero(starts, static_cast<Eigen::Index>(count));
    Eigen::MatrixXd power(starts, starts);
    for (Eigen::Index e = 0; e < starts; ++e) {
      const double exponent = exponents[static_cast<std::size_t>(e)];
      std::vector<double> value(count);
      for (std::size_t n = 0; n < count; ++n) value[n] = std::pow(static_cast<double>(n), exponent);
      for (Eigen::Index k = 0; k < starts; ++k) power(e, k) = std::pow(static_cast<double>(k + first_sample), exponent);
      for (std::size_t n = 1; n < count; ++n) {
        double sum = 0;
        throw_if_cancelled();
        for (std::size_t k = 0; k <= n; ++k) sum += weights[k] * value[n - k];
        lacking_(e, static_cast<Eigen::Index>(n)) =
            exact_at(terms, sample_time, exponent, static_cast<double>(n)) - sum;
      }
    }
    if (starts > 0) factored_.compute(power);
  }
  [[nodiscard]] Eigen::VectorXd at(std::size_t n) const {
    if (lacking_.rows() == 0) return {};
    return factored_.solve(lacking_.col(static_cast<Eigen::Index>(n)));
  }

 private:
  Eigen::MatrixXd lacking_;
  Eigen::FullPivLU<Eigen::MatrixXd> factored_;
};

}  // namespace

std::vector<double> respond_bdf2(const FractionalTransferFunction& model, std::span<const double> samples,
                                 double sample_time) {
  detail::check_samples(samples, "respond_bdf2");
  detail::check_sample_time(sample_time, "respond_bdf2");
  detail::check_proper(model, "respond_bdf2");
  const std::size_t count = samples.size();
  const std::vector<double> left = weights_of(model.denominator(), sample_time, count);
  const std::vector<double> right = weights_of(model.numerator(), sample_time, count);

  // The input side: whole powers from the jump at t = 0 on.
  const double highest_top = model.numerator().front().order;
  std::vector<double> driven(count, 0);
  std::vector<double> whole;
  if (model.numerator().back().order != 0 || highest_top != 0) {
    for (double power = 0; power < highest_top + 1 && whole.size() < count; ++power) whole.push_back(power);
  }
  const StartingWeights input_start(model.numerator(), right, sample_time, whole, 0);
  for (std::size_t n = 0; n < count; ++n) {
    throw_if_cancelled();
    for (std::size_t k = 0; k <= n; ++k) driven[n] += right[k] * samples[n - k];
    if (n == 0 || whole.empty()) continue;
    const Eigen::VectorXd weight = input_start.at(n);
    for (Eigen::Index k = 0; k < weight.size(); ++k) driven[n] += weight[k] * samples[static_cast<std::size_t>(k)];
  }

  std::vector<double> output(count, 0);
  if (detail::order_at_infinity(model) == 0) {
    output[0] = samples[0] * model.numerator().front().coefficient / model.denominator().front().coefficient;
  }
  const bool moves = std::any_of(samples.begin(), samples.end(), [&](double each) { return each != samples[0]; });
  std::vector<double> exponents = starting_exponents(model, samples[0] != 0, moves);
  exponents.resize(std::min(exponents.size(), count - 1));
  const auto starts = static_cast<Eigen::Index>(exponents.size());
  const StartingWeights output_start(model.denominator(), left, sample_time, exponents, 1);

  // The starting weights couple the first samples, so these are solved for together.
  if (starts > 0) {
    Eigen::MatrixXd together = Eigen::MatrixXd::Zero(starts, starts);
    Eigen::VectorXd rest(starts);
    for (Eigen::Index n = 1; n <= starts; ++n) {
      const auto at = static_cast<std::size_t>(n);
      together.row(n - 1) = output_start.at(at).transpose();
      for (Eigen::Index k = 1; k <= n; ++k) together(n - 1, k - 1) += left[static_cast<std::size_t>(n - k)];
      rest[n - 1] = driven[at] - left[at] * output[0];
    }
    const Eigen::VectorXd first = together.fullPivLu().solve(rest);
    for (Eigen::Index n = 0; n < starts; ++n) output[static_cast<std::size_t>(n + 1)] = first[n];
  }
  for (std::size_t n = static_cast<std::size_t>(starts) + 1; n < count; ++n) {
    double sum = driven[n];
    throw_if_cancelled();
    for (std::size_t k = 1; k <= n; ++k) sum -= left[k] * output[n - k];
    if (starts > 0) {
      const Eigen::VectorXd weight = output_start.at(n);
      for (Eigen::Index k = 0; k < starts; ++k) sum -= weight[k] * output[static_cast<std::size_t>(k + 1)];
    }
    output[n] = sum / left[0];
  }
  detail::delay_samples(output, model.delay(), sample_time);
  return output;
}

}  // namespace frac
