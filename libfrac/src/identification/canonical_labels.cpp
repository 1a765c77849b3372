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

}  // namespace

std::vector<double> canonical_labels(const Structure& structure, const std::vector<ParameterConstraint>& constraints,
                                     std::vector<double> parameters) {
  const auto& names = structure.parameter_names();
  std::map<int, std::map<std::string, std::size_t>> group;  // number -> stem -> parameter
  for (std::size_t i = 0; i < names.size(); ++i) {
    const auto [stem, number] = label_of(names[i]);
    const bool constrained = std::any_of(constraints.begin(), constraints.end(),
                                         [&](const ParameterConstraint& each) { return each.name == names[i]; });
    if (number >= 0 && !constrained) group[number].emplace(stem, i);
  }
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
