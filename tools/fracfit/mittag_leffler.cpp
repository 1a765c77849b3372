// SPDX-License-Identifier: BSD-3-Clause
#include "frac/mittag_leffler.hpp"

#include <CLI/CLI.hpp>
#include <cmath>
#include <complex>
#include <cstdio>
#include <memory>
#include <stdexcept>

#include "common_options.hpp"
#include "exit_code.hpp"
#include "io/data_error.hpp"
#include "io/number_list.hpp"
#include "subcommand.hpp"

namespace fracfit {
namespace {

struct MittagLefflerOptions {
  CommonOptions common;
  std::string alpha, beta = "1", z;
};

std::complex<double> complex_option(std::string_view name, const std::string& text) {
  const std::vector<double> parts = io::parse_list(text, name);
  if (parts.size() > 2)
    throw std::invalid_argument(std::string(name) + " " + io::quoted(text) + ": expected RE or RE,IM");
  return {parts[0], parts.size() == 2 ? parts[1] : 0};
}

int mittag_leffler(const MittagLefflerOptions& given) {
  const io::OutputFile file(given.common.out);
  const std::complex<double> value = frac::mittag_leffler(
      number_option("--alpha", given.alpha), number_option("--beta", given.beta), complex_option("--z", given.z));
  char text[64];
  std::snprintf(text, sizeof text, "%.17g,%.17g\n", value.real(), value.imag());
  file.write(text);
  if (std::isfinite(value.real()) && std::isfinite(value.imag())) return usable_result;
  say(given.common, "the value is beyond the range of a double");
  return no_usable_result;
}

}  // namespace

void add_mittag_leffler(CLI::App& program, Run& run) {
  const auto given = std::make_shared<MittagLefflerOptions>();
  auto* function = program.add_subcommand("mittag-leffler", "Mittag-Leffler function E_{alpha,beta}(z), as re,im");
  function->add_option("--alpha", given->alpha, "First order, above 0 to 100")->required()->type_name("ALPHA");
  function->add_option("--beta", given->beta, "Second order, -50 to 50")->capture_default_str()->type_name("BETA");
  function->add_option("--z", given->z, "Argument, real or complex")->required()->type_name("RE[,IM]");
  function->add_option("--out", given->common.out, "Output file; standard output if not given")
      ->type_name("FILE")
      ->check(not_empty());
  add_common_options(*function, given->common, {});
  function->footer(
      "Examples:\n"
      "  fracfit mittag-leffler --alpha 0.5 --z -3\n"
      "  fracfit mittag-leffler --alpha 1.5 --beta 2 --z 0.5,-1.25");
  function->callback([given, &run] { run = [given] { return mittag_leffler(*given); }; });
}

}  // namespace fracfit
