// SPDX-License-Identifier: BSD-3-Clause
#include "shift.hpp"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <stdexcept>

namespace frac {
namespace detail {
namespace {

/// The formula with (aT s) instead of each s.
std::string with_shifted_s(std::string_view formula) {
  const auto in_name = [](char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_'; };
  const auto is_digit = [](char c) { return std::isdigit(static_cast<unsigned char>(c)) != 0; };
  std::string text;
  for (std::size_t i = 0; i < formula.size();) {
    std::size_t end = i;
    if (is_digit(formula[i]) || formula[i] == '.') {
      double number = 0;
      end = static_cast<std::size_t>(std::from_chars(formula.data() + i, formula.data() + formula.size(), number).ptr -
                                     formula.data());
    } else {
      while (end < formula.size() && in_name(formula[end])) ++end;
    }
    end = std::max(end, i + 1);
    const std::string_view word = formula.substr(i, end - i);
    text += word == "s" ? "(" + std::string(horizontal_shift) + " s)" : std::string(word);
    i = end;
  }
  return text;
}

/// A curve as its logarithms over ln omega: of what is fitted, and of the angle where that is fitted too.
struct LogCurve {
  std::vector<double> log_omega, log_value, angle;  // either of the last two may be empty
};

LogCurve log_curve(const FrequencyResponseData& data, Component component) {
  LogCurve result;
  double last = 0;
  for (std::size_t i = 0; i < data.size(); ++i) {
    const std::complex<double> value = data.value()[i];
    const double part = component == Component::imaginary ? std::abs(value.imag())
                        : component == Component::real    ? std::abs(value.real())
                                                          : std::abs(value);
    if (!(part > 0)) continue;
    result.log_omega.push_back(std::log(data.omega()[i]));
    if (component != Component::phase) result.log_value.push_back(std::log(part));
    if (component == Component::both || component == Component::phase) {
      double angle = std::arg(value);
      while (angle - last > std::numbers::pi) angle -= 2 * std::numbers::pi;
      while (angle - last < -std::numbers::pi) angle += 2 * std::numbers::pi;
      result.angle.push_back(last = angle);
    }
  }
  return result;
}

double between(const std::vector<double>& x, const std::vector<double>& y, double at) {
  const auto above = std::clamp<std::ptrdiff_t>(std::lower_bound(x.begin(), x.end(), at) - x.begin(), 1,
                                                static_cast<std::ptrdiff_t>(x.size()) - 1);
  const auto i = static_cast<std::size_t>(above);
  const double width = x[i] - x[i - 1];
  return width > 0 ? y[i - 1] + (y[i] - y[i - 1]) * (at - x[i - 1]) / width : y[i];
}

struct Match {
  double mismatch = std::numeric_limits<double>::infinity();  // mean square of what is left
  double vertical = 0;                                        // logarithm
};

/// The curve laid on another one with its ln omega moved up by `shift`, where at least `least` of its points are within
/// the other one.
Match match(const LogCurve& curve, const LogCurve& on, double shift, bool vertical, std::size_t least) {
  std::vector<double> value, angle;
  for (std::size_t i = 0; i < curve.log_omega.size(); ++i) {
    const double at = curve.log_omega[i] + shift;
    if (at < on.log_omega.front() || at > on.log_omega.back()) continue;
    if (!curve.log_value.empty()) value.push_back(curve.log_value[i] - between(on.log_omega, on.log_value, at));
    if (!curve.angle.empty()) angle.push_back(curve.angle[i] - between(on.log_omega, on.angle, at));
  }
  const std::size_t count = std::max(value.size(), angle.size());
  if (count < least) return {};
  Match result;
  if (vertical && !value.empty())
    result.vertical = std::accumulate(value.begin(), value.end(), 0.0) / static_cast<double>(value.size());
  double square = 0;
  for (const double each : value) square += (each - result.vertical) * (each - result.vertical);
  for (const double each : angle) square += each * each;
  // A parameter of the overlap costs a degree of freedom: few points agree by chance.
  result.mismatch = square / (static_cast<double>(count) - (vertical ? 1.5 : 1));
  return result;
}

struct Laid {
  double shift, vertical;  // logarithms
};

/// The best place of the curve on another one: on a grid, and then finer about the best of it.
Laid laid_on(const LogCurve& curve, const LogCurve& on, bool vertical, double lowest, double highest) {
  const std::size_t least = std::max<std::size_t>(4, std::min(curve.log_omega.size(), on.log_omega.size()) / 6);
  Laid best{0, 0};
  double found = std::numeric_limits<double>::infinity();
  double from = lowest, to = highest;
  constexpr int steps = 240;
  for (int pass = 0; pass < 3; ++pass) {
    const double step = (to - from) / steps;
    for (int i = 0; i <= steps; ++i) {
      const double shift = from + i * step;
      const Match here = match(curve, on, shift, vertical, least);
      if (!(here.mismatch < found)) continue;
      found = here.mismatch;
      best = {shift, here.vertical};
    }
    from = best.shift - 2 * step;
    to = best.shift + 2 * step;
  }
  return best;
}

/// All curves as one, each multiplied back onto the reference.
FrequencyResponseData together(const std::vector<JointCurve>& curves, const std::vector<Laid>& laid) {
  struct Point {
    double omega;
    std::complex<double> value;
    double sigma;
  };
  std::vector<Point> points;
  bool sigma = true;
  for (std::size_t c = 0; c < curves.size(); ++c) {
    const FrequencyResponseData& data = *curves[c].response();
    const double along = std::exp(laid[c].shift), down = std::exp(-laid[c].vertical);
    sigma = sigma && !data.sigma().empty();
    for (std::size_t i = 0; i < data.size(); ++i)
      points.push_back({data.omega()[i] * along, data.value()[i] * down, sigma ? data.sigma()[i] * down : 0});
  }
  std::stable_sort(points.begin(), points.end(), [](const Point& a, const Point& b) { return a.omega < b.omega; });
  std::vector<double> omega, deviation;
  std::vector<std::complex<double>> value;
  for (const Point& each : points) {
    omega.push_back(each.omega);
    value.push_back(each.value);
    if (sigma) deviation.push_back(each.sigma);
  }
  return {std::move(omega), std::move(value), std::move(deviation), curves.front().response()->frequency_unit()};
}

/// The fit over the range of all curves and half as much beyond, as a curve to lay others on.
LogCurve drawn(const FitResult& master, const Realisation& realisation, const FrequencyResponseData& over,
               Component component) {
  constexpr int count = 1000;
  const double first = std::log(over.omega().front()), width = std::log(over.omega().back()) - first;
  std::vector<double> omega;
  for (int i = 0; i <= count; ++i) omega.push_back(std::exp(first + width * (-0.5 + 2.0 * i / count)));
  std::vector<std::complex<double>> value = fitted_response(master, realisation, omega);
  for (std::complex<double>& each : value)
    if (!std::isfinite(each.real()) || !std::isfinite(each.imag())) each = 0;
  return log_curve({omega, value}, component);
}

}  // namespace

Superposition superposed(const std::vector<JointCurve>& curves, const Structure& master, const CurveShift& shift,
                         const FitOptions& options) {
  if (shift.reference >= curves.size()) throw std::invalid_argument("the reference of the shift is no curve");
  if (options.weight == Weight::repeats)
    throw std::invalid_argument("weight 'repeats' has no meaning with a shift, which moves the frequencies");
  std::vector<LogCurve> logs;
  for (const JointCurve& curve : curves) {
    logs.push_back(log_curve(*curve.response(), options.component));
    if (logs.back().log_omega.size() < 4)
      throw std::invalid_argument("curve " + curve.name + " has too few points to be shifted; 4 are needed");
  }
  std::vector<Laid> laid(curves.size(), {0, 0});
  const auto lay = [&](std::size_t c, std::size_t neighbour) {
    const double lowest = logs[neighbour].log_omega.front() - logs[c].log_omega.back();
    const double highest = logs[neighbour].log_omega.back() - logs[c].log_omega.front();
    const Laid here = laid_on(logs[c], logs[neighbour], shift.vertical, lowest, highest);
    laid[c] = {laid[neighbour].shift + here.shift, laid[neighbour].vertical + here.vertical};
  };
  for (std::size_t c = shift.reference + 1; c < curves.size(); ++c) lay(c, c - 1);
  for (std::size_t c = shift.reference; c-- > 0;) lay(c, c + 1);

  Superposition result;
  constexpr int rounds = 3;
  constexpr double reach = 3;  // factors e by which a fit of all curves may move one
  for (int round = 0; round < rounds; ++round) {
    const FrequencyResponseData all = together(curves, laid);
    result.master = fit(all, master, options);
    if (!result.master.usable() || round + 1 == rounds) break;
    const LogCurve on = drawn(result.master, options.realisation, all, options.component);
    if (on.log_omega.size() < 4) break;
    for (std::size_t c = 0; c < curves.size(); ++c)
      laid[c] = laid_on(logs[c], on, shift.vertical, laid[c].shift - reach, laid[c].shift + reach);
    // The reference stays where it is.
    const Laid back = laid[shift.reference];
    for (Laid& each : laid) each = {each.shift - back.shift, each.vertical - back.vertical};
  }
  for (const Laid& each : laid) {
    result.horizontal.push_back(std::exp(each.shift));
    result.vertical.push_back(std::exp(each.vertical));
  }
  return result;
}

FitResult fit_laid(const std::vector<JointCurve>& curves, const std::vector<double>& horizontal,
                   const std::vector<double>& vertical, const Structure& master, const FitOptions& options) {
  std::vector<Laid> laid;
  for (std::size_t c = 0; c < curves.size(); ++c) laid.push_back({std::log(horizontal[c]), std::log(vertical[c])});
  return fit(together(curves, laid), master, options);
}

}  // namespace detail

Structure shifted(const Structure& master, const CurveShift& shift) {
  for (const std::string& name : master.parameter_names()) {
    if (name == horizontal_shift || name == vertical_shift)
      throw std::invalid_argument("parameter '" + name + "' of " + master.formula() +
                                  " has the name of a shift factor; give it another one");
  }
  const std::string moved = detail::with_shifted_s(master.formula());
  return Structure(shift.vertical ? std::string(vertical_shift) + " (" + moved + ")" : moved);
}

}  // namespace frac
