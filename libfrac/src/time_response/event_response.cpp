// SPDX-License-Identifier: BSD-3-Clause
#include "event_response.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <utility>

#include "branch_cut.hpp"
#include "cut_plane_model.hpp"
#include "event_run.hpp"
#include "exponential_sum.hpp"
#include "exponential_terms.hpp"
#include "formula/power_sum.hpp"
#include "poles/laplace_image.hpp"
#include "sensitive_image.hpp"

namespace frac::detail {
namespace {

using Complex = std::complex<double>;
constexpr double pi = std::numbers::pi;
constexpr std::size_t most_integrators = 8;

// Whether the image and its derivatives are ratios of polynomials, which have no branch cut.
bool is_rational(const RatioOfPowerSums& ratio) {
  const auto is_whole = [](const SensitiveTerm& term) {
    return term.order == std::round(term.order) &&
           std::all_of(term.by_order.begin(), term.by_order.end(), [](double each) { return each == 0; });
  };
  return std::all_of(ratio.numerator.begin(), ratio.numerator.end(), is_whole) &&
         std::all_of(ratio.denominator.begin(), ratio.denominator.end(), is_whole);
}

// Poles whose residues are no larger than the response, so that they need not be left to a rule along a cut.
bool are_apart(const LaplaceImage& image) {
  constexpr double crowd = 0.1;
  for (std::size_t k = 0; k < image.poles().clusters.size(); ++k) {
    if (image.poles().clusters[k].multiplicity > 1 || image.clearance(k) < crowd) return false;
  }
  return true;
}

// Nodes on a circle about each pole that the rule does not account for.  Circles of `largest_share` of the way to the
// next pole or node are so small that e^{st} on them does not grow far beyond its value at the middle and decays about
// as fast.  On those of a smaller share q, n points leave an error of q^n, and rounding one of eps/q^2 in derivatives.
// @param rule  null for an image without a branch cut
void add_circles(const LaplaceImage& image, const CutRule* rule, SensitiveImage& sensitive, double latest,
                 double tolerance, SensitiveTerms& terms) {
  constexpr double largest_share = 0.25;
  const double simple_share = tolerance > 1e-11 ? 1.0 / 64 : 1.0 / 16;
  for (std::size_t k = 0; k < image.poles().clusters.size(); ++k) {
    const RootCluster& pole = image.poles().clusters[k];
    const bool on_cut = !rule && std::abs(pole.log_s.imag() - pi) < 1e-7;
    const Complex middle = on_cut ? Complex(pole.log_s.real(), pi) : pole.log_s;
    const Complex middle_share = rule ? rule->share_of(pole) : middle.imag() > pi ? 0.0 : 1.0;
    if (std::abs(middle_share) < 1e-3 * tolerance) continue;
    const bool shares = middle_share != 1.0;
    // Roots that coincide bring powers of t, which take more points.
    const double part = pole.multiplicity > 1 ? largest_share : simple_share;
    const int points =
        2 * static_cast<int>(std::ceil(0.5 * std::log(tolerance) / std::log(part)) + 1) + 6 * (pole.multiplicity - 1);
    const double lasting = std::max(1.5 / (std::exp(pole.log_s.real()) * latest), -0.25 * std::cos(pole.log_s.imag()));
    // The share of the rule is analytic up to its nodes.
    const double room = largest_share * std::min({image.clearance(k), 1.0, 1.5 * pi - pole.log_s.imag(),
                                                  shares ? rule->distance(pole.log_s) : 1.0});
    const double radius = std::max(part / largest_share * std::min(room, lasting), 4 * pole.spread);
    for (int i = 0; i < (pole.is_conjugate || on_cut ? points / 2 : points); ++i) {
      const Complex offset = std::polar(radius, 2 * pi * (i + 0.5) / points);
      const Complex share = shares ? rule->share(middle + offset) : 1.0;
      terms.add(rate_at(middle + offset), 2.0 / points * share * offset * sensitive(middle + offset));
    }
  }
}

/// Kept per thread, so that rows find memory there.
SensitiveTerms& cleared_terms() {
  thread_local SensitiveTerms terms;
  terms.clear();
  return terms;
}

/// Adds the nodes along the cut and the constants to the nodes on circles, and gives the plan all of them; false where
/// a value is not finite.
/// @param rule      null for an image without a branch cut
/// @param image_at  H and its derivatives at ln s
/// @param direct    what the output follows at once
/// @param lowest    ln|s| of nodes that may count
template <typename ImageAt>
bool complete(EventPlan& plan, const CutRule* rule, const ImageAt& image_at, const std::vector<RootCluster>& poles,
              const RealRow& direct, double latest, double lowest, double tolerance, SensitiveTerms& terms) {
  double negligible = 0;
  if (rule) {
    const double largest =
        append_cut_terms(*rule, image_at, latest, plan.integrators, lowest, 0.03 * rule->step() * tolerance, terms);
    if (!std::isfinite(largest)) return false;
    negligible = 1e-3 * rule->step() * tolerance * largest;
  }
  // Integrated again and again, fast terms would outgrow the response and cancel: see ExponentialSum.
  if (plan.integrators > 0) make_direct(terms, latest, plan.integrators);
  const auto constants = constants_of(terms, image_at, log_anchors(poles, latest, plan.integrators + 1), rule,
                                      negligible, plan.integrators, plan.channels);
  plan.take(terms, constants, direct);
  return true;
}

}  // namespace

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

void EventResponse::set_nothing(Eigen::Index columns, Result& result) const {
  const auto rows = static_cast<Eigen::Index>(output_time_.size());
  result.value.setZero(rows);
  result.gradient.setZero(rows, columns - 1);
}

std::optional<EventPlan> EventResponse::planned(double high_order, double low_order, double delay) const {
  if (high_order > 0 || !(low_order > -1.0 - static_cast<double>(most_integrators)) || !std::isfinite(delay) ||
      delay < 0) {
    return std::nullopt;
  }
  EventPlan plan;
  plan.delay = delay;
  plan.integrators = low_order <= -1 ? static_cast<std::size_t>(std::floor(-low_order)) : 0;
  plan.channels = plan.integrators + (has_slopes_ ? 2 : 1);
  return plan;
}

bool EventResponse::evaluate(const FractionalTransferFunction& model, double tolerance, Result& result) const {
  std::optional<EventPlan> planned_for = planned(order_at_infinity(model), order_at_origin(model), model.delay());
  if (!planned_for) return false;
  EventPlan& plan = *planned_for;
  const double direct = order_at_infinity(model) == 0
                            ? model.numerator().front().coefficient / model.denominator().front().coefficient
                            : 0;
  const double latest = output_time_.back() - knots_.front().time - plan.delay;
  if (!(latest > 0)) {
    set_nothing(1, result);
    return true;
  }
  const LaplaceImage step(scaled(numerator_of(model), 1, static_cast<double>(plan.integrators)),
                          scaled(denominator_of(model), 1, 1));
  if (!step.poles().complete) return false;
  ExponentialSum sum = exponential_sum(step, shortest_lag(plan.delay), latest, tolerance, plan.integrators,
                                       plan.channels, FastTerms::direct);
  plan.take(sum.terms, sum.constants, direct);
  run_over_events(plan, knots_, output_time_, result);
  return result.value.allFinite();
}

bool EventResponse::evaluate(const RatioOfPowerSums& ratio, double tolerance, Result& result) const {
  const std::vector<PowerTerm> numerator = plain_terms(ratio.numerator);
  const std::vector<PowerTerm> denominator = plain_terms(ratio.denominator);
  if (numerator.empty() || denominator.empty()) return false;
  const double high_order = numerator.front().order - denominator.front().order;
  const double low_order = numerator.back().order - denominator.back().order;
  std::optional<EventPlan> planned_for = planned(high_order, low_order, ratio.delay);
  if (!planned_for) return false;
  EventPlan& plan = *planned_for;
  if (std::any_of(ratio.delay_slope.begin(), ratio.delay_slope.end(), [](double each) { return each != 0; })) {
    plan.delay_slope = ratio.delay_slope;
  }
  const auto m = static_cast<double>(plan.integrators);
  SensitiveImage sensitive(ratio, m);
  const Eigen::Index columns = sensitive.columns();
  RealRow direct = RealRow::Zero(columns);
  if (high_order == 0) {
    const SensitiveTerm& top = ratio.numerator.front();
    const SensitiveTerm& bottom = ratio.denominator.front();
    direct[0] = top.coefficient / bottom.coefficient;
    for (std::size_t p = 0; p < top.by_coefficient.size(); ++p) {
      direct[static_cast<Eigen::Index>(p) + 1] =
          (top.by_coefficient[p] - direct[0] * bottom.by_coefficient[p]) / bottom.coefficient;
    }
  }

  const double latest = output_time_.back() - knots_.front().time - ratio.delay;
  if (!(latest > 0)) {
    set_nothing(columns, result);
    return true;
  }
  const LaplaceImage image(scaled(numerator, 1, m), denominator);
  if (!image.poles().complete) return false;

  std::optional<CutRule> rule;
  if (!is_rational(ratio) || !are_apart(image)) rule.emplace(image, shortest_lag(ratio.delay), tolerance);
  const CutRule* const along_cut = rule ? &*rule : nullptr;
  SensitiveTerms& terms = cleared_terms();
  add_circles(image, along_cut, sensitive, latest, tolerance, terms);
  const auto image_at = [&](Complex zeta) -> const ComplexRow& { return sensitive(zeta); };
  if (!complete(plan, along_cut, image_at, image.poles().clusters, direct, latest,
                rule ? image.lowest_noticed(latest, tolerance) : 0, tolerance, terms))
    return false;
  run_over_events(plan, knots_, output_time_, result);
  return result.value.allFinite() && result.gradient.allFinite();
}

bool EventResponse::evaluate(CutPlaneModel model, double tolerance, Result& result) const {
  std::optional<EventPlan> plan = planned(model.order_at_infinity(), model.order_at_origin(), 0);
  if (!plan) return false;
  const double latest = output_time_.back() - knots_.front().time;
  if (!(latest > 0)) {
    set_nothing(model.columns(), result);
    return true;
  }
  const CutRule rule(cut_beside_negative_axis(), shortest_lag(0), tolerance);
  ComplexRow row;
  const auto image_at = [&](Complex zeta) -> const ComplexRow& {
    row = std::exp(static_cast<double>(plan->integrators) * zeta) * model(zeta);
    return row;
  };
  if (!complete(*plan, &rule, image_at, {}, model.at_infinity(), latest, -std::log(latest), tolerance, cleared_terms()))
    return false;
  run_over_events(*plan, knots_, output_time_, result);
  return result.value.allFinite() && result.gradient.allFinite();
}

}  // namespace frac::detail
