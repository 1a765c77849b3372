// SPDX-License-Identifier: BSD-3-Clause
#include "frac/mittag_leffler.hpp"

#include <cmath>
#include <cstdio>

#include "commands/subcommand.hpp"
#include "output/json.hpp"

namespace fracfit {
namespace {

class MittagLeffler : public Command {
 public:
  MittagLeffler()
      : Command("mittag-leffler", "Mittag-Leffler function E_{alpha,beta}(z) or E^gamma_{alpha,beta}(z), as re,im") {
    Options& o = options();
    o.number("--alpha", alpha_, "First order, above 0 to 100", "ALPHA").required();
    o.number("--beta", beta_, "Second order, -50 to 50", "BETA");
    o.number("--gamma", gamma_, "Third parameter (Prabhakar), above 0 to 100; other than 1 with --alpha up to 2",
             "GAMMA");
    o.parsed("--z", z_, complex_of, "Argument, real or complex", "RE[,IM]").required();
    add_common({"csv", "json"});
    set_footer(
        "Examples:\n"
        "  fracfit mittag-leffler --alpha 0.5 --z -3\n"
        "  fracfit mittag-leffler --alpha 1.5 --beta 2 --z 0.5,-1.25\n"
        "  fracfit mittag-leffler --alpha 0.8 --beta 0.8 --gamma 0.5 --z -2");
  }

 private:
  int run() override {
    const std::complex<double> value =
        gamma_ == 1 ? frac::mittag_leffler(alpha_, beta_, z_) : frac::prabhakar(alpha_, beta_, gamma_, z_);
    if (format() == "json") {
      Json json = origin(command_line());
      json["re"] = value.real();
      json["im"] = value.imag();
      write(json.dump() + "\n");
    } else {
      char text[64];
      std::snprintf(text, sizeof text, "%.17g,%.17g\n", value.real(), value.imag());
      write(text);
    }
    if (std::isfinite(value.real()) && std::isfinite(value.imag())) return usable_result;
    say("the value is beyond the range of a double");
    return no_usable_result;
  }

  double alpha_ = NAN, beta_ = 1, gamma_ = 1;
  std::complex<double> z_;
};

}  // namespace

std::unique_ptr<Command> make_mittag_leffler() {
  return std::make_unique<MittagLeffler>();
}

}  // namespace fracfit
