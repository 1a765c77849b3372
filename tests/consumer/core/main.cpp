// The furnace model, exactly and with each power of s realised by zeros and poles.
#include <frac/fractional_transfer_function.hpp>
#include <frac/oustaloup.hpp>
#include <iostream>

int main() {
  const auto furnace = frac::FractionalTransferFunction::parse("1/(0.8 s^2.2 + 0.5 s^0.9 + 1)");
  const frac::OustaloupRealisation realisation{.band = {1e-3, 1e3}, .poles = 12};
  for (const double omega : {0.1, 1.0, 10.0}) {  // rad/s
    std::cout << omega << "  " << furnace.response(omega) << "  " << furnace.response(omega, realisation) << '\n';
  }
  const frac::ZeroPoleGain half_derivative = frac::oustaloup(0.5, {1e-2, 1e2}, 4);
  for (const double pole : half_derivative.poles) std::cout << "s^0.5 has a pole at " << pole << " rad/s\n";
}
