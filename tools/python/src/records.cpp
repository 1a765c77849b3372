// SPDX-License-Identifier: BSD-3-Clause
#include <complex>
#include <cstdint>
#include <limits>
#include <optional>
#include <stdexcept>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "arrays.hpp"
#include "frac/records/multisine.hpp"
#include "frac/records/response.hpp"
#include "parts.hpp"
#include "run.hpp"

namespace python {
namespace {

// Sample time, input, outputs, a reference or nothing, and pairs of the first sample after a gap and of how many it
// lacks.
using Signals = std::tuple<double, Reals, std::vector<Reals>, Reals, std::vector<std::pair<std::size_t, std::size_t>>>;

frac::Record record_of(const Signals& signals) {
  const auto& [sample_time, input, outputs, reference, gaps] = signals;
  std::vector<std::vector<double>> answers;
  std::vector<frac::RecordGap> missing;
  for (const auto& [before, count] : gaps) missing.push_back({before, count});
  for (const Reals& output : outputs) answers.push_back(vector_of(output));
  return {sample_time, vector_of(input), std::move(answers), vector_of(reference), std::move(missing)};
}

template <typename All>
auto word_of(const char* name, const std::string& text, const All& all) {
  std::string words;
  for (const auto each : all) {
    if (text == to_string(each)) return each;
    words += (words.empty() ? "" : ", ") + std::string(to_string(each));
  }
  throw std::invalid_argument(std::string(name) + " \"" + text + "\": expected one of " + words);
}

// One row for each output.
template <typename T, typename Get>
py::array_t<T> rows_of(const frac::ResponseEstimate& found, Get get) {
  std::vector<T> numbers;
  for (const auto& points : found.outputs)
    for (const frac::ResponsePoint& point : points) numbers.push_back(static_cast<T>(get(point)));
  return array_of(std::move(numbers), {static_cast<py::ssize_t>(found.outputs.size()),
                                       static_cast<py::ssize_t>(found.outputs.front().size())});
}

// One number of the harmonics from the second on, NaN where there is none, as rows of the points of each output.
template <typename T, typename Get>
py::array_t<T> harmonics_of(const frac::ResponseEstimate& found, std::size_t orders, Get get) {
  std::vector<T> numbers;
  for (const auto& points : found.outputs)
    for (const frac::ResponsePoint& point : points)
      for (std::size_t k = 0; k < orders; ++k)
        numbers.push_back(k < point.harmonics.size() ? get(point.harmonics[k])
                                                     : T(std::numeric_limits<double>::quiet_NaN()));
  return array_of(std::move(numbers),
                  {static_cast<py::ssize_t>(found.outputs.size()),
                   static_cast<py::ssize_t>(found.outputs.front().size()), static_cast<py::ssize_t>(orders)});
}

py::dict response(const std::vector<Signals>& given, const std::optional<std::string>& excitation,
                  const std::optional<double>& period, int harmonics, double sensor_delay) {
  frac::ResponseOptions options{{}, period, harmonics, sensor_delay};
  if (excitation) options.excitation = word_of("excitation", *excitation, frac::excitations());
  std::vector<frac::Record> records;
  for (const Signals& signals : given) records.push_back(record_of(signals));
  const auto found = result_of([&](frac::Progress&) { return frac::response(records, options); });
  using Point = frac::ResponsePoint;
  using Complex = std::complex<double>;
  py::dict result;
  result["omega"] = column_of<double>(found.outputs.front(), [](const Point& p) { return p.omega; });
  result["response"] = rows_of<Complex>(found, [](const Point& p) { return p.value; });
  result["sigma"] = rows_of<double>(found, [](const Point& p) { return p.sigma_or_rounding(); });
  result["deviation_re"] = rows_of<double>(found, [](const Point& p) { return p.sigma_re; });
  result["deviation_im"] = rows_of<double>(found, [](const Point& p) { return p.sigma_im; });
  result["correlation"] = rows_of<double>(found, [](const Point& p) { return p.correlation; });
  result["degrees_of_freedom"] = rows_of<double>(found, [](const Point& p) { return p.degrees; });
  result["noise"] = rows_of<double>(found, [](const Point& p) { return p.noise; });
  result["distortion"] = rows_of<double>(found, [](const Point& p) { return p.distortion; });
  result["even_distortion"] = rows_of<double>(found, [](const Point& p) { return p.even_distortion; });
  result["distortion_low"] = rows_of<double>(found, [](const Point& p) { return p.distortion_low; });
  result["distortion_high"] = rows_of<double>(found, [](const Point& p) { return p.distortion_high; });
  result["even_distortion_low"] = rows_of<double>(found, [](const Point& p) { return p.even_distortion_low; });
  result["even_distortion_high"] = rows_of<double>(found, [](const Point& p) { return p.even_distortion_high; });
  result["coherence"] = rows_of<double>(found, [](const Point& p) { return p.coherence; });
  result["h1"] = rows_of<Complex>(found, [](const Point& p) { return p.windowed; });
  result["subharmonic"] = rows_of<std::int64_t>(found, [](const Point& p) { return p.subharmonic; });
  const bool is_stepped = found.excitation == frac::Excitation::stepped_sine;
  const std::size_t orders = is_stepped ? static_cast<std::size_t>(harmonics) - 1 : 0;
  result["harmonics"] = harmonics_of<Complex>(found, orders, [](const auto& each) { return each.value; });
  result["harmonics_sigma"] = harmonics_of<double>(found, orders, [](const auto& each) { return each.sigma; });
  result["input_amplitude"] =
      column_of<double>(found.outputs.front(), [](const Point& p) { return p.input_amplitude; });
  result["periods"] = column_of<double>(found.outputs.front(), [](const Point& p) { return p.periods; });
  std::vector<std::vector<std::string>> flags;
  for (const auto& points : found.outputs) {
    auto& of_output = flags.emplace_back();
    for (const Point& point : points) of_output.push_back(point.flag);
  }
  result["flags"] = flags;
  result["excitation"] = std::string(to_string(found.excitation));
  result["period"] = found.period;
  result["realisations"] = found.realisations;
  result["remarks"] = found.remarks;
  return result;
}

py::dict multisine(const std::pair<double, double>& band, double period, double sample_time, const std::string& lines,
                   double peak, std::uint64_t seed, int rounds) {
  const frac::MultisineOptions options{
      band.first, band.second, period, sample_time, word_of("lines", lines, frac::multisine_lines()),
      peak,       seed,        rounds};
  const frac::Multisine made = result_of([&](frac::Progress&) { return frac::multisine(options); });
  py::dict result;
  result["input"] = array_of(made.samples);
  result["lines"] = array_of(std::vector<std::int64_t>(made.lines.begin(), made.lines.end()));
  result["amplitude"] = made.amplitude;
  result["crest_factor"] = made.crest_factor;
  return result;
}

py::dict stepped_sine_plan(const std::vector<double>& omega, double total_time, std::size_t settling) {
  std::vector<double> at, begin, end;
  std::vector<std::int64_t> settles, measures;
  for (const frac::SteppedSineStep& step : frac::stepped_sine_plan(omega, total_time, settling)) {
    at.push_back(step.omega);
    settles.push_back(static_cast<std::int64_t>(step.settling));
    measures.push_back(static_cast<std::int64_t>(step.measuring));
    begin.push_back(step.begin);
    end.push_back(step.end);
  }
  py::dict result;
  result["omega"] = array_of(at);
  result["settling"] = array_of(settles);
  result["measuring"] = array_of(measures);
  result["begin"] = array_of(begin);
  result["end"] = array_of(end);
  return result;
}

}  // namespace

void add_records(py::module_& module) {
  module.def("response", &response);
  module.def("multisine", &multisine);
  module.def("stepped_sine_plan", &stepped_sine_plan);
}

}  // namespace python
