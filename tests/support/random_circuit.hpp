// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cctype>
#include <cmath>
#include <map>
#include <random>
#include <set>
#include <sstream>
#include <string>

#include "frac/identification/model_library.hpp"

namespace support {

/// "R0+(R1|C1)" of a model of the family elements.
inline std::string circuit_of(const frac::NamedModel& model) {
  return model.name.substr(model.name.find(':') + 1);
}

/// Elements without their numbers.
inline std::multiset<std::string> kinds_in(const frac::NamedModel& model) {
  std::multiset<std::string> kinds;
  std::istringstream circuit(circuit_of(model));
  for (std::string element; std::getline(circuit, element, '+');) {
    std::erase_if(element, [](unsigned char c) { return std::isdigit(c) != 0; });
    kinds.insert(element);
  }
  return kinds;
}

/// A circuit of some kinds, in numbers.
struct Circuit {
  std::string formula;
  std::multiset<std::string> kinds;
  std::map<std::string, double> values;  // of R0, L0
};

/// A resistor, in 4 of 10 an inductor, one or two of RC, R with a CPE or Gerischer, and in 8 of 10 one of W, Wo, Ws and
/// C; times two decades apart, for 1e-2 to 1e5 rad/s.
inline Circuit random_circuit(std::mt19937_64& generator) {
  std::uniform_real_distribution<double> uniform(0, 1);
  const auto draw = [&] { return uniform(generator); };
  const auto log_uniform = [&](double low, double decades) { return low * std::pow(10.0, decades * draw()); };
  const auto text = [](double value) {
    std::ostringstream out;
    out.precision(12);
    out << value;
    return out.str();
  };
  Circuit circuit;
  const auto put = [&](const std::string& kind, const std::string& formula) {
    circuit.kinds.insert(kind);
    circuit.formula += (circuit.formula.empty() ? "" : " + ") + formula;
  };
  const double r0 = log_uniform(0.3, 1);
  circuit.values["R0"] = r0;
  put("R", text(r0));
  if (draw() < 0.4) {
    circuit.values["L0"] = r0 * log_uniform(1e-5, 1);
    put("L", text(circuit.values["L0"]) + " s");
  }
  double decade = -3.5;
  for (int arcs = draw() < 0.5 ? 1 : 2; arcs > 0; --arcs, decade += 2) {
    const std::string t = text(log_uniform(std::pow(10.0, decade), 0.5)), r = text(log_uniform(0.5, 0.8));
    const double kind = draw();
    if (kind < 0.25) {
      put("(R|C)", r + "/(1 + " + t + " s)");
    } else if (kind < 0.8) {
      put("(R|CPE)", r + "/(1 + (" + t + " s)^" + text(0.65 + 0.25 * draw()) + ")");
    } else {
      put("G", r + "/sqrt(1 + " + t + " s)");
    }
  }
  const double kind = draw();
  const std::string root = "sqrt(" + text(log_uniform(std::pow(10.0, decade + 1), 0.5)) + " s)";
  const std::string r = text(log_uniform(1, 0.8));
  if (kind < 0.2) {
    put("W", r + "/sqrt(s)");
  } else if (kind < 0.4) {
    put("Wo", r + " coth(" + root + ")/" + root);
  } else if (kind < 0.6) {
    put("Ws", r + " tanh(" + root + ")/" + root);
  } else if (kind < 0.8) {
    put("C", "1/(" + r + " s)");
  }
  return circuit;
}

}  // namespace support
