#include "canonical_labels.hpp"

#include <algorithm>
#include <complex>
#include <map>
#include <string>

namespace frac::detail {
namespace {

struct Label {
  std::string stem;
  int number;  // -1: none
};

Label label_of(const std::string& name) {
  const std::size_t digits = name.find_last_not_of("0123456789") + 1;
  if (digits == 0 || digits == name.size() || name.size() - digits > 6) return {name, -1};
  return {name.substr(0, digits), std::stoi(name.substr(digits))};
}

bool same_model(const Structure& structure, const std::vector<double>& a, const std::vector<double>& b) {
  for (const double omega : {0.37, 1.9}) {
    const std::complex<double> value = structure.response(a, omega);
    const std::complex<double> other = structure.response(b, omega);
    if (!(std::abs(value - other) <= 1e-10 * std::abs(value))) return false;
  }
  return true;
}

// Exchanges two orders, and two coefficients unless they are the same, where the model allows it.
bool exchange(const Structure& structure, std::vector<double>& parameters, std::size_t order, std::size_t other_order,
              std::size_t coefficient, std::size_t other_coefficient) {
  std::vector<double> exchanged = parameters;
  std::swap(exchanged[order], exchanged[other_order]);
  std::swap(exchanged[coefficient], exchanged[other_coefficient]);
  if (!same_model(structure, parameters, exchanged)) return false;
  parameters = std::move(exchanged);
  return true;
}

// The higher order to the name that comes first.
void order_by_appearance(const Structure& structure, const std::vector<std::size_t>& orders,
                         const std::vector<std::size_t>& coefficients, std::vector<double>& parameters) {
  for (std::size_t a = 0; a < orders.size(); ++a) {
    for (std::size_t b = a + 1; b < orders.size(); ++b) {
      if (parameters[orders[a]] >= parameters[orders[b]]) continue;
      bool done = coefficients.empty()
                      ? false
                      : exchange(structure, parameters, orders[a], orders[b], coefficients[0], coefficients[0]);
      for (std::size_t c = 0; c < coefficients.size() && !done; ++c) {
        for (std::size_t d = c + 1; d < coefficients.size() && !done; ++d) {
          done = exchange(structure, parameters, orders[a], orders[b], coefficients[c], coefficients[d]);
        }
      }
    }
  }
}

}  // namespace

std::vector<double> canonical_labels(const Structure& structure, const std::vector<ParameterConstraint>& constraints,
                                     std::vector<double> parameters) {
  const auto& names = structure.parameter_names();
  std::vector<std::size_t> orders, coefficients;            // without a number
  std::map<int, std::map<std::string, std::size_t>> group;  // number -> stem -> parameter
  for (std::size_t i = 0; i < names.size(); ++i) {
    const auto [stem, number] = label_of(names[i]);
    const bool constrained = std::any_of(constraints.begin(), constraints.end(),
                                         [&](const ParameterConstraint& each) { return each.name == names[i]; });
    if (constrained) continue;
    if (number >= 0) {
      group[number].emplace(stem, i);
    } else if (structure.parameter_roles()[i] == ParameterRole::order) {
      orders.push_back(i);
    } else if (structure.parameter_roles()[i] == ParameterRole::coefficient) {
      coefficients.push_back(i);
    }
  }
  order_by_appearance(structure, orders, coefficients, parameters);
  const auto leading_order = [&](const std::map<std::string, std::size_t>& members) -> const double* {
    for (const auto& [stem, i] : members) {
      if (structure.parameter_roles()[i] == ParameterRole::order) return &parameters[i];
    }
    return nullptr;
  };
  // As many passes as a sort by neighbours takes at most.
  for (std::size_t pass = 0; pass < group.size(); ++pass) {
    for (auto low = group.begin(); low != group.end(); ++low) {
      for (auto high = std::next(low); high != group.end(); ++high) {
        const double* first = leading_order(low->second);
        const double* second = leading_order(high->second);
        if (!first || !second || *first <= *second) continue;
        std::vector<double> exchanged = parameters;
        for (const auto& [stem, i] : low->second) {
          if (const auto other = high->second.find(stem); other != high->second.end()) {
            std::swap(exchanged[i], exchanged[other->second]);
          }
        }
        if (same_model(structure, parameters, exchanged)) parameters = std::move(exchanged);
      }
    }
  }
  return parameters;
}

}  // namespace frac::detail
