// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <string_view>

namespace report {

/// The circuit that a model of an impedance is, by its name in a ranking: "R0+(R1|CPE1)+Wo2", in series but for what
/// bars part in brackets, which is in parallel.  Of a preset the one that its formula stands for; of a sum of passive
/// elements the one in its name.  Empty for models that are no circuit.
[[nodiscard]] std::string circuit_of(std::string_view model);

/// The circuit as an SVG picture between two terminals: resistors, inductors and capacitors by their symbols, a
/// constant-phase element as two angles, all else as a box; each with its name above it.
/// @throws std::invalid_argument  for a circuit with an empty element or a bracket that is not closed
[[nodiscard]] std::string circuit_drawing(std::string_view circuit);

}  // namespace report
