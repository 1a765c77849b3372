// SPDX-License-Identifier: BSD-3-Clause
#include "report/scene.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <utility>

#include "io/data_error.hpp"
#include "io/input_text.hpp"
#include "io/number.hpp"
#include "io/number_list.hpp"
#include "report/html.hpp"
#include "report/prose.hpp"

namespace report {

namespace {

using Json = nlohmann::json;

[[noreturn]] void fail(const std::filesystem::path& file, const std::string& message) {
  throw io::DataError(file.string(), 0, 0, message);
}

std::vector<double> numbers(const std::filesystem::path& file, const std::string& name, const Json& value) {
  std::vector<double> list;
  const auto take = [&](const Json& entry) {
    if (!entry.is_number()) {
      fail(file, "\"" + name + "\" holds " + entry.dump() + "; expected a number or a list of numbers");
    }
    list.push_back(entry.get<double>());
  };
  if (value.is_array()) {
    for (const Json& entry : value) take(entry);
  } else if (value.is_string() && name == "omega") {
    try {
      list = io::parse_grid(value.get<std::string>(), "\"omega\"");
    } catch (const std::invalid_argument& error) {
      fail(file, error.what());
    }
  } else {
    take(value);
  }
  if (list.empty()) fail(file, "\"" + name + "\" is an empty list; expected at least one number");
  return list;
}

void check_range(const std::filesystem::path& file, const std::string& name, const std::vector<double>& list,
                 double above, bool may_equal, double at_most) {
  for (const double value : list) {
    if (!std::isfinite(value) || value < above || (value == above && !may_equal) || value > at_most) {
      fail(file, "\"" + name + "\" holds " + io::format_number(value) + "; expected " + (may_equal ? ">= " : "> ") +
                     io::format_number(above) +
                     (std::isfinite(at_most) ? " and <= " + io::format_number(at_most) : ""));
    }
  }
}

void check_distinct(const std::filesystem::path& file, const std::string& name, std::vector<double> list) {
  std::sort(list.begin(), list.end());
  if (const auto twin = std::adjacent_find(list.begin(), list.end()); twin != list.end()) {
    fail(file, "\"" + name + "\" holds " + io::format_number(*twin) + " twice; expected distinct values");
  }
}

double single(const std::filesystem::path& file, const std::string& name, const std::vector<double>& list) {
  if (list.size() != 1)
    fail(file, "\"" + name + "\" is a list of " + std::to_string(list.size()) + "; expected one number");
  return list.front();
}

Json parsed(const std::filesystem::path& file) {
  const auto text = io::input_text(file.string());
  try {
    return Json::parse(*text);
  } catch (const Json::parse_error& error) {
    const std::string_view before = std::string_view(*text).substr(0, error.byte > 0 ? error.byte - 1 : 0);
    const auto line = static_cast<std::size_t>(std::count(before.begin(), before.end(), '\n')) + 1;
    const auto line_begin = before.rfind('\n');
    const std::size_t column = before.size() - (line_begin == std::string_view::npos ? 0 : line_begin + 1) + 1;
    throw io::DataError(file.string(), line, column,
                        before.size() == text->size()
                            ? "is not JSON: it ends too early"
                            : "is not JSON: cannot go on with " + io::quoted(text->substr(before.size(), 1)));
  }
}

void check_rising(const std::filesystem::path& file, const std::vector<double>& omega) {
  if (omega.size() < 5) fail(file, "\"omega\" has " + std::to_string(omega.size()) + " entries; expected at least 5");
  for (std::size_t i = 1; i < omega.size(); ++i) {
    if (omega[i] <= omega[i - 1]) {
      fail(file, "\"omega\" holds " + io::format_number(omega[i]) + " after " + io::format_number(omega[i - 1]) +
                     "; expected rising values");
    }
  }
}

constexpr const char* contacts =
    "expected contact_stiffness with contact_damping, or contact_frequency with contact_ratio or contact_restitution, "
    "in place of restitution";

// The contact that takes time; empty where none of its members is given.
template <class Number>
std::optional<backlash::CompliantContact> contact_of(const std::filesystem::path& file, const Json& json,
                                                     const Number& number, double mass1, double mass2) {
  std::string given;
  for (const auto& [name, value] : json.items())
    if (name.starts_with("contact_")) given += (given.empty() ? "" : " ") + name;
  if (given.empty()) return std::nullopt;
  if (json.contains("restitution")) fail(file, "\"restitution\" and \"" + given + "\" are both given; " + contacts);
  constexpr double infinity = std::numeric_limits<double>::infinity();
  // Members come in the order of their names.
  if (given == "contact_damping contact_stiffness")
    return backlash::CompliantContact(number("contact_stiffness", 0, false, infinity),
                                      number("contact_damping", 0, false, infinity));
  double ratio = 0;
  if (given == "contact_frequency contact_ratio")
    ratio = number("contact_ratio", 0, false, infinity);
  else if (given == "contact_frequency contact_restitution")
    // A contact that loses nothing has no stable orbit.
    ratio = backlash::damping_ratio_of_restitution(number("contact_restitution", 0, false, std::nextafter(1.0, 0.0)));
  else
    fail(file, "a contact is given by \"" + given + "\"; " + contacts);
  return backlash::CompliantContact::from_frequency(number("contact_frequency", 0, false, infinity), ratio, mass1,
                                                    mass2);
}

}  // namespace

std::string base_scene_text(const Scene& scene, bool force, bool clearance, bool restitution) {
  std::vector<std::string> parts;
  if (force) parts.push_back("F = " + html_number(scene.force) + " N");
  if (clearance) parts.push_back("Δ = " + html_number(scene.clearance) + " m");
  if (restitution) parts.push_back("ε = " + html_number(scene.restitution));
  std::string text;
  for (const std::string& part : parts) text += (text.empty() ? "" : ", ") + part;
  return text;
}

std::string numbered_caption(const Scene& scene, int number, const std::string& caption) {
  if (!scene.of_the_paper) return caption;
  return prose("curves", "of-the-paper", {{"number", std::to_string(number)}, {"caption", caption}});
}

Scene paper_scene() {
  Scene scene;
  scene.of_the_paper = true;
  scene.mass1 = scene.mass2 = 1;
  scene.force = 40;
  scene.clearance = 0.3;
  scene.restitution = 0.6;
  scene.forces = {10, 20, 30, 40, 50};
  scene.clearances = {0, 0.1, 0.2, 0.3, 0.4, 0.5};
  scene.restitutions = {0, 0.2, 0.4, 0.6, 0.8, 1};
  scene.omega_nichols = io::parse_grid("5:15:200log", "omega");
  scene.omega_bode = io::parse_grid("0.5:25:200log", "omega");
  scene.omega_family = io::parse_grid("5:35:200log", "omega");
  scene.jump_forces = {10, 15, 20, 25, 30, 35, 40, 45, 50};
  scene.jump_clearances = {0.01, 0.025, 0.05, 0.1, 0.2, 0.3, 0.4, 0.5};
  scene.jump_restitutions = scene.restitutions;
  return scene;
}

Scene read_scene(const std::filesystem::path& file) {
  const Json json = parsed(file);
  const std::string expected =
      "expected an object with clearance, restitution or a contact, force, omega and, if not 1 kg, mass1 and mass2";
  if (!json.is_object()) fail(file, expected);
  static const std::vector<std::string> known = {"mass1",
                                                 "mass2",
                                                 "m1",
                                                 "m2",
                                                 "clearance",
                                                 "restitution",
                                                 "force",
                                                 "omega",
                                                 "friction1",
                                                 "friction2",
                                                 "contact_ratio",
                                                 "contact_stiffness",
                                                 "contact_damping",
                                                 "contact_frequency",
                                                 "contact_restitution"};
  for (const auto& [name, value] : json.items()) {
    if (std::find(known.begin(), known.end(), name) == known.end())
      fail(file, "unknown member \"" + name + "\"; " + expected);
  }
  const auto member = [&](const std::string& name) {
    if (!json.contains(name)) fail(file, "\"" + name + "\" is missing; " + expected);
    return numbers(file, name, json.at(name));
  };
  // Under the name of the option, or under the one it had before.
  const auto mass = [&](std::string name, const std::string& old_name) {
    if (json.contains(name) && json.contains(old_name))
      fail(file, "\"" + name + "\" and \"" + old_name + "\" mean the same; expected one of them");
    if (!json.contains(name)) name = old_name;
    if (!json.contains(name)) return 1.0;
    const std::vector<double> list = member(name);
    check_range(file, name, list, 0, false, std::numeric_limits<double>::infinity());
    return single(file, name, list);
  };
  constexpr double infinity = std::numeric_limits<double>::infinity();
  Scene scene;
  scene.mass1 = mass("mass1", "m1");
  scene.mass2 = mass("mass2", "m2");
  scene.forces = member("force");
  scene.clearances = member("clearance");
  // One number, which must be above `least`.
  const auto number = [&](const std::string& name, double least, bool may_equal, double at_most) {
    const std::vector<double> list = member(name);
    check_range(file, name, list, least, may_equal, at_most);
    return single(file, name, list);
  };
  scene.contact = contact_of(file, json, number, scene.mass1, scene.mass2);
  for (const auto& [name, target] :
       {std::pair{"friction1", &scene.friction.body1}, std::pair{"friction2", &scene.friction.body2}}) {
    if (!json.contains(name)) continue;
    if (!scene.contact) fail(file, "\"" + std::string(name) + "\" needs contacts that take time; " + contacts);
    *target = number(name, 0, true, infinity);
  }
  if (scene.contact)
    scene.restitutions = {backlash::free_contact(*scene.contact, scene.mass1, scene.mass2).restitution};
  else
    scene.restitutions = member("restitution");
  const std::vector<double> omega = member("omega");
  check_range(file, "force", scene.forces, 0, false, infinity);
  check_range(file, "clearance", scene.clearances, 0, !scene.contact, infinity);
  check_range(file, "restitution", scene.restitutions, 0, true, 1);
  check_range(file, "omega", omega, 0, false, infinity);
  check_distinct(file, "force", scene.forces);
  check_distinct(file, "clearance", scene.clearances);
  check_distinct(file, "restitution", scene.restitutions);
  check_rising(file, omega);
  scene.force = scene.forces.front();
  const auto gap =
      std::find_if(scene.clearances.begin(), scene.clearances.end(), [](double value) { return value > 0; });
  scene.clearance = gap == scene.clearances.end() ? 0 : *gap;
  scene.restitution = scene.restitutions.front();
  scene.omega_nichols = scene.omega_bode = scene.omega_family = omega;
  scene.jump_forces = scene.forces;
  std::copy_if(scene.clearances.begin(), scene.clearances.end(), std::back_inserter(scene.jump_clearances),
               [](double clearance) { return clearance > 0; });
  scene.jump_restitutions = scene.restitutions;
  return scene;
}

}  // namespace report
