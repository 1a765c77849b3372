// SPDX-License-Identifier: BSD-3-Clause
// How often the 95 % intervals of response() hold the exact response, for each disturbance and number of periods, over
// seeds that nothing was tuned on, beside the mean over periods with its scatter; then errors of a random input beside
// those of windowed H1.  Prints the tables of tools/docs/methods/response.md.  Arguments: [seeds] [first seed] [part of
// the name of a record, such as stepped: these alone]
#include <algorithm>
#include <cmath>
#include <complex>
#include <cstdio>
#include <cstdlib>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "support/simulated_records.hpp"

namespace {

using Complex = std::complex<double>;
using std::numbers::pi;

/// The usual estimate of a periodic record (Pintelon, Schoukens 2012, chapter 2; FdiTools' time2frf_ml): the mean of
/// the lines over periods, and the deviation of each part from their (co)variances.
class MeanOverPeriods {
 public:
  void count(const frac::Record& record, std::size_t periods) {
    constexpr std::size_t length = 128, lines = 40;
    const auto number = static_cast<double>(periods);
    const support::ResonantFilter filter;
    std::vector<Complex> turns;
    for (std::size_t i = 0; i < length; ++i)
      turns.push_back(std::polar(1.0, -2 * pi * static_cast<double>(i) / length));
    for (std::size_t k = 1; k <= lines; ++k) {
      std::vector<Complex> of_input(periods), of_output(periods);
      Complex input = 0, output = 0;
      for (std::size_t p = 0; p < periods; ++p) {
        for (std::size_t i = 0; i < length; ++i) {
          const Complex turn = turns[k * i % length];
          of_input[p] += record.input()[p * length + i] * turn;
          of_output[p] += record.outputs()[0][p * length + i] * turn;
        }
        input += of_input[p] / number;
        output += of_output[p] / number;
      }
      const Complex value = output / input;
      double squares = 0;
      for (std::size_t p = 0; p < periods; ++p)
        squares += std::norm(of_output[p] - output - value * (of_input[p] - input)) / std::norm(input);
      const double deviation = std::sqrt(squares / (2 * number * (number - 1)));
      const Complex error = value - filter.response(static_cast<double>(k) / length);
      held_ +=
          (std::abs(error.real()) <= 1.96 * deviation ? 1 : 0) + (std::abs(error.imag()) <= 1.96 * deviation ? 1 : 0);
      squares_ += std::norm(error);
      whole_ += 2;
    }
  }
  [[nodiscard]] double percent() const { return 100.0 * held_ / whole_; }
  [[nodiscard]] double rms() const { return std::sqrt(squares_ / whole_); }

 private:
  int held_ = 0, whole_ = 0;
  double squares_ = 0;
};

double quantile(std::vector<double> values, double share) {
  std::sort(values.begin(), values.end());
  return values[static_cast<std::size_t>(share * static_cast<double>(values.size() - 1))];
}

/// Root mean square error over all lines of 1024 samples that begin at rest, over that of windowed H1: resonances of
/// damping 2 to 5 % at 0.02 to 0.2 of the sampling rate.
double error_beside_windowed(std::mt19937_64& generator, double noise) {
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> unit(0, 1);
  support::ResonantFilter filter(0.02 + 0.03 * unit(generator), 0.02 * std::pow(10, unit(generator)));
  std::vector<double> input, output;
  for (int i = 0; i < 1024; ++i) {
    input.push_back(normal(generator));
    output.push_back(filter.step(input.back()));
  }
  double power = 0;
  for (const double each : output) power += each * each / 1024;
  for (double& each : output) each += noise * std::sqrt(power) * normal(generator);
  frac::ResponseOptions options;
  options.excitation = frac::Excitation::arbitrary;
  double local = 0, windowed = 0;
  const auto found = frac::response({frac::Record(1, input, {output})}, options);
  for (const auto& point : found.outputs[0]) {
    const Complex exact = filter.response(point.omega / (2 * pi));
    local += std::norm(point.value - exact);
    windowed += std::norm(point.windowed - exact);
  }
  return std::sqrt(local / windowed);
}

}  // namespace

int main(int count, char** arguments) {
  const bool smoke = count > 1 && std::string(arguments[1]) == "--smoke";
  const int seeds = smoke ? 2 : count > 1 ? std::atoi(arguments[1]) : 200;
  const int first = count > 2 && !smoke ? std::atoi(arguments[2]) : 1000;
  const std::string part = count > 3 ? arguments[3] : "";
  std::printf(
      "| record | periods | intervals | hold %% | of the worst line %% | rms error / sigma | flagged | recognised %% "
      "| mean over periods: hold %% | its rms error / ours |\n|---|---|---|---|---|---|---|---|---|---|\n");
  for (const auto which : support::record_cases) {
    if (name_of(which).find(part) == std::string_view::npos) continue;
    for (const int periods : {2, 3, 5, 8, 10, 20}) {
      if (periods == 8 && !support::is_stepped(which)) continue;
      if (support::is_random(which) && periods < 5) continue;
      // Edges of segments are left out: of fewer cycles too few remain.
      if (support::is_stepped(which) && periods < 8) continue;
      support::RecordCoverage coverage;
      MeanOverPeriods mean;
      const bool is_periodic = !support::is_stepped(which) && !support::is_random(which);
      for (int seed = first; seed < first + seeds; ++seed) {
        std::mt19937_64 generator(static_cast<unsigned>(seed));
        coverage.count(which, static_cast<std::size_t>(periods), generator);
        if (!is_periodic) continue;
        generator.seed(static_cast<unsigned>(seed));
        const auto count_of = static_cast<std::size_t>(periods);
        mean.count(support::simulated_record(which, count_of, generator), count_of);
      }
      std::printf("| %s | %d | %d | %.1f | %.1f | %.3f | %d | %.1f |", std::string(name_of(which)).c_str(), periods,
                  coverage.whole, coverage.percent(), coverage.percent_of_worst_line(),
                  std::sqrt(coverage.squares * 2 / std::max(coverage.whole, 1)), coverage.flagged,
                  100.0 * coverage.recognised / coverage.records);
      if (is_periodic)
        std::printf(" %.1f | %.2f |\n", mean.percent(), mean.rms() / std::sqrt(coverage.errors / coverage.whole));
      else
        std::printf("  |  |\n");
      std::fflush(stdout);
    }
  }
  if (!part.empty()) return 0;
  std::printf(
      "\n| noise / output | records | error / that of H1, median | 90 %% | largest | at most a tenth |\n"
      "|---|---|---|---|---|---|\n");
  for (const double noise : {0.0, 0.01, 0.1}) {
    std::vector<double> ratios;
    for (int seed = first; seed < first + seeds; ++seed) {
      std::mt19937_64 generator(static_cast<unsigned>(seed));
      ratios.push_back(error_beside_windowed(generator, noise));
    }
    const auto below = std::count_if(ratios.begin(), ratios.end(), [](double each) { return each <= 0.1; });
    std::printf("| %g | %d | %.3f | %.3f | %.3f | %.1f %% |\n", noise, seeds, quantile(ratios, 0.5),
                quantile(ratios, 0.9), quantile(ratios, 1), 100.0 * static_cast<double>(below) / seeds);
  }
}
