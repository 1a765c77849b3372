// SPDX-License-Identifier: BSD-3-Clause
#include "options/scene_options.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "io/data_error.hpp"
#include "io/number.hpp"
#include "output/sweep_output.hpp"

namespace fracfit {
namespace {

// "0,3", "4,0" or "20,5": two whole numbers that no list of rising values would hold, or that begin with 0.
bool looks_like_decimal_comma(const std::string& text) {
  if (text.find_first_not_of("0123456789,") != std::string::npos) return false;
  const auto comma = text.find(',');
  if (comma == std::string::npos || text.find(',', comma + 1) != std::string::npos) return false;
  const auto first = io::parse_number(text.substr(0, comma)), second = io::parse_number(text.substr(comma + 1));
  return first && second && (text.front() == '0' || text[comma + 1] == '0' || *second < *first);
}

}  // namespace

void add_masses(Options& options, double& mass1, double& mass2) {
  options.number("--mass1", mass1);
  options.number("--mass2", mass2);
}

void add_scene(Options& options, Scene& scene) {
  options.number("--force", scene.force);
  options.number("--clearance", scene.clearance);
  add_masses(options, scene.mass1, scene.mass2);
}

void CompliantOptions::add(Options& options, bool several) {
  const auto declare = [&](const char* name, std::vector<double>& target) -> Option& {
    return options.parsed(
        name, target,
        [several](std::string_view of, const std::string& text) {
          return several ? scene_values_of(of, text) : std::vector<double>{number_of(of, text)};
        },
        several ? "several too" : "");
  };
  declare("--contact-stiffness", stiffness_);
  declare("--contact-damping", damping_).only_with({"--contact-stiffness"}).needed_with({"--contact-stiffness"});
  declare("--contact-frequency", frequency_);
  declare("--contact-ratio", ratio_).only_with({"--contact-frequency"});
  declare("--contact-restitution", restitution_).only_with({"--contact-frequency"});
  options.at_most_one({"--restitution", "--contact-stiffness", "--contact-frequency"});
  options.at_most_one({"--contact-ratio", "--contact-restitution"});
  for (double* each : {&friction_.body1, &friction_.body2})
    options.number(each == &friction_.body1 ? "--friction1" : "--friction2", *each)
        .not_with({"--restitution"}, "whose contacts take no time; give --contact-stiffness or --contact-frequency");
}

void CompliantOptions::exclude(Option& option, const std::string& why) {
  for (const char* contact : {"--contact-stiffness", "--contact-frequency"}) option.not_with({contact}, why);
}

bool CompliantOptions::are_given(const Options& options) const {
  const bool by_frequency = options["--contact-frequency"].is_given();
  if (by_frequency && !options["--contact-ratio"].is_given() && !options["--contact-restitution"].is_given())
    throw std::invalid_argument("--contact-frequency needs --contact-ratio or --contact-restitution");
  if (by_frequency || options["--contact-stiffness"].is_given()) return true;
  if (!options["--restitution"].text().empty()) return false;  // given, or the default
  throw std::invalid_argument("--restitution is missing, or --contact-stiffness or --contact-frequency instead");
}

std::optional<CompliantOptions> CompliantOptions::with(std::string_view name, double value) const {
  CompliantOptions changed = *this;
  for (const auto& [of, target] :
       {std::pair{"contact-stiffness", &changed.stiffness_}, std::pair{"contact-damping", &changed.damping_},
        std::pair{"contact-frequency", &changed.frequency_}, std::pair{"contact-ratio", &changed.ratio_},
        std::pair{"contact-restitution", &changed.restitution_}}) {
    if (name != of || target->empty()) continue;
    *target = {value};
    return changed;
  }
  if (name != "friction1" && name != "friction2") return std::nullopt;
  (name == "friction1" ? changed.friction_.body1 : changed.friction_.body2) = value;
  return changed;
}

std::array<std::string, 2> CompliantOptions::columns() const {
  if (frequency_.empty()) return {"contact_stiffness_n_m", "contact_damping_n_s_m"};
  return {"contact_frequency_rad_s", ratio_.empty() ? "contact_restitution" : "contact_ratio"};
}

std::vector<std::array<double, 2>> CompliantOptions::values() const {
  std::vector<std::array<double, 2>> values;
  for (const double first : frequency_.empty() ? stiffness_ : frequency_)
    for (const double second : frequency_.empty() ? damping_ : ratio_.empty() ? restitution_ : ratio_)
      values.push_back({first, second});
  return values;
}

std::vector<backlash::CompliantContact> CompliantOptions::contacts(double mass1, double mass2) const {
  std::vector<backlash::CompliantContact> contacts;
  for (const auto& [first, second] : values()) {
    if (frequency_.empty()) {
      contacts.emplace_back(first, second);
      continue;
    }
    const double ratio = ratio_.empty() ? backlash::damping_ratio_of_restitution(second) : second;
    contacts.push_back(backlash::CompliantContact::from_frequency(first, ratio, mass1, mass2));
  }
  return contacts;
}

std::vector<backlash::CompliantBodies> CompliantOptions::bodies(const frac::FractionalTransferFunction& load,
                                                                const frac::FractionalTransferFunction& drive,
                                                                double clearance) const {
  const backlash::LinearBodies elastic(load, drive, clearance, 1);
  std::vector<backlash::CompliantBodies> bodies;
  for (const auto& contact : contacts(elastic.system().mass1(), elastic.system().mass2()))
    bodies.emplace_back(load, drive, clearance, contact, friction_);
  return bodies;
}

io::Metadata contact_entries(const backlash::CompliantBodies& bodies) {
  const backlash::FreeContact free =
      backlash::free_contact(bodies.contact(), bodies.system().mass1(), bodies.system().mass2());
  io::Metadata entries;
  for (const auto& [key, value] :
       {std::pair{"contact_stiffness_n_m", bodies.contact().stiffness()},
        std::pair{"contact_damping_n_s_m", bodies.contact().damping()},
        std::pair{"contact_frequency_rad_s", free.frequency}, std::pair{"contact_ratio", free.damping_ratio},
        std::pair{"contact_restitution", free.restitution}, std::pair{"contact_time_s", free.duration}})
    entries.emplace_back(key, io::format_number(value));
  for (auto& entry : friction_entries(bodies.friction())) entries.push_back(std::move(entry));
  return entries;
}

std::string contact_word(const std::optional<backlash::Wall>& wall) {
  return !wall ? "none" : *wall == backlash::Wall::near ? "near" : "far";
}

bool is_compliant_option(std::string_view name) {
  return name.starts_with("--contact-") || name == "--friction1" || name == "--friction2";
}

std::vector<double> scene_values_of(std::string_view name, const std::string& text) {
  std::vector<double> values = numbers_of(name, text);
  const auto refuse = [&](const std::string& message) {
    throw std::invalid_argument(std::string(name) + " " + io::quoted(text) + ": " + message);
  };
  // Otherwise two scenes would be computed instead of one, unnoticed.
  if (looks_like_decimal_comma(text))
    refuse("expected one number with a decimal point, such as 0.3, or two with one each, such as 0.0,3.0");
  std::vector<double> sorted = values;
  std::sort(sorted.begin(), sorted.end());
  const auto twice = std::adjacent_find(sorted.begin(), sorted.end());
  if (twice != sorted.end()) refuse("holds " + io::format_number(*twice) + " twice");
  return values;
}

}  // namespace fracfit
