// SPDX-License-Identifier: BSD-3-Clause
#include "identification/verdict/verdict.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>
#include <stdexcept>
#include <utility>

#include "frac/identification/validate.hpp"
#include "identification/data/fit_data.hpp"
#include "identification/data/residual_rule.hpp"
#include "identification/statistics/autocorrelation.hpp"
#include "identification/statistics/curvature_fit.hpp"
#include "identification/verdict/distribution_rival.hpp"
#include "identification/verdict/finalists.hpp"
#include "identification/verdict/next_measurement.hpp"
#include "identification/verdict/ruling.hpp"
#include "identification/verdict/verdict_sentence.hpp"

namespace frac::detail {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr double most_model_error = 0.05;  // of the data

/// Where within a decade outside the data two fits differ most.
void differ_most(IdentificationResult& result, const FrequencyResponseData& data, const FitOptions& options,
                 const Comparison& pair) {
  if (!pair.fractional.is_fractional() || pair.integer.ranked.model_class != ModelClass::integer_order) return;
  std::vector<double> omega;
  constexpr int steps = 20;
  for (int i = 1; i <= steps; ++i) {
    const double factor = std::pow(10.0, static_cast<double>(i) / steps);
    omega.push_back(data.omega().front() / factor);
    omega.push_back(data.omega().back() * factor);
  }
  if (!std::holds_alternative<ExactRealisation>(options.realisation)) return;
  const auto a = fitted_response(pair.fractional.ranked.fit, options.realisation, omega);
  const auto b = fitted_response(pair.integer.ranked.fit, options.realisation, omega);
  double most = -1;
  for (std::size_t i = 0; i < omega.size(); ++i) {
    const double difference = std::abs(a[i] / b[i] - 1.0);
    if (!(difference > most)) continue;
    most = difference;
    result.differ_most = difference;
    result.differ_most_omega = omega[i];
  }
}

template <class Data>
AxisUnit axis_unit(const Data& data) {
  if constexpr (is_response<Data>)
    return {to_string(data.frequency_unit()), in_unit(1, data.frequency_unit())};
  else
    return {"s", 1};
}

/// Whether many values repeat their neighbours': they are rounded so coarsely that the steps are a shape of their own,
/// which a model of many parameters follows.
bool coarsely_rounded(const FrequencyResponseData& data, const FitOptions& options) {
  constexpr double most_repeats = 0.05;
  std::size_t repeats = 0, pairs = 0;
  const auto count = [&](double value, double before) {
    ++pairs;
    repeats += value == before && value != 0 ? 1 : 0;
  };
  for (std::size_t k = 1; k < data.size(); ++k) {
    if (data.omega()[k] == data.omega()[k - 1]) continue;
    if (options.component != Component::imaginary) count(data.value()[k].real(), data.value()[k - 1].real());
    if (options.component != Component::real) count(data.value()[k].imag(), data.value()[k - 1].imag());
  }
  return static_cast<double>(repeats) > most_repeats * static_cast<double>(pairs);
}

template <class Data>
bool within_model_error(const Data& data, const OptionsOf<Data>& options, const FitResult& fit) {
  if constexpr (is_response<Data>) {
    return fit.rms <= most_model_error * residual_rule(data, options).unit;
  } else {
    double square = 0;
    for (const double each : weighted_output(data)) square += each * each;
    return fit.rms <= most_model_error * std::sqrt(square / static_cast<double>(points(data)));
  }
}

/// What would let the skipped rivals take part.
std::string advice_on_skipped(const FitOptions& options) {
  const bool one_number = options.component == Component::magnitude || options.component == Component::phase;
  return one_number ? ": families of ratios are fitted to the real and the imaginary part, not to a magnitude or a "
                      "phase; fit both parts (component both) to have them compared"
                    : "";
}

void suggest_next(IdentificationResult& result, const FrequencyResponseData& data, const FitOptions& options,
                  const Comparison& pair) {
  if (pair.integer.ranked.model_class != ModelClass::integer_order) return;
  const RankedFit& better = result.evidence > 0 ? pair.fractional.ranked : pair.integer.ranked;
  const double noise = std::max(better.lack_of_fit.noise, better.fit.rms);
  result.next = next_measurement(data, options, pair.fractional.ranked.fit, pair.integer.ranked.fit, noise,
                                 evidence_to_decide(result.evidence));
  // Where the two are one model in two spellings, nothing tells them apart.
  if (result.next && !(result.next->expected_evidence > no_evidence)) result.next.reset();
  if (result.next) result.notes.push_back(advice(*result.next, noise, axis_unit(data)));
}

/// Whether no linear, causal and stable system gives such data: what they depart by is no evidence of a class, and a
/// power in the place of a resonance follows a part of it.  A system that is known to be unstable is not tested.
bool is_invalid(const FrequencyResponseData& data, const FitOptions& options) {
  const bool tested =
      options.component == Component::both && options.weight != Weight::repeats && options.assumptions.stable != false;
  return tested && validate(data, {.most_points = points_in_passing}).validity == Validity::invalid;
}

void call_inadequate(IdentificationResult& result, const AxisUnit& unit) {
  result.verdict = Verdict::no_adequate_model;
  result.verdict_sentence = sentence_without_model(result.ranking.at(result.chosen));
  result.notes = {note_without_model(result.ranking.at(result.chosen), unit)};
}

/// Whether a ratio was grown from the data and no fractional family was.
bool only_integer_grew(const std::vector<Competitor>& competitors, const Competitor& integer) {
  const auto grew = [](const Competitor& each) {
    return each.is_fractional() && each.ranked.from_family && !each.passive;
  };
  return integer.ranked.from_family && std::none_of(competitors.begin(), competitors.end(), grew);
}

template <class Data>
Comparison comparison_of(const Data& data, const OptionsOf<Data>& options, const std::vector<Competitor>& competitors,
                         const Finalists& finalists, bool model_error) {
  const Competitor &f = competitors[*finalists.fractional], &i = competitors[*finalists.integer];
  const Competitor& better = criterion(f) < criterion(i) ? f : i;
  const double share = independent_share(autocorrelation(better.residual, residuals_per_point(data, options), 1));
  // Where both are off by model error alone, each is judged as if it followed the data if it comes close.
  const auto comes_close = [&](const Competitor& each) {
    return model_error && within_model_error(data, options, each.ranked.fit);
  };
  bool rounded = false;
  if constexpr (is_response<Data>) rounded = coarsely_rounded(data, options);
  return {.fractional = f,
          .integer = i,
          .fractional_follows = finalists.fractional_follows || comes_close(f),
          .integer_follows = finalists.integer_follows || comes_close(i),
          .share = share,
          .orders = orders_of(f, share),
          .departure = evidence_of_departure(competitors, i, share),
          .only_integer_grew = only_integer_grew(competitors, i),
          .rounded = rounded,
          .over_time = !is_response<Data>};
}

/// Points [first, last) that are left out together.
using Block = std::pair<std::size_t, std::size_t>;

/// Blocks of neighbouring points, each point in one.
std::vector<Block> even_blocks(std::size_t points, std::size_t count) {
  std::vector<Block> blocks;
  for (std::size_t i = 0; i < count; ++i) blocks.emplace_back(i * points / count, (i + 1) * points / count);
  return blocks;
}

/// Such blocks of half a decade, but five to ten of them.
std::vector<Block> half_decades(const FrequencyResponseData& data) {
  // Over a longer gap structures of many parameters say nothing.
  const double count = 2 * std::log10(data.omega().back() / data.omega().front());
  return even_blocks(data.size(), static_cast<std::size_t>(std::clamp(std::round(count), 5.0, 10.0)));
}

/// The points within half a decade of either end; none where that takes more than a third of them.
std::vector<Block> end_blocks(const FrequencyResponseData& data) {
  const double half_decade = std::sqrt(10.0);
  const std::vector<double>& omega = data.omega();
  const auto below = std::upper_bound(omega.begin(), omega.end(), omega.front() * half_decade);
  const auto above = std::lower_bound(omega.begin(), omega.end(), omega.back() / half_decade);
  const auto lower = static_cast<std::size_t>(below - omega.begin());
  const auto upper = static_cast<std::size_t>(omega.end() - above);
  if (3 * (lower + upper) > 2 * omega.size()) return {};
  return {{0, lower}, {omega.size() - upper, omega.size()}};
}

/// The options of a fit that starts where the competitor's ended, with what ended at a limit held there; empty where an
/// estimate is not finite.
template <class Options>
std::optional<Options> refit_options(Options options, const Competitor& competitor) {
  options.constraints = competitor.ranked.model.constraints;
  for (const ParameterEstimate& estimate : competitor.ranked.fit.parameters) {
    if (!std::isfinite(estimate.value)) return std::nullopt;
    if (estimate.at_bound) hold(options, estimate.name, estimate.value);
  }
  return started_at(std::move(options), competitor.ranked.fit);
}

/// rms of the weighted residuals with which fits to the rest predict each block, started from the fit to all; infinity
/// where one of them fails, NaN without a block.
template <class Data>
double prediction_rms(const Data& data, const OptionsOf<Data>& options, const Competitor& competitor,
                      const std::vector<Block>& blocks) {
  if (blocks.empty()) return std::numeric_limits<double>::quiet_NaN();
  constexpr double failed = std::numeric_limits<double>::infinity();
  const std::size_t per_point = residuals_per_point(data, options);
  double square = 0, count = 0;
  const auto add = [&](const std::vector<double>& residual, const Block& block) {
    for (std::size_t i = block.first * per_point; i < block.second * per_point; ++i)
      square += residual[i] * residual[i];
    count += static_cast<double>((block.second - block.first) * per_point);
  };
  if (competitor.ranked.model_class == ModelClass::fixed_curve) {
    for (const Block& block : blocks) add(competitor.residual, block);
    return std::sqrt(square / count);
  }
  const Structure structure(competitor.ranked.fit.model);
  const auto started = refit_options(options, competitor);
  if (!started) return failed;
  for (const Block& block : blocks) {
    try {
      const FitResult fit = refit(part_of(data, block.first, block.second, false), structure, *started);
      if (fit.termination == FitTermination::no_usable_start) return failed;
      add(weighted_residuals(data, options, fit), block);
    } catch (const std::invalid_argument&) {
      return failed;
    }
  }
  return std::isfinite(square) ? std::sqrt(square / count) : failed;
}

template <class Data>
void predict(const Data& data, const OptionsOf<Data>& options, const Competitor& competitor, Finalist& finalist) {
  const auto rms = [&](const std::vector<Block>& blocks) { return prediction_rms(data, options, competitor, blocks); };
  if constexpr (is_response<Data>) {
    finalist.prediction_rms = rms(half_decades(data));
    finalist.extrapolation_rms = rms(end_blocks(data));
  } else {
    finalist.prediction_rms = rms(even_blocks(points(data), 5));
  }
}

template <class Data>
void compare(IdentificationResult& result, const Data& data, const OptionsOf<Data>& options, const Comparison& pair,
             const std::vector<Competitor>& competitors, const std::vector<std::string>& skipped_rivals) {
  result.evidence = evidence_for(pair.fractional, pair.integer, pair.share);
  result.departure_evidence = pair.departure.evidence;
  if constexpr (is_response<Data>) {
    const auto beside = evidence_beside_smooth_error(competitors, residuals_per_point(data, options));
    result.evidence_beside_smooth_error = beside.fractional;
    result.departure_beside_smooth_error = beside.departing;
  }
  if constexpr (is_response<Data>) differ_most(result, data, options, pair);
  predict(data, options, pair.fractional, *result.fractional);
  predict(data, options, pair.integer, *result.integer);

  Ruling decided = ruling(result, pair, skipped_rivals);
  bool invalid = false;
  if constexpr (is_response<Data>) {
    invalid = decided.verdict == Verdict::fractional_supported && is_invalid(data, options);
    if (invalid)
      decided = {Verdict::undecided,
                 ", but the data are invalid as the response of a linear, causal and stable system (see validate)"};
    if (decided.verdict == Verdict::fractional_supported)
      result.distribution = distribution_rival(data, options, pair.fractional, pair.share);
    if (result.distribution && !decides(result.distribution->evidence))
      decided.verdict = Verdict::fractional_or_distribution;
  }
  const bool departing = departure_decides(result, pair, decided.verdict);
  result.log10_odds = log10_odds(departing ? result.departure_evidence : result.evidence, decided.verdict);
  const bool undecided = decided.verdict == Verdict::undecided;
  if (result.model_error && undecided) return call_inadequate(result, axis_unit(data));
  if constexpr (is_response<Data>) {
    if (undecided && !skipped_rivals.empty()) decided.reason += advice_on_skipped(options);
  }
  result.verdict = decided.verdict;
  result.verdict_sentence = verdict_sentence(result, pair, decided);
  result.notes = verdict_notes(result, pair, decided, axis_unit(data));
  if constexpr (is_response<Data>) {
    if (undecided && !invalid) suggest_next(result, data, options, pair);
  }
}

}  // namespace

template <class Data>
void judge(IdentificationResult& result, const Data& data, const OptionsOf<Data>& options,
           const std::vector<Competitor>& competitors, const std::vector<std::string>& skipped_rivals) {
  result.verdict = Verdict::undecided;
  result.evidence = result.departure_evidence = result.log10_odds = result.differ_most = result.differ_most_omega = nan;
  result.evidence_beside_smooth_error = result.departure_beside_smooth_error = nan;
  if constexpr (is_response<Data>) {
    if (options.without_noise) {
      result.verdict_sentence = no_noise_sentence;
      return;
    }
  }
  if (std::none_of(competitors.begin(), competitors.end(), is_comparable)) {
    result.verdict_sentence =
        "There are too few residuals (" + std::to_string(competitors.front().residual.size()) +
        ") to judge any candidate; at least three more are needed than it has parameters, and twice as many.";
    return;
  }
  const Finalists finalists = finalists_of(competitors);
  const auto finalist = [&](std::size_t index) {
    return Finalist{index, competitors[index].ranked.fit.free_parameters, nan, nan};
  };
  if (finalists.fractional) result.fractional = finalist(*finalists.fractional);
  if (finalists.integer) result.integer = finalist(*finalists.integer);
  result.model_error = !finalists.fractional_follows && !finalists.integer_follows;
  if (!result.fractional || !result.integer) {
    if (result.model_error) return call_inadequate(result, axis_unit(data));
    result.verdict_sentence = result.fractional
                                  ? "Only fractional-order candidates could be ranked, so nothing is compared."
                                  : "No fractional-order candidate could be ranked, so nothing is compared.";
    return;
  }
  const Comparison pair = comparison_of(data, options, competitors, finalists, result.model_error);
  if (!pair.fractional_follows && !pair.integer_follows) return call_inadequate(result, axis_unit(data));
  compare(result, data, options, pair, competitors, skipped_rivals);
}

template void judge(IdentificationResult&, const FrequencyResponseData&, const FitOptions&,
                    const std::vector<Competitor>&, const std::vector<std::string>&);
template void judge(IdentificationResult&, const TimeResponseData&, const TimeFitOptions&,
                    const std::vector<Competitor>&, const std::vector<std::string>&);

}  // namespace frac::detail
