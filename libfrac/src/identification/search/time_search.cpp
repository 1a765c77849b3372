// SPDX-License-Identifier: BSD-3-Clause
#include "time_search.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include "base/draws.hpp"
#include "identification/residuals/frequency_problem.hpp"
#include "identification/residuals/laplace_residuals.hpp"
#include "identification/search/frequency_search.hpp"
#include "interchange.hpp"
#include "search_starts.hpp"
#include "start_values.hpp"

namespace frac::detail {
namespace {

// Simulations of the search, far below any noise, and of its scouts.
constexpr double coarse = 1e-8;
constexpr double coarsest = 1e-5;
// Outputs that are enough for them.
constexpr std::size_t few_outputs = 500;
constexpr std::size_t very_few_outputs = 120;
// Costs that agree to this are the same minimum or equally good fits: far less than noise in the data makes of it.
constexpr double equally_good = 1e-3;
// Solves from about the best: until so many have come back to it, and no more than so many.
constexpr std::size_t enough_returns = 4;
constexpr int most_scouts = 24;
// A scout is followed if it came within this factor of the best cost.
constexpr double promising = 1.5;
// Beyond this many times the hopeless cost no search goes on from a first, rough end.
constexpr double far_beyond = 1.5;

std::vector<std::size_t> every_nth(const std::vector<std::size_t>& all, std::size_t enough) {
  const std::size_t stride = (all.size() + enough - 1) / enough;
  std::vector<std::size_t> index;
  for (std::size_t i = 0; i < all.size(); i += stride) index.push_back(all[i]);
  if (index.back() != all.back()) index.push_back(all.back());
  return index;
}

class TimeSearch {
 public:
  TimeSearch(const TimeProblem& problem, double hopeless, double settled)
      : problem_(problem),
        hopeless_(hopeless),
        settled_(settled),
        // Every n-th output of a periodic record may be the same few of each period, and none is cheaper than all.
        few_(problem.residuals_at(
            problem.periodic() ? problem.data.observed() : every_nth(problem.data.observed(), few_outputs), coarse)),
        generator_(problem.options.seed) {
    result_.best.cost = std::numeric_limits<double>::infinity();
  }

  GlobalSolution run() {
    const ParameterMap& map = problem_.map;
    if (!without_start(map)) try_from(map.to_theta(map.start()));
    if (problem_.options.global_start && !map.free().empty() && !is_exact() && problem_.periodic()) {
      search_lines();
    } else if (problem_.options.global_start && !map.free().empty() && !is_exact()) {
      search_transforms();
      const TimeResiduals sparse =
          problem_.residuals_at(every_nth(problem_.data.observed(), very_few_outputs), coarsest);
      if (!std::isfinite(result_.best.cost)) {
        follow(start_among(sparse, {}, far_beyond * hopeless_among(sparse)));
      }
      if (std::isfinite(result_.best.cost) && !is_hopeless()) look_about(sparse);
    }
    if (!std::isfinite(result_.best.cost)) return {};
    result_.starts_at_best = at_best();
    finish();
    return result_;
  }

 private:
  void try_from(const std::vector<double>& theta) {
    ++result_.starts;
    if (!std::isfinite(few_.cost(theta))) return;
    // finish() settles the best; the others only need to be told from it.
    LocalSolution found = local_solve(few_, theta, nearly());
    ends_.push_back(found.cost);
    // The first of equal minima counts: the user's start names the parameters.
    if (found.cost + few_.rounding_cost() < result_.best.cost) result_.best = std::move(found);
  }

  [[nodiscard]] bool is_exact() const { return result_.best.cost <= few_.rounding_cost(); }

  [[nodiscard]] static LocalOptions nearly() {
    LocalOptions options;
    options.iterations = 50;
    options.cost_tolerance = 1e-7;
    return options;
  }

  /// The cost of these residuals that is as poor as the hopeless one.
  [[nodiscard]] double hopeless_among(const TimeResiduals& residuals) const {
    const double of_all =
        static_cast<double>(residuals.points()) / static_cast<double>(problem_.data.observed().size());
    return hopeless_ * of_all / (problem_.unit * problem_.unit);
  }
  [[nodiscard]] bool is_hopeless(double times = 1) const { return result_.best.cost > times * hopeless_among(few_); }

  [[nodiscard]] bool as_good_as_best(double cost) const {
    return cost <= result_.best.cost * (1 + equally_good) + few_.rounding_cost();
  }
  [[nodiscard]] std::size_t at_best() const {
    return static_cast<std::size_t>(
        std::count_if(ends_.begin(), ends_.end(), [&](double cost) { return as_good_as_best(cost); }));
  }

  [[nodiscard]] GlobalSolution start_among(const Residuals& residuals, const std::vector<double>& orders,
                                           double hopeless = std::numeric_limits<double>::infinity()) const {
    return global_search(residuals, residuals, orders, problem_.options.seed, hopeless, SearchAim::start);
  }

  void follow(const GlobalSolution& found) {
    result_.starts += found.starts;
    if (found.starts_at_best > 0) try_from(found.best.theta);
  }

  // A transform that decays slowly sees slow modes better, but is cut off more at the end of the record.  So the minima
  // of the three differ, and starts from several of them that come to one minimum in time confirm it.
  void search_transforms() {
    for (const double decay : {8.0, 4.0, 2.0}) {
      LaplaceResiduals transformed(problem_.data, problem_.structure, problem_.map, problem_.options.offset, decay);
      transformed.set_priors(problem_.priors, 1);  // these residuals are in units of the errors they should have
      if (transformed.points() < problem_.map.free().size()) continue;
      follow(start_among(transformed, suggested_orders(transformed.quotient())));
      if (is_exact() || at_best() > 1 || is_hopeless(far_beyond)) return;
    }
  }

  // In the steady state each line of the output is that of the input times the model.  The search over frequency knows
  // this problem; first each line weighs by a hundredth of itself beside the noise, then by the noise, as over time.
  void search_lines() {
    const PeriodicInput& input = *problem_.periodic();
    if (input.excited().empty()) return;
    const TimeResponseData& data = problem_.data;
    const LineSum sum(data.size(), input.period());
    const std::vector<std::complex<double>> line = sum.fitted(without_slope(data), data.observed());
    const double noise = noise_of_lines(sum, line);
    for (const double share : {0.01, 0.0}) {
      std::vector<double> omega, sigma;
      std::vector<std::complex<double>> value;
      double largest = 0;
      for (const std::size_t k : input.excited()) largest = std::max(largest, std::abs(line[k]));
      for (const std::size_t k : input.excited()) {
        constexpr double rounding = 1e-12;
        const double spread = std::hypot(noise, share * std::abs(line[k]), rounding * largest);
        omega.push_back(input.omega(k));
        value.push_back(line[k] / input.line()[k]);
        sigma.push_back(spread / std::abs(input.line()[k]));
      }
      const FrequencyResponseData response(std::move(omega), std::move(value), std::move(sigma));
      FitOptions options;
      options.weight = Weight::given;
      // A dead time longer by the period has the same lines, so that their spacing limits it, not the record.
      options.constraints = problem_.options.constraints;
      options.seed = problem_.options.seed;
      FrequencyProblem over_frequency(response, problem_.structure, options);
      const GlobalSolution found = frequency_search(over_frequency, std::numeric_limits<double>::infinity(), settled_);
      result_.starts += found.starts;
      if (found.starts_at_best == 0) continue;
      try_from(problem_.map.to_theta(over_frequency.map.to_user(found.best.theta)));
      result_.minima = std::max(result_.minima, found.minima);
    }
  }

  /// The output without the straight line through it, which is no part of a period.
  [[nodiscard]] static std::vector<double> without_slope(const TimeResponseData& data) {
    double count = 0, mean_index = 0, mean = 0, both = 0, square = 0;
    for (const std::size_t i : data.observed()) {
      ++count;
      mean_index += static_cast<double>(i);
      mean += data.output()[i];
    }
    mean_index /= count;
    mean /= count;
    for (const std::size_t i : data.observed()) {
      const double distance = static_cast<double>(i) - mean_index;
      both += distance * (data.output()[i] - mean);
      square += distance * distance;
    }
    std::vector<double> result = data.output();
    for (std::size_t i = 0; i < result.size(); ++i)
      result[i] -= mean + (square > 0 ? both / square : 0) * (static_cast<double>(i) - mean_index);
    return result;
  }

  /// Standard deviation of each part of a line, by what the lines leave of the output.
  [[nodiscard]] double noise_of_lines(const LineSum& sum, const std::vector<std::complex<double>>& line) const {
    const TimeResponseData& data = problem_.data;
    const std::vector<double> model = sum(line), output = without_slope(data);
    double square = 0;
    for (const std::size_t i : data.observed()) square += (output[i] - model[i]) * (output[i] - model[i]);
    const auto count = static_cast<double>(data.observed().size());
    const double degrees = std::max(1.0, count - 2 * static_cast<double>(sum.lines()) - 1);
    return std::sqrt(square / degrees * 2 / count);
  }

  // About the best one.  Dead times have minima between any two samples, so they move by some samples or by a tenth of
  // the record.
  [[nodiscard]] std::vector<double> drawn_about_best(double reach) {
    const double length = length_of(problem_.data);
    const double sampling = length / static_cast<double>(problem_.data.size() - 1);
    return drawn_about(problem_.map, result_.best.theta, reach, generator_, [&](const auto&, double step) {
      return step * (uniform_draw(generator_) < 0.5 ? 2 * sampling : 0.1 * length) * problem_.map.scale().omega;
    });
  }

  void look_about(const TimeResiduals& sparse) {
    LocalOptions scouting;
    scouting.iterations = 20;
    scouting.cost_tolerance = 1e-5;
    std::size_t returns = 0;
    for (int scout = 0; scout < most_scouts && returns < enough_returns && !is_exact(); ++scout) {
      const std::vector<double> theta = drawn_about_best(scout % 2 == 0 ? 0.5 : 2);
      if (!std::isfinite(sparse.cost(theta))) continue;
      const LocalSolution found = local_solve(sparse, theta, scouting);
      if (!(found.cost <= promising * sparse.cost(result_.best.theta) + sparse.rounding_cost())) {
        ++result_.starts;
        continue;
      }
      const double before = result_.best.cost;
      try_from(found.theta);
      if (result_.best.cost < before * (1 - equally_good)) returns = 0;
      if (!ends_.empty() && as_good_as_best(ends_.back())) ++returns;
    }
  }

  // All samples, and the labels of interchangeable parts in their order.  Digits of a hopeless fit are of no use.
  void finish() {
    const bool hopeless = is_hopeless();
    // Errors of the simulation far below the residuals move nothing.
    const double rms = std::sqrt(result_.best.cost / static_cast<double>(few_.count()));
    const TimeResiduals all = problem_.residuals_at(
        problem_.data.observed(), hopeless ? coarse : std::clamp(1e-6 * rms, finest_simulation, coarse));
    const ParameterMap& map = problem_.map;
    const std::vector<double> start = map.to_theta(
        with_labels_in_order(problem_.structure, problem_.options.constraints, map.to_user(result_.best.theta)));
    LocalOptions last;
    last.cost_tolerance = settled_;
    result_.best = local_solve(all, start, hopeless ? nearly() : last);
    // Patience in rounds, as long as one of them gains more than noise in the data makes of the cost.
    LocalOptions patient = last;
    patient.iterations = 100;
    for (int round = 0; round < 8 && !result_.best.converged && !hopeless && !is_exact(); ++round) {
      const double before = result_.best.cost;
      result_.best = local_solve(all, result_.best.theta, patient);
      if (!(result_.best.cost < before * (1 - equally_good))) break;
    }
  }

  const TimeProblem& problem_;
  double hopeless_, settled_;
  TimeResiduals few_;
  std::mt19937_64 generator_;
  GlobalSolution result_;
  std::vector<double> ends_;  // cost of each solve among few_
};

}  // namespace

GlobalSolution time_search(const TimeProblem& problem, double hopeless, double settled) {
  return TimeSearch(problem, hopeless, settled).run();
}

}  // namespace frac::detail
