// SPDX-License-Identifier: BSD-3-Clause
#include "section_form.hpp"

#include <algorithm>
#include <cmath>
#include <functional>

namespace frac::detail {

SectionForm::SectionForm(const ZeroPoleGain& system, double sample_time, double slope)
    : time_(sample_time), slope_(slope), gain_(system.gain) {
  for (const double zero : system.zeros) zeros_.push_back(-static_cast<Extended>(zero));
  for (const double pole : system.poles) poles_.push_back(-static_cast<Extended>(pole));
  std::sort(zeros_.begin(), zeros_.end(), std::greater<>());
  std::sort(poles_.begin(), poles_.end(), std::greater<>());
  for (std::size_t i = 0; i < poles_.size(); ++i) {
    gain_ *= (1 + slope_ * zeros_[i] * time_) / (1 + slope_ * poles_[i] * time_);
  }
}

DeltaCascade SectionForm::cascade() const {
  DeltaCascade result;
  result.gain = static_cast<double>(gain_);
  for (std::size_t i = 0; i < poles_.size(); ++i) {
    result.sections.push_back(
        {static_cast<double>(rate(poles_[i])), static_cast<double>(between(zeros_[i], poles_[i]))});
  }
  return result;
}

ParallelSections SectionForm::parallel() const {
  Extended low = gain_;  // at z = 1; gain_ itself is the value at z = infinity
  for (std::size_t i = 0; i < poles_.size(); ++i) low *= rate(zeros_[i]) / rate(poles_[i]);

  ParallelSections result;
  const bool is_lead = std::abs(low) < std::abs(gain_);
  result.output = is_lead ? SectionOutput::change : SectionOutput::state;
  result.direct = static_cast<double>(is_lead ? low : gain_);
  for (std::size_t i = 0; i < poles_.size(); ++i) {
    // A zero is taken with a pole: the product of all zeros' factors alone would leave the range on wide bands.
    Extended residue = gain_;
    for (std::size_t j = 0; j < poles_.size(); ++j) {
      residue *= between(zeros_[j], poles_[i]);
      if (j != i) residue /= between(poles_[j], poles_[i]);
    }
    const Extended at = rate(poles_[i]);
    result.rates.push_back(static_cast<double>(at));
    // delta/(delta + rate) = 1 - rate/(delta + rate)
    result.weights.push_back(static_cast<double>(is_lead ? -residue / at : residue));
  }
  return result;
}

}  // namespace frac::detail
