// SPDX-License-Identifier: BSD-3-Clause
// Step response of a fractional model at the instants one asks for, with its estimated error.
#include <cstdio>
#include <frac/model/fractional_transfer_function.hpp>
#include <frac/stability.hpp>
#include <frac/time_response/response_methods.hpp>
#include <vector>

int main() {
  const auto furnace = frac::FractionalTransferFunction::parse("1/(0.8 s^2.2 + 0.5 s^0.9 + 1)");
  std::puts(frac::analyse_stability(furnace).summary().c_str());

  const std::vector<double> time{1, 5, 20, 30};  // s
  const frac::TimeResponse response = frac::respond(furnace, frac::ResponseInput{}, time, 1e-12);
  std::puts("time_s,output");
  for (std::size_t n = 0; n < time.size(); ++n) std::printf("%g,%.12f\n", time[n], response.output[n]);
  std::puts(response.summary().c_str());
  return response.usable() ? 0 : 1;
}
