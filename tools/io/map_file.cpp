// SPDX-License-Identifier: BSD-3-Clause
#include "io/map_file.hpp"

#include "io/number.hpp"
#include "io/shard_file.hpp"
#include "io/sweep_file.hpp"

namespace io {

std::string map_csv(const backlash::RegimeMap& map, const std::string& command, const Shard& shard) {
  Metadata scene{{"mass1_kg", format_number(map.scene.mass1)},
                 {"mass2_kg", format_number(map.scene.mass2)},
                 {"clearance_m", format_number(map.scene.clearance)},
                 {"force_n", format_number(map.scene.force_amplitude)},
                 {"output", std::string(backlash::to_string(map.options.output))},
                 {"protocol", std::string(backlash::to_string(map.options.protocol))},
                 {"tolerance", format_number(map.options.tolerance)},
                 {"mean_tolerance", format_number(map.options.mean_tolerance)}};
  if (shard.count > 1) scene.emplace_back(std::string(shard_key), text_of(shard));
  std::string text = header_lines(scene, command);
  text += "restitution," + std::string(point_columns(PointColumns::with_diagnostics)) + "\n";
  for (std::size_t i = 0; i < map.restitution.size(); ++i) {
    const std::string restitution = format_number(map.restitution[i]) + ",";
    for (std::size_t j = 0; j < map.omega.size(); ++j) {
      text += restitution;
      append_point(text, map.at(i, j), PointColumns::with_diagnostics);
      text += '\n';
    }
  }
  if (shard.count > 1) text += checksum_line(text);
  return text;
}

}  // namespace io
