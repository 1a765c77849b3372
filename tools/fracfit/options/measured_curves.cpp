// SPDX-License-Identifier: BSD-3-Clause
#include "options/measured_curves.hpp"

#include <algorithm>

namespace fracfit {

std::vector<MeasuredCurve> read_curves(const std::string& file, const io::MeasurementOptions& how,
                                       std::optional<backlash::Quantity> quantity,
                                       std::optional<io::Immittance> immittance) {
  const io::Measurement measurement = io::read_measurement(file, how);
  io::FrequencyResponseReadOptions options;
  options.how = how;
  options.quantity = quantity;
  options.immittance = immittance;
  std::vector<MeasuredCurve> curves;
  const auto labels = how.select.empty() ? io::curve_labels(measurement, "") : std::vector<std::string>{};
  for (const auto& label : labels) {
    options.curve = label;
    curves.push_back({label, io::read_frequency_response(measurement, options)});
  }
  const auto scenes = labels.empty() && how.select.empty() ? io::scenes_in(measurement) : std::vector<io::Metadata>{};
  for (const auto& scene : scenes) {
    options.rows = scene;
    std::string name;
    for (const auto& [key, value] : scene) name += (name.empty() ? "" : " ") + key + "=" + value;
    curves.push_back({name, io::read_frequency_response(measurement, options)});
  }
  if (curves.empty()) curves.push_back({"", io::read_frequency_response(measurement, options)});
  return curves;
}

std::vector<std::string> notes_of(const std::vector<MeasuredCurve>& curves) {
  std::vector<std::string> notes;
  for (const auto& curve : curves)
    for (const auto& note : curve.file.notes)
      if (std::find(notes.begin(), notes.end(), note) == notes.end()) notes.push_back(note);
  return notes;
}

}  // namespace fracfit
