// SPDX-License-Identifier: BSD-3-Clause
#include "frac/digital/c_header.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <limits>
#include <string>
#include <vector>

#include "support/expect_invalid_argument.hpp"

namespace {

namespace fs = std::filesystem;
using frac::AntiWindup;
using frac::CHeaderOptions;
using frac::DigitalFilter;
using frac::FractionalPid;
using frac::FractionalPidConfig;
using frac::FractionalPidDesign;
using frac::Precision;

// Draws that C and C++ make alike: 53 random bits in [-1, 1).
class Draws {
 public:
  double operator()() {
    state_ = state_ * 6364136223846793005U + 1442695040888963407U;
    return static_cast<double>(static_cast<std::int64_t>(state_) >> 11) * 0x1p-52;
  }

 private:
  std::uint64_t state_ = 1;
};

constexpr const char* c_draws = R"(#include "controller.h"
#include <stdint.h>
#include <stdio.h>
#include <string.h>
static uint64_t state = 1;
static double draw(void)
{
  state = state * 6364136223846793005ULL + 1442695040888963407ULL;
  return (double)((int64_t)state >> 11) * 2.220446049250313e-16;
}
)";

class CHeader : public ::testing::Test {
 protected:
  void SetUp() override {
    if (std::system("cc --version >/dev/null 2>&1") != 0) GTEST_SKIP() << "no C compiler";
    folder_ = fs::temp_directory_path() / ("fracfit_c_header_" + std::to_string(::getpid()));
    fs::create_directories(folder_);
  }
  void TearDown() override {
    if (!folder_.empty()) fs::remove_all(folder_);
  }

  void write(const std::string& name, const std::string& text) const { std::ofstream(folder_ / name) << text; }

  // What the compiler says to the program, which may include controller.h.
  [[nodiscard]] std::string messages_of(const std::string& program, const std::string& flags) const {
    write("main.c", program);
    const std::string at = folder_.string();
    const std::string compile = "cc " + flags + " -Wall -Wextra -Werror -pedantic -Wshadow -Wconversion -o " + at +
                                "/run " + at + "/main.c 2>" + at + "/messages";
    if (std::system(compile.c_str()) == 0) return "";
    std::ifstream messages(folder_ / "messages");
    return compile + "\n" + std::string(std::istreambuf_iterator<char>(messages), {});
  }
  void compile(const std::string& program, const std::string& flags) const {
    const std::string messages = messages_of(program, flags);
    EXPECT_TRUE(messages.empty()) << messages;
  }

  // Compiles the program and returns the bytes it writes.
  [[nodiscard]] std::string output_of(const std::string& program, const std::string& flags) const {
    compile(program, flags);
    const std::string at = folder_.string();
    EXPECT_EQ(std::system((at + "/run >" + at + "/output").c_str()), 0);
    std::ifstream file(folder_ / "output", std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
  }

  template <typename Real>
  [[nodiscard]] std::vector<Real> numbers_of(const std::string& program, const std::string& flags) const {
    const std::string bytes = output_of(program, flags);
    std::vector<Real> values(bytes.size() / sizeof(Real));
    std::memcpy(values.data(), bytes.data(), values.size() * sizeof(Real));
    return values;
  }

 private:
  fs::path folder_;
};

template <typename Real>
void expect_same_bits(const std::vector<Real>& expected, const std::vector<Real>& got) {
  ASSERT_EQ(expected.size(), got.size());
  for (std::size_t n = 0; n < expected.size(); ++n) {
    ASSERT_EQ(std::memcmp(&expected[n], &got[n], sizeof(Real)), 0)
        << "sample " << n << ": " << expected[n] << " and " << got[n];
  }
}

FractionalPidConfig usual(double lambda, double mu) {
  FractionalPidConfig config;
  config.gains = {.kp = 2, .ki = 3, .kd = 0.02, .lambda = lambda, .mu = mu};
  config.sample_time = 1e-3;
  config.band = {0.1, 300};
  config.derivative_filter_time = 2e-3;
  config.setpoint_weight = 0.7;
  config.minimum = lambda == 0.5 ? 0.25 : -3;
  config.maximum = 2.5;
  return config;
}

// Set-points that jump and saturate, noise, manual control now and then, and inputs that are no numbers.
template <typename Real>
std::vector<Real> run_class(const FractionalPidDesign& design, int samples) {
  FractionalPid<Real> pid(design);
  Draws draw;
  std::vector<Real> output;
  for (int n = 0; n < samples; ++n) {
    const auto setpoint = static_cast<Real>(n / 1000 % 3);
    auto measured = static_cast<Real>(0.8 + 0.5 * draw());
    if (n % 5000 < 20) pid.track(static_cast<Real>(draw()));
    if (n % 7000 == 6999) pid.reset(setpoint, measured);
    if (n % 3000 == 0) measured = std::numeric_limits<Real>::quiet_NaN();
    output.push_back(pid.step(setpoint, measured) + static_cast<Real>(10 * pid.saturated() + 100 * pid.bad_input()));
  }
  return output;
}

std::string pid_program(const std::string& real, int samples) {
  return c_draws +
         ("int main(void)\n{\n  controller_state s;\n  int n;\n  controller_init(&s);\n  for (n = 0; n < " +
          std::to_string(samples) + "; ++n) {\n    const " + real + " setpoint = (" + real + ")(n / 1000 % 3);\n    " +
          real + " measured = (" + real + ")(0.8 + 0.5 * draw());\n    " + real +
          " out;\n    if (n % 5000 < 20) controller_track(&s, (" + real +
          ")draw());\n    if (n % 7000 == 6999) controller_reset_at(&s, setpoint, measured);\n    if (n % 3000 == 0) { "
          "const " +
          real +
          " zero = 0; measured = zero / zero; }\n    out = controller_step(&s, setpoint, measured);\n    out += (" +
          real +
          ")(10 * s.saturated + 100 * s.bad_input);\n    fwrite(&out, sizeof out, 1, stdout);\n  }\n  return 0;\n}\n");
}

// What CText puts in for the identifiers in capitals of a run-time file, as macros.
std::string macros(const std::vector<std::string>& conditions, unsigned chosen) {
  std::string text = "#define REAL float\n#define PREFIX_DIRECT 1.0f\n";
  for (const char* name : {"ZERO",
                           "TINY",
                           "MOST",
                           "LARGEST_INPUT",
                           "KP",
                           "KI",
                           "KD",
                           "SETPOINT_WEIGHT",
                           "DERIVATIVE_SETPOINT_WEIGHT",
                           "SAMPLE_TIME",
                           "HALF_TIME",
                           "LAG_SHARE",
                           "INVERSE_LAG_TIME",
                           "REST_OUTPUT",
                           "MINIMUM",
                           "MAXIMUM",
                           "TRACKING_SHARE",
                           "INVERSE_TRACKING",
                           "INTEGRAL_TAP",
                           "INTEGRAL_GAIN",
                           "INVERSE_INTEGRAL_GAIN",
                           "HIGH_GAIN",
                           "PRESENT_SHARE",
                           "TIME",
                           "INVERSE_TIME"}) {
    text += "#define " + std::string(name) + " 0.5f\n";
  }
  for (const char* name : {"INTEGRAL", "DERIVATIVE", "SECTION", "PREFIX"}) {
    text += "#define " + std::string(name) + "_TAPS 4\n#define " + std::string(name) + "_SIZE 8\n";
  }
  for (const char* name : {"PAIRS", "DIFFERENCES", "INTEGRATORS", "DEAD_SAMPLES"}) {
    text += "#define " + std::string(name) + " 2\n";
  }
  for (std::size_t i = 0; i < conditions.size(); ++i) {
    text += "#define " + conditions[i] + ((chosen >> i & 1U) != 0 ? " 1\n" : " 0\n");
  }
  return text;
}

std::string filter_functions(const std::string& prefix) {
  return "REAL NAME_" + prefix + "_tapped(const NAME_state *s, REAL input);\nREAL NAME_" + prefix +
         "_output(NAME_state *s, REAL x);\nvoid NAME_" + prefix +
         "_advance(NAME_state *s, REAL input, REAL x);\nextern const float NAME_" + prefix + "_rate[8];\n";
}

// The run-time files are C themselves: free of warnings, with macros in place of what an export puts in.
TEST_F(CHeader, RuntimeFilesAreCWithEveryCondition) {
  const std::string folder = std::string(FRACFIT_SOURCE_DIR) + "/libfrac/src/digital/c_export/runtime/";
  const auto include = [&](const char* file) { return "#include \"" + folder + file + "\"\n"; };
  const std::string tail = "int main(void) { return 0; }\n";
  const std::vector<std::string> pid{"HAS_INTEGRAL_TAPS",       "HAS_INTEGRAL_SECTIONS", "HAS_DERIVATIVE_TAPS",
                                     "HAS_DERIVATIVE_SECTIONS", "DIFFERENTIATES",        "BACK_CALCULATION",
                                     "CONDITIONAL_INTEGRATION"};
  const std::string states =
      "#define HAS_INTEGRAL_STATE (HAS_INTEGRAL_TAPS || HAS_INTEGRAL_SECTIONS)\n"
      "#define HAS_DERIVATIVE_STATE (HAS_DERIVATIVE_TAPS || HAS_DERIVATIVE_SECTIONS)\n"
      "#define HAS_ANY_STATE (HAS_INTEGRAL_STATE || HAS_DERIVATIVE_STATE)\n"
      "#define FOLLOWS_INPUT (HAS_DERIVATIVE_STATE && !DIFFERENTIATES)\n";
  const std::string flags = "-std=c99 -fsyntax-only";
  for (const unsigned chosen : {0U, 0x03U, 0x2cU, 0x55U, 0x3aU, 0x4fU, 0x1fU}) {
    SCOPED_TRACE(chosen);
    compile(macros(pid, chosen) + states + include("pid_state.h") + filter_functions("integral") +
                filter_functions("derivative") + include("pid.c") + tail,
            flags);
  }
  const std::vector<std::string> filter{"HAS_SECTION_TAPS", "HAS_SECTION_SECTIONS", "HAS_PAIRS",
                                        "HAS_DIFFERENCES",  "HAS_INTEGRATORS",      "HAS_DEAD_TIME"};
  const std::string loops =
      "#define HAS_LOOPS (HAS_PAIRS || HAS_DIFFERENCES || HAS_INTEGRATORS)\n"
      "#define HAS_ARRAYS (HAS_LOOPS || HAS_SECTION_TAPS || HAS_SECTION_SECTIONS || HAS_DEAD_TIME)\n"
      "#define HAS_NOTHING (!HAS_ARRAYS)\n"
      "extern const float NAME_pair_rate_re[2], NAME_pair_rate_im[2], NAME_pair_weight_re[2], "
      "NAME_pair_weight_im[2];\n";
  for (const unsigned chosen : {0U, 0x01U, 0x02U, 0x04U, 0x08U, 0x10U, 0x20U, 0x3fU}) {
    SCOPED_TRACE(chosen);
    compile(macros(filter, chosen) + loops + include("filter_state.h") + filter_functions("section") +
                include("filter.c") + tail,
            flags);
  }
  const std::vector<std::string> section{"HAS_PREFIX_TAPS", "HAS_PREFIX_SECTIONS", "PREFIX_GIVES_STATES"};
  for (unsigned chosen = 0; chosen < 8; ++chosen) {
    SCOPED_TRACE(chosen);
    compile(macros(section, chosen) +
                "#define HAS_PREFIX_STATE (HAS_PREFIX_TAPS || HAS_PREFIX_SECTIONS)\n"
                "typedef struct { float PREFIX_past[4], PREFIX_v[8], PREFIX_lost[8], PREFIX_leak[8]; } NAME_state;\n"
                "extern const float NAME_PREFIX_tap[4], NAME_PREFIX_rate[8], NAME_PREFIX_weight[8];\n" +
                include("section_filter.c") + tail,
            flags);
    if ((chosen & 2U) == 0) continue;
    compile(macros(section, chosen) +
                "#define VECTOR_INTEGER int\n#define __AVX512F__ 1\n"
                "typedef struct { float PREFIX_past[4], PREFIX_v[8], PREFIX_lost[8], PREFIX_leak[8]; } NAME_state;\n"
                "extern const float NAME_PREFIX_rate[8], NAME_PREFIX_weight[8];\n" +
                include("section_vector.c") + tail,
            flags);
  }
}

// A compiler whose double has 4 bytes, as some for small processors, refuses what was exported for double.
TEST_F(CHeader, DoubleHeaderIsRefusedWhereDoubleIsNone) {
  const FractionalPidDesign design(usual(0.8, 0.6));
  const std::string program =
      "#include <float.h>\n#undef DBL_MANT_DIG\n#define DBL_MANT_DIG 24\n#include \"controller.h\"\n"
      "int main(void) { return 0; }\n";
  write("controller.h", frac::c_header(design, {}));
  EXPECT_NE(messages_of(program, "-std=c99 -fsyntax-only").find("export in single precision"), std::string::npos);
  write("controller.h", frac::c_header(design, {.precision = Precision::float_type}));
  EXPECT_EQ(messages_of(program, "-std=c99 -fsyntax-only"), "");
}

TEST_F(CHeader, PidInCGivesTheBitsOfTheClassOnAMillionSamples) {
  const FractionalPidDesign design(usual(0.8, 0.6));
  write("controller.h", frac::c_header(design, {}));
  expect_same_bits(run_class<double>(design, 1'000'000),
                   numbers_of<double>(pid_program("double", 1'000'000), "-std=c99 -O2"));
}

TEST_F(CHeader, EveryKindOfControllerInBothPrecisions) {
  const int samples = 30'000;
  for (const AntiWindup method :
       {AntiWindup::none, AntiWindup::back_calculation, AntiWindup::conditional_integration}) {
    for (const auto& [lambda, mu] : {std::pair{0.8, 0.6}, {1.3, 1.4}, {1.0, 1.0}, {0.5, 1.0}}) {
      FractionalPidConfig config = usual(lambda, mu);
      config.anti_windup = method;
      const FractionalPidDesign design(config);
      write("controller.h", frac::c_header(design, {}));
      expect_same_bits(run_class<double>(design, samples),
                       numbers_of<double>(pid_program("double", samples), "-std=c99 -O0"));
      write("controller.h", frac::c_header(design, {.precision = Precision::float_type}));
      expect_same_bits(run_class<float>(design, samples),
                       numbers_of<float>(pid_program("float", samples), "-std=c99 -O1"));
    }
  }
}

// With fused operations at hand and no strict standard asked for, GCC would use them.
TEST_F(CHeader, FusedOperationsAreKeptOut) {
#if defined(__x86_64__)
  if (!__builtin_cpu_supports("fma")) GTEST_SKIP() << "no fused operations here";
  const FractionalPidDesign design(usual(0.8, 0.6));
  write("controller.h", frac::c_header(design, {}));
  expect_same_bits(run_class<double>(design, 30'000),
                   numbers_of<double>(pid_program("double", 30'000), "-std=gnu99 -O3 -mfma -mavx2"));
#else
  GTEST_SKIP() << "for x86-64";
#endif
}

TEST_F(CHeader, FilterInCGivesTheBitsOfTheClass) {
  const int samples = 20'000;
  const auto model = [](const char* formula) { return frac::FractionalTransferFunction::parse(formula); };
  for (const auto& design :
       {filter_design(frac::digital_power(0.5, {0.1, 300}, frac::Tolerance{1e-4}, 1e-3)),
        filter_design(frac::digital_power(-1.4, {0.1, 300}, frac::Tolerance{1e-4}, 1e-3)),
        filter_design(frac::digital_power(2.3, {0.1, 100}, frac::PoleCount{5}, 1e-3, frac::Discretisation::tustin)),
        filter_design(model("exp(-0.0123 s)/(0.8 s^2.2 + 0.5 s^0.9 + 1)"), 1e-3),
        filter_design(model("(s + 3)/(s^1.5 + s)"), 1e-3), filter_design(model("3"), 1e-3)}) {
    DigitalFilter<double> filter(design);
    Draws draw;
    std::vector<double> expected;
    for (int n = 0; n < samples; ++n) expected.push_back(filter.step(draw()));
    write("controller.h", frac::c_header(design, {}));
    const std::string program =
        c_draws + ("int main(void)\n{\n  controller_state s;\n  int n;\n  controller_init(&s);\n  for (n = 0; n < " +
                   std::to_string(samples) +
                   "; ++n) {\n    const double out = controller_step(&s, draw());\n    fwrite(&out, sizeof out, 1, "
                   "stdout);\n  }\n  return 0;\n}\n");
    expect_same_bits(expected, numbers_of<double>(program, "-std=c99 -O2"));
  }
}

TEST_F(CHeader, TwoControllersLiveInOneProgram) {
  const FractionalPidDesign design(usual(0.8, 0.6));
  write("controller.h", frac::c_header(design, {.comment = "ends early? */ int x; /* and REAL NAME"}) +
                            frac::c_header(design, {.name = "second", .precision = Precision::float_type}));
  const std::string output = output_of(
      "#include \"controller.h\"\n#include <stdio.h>\nint main(void)\n{\n  controller_state a;\n  second_state b;\n  "
      "controller_init(&a);\n  second_init(&b);\n  controller_reset(&a);\n  printf(\"%.3f %.3f\\n\", "
      "controller_step(&a, 0.5, 0.0), (double)second_step(&b, 0.5f, 0.0f));\n  return 0;\n}\n",
      "-std=c99");
  const auto space = output.find(' ');
  ASSERT_NE(space, std::string::npos);
  EXPECT_EQ(output.substr(0, space) + "\n", output.substr(space + 1));
}

TEST(CHeaderText, NamesAreChecked) {
  const FractionalPidDesign design(usual(0.8, 0.6));
  for (const std::string name :
       {"", "1st", "a-b", "double", "a b", "x;", "aaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaa"}) {
    CHeaderOptions options;
    options.name = name;
    support::expect_invalid_argument([&] { (void)frac::c_header(design, options); }, {"C name \"" + name + "\""});
  }
  EXPECT_EQ(frac::precision_from_string("float"), Precision::float_type);
  support::expect_invalid_argument([] { (void)frac::precision_from_string("half"); }, {"half"});
}

TEST(CHeaderText, NeedsNoLibrary) {
  const FractionalPidDesign design(usual(0.8, 0.6));
  const std::string of_double = frac::c_header(design, {});
  const std::string of_float = frac::c_header(design, {.precision = Precision::float_type});
  // float.h alone, which every compiler has, to look at the size of double.
  EXPECT_EQ(of_double.find("#include"), of_double.rfind("#include <float.h>\n#if DBL_MANT_DIG != 53\n"));
  EXPECT_EQ(of_float.find("#include"), std::string::npos);
  for (const std::string& text : {of_double, of_float}) EXPECT_EQ(text.find("malloc"), std::string::npos);
}

}  // namespace
