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

/// The model at one set of parameters, ready to be run over the events.  Rows of `weight`: real nodes, real parts of
/// complex ones, their imaginary parts.
struct EventPlan {
  Eigen::Index real_count = 0;
  Eigen::Index complex_count = 0;
  std::vector<std::complex<double>> rate;  // real ones first
  // States that decay within the horizon take the input itself, the others its m-fold integral.
  std::vector<bool> is_direct;
  Eigen::MatrixXd weight;
  Eigen::MatrixXd constant;  // a row per derivative of the m-fold integral of the input, from the 0th
  Eigen::VectorXd motion;    // weights of the states in the output's rate of change; empty where it is not wanted
  double direct = 0;
  Eigen::RowVectorXd direct_by;
  std::size_t integrators = 0;
  std::size_t channels = 1;
  double delay = 0;
  std::vector<double> delay_slope;

  template <typename Weight, typename Value>
  void take(std::vector<ExponentialTerm<Weight>> terms, const std::vector<Value>& constants) {
    const auto complex_terms =
        std::stable_partition(terms.begin(), terms.end(), [](const auto& term) { return term.rate.imag() == 0; });
    real_count = complex_terms - terms.begin();
    complex_count = terms.end() - complex_terms;
    const Eigen::Index columns = row_of(constants.front()).size();
    weight.resize(real_count + 2 * complex_count, columns);
    if (!delay_slope.empty()) motion.resize(weight.rows());
    for (Eigen::Index i = 0; i < real_count + complex_count; ++i) {
      const ExponentialTerm<Weight>& term = terms[static_cast<std::size_t>(i)];
      rate.push_back(term.rate);
      is_direct.push_back(term.is_direct);
      const auto& row = row_of(term.weight);
      const std::complex<double> moved = row[0] * term.rate;
      weight.row(i) = row.real().matrix();
      if (!delay_slope.empty()) motion[i] = moved.real();
      if (i < real_count) continue;
      weight.row(i + complex_count) = -row.imag().matrix();
      if (!delay_slope.empty()) motion[i + complex_count] = -moved.imag();
    }
    constant.resize(static_cast<Eigen::Index>(constants.size()), columns);
    for (std::size_t j = 0; j < constants.size(); ++j) {
      constant.row(static_cast<Eigen::Index>(j)) = row_of(constants[j]).matrix();
    }
  }
};

/// Runs the states of the plan from knot to knot of the input and writes what they give at the output instants.
void run_over_events(const EventPlan& plan, const std::vector<EventResponse::Knot>& knots,
                     const std::vector<double>& output_time, EventResponse::Result& result);

}  // namespace frac::detail
