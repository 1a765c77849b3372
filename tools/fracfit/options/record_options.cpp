// SPDX-License-Identifier: BSD-3-Clause
#include "options/record_options.hpp"

#include <array>
#include <limits>
#include <memory>
#include <stdexcept>
#include <string>
#include <utility>

namespace fracfit {
namespace {

constexpr std::array names = {"--sensor-noise", "--force-noise",  "--quantisation", "--clip",
                              "--sensor-delay", "--clock-jitter", "--seed"};

}  // namespace

void RecordOptions::add(Options& options, const std::string& record) {
  options.number(names[0], sensors_.position.noise);
  options.number(names[1], sensors_.force.noise);
  options.number(names[2], sensors_.position.quantisation);
  options.number(names[3], clip_).default_is("none");
  options.number(names[4], sensors_.position.delay);
  options.number(names[5], sensors_.clock_jitter);
  options.count(names[6], sensors_.seed, 0, std::numeric_limits<std::uint64_t>::max(), "of noise and jitter");
  for (const char* name : names) options[name].only_with({record}, "which makes the output a record");
}

void RecordOptions::check(const Options& options) const {
  const auto require = [&](const char* name, bool is_allowed, const char* allowed) {
    if (!is_allowed)
      throw std::invalid_argument(name + (" " + options[name].text()) + ": allowed is a finite number " + allowed);
  };
  for (const auto& [name, value] :
       {std::pair{names[0], sensors_.position.noise}, std::pair{names[1], sensors_.force.noise},
        std::pair{names[2], sensors_.position.quantisation}, std::pair{names[4], sensors_.position.delay},
        std::pair{names[5], sensors_.clock_jitter}})
    require(name, value >= 0 && std::isfinite(value), "from 0");
  if (options[names[3]].is_given()) require(names[3], clip_ > 0 && std::isfinite(clip_), "above 0");
}

Rows RecordOptions::rows(const backlash::RigMotion& motion, double sample_time) const {
  backlash::RigSensors sensors = sensors_;
  sensors.sample_time = sample_time;
  if (!std::isnan(clip_)) sensors.position.clip = clip_;
  const auto record = std::make_shared<const backlash::RigRecord>(rig_record(motion, sensors));
  Rows rows{{"time_s", "force_n", "x1_m", "x2_m"}, record->time.size(), {}};
  std::vector<const std::vector<double>*> columns{&record->time, &record->force, &record->x1, &record->x2};
  if (!record->set_point.empty()) {
    rows.columns.emplace_back("reference_m");
    columns.push_back(&record->set_point);
  }
  rows.fill = [record, columns](std::size_t i, std::vector<Cell>& cells) {
    for (const auto* column : columns) cells.emplace_back((*column)[i]);
  };
  return rows;
}

}  // namespace fracfit
