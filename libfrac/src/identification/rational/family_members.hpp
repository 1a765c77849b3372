// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <complex>
#include <cstddef>
#include <limits>
#include <memory>
#include <optional>
#include <vector>

#include "frac/identification/model_library.hpp"
#include "identification/data/fit_data.hpp"

namespace frac::detail {

/// The members of a family on given data, simplest member first, as formulas with start values.
struct FamilyMembers {
  std::vector<NamedModel> models;
  std::size_t chosen = 0;  // by BIC and the price of the search
  /// The amount by which the best member with an order that departs from whole numbers lies above the chosen one, in
  /// the measure of schwarz(); infinite without such a member.
  double departed = std::numeric_limits<double>::infinity();
  bool exact = false;           // the largest member meets the data to rounding, so that none was tried beyond it
  std::size_t relaxations = 0;  // RationalShape::relaxations() of the chosen one, for ratios in s
  /// Whether the chosen one, of more than few_relaxations, follows data to 1e-4 or closer and came there as an
  /// approximation does: residuals fell from pole to pole by about the same factor, and not at once.
  bool approximates = false;
  /// Where the family came to an unstable member and to another one with stable poles, that which is not taken.
  std::shared_ptr<const FamilyMembers> set_aside = nullptr;
  bool stands_in = false;  // with stable poles, for an unstable member
  bool passive = false;    // sums of passive elements

  bool open_range = false;  // nobody has told how many poles there may be
  /// Whether the chosen one is the largest that was tried, and further poles might still pay.
  [[nodiscard]] bool is_cut() const { return open_range && !exact && chosen > 0 && chosen + 1 == models.size(); }
};

/// An order departs from the whole numbers that is at least that far from each.
inline constexpr double least_departure = 0.1;
[[nodiscard]] inline bool departs(double order) {
  return std::abs(order - std::round(order)) >= least_departure;
}

/// A row of real poles and dead times approximates many systems, also those that no candidate describes.  A ratio may
/// have so many without being taken for such an approximation.
inline constexpr std::size_t few_relaxations = 2;

class RatioGrowths;  // see rational_growth.hpp

/// Over time none has more zeros than poles: it would have no finite response to a step.
/// @param model   with a family
/// @param ratios  what other families of the same data and options have grown
/// @throws std::invalid_argument  as resolved_model()
[[nodiscard]] FamilyMembers family_members(const FrequencyResponseData& data, const NamedModel& model,
                                           const FitOptions& options, RatioGrowths& ratios);
[[nodiscard]] FamilyMembers family_members(const TimeResponseData& data, const NamedModel& model,
                                           const TimeFitOptions& options, RatioGrowths& ratios);

/// Response of the best ratio of the default family at the frequencies of the data; empty where there is none.
/// @param ratios  nothing, or what has grown of the same data and options
[[nodiscard]] std::vector<std::complex<double>> ratio_response(const FrequencyResponseData& data,
                                                               const FitOptions& options, RatioGrowths& ratios);

/// The rms that no sum of passive elements without modes comes below, whatever their number, in the unit of
/// FitResult::rms; nothing where the data are taken for a receptance, whose elements are modes, or where it is less
/// than the bound itself is known to, as that of data with fewer residuals than it has elements.
[[nodiscard]] std::optional<double> least_rms_of_relaxations(const FrequencyResponseData& data,
                                                             const FitOptions& options);

/// The chosen member alone, which knows whether it ends its family.
[[nodiscard]] FamilyMembers chosen_member(FamilyMembers members);
template <class Data>
[[nodiscard]] FamilyMembers best_member(const Data& data, const NamedModel& model, const OptionsOf<Data>& options,
                                        RatioGrowths& ratios) {
  return chosen_member(family_members(data, model, options, ratios));
}

}  // namespace frac::detail
