// SPDX-License-Identifier: BSD-3-Clause
#include <string>

#include "arrays.hpp"
#include "frac/cancellation.hpp"
#include "frac/laplace_value.hpp"
#include "frac/loop_stability.hpp"
#include "frac/model/algebra.hpp"
#include "frac/model/delayed_loop.hpp"
#include "frac/model/frequency_response_data.hpp"
#include "frac/model/time_response_data.hpp"
#include "frac/no_ratio.hpp"
#include "frac/parameter_units.hpp"
#include "frac/stability.hpp"
#include "frac/structure.hpp"
#include "parts.hpp"
#include "realisation_choice.hpp"
#include "run.hpp"

namespace python {
namespace {

using Transfer = frac::FractionalTransferFunction;

// Points that are evaluated between two looks at the cancellation flag.
constexpr std::size_t block = 4096;

Complexes response(const frac::Structure& structure, const std::vector<double>& values, const Reals& omega,
                   const py::dict& choice) {
  Complexes result(omega.size());
  const std::span<const double> at = span_of(omega);
  const std::span<std::complex<double>> out(result.mutable_data(), at.size());
  const frac::Realisation realisation = realisation_of(choice);
  const auto evaluate = [&](std::size_t begin, std::size_t count) {
    structure.response(values, at.subspan(begin, count), realisation, out.subspan(begin, count));
  };
  if (at.size() <= block) {
    run_here([&] { evaluate(0, at.size()); });
  } else {
    run([&](frac::Progress&) {
      for (std::size_t i = 0; i < at.size(); i += block) {
        frac::throw_if_cancelled();
        evaluate(i, std::min(block, at.size() - i));
      }
    });
  }
  return result;
}

Complexes values_at(const Transfer& model, const Complexes& s) {
  Complexes result(s.size());
  const auto at = span_of(s);
  std::complex<double>* out = result.mutable_data();
  const auto evaluate = [&] {
    for (std::size_t i = 0; i < at.size(); ++i) {
      if (i % block == 0) frac::throw_if_cancelled();
      out[i] = frac::laplace_value(model, at[i]);
    }
  };
  if (at.size() <= block) {
    run_here(evaluate);
  } else {
    run([&](frac::Progress&) { evaluate(); });
  }
  return result;
}

py::list terms_of(const std::vector<frac::PowerTerm>& terms) {
  py::list list;
  for (const auto& term : terms) list.append(py::make_tuple(term.coefficient, term.order));
  return list;
}

py::dict stability_of(const Transfer& model) {
  const auto analysis = result_of([&](frac::Progress&) { return frac::analyse_stability(model); });
  py::dict result;
  result["stability"] = std::string(frac::to_string(analysis.stability));
  result["poles"] = column_of<std::complex<double>>(analysis.poles, [](const auto& pole) { return pole.value; });
  result["multiplicity"] = column_of<int>(analysis.poles, [](const auto& pole) { return pole.multiplicity; });
  result["cancelled"] = column_of<bool>(analysis.poles, [](const auto& pole) { return pole.cancelled; });
  result["commensurate_order"] = analysis.commensurate_order;
  result["remark"] = analysis.remark;
  result["summary"] = analysis.summary();
  return result;
}

py::array crossovers_of(const std::vector<frac::Crossover>& crossovers) {
  std::vector<double> numbers;
  for (const auto& each : crossovers) numbers.insert(numbers.end(), {each.omega, each.margin});
  return array_of(std::move(numbers), {static_cast<py::ssize_t>(crossovers.size()), 2});
}

py::dict margins_of(const Transfer& loop) {
  const auto margins = result_of([&](frac::Progress&) { return frac::margins(loop); });
  py::dict result;
  result["gain_margin"] = margins.gain_margin;
  result["gain_reduction"] = margins.gain_reduction;
  result["phase_margin"] = margins.phase_margin;
  result["delay_margin"] = margins.delay_margin;
  result["phase_crossovers"] = crossovers_of(margins.gain);
  result["gain_crossovers"] = crossovers_of(margins.phase);
  result["remark"] = margins.remark;
  return result;
}

}  // namespace

void add_model(py::module_& module) {
  using namespace py::literals;
  py::class_<frac::Structure>(module, "Structure")
      .def(py::init<std::string>())
      .def_property_readonly("formula", &frac::Structure::formula)
      .def_property_readonly("grouped", &frac::Structure::grouped)
      .def_property_readonly("parameter_names", &frac::Structure::parameter_names)
      .def_property_readonly("is_fractional", &frac::Structure::has_fractional_order)
      .def("response", &response)
      .def("transfer_function",
           [](const frac::Structure& structure, const std::vector<double>& values) {
             return frac::to_transfer_function(structure, values);
           })
      .def("delayed_loop", [](const frac::Structure& structure, const std::vector<double>& values) {
        return frac::delayed_loop(structure, values);
      });
  py::class_<frac::DelayedLoop>(module, "DelayedLoop").def("closed_loop", [](const frac::DelayedLoop& closed) {
    return std::string(
        frac::to_string(result_of([&](frac::Progress&) { return frac::analyse_closed_loop(closed); }).stability));
  });
  py::register_exception<frac::NoRatio>(module, "NoRatio", PyExc_ValueError);
  py::class_<Transfer>(module, "TransferFunction")
      .def_static("parse", [](const std::string& formula) { return Transfer::parse(formula); })
      .def_property_readonly("formula", &Transfer::formula)
      .def_property_readonly("numerator", [](const Transfer& model) { return terms_of(model.numerator()); })
      .def_property_readonly("denominator", [](const Transfer& model) { return terms_of(model.denominator()); })
      .def_property_readonly("delay", &Transfer::delay)
      .def("values_at", &values_at)
      .def("stability", &stability_of)
      .def("margins", &margins_of)
      .def("closed_loop",
           [](const Transfer& loop) {
             const auto found = result_of([&](frac::Progress&) { return frac::analyse_closed_loop(loop); });
             return py::make_tuple(std::string(frac::to_string(found.stability)), found.unstable_poles);
           })
      .def("h2_norm", [](const Transfer& model) { return result_of([&](auto&) { return frac::h2_norm(model); }); })
      .def("peak_gain",
           [](const Transfer& model) {
             const auto peak = result_of([&](frac::Progress&) { return frac::h_infinity_norm(model); });
             return py::make_tuple(peak.gain, peak.omega);
           })
      .def("add", [](const Transfer& a, const Transfer& b) { return a + b; })
      .def("subtract", [](const Transfer& a, const Transfer& b) { return a - b; })
      .def("multiply", [](const Transfer& a, const Transfer& b) { return a * b; })
      .def("divide", [](const Transfer& a, const Transfer& b) { return a / b; })
      .def("feedback", [](const Transfer& forward, const Transfer& back) { return frac::feedback(forward, back); })
      .def("simplified", [](const Transfer& model) { return frac::simplified(model); });
  module.def("parameter_units", [](const std::string& formula, const std::string& unit) {
    return frac::parameter_units(frac::Structure(formula), unit);
  });
  // Data are checked by the constructors of the library, whose sentences the caller is to see.
  module.def("check_frequency_response", [](const Reals& omega, const Complexes& value, const Reals& sigma) {
    static_cast<void>(frac::FrequencyResponseData(vector_of(omega), vector_of(value), vector_of(sigma)));
  });
  module.def("check_time_response", [](const Reals& time, const Reals& input, const Reals& output, const Reals& sigma) {
    static_cast<void>(frac::TimeResponseData(vector_of(time), vector_of(input), vector_of(output), vector_of(sigma),
                                             frac::Hold::zero_order, std::numeric_limits<double>::lowest()));
  });
}

}  // namespace python
