// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "frac/structure.hpp"

struct fracfit_model {
  frac::Structure structure;
};
