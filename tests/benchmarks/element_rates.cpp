// SPDX-License-Identifier: BSD-3-Clause
// How often sums of passive elements that grew from noisy responses of circuits drawn at random have the elements of
// the circuit.  Prints a table of tools/docs/methods/elements.md.  Arguments: [circuits] [seed]
#include <algorithm>
#include <cmath>
#include <complex>
#include <cstdio>
#include <cstdlib>
#include <iterator>
#include <random>
#include <set>
#include <string>
#include <vector>

#include "frac/identification/model_choice.hpp"
#include "support/random_circuit.hpp"

namespace {

using Complex = std::complex<double>;
using Kinds = std::multiset<std::string>;

std::size_t only_in_first(const Kinds& first, const Kinds& second) {
  std::vector<std::string> difference;
  std::set_difference(first.begin(), first.end(), second.begin(), second.end(), std::back_inserter(difference));
  return difference.size();
}

class Tally {
 public:
  void count(const support::Circuit& circuit, double noise, std::mt19937_64& generator) {
    constexpr int points = 60;
    const frac::Structure truth(circuit.formula);
    std::normal_distribution<double> normal(0, noise);
    std::vector<double> omega;
    std::vector<Complex> value;
    double cost_of_truth = 0;
    for (int i = 0; i < points; ++i) {
      omega.push_back(1e-2 * std::pow(1e7, i / (points - 1.0)));
      const Complex exact = truth.response({}, omega.back());
      const double real = normal(generator), imaginary = normal(generator);
      value.push_back(exact + std::abs(exact) * Complex(real, imaginary));
      cost_of_truth += std::norm((value.back() - exact) / std::abs(value.back()));
    }
    frac::FitOptions options;
    options.component = frac::Component::both;
    options.weight = frac::Weight::relative;
    const frac::Growth growth =
        frac::grow(frac::FrequencyResponseData(omega, value), frac::GrowthFamily::elements, options);
    const Kinds kinds = support::kinds_in(growth.models.at(growth.chosen));
    const std::size_t wrong = std::max(only_in_first(kinds, circuit.kinds), only_in_first(circuit.kinds, kinds));
    // A part in a thousand is left to where searches end.
    const bool above = growth.fits.at(growth.chosen).cost > 1.001 * cost_of_truth;
    ++circuits_;
    right_ += wrong == 0 ? 1 : 0;
    elements_ += circuit.kinds.size();
    wrong_ += wrong;
    above_ += above ? 1 : 0;
    wrong_below_ += wrong > 0 && !above ? 1 : 0;
  }
  void print(double noise) const {
    std::printf("| %g %% | %d | %d | %zu | %zu | %d | %d |\n", 100 * noise, circuits_, right_, elements_, wrong_,
                above_, wrong_below_);
    std::fflush(stdout);
  }

 private:
  int circuits_ = 0, right_ = 0, above_ = 0, wrong_below_ = 0;
  std::size_t elements_ = 0, wrong_ = 0;
};

}  // namespace

int main(int count, char** arguments) {
  const bool smoke = count > 1 && std::string(arguments[1]) == "--smoke";
  const int circuits = smoke ? 3 : count > 1 ? std::atoi(arguments[1]) : 400;
  const auto seed = static_cast<unsigned>(count > 2 ? std::atoi(arguments[2]) : 1);
  std::printf(
      "| noise | circuits | all kinds right | elements | of another kind | cost above that of the truth | wrong at no "
      "higher cost |\n|---|---|---|---|---|---|---|\n");
  for (const double noise : {0.001, 0.003, 0.01}) {
    std::mt19937_64 generator(seed);
    Tally tally;
    for (int i = 0; i < circuits; ++i) {
      const support::Circuit circuit = support::random_circuit(generator);
      tally.count(circuit, noise, generator);
    }
    tally.print(noise);
  }
}
