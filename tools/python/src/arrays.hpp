// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pybind11/complex.h>
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <cassert>
#include <complex>
#include <cstddef>
#include <initializer_list>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace python {

namespace py = pybind11;

/// What the Python layer hands over: contiguous, of the machine's byte order, checked for its type and shape there.
using Reals = py::array_t<double, py::array::c_style>;
using Complexes = py::array_t<std::complex<double>, py::array::c_style>;

template <typename T>
[[nodiscard]] std::span<const T> span_of(const py::array_t<T, py::array::c_style>& array) {
  return {array.data(), static_cast<std::size_t>(array.size())};
}

template <typename T>
[[nodiscard]] std::vector<T> vector_of(const py::array_t<T, py::array::c_style>& array) {
  return {array.data(), array.data() + array.size()};
}

/// Takes the numbers over without a copy.
template <typename T>
[[nodiscard]] py::array_t<T> array_of(std::vector<T> numbers, std::vector<py::ssize_t> shape = {}) {
  auto owned = std::make_unique<std::vector<T>>(std::move(numbers));
  const T* data = owned->data();
  if (shape.empty()) shape.push_back(static_cast<py::ssize_t>(owned->size()));
  const py::capsule owner(owned.release(), [](void* all) { delete static_cast<std::vector<T>*>(all); });
  return py::array_t<T>(std::move(shape), data, owner);
}

/// One number of each of many structs as an array.
template <typename T, typename Structs, typename Get>
[[nodiscard]] py::array_t<T> column_of(const Structs& structs, Get get) {
  py::array_t<T> numbers(static_cast<py::ssize_t>(structs.size()));
  T* out = numbers.mutable_data();
  for (const auto& each : structs) *out++ = static_cast<T>(get(each));
  return numbers;
}

/// Words of an enumeration, whose numbers stand in a column; listed in its order, from 0 on.
template <typename Enum>
[[nodiscard]] py::list words_of(std::initializer_list<Enum> all) {
  py::list words;
  for (const Enum each : all) {
    assert(static_cast<std::size_t>(each) == words.size());
    words.append(std::string(to_string(each)));
  }
  return words;
}

}  // namespace python
