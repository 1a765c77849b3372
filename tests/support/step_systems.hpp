// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <complex>
#include <fstream>
#include <map>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "frac/model/fractional_transfer_function.hpp"

namespace support {

inline std::vector<std::vector<std::string>> text_rows(const std::string& name) {
  std::ifstream file(std::string(FRACFIT_SOURCE_DIR) + "/data/reference/" + name);
  if (!file) throw std::runtime_error("cannot read " + name);
  std::vector<std::vector<std::string>> rows;
  std::string line;
  std::getline(file, line);
  while (std::getline(file, line)) {
    rows.emplace_back();
    std::stringstream stream(line);
    for (std::string cell; std::getline(stream, cell, ',');) rows.back().push_back(cell);
  }
  return rows;
}

struct StepSystem {
  frac::FractionalTransferFunction model;
  std::string poles;  // as in the table, "(re + imj) ..."
};

/// data/reference/step_systems.csv.
inline std::map<std::string, StepSystem> step_systems() {
  const auto terms = [](const std::string& coefficients, const std::string& orders) {
    std::stringstream coefficient(coefficients), order(orders);
    std::vector<frac::PowerTerm> sum;
    for (frac::PowerTerm term{}; coefficient >> term.coefficient && order >> term.order;) sum.push_back(term);
    return sum;
  };
  std::map<std::string, StepSystem> systems;
  for (const auto& row : text_rows("step_systems.csv")) {
    systems.emplace(row[0], StepSystem{{terms(row[1], row[2]), terms(row[3], row[4])}, row.size() > 5 ? row[5] : ""});
  }
  return systems;
}

struct StepValue {
  std::string system;
  double t, y;
};

/// data/reference/step_response.csv.
inline std::vector<StepValue> step_values() {
  std::vector<StepValue> values;
  for (const auto& row : text_rows("step_response.csv"))
    values.push_back({row[0], std::stod(row[1]), std::stod(row[2])});
  return values;
}

/// Systems without a table: a pole a degree from the cut or on the next sheet beside it, high and integer orders,
/// double and near-cancelling poles, integrators, an unstable one, dead time.
inline const std::vector<std::string>& hard_systems() {
  static const std::vector<std::string> systems{"1/(14994 s^1.31 + 6009.5 s^0.97 + 1.69)",
                                                "1/(s^0.99 + 1)",
                                                "(s^0.5 + 0.5)/(s + 0.2 s^0.5 + 2)",
                                                "1/(s^0.6 + 10)",
                                                "1/(s^1.2 - 2)",
                                                "1/(s (s^0.5 + 1))",
                                                "s^0.5/(s + 1)",
                                                "exp(-2 s)/(s^1.5 + 1)",
                                                "1/(s^3.5 + 1)",
                                                "1/(s^2 + 2 s^1.5 + s)",
                                                "1/(s^2 + 2 s + 1)",
                                                "(s + 1)/(s^2 + 3 s + 2.0000001)",
                                                "1/(0.8 s^2.2 + 0.5 s^0.9 + 1)",
                                                "(1 - s^0.8)/(s^1.6 + s^0.8 + 1)",
                                                "1/(s^1.0001 + 1)",
                                                "1/(s^3 + 3 s^2 + 3 s + 1)"};
  return systems;
}

}  // namespace support
