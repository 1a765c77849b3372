// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pybind11/pybind11.h>

#include <functional>
#include <optional>
#include <utility>

#include "frac/parallel_for.hpp"

namespace python {

/// Runs work in another thread without the interpreter's lock, while the calling thread watches for signals, some fifty
/// times a second, and calls report(done, total) unless that is None.  A Ctrl-C, or an exception of `report`, cancels
/// the work and is thrown once that has ended; so is what the work throws.  The other thread stays for some
/// hundredths of a second, for the next work.
void run(const std::function<void(frac::Progress&)>& work, const pybind11::object& report = pybind11::none());

/// The same for work with a result.
template <typename Work>
[[nodiscard]] auto result_of(const Work& work, const pybind11::object& report = pybind11::none()) {
  std::optional<decltype(work(std::declval<frac::Progress&>()))> result;
  run([&](frac::Progress& progress) { result.emplace(work(progress)); }, report);
  return std::move(*result);
}

/// For work of some hundredths of a second at most, which another thread would only make longer: runs it in the calling
/// one, without the interpreter's lock.
template <typename Work>
auto run_here(const Work& work) {
  const pybind11::gil_scoped_release without_lock;
  return work();
}

}  // namespace python
