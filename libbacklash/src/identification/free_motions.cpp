// SPDX-License-Identifier: BSD-3-Clause
#include "free_motions.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "contact_response.hpp"
#include "response_table.hpp"
#include "steady_state/two_impact_orbit.hpp"

namespace backlash::detail {
namespace {

using Complex = std::complex<double>;
using Kind = PointChoice::Kind;

// With contacts that take time more steps are refused where one of many motions ends nearby, until the point is left
// out, and a round costs more.
constexpr int most_iterations_with_contacts = 25, most_rounds_with_contacts = 8;
// With friction, where each step follows every orbit and its derivatives, some milliseconds a point.
constexpr int most_iterations_with_friction = 12;
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
// Accuracy of the table of irregular motion, as a share of N.
constexpr double table_accuracy = 0.01;
// Contacts that take more of a radian, and friction that is more of the force, are not simulated as hard ones without.
constexpr double nearly_hard = 0.1;

double two_impact_end(double restitution) {
  // At restitution 0 the orbit of two impacts, each followed by a rest, goes on; without rests it ends at 1/pi.
  return restitution > 0 ? two_impact_loss(restitution).gamma : std::numbers::inv_pi;
}

class FreeMotions : public SceneMotions {
 public:
  FreeMotions(const SceneData& data, Effort effort, Motions which) : data_(data), effort_(effort), which_(which) {}

  [[nodiscard]] double accuracy() const override { return is_settling() ? SceneMotions::accuracy() : table_accuracy; }

  [[nodiscard]] std::vector<SettledMotion> settled(const Coordinates& theta,
                                                   const MeasuredPoint& point) const override {
    // N of contacts that take time differs from that of hard ones, which are simulated, in first order of their angle.
    // So does that of masses with friction, by about its share of the force.
    const double angle = contact_angle(theta, data_, point) +
                         (theta[first_friction] + theta[first_friction + 1]) * data_.force_unit / point.force;
    if (angle > nearly_hard || point.harmonic != 1) return {};
    const OutputCoefficients coefficients = output_coefficients(theta, data_.output);
    std::vector<SettledMotion> result;
    for (const StartedMotion& motion : motions_of_starts(gamma_at(theta, point), theta[3]))
      result.push_back({point_value(coefficients, point, motion.h), motion.closes, angle});
    return result;
  }

 protected:
  /// A scene, and what the choice of motions is to know of it.
  struct Scene {
    Coordinates theta;
    OutputCoefficients coefficients;
    double orbit_end;  // gamma up to which the orbit of two impacts is stable
    double limit;      // gamma up to which it counts
    double onset;      // of motion that sticks
  };

  [[nodiscard]] bool is_settling() const { return effort_ == Effort::settle; }

  /// @param find  offers the motions of a point to its choice; is_used tells whether it was used before
  template <typename Find>
  void choose_each(const Coordinates& theta, int round, PointChoices& choices, const Find& find) const {
    const double orbit_end = two_impact_end(theta[3]);
    const bool counts_beyond = effort_ == Effort::glance && round < rounds_beyond_loss;
    const Scene scene{theta, output_coefficients(theta, data_.output), orbit_end,
                      orbit_end * (counts_beyond ? beyond_loss : 1),
                      which_ == Motions::all ? chatter_onset(theta[3]) : std::numeric_limits<double>::infinity()};
    for (std::size_t i = 0; i < choices.size(); ++i) {
      PointChoice choice;
      find(scene, i, choices[i].used, choice);
      if (choice.kind == Kind::none && data_.points[i].harmonic == 1) offer_means(scene, i, choice);
      choices[i] = choice;
    }
  }

  bool offer(const Scene& scene, std::size_t i, Kind kind, Complex h, PointChoice& choice) const {
    const MeasuredPoint& point = data_.points[i];
    return choice.offer(data_, point, kind, point_value(scene.coefficients, point, h));
  }
  // Without impacts x1 stands still, which explains no N but 0.
  void offer_free(const Scene& scene, std::size_t i, double gamma, PointChoice& choice) const {
    if (which_ == Motions::all && data_.output == Output::x2 && gamma <= scene.limit)
      offer(scene, i, Kind::free, 0.0, choice);
  }

  const SceneData& data_;
  Effort effort_;
  Motions which_;

 private:
  // What N is about where the scene is irregular: its mean from contact at rest, or the orbit of two impacts, which
  // motions of doubled period and the chaos after them stay about for a while.
  void offer_means(const Scene& scene, std::size_t i, PointChoice& choice) const {
    const MeasuredPoint& point = data_.points[i];
    const double gamma = gamma_at(scene.theta, point);
    const auto offer_mean = [&](Complex h) {
      const Complex model = point_value(scene.coefficients, point, h);
      const bool is_nearer =
          choice.means == 0 || data_.size(model - point.value) < data_.size(choice.model - point.value);
      if (is_nearer) choice.model = model;
      ++choice.means;
    };
    if (const auto h = mean_h(gamma, scene.theta[3])) offer_mean(*h);
    if (gamma > about_the_orbit * scene.orbit_end) return;
    if (const auto response = two_impact_response(gamma, scene.theta[3])) offer_mean(response->h);
  }
};

class HardMotions final : public FreeMotions {
 public:
  using FreeMotions::FreeMotions;

  [[nodiscard]] Pace pace() const override {
    if (effort_ == Effort::glance) return {rounds_of_a_glance, iterations_of_a_glance};
    return {most_rounds, most_iterations, rounds_beyond_loss};
  }

  void choose(const Coordinates& theta, int round, PointChoices& choices) override {
    choose_each(theta, round, choices, [&](const Scene& scene, std::size_t i, bool, PointChoice& choice) {
      const double gamma = gamma_at(scene.theta, data_.points[i]);
      const int harmonic = data_.points[i].harmonic;
      if (gamma <= scene.limit) {
        if (const auto response = two_impact_response(gamma, scene.theta[3], harmonic))
          offer(scene, i, Kind::two_impact, response->h, choice);
      }
      offer_free(scene, i, gamma, choice);
      if (gamma < scene.onset) return;
      if (const auto h = sticking(gamma, scene.theta[3], harmonic)) offer(scene, i, Kind::sticking, *h, choice);
    });
  }

  [[nodiscard]] PointValues values(const Coordinates& theta, const PointChoices& choices, bool all) const override {
    const OutputCoefficients coefficients = output_coefficients(theta, data_.output);
    return of_used(choices, all, [&](std::size_t i) -> std::optional<Complex> {
      const auto h = h_of(theta, i, choices[i].kind);
      if (!h) return std::nullopt;
      return point_value(coefficients, data_.points[i], *h);
    });
  }

  [[nodiscard]] PointGradients gradients(const Coordinates& theta, const PointChoices& choices) const override {
    const OutputCoefficients coefficients = output_coefficients(theta, data_.output);
    return of_used(choices, true, [&](std::size_t i) -> std::optional<PointGradient> {
      const auto response = response_of(theta, i, choices[i].kind);
      if (!response) return std::nullopt;
      return point_gradient(coefficients, data_, data_.points[i], *response);
    });
  }

  [[nodiscard]] Regime regime(const Coordinates& theta, const MeasuredPoint& point,
                              const PointChoice& choice) const override {
    switch (choice.kind) {
      case Kind::two_impact:
        return gamma_at(theta, point) <= symmetry_breaking_gamma(theta[3]) ? Regime::symmetric : Regime::periodic;
      case Kind::sticking:
        return theta[3] > 0 ? Regime::chatter : Regime::periodic;
      case Kind::free:
        return Regime::free;
      case Kind::none:
        break;
    }
    return Regime::averaged;
  }

 private:
  [[nodiscard]] std::optional<Complex> sticking(double gamma, double restitution, int harmonic) const {
    if (is_settling()) return sticking_h(gamma, restitution, harmonic);
    // The table holds the fundamental alone.
    if (harmonic != 1) return std::nullopt;
    const auto response = rough_sticking_response(gamma, restitution);
    return response ? std::optional<Complex>(response->h) : std::nullopt;
  }

  [[nodiscard]] std::optional<Complex> h_of(const Coordinates& theta, std::size_t i, Kind kind) const {
    const MeasuredPoint& point = data_.points[i];
    const double gamma = gamma_at(theta, point);
    if (kind == Kind::two_impact) {
      const auto response = two_impact_response(gamma, theta[3], point.harmonic);
      return response ? std::optional<Complex>(response->h) : std::nullopt;
    }
    if (kind == Kind::free) return Complex(0);
    // Chaotic motion takes a long mean to be told from motion that sticks: not tried where it is expected.
    if (gamma < chatter_onset(theta[3])) return std::nullopt;
    return sticking(gamma, theta[3], point.harmonic);
  }

  [[nodiscard]] std::optional<GapResponse> response_of(const Coordinates& theta, std::size_t i, Kind kind) const {
    const MeasuredPoint& point = data_.points[i];
    const double gamma = gamma_at(theta, point);
    if (kind == Kind::two_impact) return two_impact_response(gamma, theta[3], point.harmonic);
    if (kind == Kind::free) return GapResponse{};
    if (is_settling() || point.harmonic != 1) return sticking_response(gamma, theta[3], point.harmonic);
    return rough_sticking_response(gamma, theta[3]);
  }
};

class CompliantMotions final : public FreeMotions {
 public:
  CompliantMotions(const SceneData& data, Effort effort, Motions which)
      : FreeMotions(data, effort, which), found_(data.points.size()) {}

  [[nodiscard]] Pace pace() const override {
    if (effort_ == Effort::glance) return {rounds_of_a_glance, iterations_of_a_glance};
    return {most_rounds_with_contacts, most_iterations_with_contacts, 0, near_step, true};
  }

  void choose(const Coordinates& theta, int round, PointChoices& choices) override {
    const ContactMotions motions(theta[3], data_.harmonics);
    choose_each(theta, round, choices, [&](const Scene& scene, std::size_t i, bool, PointChoice& choice) {
      const MeasuredPoint& point = data_.points[i];
      const double gamma = gamma_at(scene.theta, point), tau = contact_angle(scene.theta, data_, point);
      FoundMotions& found = found_[point.motion];
      bool is_stable = false;
      if (const auto h = contact_h(motions, gamma, tau, false, found, true)[harmonic_place(point.harmonic)]) {
        is_stable = found.symmetric->largest_multiplier < 1;
        if (found.symmetric->largest_multiplier < (scene.limit > scene.orbit_end ? multiplier_beyond_loss : 1))
          offer(scene, i, Kind::two_impact, *h, choice);
      }
      offer_free(scene, i, gamma, choice);
      if (which_ == Motions::all && is_settling() && (!is_stable || gamma >= scene.onset))
        offer_followed(scene, i, motions, choice);
    });
  }

  [[nodiscard]] PointValues values(const Coordinates& theta, const PointChoices& choices, bool all) const override {
    const OutputCoefficients coefficients = output_coefficients(theta, data_.output);
    const ContactMotions contact(theta[3], data_.harmonics);
    std::vector<FoundMotions> found = found_;
    return of_used(choices, all, [&](std::size_t i) -> std::optional<Complex> {
      const MeasuredPoint& point = data_.points[i];
      if (choices[i].kind == Kind::free) return point_value(coefficients, point, 0);
      const auto h =
          contact_h(contact, gamma_at(theta, point), contact_angle(theta, data_, point),
                    choices[i].kind == Kind::sticking, found[point.motion], false)[harmonic_place(point.harmonic)];
      if (!h) return std::nullopt;
      return point_value(coefficients, point, *h);
    });
  }

  [[nodiscard]] PointGradients gradients(const Coordinates& theta, const PointChoices& choices) const override {
    const OutputCoefficients coefficients = output_coefficients(theta, data_.output);
    const ContactResponses contact(theta[3], data_.harmonics);
    // Of motions, the symmetric and the followed one.
    std::vector<std::array<std::optional<ContactResponses::All>, 2>> responses(found_.size());
    return of_used(choices, true, [&](std::size_t i) -> std::optional<PointGradient> {
      const MeasuredPoint& point = data_.points[i];
      if (choices[i].kind == Kind::free) return point_gradient(coefficients, data_, point, {});
      const bool is_followed = choices[i].kind == Kind::sticking;
      auto& all = responses[point.motion][is_followed ? 1 : 0];
      if (!all) {
        all = contact.at(gamma_at(theta, point), contact_angle(theta, data_, point), is_followed, found_[point.motion]);
      }
      const auto& response = (*all)[harmonic_place(point.harmonic)];
      if (!response) return std::nullopt;
      return point_gradient(coefficients, data_, point, *response);
    });
  }

  [[nodiscard]] Regime regime(const Coordinates& theta, const MeasuredPoint& point,
                              const PointChoice& choice) const override {
    if (choice.kind == Kind::free) return Regime::free;
    if (choice.kind == Kind::two_impact) return Regime::symmetric;
    if (choice.kind == Kind::none) return Regime::averaged;
    // At contact time 0 what sticks, and the asymmetric orbit of two impacts.
    const bool sticks = theta[4] == 0 && theta[3] > 0 && gamma_at(theta, point) > two_impact_loss(theta[3]).gamma;
    return sticks ? Regime::chatter : Regime::periodic;
  }

 private:
  // The orbit of one period that is near, or that contact at rest leads to.
  void offer_followed(const Scene& scene, std::size_t i, const ContactMotions& motions, PointChoice& choice) {
    const MeasuredPoint& point = data_.points[i];
    FoundMotions& found = found_[point.motion];
    const auto& h = contact_h(motions, gamma_at(scene.theta, point), contact_angle(scene.theta, data_, point), true,
                              found, found.failures < most_failures);
    if (const auto& own = h[harmonic_place(point.harmonic)]) offer(scene, i, Kind::sticking, *own, choice);
    if (!h[0] && point.motion == i) ++found.failures;
  }

  std::vector<FoundMotions> found_;  // at the place of each motion
};

class RubbingMotions final : public FreeMotions {
 public:
  RubbingMotions(const SceneData& data, Effort effort, Motions which)
      : FreeMotions(data, effort, which), found_(data.points.size()), attempts_(data.points.size()) {}

  [[nodiscard]] Pace pace() const override {
    if (effort_ == Effort::glance) return {rounds_of_a_glance, iterations_of_a_glance};
    return {most_rounds, most_iterations_with_friction, 0, near_step, true};
  }

  // The orbit found last and, where that has ended or does not explain the point, those that the symmetric one without
  // friction and contact at rest lead to.
  void choose(const Coordinates& theta, int round, PointChoices& choices) override {
    choose_each(theta, round, choices, [&](const Scene& scene, std::size_t i, bool is_explained, PointChoice& choice) {
      const MeasuredPoint& point = data_.points[i];
      const FrictionGroups groups = friction_groups(scene.theta, data_, point);
      FoundOrbit nearest;
      const auto offer_from = [&](FrictionStart start) {
        FoundOrbit found = found_[i];
        const auto n = friction_n(groups, data_.output, start, found, point.harmonic);
        if (n && choice.offer(data_, point, Kind::sticking, friction_value(scene.theta, point, *n)))
          nearest = std::move(found);
        return n.has_value();
      };
      const bool is_there = offer_from(FrictionStart::found);
      if (!(is_there && is_explained) && attempts_[i] < most_attempts) {
        ++attempts_[i];
        offer_from(FrictionStart::symmetric);
        offer_from(FrictionStart::rest);
      }
      found_[i] = std::move(nearest);
    });
  }

  bool look_again() override {
    std::fill(attempts_.begin(), attempts_.end(), 0);
    return true;
  }

  [[nodiscard]] PointValues values(const Coordinates& theta, const PointChoices& choices, bool all) const override {
    return of_used(choices, all, [&](std::size_t i) -> std::optional<Complex> {
      const MeasuredPoint& point = data_.points[i];
      FoundOrbit found = found_[i];
      const auto n =
          friction_n(friction_groups(theta, data_, point), data_.output, FrictionStart::found, found, point.harmonic);
      if (!n) return std::nullopt;
      return friction_value(theta, point, *n);
    });
  }

  [[nodiscard]] PointGradients gradients(const Coordinates& theta, const PointChoices& choices) const override {
    return of_used(choices, true, [&](std::size_t i) -> std::optional<PointGradient> {
      const MeasuredPoint& point = data_.points[i];
      const auto response =
          friction_response(friction_groups(theta, data_, point), data_.output, found_[i], point.harmonic);
      if (!response) return std::nullopt;
      return friction_gradient(theta, data_, point, *response);
    });
  }

  // Halves of these orbits need not mirror each other.
  [[nodiscard]] Regime regime(const Coordinates&, const MeasuredPoint&, const PointChoice& choice) const override {
    return choice.kind == Kind::none ? Regime::averaged : Regime::periodic;
  }

 private:
  std::vector<FoundOrbit> found_;
  std::vector<int> attempts_;  // to find them from their start
};

}  // namespace

std::shared_ptr<SceneMotions> free_motions(const SceneData& data, bool takes_time, bool rubs, Effort effort,
                                           Motions which) {
  if (rubs) return std::make_shared<RubbingMotions>(data, effort, which);
  if (takes_time) return std::make_shared<CompliantMotions>(data, effort, which);
  return std::make_shared<HardMotions>(data, effort, which);
}

}  // namespace backlash::detail
