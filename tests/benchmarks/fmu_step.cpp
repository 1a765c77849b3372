// SPDX-License-Identifier: BSD-3-Clause
// What a step of a functional mock-up unit costs beside that of the library: processor time of setting two inputs,
// fmi2DoStep and getting the output, and of FractionalPid::step, the least of many runs.
//
// usage: fmu_step N <folder>...   with units of `fracfit export fmu --kp 2 --ki 3 --kd 0.05 --lambda 0.8 --mu 0.6
//        --sample-time 1e-3 --band 0.1:300 --poles N --name unit` unpacked in the folders
#include <dlfcn.h>
#include <time.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <limits>
#include <regex>
#include <stdexcept>
#include <string>
#include <vector>

#include "frac/digital/fractional_pid.hpp"
#include "support/fmi2_callbacks.hpp"

namespace {

double processor_seconds() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

class Unit {
 public:
  explicit Unit(const std::string& folder) {
    library_ = ::dlopen((folder + "/binaries/linux64/unit.so").c_str(), RTLD_NOW);
    if (library_ == nullptr) throw std::runtime_error(::dlerror());
    std::ifstream file(folder + "/modelDescription.xml");
    const std::string description(std::istreambuf_iterator<char>(file), {});
    std::smatch guid;
    std::regex_search(description, guid, std::regex("guid=\"([^\"]*)\""));
    static const support::Fmi2Callbacks callbacks{nullptr, std::calloc, std::free, nullptr, nullptr};
    component_ = function<void*(const char*, int, const char*, const char*, const support::Fmi2Callbacks*, int, int)>(
        "fmi2Instantiate")("unit", 1, guid[1].str().c_str(), "", &callbacks, 0, 0);
    function<int(void*, int, double, double, int, double)>("fmi2SetupExperiment")(component_, 0, 0, 0, 0, 0);
    function<int(void*)>("fmi2EnterInitializationMode")(component_);
    function<int(void*)>("fmi2ExitInitializationMode")(component_);
    set_ = function<int(void*, const unsigned*, std::size_t, const double*)>("fmi2SetReal");
    get_ = function<int(void*, const unsigned*, std::size_t, double*)>("fmi2GetReal");
    step_ = function<int(void*, double, double, int)>("fmi2DoStep");
  }

  double step(double time, double duration, double setpoint, double measured) {
    const unsigned inputs[2] = {0, 1}, output = 2;
    const double values[2] = {setpoint, measured};
    double y = 0;
    set_(component_, inputs, 2, values);
    step_(component_, time, duration, 1);
    get_(component_, &output, 1, &y);
    return y;
  }

 private:
  template <typename Function>
  [[nodiscard]] Function* function(const char* name) const {
    return reinterpret_cast<Function*>(::dlsym(library_, name));
  }

  void* library_ = nullptr;
  void* component_ = nullptr;
  int (*set_)(void*, const unsigned*, std::size_t, const double*) = nullptr;
  int (*get_)(void*, const unsigned*, std::size_t, double*) = nullptr;
  int (*step_)(void*, double, double, int) = nullptr;
};

}  // namespace

int main(int argc, char** argv) {
  if (argc < 3) return 2;
  frac::FractionalPidConfig config;
  config.gains = {.kp = 2, .ki = 3, .kd = 0.05, .lambda = 0.8, .mu = 0.6};
  config.sample_time = 1e-3;
  config.band = {0.1, 300};
  config.goal = frac::PoleCount{std::atoi(argv[1])};
  constexpr int steps = 20'000, runs = 60;
  std::vector<double> setpoint, measured;
  for (int i = 0; i < steps; ++i) {
    setpoint.push_back(i / 500 % 3);
    measured.push_back(std::rand() % 1000 / 1000.0);
  }
  std::printf("unit,library_ns,unit_ns,ratio,same_outputs\n");
  for (int which = 2; which < argc; ++which) {
    Unit unit(argv[which]);
    frac::FractionalPid<double> pid(config);
    double library_best = std::numeric_limits<double>::infinity(), unit_best = library_best;
    long n = 0;
    bool same = true;
    for (int run = 0; run < runs; ++run) {
      double of_library = 0, of_unit = 0;
      double begin = processor_seconds();
      for (std::size_t i = 0; i < steps; ++i) of_library += pid.step(setpoint[i], measured[i]);
      library_best = std::min(library_best, processor_seconds() - begin);
      begin = processor_seconds();
      for (std::size_t i = 0; i < steps; ++i, ++n)
        of_unit += unit.step(static_cast<double>(n) * 1e-3, 1e-3, setpoint[i], measured[i]);
      unit_best = std::min(unit_best, processor_seconds() - begin);
      same = same && of_library == of_unit;
    }
    std::printf("%s,%.1f,%.1f,%.2f,%s\n", argv[which], 1e9 * library_best / steps, 1e9 * unit_best / steps,
                unit_best / library_best, same ? "yes" : "no");
  }
  return 0;
}
