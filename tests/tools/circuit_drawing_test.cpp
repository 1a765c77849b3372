// SPDX-License-Identifier: BSD-3-Clause
#include "report/circuit_drawing.hpp"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <complex>
#include <map>
#include <numeric>
#include <regex>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "frac/identification/model_library.hpp"
#include "frac/structure.hpp"

namespace {

struct Point {
  double x, y;
};
struct Wire {
  Point from, to;
};
/// What a reader sees: wires, symbols between two points of the wire, names, and the two terminals.
struct Drawn {
  std::vector<Wire> wires;
  std::vector<Wire> symbols;
  std::vector<std::string> names;
  std::vector<Point> terminals;
};

double number(const std::string& text) {
  return std::stod(text);
}

/// A symbol is a group of its own with a name; its drawing begins and ends on the wire.
Drawn read(const std::string& svg) {
  Drawn drawn;
  std::vector<Point> origin{{0, 0}};
  std::vector<Wire> strokes;
  const std::regex piece(
      R"x(<g transform="translate\(([-.\d]+) ([-.\d]+)\)">|(<g [^>]*>)|(</g>)|<path d="([^"]*)"/>|<text x="([-.\d]+)" y="[-.\d]+">([^<]*)</text>|<circle cx="([-.\d]+)" cy="([-.\d]+)")x");
  for (std::sregex_iterator at(svg.begin(), svg.end(), piece), end; at != end; ++at) {
    const std::smatch& found = *at;
    const Point base = origin.back();
    if (found[1].matched) {
      origin.push_back({base.x + number(found[1]), base.y + number(found[2])});
    } else if (found[3].matched) {
      origin.push_back(base);
    } else if (found[4].matched) {
      origin.pop_back();
    } else if (found[5].matched) {
      const std::string path = found[5];
      const std::regex segment(R"(M([-.\d]+) ([-.\d]+)L([-.\d]+) ([-.\d]+))");
      strokes.clear();
      for (std::sregex_iterator each(path.begin(), path.end(), segment); each != end; ++each)
        strokes.push_back({{base.x + number((*each)[1]), base.y + number((*each)[2])},
                           {base.x + number((*each)[3]), base.y + number((*each)[4])}});
      drawn.wires.insert(drawn.wires.end(), strokes.begin(), strokes.end());
    } else if (found[6].matched) {
      // The strokes just read are those of this symbol, no wire through it.
      drawn.wires.resize(drawn.wires.size() - strokes.size());
      drawn.symbols.push_back({strokes.front().from, strokes.back().to});
      drawn.names.push_back(found[7]);
      EXPECT_DOUBLE_EQ(base.x + number(found[6]), (drawn.symbols.back().from.x + drawn.symbols.back().to.x) / 2);
    } else {
      drawn.terminals.push_back({number(found[8]), number(found[9])});
    }
  }
  return drawn;
}

bool lies_on(const Point& point, const Wire& wire) {
  // Distances are of whole pixels or of some decimals.
  constexpr double rounding = 1e-6;
  const double length = std::hypot(wire.to.x - wire.from.x, wire.to.y - wire.from.y);
  return std::hypot(point.x - wire.from.x, point.y - wire.from.y) +
             std::hypot(point.x - wire.to.x, point.y - wire.to.y) <
         length + rounding;
}

/// Between the terminals, where each symbol is a resistance of 1.
double resistance(const Drawn& drawn) {
  std::vector<Point> points;
  for (const auto* const wires : {&drawn.wires, &drawn.symbols})
    for (const Wire& each : *wires) points.insert(points.end(), {each.from, each.to});
  // The terminals are circles whose edge touches the wire.
  for (const Point& terminal : drawn.terminals) points.push_back({terminal.x + (terminal.x < 20 ? 4 : -4), terminal.y});
  std::vector<std::size_t> node(points.size());
  std::iota(node.begin(), node.end(), std::size_t{0});
  const auto join = [&](std::size_t a, std::size_t b) {
    const std::size_t from = node[a], to = node[b];
    std::replace(node.begin(), node.end(), from, to);
  };
  for (std::size_t a = 0; a < points.size(); ++a) {
    for (std::size_t b = 0; b < a; ++b)
      if (lies_on(points[a], {points[b], points[b]})) join(a, b);
    for (std::size_t wire = 0; wire < drawn.wires.size(); ++wire)
      if (lies_on(points[a], drawn.wires[wire])) {
        join(a, 2 * wire);
        join(a, 2 * wire + 1);
      }
  }
  const auto count = static_cast<Eigen::Index>(points.size());
  Eigen::MatrixXd conductance = Eigen::MatrixXd::Zero(count, count);
  for (std::size_t k = 0; k < drawn.symbols.size(); ++k) {
    const std::size_t first = 2 * (drawn.wires.size() + k);
    const auto a = static_cast<Eigen::Index>(node[first]), b = static_cast<Eigen::Index>(node[first + 1]);
    conductance(a, a) += 1;
    conductance(b, b) += 1;
    conductance(a, b) -= 1;
    conductance(b, a) -= 1;
  }
  const auto in = static_cast<Eigen::Index>(node[points.size() - 2]), out = static_cast<Eigen::Index>(node.back());
  // The outlet is at potential 0; so is every point that no symbol touches.
  for (Eigen::Index i = 0; i < count; ++i)
    if (i == out || conductance(i, i) == 0) {
      conductance.row(i).setZero();
      conductance(i, i) = 1;
    }
  return conductance.fullPivLu().solve(Eigen::VectorXd::Unit(count, in))(in);
}

TEST(CircuitDrawing, ConductsAsTheCircuitDoes) {
  const std::vector<std::pair<std::string, double>> cases{
      {"R0", 1},
      {"L0+R0+(R1|CPE1)+Wo2", 3.5},
      {"(R1|C1)+(R2|L2)", 1},
      {"R0+((R1+Wo2)|C1|L1)+G3", 2.4},
      {"(A|B|C|D|E)", 0.2},
      {"((R1|C1)+R2|(R3+R4+(R5|C5)|CPE6)+L7)", 1 / (1 / 1.5 + 1 / (1 / (1 / 2.5 + 1) + 1))}};
  for (const auto& [circuit, expected] : cases)
    EXPECT_NEAR(resistance(read(report::circuit_drawing(circuit))), expected, 1e-12) << circuit;
}

TEST(CircuitDrawing, NamesEachElementOnceAndKeepsThemApart) {
  const Drawn drawn = read(report::circuit_drawing("L0+R0+((R1+Wo2)|CPE1|L1)+mode<3>"));
  EXPECT_EQ(drawn.names, (std::vector<std::string>{"L0", "R0", "R1", "Wo2", "CPE1", "L1", "mode&lt;3&gt;"}));
  for (std::size_t a = 0; a < drawn.symbols.size(); ++a)
    for (std::size_t b = 0; b < a; ++b) {
      const Wire &one = drawn.symbols[a], &other = drawn.symbols[b];
      const bool beside = one.from.x >= other.to.x || other.from.x >= one.to.x;
      // A symbol with its name is 30 pixels high.
      EXPECT_TRUE(beside || std::abs(one.from.y - other.from.y) >= 30) << drawn.names[a] << " and " << drawn.names[b];
    }
}

TEST(CircuitDrawing, RefusesWhatIsNoCircuit) {
  for (const char* const text : {"", "R0+", "(R1|CPE1", "R1)+C2", "R0+()"})
    EXPECT_THROW((void)report::circuit_drawing(text), std::invalid_argument) << text;
}

using Complex = std::complex<double>;

/// Impedance of a circuit without brackets in brackets, its elements by the parameters of a formula.
Complex impedance(const std::string& circuit, const std::map<std::string, double>& value, Complex s) {
  const auto element = [&](const std::string& name) -> Complex {
    const std::string kind = name.substr(0, name.find_first_of("0123456789")), n = name.substr(kind.size());
    if (kind == "R") return value.at(name);
    if (kind == "L") return value.at(name) * s;
    if (kind == "C") return 1.0 / (value.at(name) * s);
    if (kind == "CPE" && value.contains("Q" + n)) return 1.0 / (value.at("Q" + n) * std::pow(s, value.at("n" + n)));
    if (kind == "CPE") return value.at("A") * std::pow(s, value.at("n" + n));
    const Complex root = std::sqrt(value.at("T") * s);
    if (kind == "Ws") return value.at("R" + n) * std::tanh(root) / root;
    if (kind == "Wo") return value.at("R" + n) / std::tanh(root) / root;
    throw std::logic_error(name);
  };
  Complex sum = 0;
  const std::regex part(R"(\(([^|]*)\|([^)]*)\)|([^+()|]+))");
  for (std::sregex_iterator at(circuit.begin(), circuit.end(), part), end; at != end; ++at)
    sum += (*at)[3].matched ? element((*at)[3]) : 1.0 / (1.0 / element((*at)[1]) + 1.0 / element((*at)[2]));
  return sum;
}

TEST(CircuitDrawing, OfAPresetIsThatOfItsFormula) {
  std::size_t circuits = 0;
  for (const frac::NamedModel& model : frac::model_library()) {
    const std::string circuit = report::circuit_of(model.name);
    if (circuit.empty()) continue;
    ++circuits;
    const frac::Structure structure(model.formula);
    std::map<std::string, double> value;
    std::vector<double> parameters;
    for (const std::string& name : structure.parameter_names()) {
      const double size = 0.3 + 0.17 * static_cast<double>(parameters.size());
      // Orders of constant-phase elements in series stand with their sign.
      const bool falls = (model.name == "arc-and-cpe" && name == "n2") || (model.name == "r-l-cpe" && name == "n1");
      parameters.push_back(value[name] = falls ? -0.6 : size);
    }
    for (const double omega : {0.1, 1.0, 20.0}) {
      const Complex s(0, omega), expected = impedance(circuit, value, s);
      EXPECT_NEAR(std::abs(structure.response(parameters, omega) / expected - 1.0), 0, 1e-12) << model.name;
    }
  }
  EXPECT_EQ(circuits, 8U);
  EXPECT_EQ(report::circuit_of("elements:R0+(R1|CPE1)"), "R0+(R1|CPE1)");
  EXPECT_EQ(report::circuit_of("fractional-lag"), "");
}

}  // namespace
