// SPDX-License-Identifier: BSD-3-Clause
#include "fmu/fmu_text.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>

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

// FMI 2.0: one element for each scalar.  Reals and booleans are numbered apart.
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

// FMI 3.0: value references as the runtime counts them, see fmi3.h.
struct References {
  explicit References(const FmuParts& parts) {
    std::uint32_t booleans = 0;
    for (const FmuVariable& variable : parts.variables) booleans += variable.is_boolean ? 1 : 0;
    const auto all = static_cast<std::uint32_t>(parts.variables.size());
    std::uint32_t scalar = 0, boolean = all - booleans;
    for (const FmuVariable& variable : parts.variables)
      variables.push_back(std::to_string(variable.is_boolean ? boolean++ : scalar++));
    time = std::to_string(all);
    states = std::to_string(all + 1);
    rates = std::to_string(all + 2);
    indicators = std::to_string(all + 3);
  }
  std::vector<std::string> variables;
  std::string time, states, rates, indicators;
};

// A vector that the model calculates.
std::string vector_variable(const std::string& name, const std::string& reference, std::size_t size,
                            const std::string& description, const std::string& more) {
  return "    <Float64" + attribute("name", name) + attribute("valueReference", reference) +
         attribute("description", description) + R"( causality="local" variability="continuous" initial="calculated")" +
         more + ">\n      <Dimension" + attribute("start", std::to_string(size)) + "/>\n    </Float64>\n";
}

std::string variables_of_3(const FmuParts& parts) {
  const References references(parts);
  std::string text = "    <Float64 name=\"time\"" + attribute("valueReference", references.time) +
                     " description=\"Time, s\" causality=\"independent\" variability=\"continuous\"/>\n";
  for (std::size_t i = 0; i < parts.variables.size(); ++i) {
    const FmuVariable& variable = parts.variables[i];
    const bool is_output = variable.role == Role::output;
    text += std::string("    <") + (variable.is_boolean ? "Boolean" : "Float64") + attribute("name", variable.name) +
            attribute("valueReference", references.variables[i]) + attribute("description", variable.description) +
            attribute("causality", causality(variable.role)) + attribute("variability", variability(variable)) +
            (is_output ? attribute("initial", "calculated") : "") +
            (variable.unit.empty() ? "" : attribute("unit", variable.unit)) +
            (is_output ? "" : attribute("start", number_text(variable.start))) + "/>\n";
  }
  if (parts.states > 0) {
    text += vector_variable("x", references.states, parts.states, "States",
                            parts.events > 0 ? attribute("reinit", "true") : "") +
            vector_variable("der(x)", references.rates, parts.states, "Derivatives of the states",
                            attribute("derivative", references.states));
  }
  if (parts.events > 0)
    text += vector_variable("indicators", references.indicators, parts.events, "Change their signs at events", "");
  return text;
}

std::string structure_of_3(const FmuParts& parts) {
  const References references(parts);
  const auto element = [](const std::string& name, const std::string& reference) {
    return "    <" + name + attribute("valueReference", reference) + "/>\n";
  };
  std::string outputs, initial;
  for (std::size_t i = 0; i < parts.variables.size(); ++i) {
    if (parts.variables[i].role != Role::output) continue;
    outputs += element("Output", references.variables[i]);
    initial += element("InitialUnknown", references.variables[i]);
  }
  std::string text = "  <ModelStructure>\n" + outputs;
  if (parts.states > 0) {
    text += element("ContinuousStateDerivative", references.rates);
    initial += element("InitialUnknown", references.states) + element("InitialUnknown", references.rates);
  }
  text += initial;
  if (parts.events > 0) text += element("EventIndicator", references.indicators);
  return text + "  </ModelStructure>\n";
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

std::string description(const FmuParts& parts, const FmuOptions& options, const std::string& token) {
  const bool is_3 = options.version == FmiVersion::three;
  const std::string able = is_3 ? "State=\"true\"" : "state=\"true\"";
  const std::string abilities =
      attribute("modelIdentifier", options.name) + " canGetAndSetFMU" + able + " canSerializeFMU" + able;
  const std::string steps = R"( canHandleVariableCommunicationStepSize="true")";
  // FMI 3.0 has a file of their own for the sources.
  const auto interface = [&](const std::string& element, const std::string& attributes) {
    return "  <" + element + attributes +
           (is_3 ? "/>\n"
                 : ">\n    <SourceFiles>\n      <File" + attribute("name", options.name + ".c") +
                       "/>\n    </SourceFiles>\n  </" + element + ">\n");
  };
  std::string text = "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<fmiModelDescription" +
                     attribute("fmiVersion", is_3 ? "3.0" : "2.0") + attribute("modelName", options.name) +
                     attribute(is_3 ? "instantiationToken" : "guid", token) +
                     attribute("description", options.description) + attribute("generationTool", options.tool) +
                     R"( variableNamingConvention="structured")" +
                     (is_3 ? "" : attribute("numberOfEventIndicators", std::to_string(parts.events))) + ">\n";
  if (parts.states > 0) text += interface("ModelExchange", abilities);
  text += interface("CoSimulation", abilities + steps) + units(parts) +
          "  <LogCategories>\n    <Category name=\"logStatusError\"/>\n  </LogCategories>\n";
  if (!std::isnan(parts.sample_time))
    text += "  <DefaultExperiment" + attribute("stepSize", number_text(parts.sample_time)) + "/>\n";
  return text + "  <ModelVariables>\n" + (is_3 ? variables_of_3(parts) : scalar_variables(parts)) +
         "  </ModelVariables>\n" + (is_3 ? structure_of_3(parts) : structure(parts)) + "</fmiModelDescription>\n";
}

// How the sources are compiled, which FMI 3.0 has in a file of its own.
std::string build_description(const std::string& name) {
  return "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<fmiBuildDescription fmiVersion=\"3.0\">\n"
         "  <BuildConfiguration" +
         attribute("modelIdentifier", name) + ">\n    <SourceFileSet language=\"C99\">\n      <SourceFile" +
         attribute("name", name + ".c") + "/>\n    </SourceFileSet>\n  </BuildConfiguration>\n</fmiBuildDescription>\n";
}

std::string main_source(const FmuParts& parts, const std::string& interface, const std::string& token) {
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
  text += "#define MODEL_TOKEN \"" + token + "\"\n#define MODEL_REALS " + std::to_string(reals + 2 * parts.states) +
          "\n#define MODEL_BOOLEANS " + std::to_string(booleans) + "\n#define MODEL_STATES " +
          std::to_string(parts.states) + "\n#define MODEL_EVENTS " + std::to_string(parts.events) + "\n\n";
  for (std::size_t i = 0; i < 2 * parts.states; ++i) {
    defaults += ", 0";
    access += ", 'o'";
  }
  text += "static const double model_default[MODEL_REALS] = {" + defaults + "};\n";
  text += "static const char model_access[MODEL_REALS] = {" + access + "};\n\n" + parts.values;
  for (const auto& [name, content] : parts.includes) text += "#include \"" + name + "\"\n";
  return text + "#include \"" + interface + "\"\n";
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
  const bool is_3 = options.version == FmiVersion::three;
  const std::string interface = is_3 ? "fmi3.h" : "fmi2.h";
  // The unit is told by a fingerprint of all its text but the fingerprint itself.
  std::string all = main_source(parts, interface, "") + description(parts, options, "");
  for (const auto& [name, content] : parts.includes) all += content;
  const std::string token = "{" + fingerprint(all) + "-" + options.name + "}";
  const std::string folder = "sources/", binaries = "binaries/";
  Fmu result{options.name, {}, folder + options.name + ".c", {}, {}};
  result.linux_library = binaries + (is_3 ? "x86_64-linux/" : "linux64/") + options.name + ".so";
  result.windows_library = binaries + (is_3 ? "x86_64-windows/" : "win64/") + options.name + ".dll";
  result.files.push_back({"modelDescription.xml", description(parts, options, token)});
  result.files.push_back({result.main_source, main_source(parts, interface, token)});
  if (is_3) result.files.push_back({folder + "buildDescription.xml", build_description(options.name)});
  result.files.push_back({folder + interface, std::string(is_3 ? fmu_runtime::fmi3 : fmu_runtime::fmi2)});
  result.files.push_back({folder + "fmu.h", std::string(fmu_runtime::fmu)});
  for (const auto& [name, content] : parts.includes) result.files.push_back({folder + name, std::string(content)});
  return result;
}

}  // namespace frac::detail
