// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <exception>
#include <limits>
#include <new>
#include <stdexcept>
#include <string>
#include <string_view>

#include "fracfit.h"

namespace c_interface {

/// Keeps the sentence for fracfit_error(); "" clears it.
void set_error(const char* sentence) noexcept;

/// What a caller has passed as NULL, by its name.
/// @throws std::invalid_argument
template <typename Handle>
Handle& given(Handle* handle, const char* name) {
  if (!handle) throw std::invalid_argument(std::string(name) + " is NULL");
  return *handle;
}

/// A text that a caller has passed.
/// @throws std::invalid_argument  it is NULL
inline std::string_view text(const char* value, const char* name) {
  return &given(value, name);
}

/// Calls what may throw on behalf of a C function.  What it throws becomes a status and the sentence of
/// fracfit_error().
template <typename Call>
int status_of(const Call& call) noexcept {
  try {
    set_error("");
    return call();
  } catch (const std::invalid_argument& error) {
    set_error(error.what());
    return FRACFIT_WRONG_USE;
  } catch (const std::domain_error& error) {
    set_error(error.what());
    return FRACFIT_WRONG_USE;
  } catch (const std::bad_alloc&) {
    set_error("out of memory");
  } catch (const std::exception& error) {
    set_error(error.what());
  } catch (...) {
    set_error("a fault of fracfit");
  }
  return FRACFIT_FAILED;
}

/// The same for functions that make a handle.
template <typename Handle, typename Call>
Handle* handle_of(const Call& call) noexcept {
  Handle* handle = nullptr;
  (void)status_of([&] {
    handle = call();
    return FRACFIT_OK;
  });
  return handle;
}

/// And for those that read a number.
template <typename Handle, typename Call>
double number_of(const Handle* handle, const char* name, const Call& call) noexcept {
  double number = std::numeric_limits<double>::quiet_NaN();
  (void)status_of([&] {
    number = call(given(handle, name));
    return FRACFIT_OK;
  });
  return number;
}

}  // namespace c_interface
