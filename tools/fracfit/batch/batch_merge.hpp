// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "batch/batch_reader.hpp"
#include "io/descriptor.hpp"
#include "io/output_file.hpp"
#include "io/shard_file.hpp"

namespace fracfit {

/// The table that several batch tables of the same command make.  Memory grows neither with the rows nor with the
/// curves, but for 16 bytes of each curve and power law, and a bit for each row of a table that is no finished shard.
class BatchMerge {
 public:
  /// Reads and checks all tables.
  /// @throws io::DataError  one is no batch table, stems from another command or other files than the first, or was
  ///                        changed; the text names file and line.
  explicit BatchMerge(const std::vector<std::string>& files);

  struct Outcome {
    std::vector<std::string> notes;  // what is to be said of the power laws
    std::string missing;             // which curves, and which shards as sbatch --array= takes them; empty: none
  };
  /// Writes the rows in the order of the curves, and the power laws below them where no row is missing.
  /// @throws io::DataError  a table has a row that another one has too, or of none of its inputs.
  [[nodiscard]] Outcome write(const io::OutputFile::Sink& sink) const;

 private:
  // Curves without a row, and the names of the first.
  struct Missing {
    std::size_t count = 0;
    std::vector<std::string> first;
  };
  [[nodiscard]] std::string missing_text(const Missing& missing) const;

  std::vector<io::Descriptor> descriptors_;
  std::vector<BatchReader> tables_;
  std::vector<std::string> unfinished_;
  std::vector<std::size_t> shards_to_do_;
};

/// State of each of some shards of a batch, every row read.
/// @throws io::DataError  the files stem from different commands, or one is no shard of a batch.
[[nodiscard]] std::vector<io::ShardState> batch_shard_states(const std::vector<std::string>& files);

}  // namespace fracfit
