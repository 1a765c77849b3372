// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "frac/identification/model_library.hpp"
#include "frac/structure.hpp"

namespace frac::detail {

/// A structure that is a preset, however it is written.
struct RecognisedPreset {
  const NamedModel* preset;                  // of model_library()
  std::vector<std::string> preset_names;     // of its parameters, in the order of the preset
  std::vector<std::string> structure_names;  // what the structure calls them
};
[[nodiscard]] std::optional<RecognisedPreset> recognised_preset(const Structure& structure);

/// The constraints with parameters of other names, those on names that are not in the list left out.
[[nodiscard]] std::vector<ParameterConstraint> renamed(const std::vector<ParameterConstraint>& constraints,
                                                       const std::vector<std::string>& names,
                                                       const std::vector<std::string>& new_names);

}  // namespace frac::detail
