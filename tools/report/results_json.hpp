// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "report/section.hpp"

namespace report {

struct StageTime {
  std::string name;
  double seconds;
};

/// How the report was made.
struct Provenance {
  std::string version, command, compiler, build_type;
  int threads;
  std::vector<StageTime> stages;
  Metadata inputs;  // what it was made from: the scene in SI units, or the data files
};

/// results.json: provenance, headline numbers, every table of the page in full, what the figures of
/// measured data show, and the names of the rest.
[[nodiscard]] std::string results_json(const Provenance& provenance, const std::vector<Section>& sections,
                                       bool pictures);

}  // namespace report
