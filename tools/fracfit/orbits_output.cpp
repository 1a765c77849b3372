#include "orbits_output.hpp"

#include <cmath>
#include <nlohmann/json.hpp>

#include "io/number.hpp"
#include "io/sweep_file.hpp"

namespace fracfit {
namespace {

using Json = nlohmann::ordered_json;

Json number(double value) {
  return std::isfinite(value) ? Json(value) : Json(nullptr);
}

io::Metadata scene_of(const backlash::OrbitDiagram& diagram) {
  return {{"mass1_kg", io::format_number(diagram.system.mass1())},
          {"mass2_kg", io::format_number(diagram.system.mass2())},
          {"clearance_m", io::format_number(diagram.system.clearance())},
          {"force_n", io::format_number(diagram.force_amplitude)},
          {"restitution", io::format_number(diagram.system.restitution())},
          {"omega_from_rad_s", io::format_number(diagram.omega_from)},
          {"omega_to_rad_s", io::format_number(diagram.omega_to)},
          {"output", std::string(backlash::to_string(diagram.options.output))},
          {"longest_period", std::to_string(diagram.options.longest_period)},
          {"most_impacts", std::to_string(diagram.options.most_impacts)}};
}

double impacts_per_period(const backlash::OrbitBranch& branch) {
  return static_cast<double>(branch.impacts) / branch.period;
}

void append_row(std::string& text, std::size_t index, const backlash::OrbitBranch& branch, std::string_view kind,
                const backlash::PeriodicOrbit& orbit) {
  text += std::to_string(index) + "," + std::string(kind) + ",";
  for (const double value : {orbit.omega, orbit.value.real(), orbit.value.imag()}) {
    io::append_number(text, value);
    text += ',';
  }
  text += std::to_string(branch.period) + ",";
  io::append_number(text, impacts_per_period(branch));
  text += branch.symmetric ? ",symmetric" : ",asymmetric";
  text += orbit.stable ? ",stable" : ",unstable";
  for (const auto& multiplier : orbit.multipliers) {
    for (const double value : {multiplier.real(), multiplier.imag()}) {
      text += ',';
      io::append_number(text, value);
    }
  }
  text += '\n';
}

Json orbit_json(const backlash::PeriodicOrbit& orbit) {
  Json json{{"omega_rad_s", number(orbit.omega)},
            {"re_m_per_n", number(orbit.value.real())},
            {"im_m_per_n", number(orbit.value.imag())},
            {"stable", orbit.stable}};
  json["multipliers"] = Json::array();
  for (const auto& multiplier : orbit.multipliers)
    json["multipliers"].push_back({number(multiplier.real()), number(multiplier.imag())});
  json["impacts"] = Json::array();
  for (const auto& impact : orbit.impacts)
    json["impacts"].push_back({{"phase_rad", number(impact.phase)},
                               {"wall", impact.wall == backlash::Wall::near ? "near" : "far"},
                               {"speed_m_per_s", number(impact.speed)}});
  return json;
}

}  // namespace

std::string orbits_csv(const backlash::OrbitDiagram& diagram, const std::string& command) {
  std::string text = "# fracfit: " + std::string(io::version()) + "\n# command: " + command + "\n";
  for (const auto& [key, value] : scene_of(diagram)) text += "# " + key + ": " + value + "\n";
  text +=
      "branch,kind,omega_rad_s,re_m_per_n,im_m_per_n,period,impacts_per_period,symmetry,stability,re_multiplier1,"
      "im_multiplier1,re_multiplier2,im_multiplier2\n";
  for (std::size_t i = 0; i < diagram.branches.size(); ++i) {
    const auto& branch = diagram.branches[i];
    auto next = branch.bifurcations.begin();
    for (std::size_t j = 0; j < branch.orbits.size(); ++j) {
      append_row(text, i + 1, branch, "orbit", branch.orbits[j]);
      for (; next != branch.bifurcations.end() && next->after <= j; ++next)
        append_row(text, i + 1, branch, backlash::to_string(next->kind), next->orbit);
    }
  }
  return text;
}

std::string orbits_json(const backlash::OrbitDiagram& diagram, const std::string& command) {
  Json json{{"fracfit", io::version()}, {"command", command}};
  for (const auto& [key, value] : scene_of(diagram)) {
    const auto parsed = io::parse_number(value);
    json["scene"][key] = parsed ? number(*parsed) : Json(value);
  }
  json["branches"] = Json::array();
  for (const auto& branch : diagram.branches) {
    Json entry{{"period", branch.period},
               {"impacts_per_period", number(impacts_per_period(branch))},
               {"symmetric", branch.symmetric},
               {"begin", backlash::to_string(branch.begin)},
               {"end", backlash::to_string(branch.end)}};
    entry["orbits"] = Json::array();
    for (const auto& orbit : branch.orbits) entry["orbits"].push_back(orbit_json(orbit));
    entry["bifurcations"] = Json::array();
    for (const auto& point : branch.bifurcations) {
      Json bifurcation{{"kind", backlash::to_string(point.kind)}, {"after", point.after}};
      bifurcation.update(orbit_json(point.orbit));
      entry["bifurcations"].push_back(std::move(bifurcation));
    }
    json["branches"].push_back(std::move(entry));
  }
  return json.dump(1, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace fracfit
