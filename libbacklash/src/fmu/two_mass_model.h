/* SPDX-License-Identifier: BSD-3-Clause */
/* Two masses with a clearance as a model: backlash/two_mass_plant.hpp, operation for operation, so that both give the
 * same bits.  The force is constant within a step; flights are parabolas and impacts are met at exact instants.
 * In model exchange the simulator integrates the states below and finds the impacts by their indicators.
 */
#include <float.h>
#include <math.h>

enum {
  at_force,
  at_position1,
  at_velocity1,
  at_position2,
  at_velocity2,
  at_gap,
  at_energy_loss,
  at_impacts,
  at_mass1,
  at_mass2,
  at_clearance,
  at_restitution,
  at_start_position1,
  at_start_velocity1,
  at_start_position2,
  at_start_velocity2
};

/* Continuous states. */
enum { of_centre, of_centre_rate, of_gap, of_gap_rate };

typedef struct {
  double real[MODEL_REALS];
  int boolean[MODEL_BOOLEANS]; /* whether the masses rest in contact */
  double mass1, mass2, clearance, restitution;
  double total_mass, reduced_mass, share1, share2;
  double centre, centre_rate;
  /* The gap from the wall last touched, so that short hops keep relative precision at either wall. */
  int at_far;
  double distance, rate;
  double energy_loss, impacts;
  double x[MODEL_STATES];
} model;

typedef struct {
  double after;
  double speed;
} first_contact;

/* First t > 0 at which distance + rate t + acceleration t^2/2 falls to 0, and the speed there. */
static inline first_contact fall(double distance, double rate, double acceleration)
{
  first_contact result = {HUGE_VAL, 0};
  const double square = rate * rate - 2 * acceleration * distance;
  if (square < 0 || (rate >= 0 && acceleration >= 0)) return result;
  result.speed = sqrt(square);
  result.after = rate < 0 ? 2 * distance / (result.speed - rate) : (rate + result.speed) / -acceleration;
  return result;
}

static double impact_energy_loss(const model *m, double speed)
{
  const double e = m->restitution;
  const double reduced = m->mass1 / (m->mass1 + m->mass2) * m->mass2;
  return (1 - e) * (1 + e) * reduced / 2 * speed * speed;
}

/* The states of what a step has changed. */
static void keep_states(model *m)
{
  m->x[of_centre] = m->centre;
  m->x[of_centre_rate] = m->centre_rate;
  m->x[of_gap] = m->at_far ? m->clearance - m->distance : m->distance;
  m->x[of_gap_rate] = m->at_far ? -m->rate : m->rate;
}

static inline void hit(model *m, double speed)
{
  m->distance = 0;
  m->rate = m->restitution * speed;
  m->energy_loss += impact_energy_loss(m, speed);
  m->impacts += 1;
}

static const char *model_start(model *m, double time)
{
  double gap;
  (void)time;
  m->mass1 = m->real[at_mass1];
  m->mass2 = m->real[at_mass2];
  m->clearance = m->real[at_clearance];
  m->restitution = m->real[at_restitution];
  if (!(m->mass1 > 0 && m->mass2 > 0)) return "mass1 and mass2 must be above 0 kg";
  if (!(m->clearance >= 0)) return "clearance must not be below 0 m";
  if (!(m->restitution >= 0 && m->restitution <= 1)) return "restitution must be in [0, 1]";
  m->total_mass = m->mass1 + m->mass2;
  m->reduced_mass = m->mass1 / m->total_mass * m->mass2;
  gap = m->real[at_start_position2] - m->real[at_start_position1];
  if (!(gap >= 0 && gap <= m->clearance)) return "start_position2 - start_position1 must be in [0, clearance]";
  m->share1 = m->mass1 / m->total_mass;
  m->share2 = m->mass2 / m->total_mass;
  m->energy_loss = 0;
  m->impacts = 0;
  m->boolean[0] = 0;
  m->centre = m->real[at_start_position1] + m->share2 * gap;
  m->centre_rate =
      m->real[at_start_velocity1] + m->share2 * (m->real[at_start_velocity2] - m->real[at_start_velocity1]);
  m->at_far = gap > m->clearance / 2;
  m->distance = m->at_far ? m->clearance - gap : gap;
  m->rate = (m->at_far ? -1 : 1) * (m->real[at_start_velocity2] - m->real[at_start_velocity1]);
  if (m->clearance == 0) {
    /* Without clearance the masses are one body. */
    if (m->rate != 0) m->energy_loss = 0.5 * m->reduced_mass * m->rate * m->rate;
    m->rate = 0;
    m->boolean[0] = 1;
  } else if (m->distance == 0 && m->rate < 0) {
    hit(m, -m->rate);
  }
  keep_states(m);
  return 0;
}

/* Hops from the wall that stay short of the other one: hop k starts with rate eps^k v and lasts 2 eps^k v/pressure.
 * Returns the time that is left when they have ended in rest, or 0. */
static double hop_along_wall(model *m, double pressure, double duration)
{
  const double restitution = m->restitution;
  const double first = 2 * m->rate / pressure;
  const double all = restitution < 1 ? first / (1 - restitution) : HUGE_VAL;
  double hops = 0, passed = 0, rest, before;
  if (all <= duration) {
    m->energy_loss += 0.5 * m->reduced_mass * m->rate * m->rate;
    m->impacts += 1;
    m->rate = 0;
    m->distance = 0;
    return duration - all;
  }
  if (restitution == 1) {
    const double remainder = fmod(duration, first);
    passed = duration - remainder;
    hops = round(passed / first);
  } else if (first < duration) {
    hops = floor(log1p(-duration / all) / log(restitution));
    passed = -all * expm1(hops * log(restitution));
    if (passed > duration) {
      hops -= 1;
      passed = -all * expm1(hops * log(restitution));
    }
  }
  before = m->rate;
  m->rate *= pow(restitution, hops);
  m->energy_loss += 0.5 * m->reduced_mass * (before - m->rate) * (before + m->rate);
  m->impacts += hops;
  rest = duration - passed;
  if (rest < 0) rest = 0;
  if (2 * m->rate / pressure < rest) rest = 2 * m->rate / pressure;
  m->distance = rest * (m->rate - 0.5 * pressure * rest);
  if (!(m->distance > 0)) m->distance = 0;
  m->rate -= pressure * rest;
  if (m->distance == 0 && m->rate < 0) hit(m, -m->rate);
  return 0;
}

static void move_gap(model *m, double acceleration, double duration)
{
  double left = duration, away;
  m->boolean[0] = 0;
  while (left > 0) {
    first_contact back = {HUGE_VAL, 0}, across, first;
    int is_across;
    away = m->at_far ? -acceleration : acceleration;
    if (m->distance == 0 && m->rate == 0 && away <= 0) {
      m->boolean[0] = 1;
      return;
    }
    if (m->distance != 0) back = fall(m->distance, m->rate, away);
    across = fall(m->clearance - m->distance, -m->rate, -away);
    if (m->distance == 0 && away < 0 && across.after == HUGE_VAL) {
      left = hop_along_wall(m, -away, left);
      continue;
    }
    is_across = !(back.after <= across.after);
    first = is_across ? across : back;
    if (first.after > left) {
      m->distance = m->distance + left * (m->rate + 0.5 * away * left);
      if (m->distance < 0) m->distance = 0;
      if (m->distance > m->clearance) m->distance = m->clearance;
      m->rate += away * left;
      /* A contact within rounding of the end of the step. */
      if (m->distance == 0 && m->rate < 0) hit(m, -m->rate);
      if (m->distance == m->clearance && m->rate > 0) {
        m->at_far = !m->at_far;
        hit(m, m->rate);
      }
      return;
    }
    left -= first.after;
    if (is_across) m->at_far = !m->at_far;
    hit(m, first.speed);
  }
  away = m->at_far ? -acceleration : acceleration;
  m->boolean[0] = m->distance == 0 && m->rate == 0 && away <= 0;
}

static const char *model_step(model *m, double time, double duration)
{
  const double force = m->real[at_force];
  const double acceleration = force / m->mass2;
  const double common = force / m->total_mass;
  (void)time;
  if (m->clearance > 0) {
    const double fastest = sqrt(m->rate * m->rate + 2 * fabs(acceleration) * m->clearance);
    if (!(fastest * duration <= 1e7 * m->clearance)) return "the clearance would be crossed more than 1e7 times in a step";
    move_gap(m, acceleration, duration);
  }
  m->centre += duration * (m->centre_rate + 0.5 * common * duration);
  m->centre_rate += common * duration;
  keep_states(m);
  return 0;
}

static double *model_state(model *m)
{
  return m->x;
}

static void model_rates(model *m, double *rate)
{
  rate[of_centre] = m->x[of_centre_rate];
  rate[of_centre_rate] = m->real[at_force] / m->total_mass;
  rate[of_gap] = m->boolean[0] ? 0 : m->x[of_gap_rate];
  rate[of_gap_rate] = m->boolean[0] ? 0 : m->real[at_force] / m->mass2;
}

/* Acceleration away from the wall that is touched, or was last. */
static double away_from_wall(const model *m)
{
  return (m->at_far ? -1 : 1) * m->real[at_force] / m->mass2;
}

/* The distances from both walls, and in contact what presses the masses together.  On a wall the sign tells whether
 * the masses are parting. */
static void model_indicators(model *m, double *indicator)
{
  const int is_joined = m->boolean[0];
  const double rate = m->x[of_gap_rate], force = m->real[at_force];
  double near = m->x[of_gap], far = m->clearance - m->x[of_gap];
  if (near == 0) near = rate > 0 || (rate == 0 && force > 0) ? DBL_MIN : -DBL_MIN;
  if (far == 0) far = rate < 0 || (rate == 0 && force < 0) ? DBL_MIN : -DBL_MIN;
  indicator[0] = is_joined ? 1 : near;
  indicator[1] = is_joined ? 1 : far;
  indicator[2] = is_joined && m->clearance > 0 && away_from_wall(m) > 0 ? -1 : 1;
}

/* An impact, a contact that begins because hops have become too low to tell, or one that ends. */
static int model_event(model *m)
{
  const double lowest_hop = 1e-9 * m->clearance;
  const double gap = m->x[of_gap], rate = m->x[of_gap_rate];
  int is_near, is_far;
  double away;
  if (m->clearance == 0) return 0;
  if (m->boolean[0]) {
    m->boolean[0] = away_from_wall(m) <= 0;
    return 0;
  }
  is_near = gap <= 0 && rate <= 0;
  is_far = gap >= m->clearance && rate >= 0;
  if (!is_near && !is_far) return 0;
  m->at_far = is_far;
  away = away_from_wall(m);
  if (rate == 0 && away > 0) return 0;
  m->distance = m->rate = 0;
  if (rate != 0) hit(m, fabs(rate));
  if (away <= 0 && m->rate * m->rate <= -2 * away * lowest_hop) {
    m->energy_loss += 0.5 * m->reduced_mass * m->rate * m->rate;
    m->rate = 0;
    m->boolean[0] = 1;
  }
  m->x[of_gap] = m->at_far ? m->clearance : 0;
  m->x[of_gap_rate] = m->at_far ? -m->rate : m->rate;
  return 1;
}

static void model_results(model *m)
{
  const double centre = m->x[of_centre], centre_rate = m->x[of_centre_rate];
  const double y = m->x[of_gap], y_rate = m->x[of_gap_rate];
  m->real[at_position1] = centre - m->share2 * y;
  m->real[at_velocity1] = centre_rate - m->share2 * y_rate;
  m->real[at_position2] = centre + m->share1 * y;
  m->real[at_velocity2] = centre_rate + m->share1 * y_rate;
  m->real[at_gap] = y;
  m->real[at_energy_loss] = m->energy_loss;
  m->real[at_impacts] = m->impacts;
}
