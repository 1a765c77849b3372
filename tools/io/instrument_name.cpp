// SPDX-License-Identifier: BSD-3-Clause
#include "io/instrument_name.hpp"

#include <algorithm>
#include <array>
#include <utility>

namespace io {
namespace {

// Lower case without blanks, underscores, dots and stars; primes of all kinds as apostrophes.
std::string plain(std::string_view name) {
  constexpr std::array<std::pair<std::string_view, std::string_view>, 7> written{{{"\xE2\x80\xB2", "'"},
                                                                                  {"\xE2\x80\xB3", "''"},
                                                                                  {"\xE2\x80\x99", "'"},
                                                                                  {"\xE2\x80\x9D", "''"},
                                                                                  {"\xCE\xB5", "eps"},
                                                                                  {"\xCF\x89", "omega"},
                                                                                  {"\"", "''"}}};
  std::string text;
  for (std::size_t i = 0; i < name.size();) {
    const auto* const found = std::find_if(written.begin(), written.end(),
                                           [&](const auto& each) { return name.substr(i).starts_with(each.first); });
    if (found != written.end()) {
      text += found->second;
      i += found->first.size();
      continue;
    }
    const char c = name[i++];
    if (std::string_view(" \t_.*").find(c) != std::string_view::npos) continue;
    text += c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  }
  return text;
}

// "re(z)" -> "rez": brackets around a quantity belong to the name, those around a unit do not.
void open_brackets(std::string& name) {
  for (const std::string_view symbol : {"(z)", "(y)", "(g)", "(e)", "(eps)"}) {
    const auto at = name.find(symbol);
    if (at == std::string::npos || at == 0) continue;
    name.replace(at, symbol.size(), symbol.substr(1, symbol.size() - 2));
    return;
  }
}

struct Known {
  std::string_view name;
  Quantity quantity;
  std::string_view symbol = {};
  std::string_view needs_unit = {};  // means this only with a unit that begins so
};

constexpr std::array known{
    Known{"frequency", Quantity::frequency}, Known{"freq", Quantity::frequency}, Known{"f", Quantity::frequency},
    Known{"omega", Quantity::frequency, "w"}, Known{"w", Quantity::frequency, "w"},
    Known{"angularfrequency", Quantity::frequency, "w"}, Known{"angfrequency", Quantity::frequency, "w"},
    Known{"angfreq", Quantity::frequency, "w"}, Known{"zreal", Quantity::real, "z"}, Known{"zre", Quantity::real, "z"},
    Known{"rez", Quantity::real, "z"}, Known{"realz", Quantity::real, "z"}, Known{"z'", Quantity::real, "z"},
    Known{"zimag", Quantity::imaginary, "z"}, Known{"zim", Quantity::imaginary, "z"},
    Known{"imz", Quantity::imaginary, "z"}, Known{"imagz", Quantity::imaginary, "z"},
    Known{"z''", Quantity::imaginary, "z"}, Known{"|z|", Quantity::magnitude, "z"},
    Known{"zmod", Quantity::magnitude, "z"}, Known{"zmag", Quantity::magnitude, "z"},
    Known{"modz", Quantity::magnitude, "z"}, Known{"z", Quantity::magnitude, "z", "ohm"},
    Known{"zphz", Quantity::phase, "z"}, Known{"phasez", Quantity::phase, "z"}, Known{"zphase", Quantity::phase, "z"},
    Known{"theta", Quantity::phase}, Known{"phaseangle", Quantity::phase}, Known{"phase", Quantity::phase},
    Known{"yreal", Quantity::real, "y"}, Known{"rey", Quantity::real, "y"}, Known{"y'", Quantity::real, "y"},
    Known{"yimag", Quantity::imaginary, "y"}, Known{"imy", Quantity::imaginary, "y"},
    Known{"y''", Quantity::imaginary, "y"}, Known{"|y|", Quantity::magnitude, "y"},
    Known{"phasey", Quantity::phase, "y"}, Known{"g'", Quantity::real, "g"}, Known{"gstor", Quantity::real, "g"},
    Known{"gstorage", Quantity::real, "g"}, Known{"storagemodulus", Quantity::real, "g"},
    Known{"g''", Quantity::imaginary, "g"}, Known{"gloss", Quantity::imaginary, "g"},
    Known{"lossmodulus", Quantity::imaginary, "g"}, Known{"e'", Quantity::real, "e"},
    Known{"estor", Quantity::real, "e"}, Known{"estorage", Quantity::real, "e"}, Known{"e''", Quantity::imaginary, "e"},
    Known{"eloss", Quantity::imaginary, "e"},
    // The loss of a dielectric is counted positive: eps = eps' - i eps''.
    Known{"eps'", Quantity::real, "eps"}, Known{"epsilon'", Quantity::real, "eps"},
    Known{"eps''", Quantity::negative_imaginary, "eps"}, Known{"epsilon''", Quantity::negative_imaginary, "eps"},
    Known{"gprime", Quantity::real, "g"}, Known{"gdoubleprime", Quantity::imaginary, "g"},
    Known{"eprime", Quantity::real, "e"}, Known{"edoubleprime", Quantity::imaginary, "e"},
    // Resistance and reactance in series, as bridges write them.
    Known{"r", Quantity::real, "z", "ohm"}, Known{"x", Quantity::imaginary, "z", "ohm"},
    Known{"rs", Quantity::real, "z", "ohm"}, Known{"xs", Quantity::imaginary, "z", "ohm"},
    // Conductance and susceptance.
    Known{"g", Quantity::real, "y", "S"}, Known{"b", Quantity::imaginary, "y", "S"},
    // As programs write them in other languages.
    Known{"frequenz", Quantity::frequency}, Known{"messfrequenz", Quantity::frequency},
    Known{"kreisfrequenz", Quantity::frequency, "w"}, Known{"winkelfrequenz", Quantity::frequency, "w"},
    Known{"fr\xC3\xA9quence", Quantity::frequency}, Known{"pulsation", Quantity::frequency, "w"},
    Known{"frecuencia", Quantity::frequency}, Known{"frequenza", Quantity::frequency},
    Known{"realteil", Quantity::real}, Known{"imagin\xC3\xA4rteil", Quantity::imaginary},
    Known{"betrag", Quantity::magnitude}, Known{"phasenwinkel", Quantity::phase}, Known{"phasewinkel", Quantity::phase},
    Known{"speichermodul", Quantity::real, "g"}, Known{"verlustmodul", Quantity::imaginary, "g"},
    Known{"imaginaerteil", Quantity::imaginary}, Known{"partereal", Quantity::real},
    Known{"parteimaginaria", Quantity::imaginary}, Known{"partereale", Quantity::real},
    Known{"parteimmaginaria", Quantity::imaginary},
    Known{"partier\xC3\xA9"
          "elle",
          Quantity::real},
    Known{"partieimaginaire", Quantity::imaginary}, Known{"moduledeconservation", Quantity::real, "g"},
    Known{"moduledeperte", Quantity::imaginary, "g"}};

// Letters that ZView sets behind a name, no units.
bool is_letter_of_a_column(std::string_view unit) {
  return unit == "a" || unit == "b";
}

std::string unit_as_written(std::string_view name) {
  const auto open = name.find_last_of("([");
  const auto slash = name.find('/');
  std::string_view unit;
  // "Re(Z)/Ohm", but "omega (rad/s)" too.
  const bool is_within_brackets =
      open != std::string_view::npos && open < slash && (name.ends_with(')') || name.ends_with(']'));
  if (slash != std::string_view::npos && !is_within_brackets) {
    unit = name.substr(slash + 1);
  } else if (open != std::string_view::npos) {
    unit = name.substr(open + 1, name.find_last_of(")]") - open - 1);
  }
  while (unit.starts_with(' ')) unit.remove_prefix(1);
  while (unit.ends_with(' ')) unit.remove_suffix(1);
  const std::string lower = plain(unit);
  if (lower == "ohm" || lower == "ohms" || lower == "\xCE\xA9" || lower == "\xE2\x84\xA6") return "ohm";
  return std::string(unit);
}

}  // namespace

std::optional<ColumnMeaning> instrument_column(std::string_view name) {
  std::string text = plain(name);
  open_brackets(text);
  const std::string_view view = text;
  const auto end = std::min({view.find('/'), view.find('('), view.find('[')});
  std::string_view base = view.substr(0, end);
  const bool is_negative = base.starts_with('-');
  if (is_negative) base.remove_prefix(1);
  const bool has_mark = end < view.size();
  std::string unit = has_mark ? unit_as_written(name) : "";
  const bool is_lettered = has_mark && is_letter_of_a_column(plain(unit)) && view[end] == '(';
  if (is_lettered) unit.clear();
  const auto* const found = std::find_if(known.begin(), known.end(), [&](const Known& each) {
    return each.name == base && (each.needs_unit.empty() || unit.starts_with(each.needs_unit));
  });
  if (found == known.end()) return std::nullopt;
  // Names of the common kind are read by column_meaning(), unless a slash gives the unit, a dot shortens the name or it
  // is written in Greek.
  constexpr std::array<std::string_view, 9> common{"frequency",        "freq",         "f",       "omega", "w",
                                                   "angularfrequency", "angfrequency", "angfreq", "phase"};
  const bool is_common = std::find(common.begin(), common.end(), found->name) != common.end();
  const bool is_shortened = name.substr(0, name.find_first_of("/([")).find('.') != std::string_view::npos;
  const bool is_ascii = std::all_of(name.begin(), name.end(), [](char c) { return static_cast<signed char>(c) >= 0; });
  const bool is_told_by_unit = has_mark && (view[end] == '/' || is_shortened);
  if (is_common && is_ascii && !is_negative && !is_told_by_unit) return std::nullopt;
  Quantity quantity = found->quantity;
  double factor = 1;
  if (is_negative) {
    if (quantity == Quantity::imaginary)
      quantity = Quantity::negative_imaginary;
    else if (quantity == Quantity::negative_imaginary)
      quantity = Quantity::imaginary;
    else if (quantity == Quantity::phase)
      factor = -1;
    else
      return std::nullopt;
  }
  return ColumnMeaning{quantity, factor, std::move(unit), {}, std::string(found->symbol)};
}

bool is_frequency_unit(std::string_view unit) {
  const ColumnMeaning meaning = column_meaning("f[" + std::string(unit) + "]");
  return !unit.empty() && meaning.quantity == Quantity::frequency && meaning.problem.empty();
}

}  // namespace io
