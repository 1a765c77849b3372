// SPDX-License-Identifier: BSD-3-Clause
#include <Eigen/Core>
#include <cmath>
#include <map>
#include <unsupported/Eigen/MatrixFunctions>

#include "frac/approximation/approximate.hpp"
#include "frac/time_response/response_methods.hpp"
#include "time_response/sample_checks.hpp"

namespace frac {
namespace {

// x' = A x + b u, y = c x + d u.
struct StateSpace {
  Eigen::MatrixXd a;
  Eigen::VectorXd b;
  Eigen::RowVectorXd c;
  double d = 0;
};

// s^-order applied to w: y = c x + d w, its states a part of the whole.
struct Output {
  Eigen::RowVectorXd c;
  double d;
};

// With w = s^n y (n the highest order of the denominator, y of the denominator alone), every other term is s^-(n - q)
// of w: modes of the ladder for the fractional part, then integrators.  The whole stays a state space, because poles
// that coincide, as those of two integrators do, have no modes.
StateSpace realised(const FractionalTransferFunction& model, FrequencyBand band, double tolerance) {
  const double highest = model.denominator().front().order;
  std::map<double, Approximation> ladders;  // by fractional part of the lag
  std::map<double, Eigen::Index> first_state;
  Eigen::Index size = 0;
  const auto whole_part = [](double lag) { return static_cast<Eigen::Index>(std::floor(lag)); };
  const auto modes_of = [&](double fraction) -> const Approximation* {
    if (fraction == 0) return nullptr;
    auto known = ladders.find(fraction);
    if (known == ladders.end()) {
      known = ladders.emplace(fraction, approximate(-fraction, band, Tolerance{tolerance})).first;
    }
    return &known->second;
  };
  const auto add = [&](double lag) {
    if (lag == 0 || !first_state.try_emplace(lag, size).second) return;
    const Approximation* modes = modes_of(lag - std::floor(lag));
    size += whole_part(lag) + (modes ? static_cast<Eigen::Index>(modes->parallel.residues.size()) : 0);
  };
  for (const auto* terms : {&model.denominator(), &model.numerator()}) {
    for (const PowerTerm& term : *terms) add(highest - term.order);
  }

  Eigen::MatrixXd a = Eigen::MatrixXd::Zero(size, size);
  Eigen::VectorXd b = Eigen::VectorXd::Zero(size);
  const auto output_of = [&](double lag) {
    Output output{Eigen::RowVectorXd::Zero(size), 1};
    if (lag == 0) return output;
    Eigen::Index state = first_state.at(lag);
    if (const Approximation* modes = modes_of(lag - std::floor(lag))) {
      output.d = modes->parallel.direct;
      for (std::size_t j = 0; j < modes->parallel.residues.size(); ++j, ++state) {
        a(state, state) = modes->system.poles[j];
        b[state] = 1;
        output.c[state] = modes->parallel.residues[j];
      }
    }
    for (Eigen::Index i = 0; i < whole_part(lag); ++i, ++state) {
      a.row(state) = output.c;
      b[state] = output.d;
      output = {Eigen::RowVectorXd::Zero(size), 0};
      output.c[state] = 1;
    }
    return output;
  };
  // w = u/d0 - sum d_i/d0 s^-(n - q_i) w.
  const double leading = model.denominator().front().coefficient;
  Eigen::RowVectorXd fed_back = Eigen::RowVectorXd::Zero(size);
  double loop = 1;
  for (std::size_t i = 1; i < model.denominator().size(); ++i) {
    const PowerTerm& term = model.denominator()[i];
    const Output output = output_of(highest - term.order);
    fed_back += term.coefficient / leading * output.c;
    loop += term.coefficient / leading * output.d;
  }
  StateSpace system{{}, {}, Eigen::RowVectorXd::Zero(size), 0};
  double through = 0;  // from w to y
  for (const PowerTerm& term : model.numerator()) {
    const Output output = output_of(highest - term.order);
    system.c += term.coefficient * output.c;
    through += term.coefficient * output.d;
  }
  const Eigen::RowVectorXd w_of_x = -fed_back / loop;
  const double w_of_u = 1 / (leading * loop);
  system.a = a + b * w_of_x;
  system.b = b * w_of_u;
  system.c += through * w_of_x;
  system.d = through * w_of_u;
  return system;
}

}  // namespace

std::vector<double> respond_ladder(const FractionalTransferFunction& model, std::span<const double> samples,
                                   double sample_time, double tolerance, Hold hold) {
  if (hold == Hold::band_limited)
    throw std::invalid_argument("respond: hold = band-limited; the ladder takes zero-order and first-order");
  detail::check_samples(samples, "respond_ladder");
  detail::check_sample_time(sample_time, "respond_ladder");
  detail::check_proper(model, "respond_ladder");
  if (!(tolerance >= 1e-8 && tolerance <= 0.1)) {
    throw std::invalid_argument("respond_ladder: tolerance = " + detail::number_text(tolerance) +
                                "; allowed is 1e-8 to 0.1");
  }
  constexpr double wider = 100;
  const double length = sample_time * static_cast<double>(samples.size());
  const StateSpace system = realised(model, {1 / (wider * length), wider / sample_time}, tolerance);
  std::vector<double> output(samples.size());
  if (system.b.size() == 0) {
    for (std::size_t n = 0; n < samples.size(); ++n) output[n] = system.d * samples[n];
    detail::delay_samples(output, model.delay(), sample_time);
    return output;
  }

  // One sample of x' = A x + b u, u' = slope: a matrix exponential, which holds for poles that coincide too.
  const Eigen::Index size = system.b.size();
  Eigen::MatrixXd motion = Eigen::MatrixXd::Zero(size + 2, size + 2);
  motion.topLeftCorner(size, size) = system.a;
  motion.col(size).head(size) = system.b;
  motion(size, size + 1) = 1;
  const Eigen::MatrixXd transition = (sample_time * motion).exp().topRows(size);
  Eigen::VectorXd state = Eigen::VectorXd::Zero(size + 2);  // x, u and its slope
  for (std::size_t n = 0; n < samples.size(); ++n) {
    if (n > 0) {
      state[size] = samples[n - 1];
      if (hold == Hold::first_order) state[size + 1] = (samples[n] - samples[n - 1]) / sample_time;
      state.head(size) = transition * state;
    }
    output[n] = system.c * state.head(size) + system.d * samples[n];
  }
  detail::delay_samples(output, model.delay(), sample_time);
  return output;
}

}  // namespace frac
