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
#include "identification/data/fit_data.hpp"
#include "rational_problem.hpp"

namespace frac::detail {
namespace {

using Complex = std::complex<double>;
using Index = Eigen::Index;

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
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
  Eigen::MatrixXd result = Eigen::MatrixXd::Constant(drive.outputs, 1 + static_cast<Index>(order.size()), nan);
  EventResponse::Result found;
  try {
    if (!drive.response.evaluate(reduce(structure.expression(), parameters, sensitivity), tolerance, found))
      return result;
  } catch (const std::invalid_argument&) {
    return result;
  }
  result.col(0) = found.value;
  for (std::size_t i = 0; i < order.size(); ++i)
    result.col(1 + static_cast<Index>(i)) = found.gradient.col(static_cast<Index>(order[i]));
  return result;
}

Eigen::MatrixXd real_rows(const Eigen::MatrixXcd& values) {
  Eigen::MatrixXd rows(2 * values.rows(), values.cols());
  rows << values.real(), values.imag();
  return rows;
}

/// The answer of (b + c z)/f for a factor f, of its parts, and its derivatives by what acts nonlinearly.
struct Change {
  Eigen::VectorXd over_f, z_over_f;
  Eigen::VectorXd by_size, by_damping, by_order, by_delay;
};

/// A factor of the denominator of a shape, in rad/s.
struct Section {
  Section(const RationalShape& shape, const PoleFactor& factor, double centre)
      : pair(factor.pair),
        free_order(shape.searches_order()),
        order(shape.order),
        log_size(factor.log_size + std::log(centre)),
        in_z(std::exp(-order * log_size)),
        first(pair ? in_z * in_z : factor.sign * in_z),
        second(2 * std::sinh(factor.damping) * in_z),
        by_damping(2 * std::cosh(factor.damping) * in_z) {}

  /// (b + c z)/f, z = (s/size)^order.
  template <class Response>
  [[nodiscard]] Eigen::MatrixXd answered(const Drive<Response>& drive, double b, double c, std::optional<double> delay,
                                         Sensitivity sensitivity) const {
    std::vector<double> values = pair ? std::vector{b, c * in_z, first, second} : std::vector{b, first};
    if (free_order) values.push_back(order);
    return answer(drive, part_of(pair, free_order), values, delay, sensitivity);
  }
  /// 1/f, and z/f of a pair.
  template <class Response>
  [[nodiscard]] Eigen::MatrixXd parts(const Drive<Response>& drive, std::optional<double> delay) const {
    if (!pair) return answered(drive, 1, 0, delay, Sensitivity::none);
    const Eigen::MatrixXd all = answered(drive, 1, 0, delay, Sensitivity::all);
    Eigen::MatrixXd result(all.rows(), 2);
    result << all.col(0), in_z * all.col(2);
    return result;
  }
  template <class Response>
  [[nodiscard]] Change change(const Drive<Response>& drive, double b, double c, std::optional<double> delay) const {
    // Of nothing there is no answer, and the derivatives are 0.
    const bool nothing = b == 0 && c == 0;
    Eigen::MatrixXd all = answered(drive, nothing ? 1 : b, c, delay, Sensitivity::all);
    Change result{all.col(1), {}, {}, {}, {}, {}};
    if (pair) result.z_over_f = in_z * all.col(2);
    if (nothing) all.setZero();
    Eigen::VectorXd by_log_z = first * all.col(2);
    if (pair) {
      by_log_z = c * result.z_over_f + 2 * first * all.col(3) + second * all.col(4);
      result.by_damping = by_damping * all.col(4);
    }
    result.by_size = -order * by_log_z;
    if (free_order) result.by_order = all.col(pair ? 5 : 3) - log_size * by_log_z;
    if (delay) result.by_delay = all.rightCols(1);
    return result;
  }

  bool pair, free_order;
  double order, log_size;
  double in_z;           // (1/size)^order
  double first, second;  // k, or m and n
  double by_damping;     // of n
};

/// The parts that a ratio consists of: 1, powers of s^-order, 1/f of each factor f of the denominator and z/f of a
/// pair. Any numerator gives one combination of them, which least squares at s tell to rounding.
class Parts {
 public:
  /// @param log_s  s in rad/s
  Parts(const RationalShape& shape, const Eigen::ArrayXcd& log_s, double centre)
      : shape_(shape), log_s_(log_s), turn_(Eigen::VectorXcd::Ones(log_s.size())) {
    for (const PoleFactor& factor : shape.factors) sections_.emplace_back(shape, factor, centre);
    values_.resize(log_s.size(), static_cast<Index>(shape.poles()) + 1);
    Index filled = 0;
    for (std::size_t k = 0; k <= shape.integrators; ++k)
      values_.col(filled++) = (-static_cast<double>(k) * shape.order * log_s).exp().matrix();
    for (const Section& section : sections_) {
      z_.push_back(section.in_z * (shape.order * log_s).exp());
      linear_.push_back((section.pair ? section.second : section.first) / section.in_z * z_.back());
      const Eigen::ArrayXcd f = linear_.back() + 1.0;
      inverse_.push_back(section.pair ? Eigen::ArrayXcd((f + z_.back().square()).inverse()) : f.inverse());
      values_.col(filled++) = inverse_.back().matrix();
      if (section.pair) values_.col(filled++) = (z_.back() * inverse_.back()).matrix();
    }
    if (shape.delayed) {
      delay_ = shape.delay / centre;
      turn_ = (-*delay_ * log_s.exp()).exp().matrix();
      values_ = turn_.asDiagonal() * values_;
    }
    rows_ = real_rows(values_);
    length_ = rows_.colwise().norm();
    rows_ *= length_.cwiseInverse().asDiagonal();
    factors_.emplace(rows_, 1e-14);
  }

  [[nodiscard]] const std::vector<Section>& sections() const { return sections_; }
  [[nodiscard]] std::optional<double> delay() const { return delay_; }

  /// The combinations that functions with their values at s are.  Not finite where the parts do not span one: poles
  /// coincide that are no pair.
  /// @param size  beside which rounding is none
  [[nodiscard]] Eigen::MatrixXd shares(const Eigen::MatrixXcd& functions, double size) const {
    const Eigen::MatrixXd wanted = real_rows(functions), share = factors_->solve(wanted);
    const bool spanned = (rows_ * share - wanted).norm() <= 1e-7 * size;
    if (!spanned) return Eigen::MatrixXd::Constant(share.rows(), share.cols(), nan);
    return length_.cwiseInverse().asDiagonal() * share;
  }

  /// Derivatives of a combination at s by sizes, dampings, dead time and order; nothing by the dead time.
  [[nodiscard]] Eigen::MatrixXcd changes(const Eigen::VectorXd& share) const {
    Eigen::MatrixXcd result = Eigen::MatrixXcd::Zero(log_s_.size(), static_cast<Index>(shape_.nonlinear()));
    Eigen::ArrayXcd by_order = Eigen::ArrayXcd::Zero(log_s_.size());
    for (std::size_t k = 1; k <= shape_.integrators; ++k) {
      const auto power = static_cast<double>(k);
      by_order -= share[static_cast<Index>(k)] * power * log_s_ * (-power * shape_.order * log_s_).exp();
    }
    Index filled = 0, at = static_cast<Index>(shape_.integrators) + 1;
    for (std::size_t i = 0; i < sections_.size(); ++i) {
      const Section& section = sections_[i];
      const Eigen::ArrayXcd &z = z_[i], &inverse = inverse_[i];
      const double b = share[at++], c = section.pair ? share[at++] : 0;
      const Eigen::ArrayXcd sum = (b + c * z) * inverse.square();
      const Eigen::ArrayXcd by_log_z =
          section.pair ? Eigen::ArrayXcd(c * z * inverse - sum * (2 * z.square() + linear_[i])) : -sum * linear_[i];
      result.col(filled++) = (-section.order * by_log_z).matrix();
      if (section.pair) result.col(filled++) = (-section.by_damping / section.in_z * sum * z).matrix();
      by_order += by_log_z * (log_s_ - section.log_size);
    }
    if (shape_.searches_order()) result.rightCols(1) = by_order.matrix();
    return turn_.asDiagonal() * result;
  }

 private:
  const RationalShape& shape_;
  Eigen::ArrayXcd log_s_;
  Eigen::VectorXcd turn_;  // by the dead time
  std::optional<double> delay_;
  std::vector<Section> sections_;
  std::vector<Eigen::ArrayXcd> z_, linear_, inverse_;  // (s/size)^order, what a factor has beside 1 and z^2, 1/f
  Eigen::MatrixXcd values_;
  Eigen::MatrixXd rows_;
  Eigen::VectorXd length_;
  std::optional<PivotedQr> factors_;
};

/// s^(-k order), k from 0 on.
Eigen::MatrixXd integrated(const RationalShape& shape, std::size_t k, const Drive<RecordResponse>& drive,
                           std::optional<double> delay, Sensitivity sensitivity) {
  const bool free_order = k > 0 && shape.searches_order();
  const std::string power = std::to_string(k) + (free_order ? " a" : "");
  const Part part(k == 0 ? "b" : "b/s^(" + power + ")", free_order ? "ba" : "b");
  return answer(drive, part, free_order ? std::vector{1, shape.order} : std::vector{1.0}, delay, sensitivity);
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
                observed(data, data.time()));
}

std::size_t RecordAnswers::free_motion_count(const RationalShape& shape) const {
  return step_ ? shape.poles() - shape.integrators : 0;
}

Eigen::MatrixXcd RecordAnswers::columns(const RationalShape& shape, const Eigen::VectorXcd& log_s,
                                        const Eigen::MatrixXcd& values) const {
  const auto faded = static_cast<Index>(free_motion_count(shape));
  Eigen::MatrixXcd result(outputs_, values.cols() + faded);
  if (shape.degree > shape.poles()) {
    result.setConstant(nan);
    return result;
  }
  const Drive<RecordResponse> drive{response_, outputs_};
  const Parts parts(shape, log_s.array() + std::log(centre_), centre_);
  Eigen::MatrixXd answers(outputs_, static_cast<Index>(shape.poles()) + 1);
  Index filled = 0;
  for (std::size_t k = 0; k <= shape.integrators; ++k)
    answers.col(filled++) = integrated(shape, k, drive, parts.delay(), Sensitivity::none);
  for (const Section& section : parts.sections()) {
    const Eigen::MatrixXd of_section = section.parts(drive, parts.delay());
    answers.middleCols(filled, of_section.cols()) = of_section;
    filled += of_section.cols();
  }
  result.leftCols(values.cols()) = (answers * parts.shares(values, values.norm())).cast<Complex>();
  if (!step_) return result;
  const Drive<EventResponse> step{*step_, outputs_};
  filled = values.cols();
  for (const Section& section : parts.sections()) {
    Eigen::MatrixXd of_section = section.parts(step, {});
    of_section.col(0).array() -= 1;  // the answer of 1/f to a step is 1 and a free motion
    result.middleCols(filled, of_section.cols()) = of_section.cast<Complex>();
    filled += of_section.cols();
  }
  return result;
}

Eigen::MatrixXcd RecordAnswers::derivatives(const RationalShape& shape, const Eigen::VectorXcd& log_s,
                                            const Eigen::VectorXcd& model, const Eigen::MatrixXcd& values,
                                            const Eigen::VectorXd& coefficients) const {
  const Drive<RecordResponse> drive{response_, outputs_};
  const Parts parts(shape, log_s.array() + std::log(centre_), centre_);
  const Eigen::VectorXd share = parts.shares(model, model.norm());
  // With the coefficients of the numerator held, those of the parts move too.
  const auto by_delay = static_cast<Index>(shape.nonlinear()) - (shape.searches_order() ? 2 : 1);
  Eigen::MatrixXcd rest = values - parts.changes(share);
  if (shape.delayed) rest.col(by_delay).setZero();
  const Eigen::MatrixXd moved = parts.shares(rest, values.norm());

  Eigen::MatrixXd result = Eigen::MatrixXd::Zero(outputs_, static_cast<Index>(shape.nonlinear()));
  Index at = 0;
  for (std::size_t k = 0; k <= shape.integrators; ++k, ++at) {
    const Eigen::MatrixXd all = integrated(shape, k, drive, parts.delay(), Sensitivity::all);
    result += all.col(1) * moved.row(at);
    if (k == 0)
      continue;  // what passes at once answers a change of the dead time by the slope of the input: it is held
    if (shape.searches_order()) result.rightCols(1) += share[at] * all.col(2);
    if (parts.delay()) result.col(by_delay) += share[at] / centre_ * all.rightCols(1);
  }
  const std::optional<Drive<EventResponse>> step =
      step_ ? std::optional(Drive<EventResponse>{*step_, outputs_}) : std::nullopt;
  Index filled = 0, faded = coefficients.size() - static_cast<Index>(free_motion_count(shape));
  for (const Section& section : parts.sections()) {
    const auto add = [&](const Change& change) {
      result.col(filled) += change.by_size;
      if (section.pair) result.col(filled + 1) += change.by_damping;
      if (section.free_order) result.rightCols(1) += change.by_order;
    };
    const Change change = section.change(drive, share[at], section.pair ? share[at + 1] : 0, parts.delay());
    add(change);
    if (parts.delay()) result.col(by_delay) += change.by_delay / centre_;
    result += change.over_f * moved.row(at++);
    if (section.pair) result += change.z_over_f * moved.row(at++);
    if (step) {
      add(section.change(*step, coefficients[faded], section.pair ? coefficients[faded + 1] : 0, {}));
      faded += section.pair ? 2 : 1;
    }
    filled += section.pair ? 2 : 1;
  }
  return result.cast<Complex>();
}

}  // namespace frac::detail
