// SPDX-License-Identifier: BSD-3-Clause
// What a step of exported firmware costs at most: its text is compiled with numbers that count what is done with them,
// and run through all its branches.  Loops have lengths that stand in the text, so the counts are those of any step.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <regex>
#include <sstream>
#include <string>

#include "frac/digital/c_header.hpp"
#include "frac/digital/fixed_point.hpp"
#include "tools/temporary_folder.hpp"

namespace {

using frac::FractionalPidConfig;
using frac::FractionalPidDesign;

struct Operations {
  long products = 0;
  long sums = 0;
  long comparisons = 0;
  long quotients = 0;
};

// The header is C that a compiler of C++ understands, with another type for `double`, `float` or `int64_t`.
constexpr const char* counting_numbers = R"(
#include <algorithm>
#include <cfloat>
#include <cstdint>
#include <cstdio>
#include <limits>
#include <random>
long products, sums, comparisons, quotients;
template <typename Number>
struct Counted {
  Number value;
  Counted() = default;
  template <typename Other>
  constexpr Counted(Other other) : value(static_cast<Number>(other)) {}
  template <typename Other>
  constexpr Counted(Counted<Other> other) : value(static_cast<Number>(other.value)) {}
  template <typename Other>
  explicit constexpr operator Other() const { return static_cast<Other>(value); }
  Counted operator-() const { return -value; }
  Counted& operator+=(Counted b) { return *this = *this + b; }
  friend Counted operator+(Counted a, Counted b) { return ++sums, a.value + b.value; }
  friend Counted operator-(Counted a, Counted b) { return ++sums, a.value - b.value; }
  friend Counted operator*(Counted a, Counted b) { return ++products, a.value * b.value; }
  friend Counted operator/(Counted a, Counted b) { return ++quotients, a.value / b.value; }
  friend Counted operator>>(Counted a, int by) { return a.value >> by; }
  friend Counted operator<<(Counted a, int by) { return a.value << by; }
  friend bool operator<(Counted a, Counted b) { return ++comparisons, a.value < b.value; }
  friend bool operator>(Counted a, Counted b) { return ++comparisons, a.value > b.value; }
  friend bool operator<=(Counted a, Counted b) { return ++comparisons, a.value <= b.value; }
  friend bool operator>=(Counted a, Counted b) { return ++comparisons, a.value >= b.value; }
  friend bool operator!=(Counted a, Counted b) { return ++comparisons, a.value != b.value; }
};
)";

// Inputs at and beyond all limits, small ones, manual control, and what is no number.
constexpr const char* run = R"(
int main() {
  static model_state s;
  model_init(&s);
  std::mt19937 random(4);
  long most[4] = {};
  for (int n = 0; n < 20000; ++n) {
#if IS_FIXED
    const auto draw = [&] { return static_cast<std::int32_t>(random()) / (n / 500 % 2 == 0 ? 1 : 1000); };
    const std::int32_t track = draw();
#else
    const auto draw = [&] {
      const double drawn = std::uniform_real_distribution<double>(-1, 1)(random);
      return n % 100 == 50 ? std::numeric_limits<double>::quiet_NaN() : (n / 500 % 2 == 0 ? 1e3 : 1e-3) * drawn;
    };
    const double track = 1e3 * std::uniform_real_distribution<double>(-1, 1)(random);
#endif
#if IS_FILTER
    (void)track;
#else
    if (n % 7 == 3) model_track(&s, track);
#endif
    products = sums = comparisons = quotients = 0;
#if IS_FILTER
    (void)model_step(&s, draw());
#else
    (void)model_step(&s, draw(), draw());
#endif
    const long now[] = {products, sums, comparisons, quotients};
    for (int i = 0; i < 4; ++i) most[i] = std::max(most[i], now[i]);
  }
  std::printf("%ld %ld %ld %ld", most[0], most[1], most[2], most[3]);
  return 0;
}
)";

// @param type  that the header computes with
Operations largest_count(const std::string& header, const std::string& type, bool is_filter) {
  const TemporaryFolder folder;
  const bool is_fixed = type == "int64_t";
  folder.write("model.h", header);
  folder.write("main.cpp", counting_numbers + ("using number = Counted<" + (is_fixed ? "std::int64_t" : type) +
                                               ">;\n#define " + type + " number\n#include \"model.h\"\n#undef " + type +
                                               "\n#define IS_FIXED " + (is_fixed ? "1" : "0") + "\n#define IS_FILTER " +
                                               (is_filter ? "1" : "0") + "\n" + run));
  const std::string at = folder.path();
  EXPECT_EQ(
      std::system(("c++ -std=c++17 -O1 -w -o '" + at + "run' '" + at + "main.cpp' 2>'" + at + "messages'").c_str()), 0)
      << content_of(folder.path("messages"));
  EXPECT_EQ(std::system(("'" + at + "run' >'" + at + "counts'").c_str()), 0);
  Operations found;
  std::istringstream counts(content_of(folder.path("counts")));
  counts >> found.products >> found.sums >> found.comparisons >> found.quotients;
  return found;
}

// Entries of all tables of the header whose name ends so.
long entries(const std::string& header, const std::string& ending) {
  const std::regex table("static const \\w+ \\w+_" + ending + R"(\[(\d+)\] = )");
  long found = 0;
  for (std::sregex_iterator at(header.begin(), header.end(), table), end; at != end; ++at) found += std::stol((*at)[1]);
  return found;
}

// At most what is said, and no bound that nothing comes near.
void expect_bound(const Operations& found, const Operations& bound) {
  const auto expect = [](long count, long most, const char* what) {
    EXPECT_LE(count, most) << what;
    EXPECT_GE(static_cast<double>(count), 0.8 * static_cast<double>(most)) << what;
  };
  expect(found.products, bound.products, "products");
  expect(found.sums, bound.sums, "sums");
  expect(found.comparisons, bound.comparisons, "comparisons");
  EXPECT_EQ(found.quotients, 0);
}

// The bounds of the page on firmware, from the tables of a header.
Operations bound_of_pid(const std::string& header) {
  const long taps = entries(header, "tap"), sections = entries(header, "rate");
  return {15 + taps + 2 * sections, 19 + taps + 7 * sections, 21 + 2 * sections};
}
Operations bound_of_filter(const std::string& header) {
  const long taps = entries(header, "tap"), sections = entries(header, "section_rate");
  const long pairs = entries(header, "pair_rate_re");
  return {1 + taps + 2 * sections + 6 * pairs, 1 + taps + 6 * sections + 7 * pairs, 2 * sections + 4 * pairs};
}
Operations bound_of_fixed_pid(const std::string& header) {
  const long taps = entries(header, "tap"), sections = entries(header, "rate");
  // Taps of the integral count again where the output is cut.
  const long again = entries(header, "integral_tap");
  return {10 + taps + again + 2 * sections, 19 + taps + 5 * sections, 12};
}
Operations bound_of_fixed_filter(const std::string& header) {
  const long taps = entries(header, "tap"), sections = entries(header, "section_rate");
  const long pairs = entries(header, "pair_rate_re");
  return {1 + taps + 2 * sections + 6 * pairs, 2 + taps + 5 * sections + 10 * pairs, 2};
}

FractionalPidConfig pid(double lambda, double mu, frac::Discretisation method) {
  FractionalPidConfig config;
  config.gains = {.kp = 2, .ki = 3, .kd = 0.02, .lambda = lambda, .mu = mu};
  config.sample_time = 0.01;
  config.band = {0.1, 30};
  config.minimum = -3;
  config.maximum = 2.5;
  config.discretisation = method;
  return config;
}

class StepCost : public ::testing::Test {
 protected:
  void SetUp() override {
    if (std::system("c++ --version >/dev/null 2>&1") != 0) GTEST_SKIP() << "no C++ compiler";
  }
};

TEST_F(StepCost, ControllersDoNoMoreThanIsSaid) {
  using frac::AntiWindup;
  using frac::Discretisation;
  struct Case {
    Discretisation method;
    AntiWindup anti_windup;
    const char* type;
  };
  for (const auto& [method, anti_windup, type] :
       {Case{Discretisation::direct, AntiWindup::back_calculation, "double"},
        Case{Discretisation::tustin, AntiWindup::conditional_integration, "float"}}) {
    SCOPED_TRACE(type);
    auto config = pid(0.8, 0.6, method);
    config.anti_windup = anti_windup;
    config.setpoint_weight = 0.7;
    config.derivative_setpoint_weight = 0.2;
    config.derivative_filter_time = 0.05;
    const std::string header =
        frac::c_header(FractionalPidDesign(config), {.name = "model", .precision = frac::precision_from_string(type)});
    expect_bound(largest_count(header, type, false), bound_of_pid(header));
  }
}

TEST_F(StepCost, FixedPointControllersDoNoMoreThanIsSaid) {
  for (const auto method : {frac::Discretisation::direct, frac::Discretisation::tustin}) {
    auto config = pid(0.8, 0.6, method);
    config.setpoint_weight = 0.7;
    config.derivative_filter_time = 0.05;
    const std::string header =
        frac::fixed_point_header(FractionalPidDesign(config), {.input = 2, .output = 200}, {.name = "model"}).text;
    expect_bound(largest_count(header, "int64_t", false), bound_of_fixed_pid(header));
  }
}

TEST_F(StepCost, FiltersDoNoMoreThanIsSaid) {
  const auto power = frac::filter_design(frac::digital_power(-0.5, {0.1, 70}, frac::Tolerance{1e-3}, 0.02));
  const auto resonance = frac::model_filter(frac::FractionalTransferFunction::parse("1/(s^2 + 0.2 s + 0.1 s^0.5 + 1)"),
                                            frac::FrequencyBand{1e-2, 1e1}, 0.05, 1e-3)
                             .design;
  for (const auto& design : {power, resonance}) {
    const std::string header = frac::c_header(design, {.name = "model"});
    expect_bound(largest_count(header, "double", true), bound_of_filter(header));
    const std::string fixed = frac::fixed_point_header(design, {.input = 5, .output = 400}, {.name = "model"}).text;
    expect_bound(largest_count(fixed, "int64_t", true), bound_of_fixed_filter(fixed));
  }
}

}  // namespace
