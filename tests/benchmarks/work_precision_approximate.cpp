// Design of rational approximations of s^a: largest relative error on the band and time of a design, by method and
// number of poles.  Prints case,method,setting,error,seconds; seconds are processor time, the median of 5 repeats.
#include <algorithm>
#include <cstdio>
#include <ctime>
#include <stdexcept>
#include <string>
#include <vector>

#include "frac/approximate.hpp"

namespace {

double processor_seconds() {
  timespec now{};
  ::clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

struct Case {
  std::string name;
  double order;
  frac::FrequencyBand band;
};

void run(const Case& power, frac::ApproximationMethod method, frac::ApproximationGoal goal, const std::string& asked) {
  std::vector<double> seconds;
  frac::Approximation result = frac::approximate(power.order, power.band, goal, method);
  for (int repeat = 0; repeat < 5; ++repeat) {
    const double start = processor_seconds();
    result = frac::approximate(power.order, power.band, goal, method);
    seconds.push_back(processor_seconds() - start);
  }
  std::nth_element(seconds.begin(), seconds.begin() + 2, seconds.end());
  std::printf("%s,%s,%s%d poles (limit %d),%.3e,%.3e\n", power.name.c_str(),
              std::string(frac::to_string(method)).c_str(), asked.c_str(), result.poles, result.limit_poles,
              result.error.max_relative, seconds[2]);
}

}  // namespace

int main() {
  std::printf("# %s, GCC %s, median of 5 repeats\ncase,method,setting,error,seconds\n", FRACFIT_BUILD_TYPE,
              __VERSION__);
  const Case cases[] = {{"s^0.5 over 4 decades", 0.5, {1e-2, 1e2}},
                        {"s^0.1 over 6 decades", 0.1, {1e-3, 1e3}},
                        {"s^0.5 over 6 decades", 0.5, {1e-3, 1e3}},
                        {"s^0.9 over 8 decades", 0.9, {1e-4, 1e4}}};
  for (const Case& power : cases) {
    for (const frac::ApproximationMethod method : frac::approximation_methods()) {
      for (const int poles : {1, 2, 3, 4, 5, 8, 12, 13, 15, 26, 30, 40, 60}) {
        try {
          run(power, method, frac::PoleCount{poles}, "");
        } catch (const std::invalid_argument&) {
          continue;  // a number of poles that this method does not have
        }
      }
    }
    for (const double tolerance : {1e-1, 1e-3, 1e-6, 1e-9, 1e-12}) {
      char asked[32];
      std::snprintf(asked, sizeof asked, "tolerance %.0e: ", tolerance);
      run(power, frac::ApproximationMethod::ladder, frac::Tolerance{tolerance}, asked);
    }
  }
}
