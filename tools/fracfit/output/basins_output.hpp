// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "backlash/basins.hpp"
#include "output/document.hpp"

namespace fracfit {

/// Said where nothing attracts.
constexpr const char* no_attractor =
    "at restitution 1 impacts lose no energy and nothing attracts: the motions listed are those of these starts, told "
    "apart by their long-time means; other starts have others";

/// The scene that was asked for, as entries of a head. @param contact  entries in place of a restitution, if any
[[nodiscard]] io::Metadata basins_scene(const backlash::BasinMap& map, backlash::Output output,
                                        const io::Metadata& contact);

/// Scene and motions in the head, one row per start.
[[nodiscard]] Document basins_document(const backlash::BasinMap& map, backlash::Output output,
                                       const io::Metadata& contact);

[[nodiscard]] std::string basins_json(const backlash::BasinMap& map, backlash::Output output,
                                      const io::Metadata& contact, const std::string& command);

/// For people: the motions, and which start leads to which as a picture of characters.
[[nodiscard]] std::string basins_table(const backlash::BasinMap& map, backlash::Output output,
                                       const io::Metadata& contact);

}  // namespace fracfit
