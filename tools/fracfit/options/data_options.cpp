// SPDX-License-Identifier: BSD-3-Clause
#include "options/data_options.hpp"

namespace fracfit {

void add_file_options(Options& options, io::MeasurementOptions& how) {
  options
      .parsed(
          "--columns", how.columns,
          [](std::string_view, const std::string& text) {
            static_cast<void>(io::columns_told(text));
            return text;
          },
          "Which column is what, by number or name; e.g. f=1,re=2,-im=3, keys f, omega, re, im, -im, magnitude, "
          "magnitude_db, phase_deg, phase_rad, sigma, weight",
          "LIST")
      .only_for(frequency_response);
  options.text("--frequency-unit", how.frequency_unit, "Unit of a frequency whose name gives none, e.g. Hz", "UNIT")
      .one_of({"Hz", "kHz", "MHz", "GHz", "mHz", "rad/s", "krad/s"})
      .only_for(frequency_response);
}

void add_select(Options& options, io::MeasurementOptions& how) {
  options.text("--select", how.select, "One of several sweeps in the file, by its number from 1 or its name", "SWEEP")
      .only_for(frequency_response);
}

void add_quantity(Options& options, std::optional<backlash::Quantity>& quantity) {
  options
      .choice("--quantity", quantity, backlash::quantities(),
              "N or -1/N, made of the other one where the file holds that, which its header tells, or the unit N/m")
      .default_is("as the file has it")
      .only_for(frequency_response);
}

Option& add_immittance(Options& options, std::optional<io::Immittance>& immittance) {
  return options
      .choice("--component", immittance, io::immittances(),
              "made of the other one where the file holds that, which its columns or the unit tell")
      .default_is("as the file has it");
}

}  // namespace fracfit
