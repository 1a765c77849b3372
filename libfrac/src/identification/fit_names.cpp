// SPDX-License-Identifier: BSD-3-Clause
#include <span>
#include <string_view>

#include "base/spelling.hpp"
#include "frac/identification/fit.hpp"
#include "frac/identification/model_choice.hpp"
#include "frac/identification/time_fit.hpp"

namespace frac {

namespace {

constexpr detail::Spellings<Component, 5> component_names = {{
    {Component::imaginary, "imaginary"},
    {Component::real, "real"},
    {Component::both, "both"},
    {Component::magnitude, "magnitude"},
    {Component::phase, "phase"},
}};
constexpr detail::Spellings<Weight, 7> weight_names = {{
    {Weight::relative, "relative"},
    {Weight::absolute, "absolute"},
    {Weight::given, "given"},
    {Weight::smoothed_relative, "smoothed-relative"},
    {Weight::log_complex, "log-complex"},
    {Weight::repeats, "repeats"},
    {Weight::learned, "learned"},
}};
constexpr detail::Spellings<Loss, 3> loss_names = {{
    {Loss::none, "none"},
    {Loss::huber, "huber"},
    {Loss::cauchy, "cauchy"},
}};
constexpr detail::Spellings<RecordNoise, 2> noise_names = {{
    {RecordNoise::white, "white"},
    {RecordNoise::coloured, "coloured"},
}};
constexpr detail::Spellings<FitTermination, 3> termination_names = {{
    {FitTermination::converged, "converged"},
    {FitTermination::not_converged, "not-converged"},
    {FitTermination::no_usable_start, "no-usable-start"},
}};
constexpr detail::Spellings<NoiseSource, 3> source_names = {{
    {NoiseSource::sigma, "sigma"},
    {NoiseSource::repeats, "repeats"},
    {NoiseSource::data, "data"},
}};
constexpr detail::Spellings<ModelClass, 3> class_names = {{
    {ModelClass::fractional, "fractional"},
    {ModelClass::integer_order, "integer-order"},
    {ModelClass::fixed_curve, "fixed-curve"},
}};
constexpr detail::Spellings<Verdict, 5> verdict_names = {{
    {Verdict::fractional_supported, "supported"},
    {Verdict::fractional_or_distribution, "fractional-or-distribution"},
    {Verdict::fractional_not_supported, "not-supported"},
    {Verdict::undecided, "undecided"},
    {Verdict::no_adequate_model, "no-adequate-model"},
}};
constexpr detail::Spellings<IntervalKind, 2> interval_names = {{
    {IntervalKind::curvature, "curvature"},
    {IntervalKind::profile, "profile"},
}};
constexpr detail::Spellings<GrowthFamily, 7> family_names = {{
    {GrowthFamily::powers, "powers"},
    {GrowthFamily::denominator, "denominator"},
    {GrowthFamily::arcs, "arcs"},
    {GrowthFamily::rational, "rational"},
    {GrowthFamily::commensurate, "commensurate"},
    {GrowthFamily::terms, "terms"},
    {GrowthFamily::elements, "elements"},
}};

constexpr detail::Spellings<Remedy, 6> remedy_names{{
    {Remedy::give_limits, "give-limits"},
    {Remedy::estimate_trend, "estimate-trend"},
    {Remedy::estimate_earlier_input, "estimate-earlier-input"},
    {Remedy::hold_zero_order, "hold-zero-order"},
    {Remedy::hold_first_order, "hold-first-order"},
    {Remedy::hold_band_limited, "hold-band-limited"},
}};

}  // namespace

std::string_view to_string(Component component) {
  return detail::spelling(component_names, component);
}
std::string_view to_string(Weight weight) {
  return detail::spelling(weight_names, weight);
}
std::string_view to_string(Loss loss) {
  return detail::spelling(loss_names, loss);
}
std::string_view to_string(RecordNoise noise) {
  return detail::spelling(noise_names, noise);
}
std::string_view to_string(FitTermination termination) {
  return detail::spelling(termination_names, termination);
}
std::string_view to_string(NoiseSource source) {
  return detail::spelling(source_names, source);
}
std::string_view to_string(ModelClass model_class) {
  return detail::spelling(class_names, model_class);
}
std::string_view to_string(Verdict verdict) {
  return detail::spelling(verdict_names, verdict);
}
std::string_view to_string(IntervalKind kind) {
  return detail::spelling(interval_names, kind);
}
std::string_view to_string(GrowthFamily family) {
  return detail::spelling(family_names, family);
}
std::string_view to_string(Remedy remedy) {
  return detail::spelling(remedy_names, remedy);
}
Component component_from_string(std::string_view text) {
  return detail::from_spelling(component_names, "component", text);
}
Weight weight_from_string(std::string_view text) {
  return detail::from_spelling(weight_names, "weight", text);
}
Loss loss_from_string(std::string_view text) {
  return detail::from_spelling(loss_names, "loss", text);
}
RecordNoise record_noise_from_string(std::string_view text) {
  return detail::from_spelling(noise_names, "noise", text);
}
FitTermination fit_termination_from_string(std::string_view text) {
  return detail::from_spelling(termination_names, "termination of a fit", text);
}
IntervalKind interval_kind_from_string(std::string_view text) {
  return detail::from_spelling(interval_names, "kind of interval", text);
}
Remedy remedy_from_string(std::string_view text) {
  return detail::from_spelling(remedy_names, "remedy", text);
}
GrowthFamily growth_family_from_string(std::string_view text) {
  return detail::from_spelling(family_names, "family", text);
}
std::span<const Component> components() {
  static constexpr auto all = detail::enumerators(component_names);
  return all;
}
std::span<const Weight> weights() {
  static constexpr auto all = detail::enumerators(weight_names);
  return all;
}
std::span<const Loss> losses() {
  static constexpr auto all = detail::enumerators(loss_names);
  return all;
}
std::span<const RecordNoise> record_noises() {
  static constexpr auto all = detail::enumerators(noise_names);
  return all;
}
std::span<const GrowthFamily> growth_families() {
  static constexpr auto all = detail::enumerators(family_names);
  return all;
}

}  // namespace frac
