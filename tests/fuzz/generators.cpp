// SPDX-License-Identifier: BSD-3-Clause
#include "generators.hpp"

#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <numbers>
#include <utility>

namespace fuzz {
namespace {

std::uint64_t number_in_environment(const char* name, std::uint64_t otherwise) {
  const char* const text = std::getenv(name);
  return text == nullptr ? otherwise : std::strtoull(text, nullptr, 10);
}

// With 17 digits, which read back as the same double.
std::string digits(double value) {
  std::array<char, 32> text;
  std::snprintf(text.data(), text.size(), "%.17g", value);
  return text.data();
}

std::string number(Random& random) {
  static const std::vector<std::string> odd{"0",     "1",  "1e308", "1e-308",   "5e-324",
                                            "1e999", ".5", "2.",    "00.1e+01", "1e"};
  if (random.below(8) == 0) return one_of(random, odd);
  return digits(random.log_uniform(1e-3, 1e3));
}

std::string atom(Random& random) {
  static const std::vector<std::string> names{"s", "s", "s", "K", "T1", "a", "R_2", "tau"};
  return random.below(3) == 0 ? number(random) : one_of(random, names);
}

}  // namespace

std::size_t cases(std::size_t usual) {
  return usual * static_cast<std::size_t>(number_in_environment("FRACFIT_FUZZ_FACTOR", 1));
}

std::uint64_t seed(std::uint64_t fixed) {
  return fixed + 1000 * number_in_environment("FRACFIT_FUZZ_SEED", 0);
}

std::string formula(Random& random, int depth) {
  if (depth == 0) return atom(random);
  const auto part = [&] { return formula(random, static_cast<int>(random.below(static_cast<std::size_t>(depth)))); };
  switch (random.below(9)) {
    case 0:
      return part() + " + " + part();
    case 1:
      return part() + "-" + part();
    case 2:
      return "(" + part() + ")*(" + part() + ")";
    case 3:
      return "(" + part() + ")/(" + part() + ")";
    case 4:
      return "(" + part() + ")^" + (random.below(2) == 0 ? number(random) : std::string("a"));
    case 5:
      return "s^" + (random.below(2) == 0 ? number(random) : std::string("(") + part() + ")");
    case 6: {
      static const std::vector<std::string> functions{"sqrt", "tanh", "coth", "exp"};
      return one_of(random, functions) + "(" + part() + ")";
    }
    case 7:
      return "exp(-" + number(random) + " s)" + part();
    default:
      return part() + " " + part();
  }
}

std::string damaged(Random& random, std::string text) {
  const std::size_t times = 1 + random.below(3);
  for (std::size_t i = 0; i < times && !text.empty(); ++i) {
    const std::size_t at = random.below(text.size());
    const std::size_t length = 1 + random.below(std::min<std::size_t>(text.size() - at, 40));
    switch (random.below(6)) {
      case 0:
        text[at] = static_cast<char>(random.below(256));
        break;
      case 1:
        text[at] = "0123456789,.\n#-+e \"\t;()^/*"[random.below(26)];
        break;
      case 2:
        text.erase(at, length);
        break;
      case 3:
        text.insert(at, text.substr(at, length));
        break;
      case 4:
        text.replace(at, length, std::string(length, '\0'));
        break;
      default:
        text.resize(at);
    }
  }
  return text;
}

std::string cut(Random& random, std::string text) {
  text.resize(random.below(text.size()));
  return text;
}

Table table(Random& random) {
  enum class Form { cartesian, negative_imaginary, polar, decibel };
  const Form form = std::array{Form::cartesian, Form::negative_imaginary, Form::polar, Form::decibel}[random.below(4)];
  const bool in_hertz = random.below(2) == 0;
  const bool in_degrees = random.below(2) == 0;
  const std::string separator = one_of(random, std::vector<std::string>{",", ";", "\t", " ", ", ", " ; "});
  const std::string line_end = random.below(3) == 0 ? "\r\n" : "\n";
  const bool has_other = random.below(2) == 0;

  Table result;
  std::string& text = result.text;
  if (random.below(4) == 0) text += "\xEF\xBB\xBF";
  for (std::size_t i = random.below(3); i > 0; --i) text += "# key: " + digits(random.unit()) + line_end;
  std::vector<std::string> names{in_hertz ? "f_Hz" : "omega_rad_s"};
  const std::string phase = in_degrees ? "phase_deg" : "phase_rad";
  if (form == Form::cartesian) names.insert(names.end(), {"re_ohm", "im_ohm"});
  if (form == Form::negative_imaginary) names.insert(names.end(), {"re", "-im"});
  if (form == Form::polar) names.insert(names.end(), {"magnitude", phase});
  if (form == Form::decibel) names.insert(names.end(), {"magnitude_db", phase});
  if (has_other) names.emplace_back("remark");
  const auto add_row = [&](const std::vector<std::string>& fields) {
    for (std::size_t i = 0; i < fields.size(); ++i) text += (i > 0 ? separator : "") + fields[i];
    text += line_end;
  };
  add_row(names);

  const std::size_t rows = 1 + random.below(12);
  double frequency = random.log_uniform(1e-6, 1e3);
  for (std::size_t i = 0; i < rows; ++i) {
    frequency *= 1 + random.unit();
    const double first = random.normal() * random.log_uniform(1e-6, 1e6);
    const double second = random.normal() * random.log_uniform(1e-6, 1e6);
    result.omega.push_back(in_hertz ? frequency * 2 * std::numbers::pi : frequency);
    std::vector<std::string> fields{digits(frequency)};
    if (form == Form::cartesian || form == Form::negative_imaginary) {
      result.value.emplace_back(first, form == Form::cartesian ? second : -second);
      fields.insert(fields.end(), {digits(first), digits(second)});
    } else {
      const double angle = random.uniform(-10, 10);
      const double level = random.uniform(-200, 200);
      const double modulus = form == Form::polar ? std::abs(first) : std::pow(10, level / 20);
      result.value.push_back(std::polar(modulus, angle));
      fields.insert(fields.end(), {digits(form == Form::polar ? modulus : level),
                                   digits(in_degrees ? angle * 180 / std::numbers::pi : angle)});
    }
    if (has_other) fields.emplace_back(separator == " " ? "x" : "\"some words\"");
    if (random.below(6) == 0) text += "# a remark" + line_end;
    if (random.below(6) == 0) text += line_end;
    add_row(fields);
  }
  return result;
}

}  // namespace fuzz
