// SPDX-License-Identifier: BSD-3-Clause
#include "report/report.hpp"

#include <glog/logging.h>

#include <optional>
#include <string>
#include <vector>

#include "arrays.hpp"
#include "run.hpp"

namespace python {
namespace {

report::Field field_of(const std::string& text) {
  std::string known;
  for (const auto field : report::fields()) {
    if (text == report::to_string(field)) return field;
    known += (known.empty() ? "" : ", ") + std::string(report::to_string(field));
  }
  throw std::invalid_argument("quantity \"" + text + "\": expected one of " + known);
}

py::tuple written(const std::string& out, const std::vector<std::string>& data, const std::optional<std::string>& scene,
                  const py::dict& given, const py::object& told) {
  report::ReportOptions options;
  options.out = out;
  options.data.assign(data.begin(), data.end());
  if (scene) options.scene = *scene;
  options.how.columns = given["columns"].cast<std::string>();
  options.how.frequency_unit = given["frequency_unit"].cast<std::string>();
  options.how.select = given["select"].cast<std::string>();
  options.field = field_of(given["quantity"].cast<std::string>());
  options.threads = given["threads"].cast<int>();
  options.command = given["command"].cast<std::string>();
  const auto outcome = result_of(
      [&](frac::Progress& progress) {
        options.progress = &progress;
        return report::write_report(options);
      },
      told);
  return py::make_tuple(outcome.index.string(), outcome.pictures, outcome.message);
}

}  // namespace
}  // namespace python

PYBIND11_MODULE(_report, module) {
  module.doc() = "Compiled part of fracfit that writes reports.";
  // What the solver would print of steps that fail stands in the results.
  FLAGS_minloglevel = google::GLOG_FATAL;
  module.def("report", &python::written);
}
