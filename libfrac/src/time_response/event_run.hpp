// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <complex>
#include <cstddef>
#include <limits>
#include <vector>

#include "event_response.hpp"
#include "exponential_terms.hpp"
#include "sensitive_image.hpp"

namespace frac::detail {

/// Instants closer than this are one.
inline double rounding_at(double t) {
  return 16 * std::numeric_limits<double>::epsilon() * std::abs(t);
}

/// One row of one column or more.
inline Eigen::Array<std::complex<double>, 1, 1> row_of(std::complex<double> weight) {
  return Eigen::Array<std::complex<double>, 1, 1>(weight);
}
inline const ComplexRow& row_of(const ComplexRow& weight) {
  return weight;
}
inline Eigen::Array<double, 1, 1> row_of(double value) {
  return Eigen::Array<double, 1, 1>(value);
}
inline const RealRow& row_of(const RealRow& value) {
  return value;
}

/// The model at one set of parameters, ready to be run over the events.
struct EventPlan {
  /// Nodes are moved several at once: the real ones, the complex ones, and rows and columns of `weight` are filled up
  /// to a multiple of this with some that stay zero.
  static constexpr Eigen::Index together = 4;

  Eigen::Index real_count = 0;
  Eigen::Index complex_count = 0;
  std::vector<std::complex<double>> rate;  // real ones first
  // States that decay within the horizon take the input itself, the others its m-fold integral.
  std::vector<bool> is_direct;
  // What the value (column 0) and its derivatives by the parameters take of real nodes, of the real parts of complex
  // ones, of their imaginary parts, of the derivatives of the m-fold integral of the input, from the 0th, and of the
  // jump that the states do not know of yet: a row for each.
  Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> weight;
  Eigen::Index columns = 1;  // of `weight`, those that fill it up left out
  std::size_t integrators = 0;
  std::size_t channels = 1;
  double delay = 0;
  Slope delay_slope;

  [[nodiscard]] Eigen::Index states() const { return real_count + 2 * complex_count; }

  /// @param terms      left in another order
  /// @param constants  as many as channels
  /// @param direct     what the output follows at once
  template <typename Terms, typename Value>
  void take(Terms& terms, const std::vector<Value>& constants, const Value& direct) {
    const auto filled = [](Eigen::Index count) { return (count + together - 1) / together * together; };
    const auto complex_terms =
        std::stable_partition(terms.begin(), terms.end(), [](const auto& term) { return term.rate.imag() == 0; });
    real_count = filled(complex_terms - terms.begin());
    complex_count = filled(terms.end() - complex_terms);
    rate.assign(static_cast<std::size_t>(real_count + complex_count), 0.0);
    is_direct.assign(rate.size(), false);
    columns = row_of(direct).size();
    const auto inputs = static_cast<Eigen::Index>(channels);
    weight.setZero(filled(states() + inputs + 1), filled(columns));
    // Of the output's rate of change: the rate of a state is that of its node times it and what it takes.
    Eigen::VectorXd motion = Eigen::VectorXd::Zero(weight.rows());
    const auto put = [&](Eigen::Index at, const auto& row) {
      for (Eigen::Index k = 0; k < columns; ++k) weight(at, k) = row[k];
    };
    const auto set = [&](Eigen::Index node, const auto& term) {
      const auto i = static_cast<std::size_t>(node);
      rate[i] = term.rate;
      is_direct[i] = term.is_direct;
      const auto& row = row_of(term.weight);
      const std::complex<double> moved = row[0] * term.rate;
      put(node, row.real());
      motion[node] = moved.real();
      motion[states() + (term.is_direct ? static_cast<Eigen::Index>(integrators) : 0)] += moved.real();
      if (node < real_count) return;
      put(node + complex_count, -row.imag());
      motion[node + complex_count] = -moved.imag();
    };
    Eigen::Index node = 0;
    for (auto term = terms.begin(); term != complex_terms; ++term) set(node++, *term);
    node = real_count;
    for (auto term = complex_terms; term != terms.end(); ++term) set(node++, *term);
    for (Eigen::Index j = 0; j < inputs; ++j) {
      put(states() + j, row_of(constants[static_cast<std::size_t>(j)]));
      if (j > 0) motion[states() + j] += weight(states() + j - 1, 0);
    }
    put(states() + inputs, row_of(direct));
    // A longer dead time moves the output back.
    for (std::size_t p = 0; p < delay_slope.size(); ++p) {
      weight.col(static_cast<Eigen::Index>(p) + 1) -= delay_slope[p] * motion;
    }
  }
};

/// Runs the states of the plan from knot to knot of the input and writes what they give at the output instants.
void run_over_events(const EventPlan& plan, const std::vector<EventResponse::Knot>& knots,
                     const std::vector<double>& output_time, EventResponse::Result& result);

}  // namespace frac::detail
