// SPDX-License-Identifier: BSD-3-Clause
#include "options/drive_options.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <vector>

#include "io/data_error.hpp"
#include "io/number.hpp"

namespace fracfit {
namespace {

/// What stands for an option of two masses: times the ratio of the gear to that power, and what the unit is in SI.
struct DriveWord {
  const char* name;
  const char* replaces;
  int power;
  double unit;
};
constexpr double degree = std::numbers::pi / 180;
constexpr DriveWord words[] = {
    {"--inertia1", "--mass1", 0, 1},
    {"--inertia2", "--mass2", 2, 1},
    {"--torque", "--force", 1, 1},
    {"--torque-limit", "--force-limit", 1, 1},
    {"--gap-degrees", "--clearance", 0, degree},
    {"--friction-torque1", "--friction1", 0, 1},
    {"--friction-torque2", "--friction2", 1, 1},
    {"--load-torque", "--disturbance1", 0, 1},
    {"--step-degrees", "--setpoint-step", 0, degree},
};
constexpr const char* ratio_word = "--gear-ratio";

bool is_declared(const Options& options, std::string_view name) {
  for (const Option& option : options.all())
    if (option.name() == name) return true;
  return false;
}

// A number, a list or a grid FROM:TO:COUNT, whose last part is no number of that unit.
std::string scaled(const DriveWord& word, const std::string& text, double factor) {
  const char separator = text.find(':') == std::string::npos ? ',' : ':';
  std::string result;
  int part = 0;
  for (std::size_t begin = 0; begin <= text.size(); ++part) {
    const std::size_t end = std::min(text.find(separator, begin), text.size());
    const std::string piece = text.substr(begin, end - begin);
    const auto value = io::parse_number(piece);
    if (part > 0) result += separator;
    constexpr int count = 2;
    if (separator == ':' && part == count) {
      result += piece;
    } else {
      if (!value || !std::isfinite(*value))
        throw std::invalid_argument(std::string(word.name) + " " + io::quoted(text) + ": expected finite numbers");
      result += io::format_number(*value * factor);
    }
    begin = end + 1;
  }
  return factor == 1 ? text : result;
}

void convert_controller(Options& options, double ratio) {
  if (ratio == 1 || !is_declared(options, "--controller") || !options["--controller"].is_given()) return;
  Option& option = options["--controller"];
  const std::string text = option.given.back();
  const Option& body = options["--body"];
  const bool is_of_motor = !body.given.empty() && body.given.back() == "x2";
  const std::string factor = io::format_number(is_of_motor ? ratio * ratio : ratio);
  auto cascade = Cascade::of("--controller", text);
  if (cascade) cascade->speed_gain = factor + " (" + cascade->speed_gain + ")";
  option.given.back() = cascade ? cascade->text() : factor + " (" + text + ")";
  option.say(text);
}

}  // namespace

void add_drive_words(Options& options, std::string& texts) {
  if (!is_declared(options, "--mass1")) return;
  for (const DriveWord& word : words)
    if (is_declared(options, word.replaces)) options.text(word.name, texts);
  options.text(ratio_word, texts).default_is("1");
}

std::string convert_drive_words(Options& options) {
  if (!is_declared(options, ratio_word)) return {};
  double ratio = 1;
  const Option& gear = options[ratio_word];
  if (gear.is_given()) {
    ratio = number_of(ratio_word, gear.given.back());
    if (!(ratio > 0))
      throw std::invalid_argument(std::string(ratio_word) + " " + gear.given.back() + ": allowed is above 0");
  }
  bool is_drive = false;
  for (const DriveWord& word : words) {
    if (!is_declared(options, word.name) || !options[word.name].is_given()) continue;
    is_drive = true;
    const double factor = std::pow(ratio, word.power) * word.unit;
    Option& replaced = options[word.replaces];
    if (replaced.is_given())
      throw std::invalid_argument("give either " + replaced.name() + " or " + word.name + ", not both");
    replaced.given = {scaled(word, options[word.name].given.back(), factor)};
    replaced.unsaid();
  }
  if (gear.is_given() && !is_drive)
    throw std::invalid_argument(std::string(ratio_word) +
                                " has no meaning without a word of a drive such as --inertia2 or --torque");
  if (!is_drive) return {};
  convert_controller(options, ratio);
  return "a drive seen from the shaft of its load: read m as rad, N as N m and kg as kg m^2" +
         (ratio == 1 ? std::string()
                     : "; x2 is the angle of the motor over " + io::format_number(ratio) +
                           ", a force the torque of the motor times that");
}

std::string in_drive_words(const Options& options, const std::string& message) {
  std::string text = message;
  for (const DriveWord& word : words) {
    if (!is_declared(options, word.name) || !options[word.name].is_given()) continue;
    const std::string theirs = std::string(word.name) + " (as " + word.replaces + ")", ours = word.replaces;
    for (std::size_t at = 0; (at = text.find(ours, at)) != std::string::npos; at += theirs.size()) {
      const char next = at + ours.size() < text.size() ? text[at + ours.size()] : ' ';
      if (next == '-' || std::isalnum(static_cast<unsigned char>(next)) != 0) continue;
      text.replace(at, ours.size(), theirs);
    }
  }
  return text;
}

std::optional<Cascade> Cascade::of(std::string_view option, const std::string& text) {
  constexpr std::string_view head = "cascade(";
  const std::size_t at = text.find(head);
  if (at == std::string::npos) return std::nullopt;
  std::size_t end_of_words = head.size();
  for (int depth = 1; end_of_words < text.size() && depth > 0; ++end_of_words)
    depth += text[end_of_words] == '(' ? 1 : text[end_of_words] == ')' ? -1 : 0;
  if (at != 0 || end_of_words != text.size() || text.back() != ')')
    throw std::invalid_argument(std::string(option) + " " + io::quoted(text) +
                                ": a cascade stands alone, cascade(K1, K2, T); with a dead time L write its formula, "
                                "exp(-L s) (K1 + s) (K2 + K2/(T s)), which differs in what it makes of a set-point");
  std::vector<std::string> parts;
  const std::size_t close = text.size() - 1;
  for (std::size_t begin = head.size(); begin <= close;) {
    const std::size_t end = std::min(text.find(',', begin), close);
    parts.push_back(text.substr(begin, end - begin));
    begin = end + 1;
  }
  if (parts.size() != 2 && parts.size() != 3)
    throw std::invalid_argument(std::string(option) + " " + io::quoted(text) +
                                ": expected cascade(K1, K2, T) or cascade(K1, K2), a position controller K1 around a "
                                "speed controller K2 (1 + 1/(T s))");
  return Cascade{parts[0], parts[1], parts.size() == 3 ? parts[2] : std::string()};
}

std::string Cascade::formula() const {
  const std::string speed = "(" + speed_gain + ")";
  return "((" + position_gain + ") + s) " +
         (integral_time.empty() ? speed : "(" + speed + " + " + speed + "/((" + integral_time + ") s))");
}

std::string Cascade::text() const {
  return "cascade(" + position_gain + ", " + speed_gain + (integral_time.empty() ? "" : ", " + integral_time) + ")";
}

}  // namespace fracfit
