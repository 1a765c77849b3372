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
#include "identification/time_noise.hpp"
#include "rational_problem.hpp"

namespace frac::detail {
namespace {

using Complex = std::complex<double>;
using Index = Eigen::Index;

constexpr double tolerance = 1e-10;  // of simulations; residuals of 1e-9 are none

/// What parts of a model are driven by.
template <class Response>
struct Drive {
  const Response& response;
  Index outputs;
};

/// A part of a model as a formula; the letters of its parameters stand in the order of their values.
struct Part {
  Part(const std::string& formula, std::string letters)
      : prompt(formula), delayed("exp(-L s) (" + formula + ")"), names(std::move(letters)) {}
  Structure prompt, delayed;
  std::string names;
};

/// Over the denominator k s^a + 1, or m s^(2a) + n s^a + 1 of a pair.
const Part& part_of(bool pair, bool free_order) {
  static const std::array<Part, 4> parts{Part("b/(k s + 1)", "bk"), Part("b/(k s^a + 1)", "bka"),
                                         Part("(b + c s)/(m s^2 + n s + 1)", "bcmn"),
                                         Part("(b + c s^a)/(m s^(2 a) + n s^a + 1)", "bcmna")};
  return parts[(pair ? 2u : 0u) + (free_order ? 1u : 0u)];
}

/// What a part answers, and with `sensitivity` the derivatives by its parameters in their order and by the delay; not
/// finite where it outgrows a double.
template <class Response>
Eigen::MatrixXd answer(const Drive<Response>& drive, const Part& part, const std::vector<double>& values,
                       std::optional<double> delay, Sensitivity sensitivity) {
  const Structure& structure = delay ? part.delayed : part.prompt;
  std::vector<std::size_t> order;
  for (const char letter : part.names) order.push_back(structure.parameter_index(std::string(1, letter)));
  if (delay) order.push_back(structure.parameter_index("L"));
  std::vector<double> parameters(order.size());
  for (std::size_t i = 0; i < order.size(); ++i) parameters[order[i]] = i < values.size() ? values[i] : *delay;
  if (sensitivity == Sensitivity::none) order.clear();
  Eigen::MatrixXd result = Eigen::MatrixXd::Constant(drive.outputs, 1 + static_cast<Index>(order.size()),
                                                     std::numeric_limits<double>::quiet_NaN());
  const std::optional<RatioOfPowerSums> ratio = ratio_at(structure, parameters, sensitivity);
  EventResponse::Result found;
  if (!ratio || !drive.response.evaluate(*ratio, tolerance, found)) return result;
  result.col(0) = found.value;
  for (std::size_t i = 0; i < order.size(); ++i)
    result.col(1 + static_cast<Index>(i)) = found.gradient.col(static_cast<Index>(order[i]));
  return result;
}

/// A factor of the denominator of a shape in rad/s.
struct Section {
  Section(const RationalShape& shape, const PoleFactor& factor, double centre)
      : pair(factor.pair),
        free_order(shape.searches_order()),
        order(shape.order),
        log_size(factor.log_size + std::log(centre)),
        in_z(std::exp(-order * log_size)),
        first(pair ? in_z * in_z : factor.sign * in_z),
        second(2 * std::sinh(factor.damping) * in_z) {}

  /// (b + c s^a) over the factor.
  template <class Response>
  [[nodiscard]] Eigen::MatrixXd over(const Drive<Response>& drive, double b, double c, std::optional<double> delay,
                                     Sensitivity sensitivity) const {
    std::vector<double> values = pair ? std::vector{b, c, first, second} : std::vector{b, first};
    if (free_order) values.push_back(order);
    return answer(drive, part_of(pair, free_order), values, delay, sensitivity);
  }

  bool pair, free_order;
  double order, log_size;
  double in_z;           // (1/size)^order
  double first, second;  // k, or m and n
};

/// Columns side by side.
class Columns {
 public:
  Columns(Index rows, Index count) : columns_(rows, count) {}
  template <class Column>
  void add(const Column& column) {
    columns_.col(filled_++) = column;
  }
  [[nodiscard]] Eigen::MatrixXcd taken() { return columns_.leftCols(filled_); }

 private:
  Eigen::MatrixXcd columns_;
  Index filled_ = 0;
};

/// The parts that a shape consists of, each at s and as it is answered: 1, powers of 1/z = s^-a, 1/f of each factor f
/// of the denominator and z/f of a pair, and with `sensitivity` what derivatives of such sums consist of besides.
struct Parts {
  Columns values, answers;
  Sensitivity sensitivity;

  template <class Value, class Answer>
  void add(const Value& value, const Answer& answered) {
    values.add(value.matrix());
    answers.add(answered.template cast<Complex>());
  }
};

void add_integrators(const RationalShape& shape, const Eigen::ArrayXcd& log_s, const Drive<RecordResponse>& drive,
                     std::optional<double> delay, Parts& parts) {
  const bool free_order = shape.searches_order();
  for (std::size_t k = 0; k <= shape.integrators; ++k) {
    const auto power = static_cast<double>(k);
    const std::string exponent = std::to_string(k) + (free_order ? " a" : "");
    const Part part(k == 0 ? "b" : "b/s^(" + exponent + ")", k > 0 && free_order ? "ba" : "b");
    const Eigen::MatrixXd all = answer(
        drive, part, k > 0 && free_order ? std::vector{1.0, shape.order} : std::vector{1.0}, delay, parts.sensitivity);
    const Eigen::ArrayXcd value = (-power * shape.order * log_s).exp();
    parts.add(value, all.col(0));
    if (parts.sensitivity == Sensitivity::none) continue;
    if (k > 0 && free_order) parts.add(-power * log_s * value, all.col(2));
    // What the input passes on at once answers a change of the delay by the slope of the input, which is held.
    const double held = k > 0 ? 1 : 0;
    if (delay) parts.add(-log_s.exp() * value, held * all.rightCols(1));
  }
}

void add_section(const Section& section, const Eigen::ArrayXcd& log_s, const Drive<RecordResponse>& drive,
                 std::optional<double> delay, Parts& parts) {
  const Eigen::ArrayXcd z = section.in_z * (section.order * log_s).exp();
  // Of a pair the derivative by c is z/f.
  const Sensitivity sensitivity = section.pair ? Sensitivity::all : parts.sensitivity;
  const Eigen::MatrixXd all = section.over(drive, 1, 0, delay, sensitivity);
  const Eigen::ArrayXcd linear = (section.pair ? section.second : section.first) / section.in_z * z;
  const Eigen::ArrayXcd f = section.pair ? Eigen::ArrayXcd((z * z + linear + 1.0).inverse()) : (linear + 1.0).inverse();
  parts.add(f, all.col(0));
  if (section.pair) parts.add(z * f, section.in_z * all.col(2));
  if (parts.sensitivity == Sensitivity::none) return;
  const Eigen::ArrayXcd by_power = (section.pair ? Eigen::ArrayXcd(2.0 * z * z + linear) : linear) * -f;
  if (section.pair) {
    parts.add(-z * z * f * f, section.first * all.col(3));
    parts.add(-z * f * f, section.in_z * all.col(4));
  } else {
    parts.add(by_power * f, section.first * all.col(2));
  }
  if (section.free_order) parts.add(by_power * log_s * f, all.col(section.pair ? 5 : 3));
  if (delay) parts.add(-log_s.exp() * f, all.rightCols(1));
  if (!section.pair || (!section.free_order && !delay)) return;
  const Eigen::MatrixXd rising = section.over(drive, 0, section.in_z, delay, sensitivity);
  if (section.free_order) parts.add((1.0 + by_power) * log_s * z * f, rising.col(5));
  if (delay) parts.add(-log_s.exp() * z * f, rising.rightCols(1));
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
                  std::numbers::pi * static_cast<double>(data.size()) / length,
                  noise_is_open(options)};
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

Eigen::MatrixXd RecordAnswers::of(const RationalShape& shape, const Eigen::VectorXcd& log_s,
                                  const Eigen::MatrixXcd& values, Sensitivity sensitivity) const {
  const Eigen::ArrayXcd log_omega = log_s.array() + std::log(centre_);
  const std::optional<double> delay = shape.delayed ? std::optional(shape.delay / centre_) : std::nullopt;
  const auto most = static_cast<Index>(4 * (shape.poles() + 1));
  Parts parts{Columns(log_s.size(), most), Columns(outputs_, most), sensitivity};
  const Drive<RecordResponse> drive{response_, outputs_};
  add_integrators(shape, log_omega, drive, delay, parts);
  for (const PoleFactor& factor : shape.factors)
    add_section(Section(shape, factor, centre_), log_omega, drive, delay, parts);
  Eigen::MatrixXcd at_s = parts.values.taken();
  if (shape.delayed) {
    const Eigen::VectorXcd turn = (-*delay * log_omega.exp()).exp().matrix();
    at_s = turn.asDiagonal() * at_s;
  }
  Eigen::MatrixXd rows = real_rows(at_s);
  const Eigen::VectorXd length = rows.colwise().norm();
  rows *= length.cwiseInverse().asDiagonal();
  const Eigen::MatrixXd wanted = real_rows(values), share = PivotedQr(rows, 1e-14).solve(wanted);
  // Where poles coincide that are no pair, the parts do not span what the shape does.
  const bool spanned = (rows * share - wanted).norm() <= 1e-7 * wanted.norm();
  if (!spanned) return Eigen::MatrixXd::Constant(outputs_, values.cols(), std::numeric_limits<double>::quiet_NaN());
  return parts.answers.taken().real() * (length.cwiseInverse().asDiagonal() * share);
}

std::size_t RecordAnswers::free_motion_count(const RationalShape& shape) const {
  return step_ ? shape.poles() - shape.integrators : 0;
}

Eigen::MatrixXcd RecordAnswers::columns(const RationalShape& shape, const Eigen::VectorXcd& log_s,
                                        const Eigen::MatrixXcd& values) const {
  const auto faded = static_cast<Index>(free_motion_count(shape));
  Eigen::MatrixXcd result(outputs_, values.cols() + faded);
  if (shape.degree > shape.poles()) {
    result.setConstant(std::numeric_limits<double>::quiet_NaN());
    return result;
  }
  result.leftCols(values.cols()) = of(shape, log_s, values, Sensitivity::none).cast<Complex>();
  if (!step_) return result;
  const Drive<EventResponse> step{*step_, outputs_};
  Index filled = values.cols();
  for (const PoleFactor& factor : shape.factors) {
    const Section section(shape, factor, centre_);
    const Eigen::MatrixXd all = section.over(step, 1, 0, {}, Sensitivity::all);
    // The answer of 1/f to a step is 1 and a free motion.
    result.col(filled++) = (all.col(0).array() - 1.0).cast<Complex>();
    if (factor.pair) result.col(filled++) = (section.in_z * all.col(2)).cast<Complex>();
  }
  return result;
}

Eigen::MatrixXcd RecordAnswers::derivatives(const RationalShape& shape, const Eigen::VectorXcd& log_s,
                                            const Eigen::MatrixXcd& values, const Eigen::VectorXd& coefficients) const {
  Eigen::MatrixXd result = of(shape, log_s, values, Sensitivity::all);
  if (!step_) return result.cast<Complex>();
  const Drive<EventResponse> step{*step_, outputs_};
  Index filled = 0;
  const Eigen::VectorXd amount = coefficients.tail(static_cast<Index>(free_motion_count(shape)));
  for (const PoleFactor& factor : shape.factors) {
    const Section section(shape, factor, centre_);
    const double c = factor.pair ? section.in_z * amount[filled + 1] : 0;
    const Eigen::MatrixXd all = section.over(step, amount[filled], c, {}, Sensitivity::all);
    const Eigen::VectorXd by_log_z =
        factor.pair ? Eigen::VectorXd(c * all.col(2) + 2 * section.first * all.col(3) + section.second * all.col(4))
                    : Eigen::VectorXd(section.first * all.col(2));
    result.col(filled) -= section.order * by_log_z;
    if (section.free_order) result.rightCols(1) += all.rightCols(1) - section.log_size * by_log_z;
    if (factor.pair) result.col(filled + 1) += 2 * std::cosh(factor.damping) * section.in_z * all.col(4);
    filled += factor.pair ? 2 : 1;
  }
  return result.cast<Complex>();
}

}  // namespace frac::detail
