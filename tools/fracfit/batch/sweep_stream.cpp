// SPDX-License-Identifier: BSD-3-Clause
#include "batch/sweep_stream.hpp"

#include <algorithm>
#include <cmath>
#include <mutex>

#include "io/fingerprint.hpp"
#include "io/number_list.hpp"
#include "io/output_file.hpp"
#include "io/result_stream.hpp"
#include "io/shard_file.hpp"

namespace fracfit {
namespace {

using Points = std::vector<backlash::DescribingFunctionPoint>;

PointCounts counts_of(const Points& points, const SweepTable& table) {
  PointCounts counts;
  counts.add(points, table.form.quantity);
  return counts;
}

// How the stream keeps the counts of a piece.
std::string text_of(const PointCounts& counts) {
  return std::to_string(counts.not_finite) + "," + std::to_string(counts.transient_possible) + "," +
         std::to_string(counts.decided_by_rounding) + "," + std::to_string(counts.without_inverse) + "," +
         std::to_string(counts.all);
}

PointCounts counts_from(const std::string& text) {
  const std::vector<double> numbers = io::parse_list(text, "counts");
  const auto number = [&](std::size_t i) { return static_cast<std::size_t>(numbers.at(i)); };
  PointCounts counts;
  counts.not_finite = number(0);
  counts.transient_possible = number(1);
  counts.decided_by_rounding = number(2);
  counts.without_inverse = number(3);
  counts.all = number(4);
  return counts;
}

PointCounts write_whole(const backlash::SweepPieces& pieces, const SweepTable& table, const SweepTarget& target,
                        frac::Progress& progress) {
  const std::size_t width = pieces.omega().size();
  Points all(pieces.scenes().size() * width);
  pieces.compute([](std::size_t) { return false; },
                 [&](std::size_t number, const Points& points) {
                   const auto [scene, first, count] = pieces.piece(number);
                   std::copy(points.begin(), points.end(),
                             all.begin() + static_cast<std::ptrdiff_t>(scene * width + first));
                 },
                 &progress);
  target.file.write(text_of(document_of(table, 0, width, all), target.format, target.command));
  return counts_of(all, table);
}

PointCounts write_stream(const backlash::SweepPieces& pieces, const SweepTable& table, const SweepTarget& target,
                         frac::Progress& progress) {
  const std::string head = csv_head(document_of(table, 0, 1, {}), target.command);
  io::ResultStream stream(target.stream_path + ".partial", std::string(io::unfinished_line) + "\n" + head);
  PointCounts counts;
  for (std::size_t number = 0; number < pieces.count(); ++number) {
    if (!stream.contains(std::to_string(number))) continue;
    counts += counts_from(stream.remark(std::to_string(number)));
    counts.of_earlier_run += pieces.piece(number).count;
  }
  std::mutex counting;
  pieces.compute([&](std::size_t number) { return stream.contains(std::to_string(number)); },
                 [&](std::size_t number, const Points& points) {
                   const backlash::SweepPiece piece = pieces.piece(number);
                   const PointCounts now = counts_of(points, table);
                   stream.append(std::to_string(number),
                                 csv_rows(document_of(table, piece.scene, piece.count, points).rows), text_of(now));
                   const std::lock_guard guard(counting);
                   counts += now;
                 },
                 &progress);
  target.file.write([&](const io::OutputFile::Sink& sink) {
    io::Fingerprint fingerprint;
    const auto write = [&](const std::string& text) {
      fingerprint.add(text);
      sink(text);
    };
    write(head);
    for (std::size_t number = 0; number < pieces.count(); ++number) write(stream.text(std::to_string(number)));
    if (table.shard.count > 1) sink(io::checksum_line(fingerprint));
  });
  stream.remove();
  return counts;
}

}  // namespace

void PointCounts::add(const std::vector<backlash::DescribingFunctionPoint>& points, backlash::Quantity quantity) {
  for (const auto& point : points) {
    not_finite += point.usable() ? 0U : 1U;
    transient_possible += point.transient_possible ? 1U : 0U;
    decided_by_rounding += std::isnan(point.force_sensitivity) ? 0U : 1U;
    without_inverse += quantity == backlash::Quantity::minus_inverse && !backlash::minus_inverse(point) ? 1U : 0U;
  }
  all += points.size();
}

PointCounts& PointCounts::operator+=(const PointCounts& other) {
  not_finite += other.not_finite;
  transient_possible += other.transient_possible;
  decided_by_rounding += other.decided_by_rounding;
  without_inverse += other.without_inverse;
  all += other.all;
  return *this;
}

std::vector<double> expected_costs(const std::vector<backlash::SweepScene>& scenes) {
  std::vector<double> cost;
  cost.reserve(scenes.size());
  for (const auto& scene : scenes) cost.push_back(backlash::expected_cost(scene.system.restitution()));
  return cost;
}

PointCounts write_sweep(const backlash::SweepPieces& pieces, const SweepTable& table, const SweepTarget& target,
                        frac::Progress& progress) {
  return (target.stream_path.empty() ? write_whole : write_stream)(pieces, table, target, progress);
}

}  // namespace fracfit
