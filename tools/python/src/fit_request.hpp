// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pybind11/pybind11.h>

#include <vector>

#include "frac/identification/fit.hpp"
#include "frac/identification/identify.hpp"
#include "frac/identification/model_library.hpp"
#include "frac/identification/outliers.hpp"
#include "frac/identification/time_fit.hpp"

namespace python {

/// Options from a dict whose keys are those of fit(); what is None or missing keeps its default.
[[nodiscard]] frac::FitOptions fit_options(const pybind11::dict& given);
[[nodiscard]] frac::TimeFitOptions time_fit_options(const pybind11::dict& given);

/// Whether "outliers" says keep rather than leave-out, which it says unless given.
[[nodiscard]] bool keeps_outliers(const pybind11::dict& given);

/// Puts the component that is fitted in the place of the one that was asked for, see frac::fitted_component().
/// @return  what is told of it; empty where it is the same
[[nodiscard]] std::vector<std::string> settle_component(frac::FitOptions& options,
                                                        const frac::FrequencyResponseData& data);

/// What is told of the points that are left out, with the way to keep them; empty where there are none.
[[nodiscard]] std::vector<std::string> notes_of(const frac::ScreenedData& points);

/// What is told of data whose imaginary part has the wrong sign, and empty for others.  Both parts are judged together,
/// and repeats at one frequency are not points of a sweep.
[[nodiscard]] std::vector<std::string> note_of_sign(const frac::FrequencyResponseData& data,
                                                    const frac::FitOptions& options);

/// Data from a dict of arrays: omega, response, sigma; time, input, output, sigma, hold, input_at_rest, kept.
[[nodiscard]] frac::FrequencyResponseData spectrum_of(const pybind11::dict& data);
[[nodiscard]] frac::TimeResponseData record_of(const pybind11::dict& data);

/// Curves by their names, of a value for each of the points.
[[nodiscard]] std::vector<frac::FixedCurve> fixed_curves(const pybind11::dict& given, std::size_t points);

/// The constraints of a model with what "fixed", "bounds", "start", "prior" and "constraint" of the options add to
/// them.
[[nodiscard]] std::vector<frac::ParameterConstraint> constraints_of(const frac::NamedModel& model,
                                                                    const pybind11::dict& given);
/// As a list of tuples (name, fixed, lower, upper, start, prior, above), and back.
[[nodiscard]] pybind11::list list_of(const std::vector<frac::ParameterConstraint>& constraints);
/// (remedy, names of parameters) each.
[[nodiscard]] pybind11::list list_of(const std::vector<frac::Advice>& advice);
[[nodiscard]] std::vector<frac::ParameterConstraint> constraints_from(const pybind11::list& list);

/// A result as a dict of plain values, and back.
[[nodiscard]] pybind11::dict dict_of_fit(const frac::FitResult& result);
[[nodiscard]] frac::FitResult fit_result_from(const pybind11::dict& dict);

}  // namespace python
