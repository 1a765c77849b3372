// SPDX-License-Identifier: BSD-3-Clause
#include "scene_solver.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>

#include "base/linear_algebra.hpp"
#include "frac/cancellation.hpp"
#include "response_table.hpp"
#include "scene_evidence.hpp"
#include "steady_state/two_impact_orbit.hpp"

namespace backlash::detail {
namespace {

using Complex = std::complex<double>;
constexpr auto size = static_cast<int>(scene_size);
using SceneMatrix = Eigen::Matrix<double, size, size>;
using SceneStep = Eigen::Matrix<double, size, 1>;

constexpr int most_rounds = 20;
constexpr int most_iterations = 12;
// With contacts that take time more steps are refused where one of many motions ends nearby, until the point is left
// out, and a round costs more.
constexpr int most_iterations_with_contacts = 25, most_rounds_with_contacts = 8;
// With friction, where each step follows every orbit and its derivatives, some milliseconds a point.
constexpr int most_iterations_with_friction = 12;
constexpr int rounds_of_a_glance = 2;
constexpr int iterations_of_a_glance = 6;
// A round that moves the estimate by less than this, in standard errors, is the last.
constexpr double settled_step = 1e-4;
// Likewise where contacts take time, whose motions cost more; far below what the intervals tell.
constexpr double near_step = 1e-2;
// The two-impact orbit is followed this far beyond its loss of stability in the first rounds, whose estimates may place
// the loss beside that of the data; not to the end, since a period that has just doubled lies near to it.
constexpr double beyond_loss = 1.1;
constexpr int rounds_beyond_loss = 3;
constexpr double about_the_orbit = 1.25;
// Likewise, of contacts that take time: largest multiplier of their symmetric orbit.
constexpr double multiplier_beyond_loss = 2;
// A motion that led to no orbit of one period this often is left alone.
constexpr int most_failures = 2;
// With friction starts are followed this often.
constexpr int most_attempts = 2;
double two_impact_end(double restitution) {
  // At restitution 0 the orbit of two impacts, each followed by a rest, goes on; without rests it ends at 1/pi.
  return restitution > 0 ? two_impact_loss(restitution).gamma : std::numbers::inv_pi;
}

std::optional<Complex> sticking_h_of(double gamma, double restitution, Effort effort, int harmonic) {
  if (effort == Effort::settle) return sticking_h(gamma, restitution, harmonic);
  // The table holds the fundamental alone.
  if (harmonic != 1) return std::nullopt;
  const auto response = rough_sticking_response(gamma, restitution);
  return response ? std::optional<Complex>(response->h) : std::nullopt;
}

struct Evaluation {
  double cost = 0;
  std::vector<std::size_t> ended;  // points whose motion does not exist there
};

class Solver {
 public:
  Solver(const SceneData& data, const SceneBounds& bounds, Motions motions)
      : data_(data),
        bounds_(bounds),
        motions_(motions),
        choices_(data.points.size()),
        found_(bounds.upper[4] > 0 && !bounds.has_friction() ? data.points.size() : 0),
        orbits_(bounds.has_friction() ? data.points.size() : 0),
        attempts_(orbits_.size()) {}

  LocalScene run(const SceneVector& start, Effort effort) {
    LocalScene result;
    theta_ = start;
    effort_ = effort;
    iterations_ = effort == Effort::glance ? iterations_of_a_glance
                  : has_friction()         ? most_iterations_with_friction
                  : contacts_take_time()   ? most_iterations_with_contacts
                                           : most_iterations;
    const int rounds = effort == Effort::glance ? rounds_of_a_glance
                       : contacts_take_time()   ? most_rounds_with_contacts
                                                : most_rounds;
    for (int round = 0; round < rounds; ++round) {
      const std::vector<PointChoice> before = choices_;
      choose(round);
      if (count_used() * data_.residuals_per_point() < bounds_.free_count()) break;
      result.usable = true;
      const double last_step = follows_orbits() ? near_step : settled_step;
      if (round > rounds_that_differ() && settled(before) && moved_ < last_step && !finds_more_motions(round)) {
        // There a kink of N, or the end of a motion nearby, stops the steps but not the estimate.
        result.converged = least_squares_converged_ || follows_orbits();
        break;
      }
      least_squares();
    }
    choose(rounds);
    result.usable = count_used() * data_.residuals_per_point() >= std::max<std::size_t>(1, bounds_.free_count());
    result.theta = theta_;
    result.deviance = scene_evidence(data_, choices_, bounds_.free_count(), effort).deviance;
    result.choices = std::move(choices_);
    result.found = std::move(found_);
    result.orbits = std::move(orbits_);
    return result;
  }

 private:
  [[nodiscard]] std::size_t count_used() const {
    return static_cast<std::size_t>(
        std::count_if(choices_.begin(), choices_.end(), [](const PointChoice& choice) { return choice.used; }));
  }
  [[nodiscard]] bool settled(const std::vector<PointChoice>& before) const {
    for (std::size_t i = 0; i < choices_.size(); ++i) {
      if (choices_[i].used != before[i].used) return false;
      if (choices_[i].used && choices_[i].kind != before[i].kind) return false;
    }
    return true;
  }

  // Motions with friction that were given up on the way may exist at its end.
  bool finds_more_motions(int round) {
    if (!has_friction()) return false;
    const std::vector<PointChoice> before = choices_;
    std::fill(attempts_.begin(), attempts_.end(), 0);
    choose(round);
    return !settled(before);
  }

  // Takes the candidate when it lies nearer to the data than what is there.
  void offer(std::size_t i, const OutputCoefficients& coefficients, PointChoice::Kind kind, Complex h) {
    offer(i, kind, point_value(coefficients, data_.points[i], h));
  }
  // @return whether it was taken
  bool offer(std::size_t i, PointChoice::Kind kind, Complex model) {
    const MeasuredPoint& point = data_.points[i];
    const double deviation = data_.deviation(point, model);
    if (!(deviation > 0)) return false;
    const double misfit = data_.size(model - point.value) / deviation;
    PointChoice& choice = choices_[i];
    if (choice.kind != PointChoice::Kind::none && choice.misfit <= misfit) return false;
    choice.kind = kind;
    choice.model = model;
    choice.misfit = misfit;
    return true;
  }

  [[nodiscard]] bool contacts_take_time() const { return !found_.empty(); }
  [[nodiscard]] bool has_friction() const { return !orbits_.empty(); }
  // By Newton's method, some or all of them.
  [[nodiscard]] bool follows_orbits() const { return contacts_take_time() || has_friction(); }
  // The first rounds may count motions beyond their loss of stability.
  [[nodiscard]] int rounds_that_differ() const {
    return follows_orbits() && effort_ != Effort::glance ? 0 : rounds_beyond_loss;
  }
  [[nodiscard]] std::optional<ContactMotions> contact_motions(const SceneVector& theta) const {
    return contacts_take_time() ? std::make_optional<ContactMotions>(theta[3], data_.harmonics) : std::nullopt;
  }

  // Of contacts that take time.
  void offer_contact_motions(std::size_t i, const OutputCoefficients& coefficients, const ContactMotions& motions,
                             double free_until, double onset, double most_multiplier) {
    const MeasuredPoint& point = data_.points[i];
    const double gamma = gamma_at(theta_, point), tau = contact_angle(theta_, data_, point);
    FoundMotions& found = found_[point.motion];
    bool is_stable = false;
    if (const auto h = contact_h(motions, gamma, tau, false, found, true)[harmonic_place(point.harmonic)]) {
      is_stable = found.symmetric->largest_multiplier < 1;
      if (found.symmetric->largest_multiplier < most_multiplier)
        offer(i, coefficients, PointChoice::Kind::two_impact, *h);
    }
    if (motions_ != Motions::all) return;
    if (data_.output == Output::x2 && gamma <= free_until) offer(i, coefficients, PointChoice::Kind::free, 0.0);
    if (effort_ == Effort::settle && (!is_stable || gamma >= onset)) offer_followed(i, coefficients, motions);
  }

  // The orbit of one period that is near, or that contact at rest leads to.
  void offer_followed(std::size_t i, const OutputCoefficients& coefficients, const ContactMotions& motions) {
    const MeasuredPoint& point = data_.points[i];
    FoundMotions& found = found_[point.motion];
    const auto& h = contact_h(motions, gamma_at(theta_, point), contact_angle(theta_, data_, point), true, found,
                              found.failures < most_failures);
    if (const auto& own = h[harmonic_place(point.harmonic)]) offer(i, coefficients, PointChoice::Kind::sticking, *own);
    if (!h[0] && point.motion == i) ++found.failures;
  }

  // Of masses with friction: the orbit found last and, where that has ended or does not explain the point, those that
  // the symmetric one without friction and contact at rest lead to.
  void offer_friction_motions(std::size_t i, bool is_explained) {
    const MeasuredPoint& point = data_.points[i];
    const FrictionGroups groups = friction_groups(theta_, data_, point);
    FoundOrbit nearest;
    const auto offer_from = [&](FrictionStart start) {
      FoundOrbit found = orbits_[i];
      const auto n = friction_n(groups, data_.output, start, found, point.harmonic);
      if (n && offer(i, PointChoice::Kind::sticking, friction_value(theta_, point, *n))) nearest = std::move(found);
      return n.has_value();
    };
    const bool is_there = offer_from(FrictionStart::found);
    if (!(is_there && is_explained) && attempts_[i] < most_attempts) {
      ++attempts_[i];
      offer_from(FrictionStart::symmetric);
      offer_from(FrictionStart::rest);
    }
    orbits_[i] = std::move(nearest);
  }

  // limit: gamma up to which the orbit of two impacts, which is stable up to orbit_end, counts.
  void offer_motions(std::size_t i, const OutputCoefficients& coefficients, const ContactMotions* contact, double limit,
                     double orbit_end, double onset) {
    const MeasuredPoint& point = data_.points[i];
    const double gamma = gamma_at(theta_, point);
    const double restitution = theta_[3];
    const bool is_explained = choices_[i].used;
    choices_[i] = {};
    if (has_friction()) {
      offer_friction_motions(i, is_explained);
    } else if (contact != nullptr) {
      offer_contact_motions(i, coefficients, *contact, limit, onset, limit > orbit_end ? multiplier_beyond_loss : 1);
    } else {
      offer_hard_motions(i, coefficients, limit, onset);
    }
    if (choices_[i].kind != PointChoice::Kind::none || point.harmonic != 1) return;
    // What N is about where the scene is irregular: its mean from contact at rest, or the orbit of two impacts, which
    // motions of doubled period and the chaos after them stay about for a while.
    if (const auto h = mean_h(gamma, restitution)) offer_mean(i, coefficients, *h);
    if (gamma <= about_the_orbit * orbit_end) {
      if (const auto response = two_impact_response(gamma, restitution)) offer_mean(i, coefficients, response->h);
    }
  }

  void offer_hard_motions(std::size_t i, const OutputCoefficients& coefficients, double limit, double onset) {
    const double gamma = gamma_at(theta_, data_.points[i]);
    const double restitution = theta_[3];
    const int harmonic = data_.points[i].harmonic;
    if (gamma <= limit) {
      if (const auto response = two_impact_response(gamma, restitution, harmonic)) {
        offer(i, coefficients, PointChoice::Kind::two_impact, response->h);
      }
    }
    // Without impacts x1 stands still, which explains no N but 0.
    if (motions_ == Motions::all && data_.output == Output::x2 && gamma <= limit) {
      offer(i, coefficients, PointChoice::Kind::free, 0.0);
    }
    if (gamma >= onset) {
      if (const auto h = sticking_h_of(gamma, restitution, effort_, harmonic))
        offer(i, coefficients, PointChoice::Kind::sticking, *h);
    }
  }

  void offer_mean(std::size_t i, const OutputCoefficients& coefficients, Complex h) {
    const MeasuredPoint& point = data_.points[i];
    const Complex model = point_value(coefficients, point, h);
    PointChoice& choice = choices_[i];
    const bool is_nearer =
        choice.means == 0 || data_.size(model - point.value) < data_.size(choice.model - point.value);
    if (is_nearer) choice.model = model;
    ++choice.means;
  }

  void choose(int round) {
    const OutputCoefficients coefficients = output_coefficients(theta_, data_.output);
    const double orbit_end = two_impact_end(theta_[3]);
    const double limit = orbit_end * (effort_ == Effort::glance && round < rounds_beyond_loss ? beyond_loss : 1);
    const double onset = motions_ == Motions::all ? chatter_onset(theta_[3]) : std::numeric_limits<double>::infinity();
    const std::optional<ContactMotions> contact = contact_motions(theta_);
    for (std::size_t i = 0; i < choices_.size(); ++i)
      offer_motions(i, coefficients, contact ? &*contact : nullptr, limit, orbit_end, onset);
    use_by_evidence(data_, choices_, bounds_.free_count(), effort_);
  }

  [[nodiscard]] std::vector<double> deviations() const {
    std::vector<double> result(choices_.size());
    for (std::size_t i = 0; i < choices_.size(); ++i) {
      result[i] = data_.deviation(data_.points[i], choices_[i].model);
    }
    return result;
  }

  [[nodiscard]] std::optional<Complex> value_at(std::size_t i, const SceneVector& theta,
                                                const OutputCoefficients& coefficients, const ContactMotions* contact,
                                                std::vector<FoundMotions>& motions) const {
    const MeasuredPoint& point = data_.points[i];
    if (has_friction()) {
      FoundOrbit found = orbits_[i];
      const auto n =
          friction_n(friction_groups(theta, data_, point), data_.output, FrictionStart::found, found, point.harmonic);
      return n ? std::optional<Complex>(friction_value(theta, point, *n)) : std::nullopt;
    }
    const auto h = h_at(i, theta, contact, motions);
    return h ? std::optional<Complex>(point_value(coefficients, point, *h)) : std::nullopt;
  }

  [[nodiscard]] std::optional<Complex> h_at(std::size_t i, const SceneVector& theta, const ContactMotions* contact,
                                            std::vector<FoundMotions>& motions) const {
    const MeasuredPoint& point = data_.points[i];
    const double gamma = gamma_at(theta, point);
    const int harmonic = point.harmonic;
    if (contact != nullptr && choices_[i].kind != PointChoice::Kind::free) {
      return contact_h(*contact, gamma, contact_angle(theta, data_, point),
                       choices_[i].kind == PointChoice::Kind::sticking, motions[point.motion],
                       false)[harmonic_place(harmonic)];
    }
    switch (choices_[i].kind) {
      case PointChoice::Kind::two_impact: {
        const auto response = two_impact_response(gamma, theta[3], harmonic);
        return response ? std::optional<Complex>(response->h) : std::nullopt;
      }
      case PointChoice::Kind::sticking:
        // Chaotic motion takes a long mean to be told from motion that sticks: not tried where it is expected.
        if (gamma < chatter_onset(theta[3])) return std::nullopt;
        return sticking_h_of(gamma, theta[3], effort_, harmonic);
      default:
        return Complex(0);
    }
  }

  [[nodiscard]] Evaluation evaluate(const SceneVector& theta, const std::vector<double>& deviation, bool all) const {
    Evaluation result;
    const OutputCoefficients coefficients = output_coefficients(theta, data_.output);
    const std::optional<ContactMotions> contact = contact_motions(theta);
    std::vector<FoundMotions> motions = found_;
    for (std::size_t i = 0; i < choices_.size(); ++i) {
      if (!choices_[i].used) continue;
      const auto value = value_at(i, theta, coefficients, contact ? &*contact : nullptr, motions);
      if (!value) {
        result.ended.push_back(i);
        if (!all) return result;
        continue;
      }
      const MeasuredPoint& point = data_.points[i];
      const double misfit = data_.size(*value - point.value) / deviation[i];
      result.cost += misfit * misfit;
    }
    return result;
  }

  void drop(const std::vector<std::size_t>& points) {
    for (const std::size_t i : points) choices_[i].used = false;
  }

  void least_squares();
  [[nodiscard]] double way_in_standard_errors(const SceneVector& start, const NormalEquations& end) const;

  const SceneData& data_;
  const SceneBounds& bounds_;
  Motions motions_;
  std::vector<PointChoice> choices_;
  std::vector<FoundMotions> found_;  // empty where contacts are hard
  std::vector<FoundOrbit> orbits_;   // empty without friction
  std::vector<int> attempts_;        // to find them from their start
  SceneVector theta_{};
  Effort effort_ = Effort::settle;
  int iterations_ = most_iterations;
  double moved_ = 0;
  bool least_squares_converged_ = false;
};

std::optional<GapResponse> response_of(const SceneData& data, const SceneVector& theta, std::size_t i,
                                       const PointChoice& choice, Effort effort) {
  const double gamma = gamma_at(theta, data.points[i]);
  const int harmonic = data.points[i].harmonic;
  switch (choice.kind) {
    case PointChoice::Kind::two_impact:
      return two_impact_response(gamma, theta[3], harmonic);
    case PointChoice::Kind::sticking:
      if (harmonic != 1) return sticking_response(gamma, theta[3], harmonic);
      return effort == Effort::settle ? sticking_response(gamma, theta[3]) : rough_sticking_response(gamma, theta[3]);
    case PointChoice::Kind::free:
      return GapResponse{};
    case PointChoice::Kind::none:
      break;
  }
  return std::nullopt;
}

// found: empty where contacts are hard; orbits: without friction
NormalEquations products(const SceneData& data, const SceneVector& theta, const std::vector<PointChoice>& choices,
                         const std::vector<FoundMotions>& found, const std::vector<FoundOrbit>& orbits,
                         const std::vector<double>* deviation, Effort effort) {
  NormalEquations result;
  const OutputCoefficients coefficients = output_coefficients(theta, data.output);
  const std::size_t per_point = data.residuals_per_point();
  const auto contact = found.empty() ? std::nullopt : std::make_optional<ContactResponses>(theta[3], data.harmonics);
  // Of motions, the symmetric and the followed one.
  std::vector<std::array<std::optional<ContactResponses::All>, 2>> responses(found.size());
  const auto response_of_contact = [&](std::size_t i) {
    const MeasuredPoint& point = data.points[i];
    const bool is_followed = choices[i].kind == PointChoice::Kind::sticking;
    auto& all = responses[point.motion][is_followed ? 1 : 0];
    if (!all) {
      all = contact->at(gamma_at(theta, point), contact_angle(theta, data, point), is_followed, found[point.motion]);
    }
    return (*all)[harmonic_place(point.harmonic)];
  };
  const auto gradient_of = [&](std::size_t i) -> std::optional<PointGradient> {
    const MeasuredPoint& point = data.points[i];
    if (!orbits.empty()) {
      const auto response =
          friction_response(friction_groups(theta, data, point), data.output, orbits[i], point.harmonic);
      if (!response) return std::nullopt;
      return friction_gradient(theta, data, point, *response);
    }
    const auto response = contact && choices[i].kind != PointChoice::Kind::free
                              ? response_of_contact(i)
                              : response_of(data, theta, i, choices[i], effort);
    if (!response) return std::nullopt;
    return point_gradient(coefficients, data, point, *response);
  };
  for (std::size_t i = 0; i < choices.size(); ++i) {
    if (!choices[i].used) continue;
    const auto model = gradient_of(i);
    if (!model) continue;
    const MeasuredPoint& point = data.points[i];
    const double scale = 1 / (deviation != nullptr ? (*deviation)[i] : data.deviation(point, model->value));
    const auto residual = data.parts((model->value - point.value) * scale);
    std::array<std::array<double, 2>, scene_size> row{};
    for (std::size_t k = 0; k < scene_size; ++k) row[k] = data.parts(model->gradient[k] * scale);
    result.points.push_back({residual, row});
    for (std::size_t part = 0; part < per_point; ++part) {
      result.cost += residual[part] * residual[part];
      ++result.residuals;
      for (std::size_t k = 0; k < scene_size; ++k) {
        result.gradient[k] += row[k][part] * residual[part];
        for (std::size_t l = 0; l < scene_size; ++l) result.matrix[k][l] += row[k][part] * row[l][part];
      }
    }
  }
  return result;
}

// How much Levenberg and Marquardt's steps are shortened.
struct Damping {
  double value = 1e-4;
  int rejected = 0;

  void accept() {
    value = std::max(value * 0.1, 1e-15);
    rejected = 0;
  }
  /// After a step that was no gain: whether shorter ones have been so for too long.
  [[nodiscard]] bool is_in_vain() {
    value = std::max(value * 8, 1e-10);
    return ++rejected > 12;
  }
};

// The normal equations of those parameters that no bound holds: one at a bound that the gradient presses against it
// stays there.
class BoxedEquations {
 public:
  BoxedEquations(const NormalEquations& equations, const SceneVector& theta, const SceneBounds& bounds)
      : equations_(equations) {
    for (std::size_t k = 0; k < scene_size; ++k) {
      const bool pressed = (theta[k] <= bounds.lower[k] && equations.gradient[k] > 0) ||
                           (theta[k] >= bounds.upper[k] && equations.gradient[k] < 0);
      inner_[k] = bounds.is_free(k) && !pressed;
      if (inner_[k]) largest_ = std::max(largest_, equations.matrix[k][k]);
    }
  }

  /// Whether nothing is left that the data would move.
  [[nodiscard]] bool is_flat() const { return !(largest_ > 0); }

  [[nodiscard]] SceneStep step(double damping) const {
    SceneMatrix matrix = SceneMatrix::Identity();
    SceneStep gradient = SceneStep::Zero();
    for (std::size_t k = 0; k < scene_size; ++k) {
      if (!inner_[k]) continue;
      const auto row = static_cast<Eigen::Index>(k);
      gradient[row] = equations_.gradient[k];
      for (std::size_t l = 0; l < scene_size; ++l) {
        if (inner_[l]) matrix(row, static_cast<Eigen::Index>(l)) = equations_.matrix[k][l];
      }
      matrix(row, row) += damping * std::max(equations_.matrix[k][k], 1e-12 * largest_);
    }
    return -frac::detail::PivotedQr(matrix).solve(Eigen::VectorXd(gradient));
  }

 private:
  NormalEquations equations_;
  std::array<bool, scene_size> inner_{};
  double largest_ = 0;
};

struct Trial {
  SceneVector theta;
  double change;  // of the parameter that moved most
};
Trial step_within(const SceneBounds& bounds, const SceneVector& theta, const SceneStep& step) {
  Trial trial{theta, 0};
  for (std::size_t k = 0; k < scene_size; ++k) {
    trial.theta[k] = std::clamp(theta[k] + step[static_cast<Eigen::Index>(k)], bounds.lower[k], bounds.upper[k]);
    trial.change = std::max(trial.change, std::abs(trial.theta[k] - theta[k]));
  }
  return trial;
}

// Levenberg and Marquardt's method in a box.
void Solver::least_squares() {
  const SceneVector start = theta_;
  const std::vector<double> deviation = deviations();
  Damping damping;
  least_squares_converged_ = false;
  Evaluation current = evaluate(theta_, deviation, true);
  drop(current.ended);
  for (int iteration = 0; iteration < iterations_ && !least_squares_converged_;) {
    frac::throw_if_cancelled();
    const BoxedEquations equations(products(data_, theta_, choices_, found_, orbits_, &deviation, effort_), theta_,
                                   bounds_);
    if (equations.is_flat()) {
      least_squares_converged_ = true;
      break;
    }
    bool moved = false;
    while (!moved && iteration < iterations_) {
      const Trial trial = step_within(bounds_, theta_, equations.step(damping.value));
      if (!(trial.change > 1e-13)) {
        least_squares_converged_ = true;
        break;
      }
      ++iteration;
      const Evaluation next = evaluate(trial.theta, deviation, false);
      moved = next.ended.empty() && next.cost <= current.cost;
      if (moved) {
        // Rounding of the cost hides steps this small.
        least_squares_converged_ = trial.change < 1e-11 || current.cost - next.cost <= 1e-6 * current.cost;
        theta_ = trial.theta;
        current = next;
        damping.accept();
      } else if (damping.is_in_vain()) {
        // A motion ends right here, or the differences in cost are rounding.
        damping = {};
        least_squares_converged_ = next.ended.empty();
        if (!least_squares_converged_) {
          drop(evaluate(trial.theta, deviation, true).ended);
          current = evaluate(theta_, deviation, true);
        }
        break;
      }
    }
  }
  moved_ = way_in_standard_errors(start, products(data_, theta_, choices_, found_, orbits_, &deviation, effort_));
}

// Length of the way from the start in units of the standard errors, rounding aside.
double Solver::way_in_standard_errors(const SceneVector& start, const NormalEquations& end) const {
  double square = 0;
  for (std::size_t k = 0; k < scene_size; ++k) {
    for (std::size_t l = 0; l < scene_size; ++l)
      square += (theta_[k] - start[k]) * end.matrix[k][l] * (theta_[l] - start[l]);
  }
  const double count = static_cast<double>(std::max<std::size_t>(1, end.residuals));
  const double accuracy = 1e-9 * data_.typical_misfit;
  return std::sqrt(std::max(square, 0.0) / (end.cost / count + accuracy * accuracy));
}

}  // namespace

NormalEquations normal_equations(const SceneData& data, const LocalScene& local) {
  return products(data, local.theta, local.choices, local.found, local.orbits, nullptr, Effort::settle);
}

LocalScene solve_scene(const SceneData& data, const SceneBounds& bounds, const SceneVector& start, Effort effort,
                       Motions motions) {
  return Solver(data, bounds, motions).run(start, effort);
}

}  // namespace backlash::detail
