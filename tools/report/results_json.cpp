// SPDX-License-Identifier: BSD-3-Clause
#include "report/results_json.hpp"

#include <cmath>
#include <nlohmann/json.hpp>

namespace report {

namespace {

using Json = nlohmann::ordered_json;

// JSON has no NaN and no infinity: null.
Json json_of(const Cell& cell) {
  if (const double* number = std::get_if<double>(&cell)) return std::isfinite(*number) ? Json(*number) : Json();
  return std::get<std::string>(cell);
}

Json json_of(const Table& table) {
  Json rows = Json::array();
  for (const auto& row : table.rows) {
    Json object = Json::object();
    for (std::size_t c = 0; c < row.size(); ++c) object[table.columns[c].name] = json_of(row[c]);
    rows.push_back(std::move(object));
  }
  return rows;
}

}  // namespace

std::string results_json(const Provenance& provenance, const std::vector<Section>& sections, bool pictures) {
  Json json;
  json["schema"] = "fracfit-report/1";
  json["fracfit"] = provenance.version;
  json["command"] = provenance.command;
  json["compiler"] = provenance.compiler;
  json["build_type"] = provenance.build_type;
  json["threads"] = provenance.threads;
  json["pictures"] = pictures;
  json["inputs"] = Json::object();
  for (const auto& [name, value] : provenance.inputs) json["inputs"][name] = value;
  json["seconds"] = Json::object();
  for (const StageTime& stage : provenance.stages) json["seconds"][stage.name] = stage.seconds;
  json["facts"] = Json::object();
  json["tables"] = Json::object();
  json["files"] = Json::array();
  for (const Section& section : sections) {
    for (const auto& [name, value] : section.facts) json["facts"][name] = json_of(value);
    for (const Block& block : section.blocks) {
      if (const Table* table = std::get_if<Table>(&block)) {
        json["files"].push_back("tables/" + table->name + ".csv");
        if (table->in_results) json["tables"][table->name] = json_of(*table);
      } else if (const Figure* figure = std::get_if<Figure>(&block)) {
        json["files"].push_back("figures/" + figure->name + ".gp");
        if (!pictures) continue;
        json["files"].push_back("figures/" + figure->name + ".svg");
        json["files"].push_back("figures/" + figure->name + ".png");
      }
    }
  }
  // Text from file names may hold bytes that are no UTF-8; they become the replacement character instead of an
  // exception.
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace report
