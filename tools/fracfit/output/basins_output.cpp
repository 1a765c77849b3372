// SPDX-License-Identifier: BSD-3-Clause
#include "output/basins_output.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string_view>
#include <vector>

#include "io/number.hpp"
#include "output/aligned_table.hpp"
#include "output/json.hpp"

namespace fracfit {
namespace {

// What the starts are told apart by.
std::string motion_name(const backlash::BasinMap& map) {
  return map.attracts() ? "attractor" : "motion";
}

double share_of(const backlash::BasinMap& map, const backlash::Attractor& attractor) {
  return static_cast<double>(attractor.starts) / static_cast<double>(map.attractor.size());
}

// Of each motion, beside its values, what limits them.
std::string remark_on(const backlash::DescribingFunctionPoint& point) {
  std::string remark;
  if (point.transient_possible)
    remark = "transient not excluded after " + short_number(point.periods_followed) + " periods";
  if (!std::isnan(point.force_sensitivity)) remark += (remark.empty() ? "" : "; ") + std::string("lost in rounding");
  return remark;
}

// Indices of at most `most` of `count` things, evenly spread and with both ends.
std::vector<std::size_t> evenly_spread(std::size_t count, std::size_t most) {
  std::vector<std::size_t> index;
  const std::size_t kept = std::min(count, most);
  for (std::size_t i = 0; i < kept; ++i) index.push_back(kept < 2 ? 0 : i * (count - 1) / (kept - 1));
  return index;
}

// One character per start: velocity to the right, position upward, as far as a terminal holds them.
std::string picture(const backlash::BasinMap& map) {
  constexpr std::string_view symbols = "0123456789abcdefghijklmnopqrstuvwxyz";
  constexpr std::size_t most_columns = 64, most_rows = 25, scale_width = 12;
  const auto columns = evenly_spread(map.velocity.size(), most_columns);
  auto rows = evenly_spread(map.position.size(), most_rows);
  std::reverse(rows.begin(), rows.end());
  const auto padded = [](const std::string& text, std::size_t width) {
    return std::string(width - std::min(width, text.size()), ' ') + text;
  };
  std::string text = "start at position (m, upward) and velocity (m/s, to the right) leads to\n\n";
  for (const std::size_t row : rows) {
    const bool marked = row == rows.front() || row == rows.back();
    text += padded(marked ? short_number(map.position[row]) : "", scale_width) + "  ";
    for (const std::size_t column : columns) {
      const std::size_t motion = map.attractor[row * map.velocity.size() + column];
      text += motion < symbols.size() ? symbols[motion] : '*';
    }
    text += '\n';
  }
  const std::string first = short_number(map.velocity[columns.front()]),
                    last = short_number(map.velocity[columns.back()]);
  text += std::string(scale_width + 2, ' ') + first;
  if (columns.size() > 1) text += padded(last, std::max(columns.size(), first.size() + 1 + last.size()) - first.size());
  return text + '\n';
}

}  // namespace

io::Metadata basins_scene(const backlash::BasinMap& map, backlash::Output output, const io::Metadata& contact) {
  const auto number = [](double value) { return io::format_number(value); };
  io::Metadata scene{{"mass1_kg", number(map.system.mass1())},
                     {"mass2_kg", number(map.system.mass2())},
                     {"clearance_m", number(map.system.clearance())},
                     {"force_n", number(map.force_amplitude)}};
  if (contact.empty()) scene.emplace_back("restitution", number(map.system.restitution()));
  scene.insert(scene.end(), contact.begin(), contact.end());
  scene.emplace_back("omega_rad_s", number(map.omega));
  scene.emplace_back("output", std::string(backlash::to_string(output)));
  return scene;
}

Document basins_document(const backlash::BasinMap& map, backlash::Output output, const io::Metadata& contact) {
  Document result{basins_scene(map, output, contact),
                  {{"position_m", "velocity_m_s", motion_name(map)}, map.attractor.size(), {}}};
  if (!map.attracts()) result.head.emplace_back("note", no_attractor);
  for (std::size_t i = 0; i < map.attractors.size(); ++i) {
    const auto& [point, symmetric, starts] = map.attractors[i];
    result.head.emplace_back(
        motion_name(map) + " " + std::to_string(i),
        "share " + io::format_number(share_of(map, map.attractors[i])) + ", regime " +
            std::string(backlash::to_string(point.regime)) + ", period " + std::to_string(point.period) +
            (std::isnan(point.impacts_per_period)
                 ? ""
                 : ", impacts per period " + io::format_number(point.impacts_per_period)) +
            (symmetric ? ", symmetric" : ", asymmetric") + ", N " + io::format_number(point.value.real()) +
            (std::signbit(point.value.imag()) ? " - " : " + ") + io::format_number(std::abs(point.value.imag())) +
            " j m/N, uncertainty " + io::format_number(point.uncertainty) +
            (point.transient_possible
                 ? ", transient not excluded after " + io::format_number(point.periods_followed) + " periods"
                 : "") +
            (std::isnan(point.force_sensitivity)
                 ? ""
                 : ", lost in rounding: mean over forces that differ in the last digits, N changes by up to " +
                       io::format_number(point.force_sensitivity) + " times the relative change of the force"));
  }
  result.rows.fill = [&map](std::size_t i, std::vector<Cell>& cells) {
    cells.emplace_back(map.position[i / map.velocity.size()]);
    cells.emplace_back(map.velocity[i % map.velocity.size()]);
    cells.emplace_back(static_cast<std::int64_t>(map.attractor[i]));
  };
  return result;
}

std::string basins_json(const backlash::BasinMap& map, backlash::Output output, const io::Metadata& contact,
                        const std::string& command) {
  Json result = origin(command);
  for (const auto& [key, value] : basins_scene(map, output, contact)) {
    const auto parsed = io::parse_number(value);
    result["scene"][key] = parsed ? Json(*parsed) : Json(value);
  }
  if (!map.attracts()) result["note"] = no_attractor;
  result[motion_name(map) + "s"] = Json::list(map.attractors, [&](const auto& attractor) {
    return Json{{"share", share_of(map, attractor)},
                {"starts", attractor.starts},
                {"regime", backlash::to_string(attractor.point.regime)},
                {"period", attractor.point.period},
                {"impacts_per_period", attractor.point.impacts_per_period},
                {"symmetric", attractor.symmetric},
                {"re_m_per_n", attractor.point.value.real()},
                {"im_m_per_n", attractor.point.value.imag()},
                {"uncertainty_m_per_n", attractor.point.uncertainty},
                {"lyapunov_exponent", attractor.point.lyapunov_exponent},
                {"periods_followed", attractor.point.periods_followed},
                {"transient_possible", attractor.point.transient_possible},
                {"force_sensitivity", attractor.point.force_sensitivity}};
  });
  result["position_m"] = map.position;
  result["velocity_m_s"] = map.velocity;
  result[motion_name(map)] = map.attractor;
  return result.dump(-1) + "\n";
}

std::string basins_table(const backlash::BasinMap& map, backlash::Output output, const io::Metadata& contact) {
  std::string text = "two masses with backlash, of which " + std::string(backlash::to_string(output)) + " is read\n";
  for (const auto& [key, value] : basins_scene(map, output, contact))
    if (key != "output") text += (text.ends_with('\n') ? "" : ", ") + key + " " + value;
  text += "\n\n";
  AlignedTable table(
      {motion_name(map), "share", "regime", "period", "impacts", "symmetric", "re m/N", "im m/N", "uncertainty", ""},
      AlignedTable::Last::remark);
  for (std::size_t i = 0; i < map.attractors.size(); ++i) {
    const auto& [point, symmetric, starts] = map.attractors[i];
    table.add({std::to_string(i), short_number(100 * share_of(map, map.attractors[i]), 3) + " %",
               std::string(backlash::to_string(point.regime)), std::to_string(point.period),
               short_number(point.impacts_per_period), symmetric ? "yes" : "no", short_number(point.value.real()),
               short_number(point.value.imag()), short_number(point.uncertainty, 2), remark_on(point)});
  }
  return text + table.text() + "\n" + picture(map);
}

}  // namespace fracfit
