// SPDX-License-Identifier: BSD-3-Clause
// How often `identify` answers rightly, on seeded populations of systems whose kind is known.
//
//   verdict_rates [--systems N] [--seed S] [--noise LIST] [--points LIST] [--decades LIST] [--component LIST]
//   verdict_rates --directory DIR [--component PART]
//
// Prints one row per cell: how many files, and how many of them were called supported (with fractional-or-distribution),
// not-supported, undecided and no-adequate-model.  "false supported" counts integer-order systems called supported,
// "false not-supported" fractional ones called not-supported.  A directory holds CSV files (omega_rad_s,re,im) and
// truth.csv with the columns file,kind; kind is fractional or integer.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <complex>
#include <cstdint>
#include <cstdio>
#include <fstream>
#include <map>
#include <random>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "frac/identification/identify.hpp"
#include "frac/parallel_for.hpp"
#include "frac/structure.hpp"

namespace {

/// A system of the population: formula with parameters drawn around the middle of the band, at omega = 1 rad/s.
struct Kind {
  const char* name;
  bool fractional;
  std::string (*formula)(std::mt19937_64& generator, double decades);
};

double uniform(std::mt19937_64& generator, double lower, double upper) {
  return lower + (upper - lower) * static_cast<double>(generator() >> 11) * 0x1p-53;
}
/// Somewhere in the inner two thirds of the band.
double place(std::mt19937_64& generator, double decades) {
  return std::pow(10.0, uniform(generator, -decades / 3, decades / 3));
}
double gain(std::mt19937_64& generator) {
  return std::pow(10.0, uniform(generator, -0.5, 0.5));
}
std::string text(double value) {
  char buffer[32];
  std::snprintf(buffer, sizeof buffer, "%.6g", value);
  return buffer;
}
std::string lag(std::mt19937_64& g, double decades) {
  return "(s/" + text(place(g, decades)) + " + 1)";
}
std::string pair(std::mt19937_64& g, double decades, double low, double high) {
  const double w = place(g, decades);
  return "(s^2/" + text(w * w) + " + " + text(2 * uniform(g, low, high) / w) + " s + 1)";
}
std::string arc(std::mt19937_64& g, double decades, double order) {
  return text(gain(g)) + "/(" + text(std::pow(place(g, decades), -order)) + " s^" + text(order) + " + 1)";
}
double order(std::mt19937_64& g) {
  return uniform(g, 0.4, 0.85);
}

using G = std::mt19937_64;
const std::vector<Kind> kinds = {
    {"lag", false, [](G& g, double d) { return text(gain(g)) + "/" + lag(g, d); }},
    {"two lags", false, [](G& g, double d) { return text(gain(g)) + "/(" + lag(g, d) + lag(g, d) + ")"; }},
    {"three lags", false,
     [](G& g, double d) { return text(gain(g)) + "/(" + lag(g, d) + lag(g, d) + lag(g, d) + ")"; }},
    {"four lags", false,
     [](G& g, double d) { return text(gain(g)) + "/(" + lag(g, d) + lag(g, d) + lag(g, d) + lag(g, d) + ")"; }},
    {"lead-lag", false, [](G& g, double d) { return text(gain(g)) + lag(g, d) + "/(" + lag(g, d) + lag(g, d) + ")"; }},
    {"oscillator", false, [](G& g, double d) { return text(gain(g)) + "/" + pair(g, d, 0.02, 0.6); }},
    {"two oscillators", false,
     [](G& g, double d) {
       return text(gain(g)) + "/" + pair(g, d, 0.02, 0.6) + " + " + text(gain(g)) + "/" + pair(g, d, 0.02, 0.6);
     }},
    {"lag and delay", false,
     [](G& g, double d) {
       return text(gain(g)) + " exp(-" + text(uniform(g, 0.2, 2) * std::pow(10.0, -d / 2)) + " s)/" + lag(g, d);
     }},
    {"two lags and delay", false,
     [](G& g, double d) {
       return text(gain(g)) + " exp(-" + text(uniform(g, 0.2, 2) * std::pow(10.0, -d / 2)) + " s)/(" + lag(g, d) +
              lag(g, d) + ")";
     }},
    {"integrator and lag", false, [](G& g, double d) { return text(gain(g)) + "/(s " + lag(g, d) + ")"; }},
    {"two RC arcs", false,
     [](G& g, double d) { return text(0.3 * gain(g)) + " + " + arc(g, d, 1) + " + " + arc(g, d, 1); }},
    {"three RC arcs", false,
     [](G& g, double d) {
       return text(0.3 * gain(g)) + " + " + arc(g, d, 1) + " + " + arc(g, d, 1) + " + " + arc(g, d, 1);
     }},
    {"four RC arcs", false,
     [](G& g, double d) {
       return text(0.3 * gain(g)) + " + " + arc(g, d, 1) + " + " + arc(g, d, 1) + " + " + arc(g, d, 1) + " + " +
              arc(g, d, 1);
     }},
    {"RLC", false,
     [](G& g, double d) {
       return text(0.3 * gain(g)) + " + " + text(0.1 * std::pow(10.0, -d / 3)) + " s + " + arc(g, d, 1) + " + " +
              text(gain(g)) + "/s";
     }},
    {"power law", true, [](G& g, double) { return text(gain(g)) + " s^(-" + text(order(g)) + ")"; }},
    {"fractional lag", true, [](G& g, double d) { return arc(g, d, order(g)); }},
    {"fractional lag and delay", true,
     [](G& g, double d) {
       return "exp(-" + text(uniform(g, 0.2, 1) * std::pow(10.0, -d / 2)) + " s) * " + arc(g, d, order(g));
     }},
    {"fractional oscillator", true,
     [](G& g, double d) {
       const double w = place(g, d / 2), a = uniform(g, 1.3, 1.75);
       return text(gain(g)) + "/(" + text(std::pow(w, -a)) + " s^" + text(a) + " + " +
              text(uniform(g, 0.3, 1.5) * std::pow(w, -0.5)) + " s^0.5 + 1)";
     }},
    {"zarc", true, [](G& g, double d) { return text(0.3 * gain(g)) + " + " + arc(g, d, order(g)); }},
    {"two zarcs", true,
     [](G& g, double d) { return text(0.3 * gain(g)) + " + " + arc(g, d, order(g)) + " + " + arc(g, d, order(g)); }},
    {"arc and Warburg", true,
     [](G& g, double d) {
       return text(0.3 * gain(g)) + " + " + arc(g, d, uniform(g, 0.7, 0.9)) + " + " + text(0.3 * gain(g)) + " s^(-0.5)";
     }},
    {"Havriliak-Negami", true,
     [](G& g, double d) {
       return text(gain(g)) + "/(1 + (" + text(1 / place(g, d)) + " s)^" + text(uniform(g, 0.5, 0.9)) + ")^" +
              text(uniform(g, 0.5, 0.9));
     }},
    {"fractional solid", true,
     [](G& g, double d) {
       const double a = order(g), t = std::pow(place(g, d), -a);
       return text(gain(g)) + " + " + text(3 * gain(g)) + " * " + text(t) + " s^" + text(a) + "/(1 + " + text(t) +
              " s^" + text(a) + ")";
     }},
    {"finite Warburg", true,
     [](G& g, double d) {
       const double t = 1 / place(g, d);
       return text(0.3 * gain(g)) + " + " + text(gain(g)) + " * tanh(sqrt(" + text(t) + " s))/sqrt(" + text(t) + " s)";
     }},
};

struct Counts {
  int files = 0, supported = 0, not_supported = 0, undecided = 0, inadequate = 0, failed = 0;
  double seconds = 0;
  void add(frac::Verdict verdict) {
    ++files;
    supported += frac::refuses_whole_orders(verdict);
    not_supported += verdict == frac::Verdict::fractional_not_supported;
    undecided += verdict == frac::Verdict::undecided;
    inadequate += verdict == frac::Verdict::no_adequate_model;
  }
};

struct Case {
  std::string cell, name;
  bool fractional;
  frac::FrequencyResponseData data;
  frac::Component component;
};

std::vector<double> numbers(const std::string& list) {
  std::vector<double> result;
  std::istringstream in(list);
  for (std::string word; std::getline(in, word, ',');) result.push_back(std::stod(word));
  return result;
}

frac::FrequencyResponseData read_csv(const std::string& path) {
  std::ifstream in(path);
  if (!in) throw std::runtime_error("cannot read " + path);
  std::vector<double> omega;
  std::vector<std::complex<double>> value;
  for (std::string line; std::getline(in, line);) {
    std::replace(line.begin(), line.end(), ',', ' ');
    std::istringstream fields(line);
    double w = 0, re = 0, im = 0;
    if (!(fields >> w >> re >> im)) continue;
    omega.push_back(w);
    value.emplace_back(re, im);
  }
  return {omega, value};
}

std::vector<Case> from_directory(const std::string& directory, frac::Component component) {
  std::ifstream truth(directory + "/truth.csv");
  if (!truth) throw std::runtime_error("cannot read " + directory + "/truth.csv");
  std::vector<Case> cases;
  for (std::string line; std::getline(truth, line);) {
    const auto comma = line.find(',');
    if (comma == std::string::npos || line.starts_with("file,")) continue;
    const std::string file = line.substr(0, comma),
                      kind = line.substr(comma + 1, line.find(',', comma + 1) - comma - 1);
    cases.push_back({directory, file, kind == "fractional", read_csv(directory + "/" + file), component});
  }
  return cases;
}

std::vector<Case> population(int systems, std::uint64_t seed, const std::vector<double>& noises,
                             const std::vector<double>& points, const std::vector<double>& decades,
                             const std::vector<frac::Component>& components) {
  std::vector<Case> cases;
  for (const frac::Component component : components) {
    for (const double noise : noises) {
      for (const double count : points) {
        for (const double band : decades) {
          char cell[96];
          std::snprintf(cell, sizeof cell, "%s,%g,%g,%g", std::string(frac::to_string(component)).c_str(), noise, count,
                        band);
          for (std::size_t k = 0; k < kinds.size(); ++k) {
            for (int repeat = 0; repeat < systems; ++repeat) {
              std::mt19937_64 generator(seed * 1000003 + k * 1009 + static_cast<std::uint64_t>(repeat));
              for (int i = 0; i < 10; ++i) generator();
              const frac::Structure structure(kinds[k].formula(generator, band));
              std::normal_distribution<double> normal(0, 1);
              std::vector<double> omega;
              std::vector<std::complex<double>> value;
              for (int i = 0; i < static_cast<int>(count); ++i) {
                omega.push_back(std::pow(10.0, band * (i / (count - 1) - 0.5)));
                const auto exact = structure.response({}, omega.back());
                const double re = normal(generator), im = normal(generator);
                value.push_back(exact + noise * std::abs(exact) * std::complex<double>(re, im));
              }
              cases.push_back({cell,
                               std::string(kinds[k].name) + ": " + structure.formula(),
                               kinds[k].fractional,
                               {omega, value},
                               component});
            }
          }
        }
      }
    }
  }
  return cases;
}

}  // namespace

int main(int argc, char** argv) {
  std::map<std::string, std::string> given{
      {"--systems", "1"},  {"--seed", "1"},    {"--noise", "0,0.001,0.01,0.03,0.1"},
      {"--points", "60"},  {"--decades", "4"}, {"--component", "both"},
      {"--directory", ""}, {"--threads", "0"}, {"--verbose", "0"}};
  for (int i = 1; i + 1 < argc; i += 2) {
    if (!given.count(argv[i])) {
      std::fprintf(stderr, "unknown option %s\n", argv[i]);
      return 2;
    }
    given[argv[i]] = argv[i + 1];
  }
  std::vector<frac::Component> components;
  std::istringstream parts(given["--component"]);
  for (std::string word; std::getline(parts, word, ',');) components.push_back(frac::component_from_string(word));
  const std::vector<Case> cases =
      given["--directory"].empty()
          ? population(std::stoi(given["--systems"]), std::stoull(given["--seed"]), numbers(given["--noise"]),
                       numbers(given["--points"]), numbers(given["--decades"]), components)
          : from_directory(given["--directory"], components.front());

  struct Answer {
    frac::Verdict verdict = frac::Verdict::undecided;
    std::string sentence;
    double seconds = 0;
    bool failed = false;
  };
  std::vector<Answer> answers(cases.size());
  const std::vector<frac::NamedModel> candidates = frac::default_candidates();
  frac::parallel_for(cases.size(), std::stoi(given["--threads"]), [&](std::size_t i) {
    frac::FitOptions options;
    options.component = cases[i].component;
    options.weight = frac::Weight::relative;
    const auto begin = std::chrono::steady_clock::now();
    try {
      const auto result = frac::identify(cases[i].data, candidates, {}, options, 1);
      answers[i].verdict = result.verdict;
      answers[i].sentence = result.verdict_sentence;
    } catch (const std::exception& error) {
      answers[i].failed = true;
      answers[i].sentence = error.what();
    }
    answers[i].seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  });

  std::map<std::string, std::pair<Counts, Counts>> cells;  // integer, fractional
  Counts all_integer, all_fractional;
  for (std::size_t i = 0; i < cases.size(); ++i) {
    auto& [integer, fractional] = cells[cases[i].cell];
    for (Counts* counts :
         {cases[i].fractional ? &fractional : &integer, cases[i].fractional ? &all_fractional : &all_integer}) {
      counts->seconds += answers[i].seconds;
      if (answers[i].failed) {
        ++counts->files;
        ++counts->failed;
      } else {
        counts->add(answers[i].verdict);
      }
    }
    const bool refused = frac::refuses_whole_orders(answers[i].verdict),
               kept = answers[i].verdict == frac::Verdict::fractional_not_supported;
    const bool wrong = cases[i].fractional ? kept : refused;
    const bool decided = kept || refused;
    if (given["--verbose"] == "2" || (given["--verbose"] == "1" && (!decided || wrong || answers[i].failed)))
      std::fprintf(stderr, "%s %s | %s | %s\n",
                   wrong     ? "WRONG"
                   : decided ? "right"
                             : "open ",
                   cases[i].cell.c_str(), cases[i].name.c_str(), answers[i].sentence.c_str());
  }
  std::printf(
      "component,noise,points,decades,kind,files,supported,not_supported,undecided,no_adequate_model,failed,false_"
      "percent,seconds_per_file\n");
  const auto row = [](const std::string& cell, const char* kind, const Counts& counts, int wrong) {
    std::printf("%s,%s,%d,%d,%d,%d,%d,%d,%.1f,%.3f\n", cell.c_str(), kind, counts.files, counts.supported,
                counts.not_supported, counts.undecided, counts.inadequate, counts.failed,
                counts.files > 0 ? 100.0 * wrong / counts.files : 0.0,
                counts.files > 0 ? counts.seconds / counts.files : 0.0);
  };
  for (const auto& [cell, counts] : cells) {
    row(cell, "integer", counts.first, counts.first.supported);
    row(cell, "fractional", counts.second, counts.second.not_supported);
  }
  row("all,,,", "integer", all_integer, all_integer.supported);
  row("all,,,", "fractional", all_fractional, all_fractional.not_supported);
}
