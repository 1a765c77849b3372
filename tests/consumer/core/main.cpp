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
}
