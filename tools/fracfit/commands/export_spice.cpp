// SPDX-License-Identifier: BSD-3-Clause
#include <cmath>
#include <stdexcept>
#include <string_view>

#include "commands/subcommand.hpp"
#include "frac/circuit.hpp"
#include "frac/model/algebra.hpp"
#include "frac/structure.hpp"
#include "io/version.hpp"
#include "options/model_options.hpp"

namespace fracfit {
namespace {

// A formula of powers of s or, of one-ports, also with functions and powers of sums.
struct CircuitModel {
  std::optional<frac::FractionalTransferFunction> powers;
  std::optional<frac::Structure> functions;  // where there are no powers
};

CircuitModel circuit_model_of(std::string_view, const std::string& text) {
  try {
    return {frac::FractionalTransferFunction::parse(text), std::nullopt};
  } catch (const std::invalid_argument&) {
    std::optional<frac::Structure> formula;
    try {
      formula.emplace(text);
    } catch (const std::invalid_argument&) {
    }
    if (!formula) throw;
    return {std::nullopt, std::move(formula)};
  }
}

class ExportSpice : public Command {
 public:
  ExportSpice() : Command("export spice", "SPICE subcircuit of an impedance or a transfer function, with its error") {
    Options& o = options();
    o.parsed("--model", model_, circuit_model_of,
             "of one-ports also with functions and powers of sums, as tanh(sqrt(2 s))/sqrt(2 s)")
        .or_argument()
        .required();
    o.text("--kind", kind_,
           "What the model is: an impedance (ohm) or admittance (S) becomes resistors, capacitors and inductors, all "
           "positive, between two nodes; a transfer function from voltage to voltage becomes controlled sources",
           "KIND")
        .one_of({"impedance", "admittance", "transfer"})
        .required();
    o.parsed("--band", band_, band_of, "the error holds there").required();
    o.number("--tolerance", tolerance_, "on the band").otherwise("1e-3");
    o.text("--name", netlist_.name, "the subcircuit").unsaid();
    add_common({"netlist"});
    set_footer(
        "Examples:\n"
        "  fracfit export spice 's^-0.5' --kind impedance --band 1:1e6 --out cpe.lib\n"
        "  fracfit export spice '5 + 1e-6 s + 20/(1 + (0.01 s)^0.8)' --kind impedance --band 1:1e5 --tolerance 1e-4\n"
        "  fracfit export spice '2 tanh(sqrt(3 s))/sqrt(3 s)' --kind impedance --band 1e-2:1e2 --name warburg\n"
        "  fracfit export spice 'exp(-0.2 s)/(0.8 s^2.2 + 0.5 s^0.9 + 1)' --kind transfer --band 1e-2:1e2 --name "
        "plant");
  }

 private:
  template <typename Circuit>
  int write_netlist(const Circuit& circuit, const std::string& contents) {
    netlist_.comment = circuit.summary() + "\n" + contents + "\nWritten by fracfit " + std::string(io::version()) +
                       ":\n  " + command_line() + " --name " + netlist_.name;
    write(frac::spice_netlist(circuit, netlist_));
    if (circuit.usable()) return usable_result;
    say(circuit.message);
    return no_usable_result;
  }

  void check() override {
    if (!model_.functions) return;
    if (kind_ == "transfer")
      throw std::invalid_argument(
          "--kind transfer takes ratios of sums of powers of s; one-ports alone have functions and powers of sums");
    if (!model_.functions->parameter_names().empty())
      throw std::invalid_argument("--model has the parameter " + model_.functions->parameter_names().front() +
                                  "; expected numbers");
  }

  int run() override {
    const std::string of_one_port = "Impedance between a and b; every element is positive, so the circuit is passive.";
    if (model_.functions) {
      const frac::Structure impedance =
          kind_ == "admittance" ? frac::Structure("1/(" + model_.functions->formula() + ")") : *model_.functions;
      return write_netlist(frac::passive_one_port(impedance, *band_, tolerance_), of_one_port);
    }
    if (kind_ == "transfer") {
      const frac::TransferCircuit circuit = frac::transfer_circuit(*model_.powers, *band_, tolerance_);
      return write_netlist(circuit,
                           circuit.leaking_integrators == 0
                               ? "Transfer function from the voltage in_plus, in_minus to out_plus, out_minus."
                               : "Transfer function from the voltage in_plus, in_minus to out_plus, out_minus; "
                                 "integrators leak so little that the error above holds.");
    }
    const auto one = frac::FractionalTransferFunction({{1, 0}}, {{1, 0}});
    const auto impedance = kind_ == "admittance" ? one / *model_.powers : *model_.powers;
    return write_netlist(frac::passive_one_port(impedance, *band_, tolerance_), of_one_port);
  }

  CircuitModel model_;
  std::string kind_;
  std::optional<frac::FrequencyBand> band_;
  double tolerance_ = 1e-3;
  frac::NetlistOptions netlist_;
};

}  // namespace

std::unique_ptr<Command> make_export_spice() {
  return std::make_unique<ExportSpice>();
}

}  // namespace fracfit
