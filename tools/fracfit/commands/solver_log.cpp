// SPDX-License-Identifier: BSD-3-Clause
#include "commands/solver_log.hpp"

#include <glog/logging.h>

namespace fracfit {

void silence_solver_log() {
  FLAGS_minloglevel = google::GLOG_FATAL;
}

}  // namespace fracfit
