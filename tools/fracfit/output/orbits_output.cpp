// SPDX-License-Identifier: BSD-3-Clause
#include "output/orbits_output.hpp"

#include <utility>

#include "io/number.hpp"
#include "output/document.hpp"
#include "output/json.hpp"

namespace fracfit {
namespace {

// Column of the quantity that changes along a branch, as in every other file.
std::string parameter_column(backlash::OrbitParameter parameter) {
  switch (parameter) {
    case backlash::OrbitParameter::force:
      return "force_n";
    case backlash::OrbitParameter::clearance:
      return "clearance_m";
    case backlash::OrbitParameter::restitution:
      return "restitution";
    case backlash::OrbitParameter::contact_frequency:
      return "contact_frequency_rad_s";
    case backlash::OrbitParameter::omega:
      break;
  }
  return "omega_rad_s";
}

io::Metadata scene_of(const backlash::OrbitDiagram& diagram, const io::Metadata& contact) {
  io::Metadata scene = {{"mass1_kg", io::format_number(diagram.system.mass1())},
                        {"mass2_kg", io::format_number(diagram.system.mass2())}};
  using backlash::OrbitParameter;
  for (const auto& [parameter, value] : {std::pair{OrbitParameter::clearance, diagram.system.clearance()},
                                         std::pair{OrbitParameter::force, diagram.force_amplitude},
                                         std::pair{OrbitParameter::restitution, diagram.system.restitution()},
                                         std::pair{OrbitParameter::omega, diagram.omega}}) {
    const bool is_told = parameter == OrbitParameter::restitution && !contact.empty();
    if (parameter != diagram.parameter && !is_told)
      scene.emplace_back(parameter_column(parameter), io::format_number(value));
  }
  for (const auto& entry : contact) {
    // Where the frequency changes, what is left of the contact is its ratio.
    const bool changes = diagram.parameter == OrbitParameter::contact_frequency && entry.first.starts_with("contact_");
    if (!changes || entry.first == "contact_ratio" || entry.first == "contact_restitution") scene.push_back(entry);
  }
  scene.emplace_back("parameter", std::string(backlash::to_string(diagram.parameter)));
  scene.emplace_back("from", io::format_number(diagram.from));
  scene.emplace_back("to", io::format_number(diagram.to));
  scene.emplace_back("output", std::string(backlash::to_string(diagram.options.output)));
  scene.emplace_back("longest_period", std::to_string(diagram.options.longest_period));
  scene.emplace_back("most_impacts", std::to_string(diagram.options.most_impacts));
  return scene;
}

double impacts_per_period(const backlash::OrbitBranch& branch) {
  return static_cast<double>(branch.impacts) / branch.period;
}

void append_cells(std::vector<Cell>& cells, std::size_t index, const backlash::OrbitBranch& branch,
                  std::string_view kind, const backlash::PeriodicOrbit& orbit) {
  cells.emplace_back(static_cast<std::int64_t>(index));
  cells.emplace_back(std::string(kind));
  for (const double value : {orbit.parameter, orbit.value.real(), orbit.value.imag()}) cells.emplace_back(value);
  cells.emplace_back(std::int64_t{branch.period});
  cells.emplace_back(impacts_per_period(branch));
  cells.emplace_back(std::string(branch.symmetric ? "symmetric" : "asymmetric"));
  cells.emplace_back(std::string(orbit.stable ? "stable" : "unstable"));
  for (const auto& multiplier : orbit.multipliers)
    for (const double value : {multiplier.real(), multiplier.imag()}) cells.emplace_back(value);
}

Json orbit_json(const backlash::PeriodicOrbit& orbit, backlash::OrbitParameter parameter) {
  const auto impact_json = [](const auto& impact) {
    return Json{{"phase_rad", impact.phase},
                {"wall", impact.wall == backlash::Wall::near ? "near" : "far"},
                {"speed_m_per_s", impact.speed}};
  };
  return {{parameter_column(parameter), orbit.parameter},
          {"re_m_per_n", orbit.value.real()},
          {"im_m_per_n", orbit.value.imag()},
          {"stable", orbit.stable},
          {"multipliers", Json{orbit.multipliers[0], orbit.multipliers[1]}},
          {"impacts", Json::list(orbit.impacts, impact_json)}};
}

}  // namespace

std::string orbits_text(const backlash::OrbitDiagram& diagram, const io::Metadata& contact, const std::string& format,
                        const std::string& command) {
  // One row: branch, orbit or bifurcation.
  struct Row {
    std::size_t branch;
    std::string_view kind;
    const backlash::PeriodicOrbit* orbit;
  };
  std::vector<Row> rows;
  for (std::size_t i = 0; i < diagram.branches.size(); ++i) {
    const auto& branch = diagram.branches[i];
    auto next = branch.bifurcations.begin();
    for (std::size_t j = 0; j < branch.orbits.size(); ++j) {
      rows.push_back({i, "orbit", &branch.orbits[j]});
      for (; next != branch.bifurcations.end() && next->after <= j; ++next)
        rows.push_back({i, backlash::to_string(next->kind), &next->orbit});
    }
  }
  return text_of({scene_of(diagram, contact),
                  {{"branch", "kind", parameter_column(diagram.parameter), "re_m_per_n", "im_m_per_n", "period",
                    "impacts_per_period", "symmetry", "stability", "re_multiplier1", "im_multiplier1", "re_multiplier2",
                    "im_multiplier2"},
                   rows.size(),
                   [&](std::size_t i, std::vector<Cell>& cells) {
                     const auto& [branch, kind, orbit] = rows[i];
                     append_cells(cells, branch + 1, diagram.branches[branch], kind, *orbit);
                   }}},
                 format, command);
}

std::string orbits_json(const backlash::OrbitDiagram& diagram, const io::Metadata& contact,
                        const std::string& command) {
  Json json = origin(command);
  for (const auto& [key, value] : scene_of(diagram, contact)) {
    const auto parsed = io::parse_number(value);
    json["scene"][key] = parsed ? Json(*parsed) : Json(value);
  }
  const auto orbit = [&](const backlash::PeriodicOrbit& each) { return orbit_json(each, diagram.parameter); };
  const auto bifurcation = [&](const auto& point) {
    Json made{{"kind", backlash::to_string(point.kind)}, {"after", point.after}};
    made.update(orbit(point.orbit));
    return made;
  };
  json["branches"] = Json::list(diagram.branches, [&](const auto& branch) {
    return Json{{"period", branch.period},
                {"impacts_per_period", impacts_per_period(branch)},
                {"symmetric", branch.symmetric},
                {"begin", backlash::to_string(branch.begin)},
                {"end", backlash::to_string(branch.end)},
                {"orbits", Json::list(branch.orbits, orbit)},
                {"bifurcations", Json::list(branch.bifurcations, bifurcation)}};
  });
  return json.dump(1) + "\n";
}

}  // namespace fracfit
