// SPDX-License-Identifier: BSD-3-Clause
// Population on which verdicts are judged: frequency responses, or records over time, of integer-order and fractional
// systems with many kinds of noise, as CSV files, and truth.csv, which says what each is and what theory can decide on
// it (the bound is defined in judging/evidence_bound.hpp, for records in judging/record_bound.hpp).  It shares no code
// with the library: neither responses, nor fits, nor random numbers.
//
// Usage: judging_population DIRECTORY SEED REPEATS [time|smooth]
//        judging_population --smoke
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <sstream>
#include <string>
#include <vector>

#include "benchmarks/judging/evidence_bound.hpp"
#include "benchmarks/judging/measurement.hpp"
#include "benchmarks/judging/random_numbers.hpp"
#include "benchmarks/judging/record_bound.hpp"
#include "benchmarks/judging/step_response.hpp"
#include "benchmarks/judging/systems.hpp"

namespace {

using judging::Curve;
using judging::Kind;
using judging::RandomNumbers;
using judging::Setting;
using judging::System;

/// Settings of one file; over the repeats of a kind all noise levels come equally often.
Setting draw_setting(RandomNumbers& random, int repeat) {
  static const std::vector<double> levels = {0.01, 0.001, 0.03, 0.1, 0};
  Setting setting;
  setting.level = levels[static_cast<std::size_t>(repeat) % levels.size()];
  setting.points = random.one_of<int>({20, 35, 60, 60, 100, 200});
  setting.decades = random.one_of<double>({1.5, 2.5, 4, 4, 6});
  setting.imaginary_only = random.chance(0.25);
  setting.noise = setting.level == 0 ? "none"
                                     : random.one_of<std::string>({"relative", "relative", "relative", "additive",
                                                                   "mixed", "correlated", "outliers", "rounded"});
  return setting;
}

/// The same with white noise of 0.1 to 1 % beside a smooth error, whose sizes come equally often.
Setting draw_smooth_setting(RandomNumbers& random, int repeat) {
  Setting setting = draw_setting(random, repeat);
  setting.noise = "smooth";
  setting.level = std::vector<double>{0.01, 0.003, 0.03}[static_cast<std::size_t>(repeat) % 3];
  setting.beside = random.log_uniform(1e-3, 1e-2);
  return setting;
}

std::string number(double x) {
  char text[40];
  std::snprintf(text, sizeof text, "%.17g", x);
  return text;
}

std::string listed(const std::vector<double>& values) {
  std::ostringstream text;
  for (const double value : values) text << (text.tellp() > 0 ? " " : "") << value;
  return text.str();
}

std::string listed(const judging::Bound& bound) {
  std::ostringstream text;
  text << bound.word() << ',' << bound.log_odds << ',' << bound.deviation << ',' << bound.rational_order << ','
       << bound.rational_delay << ',' << bound.rational_loss << ',' << bound.fractional_name << ','
       << bound.fractional_loss;
  return text.str();
}

constexpr const char* kTruthHeader =
    "file,kind,class,within_family,noise,level,points,decades,component,gain,time_unit,order,names,parameters,"
    "theory,log_odds,deviation,rational_order,rational_delay,rational_loss,fractional_rival,fractional_loss\n";

/// One file per line of the truth: the kind, the draw of the system and of its measurement come from one seed.
void write_files(const std::filesystem::path& folder, std::uint64_t seed, int repeats,
                 Setting (*draw)(RandomNumbers&, int) = draw_setting) {
  std::filesystem::create_directories(folder);
  std::ofstream truth(folder / "truth.csv");
  truth << kTruthHeader;
  int index = 0;
  for (const Kind& kind : judging::kinds()) {
    ++index;
    for (int repeat = 0; repeat < repeats; ++repeat) {
      RandomNumbers random(seed * 1000003U + static_cast<std::uint64_t>(index) * 1009U +
                           static_cast<std::uint64_t>(repeat));
      random.bits();
      const System system = kind.draw(random);
      const Setting setting = draw(random, repeat);
      const double gain = random.log_uniform(1e-3, 1e3) * (random.chance(0.1) ? -1 : 1);
      const double time_unit = random.log_uniform(1e-3, 1e3);
      const Curve curve = judging::measure(system, setting, random);
      const std::string name = kind.name + "-" + std::to_string(seed) + "-" + std::to_string(repeat) + ".csv";
      std::ofstream file(folder / name);
      file << "omega_rad_s,re,im\n";
      for (std::size_t i = 0; i < curve.omega.size(); ++i) {
        file << number(curve.omega[i] / time_unit) << ',' << number(gain * curve.measured[i].real()) << ','
             << number(gain * curve.measured[i].imag()) << '\n';
      }
      const judging::Bound bound = judging::evidence_bound(kind, system, curve);
      truth << name << ',' << kind.name << ',' << (kind.fractional ? "fractional" : "integer") << ','
            << (kind.within_family ? 1 : 0) << ',' << setting.noise << ',' << setting.level << ',' << setting.points
            << ',' << setting.decades << ',' << (setting.imaginary_only ? "imaginary" : "both") << ',' << gain << ','
            << time_unit << ',' << system.order << ',' << system.names << ',' << listed(system.parameters) << ','
            << listed(bound) << '\n';
    }
    truth.flush();
  }
}

/// Records over time; `decades` in the truth is left at 0.
void write_records(const std::filesystem::path& folder, std::uint64_t seed, int repeats) {
  std::filesystem::create_directories(folder);
  std::ofstream truth(folder / "truth.csv");
  truth << kTruthHeader;
  int index = 0;
  for (const Kind& kind : judging::kinds()) {
    ++index;
    for (int repeat = 0; judging::has_record(kind) && repeat < repeats; ++repeat) {
      RandomNumbers random(seed * 7000003U + static_cast<std::uint64_t>(index) * 1009U +
                           static_cast<std::uint64_t>(repeat));
      random.bits();
      const System system = kind.draw(random);
      judging::RecordSetting setting;
      setting.level = random.one_of<double>({0, 0.001, 0.01, 0.01, 0.03, 0.1});
      setting.samples = random.one_of<int>({60, 150, 301});
      setting.input = random.one_of<std::string>({"step", "step", "pulse", "staircase"});
      if (setting.level > 0) setting.noise = random.chance(0.25) ? "correlated" : "white";
      const double gain = random.log_uniform(1e-2, 1e2);
      const double time_unit = random.log_uniform(1e-2, 1e2);
      const judging::Record record = judging::record(system, setting, random);
      const std::string name = kind.name + "-" + std::to_string(seed) + "-" + std::to_string(repeat) + ".csv";
      std::ofstream file(folder / name);
      file << "time_s,input,output\n";
      for (std::size_t i = 0; i < record.time.size(); ++i) {
        file << number(record.time[i] * time_unit) << ',' << number(record.input[i]) << ','
             << number(gain * record.output[i]) << '\n';
      }
      truth << name << ',' << kind.name << ',' << (kind.fractional ? "fractional" : "integer") << ','
            << (kind.within_family ? 1 : 0) << ',' << setting.noise << ' ' << setting.input << ',' << setting.level
            << ',' << setting.samples << ",0,output," << gain << ',' << time_unit << ',' << system.order << ','
            << system.names << ',' << listed(system.parameters) << ','
            << listed(judging::record_bound(kind, system, record)) << '\n';
    }
  }
}

bool expect(bool holds, const char* what) {
  if (!holds) std::cerr << "judging_population: " << what << '\n';
  return holds;
}

/// The bound rests on the rational fit, and the files on the responses; both are tried where the answer is known.
bool smoke() {
  bool good = true;
  for (const Kind& kind : judging::kinds()) {
    RandomNumbers random(7);
    const System system = kind.draw(random);
    for (const double w : {0.03, 0.8, 21.0}) {
      const judging::Complex above = system(judging::Complex(0, w));
      const judging::Complex below = system(judging::Complex(0, -w));
      // A real system answers at -omega with the conjugate; twelve digits leave room for chains of fifty divisions.
      good &= expect(std::isfinite(std::abs(above)) && std::abs(above - std::conj(below)) <= 1e-12 * std::abs(above),
                     (kind.name + ": not the response of a real system").c_str());
    }
  }
  const auto find = [](const std::string& name) {
    return *std::find_if(judging::kinds().begin(), judging::kinds().end(),
                         [&](const Kind& k) { return k.name == name; });
  };
  Setting setting;
  setting.noise = "relative";
  setting.level = 0.01;
  const auto curve_of = [&](const Kind& kind) {
    RandomNumbers random(11);
    return judging::measure(kind.draw(random), setting, random);
  };
  // A ratio of order n is met by order n to rounding, which at 1 % noise is a loss of 1e-20; order n - 1 misses it.
  const Curve two = curve_of(find("two-lags"));
  good &= expect(judging::rational_loss(two, 2) < 1e-12, "order 2 does not meet two lags");
  good &= expect(judging::rational_loss(two, 1) > 1, "order 1 meets two lags");
  const Curve modes = curve_of(find("modes-of-alternating-sign"));
  good &= expect(judging::rational_loss(modes, 4) < 1e-10, "order 4 does not meet two modes");
  // A lag of order near .7 over four decades is met by no ratio of order 2, and ever better by more.
  const Curve fractional = curve_of(find("fractional-lag"));
  const double second = judging::rational_loss(fractional, 2);
  const double fifth = judging::rational_loss(fractional, 5);
  good &= expect(second > 5 && fifth < 0.1 * second && fifth > 0, "ratios do not approach a fractional lag");
  // Step responses in closed form: 1 - exp(-t), the same after a dead time of 1, 1 - exp(t) erfc(sqrt t), and ringing
  // of 14 rad, near the end of what the inversion reaches.
  const System lag{[](const auto& p, double a, judging::Complex s) {
                     return std::exp(-p[0] * s) / (1.0 + (a == 1 ? s : std::pow(s, a)));
                   },
                   "L",
                   {0}};
  System late = lag;
  late.parameters = {1};
  late.delay = 1;
  System half = lag;
  half.order = 0.5;
  const System ringing{
      [](const auto& p, double, judging::Complex s) { return 1.0 / (1.0 + 2 * p[0] * s + s * s); }, "zeta", {0.05}};
  const System direct{
      [](const auto& p, double, judging::Complex s) { return (p[0] * s + 1.0) / (s + 1.0); }, "d", {0.3}};
  good &= expect(std::abs(judging::step_response(direct, 0) - 0.3) < 1e-8, "step response at its first sample");
  for (const double t : {0.01, 0.7, 3.0, 14.0}) {
    const double damped = std::sqrt(1 - 0.05 * 0.05);
    const double rung = 1 - std::exp(-0.05 * t) * (std::cos(damped * t) + 0.05 / damped * std::sin(damped * t));
    good &= expect(std::abs(judging::step_response(lag, t) + std::expm1(-t)) < 1e-8, "step response of a lag");
    good &= expect(std::abs(judging::step_response(late, t + 1) + std::expm1(-t)) < 1e-8,
                   "step response after a dead time");
    good &= expect(std::abs(judging::step_response(half, t) - 1 + std::exp(t) * std::erfc(std::sqrt(t))) < 1e-8,
                   "step response of a fractional lag");
    good &= expect(std::abs(judging::step_response(ringing, t) - rung) < 1e-8, "step response of an oscillator");
  }
  return good;
}

}  // namespace

int main(int argc, char** argv) {
  const std::vector<std::string> words(argv + 1, argv + argc);
  if (words == std::vector<std::string>{"--smoke"}) return smoke() ? 0 : 1;
  if (words.size() != 3 && !(words.size() == 4 && (words[3] == "time" || words[3] == "smooth"))) {
    std::cerr << "usage: judging_population DIRECTORY SEED REPEATS [time|smooth] | judging_population --smoke\n";
    return 2;
  }
  const std::uint64_t seed = std::strtoull(words[1].c_str(), nullptr, 10);
  const int repeats = std::atoi(words[2].c_str());
  if (words.size() == 3) {
    write_files(words[0], seed, repeats);
  } else if (words[3] == "smooth") {
    write_files(words[0], seed, repeats, draw_smooth_setting);
  } else {
    write_records(words[0], seed, repeats);
  }
  return 0;
}
