// SPDX-License-Identifier: BSD-3-Clause
#include "io/instrument_name.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include "io/data_error.hpp"

namespace io {
namespace {

// Lower case without blanks, underscores, dots and stars; primes of all kinds as apostrophes.
std::string plain(std::string_view name) {
  constexpr std::array<std::pair<std::string_view, std::string_view>, 11> written{{{"\xE2\x80\xB2", "'"},
                                                                                   {"\xE2\x80\xB3", "''"},
                                                                                   {"\xE2\x80\x99", "'"},
                                                                                   {"\xE2\x80\x9D", "''"},
                                                                                   {"\xCE\xB5", "eps"},
                                                                                   {"\xCF\x89", "omega"},
                                                                                   {"\xCE\xB4", "delta"},
                                                                                   {"\xCE\xB8", "theta"},
                                                                                   {"\xCF\x86", "phi"},
                                                                                   {"\xCF\x95", "phi"},
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
    // Capital Cyrillic letters: D0 90 to D0 AF, the small ones 32 higher, whose second half begins with D1.
    const auto next = i < name.size() ? static_cast<unsigned char>(name[i]) : 0U;
    if (c == '\xD0' && next >= 0x90 && next < 0xB0) {
      text += next < 0xA0 ? '\xD0' : '\xD1';
      text += static_cast<char>(next < 0xA0 ? next + 0x20 : next - 0x20);
      ++i;
      continue;
    }
    text += c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  }
  return text;
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
    Known{"angfreq", Quantity::frequency, "w"}, Known{"theta-z", Quantity::phase, "z"},
    Known{"shearmoduluselasticcomponent", Quantity::real, "g"},
    Known{"shearmodulusviscouscomponent", Quantity::imaginary, "g"}, Known{"z", Quantity::magnitude, "z", "ohm"},
    Known{"theta", Quantity::phase}, Known{"phase", Quantity::phase}, Known{"g'", Quantity::real, "g"},
    Known{"gstor", Quantity::real, "g"}, Known{"gstorage", Quantity::real, "g"},
    Known{"storagemodulus", Quantity::real, "g"}, Known{"g''", Quantity::imaginary, "g"},
    Known{"gloss", Quantity::imaginary, "g"}, Known{"lossmodulus", Quantity::imaginary, "g"},
    Known{"e'", Quantity::real, "e"}, Known{"estor", Quantity::real, "e"}, Known{"estorage", Quantity::real, "e"},
    Known{"e''", Quantity::imaginary, "e"}, Known{"eloss", Quantity::imaginary, "e"},
    // The loss of a dielectric is counted positive: eps = eps' - i eps''.
    Known{"epsr'", Quantity::real, "eps"}, Known{"epsr''", Quantity::negative_imaginary, "eps"},
    Known{"eps'", Quantity::real, "eps"}, Known{"epsilon'", Quantity::real, "eps"},
    Known{"eps''", Quantity::negative_imaginary, "eps"}, Known{"epsilon''", Quantity::negative_imaginary, "eps"},
    Known{"gprime", Quantity::real, "g"}, Known{"gdoubleprime", Quantity::imaginary, "g"},
    Known{"eprime", Quantity::real, "e"}, Known{"edoubleprime", Quantity::imaginary, "e"},
    // Resistance and reactance in series, as bridges write them.
    Known{"r", Quantity::real, "z", "ohm"}, Known{"x", Quantity::imaginary, "z", "ohm"},
    Known{"rs", Quantity::real, "z", "ohm"}, Known{"xs", Quantity::imaginary, "z", "ohm"},
    Known{"resistance", Quantity::real, "z"}, Known{"reactance", Quantity::imaginary, "z"},
    Known{"zr", Quantity::real, "z"}, Known{"zi", Quantity::imaginary, "z"},
    Known{"impedance", Quantity::magnitude, "z", "ohm"}, Known{"imp", Quantity::magnitude, "z", "ohm"},
    // Sound pressure level, and the words of a modulus by themselves.
    Known{"spl", Quantity::magnitude, "", "dB"}, Known{"storage", Quantity::real, "g", "Pa"},
    Known{"loss", Quantity::imaginary, "g", "Pa"},
    // Conductance and susceptance.
    Known{"conductance", Quantity::real, "y", "S"}, Known{"susceptance", Quantity::imaginary, "y", "S"},
    Known{"g", Quantity::real, "y", "S"}, Known{"b", Quantity::imaginary, "y", "S"},
    // A transfer function.
    // Names in other languages.
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
    Known{"partieimaginaire", Quantity::imaginary},
    Known{"r\xC3\xA9"
          "el",
          Quantity::real},
    Known{"imaginaire", Quantity::imaginary}, Known{"imaginaria", Quantity::imaginary},
    Known{"moduledeconservation", Quantity::real, "g"}, Known{"moduledeperte", Quantity::imaginary, "g"},
    // Russian, Chinese, Japanese, Korean.
    Known{"\xD1\x87\xD0\xB0\xD1\x81\xD1\x82\xD0\xBE\xD1\x82\xD0\xB0", Quantity::frequency},
    Known{"\xD0\xBA\xD1\x80\xD1\x83\xD0\xB3\xD0\xBE\xD0\xB2\xD0\xB0\xD1\x8F\xD1\x87\xD0\xB0\xD1\x81\xD1\x82\xD0\xBE\xD1"
          "\x82\xD0\xB0",
          Quantity::frequency, "w"},
    Known{"\xD1\x83\xD0\xB3\xD0\xBB\xD0\xBE\xD0\xB2\xD0\xB0\xD1\x8F\xD1\x87\xD0\xB0\xD1\x81\xD1\x82\xD0\xBE\xD1\x82\xD0"
          "\xB0",
          Quantity::frequency, "w"},
    Known{"\xD1\x86\xD0\xB8\xD0\xBA\xD0\xBB\xD0\xB8\xD1\x87\xD0\xB5\xD1\x81\xD0\xBA\xD0\xB0\xD1\x8F\xD1\x87\xD0\xB0\xD1"
          "\x81\xD1\x82\xD0\xBE\xD1\x82\xD0\xB0",
          Quantity::frequency, "w"},
    Known{"\xD0\xB4\xD0\xB5\xD0\xB9\xD1\x81\xD1\x82\xD0\xB2\xD0\xB8\xD1\x82\xD0\xB5\xD0\xBB\xD1\x8C\xD0\xBD\xD0\xB0\xD1"
          "\x8F\xD1\x87\xD0\xB0\xD1\x81\xD1\x82\xD1\x8C",
          Quantity::real},
    Known{"\xD0\xB2\xD0\xB5\xD1\x89\xD0\xB5\xD1\x81\xD1\x82\xD0\xB2\xD0\xB5\xD0\xBD\xD0\xBD\xD0\xB0\xD1\x8F\xD1\x87\xD0"
          "\xB0\xD1\x81\xD1\x82\xD1\x8C",
          Quantity::real},
    Known{"\xD0\xBC\xD0\xBD\xD0\xB8\xD0\xBC\xD0\xB0\xD1\x8F\xD1\x87\xD0\xB0\xD1\x81\xD1\x82\xD1\x8C",
          Quantity::imaginary},
    Known{"\xD0\xBC\xD0\xBE\xD0\xB4\xD1\x83\xD0\xBB\xD1\x8C", Quantity::magnitude},
    Known{"\xD0\xB0\xD0\xBC\xD0\xBF\xD0\xBB\xD0\xB8\xD1\x82\xD1\x83\xD0\xB4\xD0\xB0", Quantity::magnitude},
    Known{"\xD1\x84\xD0\xB0\xD0\xB7\xD0\xB0", Quantity::phase},
    Known{"\xD0\xBC\xD0\xBE\xD0\xB4\xD1\x83\xD0\xBB\xD1\x8C\xD0\xBD\xD0\xB0\xD0\xBA\xD0\xBE\xD0\xBF\xD0\xBB\xD0\xB5\xD0"
          "\xBD\xD0\xB8\xD1\x8F",
          Quantity::real, "g"},
    Known{"\xD0\xBC\xD0\xBE\xD0\xB4\xD1\x83\xD0\xBB\xD1\x8C\xD0\xBF\xD0\xBE\xD1\x82\xD0\xB5\xD1\x80\xD1\x8C",
          Quantity::imaginary, "g"},
    Known{"\xE9\xA2\x91\xE7\x8E\x87", Quantity::frequency},
    Known{"\xE8\xA7\x92\xE9\xA2\x91\xE7\x8E\x87", Quantity::frequency, "w"},
    Known{"\xE5\xAE\x9E\xE9\x83\xA8", Quantity::real}, Known{"\xE8\x99\x9A\xE9\x83\xA8", Quantity::imaginary},
    Known{"\xE9\x98\xBB\xE6\x8A\x97\xE5\xAE\x9E\xE9\x83\xA8", Quantity::real, "z"},
    Known{"\xE9\x98\xBB\xE6\x8A\x97\xE8\x99\x9A\xE9\x83\xA8", Quantity::imaginary, "z"},
    Known{"z\xE5\xAE\x9E\xE9\x83\xA8", Quantity::real, "z"},
    Known{"z\xE8\x99\x9A\xE9\x83\xA8", Quantity::imaginary, "z"},
    Known{"\xE9\x98\xBB\xE6\x8A\x97", Quantity::magnitude, "z"},
    Known{"\xE9\x98\xBB\xE6\x8A\x97\xE6\xA8\xA1", Quantity::magnitude, "z"},
    Known{"\xE9\x98\xBB\xE6\x8A\x97\xE6\xA8\xA1\xE5\x80\xBC", Quantity::magnitude, "z"},
    Known{"\xE6\xA8\xA1\xE5\x80\xBC", Quantity::magnitude}, Known{"\xE5\xB9\x85\xE5\x80\xBC", Quantity::magnitude},
    Known{"\xE7\x9B\xB8\xE4\xBD\x8D", Quantity::phase}, Known{"\xE7\x9B\xB8\xE4\xBD\x8D\xE8\xA7\x92", Quantity::phase},
    Known{"\xE5\x82\xA8\xE8\x83\xBD\xE6\xA8\xA1\xE9\x87\x8F", Quantity::real, "g"},
    Known{"\xE6\x8D\x9F\xE8\x80\x97\xE6\xA8\xA1\xE9\x87\x8F", Quantity::imaginary, "g"},
    Known{"\xE5\x91\xA8\xE6\xB3\xA2\xE6\x95\xB0", Quantity::frequency},
    Known{"\xE8\xA7\x92\xE5\x91\xA8\xE6\xB3\xA2\xE6\x95\xB0", Quantity::frequency, "w"},
    Known{"\xE5\xAE\x9F\xE9\x83\xA8", Quantity::real},
    Known{"\xE8\x99\x9A\xE6\x95\xB0\xE9\x83\xA8", Quantity::imaginary},
    Known{"\xE5\xAE\x9F\xE6\x95\xB0\xE9\x83\xA8", Quantity::real}, Known{"\xE4\xBD\x8D\xE7\x9B\xB8", Quantity::phase},
    Known{"\xEC\xA3\xBC\xED\x8C\x8C\xEC\x88\x98", Quantity::frequency},
    Known{"\xEA\xB0\x81\xEC\xA3\xBC\xED\x8C\x8C\xEC\x88\x98", Quantity::frequency, "w"},
    Known{"\xEC\x8B\xA4\xEC\x88\x98\xEB\xB6\x80", Quantity::real},
    Known{"\xED\x97\x88\xEC\x88\x98\xEB\xB6\x80", Quantity::imaginary},
    Known{"\xEC\x9C\x84\xEC\x83\x81", Quantity::phase},
    // Moduli and permittivities.
    Known{"|g|", Quantity::magnitude, "g"}, Known{"complexmodulus", Quantity::magnitude, "g"},
    Known{"complexshearmodulus", Quantity::magnitude, "g"}, Known{"|e|", Quantity::magnitude, "e"},
    Known{"|eps|", Quantity::magnitude, "eps"}, Known{"delta", Quantity::phase, "", "deg"},
    Known{"delta", Quantity::phase, "", "rad"}, Known{"delta", Quantity::phase, "", "\xC2\xB0"},
    Known{"tandelta", Quantity::loss_tangent}, Known{"tand", Quantity::loss_tangent},
    Known{"losstangent", Quantity::loss_tangent}, Known{"lossfactor", Quantity::loss_tangent},
    Known{"verlustfaktor", Quantity::loss_tangent}};

// Words that names of values are made of.  A word is a part, says whose part it is, or both.
struct Word {
  std::string_view text;
  std::optional<Quantity> part = {};
  std::string_view symbol = {};
  bool is_unit = false;
};

constexpr std::array words{Word{"real", Quantity::real},
                           Word{"re", Quantity::real},
                           Word{"'", Quantity::real},
                           Word{"prime", Quantity::real},
                           Word{"imaginary", Quantity::imaginary},
                           Word{"imag", Quantity::imaginary},
                           Word{"img", Quantity::imaginary},
                           Word{"im", Quantity::imaginary},
                           Word{"''", Quantity::imaginary},
                           Word{"doubleprime", Quantity::imaginary},
                           Word{"|z|", Quantity::magnitude, "z"},
                           Word{"|y|", Quantity::magnitude, "y"},
                           Word{"magnitude", Quantity::magnitude},
                           Word{"mag", Quantity::magnitude},
                           Word{"modulus", Quantity::magnitude},
                           Word{"mod", Quantity::magnitude},
                           Word{"abs", Quantity::magnitude},
                           Word{"absolute", Quantity::magnitude},
                           Word{"amplituderatio", Quantity::magnitude},
                           Word{"phase", Quantity::phase},
                           Word{"phaseangle", Quantity::phase},
                           Word{"phaseshift", Quantity::phase},
                           Word{"theta", Quantity::phase},
                           Word{"phi", Quantity::phase},
                           Word{"phz", Quantity::phase},
                           Word{"ph", Quantity::phase},
                           Word{"arg", Quantity::phase},
                           Word{"impedance", {}, "z"},
                           Word{"imp", {}, "z"},
                           Word{"z", {}, "z"},
                           Word{"admittance", {}, "y"},
                           Word{"y", {}, "y"},
                           Word{"permittivity", {}, "eps"},
                           Word{"eps", {}, "eps"},
                           Word{"h"},
                           Word{"data"},
                           Word{"gain"},
                           Word{"transferfunction"},
                           Word{"response"},
                           Word{"frf"},
                           Word{"part"},
                           Word{"of"},
                           Word{":"},
                           Word{"ohms", {}, {}, true},
                           Word{"ohm", {}, {}, true}};

struct Words {
  std::optional<Quantity> part;
  std::string_view symbol;
  bool has_unit = false;
  int count = 0;
};

// Takes a name apart into words that agree: one part of one thing, a unit at the end.
std::optional<Words> words_of(std::string_view name, const Words& before = {}) {
  if (name.empty()) return before;
  for (const Word& word : words) {
    if (!name.starts_with(word.text) || before.has_unit || (before.part && word.part) ||
        (!before.symbol.empty() && !word.symbol.empty()))
      continue;
    Words taken = before;
    if (word.part) taken.part = word.part;
    if (!word.symbol.empty()) taken.symbol = word.symbol;
    taken.has_unit = word.is_unit;
    ++taken.count;
    if (auto whole = words_of(name.substr(word.text.size()), taken)) return whole;
  }
  return std::nullopt;
}

// "realimpedance", "z''", "zohm", "gain:magnitude", "phaseshift"; a single common word is left to column_meaning().
std::optional<Known> put_together(std::string_view name) {
  const auto of = words_of(name);
  if (!of) return std::nullopt;
  const bool is_compound = of->count > 1 || !of->symbol.empty() || name == "phaseangle" || name == "phaseshift" ||
                           name == "amplituderatio" || name == "phi";
  if (of->part && is_compound)
    return Known{name,
                 of->symbol == "eps" && *of->part == Quantity::imaginary ? Quantity::negative_imaginary : *of->part,
                 of->symbol};
  // Of an impedance by itself with its unit the magnitude is meant.
  if (!of->part && of->symbol == "z" && of->has_unit) return Known{name, Quantity::magnitude, "z"};
  return std::nullopt;
}

// "re(z)" -> "rez": brackets around a quantity belong to the name, those around a unit do not.
void open_brackets(std::string& name) {
  // "impedance(real)" too.
  if (const auto open = name.find('('); open != std::string::npos && open > 0 && name.ends_with(')')) {
    const auto inner = words_of(std::string_view(name).substr(open + 1, name.size() - open - 2));
    if (inner && inner->part) {
      name.erase(open, 1);
      name.pop_back();
      return;
    }
  }
  for (const std::string_view symbol : {"(z)", "(y)", "(g)", "(e)", "(eps)", "(delta)", "(elasticcomponent)",
                                        "(viscouscomponent)", "(complexcomponent)"}) {
    const auto at = name.find(symbol);
    if (at == std::string::npos || at == 0) continue;
    name.replace(at, symbol.size(), symbol.substr(1, symbol.size() - 2));
    return;
  }
}

// A unit of this kind in any case of letters, with or without a prefix of one letter such as k, m or u; an omega is an
// ohm.
bool is_unit_of(std::string_view unit, std::string_view needed) {
  if (needed != "ohm" && needed != "S" && needed != "Pa") return unit.starts_with(needed);
  const auto has = [&](std::string_view spelled) { return unit.find(spelled) <= std::string_view("\xC2\xB5").size(); };
  if (needed == "ohm") return has("ohm") || has("Ohm") || has("OHM") || has("\xCE\xA9");
  return needed == "Pa" ? has("Pa") || has("pa") || has("PA") : has("S");
}

// Letters that ZView sets behind a name, no units.
bool is_letter_of_a_column(std::string_view unit) {
  return unit == "a" || unit == "b";
}

// Units in other letters.
constexpr std::array words_of_units = std::to_array<std::pair<std::string_view, std::string_view>>(
    {{"\xD0\x9E\xD0\xBC", "ohm"},
     {"\xE6\xAC\xA7\xE5\xA7\x86", "ohm"},
     {"\xE6\xAC\xA7", "ohm"},
     {"\xE3\x82\xAA\xE3\x83\xBC\xE3\x83\xA0", "ohm"},
     {"\xEC\x98\xB4", "ohm"},
     {"\xD0\x93\xD1\x86", "Hz"},
     {"\xD0\xBA\xD0\x93\xD1\x86", "kHz"},
     {"\xD0\x9C\xD0\x93\xD1\x86", "MHz"},
     {"\xD0\xBC\xD0\x93\xD1\x86", "mHz"},
     {"\xD0\x93\xD0\x93\xD1\x86", "GHz"},
     {"\xE8\xB5\xAB\xE5\x85\xB9", "Hz"},
     {"\xE8\xB5\xAB", "Hz"},
     {"\xD1\x80\xD0\xB0\xD0\xB4/\xD1\x81", "rad/s"},
     {"\xE5\xBC\xA7\xE5\xBA\xA6/\xE7\xA7\x92", "rad/s"},
     {"\xD0\xB3\xD1\x80\xD0\xB0\xD0\xB4", "deg"},
     {"\xD0\xB3\xD1\x80\xD0\xB0\xD0\xB4\xD1\x83\xD1\x81\xD1\x8B", "deg"},
     {"\xE5\xBA\xA6", "deg"},
     {"\xD1\x80\xD0\xB0\xD0\xB4", "rad"},
     {"\xE5\xBC\xA7\xE5\xBA\xA6", "rad"},
     {"\xD0\x9F\xD0\xB0", "Pa"},
     {"\xD0\xBA\xD0\x9F\xD0\xB0", "kPa"},
     {"\xD0\x9C\xD0\x9F\xD0\xB0", "MPa"},
     {"\xE5\xB8\x95", "Pa"}});

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
  const auto* const word =
      std::find_if(words_of_units.begin(), words_of_units.end(), [&](const auto& each) { return each.first == unit; });
  return std::string(word != words_of_units.end() ? word->second : unit);
}

// Brackets of the width of a Chinese character are brackets too.
std::string with_narrow_brackets(std::string_view name) {
  std::string text(name);
  for (const auto& [wide, narrow] : {std::pair{"\xEF\xBC\x88", "("}, {"\xEF\xBC\x89", ")"}}) {
    const std::string_view bracket = wide;
    for (auto at = text.find(bracket); at != std::string::npos; at = text.find(bracket, at))
      text.replace(at, bracket.size(), narrow);
  }
  return text;
}

}  // namespace

std::optional<ColumnMeaning> instrument_column(std::string_view written) {
  const std::string narrow = with_narrow_brackets(written);
  const std::string_view name = narrow;
  std::string text = plain(name);
  open_brackets(text);
  const std::string_view view = text;
  const auto end = std::min({view.find('/'), view.find('('), view.find('[')});
  std::string_view base = view.substr(0, end);
  bool is_negative = false;
  for (const std::string_view sign : {"-", "neg", "negative", "minus"})
    if (base.starts_with(sign) && base.size() > sign.size()) {
      const std::string_view rest = base.substr(sign.size());
      if (sign != "-" && !words_of(rest)) continue;
      is_negative = true;
      base = rest;
      break;
    }
  const bool has_mark = end < view.size();
  std::string unit = has_mark ? unit_as_written(name) : "";
  const bool is_lettered = has_mark && is_letter_of_a_column(plain(unit)) && view[end] == '(';
  if (is_lettered) unit.clear();
  const auto* const listed = std::find_if(known.begin(), known.end(), [&](const Known& each) {
    return each.name == base && (each.needs_unit.empty() || is_unit_of(unit, each.needs_unit));
  });
  const std::optional<Known> found = listed == known.end() ? put_together(base) : std::optional(*listed);
  if (!found) return std::nullopt;
  if (unit.empty() && listed == known.end() && (base.ends_with("ohm") || base.ends_with("ohms"))) unit = "ohm";
  // A small letter without a unit of pressure stands for epsilon; of E' and E'' the modulus is written.
  if (!is_negative && found->symbol == "e" && name.find('e') < name.find('\'') && !unit.ends_with("Pa") &&
      base.starts_with("e'")) {
    const Quantity part = found->quantity == Quantity::imaginary ? Quantity::negative_imaginary : found->quantity;
    return ColumnMeaning{part,
                         1,
                         std::move(unit),
                         {},
                         "eps",
                         false,
                         "column " + quoted(name) + " is taken as a permittivity; a modulus is E' or has a unit"};
  }
  // Names of the common kind are read by column_meaning(), unless a slash gives the unit, a dot shortens the name or it
  // is written in Greek.
  constexpr std::array<std::string_view, 9> common{"frequency",        "freq",         "f",       "omega", "w",
                                                   "angularfrequency", "angfrequency", "angfreq", "phase"};
  const bool is_common = std::find(common.begin(), common.end(), found->name) != common.end();
  const bool is_shortened = name.substr(0, name.find_first_of("/([")).find('.') != std::string_view::npos;
  const bool is_ascii = std::all_of(name.begin(), name.end(), [](char c) { return static_cast<signed char>(c) >= 0; });
  const bool is_told_by_unit = is_shortened || (has_mark && view[end] == '/');
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

bool is_unit_of_material(std::string_view unit) {
  return is_unit_of(unit, "ohm") || is_unit_of(unit, "Pa") || is_unit_of(unit, "S");
}

bool is_frequency_unit(std::string_view unit) {
  const ColumnMeaning meaning = column_meaning("f[" + std::string(unit) + "]");
  return !unit.empty() && meaning.quantity == Quantity::frequency && meaning.problem.empty();
}

}  // namespace io
