// SPDX-License-Identifier: BSD-3-Clause
#include "backlash/jump_frequency.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>
#include <utility>

#include "base/check.hpp"
#include "base/spelling.hpp"
#include "two_impact_orbit.hpp"
#include "visible_jump.hpp"

namespace backlash {
namespace {

constexpr std::array<std::pair<JumpCriterion, std::string_view>, 8> criteria = {{
    {JumpCriterion::two_impact_loss, "two-impact-loss"},
    {JumpCriterion::symmetry_loss, "symmetry-loss"},
    {JumpCriterion::saddle_node, "saddle-node"},
    {JumpCriterion::contact_at_rest, "contact-at-rest"},
    {JumpCriterion::mid_gap_at_rest, "mid-gap-at-rest"},
    {JumpCriterion::sweep_up, "sweep-up"},
    {JumpCriterion::sweep_down, "sweep-down"},
    {JumpCriterion::largest_discontinuity, "largest-discontinuity"},
}};

constexpr std::string_view sticks =
    "at restitution 0 the masses stick after each impact, so two impacts per period remain at every lower frequency";

// gamma = F/(M2 clearance omega^2) = 1/c^2.
double constant_at(double gamma) {
  return 1 / std::sqrt(gamma);
}

/// The event at the end of an orbit, and what it means without dissipation.
std::string told(const std::string& end, double restitution) {
  if (restitution != 1) return end;
  return end + "; without dissipation it is neutrally stable above, and no motion is attracted to it";
}

JumpFrequency two_impact_loss(double restitution) {
  if (restitution == 0) return {std::nullopt, std::string(sticks)};
  const detail::TwoImpactLoss loss = detail::two_impact_loss(restitution);
  const std::string orbit = loss.symmetric ? "the symmetric two-impact orbit" : "the asymmetric two-impact orbit";
  std::string message;
  switch (loss.end) {
    case detail::TwoImpactEnd::grazing:
      message = orbit + " grazes a wall: an extra impact";
      break;
    case detail::TwoImpactEnd::period_doubling:
      message = orbit + " doubles its period";
      break;
    case detail::TwoImpactEnd::fold:
      message = orbit + " meets an unstable one and vanishes";
      break;
  }
  return {constant_at(loss.gamma), told(message, restitution)};
}

JumpFrequency symmetry_loss(double restitution) {
  if (restitution == 0) {
    return {std::nullopt,
            "at restitution 0 the masses stick after each impact, so that the symmetric motion remains at every lower "
            "frequency"};
  }
  const detail::SymmetryLoss loss = detail::symmetry_loss(restitution);
  const char* message =
      loss.grazing ? "the symmetric two-impact orbit grazes a wall before its symmetry would break: an extra impact"
                   : "the symmetric two-impact orbit breaks its symmetry (pitchfork)";
  return {constant_at(loss.gamma), told(message, restitution)};
}

JumpFrequency saddle_node(double restitution) {
  if (restitution == 1) {
    return {std::nullopt, "without dissipation the two-impact orbit exists at every higher frequency"};
  }
  return {constant_at(detail::saddle_node_gamma(restitution)),
          "the two-impact orbit meets its unstable partner (saddle-node)"};
}

// Standard deviations by which the lines through the samples before and after a step must miss each other, for normally
// distributed scatter, and the least step that counts as a jump.
constexpr double significance = 5;
constexpr double least_step = 0.02;
// Samples on either side that make a line.
constexpr std::size_t neighbours = 6;
// |Im G| below this share of its largest value counts as zero.
constexpr double zero_share = 1e-12;
// Standard deviations in a 95 % half width.
constexpr double normal_quantile = 1.96;

double median(std::vector<double>& values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  if (values.size() % 2 != 0) return *middle;
  return 0.5 * (*middle + *std::max_element(values.begin(), middle));
}

struct Curve {
  std::vector<double> omega;
  std::vector<double> log_omega;
  std::vector<double> log_imaginary;
  std::vector<double> variance;  // of log_imaginary, from the uncertainties of the samples
};

// Line through a few samples: median of the slopes between them (Theil, Sen), then median of what is left.
struct Line {
  double slope;
  double at_step;  // value at the step
  double scatter;  // standard deviation of the samples about it
};

double median_slope(const Curve& curve, std::size_t first, std::size_t last, std::vector<double>& work) {
  work.clear();
  for (std::size_t i = first; i < last; ++i) {
    for (std::size_t j = i + 1; j < last; ++j) {
      work.push_back((curve.log_imaginary[j] - curve.log_imaginary[i]) / (curve.log_omega[j] - curve.log_omega[i]));
    }
  }
  return median(work);
}

Line line_through(const Curve& curve, std::size_t first, std::size_t last, double slope, double log_omega,
                  std::vector<double>& work) {
  work.clear();
  for (std::size_t i = first; i < last; ++i) {
    work.push_back(curve.log_imaginary[i] - slope * (curve.log_omega[i] - log_omega));
  }
  const double middle = median(work);
  for (double& value : work) value = std::abs(value - middle);
  // 1.4826 times the median deviation estimates the standard deviation of normally distributed scatter.
  return {slope, middle, 1.4826 * median(work)};
}

// ln|Im G| over different frequencies; repeats of one are averaged.
Curve log_imaginary_part(const frac::FrequencyResponseData& data, const std::vector<double>& uncertainty) {
  double largest = 0;
  for (const auto& value : data.value()) largest = std::max(largest, std::abs(value.imag()));
  const double zero = std::max(zero_share * largest, std::numeric_limits<double>::min());
  Curve curve;
  for (std::size_t i = 0; i < data.size();) {
    std::size_t next = i;
    double sum = 0;
    double squares = 0;
    for (; next < data.size() && data.omega()[next] == data.omega()[i]; ++next) {
      sum += data.value()[next].imag();
      if (!uncertainty.empty()) squares += std::pow(uncertainty[next] / normal_quantile, 2);
    }
    const double magnitude = std::max(zero * static_cast<double>(next - i), std::abs(sum));
    curve.omega.push_back(data.omega()[i]);
    curve.log_omega.push_back(std::log(data.omega()[i]));
    curve.log_imaginary.push_back(std::log(magnitude / static_cast<double>(next - i)));
    curve.variance.push_back(squares / (magnitude * magnitude));
    i = next;
  }
  return curve;
}

}  // namespace

std::string_view to_string(JumpCriterion criterion) {
  return frac::detail::spelling(criteria, criterion);
}
JumpCriterion jump_criterion_from_string(std::string_view text) {
  return frac::detail::from_spelling(criteria, "criterion", text);
}
std::span<const JumpCriterion> jump_criteria() {
  static constexpr auto all = frac::detail::enumerators(criteria);
  return all;
}

JumpFrequency jump_similarity_constant(double restitution, JumpCriterion criterion) {
  detail::require_restitution(restitution);
  switch (criterion) {
    case JumpCriterion::two_impact_loss:
      return two_impact_loss(restitution);
    case JumpCriterion::symmetry_loss:
      return symmetry_loss(restitution);
    case JumpCriterion::saddle_node:
      return saddle_node(restitution);
    case JumpCriterion::contact_at_rest:
      return {std::numbers::sqrt2, "from contact at rest u = gamma (1 - cos tau) just reaches the other wall"};
    case JumpCriterion::mid_gap_at_rest:
      return {2.0, "from mid-gap at rest u = 1/2 + gamma (1 - cos tau) just reaches the wall"};
    case JumpCriterion::sweep_up:
      return detail::visible_jump(restitution, Protocol::sweep_up);
    case JumpCriterion::sweep_down:
      return detail::visible_jump(restitution, Protocol::sweep_down);
    case JumpCriterion::largest_discontinuity:
      break;
  }
  throw std::invalid_argument(
      "criterion is largest-discontinuity, which needs the samples of a curve; it must be a criterion of the physics");
}

std::optional<double> jump_frequency(const TwoMassSystem& system, double force_amplitude, JumpCriterion criterion) {
  detail::require_positive("force_amplitude", "N", force_amplitude);
  detail::require_positive("clearance", "m", system.clearance());
  const std::optional<double> c = jump_similarity_constant(system.restitution(), criterion).similarity_constant;
  if (!c) return std::nullopt;
  return *c * std::sqrt(force_amplitude / system.mass2() / system.clearance());
}

std::vector<Discontinuity> find_discontinuities(const frac::FrequencyResponseData& data,
                                                const std::vector<double>& uncertainty) {
  if (!uncertainty.empty() && uncertainty.size() != data.size()) {
    throw std::invalid_argument("uncertainty has " + std::to_string(uncertainty.size()) + " entries for " +
                                std::to_string(data.size()) + " samples; it must have one for each, or none");
  }
  for (std::size_t i = 0; i < uncertainty.size(); ++i) {
    if (!(uncertainty[i] >= 0)) {
      throw std::invalid_argument("uncertainty[" + std::to_string(i) + "] is " + detail::text(uncertainty[i]) +
                                  "; it must not be negative");
    }
  }
  const Curve curve = log_imaginary_part(data, uncertainty);
  if (curve.omega.size() < 5) {
    throw std::invalid_argument("data has " + std::to_string(curve.omega.size()) +
                                " different frequencies; at least 5 are needed to find a discontinuity");
  }
  std::vector<Discontinuity> found;
  std::vector<double> work;
  for (std::size_t i = 1; i + 2 < curve.omega.size(); ++i) {
    const std::size_t first = i + 1 > neighbours ? i + 1 - neighbours : 0;
    const std::size_t last = std::min(curve.omega.size(), i + 1 + neighbours);
    // Two samples at an end of the curve borrow the slope of the other side.
    const bool has_left = i + 1 - first > 2;
    const bool has_right = last - (i + 1) > 2;
    if (!has_left && !has_right) continue;
    double left_slope = has_left ? median_slope(curve, first, i + 1, work) : 0;
    const double right_slope = has_right ? median_slope(curve, i + 1, last, work) : left_slope;
    if (!has_left) left_slope = right_slope;
    const double log_omega = 0.5 * (curve.log_omega[i] + curve.log_omega[i + 1]);
    const Line left = line_through(curve, first, i + 1, left_slope, log_omega, work);
    const Line right = line_through(curve, i + 1, last, right_slope, log_omega, work);
    const double shift = std::abs(right.at_step - left.at_step);
    const double width = curve.log_omega[i + 1] - curve.log_omega[i];
    const double step =
        std::abs(curve.log_imaginary[i + 1] - curve.log_imaginary[i] - 0.5 * (left.slope + right.slope) * width);
    const double known_to = std::sqrt(curve.variance[i] + curve.variance[i + 1]);
    if (std::min(shift, step) > least_step && step > 0.5 * shift && step > significance * known_to &&
        shift > significance * std::hypot(left.scatter, right.scatter)) {
      found.push_back(
          {curve.omega[i], curve.omega[i + 1], std::sqrt(curve.omega[i] * curve.omega[i + 1]), -std::expm1(-step)});
    }
  }
  std::stable_sort(found.begin(), found.end(),
                   [](const Discontinuity& a, const Discontinuity& b) { return a.size > b.size; });
  return found;
}

}  // namespace backlash
