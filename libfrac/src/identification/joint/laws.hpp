// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "frac/identification/joint_fit.hpp"

namespace frac::detail {

/// Values of the parameters of laws, and how far these are then from what they are to follow.
struct LawMinimum {
  std::vector<double> values;
  double cost;
};

/// Parameters of a structure that follow laws of what is known of each curve, "K = K0 T^p".
class Laws {
 public:
  /// @throws std::invalid_argument  as joint_fit() says of laws.
  Laws(const Structure& structure, const JointFitOptions& options, const std::vector<JointCurve>& curves);

  [[nodiscard]] std::size_t count() const { return laws_.size(); }
  /// The parameter of the structure that follows this law.
  [[nodiscard]] std::size_t parameter(std::size_t law) const { return laws_[law].parameter; }
  [[nodiscard]] bool drives(std::size_t parameter) const;
  /// Parameters of the laws; one may stand in several of them.
  [[nodiscard]] const std::vector<std::string>& names() const { return names_; }
  [[nodiscard]] bool has(const std::string& name) const;

  /// The value of a law for a curve.
  /// @param values    of names()
  /// @param gradient  by names(), 0 for those that do not stand in the law
  double at(std::size_t law, std::size_t curve, std::span<const double> values, std::span<double> gradient) const;

  /// Whether each law that holds the name is in proportion to it, so that a positive law makes it positive.
  [[nodiscard]] bool scales(std::size_t name, std::span<const double> values) const;

  /// Whether a shift factor follows one of them.
  [[nodiscard]] bool drive_shifts() const;

  /// Sets of values with which the laws follow parameters of single curves; shift factors but for a factor that all
  /// curves have in common, since a law need not be 1 where the curves were laid.  The best first, then others that are
  /// minima too.
  /// @param parameters  of each curve, by the structure
  /// @param weights     of the curves; if all are 0, all count
  /// @param given       starts of the user, NaN where there is none
  [[nodiscard]] std::vector<std::vector<double>> starts(const std::vector<std::vector<double>>& parameters,
                                                        std::vector<double> weights,
                                                        std::span<const double> given) const;

  /// The same of a few curves each that follow each other: where one is laid on its neighbour in a wrong place, all
  /// beyond it are off by the same factor, and the laws follow those on one side alone.
  [[nodiscard]] std::vector<std::vector<double>> starts_of_neighbours(
      const std::vector<std::vector<double>>& parameters, std::span<const double> given) const;

 private:
  /// Minima that searches from so many places end in, the least first.
  /// @param weights  of the curves, of which those above 0 count
  [[nodiscard]] std::vector<LawMinimum> minima(const std::vector<std::vector<double>>& parameters,
                                               const std::vector<double>& weights, std::span<const double> given,
                                               int trials) const;

  struct Law {
    std::size_t parameter;
    bool is_shift;                                // of a factor of CurveShift
    Structure formula;                            // free of s
    std::vector<std::size_t> place;               // of each in names(); `covariate` where a curve knows it
    std::vector<std::vector<double>> covariates;  // values of its names, per curve; NaN for parameters
  };
  std::vector<std::string> names_;
  std::vector<Law> laws_;
};

}  // namespace frac::detail
