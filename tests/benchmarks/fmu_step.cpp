// SPDX-License-Identifier: BSD-3-Clause
// What a step of a functional mock-up unit costs beside that of the library: processor time of setting the inputs,
// fmi2DoStep and getting the output, that of fmi2DoStep alone, and of a step of the class, the least of many runs.
//
// usage: fmu_step KIND=FOLDER...
// with units of `fracfit export fmu --name unit` and the options below, unpacked in the folders; KIND is
//   pid, float-pid  --kp 2 --ki 3 --kd 0.05 --lambda 0.8 --mu 0.6 --sample-time 1e-3 --band 0.1:300 --poles 16, and
//                   --precision float
//   filter          --model '1/(0.8 s^2.2 + 0.5 s^0.9 + 1)' --sample-time 0.01 --band 0.01:100
//   masses          --clearance 0.001 --restitution 0.6 --mass1 2 --mass2 1
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

#include "backlash/two_mass_plant.hpp"
#include "frac/digital/digital_filter.hpp"
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

  // The first inputs, as many as there are.
  double step(double time, double duration, const std::vector<double>& inputs, unsigned output) {
    static constexpr unsigned references[] = {0, 1};
    double y = 0;
    set_(component_, references, inputs.size(), inputs.data());
    step_alone(time, duration);
    get_(component_, &output, 1, &y);
    return y;
  }
  void step_alone(double time, double duration) { step_(component_, time, duration, 1); }

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

constexpr int steps = 20'000, runs = 60;

// Inputs of each step.
std::vector<std::vector<double>> signals(std::size_t count) {
  std::vector<std::vector<double>> inputs;
  for (int i = 0; i < steps; ++i) {
    inputs.push_back({static_cast<double>(i / 500 % 3)});
    if (count == 2) inputs.back().push_back(std::rand() % 1000 / 1000.0);
  }
  return inputs;
}

// @param step  of the library, from the inputs to the output
template <typename Step>
void compare(const std::string& name, const std::string& folder, std::size_t count, unsigned output, double duration,
             Step step) {
  Unit unit(folder);
  const std::vector<std::vector<double>> inputs = signals(count);
  double library_best = std::numeric_limits<double>::infinity(), unit_best = library_best, alone_best = library_best;
  long n = 0;
  bool same = true;
  for (int run = 0; run < runs; ++run) {
    double of_library = 0, of_unit = 0;
    double begin = processor_seconds();
    for (const auto& each : inputs) of_library += step(each);
    library_best = std::min(library_best, processor_seconds() - begin);
    begin = processor_seconds();
    for (const auto& each : inputs) of_unit += unit.step(static_cast<double>(n++) * duration, duration, each, output);
    unit_best = std::min(unit_best, processor_seconds() - begin);
    same = same && of_library == of_unit;
  }
  for (int run = 0; run < runs; ++run) {
    const double begin = processor_seconds();
    for (int i = 0; i < steps; ++i) unit.step_alone(static_cast<double>(n++) * duration, duration);
    alone_best = std::min(alone_best, processor_seconds() - begin);
  }
  std::printf("%s,%.1f,%.1f,%.1f,%.2f,%s\n", name.c_str(), 1e9 * library_best / steps, 1e9 * unit_best / steps,
              1e9 * alone_best / steps, unit_best / library_best, same ? "yes" : "no");
}

frac::FractionalPidConfig pid_config() {
  frac::FractionalPidConfig config;
  config.gains = {.kp = 2, .ki = 3, .kd = 0.05, .lambda = 0.8, .mu = 0.6};
  config.sample_time = 1e-3;
  config.band = {0.1, 300};
  config.goal = frac::PoleCount{16};
  return config;
}

template <typename Real>
void compare_pid(const std::string& name, const std::string& folder) {
  frac::FractionalPid<Real> pid{frac::FractionalPidDesign(pid_config())};
  compare(name, folder, 2, 2, 1e-3, [&](const std::vector<double>& inputs) {
    return static_cast<double>(pid.step(static_cast<Real>(inputs[0]), static_cast<Real>(inputs[1])));
  });
}

void compare_filter(const std::string& name, const std::string& folder) {
  const auto model = frac::FractionalTransferFunction::parse("1/(0.8 s^2.2 + 0.5 s^0.9 + 1)");
  frac::DigitalFilter<double> filter(frac::model_filter(model, frac::FrequencyBand{0.01, 100}, 0.01, 1e-3).design);
  compare(name, folder, 1, 1, 0.01, [&](const std::vector<double>& inputs) { return filter.step(inputs[0]); });
}

void compare_masses(const std::string& name, const std::string& folder) {
  constexpr double duration = 1e-3;
  constexpr unsigned gap = 5;
  backlash::TwoMassPlant plant({2, 1, 1e-3, 0.6}, {});
  compare(name, folder, 1, gap, duration, [&](const std::vector<double>& inputs) {
    plant.advance(inputs[0], duration);
    return plant.gap();
  });
}

}  // namespace

int main(int argc, char** argv) {
  std::printf("unit,library_ns,unit_ns,alone_ns,ratio,same_outputs\n");
  for (int which = 1; which < argc; ++which) {
    const std::string argument = argv[which], kind = argument.substr(0, argument.find('='));
    if (kind.size() == argument.size()) return 2;
    const std::string folder = argument.substr(kind.size() + 1);
    if (kind == "pid")
      compare_pid<double>(kind, folder);
    else if (kind == "float-pid")
      compare_pid<float>(kind, folder);
    else if (kind == "filter")
      compare_filter(kind, folder);
    else if (kind == "masses")
      compare_masses(kind, folder);
    else
      return 2;
  }
  return 0;
}
