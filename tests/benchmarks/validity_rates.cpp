// SPDX-License-Identifier: BSD-3-Clause
// How often `validate` is wrong: alarms on consistent data by model and noise, and detection of stated violations.
// Prints tables for tools/docs/validity_rates.md.  Arguments: [seeds]
// [first seed] [impedances|resonances|further|violations|mains].
#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <complex>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "frac/identification/validate.hpp"
#include "support/validity_cases.hpp"

namespace {

using frac::Validity;
using support::NoiseKind;
using support::Random;
using support::Sweep;

struct Counts {
  int all = 0, valid = 0, suspect = 0, invalid = 0, undecided = 0, reversed = 0;
  double seconds = 0;
  void add(const frac::ValidationResult& result) {
    ++all;
    reversed += result.reversed_sign;
    ++(result.validity == Validity::valid     ? valid
       : result.validity == Validity::suspect ? suspect
       : result.validity == Validity::invalid ? invalid
                                              : undecided);
  }
  [[nodiscard]] double percent(int count) const { return 100.0 * count / all; }
};

void judge(const Sweep& sweep, Counts& counts) {
  const auto data = sweep.data();
  const std::clock_t start = std::clock();
  counts.add(frac::validate(data));
  counts.seconds += static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
}

const std::vector<std::pair<NoiseKind, const char*>> kinds{{NoiseKind::relative, "relative"},
                                                           {NoiseKind::additive, "additive"},
                                                           {NoiseKind::mixed, "mixed"},
                                                           {NoiseKind::towards_low, "rising towards low frequency"}};

void false_alarms(const std::vector<support::ValidityModel>& models, int seeds, int first) {
  std::printf(
      "| model | noise | measurements | suspect | invalid | undecided | false alarms | ms each |\n"
      "|---|---|---|---|---|---|---|---|\n");
  for (const auto& model : models) {
    for (const auto& [kind, name] : kinds) {
      Counts counts;
      for (int seed = first; seed < first + seeds; ++seed) {
        auto [random, noise, per_decade] = support::seeded_measurement(seed, kind);
        Sweep sweep = support::sweep(model,
                                     model.upper / model.lower < 2     ? 60 * per_decade
                                     : model.upper / model.lower < 1e4 ? 3 * per_decade
                                                                       : per_decade,
                                     kind, noise, random);
        support::add_noise(sweep, random);
        judge(sweep, counts);
      }
      std::printf("| %s | %s | %d | %d | %d | %d | %.1f %% | %.1f |\n", model.name.c_str(), name, counts.all,
                  counts.suspect, counts.invalid, counts.undecided, counts.percent(counts.suspect + counts.invalid),
                  1e3 * counts.seconds / counts.all);
      std::fflush(stdout);
    }
  }
}

using Violation = std::function<void(Sweep&, Random&)>;

void scale_above(Sweep& sweep, double share) {
  for (std::size_t i = sweep.exact.size() / 2; i < sweep.exact.size(); ++i) sweep.exact[i] *= 1 + share;
}

// An element that answers to the size of its own response, at constant amplitude of the input.
void amplitude_dependence(Sweep& sweep, double share) {
  double largest = 0;
  for (const auto& each : sweep.exact) largest = std::max(largest, std::abs(each));
  for (auto& each : sweep.exact) each *= 1 - share * std::norm(each) / (largest * largest);
}

void push_out(Sweep& sweep, std::size_t point, double deviations, Random& random) {
  sweep.exact[point] += std::polar(deviations * sweep.deviation[point], random.uniform(0, 6.2832));
}

void mains(Sweep& sweep, double deviations, Random& random, const std::vector<double>& harmonics = {1, 3}) {
  for (std::size_t i = 0; i < sweep.omega.size(); ++i) {
    const double multiple = sweep.omega[i] / (2 * 3.14159265358979 * 50);
    for (const double harmonic : harmonics)
      if (std::abs(multiple / harmonic - 1) < 0.02) push_out(sweep, i, deviations, random);
  }
}

using Columns = std::vector<std::vector<std::complex<double>>>;

Eigen::VectorXd weighted(const Sweep& sweep, const std::vector<std::complex<double>>& column) {
  Eigen::VectorXd rows(2 * static_cast<Eigen::Index>(column.size()));
  for (std::size_t k = 0; k < column.size(); ++k) {
    const auto at = 2 * static_cast<Eigen::Index>(k);
    rows(at) = column[k].real() / sweep.deviation[k];
    rows(at + 1) = column[k].imag() / sweep.deviation[k];
  }
  return rows;
}

// Power of the two-sided test at 5 % that knows the noise, the shape of the change and that the response without it may
// move by any sum of the columns: none does better.  The change in units of its standard deviation is normal.
double best_power(const Sweep& sweep, const std::vector<std::complex<double>>& change, const Columns& columns) {
  Eigen::MatrixXd tangent(2 * static_cast<Eigen::Index>(change.size()), static_cast<Eigen::Index>(columns.size()));
  for (std::size_t j = 0; j < columns.size(); ++j)
    tangent.col(static_cast<Eigen::Index>(j)) = weighted(sweep, columns[j]).normalized();
  const Eigen::ColPivHouseholderQR<Eigen::MatrixXd> factor(tangent);
  const Eigen::VectorXd turned = factor.householderQ().adjoint() * weighted(sweep, change);
  const double size = turned.tail(turned.size() - factor.rank()).norm();
  constexpr double limit = 1.959964;
  const auto above = [](double x) { return std::erfc(x / std::sqrt(2.0)) / 2; };
  return above(limit - size) + above(limit + size);
}

// How the response of a formula moves with its parameters.
Columns moves_of(const frac::Structure& structure, const std::vector<double>& parameters, const Sweep& sweep) {
  Columns columns;
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    auto up = parameters, down = parameters;
    constexpr double share = 1e-5;
    up[i] *= 1 + share;
    down[i] *= 1 - share;
    auto& column = columns.emplace_back();
    for (const double omega : sweep.omega)
      column.push_back(structure.response(up, omega) - structure.response(down, omega));
  }
  return columns;
}

// A formula that nobody knows: three real poles in each decade, a decade beyond the band on either side.
Columns sums_of_poles(const Sweep& sweep) {
  using namespace std::complex_literals;
  Columns columns(3);
  for (const double omega : sweep.omega) {
    columns[0].emplace_back(1);
    columns[1].push_back(1i * omega);
    columns[2].push_back(1.0 / (1i * omega));
  }
  for (double corner = sweep.omega.front() / 10; corner < sweep.omega.back() * 10; corner *= std::cbrt(10.0)) {
    auto& column = columns.emplace_back();
    for (const double omega : sweep.omega) column.push_back(1.0 / (1.0 + 1i * omega / corner));
  }
  return columns;
}

void detections(int seeds, int first) {
  const std::vector<std::pair<std::string, Violation>> violations{
      {"drift 1 %, points of equal time", [](Sweep& s, Random&) { support::drift(s, 0.01, false); }},
      {"drift 3 %, points of equal time", [](Sweep& s, Random&) { support::drift(s, 0.03, false); }},
      {"drift 10 %, points of equal time", [](Sweep& s, Random&) { support::drift(s, 0.1, false); }},
      {"drift 1 %, points of equal periods", [](Sweep& s, Random&) { support::drift(s, 0.01, true); }},
      {"drift 3 %, points of equal periods", [](Sweep& s, Random&) { support::drift(s, 0.03, true); }},
      {"drift 10 %, points of equal periods", [](Sweep& s, Random&) { support::drift(s, 0.1, true); }},
      {"step of 1 % in mid-band", [](Sweep& s, Random&) { scale_above(s, 0.01); }},
      {"step of 3 % in mid-band", [](Sweep& s, Random&) { scale_above(s, 0.03); }},
      {"step of 10 % in mid-band", [](Sweep& s, Random&) { scale_above(s, 0.1); }},
      {"amplitude dependence 10 %", [](Sweep& s, Random&) { amplitude_dependence(s, 0.1); }},
      {"amplitude dependence 30 %", [](Sweep& s, Random&) { amplitude_dependence(s, 0.3); }},
      {"one point 6 deviations off", [](Sweep& s, Random& r) { push_out(s, 3 + r.below(s.exact.size() - 6), 6, r); }},
      {"one point 10 deviations off", [](Sweep& s, Random& r) { push_out(s, 3 + r.below(s.exact.size() - 6), 10, r); }},
      {"three points 10 deviations off",
       [](Sweep& s, Random& r) {
         for (int i = 0; i < 3; ++i) push_out(s, 3 + r.below(s.exact.size() - 6), 10, r);
       }},
      {"50 and 150 Hz 4 deviations off", [](Sweep& s, Random& r) { mains(s, 4, r); }},
      {"50 and 150 Hz 8 deviations off", [](Sweep& s, Random& r) { mains(s, 8, r); }},
      {"phase reversed",
       [](Sweep& s, Random&) {
         for (auto& each : s.exact) each = std::conj(each);
       }},
  };
  const auto& models = support::impedance_models();
  std::printf(
      "| violation | noise | measurements | valid | suspect | invalid | undecided | sign | found | best, poles | best, "
      "formula "
      "|\n|---|---|---|---|---|---|---|---|---|---|---|\n");
  for (const auto& [name, violate] : violations) {
    for (const double noise : {0.001, 0.003, 0.01}) {
      Counts counts;
      double by_poles = 0, by_formula = 0;
      for (int seed = first; seed < first + seeds; ++seed) {
        Random random(static_cast<std::uint64_t>(seed) * 7000003 + 17);
        const auto& model = models[random.below(6)];
        // The parameters are the first that sweep() draws.
        Random same = random;
        const std::vector<double> parameters = model.parameters(same);
        // Ten points per decade from 0.01 Hz meet 50.1 Hz.
        Sweep sweep = support::sweep(model, 10, NoiseKind::relative, noise, random);
        std::vector<std::complex<double>> change = sweep.exact;
        violate(sweep, random);
        for (std::size_t k = 0; k < change.size(); ++k) change[k] = sweep.exact[k] - change[k];
        by_poles += best_power(sweep, change, sums_of_poles(sweep));
        by_formula += best_power(sweep, change, moves_of(frac::Structure(model.formula), parameters, sweep));
        support::add_noise(sweep, random);
        judge(sweep, counts);
      }
      std::printf("| %s | %.1f %% | %d | %d | %d | %d | %d | %d | %.0f %% | %.0f %% | %.0f %% |\n", name.c_str(),
                  100 * noise, counts.all, counts.valid, counts.suspect, counts.invalid, counts.undecided,
                  counts.reversed, counts.percent(counts.suspect + counts.invalid), 100 * by_poles / counts.all,
                  100 * by_formula / counts.all);
      std::fflush(stdout);
    }
  }
}

// What becomes of lines of the mains of each size, and what is taken for them where there are none.
void lines_of_mains(int seeds, int first) {
  const std::vector<std::pair<std::string, std::vector<double>>> lines{{"50 Hz", {1}}, {"50 and 150 Hz", {1, 3}}};
  std::printf(
      "| lines | deviations off | measurements | named | only outliers | invalid | undecided | valid | other mains "
      "named "
      "| best, poles |\n|---|---|---|---|---|---|---|---|---|---|\n");
  for (const auto& [name, harmonics] : lines) {
    for (const double deviations : {0.0, 2.0, 3.0, 4.0, 5.0, 6.0, 8.0, 12.0}) {
      if (deviations == 0 && harmonics.size() > 1) continue;
      Counts counts;
      int named = 0, other = 0, outliers = 0;
      double best = 0;
      for (int seed = first; seed < first + seeds; ++seed) {
        Random random(static_cast<std::uint64_t>(seed) * 7000003 + 29);
        const auto& model = support::impedance_models()[random.below(6)];
        const double noise = std::vector{0.001, 0.003, 0.01}[random.below(3)];
        // Forty points per decade from 0.01 Hz meet 50.1 and 149.6 Hz.
        Sweep sweep = support::sweep(model, 40, NoiseKind::relative, noise, random);
        std::vector<std::complex<double>> change = sweep.exact;
        mains(sweep, deviations, random, harmonics);
        for (std::size_t k = 0; k < change.size(); ++k) change[k] = sweep.exact[k] - change[k];
        if (deviations > 0) best += best_power(sweep, change, sums_of_poles(sweep));
        support::add_noise(sweep, random);
        const frac::ValidationResult result = frac::validate(sweep.data());
        counts.add(result);
        const auto alarmed = [&](frac::ValidityTest test) {
          return std::ranges::any_of(result.findings,
                                     [&](const auto& each) { return each.test == test && each.alarm; });
        };
        const bool is_named = alarmed(frac::ValidityTest::mains_50);
        named += is_named;
        other += alarmed(frac::ValidityTest::mains_60);
        outliers += !is_named && result.validity == Validity::suspect;
      }
      std::printf("| %s | %g | %d | %.1f %% | %.1f %% | %.1f %% | %.1f %% | %.1f %% | %.1f %% | %.0f %% |\n",
                  deviations == 0 ? "none" : name.c_str(), deviations, counts.all, counts.percent(named),
                  counts.percent(outliers), counts.percent(counts.invalid), counts.percent(counts.undecided),
                  counts.percent(counts.valid), counts.percent(other), 100 * best / counts.all);
      std::fflush(stdout);
    }
  }
}

}  // namespace

int main(int argc, char** argv) {
  const int seeds = argc > 1 ? std::atoi(argv[1]) : 1000;
  const int first = argc > 2 ? std::atoi(argv[2]) : 1;
  const std::string only = argc > 3 ? argv[3] : "";
  std::printf("%s, GCC %s, seeds %d to %d\n", FRACFIT_BUILD_TYPE, __VERSION__, first, first + seeds - 1);
  if (only.empty() || only == "impedances") {
    std::printf("\n## False alarms: impedances and moduli\n\n");
    false_alarms(support::impedance_models(), seeds, first);
  }
  if (only.empty() || only == "resonances") {
    std::printf("\n## False alarms: transfer functions with complex poles or delay\n\n");
    false_alarms(support::resonant_models(), seeds, first);
  }
  if (only.empty() || only == "further") {
    std::printf("\n## False alarms: responses that the test was not made from\n\n");
    false_alarms(support::further_models(), seeds, first);
  }
  if (only.empty() || only == "violations") {
    std::printf("\n## Detection\n\n");
    detections(seeds, first);
  }
  if (only.empty() || only == "mains") {
    std::printf("\n## Lines of the mains\n\n");
    lines_of_mains(seeds, first);
  }
}
