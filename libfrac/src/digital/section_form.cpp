#include "section_form.hpp"

#include <algorithm>
#include <cmath>
#include <functional>

namespace frac::detail {
namespace {

using Extended = long double;

// A corner's term weight w/(w + corner), w = delta/(delta + 2), is scaled delta/(delta + rate).
struct CornerTerm {
  Extended rate;
  Extended scaled;
};

std::vector<CornerTerm> corner_terms(const GainCorrection& correction) {
  std::vector<CornerTerm> terms;
  for (std::size_t j = 0; j < correction.corners.size(); ++j) {
    const Extended corner = correction.corners[j];
    terms.push_back({2 * corner / (1 + corner), correction.weights[j] / (1 + corner)});
  }
  return terms;
}

}  // namespace

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

ParallelSections SectionForm::times(const GainCorrection& correction) const {
  const std::vector<CornerTerm> corners = corner_terms(correction);
  Extended low = gain_ * correction.constant;  // at z = 1
  Extended high = correction.constant;         // at z = infinity
  for (const CornerTerm& corner : corners) high += corner.scaled;
  high *= gain_;
  for (std::size_t i = 0; i < poles_.size(); ++i) low *= rate(zeros_[i]) / rate(poles_[i]);

  struct Residue {
    Extended rate;
    Extended value;
  };
  std::vector<Residue> residues;
  for (std::size_t i = 0; i < poles_.size(); ++i) {
    // A zero is taken with a pole: the product of all zeros' factors alone would leave the range on wide bands.
    Extended value = gain_;
    for (std::size_t j = 0; j < poles_.size(); ++j) {
      value *= between(zeros_[j], poles_[i]);
      if (j != i) value /= between(poles_[j], poles_[i]);
    }
    const Extended at = rate(poles_[i]);
    Extended factor = correction.constant;
    for (const CornerTerm& corner : corners) factor += corner.scaled * at / (at - corner.rate);
    residues.push_back({at, value * factor});
  }
  for (const CornerTerm& corner : corners) {
    Extended value = -corner.scaled * corner.rate * gain_;
    for (std::size_t j = 0; j < poles_.size(); ++j) {
      value *= (rate(zeros_[j]) - corner.rate) / (rate(poles_[j]) - corner.rate);
    }
    residues.push_back({corner.rate, value});
  }

  ParallelSections result;
  const bool is_lead = std::abs(low) < std::abs(high);
  result.output = is_lead ? SectionOutput::change : SectionOutput::state;
  result.direct = static_cast<double>(is_lead ? low : high);
  for (const Residue& residue : residues) {
    result.rates.push_back(static_cast<double>(residue.rate));
    // delta/(delta + rate) = 1 - rate/(delta + rate)
    result.weights.push_back(static_cast<double>(is_lead ? -residue.value / residue.rate : residue.value));
  }
  return result;
}

ParallelSections sections_of(const GainCorrection& correction) {
  ParallelSections result;
  result.output = SectionOutput::change;
  result.direct = correction.constant;
  for (const CornerTerm& corner : corner_terms(correction)) {
    result.rates.push_back(static_cast<double>(corner.rate));
    result.weights.push_back(static_cast<double>(corner.scaled));
  }
  return result;
}

}  // namespace frac::detail
