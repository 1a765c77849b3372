// SPDX-License-Identifier: BSD-3-Clause
#include "laws.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <numbers>
#include <random>
#include <stdexcept>

#include "base/linear_algebra.hpp"
#include "identification/statistics/definition.hpp"

namespace frac::detail {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr std::size_t covariate = std::numeric_limits<std::size_t>::max();

std::size_t index_in(const std::vector<std::string>& names, const std::string& name) {
  return static_cast<std::size_t>(std::find(names.begin(), names.end(), name) - names.begin());
}

/// NaN where the curve does not know it.
double known_value(const JointCurve& curve, const std::string& name) {
  for (const auto& [key, value] : curve.covariates)
    if (key == name) return value;
  return nan;
}

/// "; known are a, b", of the first curve; empty where it knows nothing.
std::string known_names(const JointCurve& curve) {
  std::string names;
  for (const auto& [key, value] : curve.covariates) names += (names.empty() ? "; known are " : ", ") + key;
  return names;
}

[[noreturn]] void refuse(const std::string& definition, const std::string& reason) {
  throw std::invalid_argument("law '" + definition + "': " + reason);
}

}  // namespace

Laws::Laws(const Structure& structure, const JointFitOptions& options, const std::vector<JointCurve>& curves) {
  const auto& parameters = structure.parameter_names();
  for (const std::string& text : options.laws) {
    const auto [driven, right] = split_definition(text);
    const bool is_shift = options.shift && (driven == horizontal_shift || driven == vertical_shift);
    Law law{0, is_shift, Structure(with_pi(right)), {}, std::vector<std::vector<double>>(curves.size())};
    if (law.formula.depends_on_s()) refuse(text, "it depends on s");
    const std::vector<std::string>& names = law.formula.parameter_names();
    law.parameter = index_in(parameters, driven);
    if (law.parameter == parameters.size()) refuse(text, "'" + driven + "' is no parameter of " + structure.formula());
    if (drives(law.parameter)) refuse(text, "'" + driven + "' has a law already");
    if (std::find(options.shared.begin(), options.shared.end(), driven) != options.shared.end())
      refuse(text, "'" + driven + "' is shared; what follows a law differs from curve to curve");
    bool has_covariate = false;
    for (const std::string& name : names) {
      const bool known = std::any_of(curves.begin(), curves.end(),
                                     [&](const auto& each) { return !std::isnan(known_value(each, name)); });
      has_covariate = has_covariate || known;
      for (std::size_t c = 0; c < curves.size(); ++c) {
        const double value = known ? known_value(curves[c], name) : nan;
        if (known && !std::isfinite(value)) refuse(text, "curve " + curves[c].name + " tells no number '" + name + "'");
        law.covariates[c].push_back(value);
      }
      if (known) {
        law.place.push_back(covariate);
        continue;
      }
      if (index_in(parameters, name) < parameters.size())
        refuse(text, "'" + name + "' is a parameter of the model; a law has parameters of its own");
      const std::size_t place = index_in(names_, name);
      if (place == names_.size()) names_.push_back(name);
      law.place.push_back(place);
    }
    if (!has_covariate) refuse(text, "nothing in it is known of the curves" + known_names(curves.front()));
    laws_.push_back(std::move(law));
  }
}

bool Laws::drives(std::size_t parameter) const {
  return std::any_of(laws_.begin(), laws_.end(), [&](const Law& each) { return each.parameter == parameter; });
}

bool Laws::drive_shifts() const {
  return std::any_of(laws_.begin(), laws_.end(), [](const Law& each) { return each.is_shift; });
}

bool Laws::has(const std::string& name) const {
  return index_in(names_, name) < names_.size();
}

double Laws::at(std::size_t law, std::size_t curve, std::span<const double> values, std::span<double> gradient) const {
  const Law& of = laws_[law];
  std::vector<double> all = of.covariates[curve];
  std::vector<std::complex<double>> slope(all.size());
  for (std::size_t k = 0; k < all.size(); ++k)
    if (of.place[k] != covariate) all[k] = values[of.place[k]];
  const double value = of.formula.response_and_gradient(all, 1.0, ExactRealisation{}, slope).real();
  std::fill(gradient.begin(), gradient.end(), 0.0);
  for (std::size_t k = 0; k < all.size(); ++k)
    if (of.place[k] != covariate) gradient[of.place[k]] += slope[k].real();
  return value;
}

bool Laws::scales(std::size_t name, std::span<const double> values) const {
  std::vector<double> twice(values.begin(), values.end()), gradient(names_.size());
  twice[name] *= 2;
  for (std::size_t l = 0; l < laws_.size(); ++l) {
    if (std::find(laws_[l].place.begin(), laws_[l].place.end(), name) == laws_[l].place.end()) continue;
    const double once = at(l, 0, values, gradient), doubled = at(l, 0, twice, gradient);
    // Rounding of a few operations.
    if (!(std::abs(doubled - 2 * once) <= 1e-12 * std::abs(once))) return false;
  }
  return true;
}

namespace {

/// A search by Levenberg and Marquardt over few residuals; the cost is infinite where one is not finite.
struct LawSearch {
  Eigen::VectorXd at;
  double cost;
};
template <class Residuals>
LawSearch searched(Eigen::VectorXd at, const Residuals& residuals) {
  Eigen::VectorXd residual;
  Eigen::MatrixXd jacobian;
  const auto cost_of = [&](const Eigen::VectorXd& place) {
    residuals(place, residual, jacobian);
    const double cost = residual.squaredNorm();
    return std::isfinite(cost) && jacobian.allFinite() ? cost : std::numeric_limits<double>::infinity();
  };
  LawSearch best{std::move(at), 0};
  best.cost = cost_of(best.at);
  if (!std::isfinite(best.cost)) return best;
  double damping = 1e-3;
  for (int step = 0; step < 100 && damping < 1e12; ++step) {
    residuals(best.at, residual, jacobian);
    const Eigen::Index width = jacobian.cols(), rows = jacobian.rows();
    Eigen::MatrixXd system = Eigen::MatrixXd::Zero(rows + width, width);
    system.topRows(rows) = jacobian;
    for (Eigen::Index k = 0; k < width; ++k)
      system(rows + k, k) = std::sqrt(damping) * std::max(jacobian.col(k).norm(), 1e-300);
    Eigen::VectorXd target = Eigen::VectorXd::Zero(rows + width);
    target.head(rows) = -residual;
    const Eigen::VectorXd next = best.at + Eigen::VectorXd(PivotedQr(system).solve(target));
    const double cost = next.allFinite() ? cost_of(next) : std::numeric_limits<double>::infinity();
    if (!(cost < best.cost)) {
      damping *= 10;
      continue;
    }
    const bool settled = cost > best.cost * (1 - 1e-10);
    best = {next, cost};
    damping = std::max(damping / 10, 1e-12);
    if (settled) break;
  }
  return best;
}

}  // namespace

std::vector<LawMinimum> Laws::minima(const std::vector<std::vector<double>>& parameters,
                                     const std::vector<double>& weights, std::span<const double> given,
                                     int trials) const {
  std::vector<std::size_t> curves;
  for (std::size_t c = 0; c < parameters.size(); ++c)
    if (weights[c] > 0) curves.push_back(c);
  const auto width = static_cast<Eigen::Index>(names_.size());
  const auto of_curves = static_cast<Eigen::Index>(laws_.size() * (curves.size() + 1)), rows = of_curves + width;
  // Parameters above 0 are compared by their logarithms: laws of powers and exponents are straight lines there.
  std::vector<bool> positive;
  for (const Law& law : laws_)
    positive.push_back(
        std::all_of(curves.begin(), curves.end(), [&](std::size_t c) { return parameters[c][law.parameter] > 0; }));
  const auto residuals = [&](const Eigen::VectorXd& place, Eigen::VectorXd& residual, Eigen::MatrixXd& jacobian) {
    residual.setZero(rows);
    jacobian.setZero(rows, width);
    std::vector<double> gradient(names_.size());
    Eigen::Index row = 0;
    for (std::size_t l = 0; l < laws_.size(); ++l) {
      double size = 0;
      for (const std::size_t c : curves) size = std::max(size, std::abs(parameters[c][laws_[l].parameter]));
      for (const std::size_t c : curves) {
        const double value = at(l, c, {place.data(), names_.size()}, gradient),
                     fitted = parameters[c][laws_[l].parameter];
        const double unit = positive[l] ? value : (size > 0 ? size : 1);
        residual(row) = weights[c] * (positive[l] ? std::log(value / fitted) : (value - fitted) / unit);
        for (Eigen::Index k = 0; k < width; ++k)
          jacobian(row, k) = weights[c] * gradient[static_cast<std::size_t>(k)] / unit;
        ++row;
      }
      if (laws_[l].is_shift && positive[l]) {
        // The common factor is searched for along with the rest, which leaves the distance from the mean.  It is drawn
        // to 1 so weakly that only a law with a factor of its own feels it.
        constexpr double pull = 1e-6;
        const auto count = static_cast<Eigen::Index>(curves.size());
        Eigen::VectorXd weight(count);
        for (Eigen::Index k = 0; k < count; ++k) weight(k) = weights[curves[static_cast<std::size_t>(k)]];
        const double share = 1 / (weight.squaredNorm() + pull);
        const double common = weight.dot(residual.segment(row - count, count)) * share;
        const Eigen::RowVectorXd slope = weight.transpose() * jacobian.middleRows(row - count, count) * share;
        residual.segment(row - count, count) -= common * weight;
        jacobian.middleRows(row - count, count) -= weight * slope;
        residual(row) = std::sqrt(pull) * common;
        jacobian.row(row) = std::sqrt(pull) * slope;
      }
      ++row;
    }
    // Laws may follow few leading curves almost as well with ever larger parameters, as a hyperbola that becomes a
    // line.  From so far out no search returns, and a start may miss by a little.
    constexpr double pull_per_decade = 0.3;
    for (Eigen::Index k = 0; k < width; ++k) {
      residual(of_curves + k) = pull_per_decade * std::log10(1 + std::abs(place(k)));
      jacobian(of_curves + k, k) =
          std::copysign(pull_per_decade / std::numbers::ln10 / (1 + std::abs(place(k))), place(k));
    }
  };
  std::mt19937_64 engine(1);
  std::uniform_real_distribution<double> exponent(-2, 4), side(0, 1);
  std::vector<LawMinimum> found;
  for (int trial = 0; trial < trials; ++trial) {
    Eigen::VectorXd place = Eigen::VectorXd::Ones(width);
    for (Eigen::Index k = 0; k < width; ++k) {
      if (trial > 0) place(k) = std::pow(10, exponent(engine)) * (side(engine) < 0.5 ? 1 : -1);
      if (!std::isnan(given[static_cast<std::size_t>(k)])) place(k) = given[static_cast<std::size_t>(k)];
    }
    // A factor of the whole law is above 0 where the law is.
    for (Eigen::Index k = 0; k < width; ++k)
      if (place(k) < 0 && positive.front() && scales(static_cast<std::size_t>(k), {place.data(), names_.size()}))
        place(k) = -place(k);
    const LawSearch here = searched(std::move(place), residuals);
    constexpr double alike = 1e-3;
    const bool is_new = std::none_of(found.begin(), found.end(), [&](const LawMinimum& other) {
      const Eigen::Map<const Eigen::VectorXd> there(other.values.data(), width);
      return (here.at - there).norm() <= alike * there.norm();
    });
    if (std::isfinite(here.cost) && is_new) found.push_back({{here.at.begin(), here.at.end()}, here.cost});
  }
  std::stable_sort(found.begin(), found.end(),
                   [](const LawMinimum& one, const LawMinimum& other) { return one.cost < other.cost; });
  return found;
}

std::vector<std::vector<double>> Laws::starts(const std::vector<std::vector<double>>& parameters,
                                              std::vector<double> weights, std::span<const double> given) const {
  // Laws of known quantities alone leave nothing to search for.
  if (names_.empty()) return {{}};
  const auto leading =
      static_cast<std::size_t>(std::count_if(weights.begin(), weights.end(), [](double weight) { return weight > 0; }));
  // Too few tell nothing of a law; where the others were laid is known to about a factor e.
  if (leading <= names_.size())
    for (double& weight : weights) weight = weight > 0 ? weight : 1;
  constexpr int trials = 40;
  const std::vector<LawMinimum> found = minima(parameters, weights, given, trials);
  if (found.empty()) {
    std::string names;
    for (const std::string& name : names_) names += (names.empty() ? "" : ", ") + name;
    throw std::invalid_argument("no values of " + names + " found with which the laws follow the curves; give starts");
  }
  std::vector<std::vector<double>> starts;
  constexpr std::size_t most = 8;
  for (std::size_t k = 0; k < std::min(found.size(), most); ++k) starts.push_back(found[k].values);
  return starts;
}

std::vector<std::vector<double>> Laws::starts_of_neighbours(const std::vector<std::vector<double>>& parameters,
                                                            std::span<const double> given) const {
  std::vector<std::vector<double>> starts;
  if (names_.empty()) return starts;
  constexpr int trials = 10;
  constexpr std::size_t most = 2;  // of one group
  // A common factor is named along with the names.
  for (std::size_t size = names_.size() + 1; size <= names_.size() + 2; ++size) {
    for (std::size_t first = 0; first + size <= parameters.size(); ++first) {
      std::vector<double> weights(parameters.size(), 0.0);
      std::fill_n(weights.begin() + static_cast<std::ptrdiff_t>(first), size, 1.0);
      const std::vector<LawMinimum> found = minima(parameters, weights, given, trials);
      for (std::size_t k = 0; k < std::min(found.size(), most); ++k) starts.push_back(found[k].values);
    }
  }
  return starts;
}

}  // namespace frac::detail
