// SPDX-License-Identifier: BSD-3-Clause
#include <string>

#include "base/identifier.hpp"
#include "base/number_text.hpp"
#include "frac/circuit.hpp"

namespace frac {
namespace {

using detail::number_text;

// The text of one subcircuit, line after line.
class Netlist {
 public:
  Netlist(const NetlistOptions& options, const std::string& ports) : name_(options.name) {
    detail::check_identifier("name of the subcircuit", name_);
    std::string line = "* ";
    for (const char c : options.comment + "\n") {
      line += c;
      if (c != '\n') continue;
      text_ += line;
      line = "* ";
    }
    text_ += ".subckt " + name_ + " " + ports + "\n";
  }

  void two_terminal(const std::string& element, const std::string& from, const std::string& to, double value) {
    text_ += element + " " + from + " " + to + " " + number_text(value) + "\n";
  }
  /// gain times the voltage from `plus` to `minus` as a current into `node`.
  void current_into(const std::string& element, const std::string& node, const std::string& plus,
                    const std::string& minus, double gain) {
    text_ += element + " 0 " + node + " " + plus + " " + minus + " " + number_text(gain) + "\n";
  }
  void line(const std::string& text) { text_ += text + "\n"; }
  [[nodiscard]] std::string closed() const { return text_ + ".ends " + name_ + "\n"; }

 private:
  std::string name_, text_;
};

void add_cell(Netlist& net, const FosterCell& cell, FosterForm form, const std::string& number, const std::string& from,
              const std::string& to) {
  if (form == FosterForm::series) {
    if (cell.resistance) net.two_terminal("R" + number, from, to, *cell.resistance);
    if (cell.capacitance) net.two_terminal("C" + number, from, to, *cell.capacitance);
    if (!cell.inductance) return;
    const std::string inner = cell.loss ? "l" + number : to;
    net.two_terminal("L" + number, from, inner, *cell.inductance);
    if (cell.loss) net.two_terminal("RL" + number, inner, to, *cell.loss);
    return;
  }
  std::string at = from;
  const auto next = [&](bool is_last, const char* prefix) { return is_last ? to : prefix + number; };
  if (cell.resistance) {
    const std::string node = next(!cell.inductance && !cell.capacitance, "r");
    net.two_terminal("R" + number, at, node, *cell.resistance);
    at = node;
  }
  if (cell.inductance) {
    const std::string node = next(!cell.capacitance, "l");
    net.two_terminal("L" + number, at, node, *cell.inductance);
    at = node;
  }
  if (cell.capacitance) net.two_terminal("C" + number, at, to, *cell.capacitance);
  if (cell.loss) net.two_terminal("RC" + number, at, to, *cell.loss);
}

}  // namespace

std::string spice_netlist(const PassiveOnePort& circuit, const NetlistOptions& options) {
  Netlist net(options, "a b");
  std::string from = "a";
  for (std::size_t i = 0; i < circuit.cells.size(); ++i) {
    const std::string number = std::to_string(i + 1);
    const bool is_last = i + 1 == circuit.cells.size();
    const bool in_series = circuit.form == FosterForm::series;
    const std::string to = is_last || !in_series ? "b" : "n" + number;
    add_cell(net, circuit.cells[i], circuit.form, number, from, to);
    if (in_series) from = to;
  }
  return net.closed();
}

std::string spice_netlist(const TransferCircuit& circuit, const NetlistOptions& options) {
  Netlist net(options, "in_plus in_minus out_plus out_minus");
  std::string plus = "in_plus", minus = "in_minus";
  if (circuit.delay > 0) {
    // A line that ends in its own resistance reflects nothing.
    net.line("E_in line_in 0 in_plus in_minus 1");
    net.line("T_delay line_in 0 line_out 0 Z0=1 TD=" + number_text(circuit.delay));
    net.line("R_line line_out 0 1");
    plus = "line_out";
    minus = "0";
  }
  const StateSpace& system = circuit.system;
  const std::size_t n = system.states;
  const auto node = [](std::size_t i) { return "x" + std::to_string(i + 1); };
  for (std::size_t i = 0; i < n; ++i) {
    const std::string number = std::to_string(i + 1);
    const double rate = circuit.rates[i];
    net.two_terminal("C" + number, node(i), "0", 1 / rate);
    const double own = system.a[i * n + i];
    if (own < 0) net.two_terminal("R" + number, node(i), "0", -rate / own);
    if (own > 0) net.current_into("G" + number, node(i), node(i), "0", own / rate);
    if (system.b[i] != 0) net.current_into("G_in_" + number, node(i), plus, minus, system.b[i] / rate);
    for (std::size_t j = 0; j < n; ++j) {
      if (j == i || system.a[i * n + j] == 0) continue;
      net.current_into("G" + number + "_" + std::to_string(j + 1), node(i), node(j), "0", system.a[i * n + j] / rate);
    }
  }
  // The weighted sum is the voltage that all currents make in 1 ohm.
  for (std::size_t i = 0; i < n; ++i) {
    if (system.c[i] != 0) net.current_into("G_out_" + std::to_string(i + 1), "sum", node(i), "0", system.c[i]);
  }
  if (system.d != 0) net.current_into("G_direct", "sum", plus, minus, system.d);
  net.two_terminal("R_sum", "sum", "0", 1);
  net.line("E_out out_plus out_minus sum 0 1");
  return net.closed();
}

}  // namespace frac
