// SPDX-License-Identifier: BSD-3-Clause
#include "io/column_name.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <numbers>
#include <optional>
#include <utility>

#include "io/data_error.hpp"
#include "io/instrument_name.hpp"

namespace io {
namespace {

std::string lowered(std::string_view text) {
  std::string result(text);
  std::transform(result.begin(), result.end(), result.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return result;
}

bool is_gap(char c) {
  return c == ' ' || c == '_' || c == '\t';
}

std::string_view without_gaps(std::string_view text) {
  while (!text.empty() && is_gap(text.front())) text.remove_prefix(1);
  while (!text.empty() && is_gap(text.back())) text.remove_suffix(1);
  return text;
}

struct SplitName {
  std::string base;  // lower case, words joined by '_'
  std::string unit;  // as written
};

SplitName normalised(std::string_view base, std::string_view unit) {
  std::string name = lowered(without_gaps(base));
  std::replace_if(name.begin(), name.end(), is_gap, '_');
  return {name, std::string(without_gaps(unit))};
}

char closing(char bracket) {
  return bracket == '(' ? ')' : bracket == '[' ? ']' : '}';
}

// A unit in brackets, or after a free-standing slash as in "f / Hz".  Of two brackets, "Re[FRF] (m/N)", the first says
// whose part it is.
std::optional<SplitName> split_at_mark(std::string_view name) {
  const auto open = name.find_first_of("[({");
  if (open != std::string_view::npos) {
    const auto first_close = name.find_first_of("])}", open);
    const auto second = name.find_first_of("[({", std::min(first_close, name.size()));
    if (second != std::string_view::npos && without_gaps(name).ends_with(closing(name[second])))
      return normalised(name.substr(0, open), name.substr(second + 1, name.find_last_of("])}") - second - 1));
    const auto close = name.find_last_of("])}");
    const auto length = close == std::string_view::npos || close < open ? std::string_view::npos : close - open - 1;
    return normalised(name.substr(0, open), name.substr(open + 1, length));
  }
  const auto slash = name.find(" / ");
  if (slash != std::string_view::npos) return normalised(name.substr(0, slash), name.substr(slash + 3));
  return std::nullopt;
}

struct Base {
  std::string_view name;
  Quantity quantity;
  bool angular = false;  // a frequency that is angular by its name
};

// A name stands before every name that it begins with, because the first match is taken.
constexpr std::array<Base, 34> bases{{{"angular_frequency", Quantity::frequency, true},
                                      {"ang_freq", Quantity::frequency, true},
                                      {"omega", Quantity::frequency, true},
                                      {"w", Quantity::frequency, true},
                                      {"frequency", Quantity::frequency},
                                      {"freq", Quantity::frequency},
                                      {"f", Quantity::frequency},
                                      {"real_part", Quantity::real},
                                      {"real", Quantity::real},
                                      {"re", Quantity::real},
                                      {"imaginary_part", Quantity::imaginary},
                                      {"imag_part", Quantity::imaginary},
                                      {"imaginary", Quantity::imaginary},
                                      {"imag", Quantity::imaginary},
                                      {"im", Quantity::imaginary},
                                      {"-imaginary_part", Quantity::negative_imaginary},
                                      {"-imag_part", Quantity::negative_imaginary},
                                      {"-imaginary", Quantity::negative_imaginary},
                                      {"-imag", Quantity::negative_imaginary},
                                      {"-im", Quantity::negative_imaginary},
                                      {"magnitude", Quantity::magnitude},
                                      {"mag", Quantity::magnitude},
                                      {"abs", Quantity::magnitude},
                                      {"gain", Quantity::magnitude},
                                      {"modulus", Quantity::magnitude},
                                      {"phase", Quantity::phase},
                                      {"arg", Quantity::phase},
                                      {"angle", Quantity::phase},
                                      {"standard_deviation", Quantity::sigma},
                                      {"uncertainty", Quantity::other},
                                      {"sigma", Quantity::sigma},
                                      {"std", Quantity::sigma},
                                      {"weights", Quantity::weight},
                                      {"weight", Quantity::weight}}};

// "re_std" is no real part in the unit "std".
bool is_statistic(std::string_view unit) {
  constexpr std::array<std::string_view, 9> words{"sigma", "std",       "err",   "error", "uncertainty",
                                                  "stdev", "deviation", "lower", "upper"};
  return std::find(words.begin(), words.end(), unit) != words.end();
}

struct NamedBase {
  Base base;
  std::string unit;
};

std::optional<NamedBase> find_base(std::string_view name) {
  if (const auto split = split_at_mark(name)) {
    for (const auto& base : bases)
      if (split->base == base.name) return NamedBase{base, split->unit};
    return std::nullopt;
  }
  // "re/ohm"; in "re_m/N" the slash belongs to the unit.
  if (const auto slash = name.find('/'); slash != std::string_view::npos) {
    const auto [before, unit] = normalised(name.substr(0, slash), name.substr(slash + 1));
    for (const auto& base : bases)
      if (before == base.name) return NamedBase{base, unit};
  }
  const auto [joined, unused] = normalised(name, {});
  for (const auto& base : bases) {
    if (joined == base.name) return NamedBase{base, {}};
    if (joined.size() <= base.name.size() || !joined.starts_with(base.name) || joined[base.name.size()] != '_')
      continue;
    const auto unit = without_gaps(without_gaps(name).substr(base.name.size()));
    if (base.quantity == Quantity::magnitude && lowered(unit) == "linear") return NamedBase{base, {}};
    if (!is_statistic(lowered(unit))) return NamedBase{base, std::string(unit)};
  }
  return std::nullopt;
}

// Lower case, with "per", blanks, underscores and exponents written alike: "rad_per_s", "rad s^-1", "rad/sec" ->
// "rad/s".
std::string canonical_rate(std::string_view unit) {
  std::string text = lowered(unit);
  for (const auto& [from, to] : std::initializer_list<std::pair<std::string_view, std::string_view>>{
           {"_per_", "/"}, {" per ", "/"}, {"second", "s"}, {"sec", "s"}, {"s^-1", "/s"}, {"s-1", "/s"}}) {
    const auto at = text.find(from);
    if (at != std::string::npos) text.replace(at, from.size(), to);
  }
  std::erase_if(text, [](char c) { return c == ' ' || c == '_' || c == '*' || c == '.' || c == '/'; });
  return text;
}

std::optional<double> hertz_factor(std::string_view unit) {
  constexpr double turn = 2 * std::numbers::pi;
  if (unit == "mHz") return 1e-3 * turn;
  if (unit == "MHz") return 1e6 * turn;
  const std::string lower = lowered(unit);
  if (lower == "hz") return turn;
  if (lower == "khz") return 1e3 * turn;
  if (lower == "ghz") return 1e9 * turn;
  return std::nullopt;
}

std::optional<double> radian_rate_factor(std::string_view unit) {
  const std::string rate = canonical_rate(unit);
  if (rate == "rads" || rate == "radps") return 1;
  if (rate == "krads" || rate == "kradps") return 1e3;
  return std::nullopt;
}

void read_frequency_unit(bool angular, ColumnMeaning& meaning) {
  const auto hertz = angular ? std::nullopt : hertz_factor(meaning.unit);
  const auto rate = radian_rate_factor(meaning.unit);
  if (hertz) {
    meaning.factor = *hertz;
    meaning.in_hertz = true;
  } else if (rate) {
    meaning.factor = *rate;
  } else if (angular) {
    if (!meaning.unit.empty())
      meaning.problem = "unknown unit " + quoted(meaning.unit) + " of an angular frequency; expected rad/s or krad/s";
  } else if (meaning.unit.empty()) {
    meaning.problem =
        "the frequency has no unit; expected one in the name, such as f_Hz or omega_rad_s, or by --frequency-unit";
  } else if (lowered(meaning.unit) == "mhz") {
    meaning.problem = "the unit " + quoted(meaning.unit) + " can mean milli or mega; expected mHz or MHz";
  } else {
    meaning.problem =
        "unknown unit " + quoted(meaning.unit) + " of a frequency; expected Hz, kHz, MHz, GHz, mHz or rad/s";
  }
}

void read_phase_unit(ColumnMeaning& meaning) {
  const std::string unit = lowered(meaning.unit);
  if (unit == "deg" || unit == "degree" || unit == "degrees" || unit == "\xC2\xB0") {
    meaning.factor *= std::numbers::pi / 180;
  } else if (unit != "rad" && unit != "radian" && unit != "radians") {
    meaning.problem = meaning.unit.empty()
                          ? "the phase has no unit; expected one in the name: phase_deg or phase_rad"
                          : "unknown unit " + quoted(meaning.unit) + " of a phase; expected deg or rad";
  }
}

// Of "dB" and "dB re 1 m/N" the values have the unit of what they are relative to.
void read_magnitude_unit(ColumnMeaning& meaning) {
  const std::string unit = lowered(meaning.unit);
  if (unit != "db" && !unit.starts_with("db re ") && !unit.starts_with("db rel ")) return;
  meaning.quantity = Quantity::magnitude_db;
  std::string_view reference = meaning.unit;
  const auto drop_word = [&reference] {
    reference.remove_prefix(std::min(reference.find(' '), reference.size()));
    reference = without_gaps(reference);
  };
  drop_word();
  if (!reference.empty()) drop_word();
  const std::string_view number = reference.substr(0, reference.find_first_not_of("0123456789.,"));
  if (!number.empty() && number != "1")
    meaning.problem =
        "the decibels are relative to " + quoted(reference) + "; expected 1 of a unit, such as dB re 1 m/N";
  reference.remove_prefix(number.size());
  meaning.unit = std::string(without_gaps(reference));
}

// Units that may stand behind a name without a mark: "FreqHz", "Z' Ohm".  One stands before those it ends with.
constexpr std::array<std::string_view, 6> units_of_frequency{"rad/s", "rad_s", "khz", "mhz", "ghz", "hz"};
constexpr std::array<std::string_view, 4> units_of_phase{"degrees", "deg", "\xC2\xB0", "rad"};
constexpr std::array<std::string_view, 12> units_of_values{"kohm", "mohm", "ohms", "ohm", "\xCE\xA9", "\xE2\x84\xA6",
                                                           "kpa",  "mpa",  "gpa",  "pa",  "db",       "_s"};

// "FreqHz" -> "Freq" and "Hz", where what remains is a name and the unit is one of its kind.
std::optional<SplitName> split_before_unit(std::string_view name) {
  const std::string lower = lowered(name);
  const auto split_at = [&](const auto& units, const auto& fits) -> std::optional<SplitName> {
    for (const std::string_view unit : units) {
      if (!std::string_view(lower).ends_with(unit)) continue;
      const auto base = without_gaps(name.substr(0, name.size() - unit.size()));
      const ColumnMeaning meaning = base.empty() ? ColumnMeaning{Quantity::other, 1, {}, {}} : column_meaning(base);
      if (meaning.unit.empty() && fits(meaning.quantity))
        return SplitName{std::string(base), std::string(without_gaps(name.substr(name.size() - unit.size())))};
    }
    return std::nullopt;
  };
  if (auto split = split_at(units_of_frequency, [](Quantity what) { return what == Quantity::frequency; }))
    return split;
  if (auto split = split_at(units_of_phase, [](Quantity what) { return what == Quantity::phase; })) return split;
  const auto is_value = [](Quantity what) {
    return what == Quantity::real || what == Quantity::imaginary || what == Quantity::negative_imaginary ||
           what == Quantity::magnitude;
  };
  if (auto split = split_at(units_of_values, is_value)) return split;
  // "z_real_mohm_cm2", "loss_mpa": what stands behind a gap is written as a unit is.
  if (name.find_first_of("[(") != std::string_view::npos) return std::nullopt;
  for (auto gap = name.find_last_of(" _"); gap != std::string_view::npos && gap > 0;
       gap = name.find_last_of(" _", gap - 1)) {
    const std::string before(name.substr(0, gap)), unit(name.substr(gap + 1));
    if (!is_unit_of_material(unit)) continue;
    const ColumnMeaning meaning = column_meaning(before + " [" + unit + "]");
    if (is_value(meaning.quantity) && !meaning.symbol.empty()) return SplitName{before, unit};
  }
  return std::nullopt;
}

// "Data: Z'", "TR2: Gain", "Trace 1 Re", "Test Frequency": what stands before a colon, or a first word with a number,
// says how a value came about.
std::optional<std::string_view> behind_a_word_of_measurement(std::string_view name) {
  if (const auto colon = name.find(": "); colon != std::string_view::npos) return name.substr(colon + 2);
  for (const std::string_view word : {"data", "trace", "channel", "measured", "test", "signal", "ac", "shear"}) {
    if (lowered(name.substr(0, word.size())) != word) continue;
    const auto rest = name.substr(word.size());
    const auto end = rest.find_first_not_of(" _.0123456789");
    if (end != 0 && end != std::string_view::npos) return rest.substr(end);
  }
  return std::nullopt;
}

}  // namespace

ColumnMeaning column_meaning(std::string_view name) {
  // "Frequenz in Hz", "Frequenz, Hz", where what stands before the word has a meaning.
  for (const std::string_view word : {" in ", ", "}) {
    const auto at = name.find(word);
    if (at == std::string_view::npos || name.find_first_of("[(") != std::string_view::npos) continue;
    ColumnMeaning meaning =
        column_meaning(std::string(name.substr(0, at)) + " [" + std::string(name.substr(at + word.size())) + "]");
    if (meaning.quantity != Quantity::other) return meaning;
  }
  ColumnMeaning meaning{Quantity::other, 1, {}, {}};
  bool angular = false;
  if (auto of_instrument = instrument_column(name)) {
    meaning = *std::move(of_instrument);
    angular = meaning.symbol == "w";
    if (meaning.quantity == Quantity::phase && meaning.unit.empty()) {
      meaning.unit = "deg";
      meaning.assumption = "column " + quoted(name) + " has no unit and is taken as degrees";
    }
  } else if (const auto found = find_base(name)) {
    meaning.quantity = found->base.quantity;
    meaning.unit = found->unit;
    angular = found->base.angular;
  } else if (const auto split = split_before_unit(name)) {
    return column_meaning(split->base + " [" + split->unit + "]");
  } else if (const auto bare = behind_a_word_of_measurement(name)) {
    return column_meaning(*bare);
  }
  if (meaning.quantity == Quantity::frequency) read_frequency_unit(angular, meaning);
  if (meaning.quantity == Quantity::phase) read_phase_unit(meaning);
  if (meaning.quantity == Quantity::magnitude) read_magnitude_unit(meaning);
  return meaning;
}

bool names_standard_deviation(std::string_view name) {
  const auto found = find_base(name);
  return found && (found->base.quantity == Quantity::sigma || found->base.name == "uncertainty");
}

}  // namespace io
