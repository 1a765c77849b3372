// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pybind11/pybind11.h>

#include <functional>
#include <optional>

#include "frac/parallel_for.hpp"

namespace python {

/// Runs work in a thread of its own without the interpreter's lock, while the calling thread watches for signals, some
/// fifty times a second, and calls report(done, total) unless that is None.  A Ctrl-C, or an exception of `report`,
/// cancels the work and is thrown once its threads have ended; so is what the work throws.
void run(const std::function<void(frac::Progress&)>& work, const pybind11::object& report = pybind11::none());

/// The same for work with a result.
template <typename Work>
[[nodiscard]] auto result_of(const Work& work, const pybind11::object& report = pybind11::none()) {
  std::optional<decltype(work(std::declval<frac::Progress&>()))> result;
  run([&](frac::Progress& progress) { result.emplace(work(progress)); }, report);
  return std::move(*result);
}

}  // namespace python
