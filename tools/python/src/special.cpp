// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>

#include "arrays.hpp"
#include "frac/cancellation.hpp"
#include "frac/mittag_leffler.hpp"
#include "parts.hpp"
#include "run.hpp"

namespace python {
namespace {

// The same points whether or not a thread of its own is worth its while.
constexpr std::size_t few = 64;

// One pair of orders: the library's function of many points.
template <typename Number>
py::array_t<Number> of_points(double alpha, double beta, const py::array_t<Number, py::array::c_style>& z) {
  const auto at = span_of(z);
  std::vector<Number> value(at.size());
  run([&](frac::Progress&) { value = frac::mittag_leffler(alpha, beta, at); });
  return array_of(std::move(value));
}

// Orders and arguments of one length, point by point.
template <typename Number>
py::array_t<Number> point_by_point(const Reals& alpha, const Reals& beta,
                                   const py::array_t<Number, py::array::c_style>& z, bool derivative) {
  const auto a = span_of(alpha), b = span_of(beta);
  const auto at = span_of(z);
  std::vector<Number> value(at.size());
  const auto work = [&] {
    for (std::size_t i = 0; i < at.size(); ++i) {
      if (i % few == 0) frac::throw_if_cancelled();
      value[i] =
          derivative ? frac::mittag_leffler_derivative(a[i], b[i], at[i]) : frac::mittag_leffler(a[i], b[i], at[i]);
    }
  };
  if (at.size() <= few) {
    run_here(work);
  } else {
    run([&](frac::Progress&) { work(); });
  }
  return array_of(std::move(value));
}

// The function of three parameters, point by point.
template <typename Number>
py::array_t<Number> prabhakar_points(const Reals& alpha, const Reals& beta, const Reals& gamma,
                                     const py::array_t<Number, py::array::c_style>& z) {
  const auto a = span_of(alpha), b = span_of(beta), c = span_of(gamma);
  const auto at = span_of(z);
  std::vector<Number> value(at.size());
  run([&](frac::Progress&) {
    for (std::size_t i = 0; i < at.size(); ++i) {
      if (i % few == 0) frac::throw_if_cancelled();
      value[i] = frac::prabhakar(a[i], b[i], c[i], at[i]);
    }
  });
  return array_of(std::move(value));
}

}  // namespace

void add_special(py::module_& module) {
  module.def("mittag_leffler_points", &of_points<double>);
  module.def("mittag_leffler_points", &of_points<std::complex<double>>);
  module.def("mittag_leffler", &point_by_point<double>);
  module.def("mittag_leffler", &point_by_point<std::complex<double>>);
  module.def("prabhakar", &prabhakar_points<double>);
  module.def("prabhakar", &prabhakar_points<std::complex<double>>);
}

}  // namespace python
