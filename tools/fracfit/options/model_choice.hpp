// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "frac/identification/derived.hpp"
#include "frac/identification/model_library.hpp"

namespace fracfit {

class Options;

/// A preset by name or a formula.
/// @throws std::invalid_argument  a word that looks like a preset's name but is none; the presets are listed.
/// @throws frac::FormulaError
[[nodiscard]] frac::NamedModel chosen_model(const std::string& text);

/// A list of them separated by commas; frac::default_candidates() when it is empty.
[[nodiscard]] std::vector<frac::NamedModel> chosen_models(const std::string& list);

/// What the user says of parameters on the command line.
struct ParameterOptions {
  std::vector<std::string> fix;         // NAME=VALUE
  std::vector<std::string> bound;       // NAME=LOW:HIGH, one side may be left out
  std::vector<std::string> start;       // NAME=VALUE
  std::vector<std::string> prior = {};  // NAME=VALUE+-DEVIATION, or NAME=VALUE+-SHARE%
  std::vector<std::string> order = {};  // A<B, or longer chains
};
/// --bound, --fix and --start.
void add_parameter_options(Options& options, ParameterOptions& given);
/// --prior and --constraint.
void add_prior_options(Options& options, ParameterOptions& given);

/// A list of these texts as the entry that outputs show.
[[nodiscard]] std::string joined(const std::vector<std::string>& texts);

/// The model's own constraints with the user's put over them.
/// @throws std::invalid_argument  naming option, text and what is expected.
[[nodiscard]] std::vector<frac::ParameterConstraint> constraints_of(const frac::NamedModel& model,
                                                                    const ParameterOptions& given);

/// What --derive names.
/// @throws std::invalid_argument  naming the option and what is wrong with its text.
[[nodiscard]] std::vector<frac::DerivedQuantity> quantities_of(const std::vector<std::string>& definitions,
                                                               const std::vector<std::string>& parameter_names);

[[nodiscard]] std::vector<std::string> preset_names();
/// One line per preset: name, formula, description.
[[nodiscard]] std::string preset_list();

}  // namespace fracfit
