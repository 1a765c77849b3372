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
#include "formula/power_sum.hpp"
#include "poles/laplace_image.hpp"
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

// Value in column 0, derivative by parameter p in column 1 + p.
using ComplexRow = Eigen::Array<Complex, 1, Eigen::Dynamic>;

// N/D and its derivatives at s = e^zeta, any sheet.
class SensitiveImage {
 public:
  SensitiveImage(const RatioOfPowerSums& ratio, double extra_order)
      : top_(ratio.numerator), bottom_(ratio.denominator), extra_order_(extra_order) {}

  [[nodiscard]] Eigen::Index columns() const {
    return 1 + static_cast<Eigen::Index>(bottom_.terms.front().by_coefficient.size());
  }

  void evaluate(Complex zeta, ComplexRow& row) {
    top_.evaluate(zeta);
    bottom_.evaluate(zeta);
    const Complex factor = std::exp(top_.scale - bottom_.scale + extra_order_ * zeta) / bottom_.sum[0];
    row = factor * top_.sum;
    for (Eigen::Index p = 1; p < row.size(); ++p) row[p] -= row[0] * bottom_.sum[p] / bottom_.sum[0];
  }

 private:
  struct Sum {
    explicit Sum(const SensitiveSum& terms_) : terms(terms_) {
      for (const SensitiveTerm& term : terms) {
        double size = std::abs(term.coefficient);
        if (size == 0) {
          for (const double slope : term.by_coefficient) size = std::max(size, std::abs(slope));
        }
        log_size.push_back(std::log(size));
      }
      phase.resize(terms.size());
      sum.resize(1 + static_cast<Eigen::Index>(terms.front().by_coefficient.size()));
    }
    void evaluate(Complex zeta) {
      if (zeta.imag() != angle) {
        angle = zeta.imag();
        for (std::size_t i = 0; i < terms.size(); ++i) phase[i] = std::polar(1.0, terms[i].order * angle);
      }
      scale = -std::numeric_limits<double>::infinity();
      for (std::size_t i = 0; i < terms.size(); ++i) {
        scale = std::max(scale, log_size[i] + terms[i].order * zeta.real());
      }
      sum.setZero();
      for (std::size_t i = 0; i < terms.size(); ++i) {
        const SensitiveTerm& term = terms[i];
        const Complex power = std::exp(term.order * zeta.real() - scale) * phase[i];
        sum[0] += term.coefficient * power;
        for (std::size_t p = 0; p < term.by_coefficient.size(); ++p) {
          if (term.by_coefficient[p] == 0 && term.by_order[p] == 0) continue;
          sum[static_cast<Eigen::Index>(1 + p)] += (term.by_coefficient[p] + term.by_order[p] * zeta) * power;
        }
      }
    }
    const SensitiveSum& terms;
    std::vector<double> log_size;
    double angle = std::numeric_limits<double>::quiet_NaN();
    std::vector<Complex> phase;
    ComplexRow sum;  // both divided by e^scale
    double scale = 0;
  };
  Sum top_, bottom_;
  double extra_order_;
};

struct QuadratureNode {
  Complex zeta;
  Complex factor;  // weight over H
};

// Nodes on a circle about each pole that the rule does not account for.  The circle is so small that e^{st} on it does
// not grow far beyond its value at the middle and decays about as fast.  Its radius is at most a quarter of the way to
// the next pole or node, so that n points leave an error of 4^-n.
void add_circles(const LaplaceImage& image, const CutRule& rule, double latest, double tolerance,
                 std::vector<QuadratureNode>& nodes) {
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
      nodes.push_back({pole.log_s + offset, 2.0 / points * share * offset});
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
  // Those that decay within the horizon take the input itself, the others its m-fold integral.
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
  plan.constant = Eigen::Map<const Eigen::VectorXd>(sum.constants.data(), static_cast<Eigen::Index>(plan.channels));
  const auto complex_terms = std::stable_partition(sum.terms.begin(), sum.terms.end(),
                                                   [](const Exponential& term) { return term.rate.imag() == 0; });
  plan.real_count = complex_terms - sum.terms.begin();
  plan.complex_count = sum.terms.end() - complex_terms;
  plan.weight.resize(plan.real_count + 2 * plan.complex_count, 1);
  for (Eigen::Index i = 0; i < plan.real_count + plan.complex_count; ++i) {
    const Exponential& term = sum.terms[static_cast<std::size_t>(i)];
    plan.rate.push_back(term.rate);
    plan.is_direct.push_back(term.is_direct);
    plan.weight(i, 0) = term.weight.real();
    if (i >= plan.real_count) plan.weight(i + plan.complex_count, 0) = -term.weight.imag();
  }
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
  std::vector<QuadratureNode> nodes;
  add_circles(image, rule, latest, tolerance, nodes);
  const double step = rule.step();
  const double lowest = image.lowest_noticed(latest, tolerance);
  const Complex cut_factor(0, -step / pi);

  const auto rate_of = [&](Complex zeta) {
    return zeta.imag() == pi ? Complex(-std::exp(zeta.real())) : std::exp(zeta);
  };
  ComplexRow row(columns);
  std::vector<ComplexRow> weights;
  for (const QuadratureNode& node : nodes) {
    sensitive.evaluate(node.zeta, row);
    weights.push_back(node.factor * row);
  }
  double largest = 0;
  for (int k = 0; k < 100'000; ++k) {
    nodes.push_back({rule.node(k), cut_factor});
    sensitive.evaluate(nodes.back().zeta, row);
    weights.push_back(cut_factor * row);
    const double log_r = nodes.back().zeta.real();
    const double own = effect(std::abs(weights.back()[0]), std::exp(log_r), latest, plan.integrators);
    largest = std::max(largest, own);
    if (!std::isfinite(own)) return false;
    if (log_r < lowest && own < 0.03 * step * tolerance * largest) break;
  }

  // Integrated again and again, fast terms would outgrow the response and cancel: see ExponentialSum.
  std::vector<bool> is_direct(nodes.size(), false);
  for (std::size_t k = 0; plan.integrators > 0 && k < nodes.size(); ++k) {
    const Complex r = rate_of(nodes[k].zeta);
    is_direct[k] = std::abs(r) * latest > 2;
    if (is_direct[k]) weights[k] /= std::pow(r, static_cast<int>(plan.integrators));
  }
  const std::size_t anchored = plan.integrators + 1;
  const std::vector<double> log_anchor = log_anchors(image, latest, anchored);
  std::vector<double> anchor;
  Eigen::MatrixXd rest(static_cast<Eigen::Index>(anchored), columns);  // of H at the anchors
  double size = 0;
  for (std::size_t i = 0; i < anchored; ++i) {
    anchor.push_back(std::exp(log_anchor[i]));
    sensitive.evaluate(log_anchor[i], row);
    auto left = rest.row(static_cast<Eigen::Index>(i));
    left = row.real().matrix();
    size = std::max(size, std::abs(row[0]));
    for (std::size_t k = 0; k < nodes.size(); ++k) {
      const Complex r = rate_of(nodes[k].zeta);
      const double raised = is_direct[k] ? std::pow(anchor[i], m) : 1;
      left -= raised * (weights[k] * (r / (anchor[i] - r))).real().matrix();
    }
  }
  // Nodes too fast for the shortest lag have decayed wherever the output is read.  They leave only constants.
  plan.constant.setZero(static_cast<Eigen::Index>(plan.channels), columns);
  for (int k = 1; k < 5'000; ++k) {
    const Complex zeta = rule.node(-k);
    const Complex r = rate_of(zeta);
    sensitive.evaluate(zeta, row);
    row *= cut_factor;
    double part = 0;
    for (std::size_t i = 0; i < anchored; ++i) {
      const Complex part_of_rate = anchor[i] / r;
      const Complex share = std::pow(part_of_rate, static_cast<int>(anchored)) / (1.0 - part_of_rate);
      rest.row(static_cast<Eigen::Index>(i)) += (row * share).real().matrix();
      part = std::max(part, std::abs(row[0] * share));
    }
    row /= std::pow(r, static_cast<int>(anchored));
    for (std::size_t j = anchored; j < plan.channels; ++j, row /= r) {
      plan.constant.row(static_cast<Eigen::Index>(j)) -= row.real().matrix();
    }
    if (part < 1e-3 * tolerance * size) break;
  }
  for (Eigen::Index column = 0; column < columns; ++column) {
    const std::vector<double> coefficient =
        interpolating_polynomial(anchor, {rest.col(column).begin(), rest.col(column).end()});
    for (std::size_t j = 0; j < std::min(anchored, plan.channels); ++j) {
      plan.constant(static_cast<Eigen::Index>(j), column) = coefficient[j];
    }
  }

  // Real rates first.
  std::vector<std::size_t> order;
  for (const bool real : {true, false}) {
    for (std::size_t k = 0; k < nodes.size(); ++k) {
      if ((nodes[k].zeta.imag() == pi) == real) order.push_back(k);
    }
    if (real) plan.real_count = static_cast<Eigen::Index>(order.size());
  }
  plan.complex_count = static_cast<Eigen::Index>(nodes.size()) - plan.real_count;
  plan.weight.resize(plan.real_count + 2 * plan.complex_count, columns);
  if (!plan.delay_slope.empty()) plan.motion.resize(plan.weight.rows());
  for (Eigen::Index i = 0; i < static_cast<Eigen::Index>(order.size()); ++i) {
    const std::size_t k = order[static_cast<std::size_t>(i)];
    const Complex r = rate_of(nodes[k].zeta);
    plan.rate.push_back(r);
    plan.is_direct.push_back(is_direct[k]);
    plan.weight.row(i) = weights[k].real().matrix();
    if (i >= plan.real_count) plan.weight.row(i + plan.complex_count) = -weights[k].imag().matrix();
    if (plan.delay_slope.empty()) continue;
    const Complex moved = weights[k][0] * r;
    plan.motion[i] = moved.real();
    if (i >= plan.real_count) plan.motion[i + plan.complex_count] = -moved.imag();
  }
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
