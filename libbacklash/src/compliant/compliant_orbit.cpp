// SPDX-License-Identifier: BSD-3-Clause
#include "compliant_orbit.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>

#include "base/eigenvalues.hpp"
#include "base/linear_algebra.hpp"
#include "gauss.hpp"

namespace backlash::detail {
namespace {

using Index = Eigen::Index;

Eigen::MatrixXd part(const Eigen::MatrixXd& of, const std::vector<Index>& indices) {
  const auto size = static_cast<Index>(indices.size());
  Eigen::MatrixXd result(size, size);
  for (Index i = 0; i < size; ++i)
    for (Index k = 0; k < size; ++k)
      result(i, k) = of(indices[static_cast<std::size_t>(i)], indices[static_cast<std::size_t>(k)]);
  return result;
}

Eigen::VectorXd part(const Eigen::VectorXd& of, const std::vector<Index>& indices) {
  Eigen::VectorXd result(static_cast<Index>(indices.size()));
  for (std::size_t i = 0; i < indices.size(); ++i) result[static_cast<Index>(i)] = of[indices[i]];
  return result;
}

template <class Integrand>
double integral(double length, const Integrand& integrand) {
  double sum = 0;
  visit_gauss_nodes(length, [&](double t, double weight) { sum += weight * integrand(t); });
  return 0.5 * length * sum;
}

// Half a period later every state is its negative, but for rounding.
bool mirrors_itself(const CompliantFlow& flow, const Eigen::VectorXd& state, const CompliantMode& mode) {
  constexpr double rounding = 1e-8;
  CompliantRun run(flow, state, mode);
  const double half = std::numbers::pi / flow.omega();
  while (run.time() < half && !run.has_escaped()) run.advance(half);
  double miss = 0;
  for (const Index i : flow.repeating()) miss = std::max(miss, std::abs(run.state()[i] + state[i]) / flow.sizes()[i]);
  return miss < rounding;
}

}  // namespace

std::optional<CompliantOrbit> closed_orbit(const CompliantFlow& flow, const Eigen::VectorXd& state,
                                           const CompliantMode& mode, int periods) {
  constexpr int most_steps = 12;
  // Steps below it, of the sizes of the states, are rounding; the step before was its square root.
  constexpr double converged = 1e-10;
  // A miss below it is rounding, which the inverse makes a longer step of where masses may drift nearly freely.
  constexpr double rounding = 1e-12;
  const std::vector<Index>& repeating = flow.repeating();
  const Eigen::VectorXd sizes = part(flow.sizes(), repeating);
  Eigen::VectorXd at = state;
  CompliantMode at_mode = mode;
  bool is_last = false;
  for (int step = 0; step <= most_steps; ++step) {
    CompliantRun run(flow, at, at_mode);
    run.begin_transition();
    if (!run.follow(periods)) return std::nullopt;
    const Eigen::MatrixXd monodromy = part(run.transition(), repeating);
    const Eigen::VectorXd miss = part(Eigen::VectorXd(run.state() - at), repeating);
    const double residual = miss.cwiseQuotient(sizes).cwiseAbs().maxCoeff();
    if (!monodromy.allFinite() || !std::isfinite(residual)) return std::nullopt;
    if (is_last) {
      if (run.mode() != at_mode || !(residual < 1e-8)) return std::nullopt;
      CompliantOrbit orbit{at, at_mode, periods, monodromy, 0, residual, run.contacts(), run.sticks()};
      const Eigen::MatrixXd scaled = sizes.cwiseInverse().asDiagonal() * monodromy * sizes.asDiagonal();
      orbit.largest_multiplier = frac::detail::eigenvalues(scaled).cwiseAbs().maxCoeff();
      return orbit;
    }
    const Index size = monodromy.rows();
    const Eigen::MatrixXd scaled = sizes.cwiseInverse().asDiagonal() * monodromy * sizes.asDiagonal();
    const Eigen::VectorXd change =
        frac::detail::solve_square(Eigen::MatrixXd::Identity(size, size) - scaled, miss.cwiseQuotient(sizes));
    const double largest = change.cwiseAbs().maxCoeff();
    // An orbit further away than the gap is wide is another one.
    if (!(largest < 3)) return std::nullopt;
    for (Index i = 0; i < size; ++i) at[repeating[static_cast<std::size_t>(i)]] += change[i] * sizes[i];
    at_mode = run.mode();
    is_last = largest < converged || residual < rounding;
  }
  return std::nullopt;
}

CompliantReading read_orbit(const CompliantOrbit& orbit, const CompliantBodies& bodies, const SineForce& force,
                            Output output, double tolerance) {
  constexpr int harmonics = 3;
  const CompliantFlow flow(bodies, force, output, tolerance, harmonics);
  // The same states, with more harmonics behind them.
  Eigen::VectorXd state = Eigen::VectorXd::Zero(flow.sizes().size());
  const Index common = orbit.state.size();
  state.head(common) = orbit.state;
  CompliantRun run(flow, state, orbit.mode);
  CompliantReading reading{};
  run.visit_pieces(
      [&](const CompliantFlow::Regime& regime, const CompliantMode& mode, const FlightPath& path, double length) {
        const CompliantFlow::Body& load = regime.bodies[0];
        const CompliantFlow::Body& drive = regime.bodies[1];
        // A contact that rings is integrated radian by radian; what decays at the rate c/m at its start, from there on
        // in parts that double.
        const FreeContact free = free_contact(bodies.contact(), bodies.system().mass1(), bodies.system().mass2());
        const double radian = mode.contact == 0 ? length : 1 / (free.frequency * std::max(1.0, 2 * free.damping_ratio));
        for (double from = 0, to = 0; to < length; from = to) {
          to = std::min(length, free.damping_ratio < 1 ? from + radian : std::max(2 * from, radian));
          const auto over = [&](const auto& integrand) {
            return integral(to - from, [&](double t) { return integrand(path.state(from + t)); });
          };
          reading.work += over([&](const Eigen::VectorXd& z) {
            return force.amplitude * z[CompliantFlow::cosine] * drive.velocity.row.dot(z);
          });
          reading.moved += over([&](const Eigen::VectorXd& z) {
            return std::abs(force.amplitude * z[CompliantFlow::cosine] * drive.velocity.row.dot(z));
          });
          reading.loss += over([&](const Eigen::VectorXd& z) {
            const double speed1 = load.velocity.row.dot(z), speed2 = drive.velocity.row.dot(z);
            double power = load.resisted.dot(z) * speed1 + drive.resisted.dot(z) * speed2;
            power += flow.friction(0) * mode.slide[0] * speed1 + flow.friction(1) * mode.slide[1] * speed2;
            if (mode.contact != 0)
              power += flow.press(regime, mode.contact).row.dot(z) * mode.contact * z[CompliantFlow::rate];
            return power;
          });
        }
      });
  run.follow(orbit.periods);
  reading.is_symmetric = orbit.periods == 1 && mirrors_itself(flow, state, orbit.mode);
  const std::vector<std::complex<double>>& velocity = run.phasors();
  reading.value = velocity[0] / std::complex<double>(0, force.omega) / force.amplitude;
  const double fundamental = std::abs(velocity[0]);
  reading.second = velocity[1] / std::complex<double>(0, 2 * force.omega) / force.amplitude;
  reading.third_ratio = std::abs(velocity[2]) / 3 / fundamental;
  return reading;
}

}  // namespace backlash::detail
