// SPDX-License-Identifier: BSD-3-Clause
#include "frac/identification/fit.hpp"

#include <optional>
#include <string>
#include <utility>
#include <variant>

#include "arrays.hpp"
#include "described.hpp"
#include "fit_request.hpp"
#include "frac/cancellation.hpp"
#include "frac/identification/component_power_law.hpp"
#include "frac/identification/derived.hpp"
#include "frac/identification/describe.hpp"
#include "frac/identification/lack_of_fit.hpp"
#include "frac/identification/model_choice.hpp"
#include "frac/identification/screened_fit.hpp"
#include "frac/identification/statistics.hpp"
#include "frac/identification/uncertainty.hpp"
#include "parts.hpp"
#include "realisation_choice.hpp"
#include "run.hpp"

namespace python {
namespace {

// Some names and ranges are known with the data only.
// @param component  of a response; none over time
frac::ModelRequest request_of(const std::string& name, const py::dict& given,
                              std::optional<frac::Component> component) {
  frac::ModelRequest request;
  std::string unnamed;
  if (given.contains("grow") && !given["grow"].is_none()) {
    request.grow = frac::growth_family_from_string(given["grow"].cast<std::string>());
    if (!frac::names_persist(*request.grow)) unnamed = frac::to_string(*request.grow);
  } else if (component && name == frac::component_power_law_name) {
    request.model = frac::component_power_law(*component);
    request.component_alone = true;
  } else {
    request.model = frac::find_model(name);
    if (request.model.is_family()) unnamed = name;
  }
  request.model.constraints = constraints_of(request.model, given);
  if (!unnamed.empty() && !request.model.constraints.empty())
    throw std::invalid_argument("what is known of parameters has no meaning with the family " + unnamed +
                                ", whose parameters follow from the data");
  return request;
}

// A fit, the points it left out and what is told of these and of its law, kept as it is until Python asks for its
// values.
struct Fitted {
  frac::ModelFit fit;
  std::vector<std::size_t> left_out = {};
  std::vector<std::string> notes = {};
  std::optional<frac::Component> component = {};  // that was fitted; none over time
  std::string law = {};
};

// To what outliers leave, and to the component that the data have.
Fitted fitted_to_others(const frac::FrequencyResponseData& data, const frac::ModelRequest& request,
                        frac::FitOptions options, bool keep) {
  std::vector<std::string> notes = settle_component(options, data);
  for (auto& note : note_of_sign(data, options)) notes.push_back(std::move(note));
  frac::ScreenedData points(data, options, keep);
  for (auto& note : notes_of(points)) notes.push_back(std::move(note));
  frac::ModelFit fit = frac::fit(points, request, options);
  if (!points.taken_back().empty()) notes.push_back(points.taken_back());
  points.restore_indices(fit.result.outliers);
  return {std::move(fit), points.left_out(), std::move(notes), options.component,
          request.component_alone ? frac::component_power_law_sentence(options.component) : ""};
}

// Plain values, as Python keeps them.
py::dict dict_of_fitted(const Fitted& fit) {
  py::dict result = dict_of_fit(fit.fit.result);
  result["constraints"] = list_of(fit.fit.constraints);
  result["global_start"] = fit.fit.global_start;
  result["left_out"] = fit.left_out;
  result["component"] = fit.component ? py::object(py::str(std::string(frac::to_string(*fit.component)))) : py::none();
  result["law"] = fit.law.empty() ? py::object(py::none()) : py::str(fit.law);
  result["growth"] = py::none();
  if (const auto& growth = fit.fit.growth) {
    py::list fits;
    for (const auto& each : growth->fits) fits.append(dict_of_fit(each));
    result["growth"] =
        py::dict(py::arg("chosen") = growth->chosen, py::arg("reason") = growth->reason, py::arg("fits") = fits);
  }
  return result;
}

// Whether a fit takes some hundredths of a second at most: a local solve evaluates each point up to some hundred times,
// in about a microsecond.
bool is_short(const frac::FrequencyResponseData& points, const frac::ModelRequest& request,
              const frac::FitOptions& options) {
  constexpr std::size_t few = 400;
  return !options.global_start && !request.grow && !request.model.is_family() && points.size() <= few &&
         std::holds_alternative<frac::ExactRealisation>(options.realisation);
}

Fitted fit_spectrum(const py::dict& data, const std::string& name, const py::dict& given) {
  const frac::FitOptions options = fit_options(given);
  const frac::ModelRequest request = request_of(name, given, options.component);
  const frac::FrequencyResponseData points = spectrum_of(data);
  const bool keep = keeps_outliers(given);
  const auto work = [&] { return fitted_to_others(points, request, options, keep); };
  if (is_short(points, request, options)) return run_here(work);
  return result_of([&](frac::Progress&) { return work(); });
}

Fitted fit_record(const py::dict& data, const std::string& name, const py::dict& given) {
  if (name == frac::component_power_law_name)
    throw std::invalid_argument("model " + name + " has no meaning with samples over time");
  const frac::ModelRequest request = request_of(name, given, std::nullopt);
  const frac::TimeFitOptions options = time_fit_options(given);
  const frac::TimeResponseData record = record_of(data);
  return result_of([&](frac::Progress&) { return Fitted{frac::fit(record, request, options)}; });
}

// One fit or one sentence for each set of data.
py::list fit_many(const py::list& data, const std::string& name, const py::dict& given, int threads,
                  const py::object& report) {
  const frac::FitOptions options = fit_options(given);
  const frac::ModelRequest request = request_of(name, given, options.component);
  const bool keep = keeps_outliers(given);
  std::vector<frac::FrequencyResponseData> curves;
  for (const auto& each : data) curves.push_back(spectrum_of(each.cast<py::dict>()));
  using Outcome = std::variant<std::string, Fitted>;
  const auto outcomes = result_of(
      [&](frac::Progress& progress) {
        std::vector<Outcome> all(curves.size());
        progress.total = curves.size();
        frac::parallel_for(curves.size(), threads, [&](std::size_t i) {
          try {
            all[i] = fitted_to_others(curves[i], request, options, keep);
          } catch (const std::invalid_argument& reason) {
            all[i] = std::string(reason.what());
          }
          ++progress.done;
        });
        return all;
      },
      report);
  py::list list;
  for (const Outcome& outcome : outcomes) {
    if (const auto* reason = std::get_if<std::string>(&outcome))
      list.append(*reason);
    else
      list.append(std::get<Fitted>(outcome));
  }
  return list;
}

// The work for a frequency response or for a record over time, with the options that the result was made with.
template <typename Work>
auto on_data(const py::dict& data, const py::dict& given, const Work& work) {
  if (data.contains("omega")) {
    const frac::FitOptions options = fit_options(given);
    const frac::FrequencyResponseData all = spectrum_of(data);
    const frac::FrequencyResponseData points =
        given["law"].is_none() ? all : frac::component_alone(all, options.component);
    return result_of([&](frac::Progress&) { return work(points, options); });
  }
  const frac::TimeFitOptions options = time_fit_options(given);
  const frac::TimeResponseData record = record_of(data);
  return result_of([&](frac::Progress&) { return work(record, options); });
}

py::tuple profile(const py::dict& data, const py::dict& given, const py::dict& fit, const std::string& parameter) {
  const frac::FitResult result = fit_result_from(fit);
  const auto interval = on_data(data, given, [&](const auto& points, const auto& options) {
    return frac::profile_interval(points, options, result, parameter);
  });
  return py::make_tuple(interval.lower, interval.upper, interval.better_minimum_found);
}

py::list bootstrap(const py::dict& data, const py::dict& given, const py::dict& fit, std::size_t samples, int threads) {
  const frac::FitResult result = fit_result_from(fit);
  const auto intervals = on_data(data, given, [&](const auto& points, const auto& options) {
    return frac::bootstrap(points, options, result, samples, threads);
  });
  py::list list;
  for (const auto& each : intervals) list.append(py::make_tuple(each.lower, each.upper, each.standard_error));
  return list;
}

py::dict lack_of_fit(const py::dict& data, const py::dict& given, const py::dict& fit) {
  const frac::FitResult result = fit_result_from(fit);
  return dict_of(on_data(data, given, [&](const auto& points, const auto& options) {
    return frac::lack_of_fit(points, options, result);
  }));
}

py::dict derive(const py::dict& fit, const std::string& definition) {
  const frac::FitResult result = fit_result_from(fit);
  std::vector<std::string> names;
  for (const auto& each : result.parameters) names.push_back(each.name);
  const std::vector<frac::DerivedQuantity> quantity{{definition, names}};
  return dict_of(frac::derived_estimates(result, quantity).front());
}

Complexes fitted_response(const py::dict& fit, const py::dict& realisation, const Reals& omega) {
  return array_of(frac::fitted_response(fit_result_from(fit), realisation_of(realisation), vector_of(omega)));
}

py::array_t<double> fitted_output(const py::dict& data, const py::dict& given, const py::dict& fit) {
  return array_of(frac::fitted_output(fit_result_from(fit), record_of(data), time_fit_options(given)));
}

// Columns: real part, imaginary part, ln of the magnitude, phase.
py::array response_deviation(const py::dict& fit, const py::dict& realisation, const Reals& omega) {
  const auto deviations = frac::response_deviation(fit_result_from(fit), realisation_of(realisation), vector_of(omega));
  std::vector<double> numbers;
  for (const auto& each : deviations)
    numbers.insert(numbers.end(), {each.real, each.imaginary, each.log_magnitude, each.phase});
  return array_of(std::move(numbers), {static_cast<py::ssize_t>(deviations.size()), 4});
}

}  // namespace

void add_fit(py::module_& module) {
  module.attr("described")["FitResult"] = attributes_of<frac::FitResult>();
  py::class_<Fitted>(module, "Fitted").def("as_dict", &dict_of_fitted).def("notes", [](const Fitted& fit) {
    return fit.notes;
  });
  module.def("fit_spectrum", &fit_spectrum);
  module.def("fit_record", &fit_record);
  module.def("fit_many", &fit_many);
  module.def("profile", &profile);
  module.def("bootstrap", &bootstrap);
  module.def("summary", [](const py::dict& fit) { return fit_result_from(fit).summary(); });
  module.def("lack_of_fit", &lack_of_fit);
  module.def("derive", &derive);
  module.def("fitted_response", &fitted_response);
  module.def("fitted_output", &fitted_output);
  module.def("response_deviation", &response_deviation);
  module.def("student_t_95", &frac::student_t_95);
  module.def("presets", [] {
    py::list list;
    for (const auto& model : frac::model_library())
      list.append(py::make_tuple(model.name, model.formula, model.description));
    return list;
  });
}

}  // namespace python
