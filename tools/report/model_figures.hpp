// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "frac/model/fractional_transfer_function.hpp"
#include "report/figure.hpp"

namespace report {

/// Bode, Nyquist and Nichols diagrams and step response of a model, from its corner frequencies and poles.
/// @param name  stem of the file names: <name>-bode, <name>-nyquist, <name>-nichols, <name>-step
[[nodiscard]] std::vector<Figure> model_figures(const frac::FractionalTransferFunction& model, const std::string& name);

}  // namespace report
