// SPDX-License-Identifier: BSD-3-Clause
// BioLogic EC-Lab (.mpt): the second line tells how many lines the header has, whose last one names the columns. Beside
// the impedance Z of the working electrode a file may hold those of the counter electrode and of both (Zce, Zwe-ce),
// admittance, capacitance, modulus and permittivity, and columns of zeros for what was not measured.
#include <algorithm>
#include <cmath>
#include <utility>

#include "io/data_error.hpp"
#include "io/fields.hpp"
#include "io/formats/format.hpp"
#include "io/number.hpp"

namespace io {
namespace {

/// Columns that speak of one quantity, such as "Re(Zce)/Ohm", "-Im(Zce)/Ohm", "|Zce|/Ohm" and "Phase(Zce)/deg".
struct Pair {
  std::string of;
  std::optional<std::size_t> real, imaginary;
  std::vector<std::size_t> columns;
  bool is_zero = true;
};

/// What stands between two marks at the begin of a name; empty where they do not.
std::string_view between(std::string_view name, std::string_view open, char close) {
  if (!name.starts_with(open)) return {};
  name.remove_prefix(open.size());
  const auto end = name.find(close);
  return end == std::string_view::npos ? std::string_view{} : name.substr(0, end);
}

std::vector<Pair> pairs_in(const std::vector<TextLayout::Column>& columns) {
  std::vector<Pair> pairs;
  for (std::size_t i = 0; i < columns.size(); ++i) {
    const std::string_view name = columns[i].name;
    const std::string_view real = between(name, "Re(", ')');
    std::string_view imaginary;
    for (const std::string_view open : {"Im(", "-Im(", "(-)Im("})
      if (imaginary.empty()) imaginary = between(name, open, ')');
    std::string_view of = real.empty() ? imaginary : real;
    if (of.empty()) of = between(name, "Phase(", ')');
    if (of.empty()) of = between(name, "|", '|');
    if (of.empty()) continue;
    auto pair = std::find_if(pairs.begin(), pairs.end(), [of](const Pair& each) { return each.of == of; });
    if (pair == pairs.end()) pair = pairs.insert(pairs.end(), Pair{std::string(of), {}, {}, {}});
    pair->columns.push_back(i);
    if (!real.empty()) pair->real = i;
    if (!imaginary.empty()) pair->imaginary = i;
  }
  // |Ewe| and the like are magnitudes of a sine.
  std::erase_if(pairs, [](const Pair& pair) { return !pair.real || !pair.imaginary; });
  return pairs;
}

void find_zeros(const TextLayout& layout, std::vector<Pair>& pairs) {
  LineReader lines(std::string_view(*layout.text).substr(0, layout.end));
  lines.skip_to(layout.begin);
  std::vector<std::string_view> fields;
  for (std::string_view line; lines.next(line);) {
    split_by(trimmed(line), layout.separator, fields);
    for (Pair& pair : pairs)
      for (const std::size_t column : {*pair.real, *pair.imaginary}) {
        const double value = column < fields.size() ? parse_number(fields[column]).value_or(0) : 0;
        pair.is_zero = pair.is_zero && !(std::abs(value) > 0);
      }
  }
}

/// Names that readers of columns know: other impedances are impedances, and what is none has its unit alone.
void rename(const Pair& pair, std::vector<TextLayout::Column>& columns) {
  std::string& imaginary = columns[*pair.imaginary].name;
  if (imaginary.starts_with("(-)")) imaginary.replace(0, 3, "-");
  if (pair.of == "Z" || pair.of == "Y") return;
  for (const std::size_t i : pair.columns) {
    std::string& name = columns[i].name;
    if (pair.of.starts_with('Z')) {
      name.replace(name.find(pair.of), pair.of.size(), "Z");
    } else if (i == *pair.real || i == *pair.imaginary) {
      const auto slash = name.find('/');
      const std::string unit = slash == std::string::npos ? "" : " [" + name.substr(slash + 1) + "]";
      name = (i == *pair.real ? "re" : name.starts_with("Im") ? "im" : "-im") + unit;
    }
  }
}

/// One sweep for each quantity that is not zero throughout, the impedance first; the others are read by --select.
void take_apart(TextLayout layout, Recognised& found) {
  std::vector<Pair> pairs = pairs_in(layout.columns);
  find_zeros(layout, pairs);
  const auto rank = [](const Pair& pair) {
    return pair.of == "Z" ? 0 : pair.of.starts_with('Z') ? 1 : pair.of == "Y" ? 2 : 3;
  };
  std::stable_sort(pairs.begin(), pairs.end(), [&](const Pair& a, const Pair& b) { return rank(a) < rank(b); });
  std::vector<std::string> others, zeros;
  for (const Pair& pair : pairs) {
    if (pair.is_zero) {
      zeros.push_back(pair.of);
      continue;
    }
    Sweep& sweep = found.sweeps.emplace_back(Sweep{pair.of, layout});
    std::vector<TextLayout::Column>& columns = std::get<TextLayout>(sweep.content).columns;
    rename(pair, columns);
    for (const Pair& each : pairs) {
      // Readers of columns prefer an impedance to an admittance by themselves.
      if (each.of == pair.of || (pair.of == "Z" && each.of == "Y")) continue;
      for (const std::size_t i : each.columns) columns[i].name = "(" + columns[i].name + ")";
    }
    sweep.is_derived = found.sweeps.size() > 1;
    if (sweep.is_derived) others.push_back(pair.of);
  }
  if (!zeros.empty() && !found.sweeps.empty())
    found.notes.push_back(shortened_list(zeros) + ": zero throughout, and not read");
  if (!others.empty())
    found.notes.push_back("beside " + found.sweeps.front().name + " the file holds " + shortened_list(others) +
                          ", which --select reads by name");
  if (found.sweeps.empty()) found.sweeps.push_back({"", layout});
  found.whole = std::move(layout);
}

}  // namespace

std::optional<Recognised> read_biologic(const Source& source) {
  LineReader lines(*source.text);
  std::string_view line;
  if (!lines.next(line) || !trimmed(line).starts_with("EC-Lab ASCII")) return std::nullopt;
  const auto length = lines.next(line) && line.find(':') != std::string_view::npos
                          ? parse_count(trimmed(line.substr(line.find(':') + 1)))
                          : std::nullopt;
  if (!length || *length < 3)
    throw DataError(source.file, 2, 1, "found " + quoted(line) + "; expected 'Nb header lines : N'");
  while (lines.number() < *length && lines.next(line)) {
  }
  if (lines.number() < *length || lines.after() >= source.text->size())
    throw DataError(source.file, lines.number(), 0,
                    "ends within the header of " + std::to_string(*length) + " lines; the file is cut off");
  Recognised found{"BioLogic EC-Lab", {}};
  TextLayout layout{source.text, named_columns(line, '\t', lines.number())};
  layout.begin = lines.after();
  layout.end = source.text->size();
  layout.first_line = lines.number() + 1;
  settle_decimal_commas(layout, found);
  take_apart(std::move(layout), found);
  return found;
}

}  // namespace io
