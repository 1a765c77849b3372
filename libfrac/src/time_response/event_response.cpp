// SPDX-License-Identifier: BSD-3-Clause
#include "event_response.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <numbers>
#include <utility>

#include "branch_cut.hpp"
#include "exponential_sum.hpp"
#include "exponential_terms.hpp"
#include "formula/power_sum.hpp"
#include "poles/laplace_image.hpp"
#include "sensitive_image.hpp"
#include "special/phi_functions.hpp"

namespace frac::detail {
namespace {

using Complex = std::complex<double>;
constexpr double pi = std::numbers::pi;
constexpr std::size_t most_integrators = 8;

// Instants closer than this are one.
double rounding_at(double t) {
  return 16 * std::numeric_limits<double>::epsilon() * std::abs(t);
}

// One row of one column or more.
Eigen::Array<Complex, 1, 1> row_of(Complex weight) {
  return Eigen::Array<Complex, 1, 1>(weight);
}
const ComplexRow& row_of(const ComplexRow& weight) {
  return weight;
}
Eigen::Array<double, 1, 1> row_of(double value) {
  return Eigen::Array<double, 1, 1>(value);
}
const RealRow& row_of(const RealRow& value) {
  return value;
}

using SensitiveTerms = std::vector<ExponentialTerm<ComplexRow>>;

// Nodes on a circle about each pole that the rule does not account for.  The circle is so small that e^{st} on it does
// not grow far beyond its value at the middle and decays about as fast.  Its radius is at most a quarter of the way to
// the next pole or node, so that n points leave an error of 4^-n.
void add_circles(const LaplaceImage& image, const CutRule& rule, SensitiveImage& sensitive, double latest,
                 double tolerance, SensitiveTerms& terms) {
  const int fewest = 2 * static_cast<int>(std::ceil(0.5 * std::log(1 / tolerance) / std::log(4.0)) + 2);
  for (std::size_t k = 0; k < image.poles().clusters.size(); ++k) {
    const RootCluster& pole = image.poles().clusters[k];
    const Complex middle_share = rule.share_of(pole);
    if (std::abs(middle_share) < 1e-3 * tolerance) continue;
    const bool shares = middle_share != 1.0;
    // Roots that coincide bring powers of t, which take more points.
    const int points = fewest + 6 * (pole.multiplicity - 1);
    const double lasting = std::max(1.5 / (std::exp(pole.log_s.real()) * latest), -0.25 * std::cos(pole.log_s.imag()));
    // The share of the rule is analytic up to its nodes.
    const double room = 0.25 * std::min({image.clearance(k), 1.0, 1.5 * pi - pole.log_s.imag(),
                                         shares ? rule.distance(pole.log_s) : 1.0});
    const double radius = std::max(std::min(room, lasting), 4 * pole.spread);
    for (int i = 0; i < (pole.is_conjugate ? points / 2 : points); ++i) {
      const Complex offset = std::polar(radius, 2 * pi * (i + 0.5) / points);
      const Complex share = shares ? rule.share(pole.log_s + offset) : 1.0;
      terms.push_back({rate_at(pole.log_s + offset), 2.0 / points * share * offset * sensitive(pole.log_s + offset)});
    }
  }
}

}  // namespace

// The model at one set of parameters, ready to be run over the events.  Rows of `weight`: real nodes, real parts of
// complex ones, their imaginary parts.
struct EventResponse::Plan {
  Eigen::Index real_count = 0;
  Eigen::Index complex_count = 0;
  std::vector<Complex> rate;  // real ones first
  // States that decay within the horizon take the input itself, the others its m-fold integral.
  std::vector<bool> is_direct;
  Eigen::MatrixXd weight;
  Eigen::MatrixXd constant;  // a row per derivative of the m-fold integral of the input, from the 0th
  Eigen::VectorXd motion;    // weights of the states in the output's rate of change; empty where it is not wanted
  double direct = 0;
  Eigen::RowVectorXd direct_by;
  std::size_t integrators = 0;
  std::size_t channels = 1;
  double delay = 0;
  std::vector<double> delay_slope;

  template <typename Weight, typename Value>
  void take(std::vector<ExponentialTerm<Weight>> terms, const std::vector<Value>& constants) {
    const auto complex_terms =
        std::stable_partition(terms.begin(), terms.end(), [](const auto& term) { return term.rate.imag() == 0; });
    real_count = complex_terms - terms.begin();
    complex_count = terms.end() - complex_terms;
    const Eigen::Index columns = row_of(constants.front()).size();
    weight.resize(real_count + 2 * complex_count, columns);
    if (!delay_slope.empty()) motion.resize(weight.rows());
    for (Eigen::Index i = 0; i < real_count + complex_count; ++i) {
      const ExponentialTerm<Weight>& term = terms[static_cast<std::size_t>(i)];
      rate.push_back(term.rate);
      is_direct.push_back(term.is_direct);
      const auto& row = row_of(term.weight);
      const Complex moved = row[0] * term.rate;
      weight.row(i) = row.real().matrix();
      if (!delay_slope.empty()) motion[i] = moved.real();
      if (i < real_count) continue;
      weight.row(i + complex_count) = -row.imag().matrix();
      if (!delay_slope.empty()) motion[i + complex_count] = -moved.imag();
    }
    constant.resize(static_cast<Eigen::Index>(constants.size()), columns);
    for (std::size_t j = 0; j < constants.size(); ++j) {
      constant.row(static_cast<Eigen::Index>(j)) = row_of(constants[j]).matrix();
    }
  }
};

EventResponse::EventResponse(std::vector<double> input_time, std::vector<double> input, Hold hold,
                             std::vector<double> output_time)
    : output_time_(std::move(output_time)) {
  double slope = 0;
  double value = 0;
  for (std::size_t n = 0; n < input.size(); ++n) {
    double next_slope = 0;
    if (hold == Hold::first_order && n + 1 < input.size()) {
      next_slope = (input[n + 1] - input[n]) / (input_time[n + 1] - input_time[n]);
    }
    const double jump = hold == Hold::zero_order || n == 0 ? input[n] - value : 0;
    if (jump != 0 || next_slope != slope || n == 0) knots_.push_back({input_time[n], jump, next_slope - slope});
    has_slopes_ = has_slopes_ || next_slope != 0;
    slope = next_slope;
    value = input[n];
  }
}

double EventResponse::shortest_lag(double delay) const {
  const double span = output_time_.back() - knots_.front().time;
  double shortest = span;
  std::size_t knot = 0;
  for (const double t : output_time_) {
    while (knot + 1 < knots_.size() && knots_[knot + 1].time + delay <= t + rounding_at(t)) ++knot;
    for (std::size_t k = knot + 1; k-- > 0;) {
      const double lag = t - knots_[k].time - delay;
      if (std::abs(lag) <= rounding_at(t)) continue;
      if (lag > 0) shortest = std::min(shortest, lag);
      break;
    }
  }
  return shortest;
}

std::optional<EventResponse::Plan> EventResponse::planned(double high_order, double low_order, double delay) const {
  if (high_order > 0 || !(low_order > -1.0 - static_cast<double>(most_integrators)) || !std::isfinite(delay) ||
      delay < 0) {
    return std::nullopt;
  }
  Plan plan;
  plan.delay = delay;
  plan.integrators = low_order <= -1 ? static_cast<std::size_t>(std::floor(-low_order)) : 0;
  plan.channels = plan.integrators + (has_slopes_ ? 2 : 1);
  return plan;
}

bool EventResponse::evaluate(const FractionalTransferFunction& model, double tolerance, Result& result) const {
  std::optional<Plan> planned_for = planned(order_at_infinity(model), order_at_origin(model), model.delay());
  if (!planned_for) return false;
  Plan& plan = *planned_for;
  if (order_at_infinity(model) == 0) {
    plan.direct = model.numerator().front().coefficient / model.denominator().front().coefficient;
  }
  plan.direct_by.setZero(0);
  const double latest = output_time_.back() - knots_.front().time - plan.delay;
  const auto rows = static_cast<Eigen::Index>(output_time_.size());
  if (!(latest > 0)) {
    result.value.setZero(rows);
    result.gradient.setZero(rows, 0);
    return true;
  }
  const LaplaceImage step(scaled(numerator_of(model), 1, static_cast<double>(plan.integrators)),
                          scaled(denominator_of(model), 1, 1));
  if (!step.poles().complete) return false;
  ExponentialSum sum = exponential_sum(step, shortest_lag(plan.delay), latest, tolerance, plan.integrators,
                                       plan.channels, FastTerms::direct);
  plan.take(std::move(sum.terms), sum.constants);
  run(plan, result);
  return result.value.allFinite();
}

bool EventResponse::evaluate(const RatioOfPowerSums& ratio, double tolerance, Result& result) const {
  const std::vector<PowerTerm> numerator = plain_terms(ratio.numerator);
  const std::vector<PowerTerm> denominator = plain_terms(ratio.denominator);
  if (numerator.empty() || denominator.empty()) return false;
  const double high_order = numerator.front().order - denominator.front().order;
  const double low_order = numerator.back().order - denominator.back().order;
  std::optional<Plan> planned_for = planned(high_order, low_order, ratio.delay);
  if (!planned_for) return false;
  Plan& plan = *planned_for;
  if (std::any_of(ratio.delay_slope.begin(), ratio.delay_slope.end(), [](double each) { return each != 0; })) {
    plan.delay_slope = ratio.delay_slope;
  }
  const auto m = static_cast<double>(plan.integrators);
  SensitiveImage sensitive(ratio, m);
  const Eigen::Index columns = sensitive.columns();
  plan.direct_by.setZero(columns - 1);
  if (high_order == 0) {
    const SensitiveTerm& top = ratio.numerator.front();
    const SensitiveTerm& bottom = ratio.denominator.front();
    plan.direct = top.coefficient / bottom.coefficient;
    for (Eigen::Index p = 0; p + 1 < columns; ++p) {
      const auto i = static_cast<std::size_t>(p);
      plan.direct_by[p] = (top.by_coefficient[i] - plan.direct * bottom.by_coefficient[i]) / bottom.coefficient;
    }
  }

  const double latest = output_time_.back() - knots_.front().time - ratio.delay;
  const auto rows = static_cast<Eigen::Index>(output_time_.size());
  if (!(latest > 0)) {
    result.value.setZero(rows);
    result.gradient.setZero(rows, columns - 1);
    return true;
  }
  const LaplaceImage image(scaled(numerator, 1, m), denominator);
  if (!image.poles().complete) return false;

  const CutRule rule(image, shortest_lag(ratio.delay), tolerance);
  const auto image_at = [&](Complex zeta) -> const ComplexRow& { return sensitive(zeta); };
  SensitiveTerms terms;
  add_circles(image, rule, sensitive, latest, tolerance, terms);
  const double largest =
      append_cut_terms(rule, image_at, latest, plan.integrators, image.lowest_noticed(latest, tolerance),
                       0.03 * rule.step() * tolerance, terms);
  if (!std::isfinite(largest)) return false;
  // Integrated again and again, fast terms would outgrow the response and cancel: see ExponentialSum.
  if (plan.integrators > 0) make_direct(terms, latest, plan.integrators);
  const auto constants = constants_of(terms, image_at, log_anchors(image, latest, plan.integrators + 1), &rule,
                                      1e-3 * rule.step() * tolerance * largest, plan.integrators, plan.channels);
  plan.take(std::move(terms), constants);
  run(plan, result);
  return result.value.allFinite() && result.gradient.allFinite();
}

namespace {

// What one gap without events does to the states: x <- e^z x + sum_i drive_i V_i, V_i the derivatives of the m-fold
// integral of the input at its start.
struct Gap {
  double length;
  Eigen::ArrayXd change_re, change_im;  // e^z - 1
  Eigen::ArrayXXd drive;                // a column per channel
};

}  // namespace

void EventResponse::run(const Plan& plan, Result& result) const {
  const Eigen::Index reals = plan.real_count;
  const Eigen::Index complexes = plan.complex_count;
  const Eigen::Index size = reals + 2 * complexes;
  const auto channels = static_cast<Eigen::Index>(plan.channels);
  const auto level = static_cast<Eigen::Index>(plan.integrators);

  std::vector<Complex> phis(plan.channels);
  const auto prepared = [&](double length) {
    Gap gap{length, Eigen::ArrayXd(reals + complexes), Eigen::ArrayXd(complexes),
            Eigen::ArrayXXd::Zero(size, channels)};
    for (Eigen::Index k = 0; k < reals + complexes; ++k) {
      const Complex z = plan.rate[static_cast<std::size_t>(k)] * length;
      const Complex change = k < reals ? Complex(std::expm1(z.real())) : expm1(z);
      gap.change_re[k] = change.real();
      if (k >= reals) gap.change_im[k - reals] = change.imag();
      if (channels > 1) phi(z, phis);
      const Eigen::Index first = plan.is_direct[static_cast<std::size_t>(k)] ? level : 0;
      double power = 1;
      for (Eigen::Index i = first; i < channels; ++i, power *= length) {
        const Complex drive = i == first ? change : power * z * phis[static_cast<std::size_t>(i - first)];
        gap.drive(k, i) = drive.real();
        if (k >= reals) gap.drive(k + complexes, i) = drive.imag();
      }
    }
    return gap;
  };
  double now = knots_.front().time + plan.delay;
  // Equal gaps, to rounding, are prepared once.
  constexpr std::size_t most_kept = 12;
  std::vector<Gap> kept;
  kept.reserve(most_kept);
  std::size_t oldest = 0;
  const auto gap_of = [&](double length) -> const Gap& {
    for (const Gap& gap : kept) {
      if (std::abs(gap.length - length) <= rounding_at(now + length)) return gap;
    }
    if (kept.size() < most_kept) {
      kept.push_back(prepared(length));
      return kept.back();
    }
    oldest = (oldest + 1) % most_kept;
    kept[oldest] = prepared(length);
    return kept[oldest];
  };

  Eigen::ArrayXd state = Eigen::ArrayXd::Zero(size);
  Eigen::ArrayXd input = Eigen::ArrayXd::Zero(channels);
  const auto advance = [&](double to) {
    if (to <= now) return;
    const double length = to - now;
    const Gap& gap = gap_of(length);
    now = to;
    if ((input == 0).all() && (state == 0).all()) return;
    state.head(reals) += gap.change_re.head(reals) * state.head(reals);
    if (complexes > 0) {
      const auto change_re = gap.change_re.tail(complexes);
      auto re = state.segment(reals, complexes);
      auto im = state.tail(complexes);
      const Eigen::ArrayXd previous = re;
      re += change_re * previous - gap.change_im * im;
      im += gap.change_im * previous + change_re * im;
    }
    for (Eigen::Index i = 0; i < channels; ++i) {
      if (input[i] != 0) state += input[i] * gap.drive.col(i);
    }
    for (Eigen::Index i = 0; i < channels; ++i) {
      double factor = 1;
      for (Eigen::Index j = i + 1; j < channels; ++j) {
        factor *= length / static_cast<double>(j - i);
        input[i] += factor * input[j];
      }
    }
  };
  const auto apply = [&](const Knot& knot) {
    input[level] += knot.jump;
    if (level + 1 < channels) input[level + 1] += knot.slope;
  };

  const auto rows = static_cast<Eigen::Index>(output_time_.size());
  const Eigen::Index columns = plan.weight.cols();
  result.value.resize(rows);
  result.gradient.resize(rows, columns - 1);
  // States are turned into outputs a few hundred instants at a time.
  constexpr Eigen::Index most_buffered = 512;
  const Eigen::Index buffered = std::min(rows, most_buffered);
  Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> states(buffered, size);
  Eigen::MatrixXd inputs(buffered, channels);
  Eigen::VectorXd jumps(buffered);
  const auto flush = [&](Eigen::Index first, Eigen::Index count) {
    const auto x = states.topRows(count);
    const auto v = inputs.topRows(count);
    const auto jump = jumps.head(count);
    auto value = result.value.segment(first, count);
    auto gradient = result.gradient.middleRows(first, count);
    value.noalias() = x * plan.weight.col(0);
    value.noalias() += v * plan.constant.col(0);
    value += plan.direct * jump;
    gradient.noalias() = x * plan.weight.rightCols(columns - 1);
    gradient.noalias() += v * plan.constant.rightCols(columns - 1);
    gradient.noalias() += jump * plan.direct_by;
    if (plan.delay_slope.empty()) return;
    // d/dt of each state is rate (state + what it takes).
    Eigen::VectorXd motion = x * plan.motion;
    for (Eigen::Index k = 0; k < reals + complexes; ++k) {
      motion += plan.motion[k] * v.col(plan.is_direct[static_cast<std::size_t>(k)] ? level : 0);
    }
    for (Eigen::Index j = 0; j + 1 < channels; ++j) motion += plan.constant(j, 0) * v.col(j + 1);
    for (Eigen::Index p = 0; p + 1 < columns; ++p) {
      gradient.col(p) -= plan.delay_slope[static_cast<std::size_t>(p)] * motion;
    }
  };
  std::size_t next = 0;
  for (Eigen::Index n = 0; n < rows; ++n) {
    const double t = output_time_[static_cast<std::size_t>(n)];
    const auto at = [&] { return knots_[next].time + plan.delay; };
    while (next < knots_.size() && at() < t - rounding_at(t)) {
      advance(at());
      apply(knots_[next++]);
    }
    const bool on_knot = next < knots_.size() && at() <= t + rounding_at(t);
    advance(t);
    const Eigen::Index row = n % most_buffered;
    states.row(row) = state.matrix();
    inputs.row(row) = input.matrix();
    jumps[row] = 0;
    if (on_knot) {
      jumps[row] = knots_[next].jump;
      apply(knots_[next++]);
    }
    if (row + 1 == most_buffered || n + 1 == rows) flush(n - row, row + 1);
  }
}

}  // namespace frac::detail
