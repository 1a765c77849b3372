// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <complex>
#include <cstddef>
#include <numbers>
#include <vector>

#include "branch_cut.hpp"
#include "exponential_sum.hpp"
#include "special/complex_functions.hpp"

// The terms of an exponential sum from the nodes of a rule along the branch cut, and its constants, for values alone
// (weights are numbers) and for values with their derivatives (weights are rows).
namespace frac::detail {

/// Value in column 0, derivative by parameter p in column 1 + p.
using ComplexRow = Eigen::Array<std::complex<double>, 1, Eigen::Dynamic>;
using RealRow = Eigen::Array<double, 1, Eigen::Dynamic>;

[[nodiscard]] inline std::complex<double> value_of(std::complex<double> weight) {
  return weight;
}
[[nodiscard]] inline std::complex<double> value_of(const ComplexRow& weight) {
  return weight[0];
}
[[nodiscard]] inline double real_part(std::complex<double> weight) {
  return weight.real();
}
[[nodiscard]] inline RealRow real_part(const ComplexRow& weight) {
  return weight.real();
}
[[nodiscard]] inline double zero_like(double) {
  return 0;
}
[[nodiscard]] inline RealRow zero_like(const RealRow& row) {
  return RealRow::Zero(row.size());
}

/// Terms whose weights are rows.  Once cleared it keeps their memory for those to come.
class SensitiveTerms {
 public:
  void clear() { size_ = 0; }
  template <typename Row>
  void add(std::complex<double> rate, const Row& weight) {
    if (size_ == terms_.size()) terms_.emplace_back();
    ExponentialTerm<ComplexRow>& term = terms_[size_++];
    term.rate = rate;
    term.weight = weight;
    term.is_direct = false;
  }
  [[nodiscard]] auto begin() { return terms_.begin(); }
  [[nodiscard]] auto end() { return terms_.begin() + static_cast<std::ptrdiff_t>(size_); }
  [[nodiscard]] auto begin() const { return terms_.begin(); }
  [[nodiscard]] auto end() const { return terms_.begin() + static_cast<std::ptrdiff_t>(size_); }

 private:
  std::vector<ExponentialTerm<ComplexRow>> terms_;
  std::size_t size_ = 0;
};

template <typename Row>
void append(SensitiveTerms& terms, std::complex<double> rate, const Row& weight) {
  terms.add(rate, weight);
}
inline void append(std::vector<Exponential>& terms, std::complex<double> rate, std::complex<double> weight) {
  terms.push_back({rate, weight});
}

/// s at ln s = zeta, real on the negative axis.
[[nodiscard]] inline std::complex<double> rate_at(std::complex<double> zeta) {
  return zeta.imag() == std::numbers::pi ? std::complex<double>(-std::exp(zeta.real())) : std::exp(zeta);
}

/// Whether a term has not decayed at the end of the horizon.
[[nodiscard]] inline bool is_slow(std::complex<double> rate, double latest) {
  return std::abs(rate) <= 2 / latest;
}

/// Appends the nodes that have not decayed at the earliest lag, down to where ln|s| is below `lowest` and a node adds
/// less than `negligible` of the largest one to the m-fold integral.
/// @param image_at  Y s at ln s = zeta
/// @return what the largest one adds; not finite where a node has no finite value
template <typename Terms, typename ImageAt>
double append_cut_terms(const CutRule& rule, const ImageAt& image_at, double latest, std::size_t integrations,
                        double lowest, double negligible, Terms& terms) {
  const std::complex<double> factor(0, -rule.step() / std::numbers::pi);
  double largest = 0;
  for (int k = 0; k < 100'000; ++k) {
    const std::complex<double> zeta = rule.node(k);
    const std::complex<double> rate = rate_at(zeta);
    const auto& image = image_at(zeta);
    append(terms, rate, factor * image);
    const double added = effect(std::abs(factor * value_of(image)), std::abs(rate), latest, integrations);
    if (!std::isfinite(added)) return added;
    largest = std::max(largest, added);
    if (zeta.real() < lowest && added < negligible * largest) break;
  }
  return largest;
}

/// Makes the terms direct that decay within the horizon.
template <typename Terms>
void make_direct(Terms& terms, double latest, std::size_t integrations) {
  for (auto& term : terms) {
    if (is_slow(term.rate, latest)) continue;
    term.is_direct = true;
    term.weight /= std::pow(term.rate, static_cast<int>(integrations));
  }
}

/// Coefficients by rising power of the polynomial through the points.
template <typename Value>
[[nodiscard]] std::vector<Value> interpolating_polynomial(const std::vector<double>& x, std::vector<Value> y) {
  // Newton's divided differences, then Horner's scheme on the coefficients.
  const std::size_t count = x.size();
  for (std::size_t order = 1; order < count; ++order) {
    for (std::size_t i = count; i-- > order;) y[i] = (y[i] - y[i - 1]) / (x[i] - x[i - order]);
  }
  std::vector<Value> coefficient(count, zero_like(y.front()));
  for (std::size_t i = count; i-- > 0;) {
    for (std::size_t k = count; k-- > 1;) coefficient[k] = coefficient[k - 1] - x[i] * coefficient[k];
    coefficient[0] = y[i] - x[i] * coefficient[0];
  }
  return coefficient;
}

/// The first `count` constants of a sum with these terms.  As many as there are anchors are read from the image there,
/// the others are left of the nodes that have decayed before the earliest lag.
/// @param rule        null for an image without a branch cut
/// @param negligible  what may be left out of such nodes at the anchors
template <typename Terms, typename ImageAt>
[[nodiscard]] auto constants_of(const Terms& terms, const ImageAt& image_at, const std::vector<double>& log_anchor,
                                const CutRule* rule, double negligible, std::size_t integrations, std::size_t count) {
  using Value = decltype(real_part(image_at(0)));
  std::vector<double> anchor;
  std::vector<Value> rest;  // of Y s at the anchors, less what the terms make of it
  for (const double log_s0 : log_anchor) {
    const double s0 = std::exp(log_s0);
    const double raised = std::pow(s0, static_cast<double>(integrations));
    Value left = real_part(image_at(log_s0));
    for (const auto& term : terms) {
      const std::complex<double> share = product(term.rate, reciprocal(s0 - term.rate));
      left -= (term.is_direct ? raised : 1) * (term.weight * share).real();
    }
    anchor.push_back(s0);
    rest.push_back(std::move(left));
  }
  std::vector<Value> constants(count, zero_like(rest.front()));
  const auto anchored = static_cast<int>(anchor.size());
  for (int k = 1; rule != nullptr && k < 5'000; ++k) {
    const std::complex<double> rate = rate_at(rule->node(-k));
    const std::complex<double> factor(0, -rule->step() / std::numbers::pi);
    const auto& image = image_at(rule->node(-k));
    double size = 0;
    for (std::size_t i = 0; i < anchor.size(); ++i) {
      const std::complex<double> ratio = anchor[i] / rate;
      const std::complex<double> share = factor * std::pow(ratio, anchored) / (1.0 - ratio);
      rest[i] += (image * share).real();
      size = std::max(size, std::abs(value_of(image) * share));
    }
    std::complex<double> share = factor / std::pow(rate, anchored);
    for (std::size_t j = anchor.size(); j < count; ++j, share /= rate) constants[j] -= (image * share).real();
    if (size < negligible) break;
  }
  const std::vector<Value> coefficient = interpolating_polynomial(anchor, std::move(rest));
  std::copy_n(coefficient.begin(), std::min(coefficient.size(), count), constants.begin());
  return constants;
}

}  // namespace frac::detail
