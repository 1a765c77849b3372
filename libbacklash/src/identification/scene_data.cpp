// SPDX-License-Identifier: BSD-3-Clause
#include "scene_data.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>
#include <string>

#include "backlash/jump_frequency.hpp"
#include "base/check.hpp"
#include "base/median.hpp"

namespace backlash::detail {
namespace {

using Complex = std::complex<double>;

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
// gamma where the motion of the low-frequency side ends: between 0.463 and 0.533 for restitution 0.2 to 0.8.
constexpr double jump_gamma = 0.5;
constexpr std::size_t jumps_per_curve = 3;

// Misfit that counts as tolerable while places are compared: in shares of |N|, or in sigma.
constexpr double tolerable_share = 0.03;
constexpr double tolerable_sigmas = 3;

}  // namespace

std::array<double, 2> SceneData::parts(Complex z) const {
  switch (component) {
    case frac::Component::real:
      return {z.real(), 0};
    case frac::Component::imaginary:
      return {z.imag(), 0};
    default:
      return {z.real(), z.imag()};
  }
}

double SceneData::size(Complex z) const {
  const auto [first, second] = parts(z);
  return std::hypot(first, second);
}

double SceneData::deviation(const MeasuredPoint& point, Complex model) const {
  switch (weight) {
    case frac::Weight::given:
      return point.sigma;
    case frac::Weight::relative:
      // The part not fitted is free to grow: it must not make the other one weigh less.
      return std::abs(component == frac::Component::both ? model : point.value);
    default:
      return 1;
  }
}

double SceneData::rounding_variance() const {
  constexpr double share = 1e-7;  // of the data
  return share * typical_misfit * (share * typical_misfit);
}

double SceneData::robust_cost(const MeasuredPoint& point, std::optional<Complex> model) const {
  double tolerable = tolerable_share * typical;
  if (weight == frac::Weight::given) tolerable = tolerable_sigmas * point.sigma;
  if (weight == frac::Weight::relative) {
    const bool whole = component == frac::Component::both && model;
    tolerable = tolerable_share * std::max(std::abs(point.value), whole ? std::abs(*model) : 0.0);
  }
  if (!(tolerable > 0)) return 0;
  if (model) {
    const double share = size(*model - point.value) / tolerable;
    return std::log1p(share * share);
  }
  // ln(1 + share^2) is the price of a Cauchy distribution, in one or two dimensions, against its peak.  A value of
  // which only the size is known is spread evenly over an interval or a disc.
  const double width = tolerable / std::abs(point.value);
  const double price = component == frac::Component::both ? -2.0 / 3 * std::log(2 * width * width)
                                                          : -std::log(0.5 * std::numbers::pi * width);
  return std::max(price, 0.0);
}

bool PointChoice::offer(const SceneData& data, const MeasuredPoint& point, Kind offered, Complex value) {
  const double deviation = data.deviation(point, value);
  if (!(deviation > 0)) return false;
  const double distance = data.size(value - point.value) / deviation;
  if (kind != Kind::none && misfit <= distance) return false;
  kind = offered;
  model = value;
  misfit = distance;
  return true;
}

void check_curves(const std::vector<MeasuredDescribingFunction>& curves, const SceneIdentificationOptions& options) {
  if (curves.empty()) throw std::invalid_argument("curves is empty; at least one describing function is needed");
  for (std::size_t i = 0; i < curves.size(); ++i) {
    const std::string curve = "curve " + std::to_string(i);
    require_positive(curve + ": force_amplitude", "N", curves[i].force_amplitude);
    if (const int harmonic = curves[i].harmonic; harmonic != 1 && harmonic != 3 && harmonic != 5)
      throw std::invalid_argument(curve + ": harmonic is " + std::to_string(harmonic) + "; it must be 1, 3 or 5");
    if (options.weight == frac::Weight::given && curves[i].data.sigma().empty()) {
      throw std::invalid_argument(curve + ": weight is given, but the data have no sigma");
    }
  }
  if (std::none_of(curves.begin(), curves.end(), [](const auto& curve) { return curve.harmonic == 1; }))
    throw std::invalid_argument("all curves are of harmonics above the first; one of harmonic 1 is needed");
  using frac::Component;
  using frac::Weight;
  if (options.component != Component::both && options.component != Component::real &&
      options.component != Component::imaginary) {
    throw std::invalid_argument("component is " + std::string(frac::to_string(options.component)) +
                                "; it must be both, real or imaginary");
  }
  if (options.weight != Weight::relative && options.weight != Weight::given && options.weight != Weight::absolute) {
    throw std::invalid_argument("weight is " + std::string(frac::to_string(options.weight)) +
                                "; it must be relative, given or absolute");
  }
}

SceneData scene_data(const std::vector<MeasuredDescribingFunction>& curves, const SceneIdentificationOptions& options,
                     LoadAtRest at_rest) {
  SceneData data{{}, {}, options.output, options.component, options.weight, 0, 0, 0, 0};
  std::vector<double> sizes;
  for (std::size_t curve = 0; curve < curves.size(); ++curve) {
    data.curve_begin.push_back(data.points.size());
    const frac::FrequencyResponseData& response = curves[curve].data;
    for (std::size_t i = 0; i < response.size(); ++i) {
      const bool rests = options.output == Output::x1 && response.value()[i] == 0.0;
      if (rests && at_rest == LoadAtRest::left_out) continue;
      const double sigma = response.sigma().empty() ? nan : response.sigma()[i];
      data.points.push_back({curve, i, curves[curve].force_amplitude, response.omega()[i], response.value()[i], sigma,
                             curves[curve].harmonic, data.points.size()});
      const double size = std::abs(response.value()[i]);
      if (size > 0 && curves[curve].harmonic == 1) sizes.push_back(size);
    }
  }
  data.curve_begin.push_back(data.points.size());
  if (sizes.empty()) throw std::invalid_argument("all data are zero; nothing moves, so nothing can be identified");
  data.typical = frac::detail::median(sizes);
  std::vector<double> omegas, misfits;
  for (const MeasuredPoint& point : data.points) {
    omegas.push_back(point.omega);
    if (point.harmonic != 1) continue;
    const double deviation = data.deviation(point, point.value);
    if (deviation > 0) misfits.push_back(std::abs(point.value) / deviation);
  }
  data.typical_misfit = frac::detail::median(misfits);
  data.time_unit = 1 / frac::detail::median(omegas);
  for (MeasuredPoint& point : data.points) {
    data.harmonics = std::max(data.harmonics, point.harmonic);
    // Two curves of one harmonic and force may be of different motions.
    if (point.harmonic == 1) continue;
    point.motion = static_cast<std::size_t>(std::find_if(data.points.begin(), data.points.end(),
                                                         [&](const MeasuredPoint& other) {
                                                           return &other == &point ||
                                                                  (other.harmonic == 1 && other.force == point.force &&
                                                                   other.omega == point.omega);
                                                         }) -
                                            data.points.begin());
  }
  data.force_unit = std::numeric_limits<double>::infinity();
  for (const MeasuredPoint& point : data.points) data.force_unit = std::min(data.force_unit, point.force);
  return data;
}

SceneData thinned(const SceneData& data, std::size_t points) {
  SceneData few = data;
  few.points.clear();
  const std::size_t stride = (data.points.size() + points - 1) / points;
  for (std::size_t i = 0; i < data.points.size(); i += stride) few.points.push_back(data.points[i]);
  return few;
}

void require_residuals(const SceneData& data, std::size_t parameters) {
  const std::size_t residuals = data.points.size() * data.residuals_per_point();
  if (residuals >= parameters) return;
  throw std::invalid_argument("the data form " + std::to_string(residuals) + " residuals, fewer than the " +
                              std::to_string(parameters) + " free parameters");
}

std::vector<double> products_from_jumps(const std::vector<MeasuredDescribingFunction>& curves) {
  std::vector<double> products;
  for (const MeasuredDescribingFunction& curve : curves) {
    if (curve.harmonic != 1) continue;
    std::vector<double> omega = curve.data.omega();
    omega.erase(std::unique(omega.begin(), omega.end()), omega.end());
    if (omega.size() < 5) continue;
    const std::vector<Discontinuity> jumps = find_discontinuities(curve.data);
    for (std::size_t i = 0; i < std::min(jumps.size(), jumps_per_curve); ++i) {
      products.push_back(curve.force_amplitude / (jump_gamma * jumps[i].omega * jumps[i].omega));
    }
  }
  return products;
}

PointStatus status_of(const PointChoice& choice) {
  if (choice.used) return PointStatus::used;
  return choice.kind == PointChoice::Kind::none ? PointStatus::irregular : PointStatus::off_branch;
}

}  // namespace backlash::detail
