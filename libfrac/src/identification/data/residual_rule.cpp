// SPDX-License-Identifier: BSD-3-Clause
#include "residual_rule.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <stdexcept>
#include <string>

#include "base/counted.hpp"
#include "base/short_text.hpp"
#include "base/wide_vectors.hpp"
#include "neighbour_noise.hpp"

namespace frac::detail {

namespace {

std::string at(const FrequencyResponseData& data, std::size_t point) {
  const FrequencyUnit unit = data.frequency_unit();
  return std::string(unit == FrequencyUnit::hertz ? " at f = " : " at omega = ") +
         short_text(in_unit(data.omega()[point], unit), 6) + " " + std::string(to_string(unit));
}

void require_nonzero(const FrequencyResponseData& data) {
  for (std::size_t i = 0; i < data.size(); ++i) {
    if (!(std::abs(data.value()[i]) > 0)) {
      throw std::invalid_argument(
          "the value" + at(data, i) +
          " is 0, which has no phase and no logarithm; fit both parts with weight learned, relative or "
          "absolute");
    }
  }
}

/// The least magnitude of values other than 0; 0 where there is none.
double smallest_magnitude(const FrequencyResponseData& data) {
  double smallest = 0;
  for (const std::complex<double> value : data.value()) {
    const double size = std::abs(value);
    if (size > 0 && (smallest == 0 || size < smallest)) smallest = size;
  }
  return smallest;
}

/// |data|.  An instrument writes 0 for what it cannot tell from 0, so that such a value is known no better than the
/// smallest one that it told from 0, and weighs like that one.
std::vector<double> told_magnitude(const FrequencyResponseData& data) {
  const double smallest = smallest_magnitude(data);
  std::vector<double> size;
  for (const std::complex<double> value : data.value()) size.push_back(std::max(std::abs(value), smallest));
  return size;
}

/// Value at point i of the straight line through y over x of its neighbours up to `reach` away, without the point
/// itself, and the share of the noise variance it keeps.
struct LocalLine {
  double value, variance;
};
LocalLine local_line(const std::vector<double>& x, const std::vector<double>& y, std::size_t i, std::size_t reach) {
  const std::size_t first = i > reach ? i - reach : 0, last = std::min(x.size(), i + reach + 1);
  double n = 0, sum_x = 0, sum_y = 0, xx = 0, xy = 0;
  for (std::size_t k = first; k < last; ++k) {
    if (k == i) continue;
    const double dx = x[k] - x[i];
    n += 1;
    sum_x += dx;
    sum_y += y[k];
    xx += dx * dx;
    xy += dx * y[k];
  }
  const double spread = n * xx - sum_x * sum_x;
  if (n == 0) return {y[i], 1};
  if (!(spread > 0)) return {sum_y / n, 1 / n};
  return {(sum_y * xx - sum_x * xy) / spread, xx / spread};
}

/// |data| as its neighbours tell it: exp of a straight line through ln|data| over ln omega of up to four on either
/// side. As many as agree, within the noise, with what fewer say (Lepski's rule), so that a resonance is not smoothed
/// away; and without the point itself, so that its weight does not depend on its noise, which would bias the fit.
std::vector<double> smoothed_magnitude(const FrequencyResponseData& data) {
  std::vector<double> x, y;
  for (std::size_t i = 0; i < data.size(); ++i) {
    x.push_back(std::log(data.omega()[i]));
    y.push_back(std::log(std::abs(data.value()[i])));
  }
  const double noise = neighbour_noise(x, y);
  std::vector<double> result(data.size());
  for (std::size_t i = 0; i < data.size(); ++i) {
    std::vector<LocalLine> lines;
    for (const std::size_t reach : {1, 2, 3, 4}) {
      const bool at_an_end = i == 0 || i + 1 == data.size();
      if (reach == 1 && at_an_end && data.size() > 2) continue;  // a line needs two neighbours
      const LocalLine next = local_line(x, y, i, reach);
      const bool agrees = std::all_of(lines.begin(), lines.end(), [&](const LocalLine& line) {
        return std::abs(next.value - line.value) <= noise * std::sqrt(line.variance);
      });
      if (!agrees) break;
      lines.push_back(next);
    }
    result[i] = std::exp(lines.back().value);
  }
  return result;
}

/// Standard deviation at each frequency from its repeats; relative variances are pooled over five neighbouring
/// frequencies, because that of two or three repeats alone is off by its own size.
std::vector<double> deviation_of_repeats(const FrequencyResponseData& data) {
  struct Group {
    std::size_t first, last;
    double square, degrees, magnitude;
  };
  std::vector<Group> groups;
  for (std::size_t first = 0; first < data.size();) {
    std::size_t last = first;
    std::complex<double> mean = 0;
    while (last < data.size() && data.omega()[last] == data.omega()[first]) mean += data.value()[last++];
    const auto count = static_cast<double>(last - first);
    mean /= count;
    if (last - first < 2) {
      throw std::invalid_argument("weight 'repeats' needs at least two values at every frequency; there is one" +
                                  at(data, first));
    }
    double square = 0;
    for (std::size_t i = first; i < last; ++i) square += std::norm(data.value()[i] - mean);
    groups.push_back({first, last, square / std::norm(mean), 2 * (count - 1), std::abs(mean)});
    first = last;
  }
  std::vector<double> result(data.size());
  for (std::size_t g = 0; g < groups.size(); ++g) {
    double square = 0, degrees = 0;
    for (std::size_t k = g > 2 ? g - 2 : 0; k < std::min(groups.size(), g + 3); ++k) {
      square += groups[k].square;
      degrees += groups[k].degrees;
    }
    const double deviation = groups[g].magnitude * std::sqrt(square / degrees);
    if (!(deviation > 0) || !std::isfinite(deviation)) {
      throw std::invalid_argument("the repeats around" + at(data, groups[g].first) +
                                  " are all equal (or average to 0), so they tell no noise; use another weight");
    }
    std::fill(result.begin() + static_cast<std::ptrdiff_t>(groups[g].first),
              result.begin() + static_cast<std::ptrdiff_t>(groups[g].last), deviation);
  }
  return result;
}

/// The standard deviation (or scale) the residual of a value is divided by.
std::vector<double> scale_of(const FrequencyResponseData& data, Weight weight, double floor) {
  std::vector<double> scale(data.size(), 1.0);
  switch (weight) {
    case Weight::absolute:
    case Weight::log_complex:
      break;
    case Weight::relative:
      scale = told_magnitude(data);
      break;
    case Weight::learned:
      scale = told_magnitude(data);
      if (floor > 0)
        for (double& each : scale) each = std::hypot(each, floor);
      break;
    case Weight::smoothed_relative:
      scale = smoothed_magnitude(data);
      break;
    case Weight::given:
      if (data.sigma().empty()) {
        throw std::invalid_argument("weight 'given' needs a standard deviation for each value, the data have none");
      }
      scale = data.sigma();
      break;
    case Weight::repeats:
      scale = deviation_of_repeats(data);
      break;
  }
  return scale;
}

}  // namespace

ResidualForm residual_form(Component component, Weight weight) {
  const bool logarithmic = weight == Weight::log_complex;
  switch (component) {
    case Component::imaginary:
    case Component::real:
      if (logarithmic) {
        throw std::invalid_argument(
            "weight 'log-complex' compares magnitude and phase, so it takes component both, "
            "magnitude or phase, not " +
            std::string(to_string(component)));
      }
      return component == Component::real ? ResidualForm::real : ResidualForm::imaginary;
    case Component::both:
      return logarithmic ? ResidualForm::logarithmic : ResidualForm::cartesian;
    case Component::magnitude:
      return logarithmic || weight == Weight::relative || weight == Weight::learned ? ResidualForm::log_magnitude
                                                                                    : ResidualForm::magnitude;
    case Component::phase:
      return ResidualForm::phase;
  }
  return ResidualForm::cartesian;
}

ResidualRule residual_rule(const FrequencyResponseData& data, const FitOptions& options) {
  return residual_rule(data, options.component, options.weight, options.noise_floor.value_or(0));
}

ResidualRule residual_rule(const FrequencyResponseData& data, Component component, Weight weight, double floor) {
  if (!(floor >= 0 && std::isfinite(floor))) {
    throw std::invalid_argument("noise floor = " + std::to_string(floor) + "; allowed is 0 or more, finite");
  }

  ResidualRule rule{residual_form(component, weight), {}, 1};
  const bool pure_number = rule.form == ResidualForm::log_magnitude || rule.form == ResidualForm::logarithmic;
  const bool by_magnitude = weight == Weight::relative || weight == Weight::learned;
  const bool all_zero = by_magnitude && smallest_magnitude(data) == 0;
  if (pure_number || rule.form == ResidualForm::phase || weight == Weight::smoothed_relative || all_zero) {
    require_nonzero(data);
  }
  if (pure_number) {
    rule.weight.assign(data.size(), 1.0);
    return rule;
  }
  rule.weight = scale_of(data, weight, floor);
  if (by_magnitude && rule.form != ResidualForm::phase) rule.floor = floor;
  const bool known_noise = weight == Weight::given || weight == Weight::repeats;
  for (std::size_t i = 0; i < data.size(); ++i) {
    rule.weight[i] = 1 / rule.weight[i];
    if (rule.form != ResidualForm::phase) continue;
    // The phase of a value with standard deviation sigma is known to sigma/|value|.
    rule.weight[i] = known_noise ? rule.weight[i] * std::abs(data.value()[i]) : 1;
  }
  const bool plainly_relative = weight == Weight::relative || (weight == Weight::learned && floor == 0);
  if (rule.form == ResidualForm::phase || plainly_relative) return rule;

  // Division by the largest comes first, so that squares of data of 1e-200 or 1e200 neither vanish nor overflow.
  double largest = 0, sum = 0;
  for (std::size_t i = 0; i < data.size(); ++i) largest = std::max(largest, rule.weight[i] * std::abs(data.value()[i]));
  for (std::size_t i = 0; i < data.size() && largest > 0; ++i) {
    const double share = rule.weight[i] * std::abs(data.value()[i]) / largest;
    sum += share * share;
  }
  if (largest > 0) rule.unit = largest * std::sqrt(sum / static_cast<double>(data.size()));
  for (double& each : rule.weight) each /= rule.unit;
  return rule;
}

bool ResidualRule::residual(std::size_t point, std::complex<double> model, std::complex<double> data,
                            double* result) const {
  if (!std::isfinite(model.real()) || !std::isfinite(model.imag())) return false;
  switch (form) {
    case ResidualForm::imaginary:
      result[0] = model.imag() - data.imag();
      break;
    case ResidualForm::real:
      result[0] = model.real() - data.real();
      break;
    case ResidualForm::cartesian:
      result[0] = model.real() - data.real();
      result[1] = weight[point] * (model.imag() - data.imag());
      break;
    case ResidualForm::logarithmic:
      result[0] = std::log(std::abs(model) / std::abs(data));
      result[1] = weight[point] * std::arg(model / data);
      break;
    case ResidualForm::magnitude:
      result[0] = std::abs(model) - std::abs(data);
      break;
    case ResidualForm::log_magnitude:
      result[0] = std::log(std::abs(model) / std::abs(data));
      break;
    case ResidualForm::phase:
      result[0] = std::arg(model / data);
      if (model == 0.0) return false;
      break;
  }
  result[0] *= weight[point];
  return std::isfinite(result[0]);
}

namespace {

/// No infinity and no NaN: no exponent of all ones.
FRACFIT_INLINE inline bool all_finite(const double* values, std::size_t count) {
  constexpr std::uint64_t exponent = 0x7ff0000000000000, lowest = 0x0010000000000000;
  std::uint64_t overflow = 0;
  for (std::size_t i = 0; i < count; ++i) overflow |= (std::bit_cast<std::uint64_t>(values[i]) & exponent) + lowest;
  return overflow >> 63 == 0;
}

FRACFIT_INLINE inline void weigh_pairs(const double* weight, const double* values, std::size_t count, double* result) {
  for (std::size_t i = 0; i < count; ++i) {
    result[2 * i] = weight[i] * values[2 * i];
    result[2 * i + 1] = weight[i] * values[2 * i + 1];
  }
}

FRACFIT_INLINE inline void weigh_differences(const double* weight, const double* model, const double* data,
                                             std::size_t count, double* result) {
  for (std::size_t i = 0; i < count; ++i) {
    result[2 * i] = weight[i] * (model[2 * i] - data[2 * i]);
    result[2 * i + 1] = weight[i] * (model[2 * i + 1] - data[2 * i + 1]);
  }
}

/// @param part  0: real parts, 1: imaginary ones
FRACFIT_INLINE inline void weigh_part(const double* weight, const double* model, const double* data, std::size_t part,
                                      std::size_t count, double* result) {
  for (std::size_t i = 0; i < count; ++i) result[i] = weight[i] * (model[2 * i + part] - data[2 * i + part]);
}

// Complex numbers are pairs of reals in memory.
const double* as_pairs(std::span<const std::complex<double>> values) {
  return reinterpret_cast<const double*>(values.data());
}

}  // namespace

bool ResidualRule::residuals(std::span<const std::complex<double>> model, std::span<const std::complex<double>> data,
                             double* result) const {
  const std::size_t count = model.size();
  if (form == ResidualForm::cartesian) {
    return with_wide_vectors([&]() FRACFIT_INLINE {
      weigh_differences(weight.data(), as_pairs(model), as_pairs(data), count, result);
      return all_finite(result, 2 * count);
    });
  }
  if (form == ResidualForm::imaginary || form == ResidualForm::real) {
    const std::size_t part = form == ResidualForm::imaginary ? 1 : 0;
    return with_wide_vectors([&]() FRACFIT_INLINE {
      weigh_part(weight.data(), as_pairs(model), as_pairs(data), part, count, result);
      return all_finite(result, count) && all_finite(as_pairs(model), 2 * count);
    });
  }
  for (std::size_t i = 0; i < count; ++i) {
    if (!residual(i, model[i], data[i], result + i * per_point())) return false;
  }
  return true;
}

bool ResidualRule::derivatives(std::span<const std::complex<double>> model,
                               std::span<const std::complex<double>> of_model, double* result) const {
  const std::size_t count = model.size();
  switch (form) {
    case ResidualForm::imaginary:
      for (std::size_t i = 0; i < count; ++i) result[i] = weight[i] * of_model[i].imag();
      break;
    case ResidualForm::real:
      for (std::size_t i = 0; i < count; ++i) result[i] = weight[i] * of_model[i].real();
      break;
    case ResidualForm::cartesian:
      with_wide_vectors([&]() FRACFIT_INLINE { weigh_pairs(weight.data(), as_pairs(of_model), count, result); });
      break;
    case ResidualForm::magnitude:
      for (std::size_t i = 0; i < count; ++i) {
        result[i] = weight[i] * (std::abs(model[i]) * (of_model[i] / model[i])).real();
      }
      break;
    case ResidualForm::logarithmic:
      for (std::size_t i = 0; i < count; ++i) {
        const std::complex<double> of_logarithm = weight[i] * (of_model[i] / model[i]);
        result[2 * i] = of_logarithm.real();
        result[2 * i + 1] = of_logarithm.imag();
      }
      break;
    case ResidualForm::log_magnitude:
      for (std::size_t i = 0; i < count; ++i) result[i] = weight[i] * (of_model[i] / model[i]).real();
      break;
    case ResidualForm::phase:
      for (std::size_t i = 0; i < count; ++i) result[i] = weight[i] * (of_model[i] / model[i]).imag();
      break;
  }
  return with_wide_vectors([&]() FRACFIT_INLINE { return all_finite(result, count * per_point()); });
}

std::string remark_on_zeros(const FrequencyResponseData& data, const FitOptions& options) {
  if (options.weight != Weight::relative && options.weight != Weight::learned) return "";
  const auto zeros = std::count(data.value().begin(), data.value().end(), std::complex<double>(0));
  if (zeros == 0) return "";
  return " " + counted(static_cast<std::size_t>(zeros), "value") + (zeros == 1 ? " is" : " are") +
         " 0, below what the instrument tells, and " + (zeros == 1 ? "weighs" : "weigh") +
         " like the smallest other one, " + short_text(smallest_magnitude(data)) + ".";
}

std::vector<double> curve_residuals(const FrequencyResponseData& data, const ResidualRule& rule,
                                    const std::vector<std::complex<double>>& model) {
  std::vector<double> residual(data.size() * rule.per_point());
  for (std::size_t i = 0; i < data.size(); ++i) {
    if (!rule.residual(i, model[i], data.value()[i], residual.data() + i * rule.per_point())) {
      throw std::invalid_argument("the curve has no finite residual" + at(data, i));
    }
  }
  for (double& value : residual) value *= rule.unit;
  return residual;
}

}  // namespace frac::detail
