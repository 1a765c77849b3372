// SPDX-License-Identifier: BSD-3-Clause
#include "frac/time_response/response_methods.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>

#include "base/bound_text.hpp"
#include "base/counted.hpp"
#include "base/short_text.hpp"
#include "base/spelling.hpp"
#include "event_response.hpp"
#include "frac/cancellation.hpp"
#include "frac/model/algebra.hpp"
#include "frac/model/time_response_data.hpp"
#include "sample_checks.hpp"
#include "steady_response.hpp"

namespace frac {
namespace {

using Kind = ResponseInput::Kind;
constexpr double finest = 1e-13;  // of a sum of exponentials

constexpr detail::Spellings<ResponseMethod, 6> method_names{{{ResponseMethod::automatic, "auto"},
                                                             {ResponseMethod::reference, "reference"},
                                                             {ResponseMethod::exponential_sum, "exponential-sum"},
                                                             {ResponseMethod::grunwald_letnikov, "grunwald-letnikov"},
                                                             {ResponseMethod::bdf2, "bdf2"},
                                                             {ResponseMethod::ladder, "ladder"}}};

[[noreturn]] void refuse(const std::string& reason) {
  throw std::invalid_argument("respond: " + reason);
}

/// The sum of exponentials has no number somewhere; the reference may have.
class NoFiniteSum : public std::invalid_argument {
  using std::invalid_argument::invalid_argument;
};

std::string at(const char* list, std::size_t index, double value) {
  return std::string(list) + "[" + std::to_string(index) + "] = " + detail::number_text(value);
}

void check_instants(std::span<const double> time, const char* list, double first) {
  if (time.empty()) refuse(std::string("no instants in ") + list);
  for (std::size_t i = 0; i < time.size(); ++i) {
    if (!std::isfinite(time[i])) refuse(at(list, i, time[i]) + " s is not finite");
    if (time[i] < first) {
      refuse(at(list, i, time[i]) + " s lies before the input begins, at " + detail::number_text(first) + " s");
    }
    if (i > 0 && !(time[i] > time[i - 1])) {
      refuse(at(list, i, time[i]) + " s does not lie after " + detail::number_text(time[i - 1]) + " s");
    }
  }
}

void check(const TimeInput& input, std::span<const double> time, double tolerance) {
  double first = 0;
  if (const auto* sampled = std::get_if<SampledInput>(&input)) {
    if (sampled->time.size() != sampled->value.size()) {
      refuse(std::to_string(sampled->time.size()) + " instants but " + std::to_string(sampled->value.size()) +
             " samples of the input");
    }
    check_instants(sampled->time, "input.time", -std::numeric_limits<double>::infinity());
    detail::check_samples(sampled->value, "respond");
    first = sampled->time.front();
  }
  check_instants(time, "time", first);
  if (!(tolerance >= 1e-15 && tolerance <= 0.1)) {
    refuse("tolerance = " + detail::number_text(tolerance) + "; allowed is 1e-15 to 0.1");
  }
}

// Step of instants first, first + T, first + 2 T, ...; 0 for any other.
double even_step(std::span<const double> time, double first) {
  if (time.size() < 2 || time[0] != first) return 0;
  const double step = (time.back() - first) / static_cast<double>(time.size() - 1);
  for (std::size_t n = 0; n < time.size(); ++n) {
    if (std::abs(time[n] - first - static_cast<double>(n) * step) > 1e-9 * step) return 0;
  }
  return step;
}

// Samples with their step where input and output share even instants from the first sample on; else no samples.
struct EvenSamples {
  std::vector<double> value;
  double step = 0;
  Hold hold = Hold::zero_order;
};
EvenSamples even_samples(const TimeInput& input, std::span<const double> time) {
  if (const auto* sampled = std::get_if<SampledInput>(&input)) {
    const double step = even_step(time, sampled->time.front());
    if (step == 0 || sampled->time.size() < time.size() ||
        !std::equal(time.begin(), time.end(), sampled->time.begin())) {
      return {};
    }
    return {{sampled->value.begin(), sampled->value.begin() + static_cast<std::ptrdiff_t>(time.size())},
            step,
            sampled->hold};
  }
  const auto& named = std::get<ResponseInput>(input);
  const double step = even_step(time, 0);
  if (step == 0) return {};
  switch (named.kind) {
    case Kind::step:
      return {std::vector<double>(time.size(), 1.0), step, Hold::zero_order};
    case Kind::ramp:
      return {{time.begin(), time.end()}, step, Hold::first_order};
    case Kind::sine: {
      EvenSamples samples{{}, step, Hold::first_order};
      for (const double t : time) samples.value.push_back(std::sin(named.omega * t));
      return samples;
    }
    case Kind::impulse:
      break;
  }
  return {};
}

bool is_held_exactly(const TimeInput& input) {
  const auto* named = std::get_if<ResponseInput>(&input);
  return !named || named->kind == Kind::step || named->kind == Kind::ramp;
}

// The model whose step response is the response to the named input.
FractionalTransferFunction stepped(const FractionalTransferFunction& model, const ResponseInput& input) {
  const FractionalTransferFunction s({{1, 1}}, {{1, 0}});
  switch (input.kind) {
    case Kind::step:
      return model;
    case Kind::ramp:
      return model / s;
    case Kind::impulse:
      return model * s;
    case Kind::sine:
      break;
  }
  return model * FractionalTransferFunction({{input.omega, 1}}, {{1, 2}, {input.omega * input.omega, 0}});
}

std::vector<double> by_events(const FractionalTransferFunction& model, const TimeInput& input,
                              std::span<const double> time, double tolerance) {
  const std::vector<double> instants(time.begin(), time.end());
  const auto* named = std::get_if<ResponseInput>(&input);
  const FractionalTransferFunction driven = named ? stepped(model, *named) : model;
  const detail::EventResponse events = [&]() -> detail::EventResponse {
    if (named) return {{0.0}, {1.0}, Hold::zero_order, instants};
    const auto& sampled = std::get<SampledInput>(input);
    return {sampled.time, sampled.value, sampled.hold, instants};
  }();
  detail::EventResponse::Result result;
  if (!events.evaluate(driven, tolerance, result)) {
    throw NoFiniteSum(
        "respond: the exponential sum has no finite response: the poles could not be counted, the response begins "
        "infinite, or it outgrows a double up to " +
        detail::number_text(time.back()) + " s; the method reference gives the instants before that");
  }
  return {result.value.begin(), result.value.end()};
}

std::vector<double> by_exponentials(const FractionalTransferFunction& model, const TimeInput& input,
                                    const EvenSamples& even, std::span<const double> time, double tolerance) {
  constexpr std::size_t few = 200;
  if (even.step > 0 && is_held_exactly(input) && time.size() > few) {
    return respond(model, even.value, even.step, tolerance, even.hold);
  }
  return by_events(model, input, time, 0.1 * tolerance);
}

TimeResponse by_reference(const FractionalTransferFunction& model, const TimeInput& input,
                          std::span<const double> time) {
  TimeResponse response{std::vector<double>(time.size(), 0.0), ResponseMethod::reference, 0, true};
  if (const auto* named = std::get_if<ResponseInput>(&input)) {
    const std::vector<ReferenceValue> values = reference_response(model, *named, time);
    for (std::size_t i = 0; i < time.size(); ++i) {
      response.output[i] = values[i].value;
      // An infinity at the start belongs to the response itself; a later one means that the response outgrows a double.
      if (std::isfinite(values[i].value) || time[i] > model.delay()) {
        response.error_estimate = std::max(response.error_estimate, values[i].error_estimate);
      }
    }
    return response;
  }
  // The sum of the responses to every jump and every change of slope.
  std::vector<double> error(time.size(), 0.0);
  const ReferenceResponse step(model, {Kind::step});
  const ReferenceResponse ramp(model, {Kind::ramp});
  const auto add = [&](const ReferenceResponse& reference, double since, double factor) {
    for (std::size_t i = 0; i < time.size(); ++i) {
      if (time[i] < since) continue;
      throw_if_cancelled();
      const ReferenceValue value = reference(time[i] - since);
      response.output[i] += factor * value.value;
      error[i] += std::abs(factor) * value.error_estimate;
    }
  };
  const auto& sampled = std::get<SampledInput>(input);
  double before = 0;
  double slope = 0;
  for (std::size_t n = 0; n < sampled.time.size(); ++n) {
    const bool straight = sampled.hold == Hold::first_order;
    const double jump = n == 0 || !straight ? sampled.value[n] - before : 0;
    const double next = straight && n + 1 < sampled.time.size()
                            ? (sampled.value[n + 1] - sampled.value[n]) / (sampled.time[n + 1] - sampled.time[n])
                            : 0;
    if (jump != 0) add(step, sampled.time[n], jump);
    if (next != slope) add(ramp, sampled.time[n], next - slope);
    before = sampled.value[n];
    slope = next;
  }
  response.error_estimate = *std::max_element(error.begin(), error.end());
  return response;
}

double largest(const std::vector<double>& values) {
  double size = 0;
  for (const double value : values) {
    if (std::isfinite(value)) size = std::max(size, std::abs(value));
  }
  return size;
}

// Picks some twenty instants, close together at first.
std::vector<std::size_t> judged_instants(std::size_t count) {
  std::vector<std::size_t> list;
  for (std::size_t n = 0; n + 1 < count; n = n < 4 ? n + 1 : n + n / 2) list.push_back(n);
  list.push_back(count - 1);
  return list;
}

// The largest difference from the reference at those instants.
double difference_from_reference(const FractionalTransferFunction& model, const ResponseInput& input,
                                 std::span<const double> time, const std::vector<double>& output) {
  const ReferenceResponse reference(model, input);
  double worst = 0;
  for (const std::size_t n : judged_instants(time.size())) {
    const ReferenceValue value = reference(time[n]);
    if (std::isfinite(value.value) && std::isfinite(output[n])) {
      worst = std::max(worst, std::abs(output[n] - value.value) + value.error_estimate);
    } else if (time[n] > model.delay()) {
      worst = std::numeric_limits<double>::infinity();
    }
  }
  return worst;
}

double difference(const std::vector<double>& a, const std::vector<double>& b) {
  double worst = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    const double each = std::abs(a[i] - b[i]);
    worst = std::isnan(each) ? std::numeric_limits<double>::infinity() : std::max(worst, each);
  }
  return worst;
}

// A recursion that has outgrown a double goes on with NaN: these values become infinite, with the sign of the last
// number.
void mark_outgrown(std::vector<double>& output, ResponseMethod method) {
  double last = 0;
  for (std::size_t i = 0; i < output.size(); ++i) {
    if (std::isnan(output[i])) {
      if (last == 0) {
        refuse("method " + std::string(to_string(method)) + " has no number at output[" + std::to_string(i) +
               "]: its coefficients leave the range of a double");
      }
      output[i] = std::copysign(std::numeric_limits<double>::infinity(), last);
    }
    if (output[i] != 0) last = output[i];
  }
}

// Methods that may meet the tolerance, the cheapest first, by seconds measured on one core of 2 GHz: only their ratios
// matter, and that nobody waits longer than some twenty seconds for a second one.
std::vector<ResponseMethod> candidates(const FractionalTransferFunction& model, const TimeInput& input,
                                       const EvenSamples& even, std::span<const double> time, double tolerance) {
  const auto* named = std::get_if<ResponseInput>(&input);
  const bool begins_infinite =
      named && detail::order_at_infinity(named->kind == Kind::impulse ? stepped(model, *named) : model) > 0;
  if (tolerance < finest || begins_infinite) return {ResponseMethod::reference};
  const auto instants = static_cast<double>(time.size());
  const double knots = named ? 1 : static_cast<double>(std::get<SampledInput>(input).time.size());
  constexpr double per_value = 1.5e-4;
  constexpr double longest = 20;
  const double by_reference = per_value * instants * knots;
  // Its error is judged by some twenty values of the reference, or by a second sum.
  const double judge = named ? per_value * std::min(instants, 20.0) : 4e-4;
  const double by_exponentials = 4e-4 + judge + (even.step > 0 ? 3e-8 * instants : 1e-6 * (instants + knots));
  if (by_reference < by_exponentials) return {ResponseMethod::reference, ResponseMethod::exponential_sum};
  if (by_reference > longest) return {ResponseMethod::exponential_sum};
  return {ResponseMethod::exponential_sum, ResponseMethod::reference};
}

// The difference from a sum made for a thousandth of the tolerance, plus the error of that one.  The finest sum can
// only be compared with a coarser one, and both may err by the same roundings, so three times the difference counts.
double difference_from_finer_sum(const FractionalTransferFunction& model, const TimeInput& input,
                                 const EvenSamples& even, std::span<const double> time, double tolerance,
                                 const TimeResponse& response) {
  if (response.method == ResponseMethod::exponential_sum && tolerance < 10 * finest) {
    return 3 * difference(response.output, by_exponentials(model, input, even, time, 10 * finest));
  }
  const double finer = std::max(finest, 1e-3 * tolerance);
  return difference(response.output, by_exponentials(model, input, even, time, finer)) +
         finer * largest(response.output);
}

// The largest difference at all instants from a sum made for a thousandth of the tolerance, plus that of this sum from
// the reference at the judged ones: what lies between them differs from either by the difference of the two sums.
double difference_from_exact(const FractionalTransferFunction& model, const ResponseInput& input,
                             const EvenSamples& even, std::span<const double> time, double tolerance,
                             const TimeResponse& response) {
  const double judged = difference_from_reference(model, input, time, response.output);
  // No finer sum is to be had of the finest, whose error is rounding.
  if (response.method == ResponseMethod::exponential_sum && tolerance < 10 * finest) return judged;
  std::vector<double> finer;
  try {
    finer = by_exponentials(model, input, even, time, std::max(finest, 1e-3 * tolerance));
  } catch (const NoFiniteSum&) {
    return judged;
  }
  double between = 0;
  for (std::size_t i = 0; i < time.size(); ++i) {
    // What is infinite in both has been judged.
    if (!std::isfinite(response.output[i]) || !std::isfinite(finer[i])) continue;
    between = std::max(between, std::abs(response.output[i] - finer[i]));
  }
  return std::max(judged, between + difference_from_reference(model, input, time, finer));
}

TimeResponse by_method(ResponseMethod method, const FractionalTransferFunction& model, const TimeInput& input,
                       const EvenSamples& even, std::span<const double> time, double tolerance) {
  TimeResponse response{{}, method, 0, true};
  switch (method) {
    case ResponseMethod::automatic:
    case ResponseMethod::reference:
      response = by_reference(model, input, time);
      break;
    case ResponseMethod::exponential_sum:
      response.output = by_exponentials(model, input, even, time, std::max(tolerance, finest));
      break;
    case ResponseMethod::grunwald_letnikov:
      response.output = respond_grunwald_letnikov(model, even.value, even.step);
      break;
    case ResponseMethod::bdf2:
      response.output = respond_bdf2(model, even.value, even.step);
      break;
    case ResponseMethod::ladder:
      response.output = respond_ladder(model, even.value, even.step, std::clamp(tolerance, 1e-8, 0.1), even.hold);
      break;
  }
  mark_outgrown(response.output, method);
  if (method != ResponseMethod::reference) {
    if (const auto* named = std::get_if<ResponseInput>(&input)) {
      response.error_estimate = difference_from_exact(model, *named, even, time, tolerance, response);
    } else {
      response.error_estimate = difference_from_finer_sum(model, input, even, time, tolerance, response);
    }
  }
  response.meets_tolerance = response.error_estimate <= tolerance * largest(response.output);
  return response;
}

// Whether the reference is sure enough of itself at the judged instants.
bool reference_may_meet(const FractionalTransferFunction& model, const TimeInput& input, std::span<const double> time,
                        double error) {
  const auto* named = std::get_if<ResponseInput>(&input);
  if (!named) return true;
  const ReferenceResponse reference(model, *named);
  const std::vector<std::size_t> instants = judged_instants(time.size());
  return std::all_of(instants.begin(), instants.end(),
                     [&](std::size_t n) { return reference(time[n]).error_estimate <= error; });
}

std::optional<TimeResponse> where_finite(ResponseMethod method, const FractionalTransferFunction& model,
                                         const TimeInput& input, const EvenSamples& even, std::span<const double> time,
                                         double tolerance) {
  try {
    return by_method(method, model, input, even, time, tolerance);
  } catch (const NoFiniteSum&) {
    return std::nullopt;
  }
}

TimeResponse by_cheapest(const FractionalTransferFunction& model, const TimeInput& input, const EvenSamples& even,
                         std::span<const double> time, double tolerance) {
  const std::vector<ResponseMethod> methods = candidates(model, input, even, time, tolerance);
  if (methods.size() == 1) return by_method(methods[0], model, input, even, time, tolerance);
  const std::optional<TimeResponse> first = where_finite(methods[0], model, input, even, time, tolerance);
  if (!first) return by_method(methods[1], model, input, even, time, tolerance);
  if (first->meets_tolerance) return *first;
  if (methods[1] == ResponseMethod::reference &&
      !reference_may_meet(model, input, time, tolerance * largest(first->output))) {
    return *first;
  }
  const std::optional<TimeResponse> second = where_finite(methods[1], model, input, even, time, tolerance);
  const bool is_better = second && (second->meets_tolerance || second->error_estimate < first->error_estimate);
  return is_better ? *second : *first;
}

// The periodic steady state, exact but for rounding: a Fourier sum of n samples and a sum over its lines round by about
// as many last digits as they have halvings.
TimeResponse by_lines(const FractionalTransferFunction& model, const SampledInput& input, std::span<const double> time,
                      double tolerance, ResponseMethod method) {
  if (method != ResponseMethod::automatic && method != ResponseMethod::reference) {
    refuse("method " + std::string(to_string(method)) +
           " runs from rest; the steady state of a band-limited input takes auto or reference");
  }
  const TimeResponseData checked(input.time, input.value, std::vector<double>(input.time.size(), 0.0), {}, input.hold);
  TimeResponse response{detail::steady_response(model, {checked.time(), checked.input()}, time),
                        ResponseMethod::reference, 0, true};
  constexpr double eps = std::numeric_limits<double>::epsilon();
  response.error_estimate = eps * (10 + std::log2(static_cast<double>(input.time.size()))) * largest(response.output);
  response.meets_tolerance = response.error_estimate <= tolerance * largest(response.output);
  return response;
}

}  // namespace

std::string_view to_string(ResponseMethod method) noexcept {
  return detail::spelling(method_names, method);
}

ResponseMethod response_method_from_string(std::string_view name) {
  return detail::from_spelling(method_names, "response method", name);
}

std::span<const ResponseMethod> response_methods() {
  static constexpr auto all = detail::enumerators(method_names);
  return all;
}

TimeResponse respond(const FractionalTransferFunction& model, const TimeInput& input, std::span<const double> time,
                     double tolerance, ResponseMethod method) {
  check(input, time, tolerance);
  const auto* const sampled = std::get_if<SampledInput>(&input);
  if (sampled && sampled->hold == Hold::band_limited) return by_lines(model, *sampled, time, tolerance, method);
  const EvenSamples even = even_samples(input, time);
  if (method == ResponseMethod::automatic) return by_cheapest(model, input, even, time, tolerance);
  const bool steps_along =
      method == ResponseMethod::grunwald_letnikov || method == ResponseMethod::bdf2 || method == ResponseMethod::ladder;
  if (steps_along && even.step == 0) {
    refuse("method " + std::string(to_string(method)) +
           " needs a step, ramp or sine at instants 0, T, 2 T, ..., or samples at even instants that are those of the "
           "output");
  }
  return by_method(method, model, input, even, time, tolerance);
}

std::string TimeResponse::summary() const {
  using detail::short_text;
  return detail::counted(output.size(), "instant") + " by " + std::string(to_string(method)) + ", largest output " +
         short_text(largest(output)) + ", estimated error " + detail::bound_text(error_estimate) +
         (meets_tolerance ? "." : ", more than the tolerance allows.");
}

}  // namespace frac
