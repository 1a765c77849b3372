// SPDX-License-Identifier: BSD-3-Clause
// How often the band and the intervals of relaxation_times() of data hold the density that made the data, which the
// formula gives exactly, and how well they tell the constant.  Prints tables for tools/docs/times_coverage.md.
// Arguments: [seeds] [first seed] | constant [spectra] [first seed]
#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <complex>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <numbers>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "frac/identification/relaxation_times.hpp"
#include "support/validity_cases.hpp"

namespace {

using frac::TimesKernel;
using support::NoiseKind;
using support::Random;

struct Counts {
  int measurements = 0, places = 0, held = 0, tops = 0, held_tops = 0;
  int same_peaks = 0, false_peaks = 0, peaks = 0, held_times = 0, held_areas = 0;
  double seconds = 0;
};

double percent(int part, int whole) {
  return 100.0 * part / std::max(whole, 1);
}

void count(const support::ValidityModel& model, const support::Sweep& sweep, const std::vector<double>& parameters,
           TimesKernel kernel, Counts& counts) {
  const auto data = sweep.data();
  const std::clock_t start = std::clock();
  const auto found = frac::relaxation_times(data, kernel);
  counts.seconds += static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
  ++counts.measurements;
  const auto exact_on = [&](const std::vector<double>& tau) {
    return frac::relaxation_times(frac::Structure(model.formula), parameters, tau, kernel);
  };
  const auto truth = exact_on(found.tau);
  const auto holds = [&](std::size_t i) {
    return found.lower[i] <= truth.density[i] && truth.density[i] <= found.upper[i];
  };
  // Times that the band of frequencies sees; what lies beyond is the prior alone.
  for (std::size_t i = 0; i < found.tau.size(); ++i) {
    if (found.tau[i] < 1 / sweep.omega.back() || found.tau[i] > 1 / sweep.omega.front()) continue;
    ++counts.places;
    counts.held += holds(i);
  }
  ++counts.tops;
  counts.held_tops += holds(
      static_cast<std::size_t>(std::max_element(truth.density.begin(), truth.density.end()) - truth.density.begin()));
  // Peaks of the truth on a fine grid, for the areas within the band as those of data are.
  std::vector<double> fine;
  for (int i = 0; i <= 1000; ++i)
    fine.push_back(std::pow(sweep.omega.front() / sweep.omega.back(), -i / 1000.0) / sweep.omega.back());
  const auto exact = exact_on(fine);
  auto peaks = exact.peaks;
  std::erase_if(peaks, [&](const auto& peak) { return peak.tau <= fine.front() || peak.tau >= fine.back(); });
  for (std::size_t k = 0, from = 0; k < peaks.size(); ++k) {
    const auto index = [&](double tau) {
      return static_cast<std::size_t>(std::lower_bound(fine.begin(), fine.end(), tau) - fine.begin());
    };
    const auto place = [&](std::size_t i) { return exact.density.begin() + static_cast<std::ptrdiff_t>(i); };
    const std::size_t to =
        k + 1 < peaks.size()
            ? static_cast<std::size_t>(std::min_element(place(index(peaks[k].tau)), place(index(peaks[k + 1].tau))) -
                                       exact.density.begin())
            : fine.size() - 1;
    peaks[k].area = 0;
    for (std::size_t i = from; i < to; ++i)
      peaks[k].area += std::log(fine[i + 1] / fine[i]) * (exact.density[i] + exact.density[i + 1]) / 2;
    from = to;
  }
  counts.false_peaks += found.peaks.size() > peaks.size();
  if (found.peaks.size() != peaks.size()) return;
  ++counts.same_peaks;
  for (std::size_t k = 0; k < peaks.size(); ++k) {
    const auto &peak = found.peaks[k], &truth_of_peak = peaks[k];
    ++counts.peaks;
    counts.held_times += peak.tau_lower <= truth_of_peak.tau && truth_of_peak.tau <= peak.tau_upper;
    counts.held_areas += peak.area_lower <= truth_of_peak.area && truth_of_peak.area <= peak.area_upper;
  }
}

struct Arc {
  double resistance, time, order;
};

struct Spectrum {
  double constant = 0, inductance = 0, noise = 0;
  std::vector<Arc> arcs;
  std::vector<double> omega;
  std::vector<std::complex<double>> exact, measured;
};

/// A resistance and one to three arcs anywhere in a band of 1e-2 to 1e5 Hz, ten points per decade, and an inductance
/// that is seen above the resistance in half of them.
Spectrum spectrum(std::uint64_t seed) {
  Random random(seed);
  Spectrum made;
  made.constant = random.log_uniform(0.5, 20);
  made.inductance = random.below(2) == 0 ? 0 : made.constant * random.log_uniform(1e-7, 1e-6);
  made.arcs.resize(1 + random.below(3));
  for (Arc& arc : made.arcs) arc = {random.log_uniform(3, 100), random.log_uniform(3e-6, 10), random.uniform(0.6, 1)};
  made.noise = random.log_uniform(2e-3, 2e-2);
  for (int i = 0; i <= 70; ++i) {
    const std::complex<double> s(0, 2 * std::numbers::pi * std::pow(10, -2 + i / 10.0));
    std::complex<double> z = made.constant + made.inductance * s;
    for (const Arc& arc : made.arcs) z += arc.resistance / (1.0 + std::pow(arc.time * s, arc.order));
    const double real = random.normal(), imaginary = random.normal();
    made.omega.push_back(s.imag());
    made.exact.push_back(z);
    made.measured.push_back(z * (1.0 + made.noise * std::complex<double>(real, imaginary)));
  }
  return made;
}

/// The least standard deviation of the constant that any unbiased estimate from these data can have (Cramer and Rao),
/// for whoever knows the noise, that there may be an inductance, and how many arcs there are.
double least_deviation(const Spectrum& made) {
  const auto count = static_cast<Eigen::Index>(2 + 3 * made.arcs.size());
  Eigen::MatrixXd information = Eigen::MatrixXd::Zero(count, count);
  for (std::size_t i = 0; i < made.omega.size(); ++i) {
    // By the constant, by the inductance in terms that the last point sees as ohms, by ln R, ln T and the order.
    const std::complex<double> s(0, made.omega[i]);
    Eigen::VectorXcd gradient(count);
    gradient.head<2>() << 1.0, s / made.omega.back();
    for (std::size_t k = 0; k < made.arcs.size(); ++k) {
      const auto& [resistance, time, order] = made.arcs[k];
      const auto power = std::pow(time * s, order), arc = resistance / (1.0 + power);
      const auto slope = -arc * power / (1.0 + power);
      gradient.segment<3>(static_cast<Eigen::Index>(2 + 3 * k)) << arc, slope * order, slope * std::log(time * s);
    }
    information += (gradient.conjugate() * gradient.transpose()).real() / std::norm(made.noise * made.exact[i]);
  }
  return std::sqrt(information.ldlt().solve(Eigen::VectorXd::Unit(count, 0))(0));
}

void count_constants(int spectra, int first) {
  int near = 0, below_half = 0, held = 0, excludes_zero = 0, peaks_beyond = 0;
  // Spectra whose arcs have come down to a twentieth of the constant at the end of the band, and the others.
  int ended = 0, near_ended = 0, held_ended = 0;
  double possible = 0, possible_ended = 0, width = 0, width_ended = 0;
  std::vector<double> errors;
  for (int seed = first; seed < first + spectra; ++seed) {
    const Spectrum made = spectrum(static_cast<std::uint64_t>(seed));
    const double truth = made.constant;
    const frac::FrequencyResponseData data(made.omega, made.measured);
    const auto found = frac::relaxation_times(data, TimesKernel::falling);
    errors.push_back(std::abs(found.constant / truth - 1));
    const bool is_near = errors.back() <= 0.05;
    const bool holds = found.constant_lower <= truth && truth <= found.constant_upper;
    const double chance = std::erf(0.05 * truth / (std::sqrt(2.0) * least_deviation(made)));
    const double wide = (found.constant_upper - found.constant_lower) / truth;
    near += is_near;
    below_half += found.constant < 0.5 * truth;
    held += holds;
    possible += chance;
    width += wide;
    excludes_zero += found.constant_lower > 0;
    if (made.exact.back().real() - truth <= 0.05 * truth) {
      ++ended;
      near_ended += is_near;
      held_ended += holds;
      possible_ended += chance;
      width_ended += wide;
    }
    // A maximum beyond the band.
    bool beyond = false;
    for (std::size_t i = 1; i + 1 < found.tau.size(); ++i) {
      const bool outside = found.tau[i] * data.omega().back() < 0.99 || found.tau[i] * data.omega().front() > 1.01;
      beyond =
          beyond || (outside && found.density[i] > found.density[i - 1] && found.density[i] > found.density[i + 1]);
    }
    peaks_beyond += beyond;
  }
  std::sort(errors.begin(), errors.end());
  std::printf(
      "| spectra | within 5 %% | below half | median error | interval holds | lower end above 0 | maximum beyond the "
      "band "
      "|\n|---|---|---|---|---|---|---|\n| %d | %d | %d | %.1f %% | %d | %d | %d |\n\n",
      spectra, near, below_half, 100 * errors[errors.size() / 2], held, excludes_zero, peaks_beyond);
  std::printf("| arcs at the end of the band | spectra | within 5 %% | possible | interval holds | its mean width |\n");
  std::printf("|---|---|---|---|---|---|\n");
  const auto row = [](const char* name, int count, int within, double could, int holding, double wide) {
    std::printf("| %s | %d | %d | %.0f | %d | %.0f %% |\n", name, count, within, could, holding,
                100 * wide / std::max(count, 1));
  };
  row("to 5 % of the constant", ended, near_ended, possible_ended, held_ended, width_ended);
  row("more", spectra - ended, near - near_ended, possible - possible_ended, held - held_ended, width - width_ended);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc > 1 && std::string_view(argv[1]) == "constant") {
    count_constants(argc > 2 ? std::atoi(argv[2]) : 40, argc > 3 ? std::atoi(argv[3]) : 1);
    return 0;
  }
  const int seeds = argc > 1 ? std::atoi(argv[1]) : 20, first = argc > 2 ? std::atoi(argv[2]) : 1;
  const std::vector<std::pair<NoiseKind, const char*>> kinds{{NoiseKind::relative, "relative"},
                                                             {NoiseKind::additive, "additive"}};
  std::printf(
      "| model | noise | measurements | band | band at the maximum | number of peaks right | too many | times | areas "
      "| ms each "
      "|\n"
      "|---|---|---|---|---|---|---|---|---|---|\n");
  Counts all;
  for (const auto& model : support::impedance_models()) {
    // Those with a density that is nowhere negative and without lines.
    const bool modulus = model.name == "modulus (fractional Zener)";
    if (!modulus && model.name != "arc" && model.name != "Havriliak-Negami" && model.name != "two arcs, inductance")
      continue;
    const auto kernel = modulus ? TimesKernel::rising : TimesKernel::falling;
    for (const auto& [kind, name] : kinds) {
      Counts counts;
      for (int seed = first; seed < first + seeds; ++seed) {
        auto [random, noise, per_decade] = support::seeded_measurement(seed, kind);
        // The parameters are the first that sweep() draws.
        Random same = random;
        const auto parameters = model.parameters(same);
        auto sweep = support::sweep(model, per_decade, kind, noise, random);
        support::add_noise(sweep, random);
        count(model, sweep, parameters, kernel, counts);
      }
      std::printf("| %s | %s | %d | %.1f %% | %.0f %% | %.0f %% | %.1f %% | %.0f %% | %.0f %% | %.0f |\n",
                  model.name.c_str(), name, counts.measurements, percent(counts.held, counts.places),
                  percent(counts.held_tops, counts.tops), percent(counts.same_peaks, counts.measurements),
                  percent(counts.false_peaks, counts.measurements), percent(counts.held_times, counts.peaks),
                  percent(counts.held_areas, counts.peaks), 1000 * counts.seconds / counts.measurements);
      std::fflush(stdout);
      all.held += counts.held;
      all.places += counts.places;
    }
  }
  std::printf("\nband, all: %.1f %%\n", percent(all.held, all.places));
}
