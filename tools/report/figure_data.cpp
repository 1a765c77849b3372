// SPDX-License-Identifier: BSD-3-Clause
#include "report/figure_data.hpp"

#include <cmath>
#include <nlohmann/json.hpp>

namespace report {

namespace {

using Json = nlohmann::ordered_json;

std::string_view name_of(Mark mark) {
  switch (mark) {
    case Mark::line:
      return "line";
    case Mark::dashed:
      return "dashed";
    case Mark::dotted:
      return "dotted";
    case Mark::line_points:
      return "line_points";
    case Mark::points:
      return "points";
    case Mark::open_points:
      return "open_points";
    case Mark::faint_points:
      return "faint_points";
    case Mark::faint_bars:
      return "faint_bars";
    case Mark::band:
      return "band";
  }
  return {};
}

// [x, y], and where they say more lower, upper and what tells the point apart.
Json json_of(const PlotPoint& point) {
  Json numbers = {point.x, point.y};
  const bool has_at = !std::isnan(point.at);
  if (has_at || point.lower != point.y || point.upper != point.y) {
    numbers.push_back(point.lower);
    numbers.push_back(point.upper);
  }
  if (has_at) numbers.push_back(point.at);
  return numbers;
}

Json json_of(const Curve& curve) {
  Json segments = Json::array();
  for (const auto& segment : curve.segments) {
    Json points = Json::array();
    for (const PlotPoint& point : segment) points.push_back(json_of(point));
    segments.push_back(std::move(points));
  }
  return {{"label", curve.label}, {"colour", curve.colour}, {"mark", name_of(curve.mark)}, {"segments", segments}};
}

Json json_of(const Axis& axis) {
  Json json = {{"label", axis.label}, {"logarithmic", axis.logarithmic}, {"degrees", axis.degrees}};
  if (axis.to) json["to"] = *axis.to;
  return json;
}

Json json_of(const Panel& panel) {
  Json curves = Json::array();
  for (const Curve& curve : panel.curves) curves.push_back(json_of(curve));
  return {{"title", panel.title}, {"x", json_of(panel.x)}, {"y", json_of(panel.y)}, {"equal_axes", panel.equal_axes},
          {"wide", panel.wide},   {"tall", panel.tall},    {"curves", curves}};
}

}  // namespace

std::string figure_data(const Figure& figure) {
  Json panels = Json::array();
  for (const Panel& panel : figure.panels) panels.push_back(json_of(panel));
  const Json json = {{"name", figure.name},
                     {"link", figure.link},
                     {"columns", figure.columns},
                     {"panel_height", figure.panel_height},
                     {"panels", panels}};
  const std::string text = json.dump(-1, ' ', false, Json::error_handler_t::replace);
  // A label that holds "</script>" would end the element; inside JSON strings the escape reads the same.
  std::string safe;
  for (const char c : text) safe += c == '<' ? std::string("\\u003c") : std::string(1, c);
  return safe;
}

}  // namespace report
