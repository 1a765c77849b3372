// SPDX-License-Identifier: BSD-3-Clause
#include "io/shard.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cstdlib>
#include <functional>
#include <numeric>
#include <queue>
#include <stdexcept>
#include <utility>

#include "io/number.hpp"

namespace io {
namespace {

// Tasks of an array, counted from 1 or, where the system gives it no choice, from 0.
struct Array {
  const char *index, *first, *last, *step;  // names of variables; null: the system does not tell
  std::size_t base;
};
constexpr std::array<Array, 5> arrays{{
    {"SLURM_ARRAY_TASK_ID", "SLURM_ARRAY_TASK_MIN", "SLURM_ARRAY_TASK_MAX", "SLURM_ARRAY_TASK_STEP", 1},
    {"SGE_TASK_ID", "SGE_TASK_FIRST", "SGE_TASK_LAST", "SGE_TASK_STEPSIZE", 1},
    {"PBS_ARRAY_INDEX", nullptr, nullptr, nullptr, 1},
    {"PBS_ARRAYID", nullptr, nullptr, nullptr, 1},
    {"JOB_COMPLETION_INDEX", nullptr, nullptr, nullptr, 0},
}};

// Processes that a launcher has started together, counted from 0.
struct Ranks {
  const char *index, *count;
};
constexpr std::array<Ranks, 3> launchers{{
    {"OMPI_COMM_WORLD_RANK", "OMPI_COMM_WORLD_SIZE"},
    {"PMI_RANK", "PMI_SIZE"},
    {"SLURM_PROCID", "SLURM_NTASKS"},
}};

std::optional<std::size_t> variable(const char* name) {
  const char* const text = name == nullptr ? nullptr : std::getenv(name);
  return text == nullptr ? std::nullopt : parse_count(text);
}

std::string entry(const char* name) {
  return std::string(name) + "=" + std::getenv(name);
}

// Place in the array, counted from 1, and its size, 0 where it is not told.
Shard place_in(const Array& array, std::size_t index, bool size_is_told) {
  if (index < array.base)
    throw std::invalid_argument("expected array tasks counted from 1, as by --array=1-n; found " + entry(array.index));
  if (size_is_told) return {index - array.base + 1, 0};
  const auto first = variable(array.first), last = variable(array.last), step = variable(array.step);
  if (!first || !last)
    throw std::invalid_argument("found " + entry(array.index) +
                                ", but this system does not tell how many tasks there are; expected auto/n");
  // Of an array in which some tasks run again, the numbers tell nothing about the whole.
  if (*first != 1 || step.value_or(1) != 1)
    throw std::invalid_argument("found an array of tasks that is not 1-n (" + entry(array.first) + ", " +
                                entry(array.last) + "); expected auto/n with the number n of all shards");
  return {index, *last};
}

}  // namespace

std::optional<Shard> shard_from(std::string_view text) {
  Shard shard;
  const char* const end = text.data() + text.size();
  const auto index = std::from_chars(text.data(), end, shard.index);
  if (index.ec != std::errc{} || index.ptr == end || *index.ptr != '/') return std::nullopt;
  const auto count = std::from_chars(index.ptr + 1, end, shard.count);
  if (count.ec != std::errc{} || count.ptr != end) return std::nullopt;
  if (shard.index < 1 || shard.index > shard.count) return std::nullopt;
  return shard;
}

Shard shard_of_environment(std::size_t count) {
  Shard task{1, 1}, rank{1, 1};
  bool found = false;
  for (const Array& array : arrays) {
    const auto index = variable(array.index);
    if (!index || found) continue;
    task = place_in(array, *index, count > 0);
    found = true;
  }
  const bool in_array = found;
  bool has_rank = false;
  for (const Ranks& launcher : launchers) {
    const auto index = variable(launcher.index), size = variable(launcher.count);
    if (!index || !size || rank.count > 1) continue;
    rank = {*index + 1, *size};
    found = has_rank = true;
  }
  // PMIx alone tells the rank, but not in the environment how many there are.
  if (const auto index = variable("PMIX_RANK"); index && !has_rank) {
    if (count == 0 || in_array)
      throw std::invalid_argument("found " + entry("PMIX_RANK") +
                                  ", but not how many processes there are; expected auto/n, outside of an array");
    rank = {*index + 1, count};
    found = true;
  }
  if (!found)
    throw std::invalid_argument(
        "found no variable of Slurm, SGE, PBS, Kubernetes, Open MPI, PMI or PMIx in the environment; expected i/n");
  Shard shard{(task.index - 1) * rank.count + rank.index, task.count * rank.count};
  if (count > 0) {
    if (!in_array && rank.count != count)
      throw std::invalid_argument("the launcher has started " + std::to_string(rank.count) + " processes; expected " +
                                  std::to_string(count));
    shard.count = count;
  }
  if (shard.index > shard.count)
    throw std::invalid_argument("this is number " + std::to_string(shard.index) +
                                " of the environment; expected at most " + std::to_string(shard.count));
  return shard;
}

std::string with_shard(std::string path, const Shard& shard) {
  constexpr std::string_view place = "{shard}";
  const std::string count = std::to_string(shard.count);
  std::string index = std::to_string(shard.index);
  index.insert(0, count.size() - index.size(), '0');
  for (auto at = path.find(place); at != std::string::npos; at = path.find(place, at))
    path.replace(at, place.size(), index + "-of-" + count);
  return path;
}

std::vector<std::size_t> shards_of(const std::vector<double>& cost, std::size_t count) {
  std::vector<std::size_t> order(cost.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(order, std::greater<>(), [&](std::size_t i) { return cost[i]; });
  // What each shard has to do, the least on top, of equal ones the first.
  using Load = std::pair<double, std::size_t>;
  std::priority_queue<Load, std::vector<Load>, std::greater<>> loads;
  for (std::size_t shard = 1; shard <= count; ++shard) loads.emplace(0, shard);
  std::vector<std::size_t> owner(cost.size());
  for (const std::size_t i : order) {
    const auto [load, shard] = loads.top();
    loads.pop();
    owner[i] = shard;
    loads.emplace(load + cost[i], shard);
  }
  return owner;
}

std::vector<std::size_t> part_of(std::size_t pieces, const Shard& shard) {
  std::vector<std::size_t> part;
  for (std::size_t i = shard.index - 1; i < pieces; i += shard.count) part.push_back(i);
  return part;
}

std::string list_of(const std::vector<std::size_t>& numbers) {
  std::string text;
  for (std::size_t i = 0; i < numbers.size();) {
    std::size_t last = i;
    while (last + 1 < numbers.size() && numbers[last + 1] == numbers[last] + 1) ++last;
    text += (text.empty() ? "" : ",") + std::to_string(numbers[i]);
    if (last > i) text += (last > i + 1 ? "-" : ",") + std::to_string(numbers[last]);
    i = last + 1;
  }
  return text;
}

}  // namespace io
