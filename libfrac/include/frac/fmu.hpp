// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "frac/digital/arduino_library.hpp"
#include "frac/digital/c_header.hpp"
#include "frac/digital/digital_filter.hpp"
#include "frac/digital/fractional_pid.hpp"
#include "frac/state_space.hpp"

namespace frac {

/// Part of a Functional Mock-up Unit that others can read or set.
struct FmuVariable {
  enum class Role {
    input,
    /// Set before the simulation runs.
    fixed_parameter,
    /// Set at any time.
    tunable_parameter,
    output,
  };
  std::string name;
  Role role;
  std::string description;
  /// As text, such as "m/s"; empty for none.
  std::string unit = {};
  double start = 0;
  /// 0 or 1 instead of a number; outputs only.
  bool is_boolean = false;
  /// An output changes only at sample times.
  bool is_sampled = false;
};

/// Version of the Functional Mock-up Interface.
enum class FmiVersion { two, three };

/// 2, 3.
[[nodiscard]] std::string_view to_string(FmiVersion version);
/// @throws std::invalid_argument  unknown name.
[[nodiscard]] FmiVersion fmi_version_from_string(std::string_view text);
[[nodiscard]] std::span<const FmiVersion> fmi_versions();

struct FmuOptions {
  /// Name of the model, its files and its library: letters, digits and _, the first a letter or _, up to 40 characters.
  std::string name = "model";
  /// Arithmetic of a controller or filter; plants compute in double.
  Precision precision = Precision::double_type;
  /// One line or more.
  std::string description = {};
  /// Name of the program that writes it, such as "fracfit 1.2".
  std::string tool = {};
  FmiVersion version = FmiVersion::two;
};

/// A Functional Mock-up Unit of FMI 2.0 or 3.0 but for its compiled library: modelDescription.xml and the C sources,
/// which are compiled as one file, `main_source`.  Both versions are thin layers around the same model.
/// Instances share nothing, and a state can be kept, serialised and set again.
struct Fmu {
  std::string name;
  std::vector<NamedText> files;
  /// Path of one of the files.
  std::string main_source;
  /// Where the standard expects the library for 64-bit Linux and that for 64-bit Windows.
  std::string linux_library, windows_library;
};

/// Co-simulation: the controller acts at its sample times, from the start time on, on the inputs of that moment; its
/// output holds until the next.  Gains, set-point weights and limits can be changed while it runs and count from the
/// next sample on; the tracking time of the anti-windup stays that of the design.
/// @throws std::invalid_argument  the name.
[[nodiscard]] Fmu fmu(const FractionalPidDesign& design, const FmuOptions& options);

/// Co-simulation: the same for a filter, its dead time included.
/// @throws std::invalid_argument  the name; as c_header().
[[nodiscard]] Fmu fmu(const DigitalFilterDesign& design, const FmuOptions& options);

/// Co-simulation with steps of any length, exact for an input that is constant over a step, and model exchange.
/// @throws std::invalid_argument  the name; no state, a dead time, or more than 200 states.
[[nodiscard]] Fmu fmu(const RationalModel& system, const FmuOptions& options);

}  // namespace frac
