// SPDX-License-Identifier: BSD-3-Clause
// Functional mock-up units, run by a small master of our own: libraries are loaded as a simulator does, and results are
// held against the library's own classes and against closed forms.
#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <cstdarg>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <random>
#include <regex>
#include <set>
#include <string>
#include <vector>

#include "backlash/two_mass_plant.hpp"
#include "fmu_unit.hpp"
#include "frac/digital/digital_filter.hpp"
#include "frac/digital/fractional_pid.hpp"
#include "frac/state_space.hpp"
#include "run_program.hpp"
#include "support/fmi2_callbacks.hpp"

namespace {

// The interface as its standard words it, apart from the header that units carry.
using Component = void*;
using Callbacks = support::Fmi2Callbacks;
constexpr int ok = 0, error = 3;
constexpr int model_exchange = 0, co_simulation = 1;

std::string last_message;
void log(void*, const char*, int, const char*, const char* format, ...) {
  va_list arguments;
  va_start(arguments, format);
  char text[400];
  std::vsnprintf(text, sizeof text, format, arguments);
  va_end(arguments);
  last_message = text;
}

class Instance {
 public:
  Instance(const Unit& unit, int type = co_simulation) : unit_(&unit) {
    static const Callbacks callbacks{log, std::calloc, std::free, nullptr, nullptr};
    using Instantiate = Component (*)(const char*, int, const char*, const char*, const Callbacks*, int, int);
    component_ = reinterpret_cast<Instantiate>(unit.symbol("fmi2Instantiate"))("name", type, unit.token().c_str(), "",
                                                                               &callbacks, 0, 0);
    if (component_ == nullptr) throw std::runtime_error(last_message);
  }
  Instance(const Instance&) = delete;
  Instance& operator=(const Instance&) = delete;
  ~Instance() { unit_->call("fmi2FreeInstance", component_); }

  void initialise(double start = 0) const {
    EXPECT_EQ(unit_->call("fmi2SetupExperiment", component_, 0, 0.0, start, 0, 0.0), ok);
    EXPECT_EQ(unit_->call("fmi2EnterInitializationMode", component_), ok);
    EXPECT_EQ(unit_->call("fmi2ExitInitializationMode", component_), ok) << last_message;
  }
  int set(const std::string& name, double value) const {
    const Reference which = (*unit_)[name];
    return unit_->call("fmi2SetReal", component_, &which, std::size_t{1}, static_cast<const double*>(&value));
  }
  [[nodiscard]] double get(const std::string& name) const { return get((*unit_)[name]); }
  [[nodiscard]] double get(Reference which) const {
    double value = NAN;
    EXPECT_EQ(unit_->call("fmi2GetReal", component_, &which, std::size_t{1}, &value), ok) << last_message;
    return value;
  }
  int step(double time, double duration) const { return unit_->call("fmi2DoStep", component_, time, duration, 1); }
  [[nodiscard]] Component component() const { return component_; }
  void reset() const { EXPECT_EQ(unit_->call("fmi2Reset", component_), ok); }

 private:
  const Unit* unit_;
  Component component_;
};

/// Bits of a unit, which is compiled by itself, and of the library.
#define REQUIRE_EQUAL_ROUNDING() \
  if (FRACFIT_FUSED) GTEST_SKIP() << "products are fused into sums, in each program by its own inlining"

bool same_bits(double a, double b) {
  return std::memcmp(&a, &b, sizeof a) == 0;
}

const std::vector<std::string> pid_options{"--kp",
                                           "2",
                                           "--ki",
                                           "3",
                                           "--kd",
                                           "0.02",
                                           "--lambda",
                                           "0.8",
                                           "--mu",
                                           "0.6",
                                           "--sample-time",
                                           "1e-3",
                                           "--band",
                                           "0.1:300",
                                           "--min",
                                           "-3",
                                           "--max",
                                           "2.5",
                                           "--tracking-time",
                                           "0.5",
                                           "--setpoint-weight",
                                           "0.7"};

frac::FractionalPidConfig pid_config() {
  frac::FractionalPidConfig config;
  config.gains = {.kp = 2, .ki = 3, .kd = 0.02, .lambda = 0.8, .mu = 0.6};
  config.sample_time = 1e-3;
  config.band = {0.1, 300};
  config.minimum = -3;
  config.maximum = 2.5;
  config.tracking_time = 0.5;
  config.setpoint_weight = 0.7;
  return config;
}

std::vector<std::string> with(std::vector<std::string> arguments, const std::vector<std::string>& more) {
  arguments.insert(arguments.end(), more.begin(), more.end());
  return arguments;
}

template <typename Real>
void expect_bits_of_pid(const Unit& unit, const Instance& instance, const frac::FractionalPidConfig& config) {
  frac::FractionalPid<Real> pid{frac::FractionalPidDesign(config)};
  std::mt19937 random(5);
  std::uniform_real_distribution<double> noise(-0.5, 0.5);
  const Reference at[] = {unit["setpoint"], unit["measured"]};
  const Reference output = unit["output"], saturated = unit["saturated"];
  int cut = 0;
  for (int n = 0; n < 5000; ++n) {
    const double inputs[] = {n / 1000 % 3 * 1.0, 0.8 + noise(random)};
    ASSERT_EQ(unit.call("fmi2SetReal", instance.component(), &at[0], std::size_t{2}, &inputs[0]), ok);
    ASSERT_EQ(instance.step(n * 1e-3, 1e-3), ok);
    const Real expected = pid.step(static_cast<Real>(inputs[0]), static_cast<Real>(inputs[1]));
    ASSERT_TRUE(same_bits(instance.get(output), static_cast<double>(expected))) << n;
    int is_saturated = -1;
    ASSERT_EQ(unit.call("fmi2GetBoolean", instance.component(), &saturated, std::size_t{1}, &is_saturated), ok);
    ASSERT_EQ(is_saturated, pid.saturated());
    cut += is_saturated;
  }
  EXPECT_GT(cut, 100) << "the limits were met";
}

TEST_F(FmuTest, ControllersGiveTheBitsOfTheLibraryInBothPrecisions) {
  REQUIRE_EQUAL_ROUNDING();
  const Unit of_double(pid_options);
  const Instance first(of_double);
  first.initialise();
  expect_bits_of_pid<double>(of_double, first, pid_config());
  // The same unit with other parameters is the controller designed with them.
  const Instance other(of_double);
  frac::FractionalPidConfig config = pid_config();
  config.gains.kp = 1.25;
  config.gains.ki = 2;
  config.gains.kd = 0.03;
  config.minimum = -1;
  config.maximum = 4;
  config.setpoint_weight = 1;
  config.derivative_setpoint_weight = 0;
  EXPECT_EQ(other.set("kp", 1.25), ok);
  EXPECT_EQ(other.set("ki", 2), ok);
  EXPECT_EQ(other.set("kd", 0.03), ok);
  EXPECT_EQ(other.set("minimum", -1), ok);
  EXPECT_EQ(other.set("maximum", 4), ok);
  EXPECT_EQ(other.set("setpoint_weight", 1), ok);
  EXPECT_EQ(other.set("derivative_setpoint_weight", 0), ok);
  other.initialise();
  expect_bits_of_pid<double>(of_double, other, config);
  const Unit of_float(with(pid_options, {"--precision", "float"}));
  const Instance third(of_float);
  third.initialise();
  expect_bits_of_pid<float>(of_float, third, pid_config());
}

TEST_F(FmuTest, GainsChangeWhileItRuns) {
  const Unit unit(pid_options);
  const Instance a(unit), b(unit);
  a.initialise();
  b.initialise();
  for (int n = 0; n < 50; ++n) {
    for (const Instance* each : {&a, &b}) {
      each->set("setpoint", 0.5);
      each->set("measured", 0.01 * n);
      each->step(n * 1e-3, 1e-3);
    }
  }
  EXPECT_EQ(b.set("kp", 2.5), ok);
  EXPECT_TRUE(same_bits(a.get("output"), b.get("output"))) << "counts from the next sample on";
  a.step(0.05, 1e-3);
  b.step(0.05, 1e-3);
  // 0.5 more gain on 0.7 setpoint - measured; sums of numbers below 4 round by 1e-15.
  EXPECT_NEAR(b.get("output") - a.get("output"), 0.5 * (0.7 * 0.5 - 0.49), 1e-14);
}

TEST_F(FmuTest, SamplesAreTakenAtTheirTimesWhateverTheSteps) {
  const Unit unit(pid_options);
  const Instance fine(unit), coarse(unit);
  fine.initialise(2);
  coarse.initialise(2);
  for (const Instance* each : {&fine, &coarse}) {
    each->set("setpoint", 1);
    each->set("measured", 0.2);
  }
  // Quarters of a sample time, and 7 samples at once.
  for (int n = 0; n < 28 * 4; ++n) ASSERT_EQ(fine.step(2 + n * 0.25e-3, 0.25e-3), ok);
  for (int n = 0; n < 4; ++n) ASSERT_EQ(coarse.step(2 + n * 7e-3, 7e-3), ok);
  EXPECT_TRUE(same_bits(fine.get("output"), coarse.get("output")));
  frac::FractionalPid<double> pid{frac::FractionalPidDesign(pid_config())};
  double expected = 0;
  for (int n = 0; n < 28; ++n) expected = pid.step(1, 0.2);
  EXPECT_TRUE(same_bits(fine.get("output"), expected));
}

TEST_F(FmuTest, FiltersGiveTheBitsOfTheLibrary) {
  REQUIRE_EQUAL_ROUNDING();
  const std::string formula = "exp(-0.05 s)/(0.8 s^2.2 + 0.5 s^0.9 + 1)";
  const Unit unit({"--model", formula, "--sample-time", "0.01", "--band", "0.01:100"});
  const auto choice =
      frac::model_filter(frac::FractionalTransferFunction::parse(formula), frac::FrequencyBand{0.01, 100}, 0.01, 1e-3);
  frac::DigitalFilter<double> filter(choice.design);
  const Instance instance(unit);
  instance.initialise();
  std::mt19937 random(6);
  std::uniform_real_distribution<double> draw(-1, 1);
  for (int n = 0; n < 3000; ++n) {
    const double input = draw(random);
    instance.set("input", input);
    ASSERT_EQ(instance.step(n * 0.01, 0.01), ok);
    ASSERT_TRUE(same_bits(instance.get("output"), filter.step(input))) << n;
  }
}

// Step response of a rational model by its residues.
double step_response(const frac::RationalModel& model, double time) {
  double y = model.direct;
  for (const frac::Mode& mode : model.modes) {
    const std::complex<double> part = mode.residues.front() * (std::exp(mode.pole * time) - 1.0) / mode.pole;
    y += (mode.pole.imag() == 0 ? 1 : 2) * part.real();
  }
  return y;
}

TEST_F(FmuTest, PlantsFollowTheirStateSpaceExactlyForStepsOfAnyLength) {
  const std::string formula = "1/(0.8 s^2.2 + 0.5 s^0.9 + 1)";
  const Unit unit({"--model", formula, "--band", "0.01:100"});
  const auto model = frac::realise(frac::FractionalTransferFunction::parse(formula), {0.01, 100}, 1e-3);
  EXPECT_NE(unit.description().find("largest relative error 0.000"), std::string::npos) << unit.description();
  const Instance instance(unit);
  instance.set("input", 1);
  instance.initialise();
  EXPECT_NEAR(instance.get("output"), model.direct, 1e-15);
  double time = 0;
  for (const double duration : {1e-6, 1e-3, 0.1, 0.1, 0.7, 1e-4, 5.0, 40.0, 1e3, 0.5}) {
    ASSERT_EQ(instance.step(time, duration), ok);
    time += duration;
    // Rounding of the exponential of a matrix of norm 10^7 at most, squared 24 times: each squaring doubles 1e-16.
    EXPECT_NEAR(instance.get("output"), step_response(model, time), 1e-9) << time;
  }
}

TEST_F(FmuTest, PlantsGiveTheirDerivativesForModelExchange) {
  REQUIRE_EQUAL_ROUNDING();
  const std::string formula = "1/(0.8 s^2.2 + 0.5 s^0.9 + 1)";
  const Unit unit({"--model", formula, "--band", "0.01:100"});
  const auto space =
      frac::modal_form(frac::realise(frac::FractionalTransferFunction::parse(formula), {0.01, 100}, 1e-3));
  const Instance instance(unit, model_exchange);
  instance.initialise();
  const std::size_t n = space.states;
  std::vector<double> x(n), rate(n), back(n);
  std::mt19937 random(7);
  std::uniform_real_distribution<double> draw(-1, 1);
  for (double& each : x) each = draw(random);
  instance.set("input", 0.6);
  ASSERT_EQ(unit.call("fmi2SetContinuousStates", instance.component(), static_cast<const double*>(x.data()), n), ok);
  ASSERT_EQ(unit.call("fmi2GetDerivatives", instance.component(), rate.data(), n), ok);
  ASSERT_EQ(unit.call("fmi2GetContinuousStates", instance.component(), back.data(), n), ok);
  EXPECT_EQ(back, x);
  double y = space.d * 0.6;
  for (std::size_t i = 0; i < n; ++i) {
    double expected = space.b[i] * 0.6, size = std::abs(expected);
    for (std::size_t j = 0; j < n; ++j) {
      expected += space.a[i * n + j] * x[j];
      size += std::abs(space.a[i * n + j] * x[j]);
    }
    EXPECT_NEAR(rate[i], expected, 1e-14 * size);
    EXPECT_EQ(instance.get(unit["der\\(x\\[" + std::to_string(i + 1) + "\\]\\)"]), rate[i]);
    EXPECT_EQ(instance.get(unit["x\\[" + std::to_string(i + 1) + "\\]"]), x[i]);
    y += space.c[i] * x[i];
  }
  EXPECT_NEAR(instance.get("output"), y, 1e-12);
  EXPECT_EQ(instance.step(0, 1), error) << "co-simulation is another type";
}

TEST_F(FmuTest, TwoMassesGiveTheBitsOfTheLibrary) {
  REQUIRE_EQUAL_ROUNDING();
  const Unit unit({"--clearance", "0.01", "--restitution", "0.6", "--mass1", "2"});
  std::mt19937 random(8);
  std::uniform_real_distribution<double> force(-20, 20), duration(1e-4, 0.2);
  std::uint64_t impacts = 0;
  for (const double restitution : {0.6, 0.0, 1.0, 0.95}) {
    for (const double clearance : {0.01, 0.0}) {
      const Instance instance(unit);
      EXPECT_EQ(instance.set("restitution", restitution), ok);
      EXPECT_EQ(instance.set("clearance", clearance), ok);
      EXPECT_EQ(instance.set("mass2", 1.5), ok);
      EXPECT_EQ(instance.set("start_position2", clearance / 4), ok);
      EXPECT_EQ(instance.set("start_velocity1", 0.3), ok);
      instance.initialise();
      backlash::TwoMassPlant plant({2, 1.5, clearance, restitution}, {0, 0.3, clearance / 4, 0});
      double time = 0;
      for (int n = 0; n < 400; ++n) {
        const double f = n % 3 == 0 ? 5 : force(random), h = duration(random);
        instance.set("force", f);
        ASSERT_EQ(instance.step(time, h), ok) << last_message;
        plant.advance(f, h);
        time += h;
        const backlash::TwoMassState state = plant.state();
        ASSERT_TRUE(same_bits(instance.get("position1"), state.position1)) << n;
        ASSERT_TRUE(same_bits(instance.get("velocity1"), state.velocity1)) << n;
        ASSERT_TRUE(same_bits(instance.get("position2"), state.position2)) << n;
        ASSERT_TRUE(same_bits(instance.get("velocity2"), state.velocity2)) << n;
        ASSERT_TRUE(same_bits(instance.get("gap"), plant.gap())) << n;
        ASSERT_TRUE(same_bits(instance.get("energy_loss"), plant.energy_loss())) << n;
        ASSERT_EQ(instance.get("impacts"), static_cast<double>(plant.impacts())) << n;
      }
      impacts += plant.impacts();
    }
  }
  EXPECT_GT(impacts, 1000U);
}

// Roots are the count of a step's work: two at most of each flight between walls.  A flight from wall to wall takes at
// least clearance/v at the largest speed v = sqrt(rate^2 + 2 |acceleration| clearance), which impacts can only lessen;
// flights back to the wall they left are summed in closed form, once in a step.  So there are at most 3 flights more
// than v duration/clearance, whatever the number of impacts.
TEST_F(FmuTest, WorkOfAStepOfTwoMassesIsBoundedWhateverTheImpacts) {
  const double clearance = 0.01, mass2 = 1.5;
  const Unit unit({"--clearance", "0.01", "--restitution", "0.6", "--mass1", "2", "--mass2", "1.5"},
                  R"(cat >counting.h <<end
#include <math.h>
double counted_sqrt(double x);
double counted_pow(double x, double y);
#define sqrt counted_sqrt
#define pow counted_pow
end
cat >counts.c <<end
#include <math.h>
long roots, powers;
double counted_sqrt(double x) { ++roots; return sqrt(x); }
double counted_pow(double x, double y) { ++powers; return pow(x, y); }
end
cc -fPIC -c counts.c &&
cc -w -shared -fPIC -include counting.h sources/unit.c counts.o -o binaries/linux64/unit.so -lm)");
  long& roots = *static_cast<long*>(unit.symbol("roots"));
  long& powers = *static_cast<long*>(unit.symbol("powers"));
  std::mt19937 random(12);
  std::uniform_real_distribution<double> exponent(-3, 3), share(0, 1);
  double most_impacts = 0, nearest = 0;
  for (const double restitution : {0.0, 0.5, 0.9, 0.999, 1.0}) {
    const Instance instance(unit);
    EXPECT_EQ(instance.set("restitution", restitution), ok);
    EXPECT_EQ(instance.set("start_position2", 0.3 * clearance), ok);
    EXPECT_EQ(instance.set("start_velocity2", 0.4), ok);
    instance.initialise();
    for (int n = 0; n < 400; ++n) {
      const double force = (share(random) < 0.5 ? -1 : 1) * (n % 5 == 0 ? 0 : std::pow(10, exponent(random)));
      const double duration = std::pow(10, exponent(random) - 2);
      const double rate = instance.get("velocity2") - instance.get("velocity1");
      const double before = instance.get("impacts");
      const double crossings = std::sqrt(rate * rate + 2 * std::abs(force) / mass2 * clearance) * duration / clearance;
      instance.set("force", force);
      roots = powers = 0;
      ASSERT_EQ(instance.step(0, duration), ok) << last_message;
      // The first root is that of the largest speed; crossings round by 1e-9 of their number.
      ASSERT_LE(static_cast<double>(roots), 1 + 2 * ((1 + 1e-9) * crossings + 3))
          << n << " " << force << " " << duration;
      ASSERT_LE(powers, 1);
      most_impacts = std::max(most_impacts, (instance.get("impacts") - before) / (crossings + 3));
      nearest = std::max(nearest, static_cast<double>(roots) / (1 + 2 * (crossings + 3)));
    }
  }
  EXPECT_GT(most_impacts, 3) << "impacts are not what a step costs";
  EXPECT_GT(nearest, 0.4) << "the bound is near";
}

// A master that integrates the states exactly, as accelerations are constant under a constant force, and finds each
// event by bisection of a step.
class ExchangeMaster {
 public:
  explicit ExchangeMaster(const Unit& unit) : unit_(&unit), instance_(unit, model_exchange) {}
  [[nodiscard]] const Instance& instance() const { return instance_; }
  [[nodiscard]] int events() const { return events_; }

  void start() {
    instance_.initialise();
    handle_event();
  }

  void advance(double duration) {
    for (double left = duration; left > 0;) {
      const double step = std::min(left, 1e-3);
      const Numbers from = states(), before = indicators();
      move(from, step);
      if (!changed(before, indicators())) {
        left -= step;
        continue;
      }
      double low = 0, high = step;
      for (double middle = step / 2; middle > low && middle < high; middle = (low + high) / 2) {
        move(from, middle);
        (changed(before, indicators()) ? high : low) = middle;
      }
      move(from, high);
      handle_event();
      left -= high;
    }
  }

  // After an input has changed.
  void handle_event() {
    EventInfo info{};
    ASSERT_EQ(unit_->call("fmi2EnterEventMode", instance_.component()), ok);
    ASSERT_EQ(unit_->call("fmi2NewDiscreteStates", instance_.component(), &info), ok);
    ASSERT_EQ(unit_->call("fmi2EnterContinuousTimeMode", instance_.component()), ok);
    EXPECT_EQ(info.new_discrete_states_needed, 0);
    events_ += info.values_changed;
  }

 private:
  using Numbers = std::vector<double>;
  struct EventInfo {
    int new_discrete_states_needed, terminate, nominals_changed, values_changed, next_time_defined;
    double next_time;
  };
  Numbers ask(const char* function, std::size_t count) const {
    Numbers numbers(count);
    EXPECT_EQ(unit_->call(function, instance_.component(), numbers.data(), count), ok) << last_message;
    return numbers;
  }
  [[nodiscard]] Numbers states() const { return ask("fmi2GetContinuousStates", 4); }
  [[nodiscard]] Numbers indicators() const { return ask("fmi2GetEventIndicators", 3); }
  static bool changed(const Numbers& before, const Numbers& after) {
    for (std::size_t i = 0; i < before.size(); ++i)
      if ((before[i] > 0) != (after[i] > 0)) return true;
    return false;
  }
  void set(const Numbers& x) const {
    EXPECT_EQ(unit_->call("fmi2SetContinuousStates", instance_.component(), x.data(), x.size()), ok);
  }
  // Heun's rule, exact for parabolas.
  void move(const Numbers& from, double duration) const {
    set(from);
    const Numbers first = ask("fmi2GetDerivatives", 4);
    Numbers x = from;
    for (std::size_t i = 0; i < x.size(); ++i) x[i] += duration * first[i];
    set(x);
    const Numbers second = ask("fmi2GetDerivatives", 4);
    for (std::size_t i = 0; i < x.size(); ++i) x[i] = from[i] + duration / 2 * (first[i] + second[i]);
    set(x);
  }

  const Unit* unit_;
  Instance instance_;
  int events_ = 0;
};

// A simulator that meets the impacts by the indicators gets the motion of the library: flights are integrated exactly,
// impacts found to rounding, and errors shrink at each by the restitution.  Contact begins where hops fall below 1e-9
// of the clearance, which is the largest error.
TEST_F(FmuTest, TwoMassesInModelExchangeFollowTheLibrary) {
  const double clearance = 0.01;
  const Unit unit({"--clearance", "0.01", "--restitution", "0.6", "--mass1", "2", "--mass2", "1.5"});
  ExchangeMaster master(unit);
  backlash::TwoMassPlant plant({2, 1.5, clearance, 0.6}, {0, 0.3, clearance / 4, 0});
  EXPECT_EQ(master.instance().set("start_position2", clearance / 4), ok);
  EXPECT_EQ(master.instance().set("start_velocity1", 0.3), ok);
  master.start();
  std::mt19937 random(11);
  std::uniform_real_distribution<double> size(2, 20), duration(0.02, 0.4);
  int contacts = 0;
  for (int n = 0; n < 60; ++n) {
    const double force = (random() % 2 == 0 ? 1 : -1) * size(random), h = duration(random);
    EXPECT_EQ(master.instance().set("force", force), ok);
    master.handle_event();
    master.advance(h);
    plant.advance(force, h);
    const backlash::TwoMassState state = plant.state();
    const double scale = std::abs(state.position1) + clearance;
    ASSERT_NEAR(master.instance().get("gap"), plant.gap(), 1e-8 * clearance) << n;
    ASSERT_NEAR(master.instance().get("position1"), state.position1, 1e-8 * clearance + 1e-13 * scale) << n;
    ASSERT_NEAR(master.instance().get("velocity2"), state.velocity2, 1e-4) << n;
    ASSERT_NEAR(master.instance().get("energy_loss"), plant.energy_loss(), 1e-7 * plant.energy_loss()) << n;
    contacts += plant.in_contact() ? 1 : 0;
  }
  EXPECT_GT(contacts, 10);
  EXPECT_GT(master.events(), 300);
}

TEST_F(FmuTest, StatesAreKeptSetAgainAndSerialised) {
  const Unit unit({"--clearance", "0.01", "--restitution", "0.6"});
  const Instance a(unit), b(unit);
  // Two instances at once, with inputs of their own.
  a.initialise();
  b.initialise();
  const auto run = [](const Instance& each, double sign, int from, int to) {
    std::vector<double> positions;
    for (int n = from; n < to; ++n) {
      each.set("force", sign * std::sin(0.3 * n));
      each.step(n * 0.05, 0.05);
      positions.push_back(each.get("position2"));
    }
    return positions;
  };
  (void)run(a, 1, 0, 100);
  void* kept = nullptr;
  ASSERT_EQ(unit.call("fmi2GetFMUstate", a.component(), &kept), ok);
  (void)run(b, -2, 0, 70);
  const auto expected = run(a, 1, 100, 200);
  ASSERT_EQ(unit.call("fmi2SetFMUstate", a.component(), kept), ok);
  EXPECT_EQ(run(a, 1, 100, 200), expected);
  // The bytes make another instance the same.
  std::size_t size = 0;
  ASSERT_EQ(unit.call("fmi2SerializedFMUstateSize", a.component(), kept, &size), ok);
  std::vector<char> bytes(size);
  ASSERT_EQ(unit.call("fmi2SerializeFMUstate", a.component(), kept, bytes.data(), size), ok);
  void* read = nullptr;
  ASSERT_EQ(unit.call("fmi2DeSerializeFMUstate", b.component(), static_cast<const char*>(bytes.data()), size, &read),
            ok);
  ASSERT_EQ(unit.call("fmi2SetFMUstate", b.component(), read), ok);
  EXPECT_EQ(run(b, 1, 100, 200), expected);
  EXPECT_EQ(
      unit.call("fmi2DeSerializeFMUstate", b.component(), static_cast<const char*>(bytes.data()), size - 1, &read),
      error);
  for (void** each : {&kept, &read}) {
    EXPECT_EQ(unit.call("fmi2FreeFMUstate", a.component(), each), ok);
    EXPECT_EQ(*each, nullptr);
  }
  // After a reset it is as new.
  a.reset();
  a.initialise();
  const Instance fresh(unit);
  fresh.initialise();
  EXPECT_EQ(run(a, 1, 0, 50), run(fresh, 1, 0, 50));
}

TEST_F(FmuTest, RefusalsNameWhatIsWrong) {
  EXPECT_THROW(Instance(Unit(pid_options), model_exchange), std::runtime_error);
  EXPECT_EQ(last_message, "this model is for co-simulation only");
  const Unit unit({"--clearance", "0.01", "--restitution", "0.6"});
  static const Callbacks callbacks{log, std::calloc, std::free, nullptr, nullptr};
  using Instantiate = Component (*)(const char*, int, const char*, const char*, const Callbacks*, int, int);
  EXPECT_EQ(reinterpret_cast<Instantiate>(unit.symbol("fmi2Instantiate"))("name", co_simulation, "another", "",
                                                                          &callbacks, 0, 0),
            nullptr);
  EXPECT_EQ(last_message, "the guid is not that of modelDescription.xml");
  const Instance instance(unit);
  EXPECT_EQ(instance.step(0, 1), error);
  EXPECT_EQ(instance.set("restitution", 1.5), ok);
  EXPECT_EQ(unit.call("fmi2SetupExperiment", instance.component(), 0, 0.0, 0.0, 0, 0.0), ok);
  EXPECT_EQ(unit.call("fmi2EnterInitializationMode", instance.component()), ok);
  EXPECT_EQ(unit.call("fmi2ExitInitializationMode", instance.component()), error);
  EXPECT_EQ(last_message, "restitution must be in [0, 1]");
  EXPECT_EQ(instance.set("restitution", 0.5), ok);
  EXPECT_EQ(unit.call("fmi2ExitInitializationMode", instance.component()), ok);
  EXPECT_EQ(instance.set("restitution", 0.6), error);
  EXPECT_NE(last_message.find("fixed once the simulation runs"), std::string::npos);
  EXPECT_EQ(instance.set("gap", 0), error);
  EXPECT_EQ(instance.set("force", NAN), error);
  EXPECT_EQ(instance.step(0, -1), error);
  for (const double endless : {HUGE_VAL, double(NAN)}) {
    EXPECT_EQ(instance.step(0, endless), error);
    EXPECT_EQ(instance.step(endless, 1), error);
  }
  EXPECT_EQ(instance.set("force", 1e30), ok);
  EXPECT_EQ(instance.step(0, 1), error);
  EXPECT_NE(last_message.find("1e7 times"), std::string::npos);
  const Unit sampled(pid_options);
  const Instance controller(sampled);
  controller.initialise();
  EXPECT_EQ(controller.step(0, 2e6), error) << "2e9 samples";
  EXPECT_NE(last_message.find("1e9 samples"), std::string::npos) << last_message;
}

// What the schema of FMI 2.0 and its text ask of modelDescription.xml.
void expect_valid(const Unit& unit, bool has_states) {
  const std::string& xml = unit.description();
  if (std::system("xmllint --version >/dev/null 2>&1") == 0) {
    const auto validated =
        run_shell("xmllint --noout --relaxng '" FMI2_DESCRIPTION "' '" + unit.path("modelDescription.xml") + "'");
    EXPECT_EQ(validated.code, 0) << validated.error;
  }
  // Elements in the order of the schema.
  std::size_t at = 0;
  for (const char* element :
       {"<fmiModelDescription fmiVersion=\"2.0\"", "<CoSimulation modelIdentifier=\"unit\"", "<LogCategories>",
        "<ModelVariables>", "<ModelStructure>", "<Outputs>", "<InitialUnknowns>", "</fmiModelDescription>"}) {
    const std::size_t place = xml.find(element, at);
    ASSERT_NE(place, std::string::npos) << element << "\n" << xml;
    at = place;
  }
  EXPECT_EQ(xml.find("<ModelExchange") != std::string::npos, has_states);
  EXPECT_EQ(xml.find("<Derivatives>") != std::string::npos, has_states);
  // States jump at events, and only there.
  EXPECT_EQ(xml.find("reinit=\"true\"") != std::string::npos,
            has_states && xml.find("numberOfEventIndicators=\"0\"") == std::string::npos);
  const auto variables = matches(xml, "(<ScalarVariable[^>]*>\\s*<[^>]*/>)");
  std::set<std::string> names, references;
  std::vector<std::string> outputs;
  for (std::size_t i = 0; i < variables.size(); ++i) {
    const std::string& variable = variables[i];
    SCOPED_TRACE(variable);
    EXPECT_TRUE(names.insert(matches(variable, " name=\"([^\"]*)\"").at(0)).second);
    const bool is_boolean = variable.find("<Boolean") != std::string::npos;
    EXPECT_TRUE(
        references.insert((is_boolean ? "b" : "r") + matches(variable, "valueReference=\"([0-9]+)\"").at(0)).second);
    const std::string causality = matches(variable, "causality=\"(\\w+)\"").at(0);
    const std::string variability = matches(variable, "variability=\"(\\w+)\"").at(0);
    const bool starts = variable.find(" start=\"") != std::string::npos;
    // Inputs and parameters start somewhere; what is calculated does not.
    EXPECT_EQ(starts, causality == "input" || causality == "parameter");
    EXPECT_EQ(causality == "parameter", variability == "fixed" || variability == "tunable");
    EXPECT_EQ(variable.find("initial=\"calculated\"") != std::string::npos,
              causality == "output" || causality == "local");
    if (causality == "output") outputs.push_back(std::to_string(i + 1));
    for (const std::string& name : matches(variable, " unit=\"([^\"]*)\""))
      EXPECT_NE(xml.find("<Unit name=\"" + name + "\"/>"), std::string::npos);
    for (const std::string& of : matches(variable, "derivative=\"([0-9]+)\""))
      EXPECT_NE(variables.at(std::stoul(of) - 1).find("name=\"x["), std::string::npos);
  }
  const std::string listed = xml.substr(xml.find("<Outputs>"), xml.find("</Outputs>") - xml.find("<Outputs>"));
  EXPECT_EQ(matches(listed, "index=\"([0-9]+)\""), outputs);
  // Sources are whole and clean.
  for (const std::string processor : {"", "-mavx512f "}) {
    const auto compiled = run_shell("cc " + processor +
                                    "-std=c99 -fsyntax-only -Wall -Wextra -Wpedantic -Werror -Wconversion "
                                    "-Wdouble-promotion -Wshadow '" +
                                    unit.path("sources/unit.c") + "'");
    EXPECT_EQ(compiled.code, 0) << compiled.error;
  }
  // Nothing but the interface is visible.
  const auto symbols = run_shell("nm -D --defined-only '" + unit.path("binaries/linux64/unit.so") + "'");
  for (const std::string& line : lines_of(symbols.output)) EXPECT_NE(line.find(" T fmi2"), std::string::npos) << line;
}

TEST_F(FmuTest, DescriptionsKeepTheRulesOfTheStandard) {
  expect_valid(Unit(pid_options), false);
  expect_valid(Unit({"--model", "1/(s^0.5 + 1)", "--sample-time", "0.01", "--precision", "float"}), false);
  expect_valid(Unit({"--model", "1/(s^1.5 + 1)", "--band", "0.01:100"}), true);
  expect_valid(Unit({"--clearance", "0.01", "--restitution", "0.6"}), true);
}

TEST_F(FmuTest, IsWrittenAlikeAgainAndWithoutACompilerAsSources) {
  const TemporaryFolder folder;
  const std::vector<std::string> command{"export", "fmu", "--clearance", "0.01", "--restitution", "0.6", "--out"};
  for (const char* name : {"a.fmu", "b.fmu"}) ASSERT_EQ(run_fracfit(with(command, {folder.path(name)})).code, 0);
  EXPECT_EQ(content_of(folder.path("a.fmu")), content_of(folder.path("b.fmu")));
  const auto bare = run_fracfit(with(command, {folder.path("c.fmu")}), {.search_path = folder.path("none")});
  EXPECT_EQ(bare.code, 0);
  EXPECT_NE(bare.error.find("the unit holds its sources only: the C compiler 'cc' cannot be run"), std::string::npos)
      << bare.error;
  const auto list = run_shell("unzip -l '" + folder.path("c.fmu") + "'");
  EXPECT_NE(list.output.find("sources/model.c"), std::string::npos) << list.output;
  EXPECT_EQ(list.output.find("binaries"), std::string::npos) << list.output;
}

TEST(ExportFmu, RefusesOptionsThatDoNotGoTogether) {
  const auto refusal = [](std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), {"export", "fmu"});
    arguments.insert(arguments.end(), {"--out", "/dev/null"});
    const auto result = run_fracfit(arguments);
    EXPECT_EQ(result.code, 2) << result.error;
    return result.error;
  };
  const std::string without_library =
      run_fracfit({"export", "fmu", "--kp", "1", "--sample-time", "1", "--out", "/dev/null"}).error;
  if (without_library.find("libzip") != std::string::npos) GTEST_SKIP() << "built without libzip";
  EXPECT_NE(refusal({"--kp", "1"}).find("--sample-time is required for a PID"), std::string::npos);
  EXPECT_NE(refusal({"--model", "1/(s+1)"}).find("--band is required"), std::string::npos);
  EXPECT_NE(refusal({"--clearance", "1"}).find("--clearance needs --restitution"), std::string::npos);
  EXPECT_NE(
      refusal({"--clearance", "1", "--restitution", "0.5", "--kp", "2"}).find("--kp has no meaning with --clearance"),
      std::string::npos);
  EXPECT_NE(refusal({"--model", "1/(s+1)", "--band", "1:10", "--poles", "3"}).find("--poles has no meaning"),
            std::string::npos);
  EXPECT_NE(refusal({"--model", "exp(-s)/(s+1)", "--band", "1:10"}).find("dead time of 1 s"), std::string::npos);
  EXPECT_NE(refusal({"--kp", "1", "--sample-time", "1", "--name", "int"}).find("C name \"int\""), std::string::npos);
}

}  // namespace
