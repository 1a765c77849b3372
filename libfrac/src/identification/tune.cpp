#include "frac/identification/tune.hpp"

#include <nlopt.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>
#include <numbers>
#include <stdexcept>

#include "../detail/number_text.hpp"
#include "../detail/power_sum.hpp"
#include "tuning/loop.hpp"

namespace frac {
namespace {

using Complex = std::complex<double>;
constexpr double pi = std::numbers::pi;
constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double nothing = std::numeric_limits<double>::quiet_NaN();

[[noreturn]] void refuse(const std::string& what) {
  throw std::invalid_argument("tune: " + what);
}

void check_positive(const char* name, double value, const char* unit) {
  if (!(value > 0 && std::isfinite(value))) {
    refuse(std::string(name) + " = " + detail::number_text(value) + unit + "; allowed is above 0, finite");
  }
}

// Of mu from its limit: what the search leaves.
constexpr double at_limit = 1e-3;

// Highest order of differentiation with which the loop still falls, as s^-0.2, at high frequency: beyond it no dead
// time or lag is small enough to be left out of the model.
double highest_mu(const FractionalTransferFunction& plant, const TuningOptions& options) {
  constexpr double least_fall = 0.2;
  const double order = plant.numerator().front().order - plant.denominator().front().order;
  return -order - least_fall + (options.derivative_filter_time > 0 ? 1 : 0);
}

void check(const FractionalTransferFunction& plant, const LoopSpecification& asked, const TuningOptions& options) {
  const double growth = plant.numerator().front().order - plant.denominator().front().order;
  if (growth > 0) {
    refuse("the plant grows as s^" + detail::number_text(growth) + " at high frequency; allowed is a proper plant");
  }
  if (asked.crossover) check_positive("crossover", *asked.crossover, " rad/s");
  if (asked.phase_margin && !(*asked.phase_margin > 0 && *asked.phase_margin < pi)) {
    refuse("phase_margin = " + detail::number_text(*asked.phase_margin) + " rad; allowed is within (0, pi)");
  }
  if (!asked.crossover && (asked.phase_margin || asked.flat_phase)) {
    refuse("a phase margin or flat phase needs the crossover at which it holds");
  }
  const auto check_peak = [](const char* name, double value) {
    if (!(value > 1)) refuse(std::string(name) + " = " + detail::number_text(value) + "; allowed is above 1");
  };
  check_peak("max_sensitivity", asked.max_sensitivity);
  // |T| may stay below 1 where there is no integral term.
  if (!(asked.max_complementary_sensitivity > 0)) {
    refuse("max_complementary_sensitivity = " + detail::number_text(asked.max_complementary_sensitivity) +
           "; allowed is above 0");
  }
  for (const auto& [name, bound] :
       {std::pair{"high_frequency", asked.high_frequency}, std::pair{"low_frequency", asked.low_frequency}}) {
    if (!bound) continue;
    check_positive((std::string(name) + ".omega").c_str(), bound->omega, " rad/s");
    check_positive((std::string(name) + ".gain").c_str(), bound->gain, "");
  }
  for (const auto& [name, range] : {std::pair{"lambda", options.lambda}, std::pair{"mu", options.mu}}) {
    if (!(range.lower > 0 && range.lower <= range.upper && range.upper < 2)) {
      refuse(std::string(name) + " = " + detail::number_text(range.lower) + " to " + detail::number_text(range.upper) +
             "; needed is 0 < lower <= upper < 2");
    }
  }
  if (!(options.derivative_filter_time >= 0 && std::isfinite(options.derivative_filter_time))) {
    refuse("derivative_filter_time = " + detail::number_text(options.derivative_filter_time) +
           " s; allowed is 0 or more, finite");
  }
  if (!(options.horizon >= 0 && std::isfinite(options.horizon))) {
    refuse("horizon = " + detail::number_text(options.horizon) + " s; allowed is 0 or more, finite");
  }
  if (options.criterion != TuningCriterion::sensitivity && options.horizon == 0) {
    refuse("the criterion " + std::string(to_string(options.criterion)) + " needs a horizon");
  }
  const double most = highest_mu(plant, options);
  if (options.structure != ControllerStructure::pi && options.mu.lower > most) {
    refuse("mu = " + detail::number_text(options.mu.lower) + " and above: the loop would not fall at high frequency; " +
           "allowed is up to " + detail::number_text(most) + ", or a derivative filter, or the structure pi");
  }
  const bool empty = !asked.crossover && !std::isfinite(asked.max_sensitivity) &&
                     !std::isfinite(asked.max_complementary_sensitivity) && !asked.high_frequency &&
                     !asked.low_frequency;
  if (empty && options.criterion == TuningCriterion::sensitivity) {
    refuse("nothing is asked for: give a crossover, a bound, or the criterion iae or itae");
  }
  if (!asked.crossover && !asked.low_frequency && options.criterion == TuningCriterion::sensitivity) {
    refuse("without control |S| is 1: give a crossover, a low-frequency bound, or the criterion iae or itae");
  }
}

// Solution of a (count x count) system, empty where singular.
bool solve(double (&matrix)[3][4], int count, double (&solution)[3]) {
  for (int k = 0; k < count; ++k) {
    int pivot = k;
    for (int i = k + 1; i < count; ++i) {
      if (std::abs(matrix[i][k]) > std::abs(matrix[pivot][k])) pivot = i;
    }
    if (std::abs(matrix[pivot][k]) < 1e-300) return false;
    std::swap_ranges(matrix[k], matrix[k] + 4, matrix[pivot]);
    for (int i = k + 1; i < count; ++i) {
      const double factor = matrix[i][k] / matrix[k][k];
      for (int j = k; j < 4; ++j) matrix[i][j] -= factor * matrix[k][j];
    }
  }
  for (int k = count; k-- > 0;) {
    double sum = matrix[k][3];
    for (int j = k + 1; j < count; ++j) sum -= matrix[k][j] * solution[j];
    solution[k] = sum / matrix[k][k];
  }
  return true;
}

// A frequency about which the loop will live: the crossover asked for, or where the plant's phase has turned by 2 rad
// from its start, or the lower end of what the horizon shows.
double reference_frequency(const FractionalTransferFunction& plant, const LoopSpecification& asked,
                           const TuningOptions& options) {
  if (asked.crossover) return *asked.crossover;
  const double slowest = options.horizon > 0   ? 1 / options.horizon
                         : asked.low_frequency ? asked.low_frequency->omega
                                               : 1e-6;
  const double order = plant.numerator().back().order - plant.denominator().back().order;
  double phase = order * pi / 2;
  const double target = std::min(-2.0, phase - 0.3);
  Complex before = 0;
  for (double omega = slowest; omega < 1e8 * slowest; omega *= 1.02) {
    const Complex value = plant.response(omega);
    if (before != 0.0) phase += std::arg(value / before);
    if (phase < target) return omega;
    before = value;
  }
  return 100 * slowest;
}

class Tuner {
 public:
  Tuner(const FractionalTransferFunction& plant, const LoopSpecification& asked, const TuningOptions& options)
      : plant_(plant),
        asked_(asked),
        options_(options),
        reference_(reference_frequency(plant, asked, options)),
        plant_at_reference_(plant.response(reference_)),
        plant_slope_(detail::log_slope(plant, reference_)),
        grid_(plant, reference_, bound_frequencies(asked)) {
    if (options.criterion != TuningCriterion::sensitivity) {
      constexpr int samples = 1500;
      simulation_.emplace(plant, options.horizon, options.load_step, samples);
    }
    uses_[0] = true;
    uses_[1] = options.structure != ControllerStructure::pd;
    uses_[2] = options.structure != ControllerStructure::pi;
    const auto add = [&](Role role, double lower, double upper) {
      if (lower == upper) return;
      roles_.push_back(role);
      lower_.push_back(lower);
      upper_.push_back(upper);
    };
    if (uses_[1]) add(Role::lambda, options.lambda.lower, options.lambda.upper);
    if (uses_[2]) add(Role::mu, options.mu.lower, std::min(options.mu.upper, highest_mu(plant, options)));
    if (asked.crossover) {
      if (!asked.phase_margin) add(Role::phase_margin, 0.1, 2.6);
      if (uses_[1] && uses_[2] && !asked.flat_phase) add(Role::share, 0, 1);
    } else {
      // In units of what makes |L| = 1 at the reference.
      for (int term = 0; term < 3; ++term) {
        if (uses_[term]) add(static_cast<Role>(static_cast<int>(Role::kp) + term), -9, 5);
      }
    }
  }

  struct Candidate {
    FractionalPidGains gains;
    std::vector<double> violations;  // above 0 where kept not
    double criterion = infinity;
    [[nodiscard]] double worst() const { return *std::max_element(violations.begin(), violations.end()); }
    // Whatever keeps the specification is before whatever does not.
    [[nodiscard]] double rank() const {
      constexpr double kept = 1e-9;
      constexpr double far = 1e9;
      const double value = worst();
      if (!std::isfinite(value)) return 10 * far;
      return value > kept ? far * (1 + std::min(value, 1.0)) + std::min(value, far) : std::min(criterion, far);
    }
  };

  void search() {
    if (roles_.empty()) {
      consider({});
      return;
    }
    if (asked_.flat_phase && uses_[1] != uses_[2]) {
      search_flat_line();
      return;
    }
    look_around({}, 0);
    nlopt_srand(static_cast<unsigned long>(options_.seed));
    const auto dimensions = static_cast<unsigned>(roles_.size());
    const auto objective = [](unsigned count, const double* x, double*, void* tuner) {
      return static_cast<Tuner*>(tuner)->consider({x, x + count}).rank();
    };
    const int budget = simulation_ ? 400 : 700;
    run(NLOPT_GN_CRS2_LM, objective, budget * static_cast<int>(dimensions), false);
    // Again from the best, under the inequalities as such.
    const auto smooth = [](unsigned count, const double* x, double*, void* tuner) {
      return std::min(static_cast<Tuner*>(tuner)->consider({x, x + count}).criterion, 1e9);
    };
    run(NLOPT_LN_COBYLA, smooth, 150 * static_cast<int>(dimensions), true);
  }

  [[nodiscard]] const Candidate& best() const { return best_; }
  [[nodiscard]] int evaluations() const { return evaluations_; }
  [[nodiscard]] double reference() const { return reference_; }

 private:
  enum class Role { lambda, mu, phase_margin, share, kp, ki, kd };
  using Objective = double (*)(unsigned, const double*, double*, void*);

  static std::vector<double> bound_frequencies(const LoopSpecification& asked) {
    std::vector<double> omega;
    if (asked.crossover) omega.push_back(*asked.crossover);
    if (asked.high_frequency) omega.push_back(asked.high_frequency->omega);
    if (asked.low_frequency) omega.push_back(asked.low_frequency->omega);
    return omega;
  }

  void run(nlopt_algorithm algorithm, Objective objective, int budget, bool constrained) {
    const std::unique_ptr<nlopt_opt_s, decltype(&nlopt_destroy)> search(
        nlopt_create(algorithm, static_cast<unsigned>(roles_.size())), &nlopt_destroy);
    nlopt_set_lower_bounds(search.get(), lower_.data());
    nlopt_set_upper_bounds(search.get(), upper_.data());
    nlopt_set_maxeval(search.get(), budget);
    nlopt_set_xtol_rel(search.get(), 1e-7);
    nlopt_set_min_objective(search.get(), objective, this);
    std::vector<double> x(roles_.size());
    for (std::size_t i = 0; i < x.size(); ++i) {
      x[i] = best_at_.empty() ? (lower_[i] + upper_[i]) / 2 : best_at_[i];
    }
    if (constrained) {
      const auto constraints = [](unsigned count, double* value, unsigned n, const double* at, double*, void* tuner) {
        const Candidate candidate = static_cast<Tuner*>(tuner)->consider({at, at + n});
        for (unsigned i = 0; i < count; ++i) value[i] = std::min(candidate.violations[i], 1e3);
      };
      const auto count = static_cast<unsigned>(best_.violations.size());
      nlopt_add_inequality_mconstraint(search.get(), count, constraints, this, nullptr);
      std::vector<double> step(x.size());
      for (std::size_t i = 0; i < x.size(); ++i) step[i] = 0.03 * (upper_[i] - lower_[i]);
      nlopt_set_initial_step(search.get(), step.data());
    }
    double value = 0;
    // Whatever it returns, the best candidate met on the way is kept.
    nlopt_optimize(search.get(), x.data(), &value);
  }

  // Some points of each range, ends included: a small region of stable loops may escape a random population.
  void look_around(std::vector<double> x, std::size_t next) {
    if (next == roles_.size()) {
      consider(x);
      return;
    }
    const bool order = roles_[next] == Role::lambda || roles_[next] == Role::mu;
    const int points = order ? 5 : 4;
    for (int i = 0; i < points; ++i) {
      x.push_back(lower_[next] + (upper_[next] - lower_[next]) * i / (points - 1));
      look_around(x, next + 1);
      x.pop_back();
    }
  }

  // Two gains leave one equation for one order: its roots between steps of a scan.
  void search_flat_line() {
    constexpr int steps = 400;
    const auto slope_at = [&](double order) {
      std::vector<double> x(roles_.size());
      x[0] = order;
      if (x.size() > 1) x[1] = free_phase_;
      return slope(gains_of(x));
    };
    const int phases = roles_.size() > 1 ? 40 : 1;
    for (int phase = 0; phase < phases; ++phase) {
      if (phases > 1) free_phase_ = lower_[1] + (upper_[1] - lower_[1]) * phase / (phases - 1);
      double before_order = 0;
      double before = nothing;
      for (int i = 0; i <= steps; ++i) {
        const double order = lower_[0] + (upper_[0] - lower_[0]) * i / steps;
        const double value = slope_at(order);
        if (value == 0 || before * value < 0) {
          double left = i == 0 ? order : before_order;
          double right = order;
          for (int k = 0; k < 80; ++k) {
            const double middle = (left + right) / 2;
            (slope_at(middle) * value > 0 ? right : left) = middle;
          }
          std::vector<double> x(roles_.size(), free_phase_);
          x[0] = right;
          consider(x);
        }
        before_order = order;
        before = value;
      }
    }
    if (best_at_.empty()) consider(std::vector<double>(lower_.begin(), lower_.end()));
  }

  [[nodiscard]] double slope(const FractionalPidGains& gains) const {
    const detail::ControllerTerms terms =
        detail::controller_terms(gains.lambda, gains.mu, options_.derivative_filter_time, reference_);
    const double gain[3] = {gains.kp, gains.ki, gains.kd};
    Complex value = 0;
    Complex by_log = 0;
    for (int i = 0; i < 3; ++i) {
      value += gain[i] * terms.value[i];
      by_log += gain[i] * terms.slope[i];
    }
    return plant_slope_.imag() + (by_log / value).imag();
  }

  [[nodiscard]] FractionalPidGains gains_of(const std::vector<double>& x) const {
    FractionalPidGains gains{0, 0, 0, options_.lambda.lower, options_.mu.lower};
    if (!uses_[1]) gains.lambda = 1;
    if (!uses_[2]) gains.mu = 1;
    double phase_margin = asked_.phase_margin.value_or(1);
    double share = 0;
    double log_gain[3] = {0, 0, 0};
    for (std::size_t i = 0; i < x.size(); ++i) {
      switch (roles_[i]) {
        case Role::lambda:
          gains.lambda = x[i];
          break;
        case Role::mu:
          gains.mu = x[i];
          break;
        case Role::phase_margin:
          phase_margin = x[i];
          break;
        case Role::share:
          share = x[i];
          break;
        default:
          log_gain[static_cast<int>(roles_[i]) - static_cast<int>(Role::kp)] = x[i];
      }
    }
    const detail::ControllerTerms terms =
        detail::controller_terms(gains.lambda, gains.mu, options_.derivative_filter_time, reference_);
    double* const gain[3] = {&gains.kp, &gains.ki, &gains.kd};
    if (!asked_.crossover) {
      for (int i = 0; i < 3; ++i) {
        if (uses_[i]) *gain[i] = std::exp(log_gain[i]) / std::abs(plant_at_reference_ * terms.value[i]);
      }
      return gains;
    }
    // C(j omega) = e^{j (phase_margin - pi)}/P; for flat phase also Im(dC/C) = -Im(dP/P), linear because C is known.
    const Complex target = std::polar(1.0, phase_margin - pi) / plant_at_reference_;
    int column[3];
    int columns = 0;
    for (int i = 0; i < 3; ++i) {
      if (uses_[i]) column[columns++] = i;
    }
    const auto row = [&](double(&to)[4], int kind, double right) {
      for (int k = 0; k < 3; ++k) {
        if (k >= columns) {
          to[k] = 0;
          continue;
        }
        const int i = column[k];
        to[k] = kind == 0   ? (terms.value[i] / target).real()
                : kind == 1 ? (terms.value[i] / target).imag()
                            : (terms.slope[i] / target).imag();
      }
      to[3] = right;
    };
    double solution[3] = {nothing, nothing, nothing};
    if (columns == 3 && !asked_.flat_phase) {
      share_out(terms, target, share, solution);
    } else {
      double matrix[3][4] = {};
      row(matrix[0], 0, 1);
      row(matrix[1], 1, 0);
      if (columns == 3) row(matrix[2], 2, -plant_slope_.imag());
      if (!solve(matrix, columns, solution)) solution[0] = nothing;
    }
    for (int k = 0; k < columns; ++k) *gain[column[k]] = solution[k];
    return gains;
  }

  // Of the line of gains with C = target the point at `share` of the piece on which none is negative; beyond it, where
  // there is no such piece, the point at which the most negative is least so.
  void share_out(const detail::ControllerTerms& terms, Complex target, double share, double (&gain)[3]) const {
    Complex column[3];
    for (int i = 0; i < 3; ++i) column[i] = terms.value[i] / target;
    const auto cross = [](Complex a, Complex b) { return a.real() * b.imag() - a.imag() * b.real(); };
    const double direction[3] = {cross(column[1], column[2]), cross(column[2], column[0]), cross(column[0], column[1])};
    int largest = 0;
    for (int i = 1; i < 3; ++i) {
      if (std::abs(direction[i]) * std::abs(column[i]) > std::abs(direction[largest]) * std::abs(column[largest]))
        largest = i;
    }
    if (direction[largest] == 0) return;
    const int a = (largest + 1) % 3;
    const int b = (largest + 2) % 3;
    // Where no gain turns negative on one side: a term this many times the whole.
    constexpr double reach = 20;
    double point[3] = {0, 0, 0};
    point[a] = cross(Complex(1), column[b]) / cross(column[a], column[b]);
    point[b] = cross(column[a], Complex(1)) / cross(column[a], column[b]);
    const double farthest = reach / std::abs(direction[largest] * std::abs(column[largest]));
    double from = -farthest;
    double to = farthest;
    for (int i = 0; i < 3; ++i) {
      if (direction[i] == 0) continue;
      const double zero = -point[i] / direction[i];
      (direction[i] > 0 ? from : to) = direction[i] > 0 ? std::max(from, zero) : std::min(to, zero);
    }
    // Finely where it begins, if it has no end.
    const double part = to == farthest ? std::pow(share, 3) : from == -farthest ? 1 - std::pow(1 - share, 3) : share;
    const double at = from + part * (to - from);
    for (int i = 0; i < 3; ++i) gain[i] = point[i] + at * direction[i];
  }

  Candidate consider(const std::vector<double>& x) {
    ++evaluations_;
    Candidate candidate;
    candidate.gains = gains_of(x);
    FractionalPidGains& gains = candidate.gains;
    const detail::ControllerTerms terms =
        detail::controller_terms(gains.lambda, gains.mu, options_.derivative_filter_time, reference_);
    double* const gain[3] = {&gains.kp, &gains.ki, &gains.kd};
    for (int i = 0; i < 3; ++i) {
      const double share = *gain[i] * std::abs(terms.value[i] * plant_at_reference_);
      // However small, a negative gain is one unstable pole.
      if (share < 0 && share > -1e-9) *gain[i] = 0;
      candidate.violations.push_back(-share);
    }
    const bool finite = std::isfinite(gains.kp) && std::isfinite(gains.ki) && std::isfinite(gains.kd);
    const double high = asked_.high_frequency ? asked_.high_frequency->omega : infinity;
    const double low = asked_.low_frequency ? asked_.low_frequency->omega : 0;
    const detail::LoopGrid::Peaks peaks =
        finite ? grid_.peaks(gains, options_.derivative_filter_time, high, low)
               : detail::LoopGrid::Peaks{infinity, infinity, infinity, infinity, infinity};
    const auto add = [&](double reached, double bound) {
      if (std::isfinite(bound)) candidate.violations.push_back(std::log(reached / bound));
    };
    // Half a pole is the rounding of a count.
    candidate.violations.push_back(peaks.unstable_poles > 0.5 ? peaks.unstable_poles : -0.5);
    add(peaks.sensitivity, asked_.max_sensitivity);
    add(peaks.complementary_sensitivity, asked_.max_complementary_sensitivity);
    if (asked_.high_frequency) add(peaks.high_frequency, asked_.high_frequency->gain);
    if (asked_.low_frequency) add(peaks.low_frequency, asked_.low_frequency->gain);
    if (!finite) {
      for (double& violation : candidate.violations) violation = infinity;
    } else if (!simulation_) {
      candidate.criterion = peaks.sensitivity;
    } else if (candidate.worst() < 0.5) {
      const detail::ErrorIntegrals integrals = (*simulation_)(gains, options_.derivative_filter_time);
      candidate.criterion = options_.criterion == TuningCriterion::iae ? integrals.iae : integrals.itae;
    }
    if (best_.violations.empty() || candidate.rank() < best_.rank()) {
      best_ = candidate;
      best_at_ = x;
    }
    return candidate;
  }

  const FractionalTransferFunction& plant_;
  const LoopSpecification& asked_;
  const TuningOptions& options_;
  double reference_;
  Complex plant_at_reference_;
  Complex plant_slope_;
  detail::LoopGrid grid_;
  std::optional<detail::LoopSimulation> simulation_;
  bool uses_[3];
  std::vector<Role> roles_;
  std::vector<double> lower_, upper_;
  double free_phase_ = 1;
  Candidate best_;
  std::vector<double> best_at_;
  int evaluations_ = 0;
};

struct Extreme {
  double value = 0;
  double omega = 0;
};

// Largest of a function of omega between two frequencies: a grid of two hundred points per decade, and a golden section
// about the largest of them.
template <typename Function>
Extreme largest(const Function& function, double from, double to) {
  const int points = std::max(3, static_cast<int>(200 * std::log10(to / from)));
  const auto at = [&](double share) { return from * std::pow(to / from, share); };
  int place = 0;
  double value = -1;
  for (int i = 0; i <= points; ++i) {
    const double each = function(at(static_cast<double>(i) / points));
    if (each > value) {
      value = each;
      place = i;
    }
  }
  double left = std::max(0, place - 1) / static_cast<double>(points);
  double right = std::min(points, place + 1) / static_cast<double>(points);
  constexpr double golden = 0.6180339887498949;
  for (int i = 0; i < 40; ++i) {
    const double first = right - golden * (right - left);
    const double second = left + golden * (right - left);
    if (function(at(first)) < function(at(second))) {
      left = first;
    } else {
      right = second;
    }
  }
  const double omega = at((left + right) / 2);
  const double refined = function(omega);
  return refined > value ? Extreme{refined, omega} : Extreme{value, at(static_cast<double>(place) / points)};
}

// Every omega at which |L| = 1, and up to `fast` at which L is real, between neighbours of a grid of two hundred points
// per decade.
template <typename Found>
void scan(const FractionalTransferFunction& loop, double from, double to, double fast, const Found& found) {
  const int points = static_cast<int>(200 * std::log10(to / from));
  const auto root = [](const auto& function, double left, double right) {
    const bool rises = function(left) < 0;
    for (int i = 0; i < 60; ++i) {
      const double middle = std::sqrt(left * right);
      ((function(middle) < 0) == rises ? left : right) = middle;
    }
    return std::sqrt(left * right);
  };
  const auto log_gain = [&](double omega) { return std::log(std::abs(loop.response(omega))); };
  const auto imaginary = [&](double omega) { return loop.response(omega).imag(); };
  double before = from;
  for (int i = 1; i <= points; ++i) {
    const double omega = from * std::pow(to / from, static_cast<double>(i) / points);
    if (log_gain(before) * log_gain(omega) <= 0) found(root(log_gain, before, omega), true);
    if (omega < fast && imaginary(before) * imaginary(omega) < 0) found(root(imaginary, before, omega), false);
    before = omega;
  }
}

void describe(const FractionalTransferFunction& plant, const LoopSpecification& asked, const TuningOptions& options,
              double reference, TuningResult& result) {
  const FractionalTransferFunction controller =
      controller_transfer_function(result.gains, options.derivative_filter_time);
  const FractionalTransferFunction loop(detail::product(plant.numerator(), controller.numerator()),
                                        detail::product(plant.denominator(), controller.denominator()), plant.delay());
  result.closed_loop = analyse_closed_loop(loop).stability;
  // Where dead time turns L by more than half a radian from point to point of the search below, the worst phase counts.
  const double fast = plant.delay() > 0 ? 0.5 / (0.0116 * plant.delay()) : infinity;
  const auto sensitivity = [&](double omega) {
    const Complex value = loop.response(omega);
    return omega > fast ? 1 / std::max(1 - std::abs(value), 1e-9) : 1 / std::abs(1.0 + value);
  };
  const auto complementary = [&](double omega) { return std::abs(loop.response(omega)) * sensitivity(omega); };
  const double lowest = reference * 1e-5;
  const double highest = reference * 1e5;
  const Extreme s = largest(sensitivity, lowest, highest);
  const Extreme t = largest(complementary, lowest, highest);
  result.max_sensitivity = s.value;
  result.omega_max_sensitivity = s.omega;
  result.max_complementary_sensitivity = t.value;
  result.omega_max_complementary_sensitivity = t.omega;

  result.crossover = result.phase_margin = result.phase_slope = nothing;
  result.gain_margin = infinity;
  double nearest = infinity;
  scan(loop, lowest, highest, fast, [&](double omega, bool is_crossover) {
    const Complex value = loop.response(omega);
    if (!is_crossover) {
      if (value.real() < 0 && std::abs(value) < 1)
        result.gain_margin = std::min(result.gain_margin, 1 / std::abs(value));
      return;
    }
    const double distance = asked.crossover ? std::abs(std::log(omega / *asked.crossover)) : 1 / omega;
    if (distance >= nearest) return;
    nearest = distance;
    result.crossover = omega;
    result.phase_margin = std::remainder(std::arg(value) + pi, 2 * pi);
    result.phase_slope = detail::log_slope(loop, omega).imag();
  });
  // Beyond, every phase comes soon.
  if (fast < highest) result.gain_margin = std::min(result.gain_margin, 1 / std::abs(loop.response(fast)));

  const auto line = [&](const std::string& name, double value, double reached, bool met) {
    result.specification.push_back({name, value, reached, met});
  };
  constexpr double degree = 180 / pi;
  // What is solved for holds to rounding amplified by the conditioning of three equations.
  constexpr double solved = 1e-6;
  // Bounds are kept on a grid of thirty points per decade; between them a peak may be this much higher.
  constexpr double between = 1.002;
  if (asked.crossover) {
    line("crossover, rad/s", *asked.crossover, result.crossover,
         std::abs(result.crossover / *asked.crossover - 1) < solved);
  }
  if (asked.phase_margin) {
    line("phase margin, deg", *asked.phase_margin * degree, result.phase_margin * degree,
         std::abs(result.phase_margin - *asked.phase_margin) < solved);
  }
  if (asked.flat_phase) {
    line("phase slope, deg per e-fold", 0, result.phase_slope * degree, std::abs(result.phase_slope) < 1e-5);
  }
  const auto bound = [&](const std::string& name, double value, double reached) {
    line(name, value, reached, reached <= value * between);
  };
  if (std::isfinite(asked.max_sensitivity)) bound("max |S|", asked.max_sensitivity, result.max_sensitivity);
  if (std::isfinite(asked.max_complementary_sensitivity)) {
    bound("max |T|", asked.max_complementary_sensitivity, result.max_complementary_sensitivity);
  }
  if (asked.high_frequency) {
    const double from = asked.high_frequency->omega;
    bound("|T| from " + detail::number_text(from) + " rad/s on", asked.high_frequency->gain,
          largest(complementary, from, std::max(highest, 1e3 * from)).value);
  }
  if (asked.low_frequency) {
    const double to = asked.low_frequency->omega;
    bound("|S| up to " + detail::number_text(to) + " rad/s", asked.low_frequency->gain,
          largest(sensitivity, std::min(lowest, 1e-3 * to), to).value);
  }
  result.iae = result.itae = nothing;
  if (options.horizon > 0 && result.closed_loop == Stability::stable) {
    constexpr int samples = 4000;
    const auto with = [&](int count) {
      return detail::LoopSimulation(plant, options.horizon, options.load_step, count)(result.gains,
                                                                                      options.derivative_filter_time);
    };
    const detail::ErrorIntegrals coarse = with(samples);
    const detail::ErrorIntegrals fine = with(2 * samples);
    result.iae = 2 * fine.iae - coarse.iae;
    result.itae = 2 * fine.itae - coarse.itae;
  }
}

}  // namespace

FractionalTransferFunction controller_transfer_function(const FractionalPidGains& gains,
                                                        double derivative_filter_time) {
  const double time = derivative_filter_time;
  if (!(time >= 0 && std::isfinite(time))) {
    throw std::invalid_argument("controller_transfer_function: derivative_filter_time = " + detail::number_text(time) +
                                " s; allowed is 0 or more, finite");
  }
  std::vector<PowerTerm> numerator{{gains.kp, 0}, {gains.ki, -gains.lambda}, {gains.kd, gains.mu}};
  if (time == 0) return {numerator, {{1, 0}}};
  numerator.push_back({gains.kp * time, 1});
  numerator.push_back({gains.ki * time, 1 - gains.lambda});
  return {numerator, {{time, 1}, {1, 0}}};
}

std::string_view to_string(TuningCriterion criterion) {
  switch (criterion) {
    case TuningCriterion::sensitivity:
      return "sensitivity";
    case TuningCriterion::iae:
      return "iae";
    case TuningCriterion::itae:
      break;
  }
  return "itae";
}

TuningCriterion tuning_criterion(std::string_view name) {
  for (const auto criterion : {TuningCriterion::sensitivity, TuningCriterion::iae, TuningCriterion::itae}) {
    if (to_string(criterion) == name) return criterion;
  }
  throw std::invalid_argument("tuning criterion \"" + std::string(name) + "\": expected one of sensitivity, iae, itae");
}

std::string_view to_string(ControllerStructure structure) {
  switch (structure) {
    case ControllerStructure::pid:
      return "pid";
    case ControllerStructure::pi:
      return "pi";
    case ControllerStructure::pd:
      break;
  }
  return "pd";
}

ControllerStructure controller_structure(std::string_view name) {
  for (const auto structure : {ControllerStructure::pid, ControllerStructure::pi, ControllerStructure::pd}) {
    if (to_string(structure) == name) return structure;
  }
  throw std::invalid_argument("controller structure \"" + std::string(name) + "\": expected one of pid, pi, pd");
}

std::string_view to_string(TuningStatus status) {
  return status == TuningStatus::met ? "met" : "not-met";
}

TuningResult tune(const FractionalTransferFunction& plant, const LoopSpecification& specification,
                  const TuningOptions& options) {
  check(plant, specification, options);
  Tuner tuner(plant, specification, options);
  tuner.search();
  TuningResult result;
  result.gains = tuner.best().gains;
  result.derivative_filter_time = options.derivative_filter_time;
  result.evaluations = tuner.evaluations();
  result.mu_limit = highest_mu(plant, options);
  result.mu_at_limit = options.structure != ControllerStructure::pi && result.mu_limit < options.mu.upper &&
                       result.gains.kd != 0 && result.gains.mu > result.mu_limit - at_limit;
  const FractionalPidGains& gains = result.gains;
  if (!(std::isfinite(gains.kp) && std::isfinite(gains.ki) && std::isfinite(gains.kd))) {
    result.message = "The equations for the gains have no solution.";
    return result;
  }
  describe(plant, specification, options, tuner.reference(), result);
  std::string failed;
  for (const ReachedSpecification& line : result.specification) {
    if (!line.met) failed += (failed.empty() ? "" : "; ") + line.name;
  }
  if (std::min({gains.kp, gains.ki, gains.kd}) < 0)
    failed += (failed.empty() ? "" : "; ") + std::string("gains not negative");
  if (result.closed_loop != Stability::stable) {
    result.message = "No stable loop with this specification was found; the closed loop is " +
                     std::string(to_string(result.closed_loop)) + ".";
  } else if (!failed.empty()) {
    result.message = "No controller was found that keeps everything; not kept: " + failed + ".";
  } else {
    result.status = TuningStatus::met;
    result.message = "The closed loop is stable and keeps the specification.";
  }
  if (result.mu_at_limit) {
    result.message += " mu stands at its limit, " + detail::number_text(result.mu_limit) +
                      ": above it the loop would fall more slowly than s^-0.2 at high frequency.";
  }
  return result;
}

}  // namespace frac
