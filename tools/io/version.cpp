// SPDX-License-Identifier: BSD-3-Clause
#include "io/version.hpp"

namespace io {

std::string_view version() {
  return FRACFIT_VERSION;
}

}  // namespace io
