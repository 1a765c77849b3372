// SPDX-License-Identifier: BSD-3-Clause
#include "frac/digital/arduino_library.hpp"

#include <cmath>
#include <stdexcept>
#include <string_view>

#include "base/number_text.hpp"
#include "c_text.hpp"
#include "runtime_text.hpp"

namespace frac {
namespace {

std::string sample_microseconds(double sample_time) {
  constexpr double most = 2000;
  const double microseconds = std::round(sample_time * 1e6);
  if (!(microseconds >= 1 && sample_time <= most)) {
    throw std::invalid_argument("arduino_library: sample_time = " + detail::number_text(sample_time) +
                                " s; allowed is 1e-6 to 2000 s, which a board counts in microseconds");
  }
  return std::to_string(static_cast<long>(microseconds)) + "UL";
}

std::vector<NamedText> library(std::string header, const CHeaderOptions& options, std::string_view sketch,
                               double sample_time, const std::string& what, const std::string& functions) {
  const std::string& name = options.name;
  const detail::CText c(options);
  // One line each; the comment says in its first line what is controlled or filtered.
  std::string sentence = options.comment.substr(0, options.comment.find('\n'));
  while (!sentence.empty() && (sentence.back() == ':' || sentence.back() == ' ')) sentence.pop_back();
  const std::string properties = "name=" + name + "\nversion=1.0.0\nauthor=fracfit\nmaintainer=fracfit\nsentence=" +
                                 (sentence.empty() ? what : sentence) + "\nparagraph=" + what +
                                 " as one C header: no heap, constant time per step.\ncategory=Signal Input/Output\n"
                                 "url=\narchitectures=*\nincludes=" +
                                 name + ".h\n";
  std::string keywords = name + "_state\tKEYWORD1\n";
  for (std::size_t at = 0; at < functions.size();) {
    const std::size_t end = functions.find(' ', at);
    keywords += name + "_" + functions.substr(at, end - at) + "\tKEYWORD2\n";
    at = end == std::string::npos ? functions.size() : end + 1;
  }
  return {{"library.properties", properties},
          {"keywords.txt", keywords},
          {"src/" + name + ".h", std::move(header)},
          {"examples/" + name + "_example/" + name + "_example.ino",
           c.filled(sketch, {{"SAMPLE_MICROSECONDS", sample_microseconds(sample_time)}}, {})}};
}

}  // namespace

std::vector<NamedText> arduino_library(const FractionalPidDesign& design, const CHeaderOptions& options) {
  return library(c_header(design, options), options, detail::runtime::arduino_pid, design.config().sample_time,
                 "A fractional PID controller", "init reset reset_at step track");
}

std::vector<NamedText> arduino_library(const DigitalFilterDesign& design, const CHeaderOptions& options) {
  return library(c_header(design, options), options, detail::runtime::arduino_filter, design.sample_time,
                 "A fractional-order filter", "init reset step");
}

}  // namespace frac
