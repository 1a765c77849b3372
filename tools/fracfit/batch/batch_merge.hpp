// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "batch/batch_reader.hpp"
#include "io/descriptor.hpp"
#include "io/output_file.hpp"
#include "io/shard_file.hpp"

namespace fracfit {

/// The table that several batch tables of the same command make.  Memory holds the names of the curves and the places
/// of their rows, not the rows.
class BatchMerge {
 public:
  /// Reads and checks all tables.
  /// @throws io::DataError  one is no batch table, stems from another command or other files than the first, has a row
  ///                        that another one has too, or was changed; the text names file and line.
  explicit BatchMerge(const std::vector<std::string>& files);

  /// Writes the rows in the order of the curves, and the power laws below them where no row is missing.
  /// @return  what is to be said of the laws
  [[nodiscard]] std::vector<std::string> write(const io::OutputFile::Sink& sink) const;
  /// What is missing, as a sentence that names the shards as sbatch --array= takes them; empty: nothing.
  [[nodiscard]] std::string missing_text() const;

 private:
  // Where the row of a curve stands; of size 0: nowhere.
  struct Place {
    std::uint32_t file = 0, size = 0;
    std::size_t begin = 0;
  };

  std::vector<std::string> files_;
  std::vector<io::Descriptor> descriptors_;
  BatchFormat format_ = BatchFormat::csv;
  BatchManifest manifest_;
  std::vector<Place> places_;  // by curve
  std::vector<std::string> unfinished_;
  std::vector<std::size_t> shards_to_do_;
};

/// State of each of some shards of a batch, every row read.
/// @throws io::DataError  the files stem from different commands, or one is no shard of a batch.
[[nodiscard]] std::vector<io::ShardState> batch_shard_states(const std::vector<std::string>& files);

}  // namespace fracfit
