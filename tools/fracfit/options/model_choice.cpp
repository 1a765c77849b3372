// SPDX-License-Identifier: BSD-3-Clause
#include "options/model_choice.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <utility>

#include "frac/identification/component_power_law.hpp"
#include "frac/identification/constraints.hpp"
#include "io/data_error.hpp"
#include "io/number.hpp"
#include "options/misspelling.hpp"
#include "options/options.hpp"

namespace fracfit {
namespace {

// Words such as "power_law" parse as formulas of one parameter, which nobody means.
bool looks_like_a_preset(const std::string& text) {
  constexpr std::size_t shortest = 4;
  const auto lower = [](char c) { return c >= 'a' && c <= 'z'; };
  return text.size() >= shortest && lower(text.front()) &&
         std::all_of(text.begin(), text.end(), [&](char c) { return lower(c) || c == '-' || c == '_'; });
}

struct Assignment {
  std::string name, value;
};

Assignment assignment(std::string_view option, const std::string& text) {
  const auto equals = text.find('=');
  if (equals == std::string::npos || equals == 0 || equals + 1 == text.size())
    throw std::invalid_argument(std::string(option) + " " + io::quoted(text) + ": expected NAME=" +
                                (option == "--bound"   ? "LOW:HIGH"
                                 : option == "--prior" ? "VALUE+-DEVIATION"
                                                       : "VALUE"));
  return {text.substr(0, equals), text.substr(equals + 1)};
}

double limit(const std::string& text, const std::string& whole) {
  const auto value = io::parse_number(text);
  if (!value || *value != *value)
    throw std::invalid_argument("--bound " + io::quoted(whole) + ": " + io::quoted(text) +
                                " is no number; expected NAME=LOW:HIGH");
  return *value;
}

/// "0.5+-0.1", "10+-5%", with the sign for plus or minus in place of +- where that is at hand.
frac::ParameterPrior prior_of(const std::string& text, const std::string& whole) {
  const auto refuse = [&](const std::string& reason) {
    throw std::invalid_argument("--prior " + io::quoted(whole) + ": " + reason +
                                "; expected NAME=VALUE+-DEVIATION or NAME=VALUE+-SHARE%");
  };
  std::size_t sign = text.find("+-");
  if (sign == std::string::npos) sign = text.find("\xc2\xb1");
  if (sign == std::string::npos) refuse("it has no +-");
  std::string deviation = text.substr(sign + 2);  // either sign has two bytes
  const bool relative = !deviation.empty() && deviation.back() == '%';
  if (relative) deviation.pop_back();
  const auto number = [&](std::string part) {
    std::erase(part, ' ');
    const auto value = io::parse_number(part);
    if (!value || !std::isfinite(*value)) refuse(io::quoted(part) + " is no number");
    return *value;
  };
  const double value = number(text.substr(0, sign)), width = number(deviation);
  if (!(width > 0)) refuse("the deviation must be positive");
  if (relative && !(value > 0)) refuse("only a positive value has a deviation in per cent");
  return {value, relative ? width / 100 : width, relative};
}

/// The names of a chain "A<B<C".
std::vector<std::string> chain_of(const std::string& text) {
  std::vector<std::string> names;
  for (std::size_t begin = 0; begin <= text.size();) {
    const auto end = std::min(text.find('<', begin), text.size());
    std::string name = text.substr(begin, end - begin);
    std::erase(name, ' ');
    if (name.empty() || name.front() == '=')
      throw std::invalid_argument("--constraint " + io::quoted(text) + ": expected names with < between them");
    names.push_back(std::move(name));
    begin = end + 1;
  }
  if (names.size() < 2)
    throw std::invalid_argument("--constraint " + io::quoted(text) + ": expected names with < between them");
  return names;
}

}  // namespace

void add_parameter_options(Options& options, ParameterOptions& given) {
  options.texts("--bound", given.bound);
  options.texts("--fix", given.fix);
  options.texts("--start", given.start);
}

void add_prior_options(Options& options, ParameterOptions& given) {
  options.texts("--prior", given.prior);
  options.texts("--constraint", given.order);
}

std::string joined(const std::vector<std::string>& texts) {
  std::string text;
  for (const auto& each : texts) text += (text.empty() ? "" : "; ") + each;
  return text;
}

frac::NamedModel chosen_model(const std::string& given) {
  // A formula of several lines would break the lines of tables.
  std::string text = given;
  std::replace_if(
      text.begin(), text.end(), [](char c) { return c == '\n' || c == '\r' || c == '\t'; }, ' ');
  const auto& library = frac::model_library();
  const bool known = std::any_of(library.begin(), library.end(), [&](const auto& model) { return model.name == text; });
  const bool family = text == "rational" || text == "commensurate" || text == "terms" || text == "elements";
  if (text == frac::component_power_law_name)
    throw std::invalid_argument("model " + io::quoted(text) +
                                " is one of fracfit fit, which fits one part of a response by itself");
  if (!known && !family && looks_like_a_preset(text))
    throw std::invalid_argument("model " + io::quoted(text) + " is neither a preset nor a formula of s" +
                                suggestion(text, preset_names()) + "; presets:\n" + preset_list());
  return frac::find_model(text);
}

std::vector<frac::NamedModel> chosen_models(const std::string& list) {
  if (list.empty()) return frac::default_candidates();
  std::vector<frac::NamedModel> models;
  for (std::size_t begin = 0; begin <= list.size();) {
    const auto end = std::min(list.find(',', begin), list.size());
    const std::string text = list.substr(begin, end - begin);
    if (text.find_first_not_of(' ') == std::string::npos)
      throw std::invalid_argument("--models '" + list + "': entry " + std::to_string(models.size() + 1) +
                                  " is empty; expected presets or formulas separated by commas");
    models.push_back(chosen_model(text));
    const auto same = [&](const auto& model) { return model.name == models.back().name; };
    if (std::count_if(models.begin(), models.end(), same) > 1)
      throw std::invalid_argument("--models '" + list + "': " + io::quoted(models.back().name) + " is listed twice");
    begin = end + 1;
  }
  return models;
}

std::vector<frac::ParameterConstraint> constraints_of(const frac::NamedModel& model, const ParameterOptions& given) {
  auto constraints = model.constraints;
  for (const auto& text : given.fix) {
    const auto [name, value] = assignment("--fix", text);
    auto& constraint = frac::constraint_of(constraints, name);
    if (constraint.fixed) throw std::invalid_argument("--fix " + io::quoted(text) + ": " + name + " is fixed twice");
    // Limits and a start are the model's own here: those of the user come below.
    constraint = {name, number_of("--fix " + name, value), {}, {}, {}};
  }
  for (const auto& text : given.bound) {
    const auto [name, range] = assignment("--bound", text);
    const auto [lower, upper] = pair_of("--bound", range);
    auto& constraint = frac::constraint_of(constraints, name);
    const bool free_of_limits = lower.empty() && upper.empty();
    constexpr double infinity = std::numeric_limits<double>::infinity();
    if (!lower.empty() || free_of_limits) constraint.lower = free_of_limits ? -infinity : limit(lower, text);
    if (!upper.empty() || free_of_limits) constraint.upper = free_of_limits ? infinity : limit(upper, text);
  }
  for (const auto& text : given.start) {
    const auto [name, value] = assignment("--start", text);
    frac::constraint_of(constraints, name).start = number_of("--start " + name, value);
  }
  for (const auto& text : given.prior) {
    auto [name, value] = assignment("--prior", text);
    std::erase(name, ' ');
    auto& constraint = frac::constraint_of(constraints, name);
    if (constraint.fixed) throw std::invalid_argument("--prior " + io::quoted(text) + ": " + name + " is fixed");
    if (constraint.prior) throw std::invalid_argument("--prior " + io::quoted(text) + ": " + name + " has one already");
    constraint.prior = prior_of(value, text);
  }
  for (const auto& text : given.order) {
    const auto names = chain_of(text);
    for (std::size_t i = 1; i < names.size(); ++i) {
      auto& constraint = frac::constraint_of(constraints, names[i]);
      if (!constraint.above.empty())
        throw std::invalid_argument("--constraint " + io::quoted(text) + ": " + names[i] + " is above " +
                                    constraint.above + " already; write one chain, A<B<C");
      constraint.above = names[i - 1];
    }
  }
  return constraints;
}

std::vector<frac::DerivedQuantity> quantities_of(const std::vector<std::string>& definitions,
                                                 const std::vector<std::string>& parameter_names) {
  std::vector<frac::DerivedQuantity> quantities;
  for (const auto& definition : definitions) {
    try {
      quantities.emplace_back(definition, parameter_names);
    } catch (const std::invalid_argument& error) {
      throw std::invalid_argument("--derive " + std::string(error.what()));
    }
    for (std::size_t i = 0; i + 1 < quantities.size(); ++i)
      if (quantities[i].name() == quantities.back().name())
        throw std::invalid_argument("--derive names " + quantities.back().name() + " twice");
  }
  return quantities;
}

std::vector<std::string> preset_names() {
  std::vector<std::string> names;
  for (const auto& model : frac::model_library()) names.push_back(model.name);
  return names;
}

std::string preset_list() {
  std::size_t name_width = 0;
  std::size_t formula_width = 0;
  for (const auto& model : frac::model_library()) {
    name_width = std::max(name_width, model.name.size());
    formula_width = std::max(formula_width, model.formula.size());
  }
  std::string text;
  for (const auto& model : frac::model_library()) {
    text += "  " + model.name + std::string(name_width + 2 - model.name.size(), ' ');
    text += model.formula + std::string(formula_width + 2 - model.formula.size(), ' ') + model.description + "\n";
  }
  return text;
}

}  // namespace fracfit
