// SPDX-License-Identifier: BSD-3-Clause
#include <optional>
#include <string>

#include "arrays.hpp"
#ifdef FRACFIT_HAS_EXPORTS
#include "io/fmu_archive.hpp"
#endif
#include "io/frequency_response_file.hpp"
#include "io/point_filter.hpp"
#include "io/record_file.hpp"
#include "io/time_series_file.hpp"
#include "io/unit_name.hpp"
#include "run.hpp"

namespace python {
namespace {

py::dict dict_of(const io::Metadata& metadata) {
  py::dict result;
  for (const auto& [key, value] : metadata) result[py::str(key)] = value;
  return result;
}

io::FrequencyResponseReadOptions options_of(const py::dict& given) {
  io::FrequencyResponseReadOptions options;
  options.how.columns = given["columns"].cast<std::string>();
  options.how.frequency_unit = given["frequency_unit"].cast<std::string>();
  options.how.select = given["select"].cast<std::string>();
  options.weight_column = given["weight_column"].cast<std::optional<std::string>>();
  if (const auto quantity = given["quantity"].cast<std::optional<std::string>>())
    options.quantity = backlash::quantity_from_string(*quantity);
  options.real_may_miss = true;
  options.repeats_are_points = given["repeats"].cast<bool>();
  return options;
}

py::dict spectrum(const std::string& path, io::FrequencyResponseReadOptions options,
                  const std::vector<std::string>& where) {
  for (const auto& text : where) options.where.emplace_back(text);
  const auto file = result_of([&](frac::Progress&) { return io::read_frequency_response(path, options); });
  py::dict result;
  result["omega"] = array_of(file.data.omega());
  result["response"] = array_of(file.data.value());
  result["sigma"] = array_of(file.data.sigma());
  result["unit"] = io::written_unit(file.value_unit);
  result["frequency_unit"] = std::string(to_string(file.data.frequency_unit()));
  result["metadata"] = dict_of(file.metadata);
  result["notes"] = file.notes;
  return result;
}

py::dict record(const std::string& path, const std::vector<std::string>& where) {
  std::vector<io::SampleFilter> filters;
  for (const auto& text : where) filters.emplace_back(text);
  const auto series = result_of([&](frac::Progress&) { return io::read_time_response(path, filters); });
  py::dict result;
  result["time"] = array_of(series.time);
  result["input"] = array_of(series.input);
  result["output"] = array_of(series.output);
  result["sigma"] = array_of(series.sigma);
  result["kept"] = array_of(std::vector<py::ssize_t>(series.kept.begin(), series.kept.end()));
  result["metadata"] = dict_of(series.metadata);
  result["notes"] = series.notes;
  return result;
}

py::dict raw_record(const std::string& path, const std::string& columns, const std::optional<double>& sample_time,
                    const std::string& input_file) {
  const auto file = result_of([&](frac::Progress&) {
    return io::read_record(path, {columns, sample_time, input_file});
  });
  py::list outputs, units;
  for (const auto& output : file.record.outputs()) outputs.append(array_of(output));
  for (const auto& unit : file.units) units.append(io::written_unit(unit));
  py::dict result;
  py::list gaps;
  for (const auto& gap : file.record.gaps()) gaps.append(py::make_tuple(gap.before, gap.missing));
  result["record"] = py::make_tuple(file.record.sample_time(), array_of(file.record.input()), outputs,
                                    array_of(file.record.reference()), gaps);
  result["names"] = file.outputs;
  result["units"] = units;
  result["input_unit"] = file.input_unit;
  result["notes"] = file.notes;
  result["period"] = file.period;
  result["sensor_delay"] = file.sensor_delay;
  return result;
}

// The points of a frequency response that satisfy a comparison.
py::array_t<bool> points_where(const std::string& text, const Reals& omega, const Complexes& value) {
  const io::PointFilter filter(text);
  if (!filter.condition().quantity())
    throw std::invalid_argument("condition '" + text +
                                "' is on a column of a file; expected re, im, magnitude, omega or f");
  py::array_t<bool> kept(omega.size());
  for (py::ssize_t i = 0; i < omega.size(); ++i) kept.mutable_data()[i] = filter(omega.data()[i], value.data()[i]);
  return kept;
}

}  // namespace
}  // namespace python

PYBIND11_MODULE(_files, module) {
  module.doc() = "Compiled part of fracfit that reads files.";
  using namespace python;
  module.def("read", [](const std::string& path, const py::dict& given, const std::vector<std::string>& where) {
    const io::FrequencyResponseReadOptions options = options_of(given);
    const bool over_time = result_of([&](frac::Progress&) { return io::holds_time_response(path, options.how); });
    return over_time ? record(path, where) : spectrum(path, options, where);
  });
  module.def("sweep_names", [](const std::string& path, const std::string& key_column) {
    return result_of([&](frac::Progress&) { return io::curve_labels(io::read_measurement(path), key_column); });
  });
  module.def("raw_record", &raw_record);
  module.def("points_where", &points_where);
  module.def("immittance_of_unit", [](const std::string& unit) {
    const auto found = io::immittance_of_unit(unit);
    return std::string(found ? io::to_string(*found) : "");
  });
  module.def("inverse_unit", &io::inverse_immittance_unit);
#ifdef FRACFIT_HAS_EXPORTS
  module.def("fmu_archive",
             [](const std::vector<std::pair<std::string, std::string>>& files, const std::string& main_source,
                const std::string& linux_path, const std::string& windows_path) {
               const auto made = result_of([&](frac::Progress&) {
                 return io::fmu_archive(files, main_source, {linux_path, windows_path});
               });
               return py::make_tuple(py::bytes(made.bytes), made.no_library);
             });
#endif
}
