// SPDX-License-Identifier: BSD-3-Clause
#include "fmu/fmu_text.hpp"

#include <algorithm>
#include <cmath>

#include "base/number_text.hpp"
#include "digital/c_export/c_text.hpp"
#include "fmu/fmu_runtime.hpp"

namespace frac::detail {
namespace {

using Role = FmuVariable::Role;

std::string xml(std::string_view text) {
  std::string safe;
  for (const char c : text) {
    switch (c) {
      case '&':
        safe += "&amp;";
        break;
      case '<':
        safe += "&lt;";
        break;
      case '>':
        safe += "&gt;";
        break;
      case '"':
        safe += "&quot;";
        break;
      case '\n':
        safe += "&#10;";
        break;
      default:
        safe += c;
    }
  }
  return safe;
}

std::string attribute(const std::string& name, const std::string& value) {
  return " " + name + "=\"" + xml(value) + "\"";
}

const char* causality(Role role) {
  return role == Role::input ? "input" : role == Role::output ? "output" : "parameter";
}

const char* variability(const FmuVariable& variable) {
  switch (variable.role) {
    case Role::fixed_parameter:
      return "fixed";
    case Role::tunable_parameter:
      return "tunable";
    default:
      return variable.is_sampled || variable.is_boolean ? "discrete" : "continuous";
  }
}

// Reals and booleans are numbered apart.
std::string scalar_variables(const FmuParts& parts) {
  std::string text;
  int reals = 0, booleans = 0;
  for (const FmuVariable& variable : parts.variables) {
    const bool is_output = variable.role == Role::output;
    text += "    <ScalarVariable" + attribute("name", variable.name) +
            attribute("valueReference", std::to_string(variable.is_boolean ? booleans++ : reals++)) +
            attribute("description", variable.description) + attribute("causality", causality(variable.role)) +
            attribute("variability", variability(variable)) + (is_output ? attribute("initial", "calculated") : "") +
            ">\n      <" + (variable.is_boolean ? "Boolean" : "Real") +
            (variable.unit.empty() ? "" : attribute("unit", variable.unit)) +
            (is_output ? "" : attribute("start", number_text(variable.start))) + "/>\n    </ScalarVariable>\n";
  }
  // States and their derivatives, which model exchange wants named.
  for (std::size_t i = 0; i < parts.states; ++i) {
    text += "    <ScalarVariable" + attribute("name", "x[" + std::to_string(i + 1) + "]") +
            attribute("valueReference", std::to_string(reals++)) +
            R"( causality="local" variability="continuous" initial="calculated">)" + "\n      <Real" +
            (parts.events > 0 ? attribute("reinit", "true") : "") + "/>\n    </ScalarVariable>\n";
  }
  for (std::size_t i = 0; i < parts.states; ++i) {
    text += "    <ScalarVariable" + attribute("name", "der(x[" + std::to_string(i + 1) + "])") +
            attribute("valueReference", std::to_string(reals++)) +
            R"( causality="local" variability="continuous" initial="calculated">)" + "\n      <Real" +
            attribute("derivative", std::to_string(parts.variables.size() + i + 1)) + "/>\n    </ScalarVariable>\n";
  }
  return text;
}

std::string unknowns(const std::string& list, const std::vector<std::size_t>& indices) {
  if (indices.empty()) return {};
  std::string text = "    <" + list + ">\n";
  for (const std::size_t each : indices) text += "      <Unknown" + attribute("index", std::to_string(each)) + "/>\n";
  return text + "    </" + list + ">\n";
}

std::string structure(const FmuParts& parts) {
  std::vector<std::size_t> outputs, derivatives;
  for (std::size_t i = 0; i < parts.variables.size(); ++i) {
    if (parts.variables[i].role == Role::output) outputs.push_back(i + 1);
  }
  std::vector<std::size_t> initial = outputs;
  for (std::size_t i = 0; i < parts.states; ++i) initial.push_back(parts.variables.size() + i + 1);
  for (std::size_t i = 0; i < parts.states; ++i) {
    derivatives.push_back(parts.variables.size() + parts.states + i + 1);
    initial.push_back(derivatives.back());
  }
  return "  <ModelStructure>\n" + unknowns("Outputs", outputs) + unknowns("Derivatives", derivatives) +
         unknowns("InitialUnknowns", initial) + "  </ModelStructure>\n";
}

std::string units(const FmuParts& parts) {
  std::vector<std::string> names;
  for (const FmuVariable& variable : parts.variables) {
    const bool is_known = std::find(names.begin(), names.end(), variable.unit) != names.end();
    if (!variable.unit.empty() && !is_known) names.push_back(variable.unit);
  }
  if (names.empty()) return {};
  std::string text = "  <UnitDefinitions>\n";
  for (const std::string& name : names) text += "    <Unit" + attribute("name", name) + "/>\n";
  return text + "  </UnitDefinitions>\n";
}

std::string description(const FmuParts& parts, const FmuOptions& options, const std::string& guid) {
  const std::string sources =
      "    <SourceFiles>\n      <File" + attribute("name", options.name + ".c") + "/>\n    </SourceFiles>\n";
  const std::string abilities =
      attribute("modelIdentifier", options.name) + R"( canGetAndSetFMUstate="true" canSerializeFMUstate="true")";
  std::string text = "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<fmiModelDescription fmiVersion=\"2.0\"" +
                     attribute("modelName", options.name) + attribute("guid", guid) +
                     attribute("description", options.description) + attribute("generationTool", options.tool) +
                     R"( variableNamingConvention="structured")" +
                     attribute("numberOfEventIndicators", std::to_string(parts.events)) + ">\n";
  if (parts.states > 0) text += "  <ModelExchange" + abilities + ">\n" + sources + "  </ModelExchange>\n";
  text += "  <CoSimulation" + abilities + R"( canHandleVariableCommunicationStepSize="true">)" + "\n" + sources +
          "  </CoSimulation>\n" + units(parts) +
          "  <LogCategories>\n    <Category name=\"logStatusError\"/>\n  </LogCategories>\n";
  if (!std::isnan(parts.sample_time))
    text += "  <DefaultExperiment" + attribute("stepSize", number_text(parts.sample_time)) + "/>\n";
  return text + "  <ModelVariables>\n" + scalar_variables(parts) + "  </ModelVariables>\n" + structure(parts) +
         "</fmiModelDescription>\n";
}

std::string main_source(const FmuParts& parts, const std::string& guid) {
  std::string defaults, access;
  std::size_t reals = 0, booleans = 0;
  for (const FmuVariable& variable : parts.variables) {
    if (variable.is_boolean) {
      ++booleans;
      continue;
    }
    constexpr char letter[] = {'i', 'p', 't', 'o'};
    const double start = variable.role == Role::output ? 0 : variable.start;
    defaults += (reals == 0 ? "" : ", ") + number_text(start);
    access += std::string(reals == 0 ? "" : ", ") + "'" + letter[static_cast<int>(variable.role)] + "'";
    ++reals;
  }
  std::string text =
      "/* SPDX-License-Identifier: BSD-3-Clause */\n/* The one file to compile: it includes the others. */\n";
  text += "#include \"fmi2.h\"\n\n#define MODEL_GUID \"" + guid + "\"\n#define MODEL_REALS " +
          std::to_string(reals + 2 * parts.states) + "\n#define MODEL_BOOLEANS " + std::to_string(booleans) +
          "\n#define MODEL_STATES " + std::to_string(parts.states) + "\n#define MODEL_EVENTS " +
          std::to_string(parts.events) + "\n\n";
  for (std::size_t i = 0; i < 2 * parts.states; ++i) {
    defaults += ", 0";
    access += ", 'o'";
  }
  text += "static const double model_default[MODEL_REALS] = {" + defaults + "};\n";
  text += "static const char model_access[MODEL_REALS] = {" + access + "};\n\n" + parts.values;
  for (const auto& [name, content] : parts.includes) text += "#include \"" + name + "\"\n";
  return text + "#include \"fmu.h\"\n";
}

}  // namespace

std::string c_array(const std::string& type, const std::string& name, const std::vector<double>& values) {
  constexpr std::size_t per_line = 4;
  std::string text = "static const " + type + " " + name + "[" + std::to_string(values.size()) + "] = {";
  for (std::size_t i = 0; i < values.size(); ++i)
    text += (i == 0 ? "\n    " : i % per_line == 0 ? ",\n    " : ", ") + number_text(values[i]);
  return text + "};\n";
}

Fmu fmu_of(const FmuParts& parts, const FmuOptions& options) {
  check_c_name(options.name);
  // The unit is told by a fingerprint of all its text but the fingerprint itself.
  std::string all = main_source(parts, "") + description(parts, options, "");
  for (const auto& [name, content] : parts.includes) all += content;
  const std::string guid = "{" + fingerprint(all) + "-" + options.name + "}";
  const std::string folder = "sources/";
  Fmu result{options.name, {}, folder + options.name + ".c"};
  result.files.push_back({"modelDescription.xml", description(parts, options, guid)});
  result.files.push_back({result.main_source, main_source(parts, guid)});
  result.files.push_back({folder + "fmi2.h", std::string(fmu_runtime::fmi2)});
  result.files.push_back({folder + "fmu.h", std::string(fmu_runtime::fmu)});
  for (const auto& [name, content] : parts.includes) result.files.push_back({folder + name, std::string(content)});
  return result;
}

}  // namespace frac::detail
