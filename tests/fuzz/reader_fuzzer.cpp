// SPDX-License-Identifier: BSD-3-Clause
// libFuzzer: any bytes as a file, for every reader of files.
#include <fcntl.h>
#include <sys/mman.h>
#include <unistd.h>

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <stdexcept>
#include <string>

#include "io/csv_line.hpp"
#include "io/data_error.hpp"
#include "io/frequency_response_file.hpp"
#include "io/number_list.hpp"
#include "io/point_filter.hpp"
#include "io/shard_file.hpp"
#include "io/time_series_file.hpp"

namespace {

template <typename Read>
void take(const Read& read) {
  try {
    read();
  } catch (const io::DataError&) {
  } catch (const std::invalid_argument&) {
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const int memory = ::memfd_create("input", 0);
  static const std::string file = "/proc/self/fd/" + std::to_string(memory);
  if (::ftruncate(memory, 0) != 0 || ::pwrite(memory, data, size, 0) != static_cast<ssize_t>(size)) std::abort();
  take([] { static_cast<void>(io::read_frequency_response(file)); });
  take([] {
    io::FrequencyResponseReadOptions options;
    options.phase_may_miss = options.magnitude_may_miss = options.real_may_miss = true;
    options.where.emplace_back("a==b");
    static_cast<void>(io::read_frequency_response(file, options));
  });
  take([] { static_cast<void>(io::curve_labels(io::read_measurement(file), "")); });
  take([] { static_cast<void>(io::scenes_in(io::read_measurement(file))); });
  take([] { static_cast<void>(io::read_time_response(file)); });
  take([] { io::join_block_tables({file}, [](std::string_view) {}); });
  const std::string text(reinterpret_cast<const char*>(data), size);
  static_cast<void>(io::split_csv_line(text));
  take([&] { static_cast<void>(io::PointFilter(text)); });
  // Grids of a million points take no thinking.
  if (size < 12) take([&] { static_cast<void>(io::parse_grid(text, "grid")); });
  return 0;
}
