// SPDX-License-Identifier: BSD-3-Clause
#include "record_answers.hpp"

#include <array>
#include <cmath>
#include <complex>
#include <limits>
#include <numbers>
#include <string>
#include <utility>

#include "base/linear_algebra.hpp"
#include "frac/structure.hpp"
#include "rational_problem.hpp"

namespace frac::detail {
namespace {

using Complex = std::complex<double>;
using Index = Eigen::Index;
constexpr double tolerance = 1e-10;  // of simulations; residuals of 1e-9 are none

/// A part of a model as a formula; the letters of its parameters stand in the order of their values.
struct Part {
  explicit Part(const std::string& formula, const char* letters)
      : prompt(formula), delayed("exp(-L s) (" + formula + ")"), names(letters) {}
  Structure prompt, delayed;
  std::string names;
};

const Part& gain() {
  static const Part part("b", "b");
  return part;
}
const Part& single_pole() {
  static const Part part("b/(s/p + 1)", "bp");
  return part;
}
const Part& pole_pair() {
  static const Part part("(b + c s/w)/(s^2/w^2 + d s/w + 1)", "bcwd");
  return part;
}

/// Values and derivatives by the parameters, in their order; not finite where the part outgrows a double.
template <class Response>
Eigen::MatrixXd answer(const Response& response, Index outputs, const Part& part, const std::vector<double>& values,
                       double delay = 0) {
  const Structure& structure = delay > 0 ? part.delayed : part.prompt;
  std::vector<double> parameters(structure.parameter_names().size());
  const auto index = [&](char letter) { return structure.parameter_index(std::string(1, letter)); };
  for (std::size_t i = 0; i < values.size(); ++i) parameters[index(part.names[i])] = values[i];
  if (delay > 0) parameters[index('L')] = delay;
  Eigen::MatrixXd result = Eigen::MatrixXd::Constant(outputs, 1 + static_cast<Index>(values.size()),
                                                     std::numeric_limits<double>::quiet_NaN());
  const std::optional<RatioOfPowerSums> ratio = ratio_at(structure, parameters);
  EventResponse::Result found;
  if (!ratio || !response.evaluate(*ratio, tolerance, found)) return result;
  result.col(0) = found.value;
  for (std::size_t i = 0; i < values.size(); ++i)
    result.col(1 + static_cast<Index>(i)) = found.gradient.col(static_cast<Index>(index(part.names[i])));
  return result;
}

/// The parts that a factor f of the denominator gives, at s: 1/f and its derivative by the logarithm of a single pole;
/// of a pair 1/f, s/f, the derivatives of 1/f by the logarithm of its size and by d.
Eigen::MatrixXcd values_of(const PoleFactor& factor, const Eigen::ArrayXcd& s) {
  const Eigen::ArrayXcd z = s * std::exp(-factor.log_size);
  Eigen::MatrixXcd values(s.size(), factor.pair ? 4 : 2);
  if (factor.pair) {
    const double d = 2 * std::sinh(factor.damping);
    const Eigen::ArrayXcd f = (z * z + d * z + 1.0).inverse();
    values << f.matrix(), (z * f).matrix(), ((2.0 * z + d) * z * f * f).matrix(), (-z * f * f).matrix();
  } else {
    const Eigen::ArrayXcd f = (factor.sign * z + 1.0).inverse();
    values << f.matrix(), (factor.sign * z * f * f).matrix();
  }
  return values;
}

/// What the same parts answer.
template <class Response>
Eigen::MatrixXd answers_of(const Response& response, Index outputs, const PoleFactor& factor, double centre,
                           double delay) {
  const double size = std::exp(factor.log_size) * centre;
  if (factor.pair) {
    Eigen::MatrixXd all = answer(response, outputs, pole_pair(), {1, 0, size, 2 * std::sinh(factor.damping)}, delay);
    all.col(3) *= size;
    return chosen_columns(all, std::array<Index, 4>{0, 2, 3, 4});
  }
  Eigen::MatrixXd all = answer(response, outputs, single_pole(), {1, factor.sign * size}, delay);
  all.col(2) *= factor.sign * size;
  return chosen_columns(all, std::array<Index, 2>{0, 2});
}

Eigen::MatrixXd real_rows(const Eigen::MatrixXcd& values) {
  Eigen::MatrixXd rows(2 * values.rows(), values.cols());
  rows << values.real(), values.imag();
  return rows;
}

std::vector<double> observed_times(const TimeResponseData& data) {
  std::vector<double> time;
  for (const std::size_t i : data.observed()) time.push_back(data.time()[i]);
  return time;
}

}  // namespace

RecordRows record_rows(const TimeResponseData& data, const TimeFitOptions& options) {
  const auto count = static_cast<Index>(data.observed().size());
  const double length = data.time().back() - data.time().front();
  RecordRows rows{Eigen::VectorXd(count),
                  Eigen::VectorXd(count),
                  Eigen::VectorXd(count),
                  FirstOrderWhitening(data.observed(), options.noise_correlation),
                  {},
                  1 / length,
                  std::numbers::pi * static_cast<double>(data.size()) / length};
  Eigen::MatrixXd background(count, (options.offset ? 0 : 1) + (options.trend ? 1 : 0));
  for (Index i = 0; i < count; ++i) {
    const std::size_t point = data.observed()[static_cast<std::size_t>(i)];
    rows.time[i] = data.time()[point] - data.time().front();
    rows.weight[i] = data.sigma().empty() ? 1 : 1 / data.sigma()[point];
    rows.output[i] = data.output()[point] - options.offset.value_or(0);
    if (!options.offset) background(i, 0) = rows.weight[i];
    if (options.trend) background(i, background.cols() - 1) = rows.weight[i] * rows.time[i];
  }
  if (background.cols() > 0) {
    for (Index k = 0; k < background.cols(); ++k)
      rows.whitening.apply({background.col(k).data(), static_cast<std::size_t>(count)});
    rows.background = PivotedQr(background).basis();
  }
  Eigen::VectorXd target(count);
  rows.put(rows.output, target);
  const double size = target.stableNorm() / std::sqrt(static_cast<double>(count));
  if (size > 0) rows.weight /= size;
  return rows;
}

RecordAnswers::RecordAnswers(const TimeResponseData& data, bool earlier_input, double centre_omega)
    : outputs_(static_cast<Index>(data.observed().size())),
      centre_(centre_omega),
      response_(data, data.observed(), periodic_input(data)) {
  if (!earlier_input) return;
  step_.emplace(std::vector{data.time().front(), data.time().back()}, std::vector{1.0, 1.0}, Hold::zero_order,
                observed_times(data));
}

Eigen::MatrixXd RecordAnswers::of(const RationalShape& shape, const Eigen::VectorXcd& s,
                                  const Eigen::MatrixXcd& values) const {
  const double delay = shape.delayed ? shape.delay / centre_ : 0;
  const Index powers = static_cast<Index>(shape.integrators) + 1;
  Index count = powers + (shape.delayed ? 1 : 0);
  for (const PoleFactor& factor : shape.factors) count += factor.pair ? 4 : 2;
  Eigen::MatrixXd answers(outputs_, count);
  Eigen::MatrixXcd at_s(s.size(), count);
  Index filled = 0;
  for (; filled < powers; ++filled) {
    const Part part = filled == 0 ? gain() : Part("b/s^" + std::to_string(filled), "b");
    answers.col(filled) =
        answer(response_, outputs_, part, {std::pow(centre_, static_cast<double>(filled))}, delay).col(0);
    at_s.col(filled) = s.array().pow(-static_cast<double>(filled)).matrix();
  }
  if (shape.delayed) {
    // The derivative by the delay of what the input passes on at once is its slope, which a held input does not have.
    answers.col(filled).setZero();
    at_s.col(filled++) = s;
  }
  for (const PoleFactor& factor : shape.factors) {
    const Eigen::MatrixXcd of_factor = values_of(factor, s.array());
    answers.middleCols(filled, of_factor.cols()) = answers_of(response_, outputs_, factor, centre_, delay);
    at_s.middleCols(filled, of_factor.cols()) = of_factor;
    filled += of_factor.cols();
  }
  if (shape.delayed) {
    const Eigen::VectorXcd turn = (-shape.delay * s.array()).exp().matrix();
    at_s = turn.asDiagonal() * at_s;
  }
  Eigen::MatrixXd rows = real_rows(at_s);
  const Eigen::VectorXd length = rows.colwise().norm();
  rows *= length.cwiseInverse().asDiagonal();
  const Eigen::MatrixXd share = PivotedQr(rows, 1e-14).solve(real_rows(values));
  return answers * (length.cwiseInverse().asDiagonal() * share);
}

std::size_t RecordAnswers::free_motion_count(const RationalShape& shape) const {
  return step_ ? shape.poles() - shape.integrators : 0;
}

Eigen::MatrixXcd RecordAnswers::columns(const RationalShape& shape, const Eigen::VectorXcd& s,
                                        const Eigen::MatrixXcd& values) const {
  const auto faded = static_cast<Index>(free_motion_count(shape));
  Eigen::MatrixXcd result(outputs_, values.cols() + faded);
  if (shape.degree > shape.poles()) {
    result.setConstant(std::numeric_limits<double>::quiet_NaN());
    return result;
  }
  result.leftCols(values.cols()) = of(shape, s, values).cast<Complex>();
  if (!step_) return result;
  Index filled = values.cols();
  for (const PoleFactor& factor : shape.factors) {
    const Index count = factor.pair ? 2 : 1;
    result.middleCols(filled, count) = answers_of(*step_, outputs_, factor, centre_, 0).leftCols(count).cast<Complex>();
    result.col(filled).array() -= 1.0;  // the answer of 1/f to a step is 1 and a free motion
    filled += count;
  }
  return result;
}

Eigen::MatrixXcd RecordAnswers::derivatives(const RationalShape& shape, const Eigen::VectorXcd& s,
                                            const Eigen::MatrixXcd& values, const Eigen::VectorXd& coefficients) const {
  Eigen::MatrixXd result = of(shape, s, values);
  if (!step_) return result.cast<Complex>();
  Index filled = 0;
  Eigen::VectorXd amount = coefficients.tail(static_cast<Index>(free_motion_count(shape)));
  for (const PoleFactor& factor : shape.factors) {
    const double size = std::exp(factor.log_size) * centre_;
    if (factor.pair) {
      const Eigen::MatrixXd all = answer(*step_, outputs_, pole_pair(),
                                         {amount[filled], amount[filled + 1], size, 2 * std::sinh(factor.damping)});
      result.col(filled) += size * all.col(3);
      result.col(filled + 1) += 2 * std::cosh(factor.damping) * all.col(4);
    } else {
      const Eigen::MatrixXd all = answer(*step_, outputs_, single_pole(), {amount[filled], factor.sign * size});
      result.col(filled) += factor.sign * size * all.col(2);
    }
    filled += factor.pair ? 2 : 1;
  }
  return result.cast<Complex>();
}

}  // namespace frac::detail
