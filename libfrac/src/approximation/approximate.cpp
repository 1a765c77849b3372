// SPDX-License-Identifier: BSD-3-Clause
#include "frac/approximation/approximate.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numbers>
#include <optional>
#include <stdexcept>

#include "base/bound_text.hpp"
#include "base/counted.hpp"
#include "base/number_text.hpp"
#include "base/short_text.hpp"
#include "base/spelling.hpp"
#include "error_measure.hpp"
#include "ladder.hpp"
#include "parallel_form.hpp"
#include "realised_order.hpp"
#include "unit_design.hpp"

namespace frac {
namespace {

constexpr detail::Spellings<ApproximationMethod, 8> method_names{
    {{ApproximationMethod::ladder, "ladder"},
     {ApproximationMethod::oustaloup, "oustaloup"},
     {ApproximationMethod::oustaloup_widened, "oustaloup-widened"},
     {ApproximationMethod::refined_oustaloup, "refined-oustaloup"},
     {ApproximationMethod::matsuda, "matsuda"},
     {ApproximationMethod::carlson, "carlson"},
     {ApproximationMethod::cfe, "cfe"},
     {ApproximationMethod::charef, "charef"}}};
constexpr detail::Spellings<ApproximationStatus, 3> status_names{
    {{ApproximationStatus::as_asked, "as-asked"},
     {ApproximationStatus::met, "met"},
     {ApproximationStatus::not_attainable, "not-attainable"}}};
constexpr int most_poles = 200;
constexpr int most_matsuda_poles = 60;  // what the digits of its arithmetic carry
constexpr int fewest_refined_poles = 3;
constexpr double anything = std::numeric_limits<double>::infinity();

std::string where(ApproximationMethod method) {
  return "approximate (" + std::string(to_string(method)) + ")";
}

class Designer {
 public:
  Designer(double order, FrequencyBand band, ApproximationMethod method)
      : band_(band),
        method_(method),
        whole_(std::trunc(order)),
        fractional_(order - whole_),
        problem_{std::abs(fractional_), (std::log(band.upper) - std::log(band.lower)) / 2} {
    if (method == ApproximationMethod::carlson && fractional_ != 0) {
      counts_ = detail::carlson_pole_counts(problem_.order);
      return;
    }
    const int first = method == ApproximationMethod::refined_oustaloup ? fewest_refined_poles : 1;
    const int last = method == ApproximationMethod::matsuda ? most_matsuda_poles : most_poles;
    for (int count = first; count <= last; ++count) counts_.push_back(count);
  }

  struct Result {
    ZeroPoleGain system;
    std::vector<std::pair<std::string, double>> parameters;
    ApproximationError error;
    int poles = 0;
  };

  [[nodiscard]] double fractional() const { return fractional_; }
  [[nodiscard]] const std::vector<int>& counts() const { return counts_; }

  // `hopeless_above`: a result with a larger error is of no use and may be left unfinished.
  [[nodiscard]] Result design(int poles, double hopeless_above) const {
    Result result;
    const detail::UnitDesign unit = poles == 0 ? detail::UnitDesign{} : unit_design(poles, hopeless_above);
    result.system = on_the_band(unit);
    result.parameters = unit.parameters;
    result.poles = poles;
    result.error = detail::measured_error(result.system, fractional_, band_);
    return result;
  }

  // The smallest number of poles with which the limit that theory sets to the error is at most `error`.
  [[nodiscard]] int limit_poles(double error) const {
    if (fractional_ == 0 || error == 0) return 0;
    const double width = 2 * problem_.half_width + 4 * std::numbers::ln2;
    const double most = std::log(2 * std::sin(std::numbers::pi * problem_.order) / error);
    return std::max(0, static_cast<int>(std::ceil(width / (std::numbers::pi * std::numbers::pi) * most)));
  }

 private:
  [[nodiscard]] detail::UnitDesign unit_design(int poles, double hopeless_above) const {
    switch (method_) {
      case ApproximationMethod::ladder:
        return detail::ladder_design(problem_, poles, hopeless_above);
      case ApproximationMethod::oustaloup:
        return detail::oustaloup_design(problem_, poles);
      case ApproximationMethod::oustaloup_widened:
        return detail::oustaloup_widened_design(problem_, poles);
      case ApproximationMethod::refined_oustaloup:
        return detail::refined_oustaloup_design(problem_, poles);
      case ApproximationMethod::matsuda:
        return detail::matsuda_design(problem_, poles);
      case ApproximationMethod::carlson:
        return detail::carlson_design(problem_, poles);
      case ApproximationMethod::cfe:
        return detail::cfe_design(problem_, poles);
      case ApproximationMethod::charef:
        break;
    }
    return detail::charef_design(problem_, poles);
  }

  [[nodiscard]] ZeroPoleGain on_the_band(const detail::UnitDesign& unit) const {
    const long double centre = std::exp(
        (std::log(static_cast<long double>(band_.lower)) + std::log(static_cast<long double>(band_.upper))) / 2);
    ZeroPoleGain system;
    system.integer_order = static_cast<int>(whole_);
    const auto scaled = [&](const std::vector<long double>& roots) {
      std::vector<double> result;
      result.reserve(roots.size());
      for (const long double root : roots) result.push_back(root == 0 ? 0.0 : static_cast<double>(-root * centre));
      return result;
    };
    const auto scaled_pairs = [&](const std::vector<std::complex<long double>>& roots) {
      std::vector<std::complex<double>> result;
      result.reserve(roots.size());
      for (const auto& root : roots) result.emplace_back(-std::conj(root) * centre);
      return result;
    };
    system.zeros = scaled(unit.zeros);
    system.poles = scaled(unit.poles);
    system.zero_pairs = scaled_pairs(unit.zero_pairs);
    system.pole_pairs = scaled_pairs(unit.pole_pairs);
    const long double gain = unit.gain * std::pow(centre, static_cast<long double>(problem_.order));
    system.gain = static_cast<double>(gain);
    if (fractional_ < 0) {
      std::swap(system.zeros, system.poles);
      std::swap(system.zero_pairs, system.pole_pairs);
      system.gain = static_cast<double>(1 / gain);
    }
    return system;
  }

  FrequencyBand band_;
  ApproximationMethod method_;
  double whole_;
  double fractional_;
  detail::UnitProblem problem_;
  std::vector<int> counts_;
};

void check(double order, FrequencyBand band, const ApproximationGoal& goal, ApproximationMethod method) {
  constexpr double fewest_decades = 0.01;
  constexpr double most_decades = 24;
  detail::check_realised_order(order, where(method));
  const bool ordered = band.lower > 0 && band.lower < band.upper && std::isfinite(band.upper);
  const double decades = ordered ? std::log10(band.upper) - std::log10(band.lower) : 0;
  if (!ordered || decades < fewest_decades || decades > most_decades) {
    throw std::invalid_argument(where(method) + ": band = " + detail::number_text(band.lower) + " to " +
                                detail::number_text(band.upper) +
                                " rad/s; needed is 0 < lower < upper < infinity, 0.01 to 24 decades apart");
  }
  const auto* tolerance = std::get_if<Tolerance>(&goal);
  if (tolerance != nullptr && !(tolerance->value > 0 && tolerance->value < 1)) {
    throw std::invalid_argument(where(method) + ": tolerance = " + detail::number_text(tolerance->value) +
                                " is not between 0 and 1");
  }
}

void check_poles(const Designer& designer, int poles, ApproximationMethod method) {
  const auto& counts = designer.counts();
  if (std::find(counts.begin(), counts.end(), poles) != counts.end()) return;
  std::string allowed;
  if (method == ApproximationMethod::carlson) {
    for (const int count : counts) allowed += (allowed.empty() ? "" : ", ") + std::to_string(count);
  } else {
    allowed = std::to_string(counts.front()) + " to " + std::to_string(counts.back());
  }
  throw std::invalid_argument(where(method) + ": poles = " + std::to_string(poles) + "; allowed are " + allowed);
}

struct Found {
  Designer::Result result;
  bool met;
};

// The ladder's error falls with every pole, by a factor known beforehand, until the rounding of zeros, poles and gain
// to double ends that.  So the search starts at the number of poles that the limit suggests and goes on pole by pole.
Found smallest_ladder(const Designer& designer, double tolerance) {
  const int fewest = designer.counts().front();
  const int most = designer.counts().back();
  int poles = std::clamp(designer.limit_poles(tolerance), fewest, most);
  Designer::Result best = designer.design(poles, tolerance);
  if (best.error.max_relative <= tolerance) {
    while (poles > fewest) {
      Designer::Result fewer = designer.design(--poles, tolerance);
      if (fewer.error.max_relative > tolerance) break;
      best = std::move(fewer);
    }
    return {std::move(best), true};
  }
  best = designer.design(poles, anything);
  constexpr int tries_without_gain = 3;
  for (int tries = 0; tries < tries_without_gain && poles < most;) {
    Designer::Result more = designer.design(++poles, anything);
    if (more.error.max_relative <= tolerance) return {std::move(more), true};
    // Another pole lowers the error by a tenth at least, unless rounding prevents it.
    tries = more.error.max_relative < 0.9 * best.error.max_relative ? 0 : tries + 1;
    if (more.error.max_relative < best.error.max_relative) best = std::move(more);
  }
  return {std::move(best), false};
}

// For the other methods: doubles the number of poles, then bisects.  The error falls with that number over the range
// that matters.
Found smallest(const Designer& designer, double tolerance) {
  const std::vector<int>& counts = designer.counts();
  std::optional<Designer::Result> best;
  const auto kept = [&](std::size_t index) {
    Designer::Result result = designer.design(counts[index], anything);
    const bool met = result.error.max_relative <= tolerance;
    const bool better = !best || (met ? best->error.max_relative > tolerance || result.poles < best->poles
                                      : result.error.max_relative < best->error.max_relative);
    if (better) best = std::move(result);
    return met;
  };
  std::size_t above = 0;
  std::size_t below = 0;
  while (!kept(above)) {
    if (above + 1 == counts.size()) return {std::move(*best), false};
    below = above + 1;
    above = std::min(2 * above + 1, counts.size() - 1);
  }
  while (below < above) {
    const std::size_t middle = (below + above) / 2;
    if (kept(middle)) {
      above = middle;
    } else {
      below = middle + 1;
    }
  }
  return {std::move(*best), true};
}

Found found(const Designer& designer, double tolerance, ApproximationMethod method) {
  Designer::Result none = designer.design(0, anything);
  if (none.error.max_relative <= tolerance) return {std::move(none), true};
  return method == ApproximationMethod::ladder ? smallest_ladder(designer, tolerance) : smallest(designer, tolerance);
}

std::string count_text(int poles) {
  return detail::counted(static_cast<std::size_t>(poles), "pole");
}

}  // namespace

std::string_view to_string(ApproximationMethod method) {
  return detail::spelling(method_names, method);
}

ApproximationMethod approximation_method_from_string(std::string_view name) {
  return detail::from_spelling(method_names, "approximation method", name);
}

std::span<const ApproximationMethod> approximation_methods() {
  static constexpr auto all = detail::enumerators(method_names);
  return all;
}

std::string_view to_string(ApproximationStatus status) {
  return detail::spelling(status_names, status);
}

Approximation approximate(double order, FrequencyBand band, ApproximationGoal goal, ApproximationMethod method) {
  check(order, band, goal, method);
  const Designer designer(order, band, method);
  const auto* count = std::get_if<PoleCount>(&goal);
  if (count != nullptr && designer.fractional() != 0) check_poles(designer, count->poles, method);

  Found choice;
  std::string message;
  ApproximationStatus status = ApproximationStatus::as_asked;
  if (designer.fractional() == 0) {
    choice = {designer.design(0, anything), true};
    if (count == nullptr) status = ApproximationStatus::met;
    message = "The order is whole, so s^order is exact and takes no poles.";
  } else if (count != nullptr) {
    choice = {designer.design(count->poles, anything), true};
    message = "The largest relative error with " + count_text(count->poles) + " is " +
              detail::bound_text(choice.result.error.max_relative);
    // Zeros, poles and gain that are rounded to double leave an error of this size, whatever their number.
    constexpr double rounding = 1e-15;
    const int enough = designer.limit_poles(rounding);
    if (method == ApproximationMethod::ladder && count->poles > enough) {
      message += "; more than " + std::to_string(enough) + " are of no use in double on this band";
    }
    message += ".";
  } else {
    const double tolerance = std::get<Tolerance>(goal).value;
    choice = found(designer, tolerance, method);
    const double reached = choice.result.error.max_relative;
    if (choice.met) {
      status = ApproximationStatus::met;
      message = "Tolerance " + detail::short_text(tolerance) + " is met with " + count_text(choice.result.poles) +
                ", largest relative error " + detail::bound_text(reached) + ".";
    } else {
      status = ApproximationStatus::not_attainable;
      const int most = designer.counts().back();
      const bool rounding = method == ApproximationMethod::ladder && choice.result.poles < most;
      const std::string bounds = "by " + std::string(to_string(method)) + " with up to " + count_text(most);
      message = "Tolerance " + detail::short_text(tolerance) + " is not attainable " +
                (rounding ? "in double" : bounds) + ", best is " + detail::bound_text(reached) + " with " +
                count_text(choice.result.poles) + ".";
    }
  }
  Designer::Result& result = choice.result;
  const double compared =
      status == ApproximationStatus::as_asked ? result.error.max_relative : std::get<Tolerance>(goal).value;
  return {.order = order,
          .band = band,
          .method = method,
          .parameters = std::move(result.parameters),
          .system = result.system,
          .parallel = detail::parallel_form(result.system, designer.fractional(), band, result.error.max_relative),
          .poles = result.poles,
          .error = result.error,
          .limit_poles = designer.limit_poles(compared),
          .status = status,
          .message = std::move(message)};
}

std::string Approximation::summary() const {
  using detail::short_text;
  return "s^" + short_text(order) + " on " + short_text(band.lower) + " .. " + short_text(band.upper) + " rad/s by " +
         std::string(to_string(method)) + ", " + count_text(poles) + ": largest relative error " +
         detail::bound_text(error.max_relative) + " at " + short_text(error.omega_at_maximum) + " rad/s. " + message;
}

}  // namespace frac
