// SPDX-License-Identifier: BSD-3-Clause
#include "frac/identification/component_power_law.hpp"

#include <complex>
#include <limits>
#include <stdexcept>
#include <vector>

namespace frac {
namespace {

struct Part {
  const char* symbol;   // Im
  const char* name;     // imaginary part
  const char* formula;  // of value K omega^b in that component
};

Part part_of(Component component) {
  switch (component) {
    case Component::imaginary:
      return {"Im", "the imaginary part", "K s sqrt(-s^2)^b/sqrt(-s^2)"};
    case Component::real:
      return {"Re", "the real part", "K sqrt(-s^2)^b"};
    case Component::magnitude:
      return {"magnitude", "the magnitude", "K sqrt(-s^2)^b"};
    case Component::both:
    case Component::phase:
      break;
  }
  throw std::invalid_argument("component " + std::string(to_string(component)) + ": " +
                              std::string(component_power_law_name) +
                              " is a power law of one part of the response; expected imaginary, real or magnitude");
}

}  // namespace

NamedModel component_power_law(Component component) {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  // The widest limits that an order may have: nothing is known of this one.
  constexpr double widest = 20;
  const bool positive = component == Component::magnitude;
  std::vector<ParameterConstraint> constraints{{"b", {}, -widest, widest, {}}};
  if (!positive) constraints.push_back({"K", {}, -infinity, {}, {}});
  return {std::string(component_power_law_name), part_of(component).formula, ModelClass::fractional,
          "power law of one component", std::move(constraints)};
}

std::string component_power_law_sentence(Component component) {
  const Part part = part_of(component);
  std::string text =
      std::string(part.symbol) + " = K omega^b, a power law of " + part.name + " alone: it says nothing of the rest";
  if (component != Component::magnitude)
    text += std::string(", and no transfer function with real coefficients goes with it (K s^b has ") + part.name +
            " K " + (component == Component::imaginary ? "sin" : "cos") + "(b pi/2) omega^b)";
  return text;
}

FrequencyResponseData component_alone(const FrequencyResponseData& data, Component component) {
  static_cast<void>(part_of(component));
  if (component == Component::magnitude) return data;
  std::vector<std::complex<double>> value;
  value.reserve(data.size());
  for (const auto& each : data.value())
    value.push_back(component == Component::imaginary ? std::complex<double>(0, each.imag()) : each.real());
  return {data.omega(), std::move(value), data.sigma(), data.frequency_unit()};
}

}  // namespace frac
