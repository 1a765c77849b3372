// SPDX-License-Identifier: BSD-3-Clause
// Units of FMI 3.0 and units with a library for Windows, beside those of FMI 2.0 for Linux, whose numbers the other
// tests hold against the library and closed forms.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <fstream>
#include <random>
#include <set>
#include <sstream>

#include "backlash/two_mass_plant.hpp"
#include "fmu_unit.hpp"
#include "frac/state_space.hpp"

namespace {

using Options = std::vector<std::string>;
const Options pid{"--kp", "2", "--ki", "3", "--lambda", "0.8", "--sample-time", "1e-3", "--band", "0.1:300"};
const Options plant{"--model", "1/(0.8 s^2.2 + 0.5 s^0.9 + 1)", "--band", "0.01:100"};
const Options masses{"--clearance", "0.01", "--restitution", "0.6", "--mass1", "2", "--mass2", "1.5"};

Options with(Options options, const Options& more) {
  options.insert(options.end(), more.begin(), more.end());
  return options;
}

class FmuVersionsTest : public FmuTest {};

std::string last_message;
void log(void*, int, const char*, const char* message) {
  last_message = message;
}

constexpr int ok = 0, error = 3;

// An instance by the functions of FMI 3.0.
class Instance3 {
 public:
  explicit Instance3(const Unit& unit, bool exchanges = false) : unit_(&unit) {
    using Log = void (*)(void*, int, const char*, const char*);
    using Exchange = void* (*)(const char*, const char*, const char*, bool, bool, void*, Log);
    using CoSimulation = void* (*)(const char*, const char*, const char*, bool, bool, bool, bool, const Reference*,
                                   std::size_t, void*, Log, void*);
    const std::string token = unit.token();
    c_ = exchanges ? reinterpret_cast<Exchange>(unit.symbol("fmi3InstantiateModelExchange"))(
                         "name", token.c_str(), nullptr, false, true, nullptr, log)
                   : reinterpret_cast<CoSimulation>(unit.symbol("fmi3InstantiateCoSimulation"))(
                         "name", token.c_str(), nullptr, false, true, false, false, nullptr, 0, nullptr, log, nullptr);
    if (c_ == nullptr) throw std::runtime_error(last_message);
  }
  Instance3(const Instance3&) = delete;
  Instance3& operator=(const Instance3&) = delete;
  ~Instance3() { reinterpret_cast<void (*)(void*)>(unit_->symbol("fmi3FreeInstance"))(c_); }

  template <typename... Arguments>
  int call(const char* function, Arguments... arguments) const {
    return unit_->call(function, c_, arguments...);
  }
  void initialise(double start = 0) const {
    EXPECT_EQ(call("fmi3EnterInitializationMode", false, 0.0, start, false, 0.0), ok);
    EXPECT_EQ(call("fmi3ExitInitializationMode"), ok) << last_message;
  }
  int set(const std::string& name, double value) const {
    const Reference which = (*unit_)[name];
    return call("fmi3SetFloat64", &which, std::size_t{1}, static_cast<const double*>(&value), std::size_t{1});
  }
  // Values of a scalar or vector.
  [[nodiscard]] std::vector<double> get(const std::string& name, std::size_t size = 1) const {
    const Reference which = (*unit_)[name];
    std::vector<double> values(size, NAN);
    EXPECT_EQ(call("fmi3GetFloat64", &which, std::size_t{1}, values.data(), size), ok) << last_message;
    return values;
  }
  int step(double time, double duration) const {
    bool needs_event = true, is_ended = true, is_early = true;
    double reached = NAN;
    const int status = call("fmi3DoStep", time, duration, true, &needs_event, &is_ended, &is_early, &reached);
    EXPECT_FALSE(needs_event || is_ended || is_early);
    if (status == ok) {
      EXPECT_EQ(reached, time + duration);
    }
    return status;
  }
  // The states, rates or indicators of model exchange.
  [[nodiscard]] std::vector<double> ask(const char* function, std::size_t size) const {
    std::vector<double> values(size, NAN);
    EXPECT_EQ(call(function, values.data(), size), ok) << last_message;
    return values;
  }

 private:
  const Unit* unit_;
  void* c_ = nullptr;
};

// What the text of FMI 3.0 asks beyond the schema.
void expect_valid(const Unit& unit, bool has_states, bool has_events) {
  const std::string& xml = unit.description();
  if (has_tool("xmllint --version")) {
    const auto validated =
        run_shell("xmllint --noout --relaxng '" FMI3_DESCRIPTION "' '" + unit.path("modelDescription.xml") + "'");
    EXPECT_EQ(validated.code, 0) << validated.error;
  }
  const auto variables = matches(xml, "(<(?:Float64|Boolean) [^>]*>)");
  const auto all = matches(xml, "<(?:Float64|Boolean)[^>]* valueReference=\"([0-9]+)\"");
  EXPECT_EQ(std::set<std::string>(all.begin(), all.end()).size(), all.size()) << "references are of one variable each";
  std::vector<std::string> outputs, initial;
  for (const std::string& variable : variables) {
    const auto reference = matches(variable, "valueReference=\"([0-9]+)\"").front();
    const bool is_output = variable.find("causality=\"output\"") != std::string::npos;
    if (is_output) outputs.push_back(reference);
    // Outputs, states and their rates are all calculated at the start.
    if (is_output || variable.find("name=\"x\"") != std::string::npos ||
        variable.find("name=\"der(x)\"") != std::string::npos)
      initial.push_back(reference);
    for (const std::string& name : matches(variable, " unit=\"([^\"]*)\""))
      EXPECT_NE(xml.find("<Unit name=\"" + name + "\"/>"), std::string::npos);
  }
  EXPECT_EQ(matches(xml, "<Output valueReference=\"([0-9]+)\""), outputs);
  EXPECT_EQ(matches(xml, "<InitialUnknown valueReference=\"([0-9]+)\""), initial);
  EXPECT_EQ(xml.find("<ModelExchange") != std::string::npos, has_states);
  EXPECT_EQ(matches(xml, "<ContinuousStateDerivative valueReference=\"([0-9]+)\""),
            matches(xml, "name=\"der\\(x\\)\" valueReference=\"([0-9]+)\""));
  EXPECT_EQ(matches(xml, "derivative=\"([0-9]+)\""), matches(xml, "name=\"x\" valueReference=\"([0-9]+)\""));
  EXPECT_EQ(matches(xml, "<EventIndicator valueReference=\"([0-9]+)\"").size(), has_events ? 1U : 0U);
  EXPECT_NE(content_of(unit.path("sources/buildDescription.xml")).find("<SourceFile name=\"unit.c\"/>"),
            std::string::npos);
  for (const std::string flags : {"", "-mavx512f "}) {
    const auto compiled = run_shell("cc " + flags + "-std=c99 -fsyntax-only -Wall -Wextra -Wpedantic -Werror " +
                                    "-Wconversion -Wdouble-promotion -Wshadow '" + unit.path("sources/unit.c") + "'");
    EXPECT_EQ(compiled.code, 0) << compiled.error;
  }
}

// All functions of chapter 2.2 and of the three interfaces: those that a model does not provide are to be there too.
const std::vector<std::string> functions_of_3{"fmi3GetVersion",
                                              "fmi3SetDebugLogging",
                                              "fmi3InstantiateModelExchange",
                                              "fmi3InstantiateCoSimulation",
                                              "fmi3InstantiateScheduledExecution",
                                              "fmi3FreeInstance",
                                              "fmi3EnterInitializationMode",
                                              "fmi3ExitInitializationMode",
                                              "fmi3EnterEventMode",
                                              "fmi3Terminate",
                                              "fmi3Reset",
                                              "fmi3GetFloat32",
                                              "fmi3GetFloat64",
                                              "fmi3GetInt8",
                                              "fmi3GetUInt8",
                                              "fmi3GetInt16",
                                              "fmi3GetUInt16",
                                              "fmi3GetInt32",
                                              "fmi3GetUInt32",
                                              "fmi3GetInt64",
                                              "fmi3GetUInt64",
                                              "fmi3GetBoolean",
                                              "fmi3GetString",
                                              "fmi3GetBinary",
                                              "fmi3GetClock",
                                              "fmi3SetFloat32",
                                              "fmi3SetFloat64",
                                              "fmi3SetInt8",
                                              "fmi3SetUInt8",
                                              "fmi3SetInt16",
                                              "fmi3SetUInt16",
                                              "fmi3SetInt32",
                                              "fmi3SetUInt32",
                                              "fmi3SetInt64",
                                              "fmi3SetUInt64",
                                              "fmi3SetBoolean",
                                              "fmi3SetString",
                                              "fmi3SetBinary",
                                              "fmi3SetClock",
                                              "fmi3GetNumberOfVariableDependencies",
                                              "fmi3GetVariableDependencies",
                                              "fmi3GetFMUState",
                                              "fmi3SetFMUState",
                                              "fmi3FreeFMUState",
                                              "fmi3SerializedFMUStateSize",
                                              "fmi3SerializeFMUState",
                                              "fmi3DeserializeFMUState",
                                              "fmi3GetDirectionalDerivative",
                                              "fmi3GetAdjointDerivative",
                                              "fmi3EnterConfigurationMode",
                                              "fmi3ExitConfigurationMode",
                                              "fmi3GetIntervalDecimal",
                                              "fmi3GetIntervalFraction",
                                              "fmi3GetShiftDecimal",
                                              "fmi3GetShiftFraction",
                                              "fmi3SetIntervalDecimal",
                                              "fmi3SetIntervalFraction",
                                              "fmi3SetShiftDecimal",
                                              "fmi3SetShiftFraction",
                                              "fmi3EvaluateDiscreteStates",
                                              "fmi3UpdateDiscreteStates",
                                              "fmi3EnterContinuousTimeMode",
                                              "fmi3CompletedIntegratorStep",
                                              "fmi3SetTime",
                                              "fmi3SetContinuousStates",
                                              "fmi3GetContinuousStateDerivatives",
                                              "fmi3GetEventIndicators",
                                              "fmi3GetContinuousStates",
                                              "fmi3GetNominalsOfContinuousStates",
                                              "fmi3GetNumberOfEventIndicators",
                                              "fmi3GetNumberOfContinuousStates",
                                              "fmi3EnterStepMode",
                                              "fmi3GetOutputDerivatives",
                                              "fmi3DoStep",
                                              "fmi3ActivateModelPartition"};

TEST_F(FmuVersionsTest, DescriptionsOfVersion3KeepTheRulesOfTheStandard) {
  const Unit of_pid(with(pid, {"--fmi", "3"}));
  expect_valid(of_pid, false, false);
  expect_valid(Unit(with(plant, {"--fmi", "3"})), true, false);
  const Unit of_masses(with(masses, {"--fmi", "3"}));
  expect_valid(of_masses, true, true);
  // The functions of the standard, all of them and nothing else.
  for (const Unit* unit : {&of_pid, &of_masses}) {
    const auto symbols = run_shell("nm -D --defined-only '" + unit->path("binaries/x86_64-linux/unit.so") + "'");
    const auto visible = matches(symbols.output, " T (\\w+)");
    EXPECT_EQ(std::set<std::string>(visible.begin(), visible.end()),
              std::set<std::string>(functions_of_3.begin(), functions_of_3.end()));
  }
}

// What a simulator gets, digit for digit: of both versions and, where Wine is installed, of the libraries for Windows.
// The steps are those of a seeded record.
TEST_F(FmuVersionsTest, BothVersionsAndPlatformsGiveTheSameNumbers) {
  const TemporaryFolder folder;
  const std::string importer = folder.path("importer"), steps = folder.path("steps");
  ASSERT_EQ(run_shell("cc -std=c99 '" FMU_IMPORTER "' -o '" + importer + "' -ldl").code, 0);
  const bool has_compiler = has_tool("x86_64-w64-mingw32-gcc --version");
  const bool has_windows = has_compiler && has_tool("wine --version");
  if (has_windows) {
    ASSERT_EQ(run_shell("x86_64-w64-mingw32-gcc -std=c99 '" FMU_IMPORTER "' -o '" + importer + ".exe'").code, 0);
  }
  const std::string wine = "WINEDEBUG=-all WINEPREFIX='" + folder.path("wine") + "' timeout 300 wine ";
  struct Case {
    Options options;
    int inputs;
    std::string output;
    // Largest difference between Linux and Windows: the step of a PID takes sums and products alone, which are the
    // same everywhere; that of two masses has logarithms and exponentials, which libraries round by a bit each and
    // impacts carry on; that of a plant has none.
    double between_platforms;
  };
  for (const Case& each : {Case{pid, 2, "output", 0}, Case{plant, 1, "output", 0}, Case{masses, 1, "gap", 1e-12}}) {
    std::mt19937 random(21);
    std::uniform_real_distribution<double> draw(-5, 5), duration(1e-4, 0.05);
    std::ostringstream record;
    record.precision(17);
    for (int n = 0; n < 400; ++n) {
      record << duration(random);
      for (int i = 0; i < each.inputs; ++i) record << " " << draw(random);
      record << "\n";
    }
    std::ofstream(steps) << record.str();
    std::string expected;
    for (const std::string version : {"2", "3"}) {
      SCOPED_TRACE(each.options[0] + " " + version);
      Options options = with(each.options, {"--fmi", version});
      if (has_compiler) options.emplace_back("--windows");
      const Unit unit(options);
      const std::string folder_of_2 = "binaries/linux64/unit.so", folder_of_3 = "binaries/x86_64-linux/unit.so";
      const std::string arguments = " " + version + " '" + unit.token() + "' " + std::to_string(each.inputs) + " " +
                                    std::to_string(unit[each.output]) + " <'" + steps + "'";
      const auto here =
          run_shell("'" + importer + "' '" + unit.path(version == "3" ? folder_of_3 : folder_of_2) + "'" + arguments);
      ASSERT_EQ(here.code, 0) << here.error;
      ASSERT_EQ(std::count(here.output.begin(), here.output.end(), '\n'), 400);
      if (expected.empty()) expected = here.output;
      EXPECT_EQ(here.output, expected);
      if (!has_windows) continue;
      const std::string library =
          unit.path(version == "3" ? "binaries/x86_64-windows/unit.dll" : "binaries/win64/unit.dll");
      const auto there = run_shell(wine + "'" + importer + ".exe' '" + library + "'" + arguments);
      ASSERT_EQ(there.code, 0) << there.error;
      std::istringstream ours(here.output), theirs(there.output);
      double a, b;
      int lines = 0;
      for (; ours >> a && theirs >> b; ++lines) ASSERT_NEAR(a, b, each.between_platforms) << lines;
      EXPECT_EQ(lines, 400);
    }
  }
  if (!has_windows)
    GTEST_SKIP() << "the library for Windows is not run: x86_64-w64-mingw32-gcc or wine is not installed";
}

// The library's own class, impact for impact, and the vectors of the states.
TEST_F(FmuVersionsTest, Version3FollowsTheLibraryAndGivesVectors) {
  const Unit unit(with(masses, {"--fmi", "3"}));
  const Instance3 instance(unit);
  EXPECT_EQ(instance.set("start_position2", 0.0025), ok);
  EXPECT_EQ(instance.set("start_velocity1", 0.3), ok);
  instance.initialise(1.5);
  backlash::TwoMassPlant library({2, 1.5, 0.01, 0.6}, {0, 0.3, 0.0025, 0});
  std::mt19937 random(22);
  std::uniform_real_distribution<double> force(-20, 20), duration(1e-3, 0.1);
  double time = 1.5;
  for (int n = 0; n < 300; ++n) {
    const double f = force(random), h = duration(random);
    ASSERT_EQ(instance.set("force", f), ok);
    ASSERT_EQ(instance.step(time, h), ok) << last_message;
    library.advance(f, h);
    time += h;
    // The same operations; compilers may fuse them differently, and impacts lessen errors.
    const double scale = std::abs(library.state().position1) + 0.01;
    ASSERT_NEAR(instance.get("position1")[0], library.state().position1, 1e-12 * scale) << n;
    ASSERT_NEAR(instance.get("gap")[0], library.gap(), 1e-12) << n;
    ASSERT_EQ(instance.get("impacts")[0], static_cast<double>(library.impacts())) << n;
  }
  EXPECT_EQ(instance.get("time")[0], time);
  EXPECT_EQ(instance.get("x", 4)[2], instance.get("gap")[0]);
  // Booleans are counted on behind the scalars.
  const Reference contact = unit["in_contact"];
  bool touches = !library.in_contact();
  EXPECT_EQ(instance.call("fmi3GetBoolean", &contact, std::size_t{1}, &touches, std::size_t{1}), ok);
  EXPECT_EQ(touches, library.in_contact());
  // A vector and a scalar in one call.
  const Reference both[] = {unit["x"], unit["time"]};
  double values[5];
  EXPECT_EQ(instance.call("fmi3GetFloat64", &both[0], std::size_t{2}, &values[0], std::size_t{5}), ok);
  EXPECT_EQ(values[4], time);
  EXPECT_EQ(instance.call("fmi3GetFloat64", &both[0], std::size_t{2}, &values[0], std::size_t{4}), error);
  EXPECT_EQ(last_message, "the number of values is not that of the variables");
}

TEST_F(FmuVersionsTest, Version3IsForModelExchange) {
  const Unit unit(with(plant, {"--fmi", "3"}));
  const auto space =
      frac::modal_form(frac::realise(frac::FractionalTransferFunction::parse(plant[1]), {0.01, 100}, 1e-3));
  const Instance3 instance(unit, true);
  instance.initialise();
  std::size_t states = 0, events = 9;
  EXPECT_EQ(instance.call("fmi3GetNumberOfContinuousStates", &states), ok);
  EXPECT_EQ(instance.call("fmi3GetNumberOfEventIndicators", &events), ok);
  ASSERT_EQ(states, space.states);
  EXPECT_EQ(events, 0U);
  std::vector<double> x(states);
  for (std::size_t i = 0; i < states; ++i) x[i] = std::sin(1.0 + static_cast<double>(i));
  instance.set("input", 0.6);
  ASSERT_EQ(instance.call("fmi3SetContinuousStates", static_cast<const double*>(x.data()), states), ok);
  EXPECT_EQ(instance.ask("fmi3GetContinuousStates", states), x);
  EXPECT_EQ(instance.get("x", states), x);
  const auto rate = instance.ask("fmi3GetContinuousStateDerivatives", states);
  EXPECT_EQ(instance.get("der\\(x\\)", states), rate);
  for (std::size_t i = 0; i < states; ++i) {
    double expected = space.b[i] * 0.6, size = std::abs(expected);
    for (std::size_t j = 0; j < states; ++j) {
      expected += space.a[i * states + j] * x[j];
      size += std::abs(space.a[i * states + j] * x[j]);
    }
    // The realisation is found twice, by the program and here; a compiler that fuses products changes some 1e-12 of it.
    EXPECT_NEAR(rate[i], expected, 1e-11 * size);
  }
  EXPECT_EQ(instance.step(0, 1), error) << "co-simulation is another type";
  // An impact: mass 2 flies at the wall at 0, and comes back with the restitution.
  const Unit of_masses(with(masses, {"--fmi", "3"}));
  const Instance3 bouncing(of_masses, true);
  bouncing.initialise();
  const std::vector<double> hitting{0, 0, -1e-12, -2};
  ASSERT_EQ(bouncing.call("fmi3EnterContinuousTimeMode"), ok);
  ASSERT_EQ(bouncing.call("fmi3SetContinuousStates", hitting.data(), std::size_t{4}), ok);
  EXPECT_LT(bouncing.ask("fmi3GetEventIndicators", 3)[0], 0);
  EXPECT_EQ(bouncing.get("indicators", 3), bouncing.ask("fmi3GetEventIndicators", 3));
  bool more = true, ended = true, nominals = true, jumped = false, has_next = true;
  double next = NAN;
  ASSERT_EQ(bouncing.call("fmi3EnterEventMode"), ok);
  ASSERT_EQ(bouncing.call("fmi3UpdateDiscreteStates", &more, &ended, &nominals, &jumped, &has_next, &next), ok);
  EXPECT_TRUE(jumped && !more && !ended && !nominals && !has_next);
  EXPECT_DOUBLE_EQ(bouncing.ask("fmi3GetContinuousStates", 4)[3], 0.6 * 2);
}

TEST_F(FmuVersionsTest, StatesOfVersion3AreKeptSetAgainAndSerialised) {
  const Unit unit(with(pid, {"--fmi", "3"}));
  const Instance3 a(unit), b(unit);
  a.initialise();
  b.initialise();
  const auto run = [](const Instance3& each) {
    std::vector<double> outputs;
    for (int n = 100; n < 200; ++n) {
      each.set("setpoint", std::sin(0.1 * n));
      each.step(n * 1e-3, 1e-3);
      outputs.push_back(each.get("output")[0]);
    }
    return outputs;
  };
  a.set("setpoint", 1);
  a.step(0, 0.1);
  void* kept = nullptr;
  ASSERT_EQ(a.call("fmi3GetFMUState", &kept), ok);
  const auto expected = run(a);
  ASSERT_EQ(a.call("fmi3SetFMUState", kept), ok);
  EXPECT_EQ(run(a), expected);
  std::size_t size = 0;
  ASSERT_EQ(a.call("fmi3SerializedFMUStateSize", kept, &size), ok);
  std::vector<std::uint8_t> bytes(size);
  ASSERT_EQ(a.call("fmi3SerializeFMUState", kept, bytes.data(), size), ok);
  void* read = nullptr;
  ASSERT_EQ(b.call("fmi3DeserializeFMUState", static_cast<const std::uint8_t*>(bytes.data()), size, &read), ok);
  ASSERT_EQ(b.call("fmi3SetFMUState", read), ok);
  EXPECT_EQ(run(b), expected);
  for (void** each : {&kept, &read}) {
    EXPECT_EQ(a.call("fmi3FreeFMUState", each), ok);
    EXPECT_EQ(*each, nullptr);
  }
}

TEST_F(FmuVersionsTest, RefusalsOfVersion3NameWhatIsWrong) {
  const Unit unit(with(masses, {"--fmi", "3"}));
  EXPECT_THROW(Instance3(Unit(with(pid, {"--fmi", "3"})), true), std::runtime_error);
  EXPECT_EQ(last_message, "this model is for co-simulation only");
  const Instance3 instance(unit);
  EXPECT_EQ(instance.step(0, 1), error);
  instance.initialise();
  EXPECT_EQ(instance.set("restitution", 0.7), error);
  EXPECT_NE(last_message.find("fixed once the simulation runs"), std::string::npos);
  for (const char* name : {"gap", "x", "time"}) EXPECT_EQ(instance.set(name, 0), error) << name;
  EXPECT_EQ(instance.set("force", NAN), error);
  EXPECT_EQ(instance.step(0, -1), error);
  EXPECT_EQ(instance.call("fmi3EnterEventMode"), error);
  EXPECT_EQ(instance.call("fmi3EnterConfigurationMode"), error);
  const Reference nothing = 99;
  double value = 0;
  EXPECT_EQ(instance.call("fmi3GetFloat64", &nothing, std::size_t{1}, &value, std::size_t{1}), error);
  EXPECT_EQ(last_message, "no variable of this type has this value reference");
  // Nothing of a kind that there is none of is no error.
  const Reference* none = nullptr;
  EXPECT_EQ(instance.call("fmi3GetInt32", none, std::size_t{0}, static_cast<std::int32_t*>(nullptr), std::size_t{0}),
            ok);
  EXPECT_EQ(
      instance.call("fmi3GetInt32", &nothing, std::size_t{1}, static_cast<std::int32_t*>(nullptr), std::size_t{1}),
      error);
}

TEST(ExportFmuForWindows, NeedsItsCompiler) {
  const TemporaryFolder folder;
  Options command{"export", "fmu", "--windows", "--out", folder.path("unit.fmu")};
  command.insert(command.end(), masses.begin(), masses.end());
  const auto result = run_fracfit(command, {.search_path = folder.path("none")});
  if (result.error.find("libzip") != std::string::npos) GTEST_SKIP() << "built without libzip";
  EXPECT_EQ(result.code, 1);
  EXPECT_NE(result.error.find("no library for Windows: the C compiler 'x86_64-w64-mingw32-gcc' cannot be run"),
            std::string::npos)
      << result.error;
}

}  // namespace
