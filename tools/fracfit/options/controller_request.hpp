// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "frac/digital/c_header.hpp"
#include "frac/digital/cascade_gains.hpp"
#include "frac/digital/digital_filter.hpp"
#include "frac/digital/fractional_pid.hpp"
#include "options/model_options.hpp"
#include "options/options.hpp"

namespace fracfit {

/// A recursion in the samples as asked for on the command line: a fractional PID, or a filter for a --model.
class ControllerRequest {
 public:
  enum class SampleTime { required, optional };
  /// Declares the options that say what is designed.
  void declare(Options& options, SampleTime sample_time = SampleTime::required);
  /// @throws std::invalid_argument  options do not fit together.
  void check(const Options& options) const;

  using Design = std::variant<frac::FractionalPidDesign, frac::FilterChoice>;
  /// Makes the design and says in the options what was chosen.
  /// @throws std::invalid_argument, std::domain_error  as the designs of the library.
  [[nodiscard]] Design design(Options& options);

  [[nodiscard]] const std::optional<frac::FractionalTransferFunction>& model() const { return model_; }
  [[nodiscard]] const std::optional<frac::FrequencyBand>& band() const { return band_; }
  [[nodiscard]] const std::optional<double>& tolerance() const { return goal_.tolerance; }

 private:
  [[nodiscard]] frac::FractionalPidDesign pid(Options& options);
  [[nodiscard]] frac::FilterChoice filter(Options& options) const;

  frac::FractionalPidConfig config_;
  std::optional<frac::FractionalTransferFunction> model_;
  std::optional<frac::CascadeGains> cascade_;
  std::optional<frac::FrequencyBand> band_;
  GoalOptions goal_;
  std::optional<frac::Discretisation> discretisation_;
  double samples_ = 1e9;
  std::optional<double> minimum_, maximum_, tracking_time_;
};

/// A sentence on what differs from what was asked; empty if nothing does.
[[nodiscard]] std::string note_of(const ControllerRequest::Design& design);

/// How C code is written.
class CodeRequest {
 public:
  explicit CodeRequest(frac::Precision precision) { header_.precision = precision; }
  void declare(Options& options);
  /// @throws std::invalid_argument  the name.
  void check(bool is_filter);
  /// The options, for a command line.
  [[nodiscard]] std::string words() const;
  [[nodiscard]] std::string name_in_words() const { return " --name " + header_.name; }
  /// What `make` makes of a design and how its code is written.
  /// @param command  command line that makes it again
  template <typename Make>
  [[nodiscard]] auto made_by(Make make, const ControllerRequest& request, const ControllerRequest::Design& design,
                             const std::string& command) const {
    const frac::CHeaderOptions options = with_comment(request, design, command);
    if (const auto* pid = std::get_if<frac::FractionalPidDesign>(&design)) return make(*pid, options);
    return make(std::get<frac::FilterChoice>(design).design, options);
  }
  [[nodiscard]] std::string header(const ControllerRequest& request, const ControllerRequest::Design& design,
                                   const std::string& command) const {
    return made_by([](const auto& of, const auto& options) { return frac::c_header(of, options); }, request, design,
                   command);
  }

 private:
  [[nodiscard]] frac::CHeaderOptions with_comment(const ControllerRequest& request,
                                                  const ControllerRequest::Design& design,
                                                  const std::string& command) const;
  frac::CHeaderOptions header_;
  std::string name_;
};

}  // namespace fracfit
