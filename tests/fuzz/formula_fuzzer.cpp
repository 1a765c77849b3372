// SPDX-License-Identifier: BSD-3-Clause
// libFuzzer: any bytes as a formula.
#include <cstddef>
#include <cstdint>
#include <string_view>
#include <vector>

#include "frac/model/fractional_transfer_function.hpp"
#include "frac/structure.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  try {
    const frac::Structure structure(text);
    const std::vector<double> parameters(structure.parameter_names().size(), 0.7);
    static_cast<void>(structure.response(parameters, 1.5));
    static_cast<void>(frac::FractionalTransferFunction::parse(text).formula());
  } catch (const std::invalid_argument&) {  // the documented exception
  }
  return 0;
}
