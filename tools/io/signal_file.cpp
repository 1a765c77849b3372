#include "io/signal_file.hpp"

#include <algorithm>
#include <cmath>
#include <initializer_list>

#include "io/number.hpp"
#include "io/text_table.hpp"

namespace io {
namespace {

std::size_t column_named(const TextTable& table, std::initializer_list<std::string_view> names) {
  for (std::size_t i = 0; i < table.header().size(); ++i) {
    if (std::find(names.begin(), names.end(), table.header()[i].text) != names.end()) return i;
  }
  std::string list;
  for (const std::string_view name : names) list += (list.empty() ? "" : ", ") + std::string(name);
  throw DataError(table.file(), table.header().empty() ? 0 : table.header()[0].line, 0,
                  "found no such column; expected one named " + list);
}

}  // namespace

Signal read_signal(const std::string& file) {
  const TextTable table(file);
  const std::size_t time = column_named(table, {"time_s", "t_s", "time", "t"});
  const std::size_t value = column_named(table, {"input", "u", "value"});
  Signal signal{{}, {}, 0};
  std::vector<std::size_t> lines;
  table.for_each_row([&](const TextTable::Row& row) {
    for (const std::size_t field : {time, value}) {
      const auto number = parse_number(row.fields[field]);
      if (!number || !std::isfinite(*number)) {
        throw DataError(file, row.line, row.column_of(field),
                        "found " + quoted(row.fields[field]) + "; expected a finite number");
      }
      (field == time ? signal.time : signal.value).push_back(*number);
    }
    lines.push_back(row.line);
  });
  const std::size_t count = signal.time.size();
  if (count < 2) throw DataError(file, lines[0], 0, "found one sample; expected two or more");
  signal.sample_time = (signal.time.back() - signal.time.front()) / static_cast<double>(count - 1);
  for (std::size_t n = 1; n < count; ++n) {
    const double step = signal.time[n] - signal.time[n - 1];
    if (!(std::abs(step - signal.sample_time) <= 1e-6 * signal.sample_time)) {
      throw DataError(file, lines[n], 0,
                      "found a step of " + format_number(step) + " s; expected equal steps, " +
                          format_number(signal.sample_time) + " s on average");
    }
  }
  return signal;
}

}  // namespace io
