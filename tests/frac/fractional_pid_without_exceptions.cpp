// SPDX-License-Identifier: BSD-3-Clause
// Built with -fno-exceptions -fno-rtti, as firmware often is: the headers compile, and errors arrive as sentences.
#include <cstdio>
#include <optional>
#include <string>

#include "frac/digital/c_header.hpp"
#include "frac/digital/fractional_pid.hpp"

int main() {
  frac::FractionalPidConfig config;
  config.gains = {.kp = 2, .ki = 3, .kd = 0, .lambda = 0.8, .mu = 1};
  config.sample_time = 1e-3;
  std::string why;
  if (frac::FractionalPid<float>::try_make(config, why) || why.find("band = 0 to 0 rad/s") == std::string::npos) {
    std::printf("a controller without a band: \"%s\"\n", why.c_str());
    return 1;
  }
  config.band = {0.1, 300};
  std::optional<frac::FractionalPid<float>> pid = frac::FractionalPid<float>::try_make(config, why);
  if (!pid) {
    std::printf("%s\n", why.c_str());
    return 1;
  }
  float y = 0;
  for (int n = 0; n < 20000; ++n) y += 1e-3F * (pid->step(1, y) - y);
  std::printf("%g\n", static_cast<double>(y));
  return y > 0.9F && y < 1.1F ? 0 : 1;
}
