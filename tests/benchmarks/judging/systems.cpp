// SPDX-License-Identifier: BSD-3-Clause
#include "benchmarks/judging/systems.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace judging {
namespace {

using Parameters = std::vector<double>;

/// s^a on the principal branch, with s itself untouched at a = 1.
Complex power(Complex s, double a) {
  return a == 1 ? s : std::pow(s, a);
}

Complex whole_power(Complex s, int n) {
  Complex result = 1;
  for (int i = 0; i < n; ++i) result *= s;
  return result;
}

Complex lag(double time, Complex s) {
  return 1.0 / (1.0 + time * s);
}

/// tanh(x)/x without overflow for large x.
Complex tanh_over(Complex x) {
  const Complex e = std::exp(-2.0 * x);
  return (1.0 - e) / ((1.0 + e) * x);
}

std::string numbered(const std::string& stem, int count) {
  std::string names;
  for (int i = 1; i <= count; ++i) names += (i == 1 ? "" : " ") + stem + std::to_string(i);
  return names;
}

/// Lags with the given times; the order sits at the slowest, which is the first.
System lags(Parameters times) {
  std::sort(times.rbegin(), times.rend());
  const int count = static_cast<int>(times.size());
  return {[](const Parameters& p, double a, Complex s) {
            Complex result = 1.0 / (1.0 + power(p[0] * s, a));
            for (std::size_t i = 1; i < p.size(); ++i) result *= lag(p[i], s);
            return result;
          },
          numbered("T", count), std::move(times)};
}

Parameters draw_times(RandomNumbers& random, int count, double low, double high) {
  Parameters times;
  for (int i = 0; i < count; ++i) times.push_back(random.log_uniform(low, high));
  return times;
}

/// The same system behind a dead time, its last parameter.
System delayed(System system, double delay) {
  auto inner = std::move(system.response);
  system.response = [inner](const Parameters& p, double a, Complex s) {
    return inner(p, a, s) * std::exp(-p.back() * s);
  };
  system.names += system.names.empty() ? "L" : " L";
  system.parameters.push_back(delay);
  system.delay = delay;
  return system;
}

/// One mode: 1 + 2 zeta (s/w)^a + (s/w)^2, damping being the part that may be fractional.
Complex mode(double frequency, double damping, double a, Complex s) {
  const Complex x = s / frequency;
  return 1.0 + 2 * damping * power(x, a) + x * x;
}

/// Driving point admittance of a chain of masses, springs and dampers, or impedance of a ladder: continued fraction
/// from its far end, series elements `series` and shunt elements 1/(s^a `shunt`).
System ladder(Parameters series, Parameters shunt, double load) {
  const std::size_t count = series.size();
  Parameters p = std::move(series);
  p.insert(p.end(), shunt.begin(), shunt.end());
  p.push_back(load);
  return {[count](const Parameters& q, double a, Complex s) {
            Complex impedance = q[2 * count];
            for (std::size_t i = count; i-- > 0;) {
              const Complex admittance = (i == 0 ? power(s * q[count], a) : s * q[count + i]) + 1.0 / impedance;
              impedance = q[i] + 1.0 / admittance;
            }
            return impedance;
          },
          numbered("R", static_cast<int>(count)) + " " + numbered("C", static_cast<int>(count)) + " load", p};
}

Kind integer(std::string name, std::function<System(RandomNumbers&)> draw) {
  return {std::move(name), false, true, std::move(draw)};
}

/// Integer-order systems that no small ratio of polynomials writes exactly.
Kind beyond(std::string name, std::function<System(RandomNumbers&)> draw) {
  return {std::move(name), false, false, std::move(draw)};
}

Kind fractional(std::string name, std::function<System(RandomNumbers&)> draw) {
  return {std::move(name), true, true, std::move(draw)};
}

/// Fractional systems whose structure has no common name.
Kind nameless(std::string name, std::function<System(RandomNumbers&)> draw) {
  return {std::move(name), true, false, std::move(draw)};
}

/// An order away from whole numbers.
double draw_order(RandomNumbers& random) {
  return random.chance(0.75) ? random.uniform(0.4, 0.88) : random.uniform(1.12, 1.6);
}

System fractional_lag(RandomNumbers& random, double order) {
  (void)random;
  return {[](const Parameters& p, double a, Complex s) { return 1.0 / (1.0 + power(p[0] * s, a)); }, "T", {1}, order};
}

void add_integer_kinds(std::vector<Kind>& all) {
  all.push_back(integer("lag", [](RandomNumbers&) { return lags({1}); }));
  all.push_back(integer("two-lags", [](RandomNumbers& r) {
    const double spread = r.log_uniform(1.2, 40);
    return lags({std::sqrt(spread), 1 / std::sqrt(spread)});
  }));
  all.push_back(integer("three-lags-near", [](RandomNumbers& r) { return lags(draw_times(r, 3, 0.3, 3)); }));
  all.push_back(integer("equal-lags", [](RandomNumbers& r) {
    // Equal times are one parameter, whatever their number.
    const int count = r.whole(3, 6);
    return System{[count](const Parameters& p, double a, Complex s) {
                    return whole_power(lag(p[0], s), count - 1) / (1.0 + power(p[0] * s, a));
                  },
                  "T",
                  {1}};
  }));
  all.push_back(integer("lags-in-geometric-row", [](RandomNumbers& r) {
    const int count = r.whole(4, 6);
    const double ratio = r.log_uniform(1.5, 6);
    Parameters times;
    for (int i = 0; i < count; ++i) times.push_back(std::pow(ratio, i - 0.5 * (count - 1)));
    return lags(times);
  }));
  all.push_back(integer("underdamped", [](RandomNumbers& r) {
    return System{[](const Parameters& p, double a, Complex s) { return 1.0 / mode(p[0], p[1], a, s); },
                  "w zeta",
                  {1, r.log_uniform(0.02, 0.8)}};
  }));
  all.push_back(integer("modes-driven-and-seen-at-one-place", [](RandomNumbers& r) {
    const int count = r.whole(2, 3);
    Parameters p;
    for (int i = 0; i < count; ++i) {
      p.push_back(std::pow(2.5, i - 0.5 * (count - 1)) * r.uniform(0.8, 1.2));
      p.push_back(r.log_uniform(0.01, 0.2));
      p.push_back(r.log_uniform(0.3, 3));
    }
    return System{[](const Parameters& q, double a, Complex s) {
                    Complex sum = 0;
                    for (std::size_t i = 0; i < q.size(); i += 3) {
                      sum += q[i + 2] / mode(q[i], q[i + 1], i == 0 ? a : 1, s);
                    }
                    return sum;
                  },
                  count == 2 ? "w1 zeta1 c1 w2 zeta2 c2" : "w1 zeta1 c1 w2 zeta2 c2 w3 zeta3 c3", p};
  }));
  all.push_back(integer("modes-of-alternating-sign", [](RandomNumbers& r) {
    return System{[](const Parameters& q, double a, Complex s) {
                    return 1.0 / mode(q[0], q[1], a, s) - q[4] / mode(q[2], q[3], 1, s);
                  },
                  "w1 zeta1 w2 zeta2 c2",
                  {0.6, r.log_uniform(0.02, 0.3), r.uniform(1.2, 4), r.log_uniform(0.02, 0.3), r.uniform(0.2, 0.9)}};
  }));
  all.push_back(integer("three-lags-two-zeros", [](RandomNumbers& r) {
    const double zero1 = r.log_uniform(0.05, 20);
    const double zero2 = r.log_uniform(0.05, 20);
    return System{[](const Parameters& p, double a, Complex s) {
                    return (1.0 + p[3] * s) * (1.0 + p[4] * s) * lag(p[1], s) * lag(p[2], s) /
                           (1.0 + power(p[0] * s, a));
                  },
                  "T1 T2 T3 Z1 Z2",
                  {r.log_uniform(3, 20), r.log_uniform(0.5, 2), r.log_uniform(0.05, 0.3), zero1, zero2}};
  }));
  all.push_back(
      integer("lag-and-dead-time", [](RandomNumbers& r) { return delayed(lags({1}), r.log_uniform(0.1, 2)); }));
  all.push_back(integer("lags-and-dead-time", [](RandomNumbers& r) {
    return delayed(lags(draw_times(r, r.whole(2, 4), 0.2, 2)), r.log_uniform(0.1, 1));
  }));
  all.push_back(integer("zero-in-the-right-half-plane", [](RandomNumbers& r) {
    return System{[](const Parameters& p, double a, Complex s) {
                    return (1.0 - p[2] * s) * lag(p[1], s) / (1.0 + power(p[0] * s, a));
                  },
                  "T1 T2 Z",
                  {r.log_uniform(0.8, 3), r.log_uniform(0.2, 1), r.log_uniform(0.1, 3)}};
  }));
  all.push_back(integer("integrator-with-lags", [](RandomNumbers& r) {
    return System{
        [](const Parameters& p, double a, Complex s) { return lag(p[1], s) / (power(s, a) * (1.0 + p[0] * s)); },
        "T1 T2",
        {r.log_uniform(0.5, 5), r.log_uniform(0.05, 0.5)}};
  }));
  all.push_back(integer("three-arcs", [](RandomNumbers& r) {
    // Neighbouring arcs at factors of 3 to 20 in time: some of them merge to what looks like one depressed arc.
    const double spread = r.log_uniform(3, 20);
    return System{
        [](const Parameters& p, double a, Complex s) {
          return p[0] + p[1] / (1.0 + power(p[4] * s, a)) + p[2] * lag(p[5], s) + p[3] * lag(p[6], s);
        },
        "R0 R1 R2 R3 T1 T2 T3",
        {r.uniform(0.05, 0.5), r.uniform(0.3, 1), r.uniform(0.3, 1), r.uniform(0.3, 1), spread, 1, 1 / spread}};
  }));
  all.push_back(integer("uniform-ladder", [](RandomNumbers& r) {
    const auto count = static_cast<std::size_t>(r.whole(3, 6));
    return ladder(Parameters(count, 1), Parameters(count, 1), r.log_uniform(0.3, 30));
  }));
  all.push_back(integer("recursive-ladder", [](RandomNumbers& r) {
    // Poles and zeros in a geometric row: over the row it slopes as a power of s would, with a ripple.
    const int count = r.whole(4, 8);
    const double ratio = r.log_uniform(3, 25);
    const double slope = r.uniform(0.3, 0.7);
    Parameters p;
    for (int i = 0; i < count; ++i) {
      const double time = std::pow(ratio, 0.5 * (count - 1) - i);
      p.push_back(time);
      p.push_back(time * std::pow(ratio, -slope));
    }
    return System{[](const Parameters& q, double a, Complex s) {
                    Complex result = (1.0 + q[1] * s) / (1.0 + power(q[0] * s, a));
                    for (std::size_t i = 2; i < q.size(); i += 2) result *= (1.0 + q[i + 1] * s) * lag(q[i], s);
                    return result;
                  },
                  "pole-and-zero-times", p};
  }));
  all.push_back(integer("controller-with-filter", [](RandomNumbers& r) {
    return System{
        [](const Parameters& p, double a, Complex s) { return 1.0 + p[0] / power(s, a) + p[1] * s / (1.0 + p[2] * s); },
        "Ki Kd Tf",
        {r.log_uniform(0.2, 3), r.log_uniform(0.2, 3), r.log_uniform(0.01, 0.2)}};
  }));
  all.push_back(integer("coil-with-capacitance", [](RandomNumbers& r) {
    return System{[](const Parameters& p, double a, Complex s) {
                    const Complex coil = p[0] + p[1] * power(s, a);
                    return coil / (1.0 + p[2] * s * coil) + p[3];
                  },
                  "R L C Rs",
                  {r.log_uniform(0.05, 1), 1, r.log_uniform(0.05, 1), r.log_uniform(0.01, 0.3)}};
  }));
  all.push_back(integer("unstable-plant", [](RandomNumbers& r) {
    return System{[](const Parameters& p, double a, Complex s) { return lag(p[1], s) / (power(p[0] * s, a) - 1.0); },
                  "T1 T2",
                  {r.log_uniform(0.5, 2), r.log_uniform(0.05, 0.8)}};
  }));
  all.push_back(integer("double-integrator-with-mode", [](RandomNumbers& r) {
    return System{[](const Parameters& p, double a, Complex s) {
                    return mode(p[0], p[1], 1, s) / (s * s * mode(p[2], p[3], a, s));
                  },
                  "wz zetaz wp zetap",
                  {r.uniform(0.5, 1), r.log_uniform(0.01, 0.1), r.uniform(1.3, 2.5), r.log_uniform(0.01, 0.1)}};
  }));
  all.push_back(integer("notch", [](RandomNumbers& r) {
    return System{
        [](const Parameters& p, double a, Complex s) { return mode(p[0], p[1], 1, s) / mode(p[0], p[2], a, s); },
        "w zetaz zetap",
        {1, r.log_uniform(0.01, 0.2), r.log_uniform(0.3, 1.5)}};
  }));
  all.push_back(integer("butterworth", [](RandomNumbers& r) {
    // Its only parameter is the corner.
    const int count = r.whole(3, 7);
    return System{[count](const Parameters& p, double a, Complex s) {
                    Complex result = count % 2 == 1 ? 1.0 / (1.0 + power(s / p[0], a)) : Complex(1);
                    for (int i = 0; i < count / 2; ++i) {
                      const double damping = std::sin((2 * i + 1) * std::numbers::pi / (2 * count));
                      result /= mode(p[0], damping, i == 0 && count % 2 == 0 ? a : 1, s);
                    }
                    return result;
                  },
                  "w",
                  {1}};
  }));
  all.push_back(integer("all-pass-behind-a-lag", [](RandomNumbers& r) {
    const int count = r.whole(2, 4);
    System system{[count](const Parameters& p, double a, Complex s) {
                    return whole_power((1.0 - p[0] * s) * lag(p[0], s), count) / (1.0 + power(p[1] * s, a));
                  },
                  "T1 T2",
                  {r.log_uniform(0.1, 0.6), 1}};
    return system;
  }));
  all.push_back(integer("chain-of-four-masses", [](RandomNumbers& r) {
    // Mobility at the driven end: springs and light dampers between masses, the last spring to the wall.
    return System{[](const Parameters& p, double a, Complex s) {
                    Complex impedance = 0;
                    for (std::size_t i = 4; i-- > 0;) {
                      const Complex link = p[i] / s + p[4 + i] * (i == 0 ? power(s, a - 1) : Complex(1));
                      // The last link ends at the wall, the others at the masses behind them.
                      const Complex behind = i == 3 ? link : link * impedance / (link + impedance);
                      impedance = s + behind;
                    }
                    return 1.0 / impedance;
                  },
                  "k1 k2 k3 k4 c1 c2 c3 c4",
                  {r.uniform(0.5, 2), r.uniform(0.5, 2), r.uniform(0.5, 2), r.uniform(0.5, 2), r.log_uniform(0.02, 0.3),
                   r.log_uniform(0.02, 0.3), r.log_uniform(0.02, 0.3), r.log_uniform(0.02, 0.3)}};
  }));
  all.push_back(integer("nearly-cancelling-pole-and-zero", [](RandomNumbers& r) {
    // A drift of some per cent, seen often in slow measurements.
    return System{[](const Parameters& p, double a, Complex s) {
                    return (1.0 + p[1] * s) * lag(p[0], s) / (1.0 + power(p[2] * s, a));
                  },
                  "T1 Z T2",
                  {r.log_uniform(3, 30), r.log_uniform(2.4, 33), r.log_uniform(0.3, 1)}};
  }));
  all.push_back(beyond("ladder-of-forty", [](RandomNumbers& r) {
    const int count = r.whole(25, 60);
    System system{[count](const Parameters& p, double a, Complex s) {
                    Complex impedance = p[0];
                    for (int i = 0; i < count; ++i) impedance = p[1] + 1.0 / (power(p[2] * s, a) + 1.0 / impedance);
                    return impedance;
                  },
                  "load R C",
                  {r.log_uniform(1, 100), 0.2, 0.2}};
    return system;
  }));
  all.push_back(beyond("delay-inside-a-loop", [](RandomNumbers& r) {
    return System{[](const Parameters& p, double a, Complex s) {
                    return 1.0 / (1.0 + power(p[0] * s, a) + p[1] * std::exp(-p[2] * s));
                  },
                  "T k L",
                  {1, r.uniform(0.3, 2), r.log_uniform(0.2, 1)}};
  }));
  all.push_back(beyond("held-sample-and-lag", [](RandomNumbers& r) {
    return System{[](const Parameters& p, double a, Complex s) {
                    return (1.0 - std::exp(-p[1] * s)) / (p[1] * s * (1.0 + power(p[0] * s, a)));
                  },
                  "T Ts",
                  {1, r.log_uniform(0.05, 0.5)}};
  }));
}

void add_fractional_kinds(std::vector<Kind>& all) {
  all.push_back(fractional("fractional-lag", [](RandomNumbers& r) { return fractional_lag(r, draw_order(r)); }));
  all.push_back(fractional("fractional-lag-near-whole-order",
                           [](RandomNumbers& r) { return fractional_lag(r, r.chance(0.5) ? 0.95 : 1.05); }));
  all.push_back(fractional("fractional-lag-and-dead-time", [](RandomNumbers& r) {
    return delayed(fractional_lag(r, r.uniform(0.5, 0.9)), r.log_uniform(0.1, 1));
  }));
  all.push_back(fractional("cole-cole-on-a-floor", [](RandomNumbers& r) {
    return System{[](const Parameters& p, double a, Complex s) { return p[1] + 1.0 / (1.0 + power(p[0] * s, a)); },
                  "T floor",
                  {1, r.log_uniform(0.03, 1)},
                  r.uniform(0.5, 0.9)};
  }));
  all.push_back(fractional("cole-davidson", [](RandomNumbers& r) {
    return System{[](const Parameters& p, double a, Complex s) { return std::pow(1.0 + p[0] * s, -a); },
                  "T",
                  {1},
                  r.uniform(0.3, 0.85)};
  }));
  all.push_back(fractional("havriliak-negami", [](RandomNumbers& r) {
    return System{[](const Parameters& p, double a, Complex s) { return std::pow(1.0 + power(p[0] * s, a), -p[1]); },
                  "T b",
                  {1, r.uniform(0.35, 0.8)},
                  r.uniform(0.5, 0.9)};
  }));
  all.push_back(fractional("two-zarcs", [](RandomNumbers& r) {
    const double spread = r.log_uniform(3, 60);
    return System{
        [](const Parameters& p, double a, Complex s) {
          return p[0] + p[1] / (1.0 + power(p[3] * s, a)) + p[2] / (1.0 + power(p[4] * s, p[5]));
        },
        "R0 R1 R2 T1 T2 a2",
        {r.log_uniform(0.05, 0.5), r.uniform(0.3, 1), r.uniform(0.3, 1), spread, 1 / spread, r.uniform(0.6, 0.95)},
        r.uniform(0.55, 0.9)};
  }));
  all.push_back(fractional("warburg-short-with-resistance", [](RandomNumbers& r) {
    return System{[](const Parameters& p, double a, Complex s) { return p[0] + tanh_over(power(p[1] * s, a)); },
                  "R T",
                  {r.log_uniform(0.02, 0.5), 3},
                  0.5};
  }));
  all.push_back(nameless("warburg-open-with-arc", [](RandomNumbers& r) {
    return System{[](const Parameters& p, double a, Complex s) {
                    const Complex x = power(p[1] * s, a);
                    return p[0] + 1.0 / (x * x * tanh_over(x)) + p[2] * lag(p[3], s);
                  },
                  "R T R1 T1",
                  {r.log_uniform(0.05, 0.5), 3, r.uniform(0.3, 1), r.log_uniform(0.02, 0.2)},
                  0.5};
  }));
  all.push_back(fractional("resistance-coil-and-constant-phase", [](RandomNumbers& r) {
    return System{[](const Parameters& p, double a, Complex s) { return p[0] + p[1] * s + 1.0 / power(s, a); },
                  "R L",
                  {r.log_uniform(0.1, 2), r.log_uniform(0.01, 0.3)},
                  r.uniform(0.4, 0.9)};
  }));
  all.push_back(nameless("randles-with-constant-phase", [](RandomNumbers& r) {
    return System{[](const Parameters& p, double a, Complex s) {
                    const Complex faradaic = p[1] + p[3] / std::sqrt(s);
                    return p[0] + 1.0 / (power(p[2] * s, a) + 1.0 / faradaic);
                  },
                  "R0 R1 Q A",
                  {r.log_uniform(0.05, 0.5), 1, r.log_uniform(0.05, 0.5), r.log_uniform(0.05, 0.5)},
                  r.uniform(0.7, 0.95)};
  }));
  all.push_back(nameless("fractional-controller", [](RandomNumbers& r) {
    return System{
        [](const Parameters& p, double a, Complex s) { return 1.0 + p[0] / power(s, a) + p[1] * power(s, p[2]); },
        "Ki Kd mu",
        {r.log_uniform(0.2, 3), r.log_uniform(0.1, 1), r.uniform(0.4, 0.9)},
        r.uniform(0.4, 0.9)};
  }));
  all.push_back(fractional("two-orders-oscillator", [](RandomNumbers& r) {
    return System{
        [](const Parameters& p, double a, Complex s) { return 1.0 / (power(s, p[0]) + p[1] * power(s, a) + 1.0); },
        "a2 b1",
        {r.uniform(1.4, 2.3), r.log_uniform(0.1, 1.5)},
        r.uniform(0.5, 0.95)};
  }));
  all.push_back(fractional("mass-with-fractional-damper", [](RandomNumbers& r) {
    return System{[](const Parameters& p, double a, Complex s) { return 1.0 / (s * s + p[0] * power(s, a) + 1.0); },
                  "c",
                  {r.log_uniform(0.1, 1)},
                  r.uniform(0.3, 0.75)};
  }));
  all.push_back(nameless("sum-of-foreign-powers", [](RandomNumbers& r) {
    return System{[](const Parameters& p, double a, Complex s) {
                    return power(s, a) + p[0] * std::pow(s, -p[1]) + p[2] * std::pow(s, p[3]);
                  },
                  "A2 a2 A3 a3",
                  {r.log_uniform(0.3, 3), r.uniform(0.25, 0.75), r.log_uniform(0.05, 0.3), r.uniform(1.15, 1.4)},
                  r.uniform(0.15, 0.45)};
  }));
  all.push_back(nameless("fractional-lead", [](RandomNumbers& r) {
    return System{[](const Parameters& p, double a, Complex s) {
                    return (1.0 + power(p[0] * s, a)) / (1.0 + power(p[1] * s, p[2]));
                  },
                  "T1 T2 a2",
                  {r.log_uniform(3, 10), r.log_uniform(0.1, 0.3), r.uniform(0.5, 0.9)},
                  r.uniform(0.5, 0.9)};
  }));
  all.push_back(nameless("lead-to-a-power", [](RandomNumbers& r) {
    return System{[](const Parameters& p, double a, Complex s) { return std::pow((1.0 + p[0] * s) * lag(p[1], s), a); },
                  "T1 T2",
                  {r.log_uniform(4, 20), r.log_uniform(0.05, 0.25)},
                  r.uniform(0.35, 0.7)};
  }));
  all.push_back(nameless("gerischer-with-resistance", [](RandomNumbers& r) {
    return System{[](const Parameters& p, double a, Complex s) { return p[1] + std::pow(1.0 + p[0] * s, -a); },
                  "T R",
                  {1, r.log_uniform(0.03, 0.5)},
                  0.5};
  }));
  all.push_back(nameless("half-space-diffusion", [](RandomNumbers&) {
    return System{
        [](const Parameters& p, double a, Complex s) { return std::exp(-power(p[0] * s, a)); }, "T", {1}, 0.5};
  }));
  all.push_back(nameless("heated-rod", [](RandomNumbers& r) {
    return System{[](const Parameters& p, double a, Complex s) {
                    const Complex x = power(p[0] * s, a);
                    const Complex e = std::exp(-x);
                    return 2.0 * e * lag(p[1], s) / (1.0 + e * e);
                  },
                  "T Tsensor",
                  {3, r.log_uniform(0.02, 0.3)},
                  0.5};
  }));
  all.push_back(nameless("distributed-order", [](RandomNumbers&) {
    // 1/(the integral of s^a over a from 0 to 1): every order between 0 and 1 at once.
    System system{[](const Parameters& p, double, Complex s) {
                    const Complex x = p[0] * s;
                    return std::abs(x - 1.0) < 1e-9 ? Complex(1) : std::log(x) / (x - 1.0);
                  },
                  "T",
                  {1}};
    system.has_order = false;
    return system;
  }));
  all.push_back(nameless("coil-with-eddy-currents", [](RandomNumbers& r) {
    // A loudspeaker: resistance, an inductance of order .5 to .8 and the mechanical resonance in parallel form.
    return System{[](const Parameters& p, double a, Complex s) {
                    return p[0] + p[1] * power(s, a) + p[2] * s / mode(p[3], p[4], 1, s);
                  },
                  "R L c w zeta",
                  {1, r.log_uniform(0.1, 1), r.log_uniform(0.5, 5), r.uniform(0.3, 0.7), r.log_uniform(0.05, 0.4)},
                  r.uniform(0.5, 0.8)};
  }));
  all.push_back(nameless("product-of-fractional-lags", [](RandomNumbers& r) {
    return System{[](const Parameters& p, double a, Complex s) {
                    return 1.0 / ((1.0 + power(p[0] * s, a)) * (1.0 + power(p[1] * s, p[2])));
                  },
                  "T1 T2 a2",
                  {r.log_uniform(1.5, 5), r.log_uniform(0.1, 0.7), r.uniform(0.6, 0.95)},
                  r.uniform(0.6, 0.9)};
  }));
  all.push_back(nameless("closed-loop-of-fractional-plant", [](RandomNumbers& r) {
    return System{[](const Parameters& p, double a, Complex s) {
                    const Complex plant = p[0] / (s * (1.0 + power(p[1] * s, a)));
                    return plant / (1.0 + plant);
                  },
                  "K T",
                  {r.log_uniform(0.5, 2), r.log_uniform(0.5, 2)},
                  r.uniform(0.5, 0.85)};
  }));
  all.push_back(fractional("fractional-solid", [](RandomNumbers& r) {
    return System{[](const Parameters& p, double a, Complex s) {
                    const Complex x = power(p[1] * s, a);
                    return p[0] + x / (1.0 + x);
                  },
                  "E0 T",
                  {r.log_uniform(0.02, 0.5), 1},
                  r.uniform(0.4, 0.8)};
  }));
}

}  // namespace

const std::vector<Kind>& kinds() {
  static const std::vector<Kind> all = [] {
    std::vector<Kind> result;
    add_integer_kinds(result);
    add_fractional_kinds(result);
    return result;
  }();
  return all;
}

}  // namespace judging
