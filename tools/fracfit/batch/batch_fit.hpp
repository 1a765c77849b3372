// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "batch/batch_table.hpp"
#include "frac/identification/screened_fit.hpp"
#include "options/fit_request.hpp"

namespace fracfit {

/// One curve of a batch: a file, or one of the curves in it.
struct BatchCurve {
  std::string name;  // the file, and after a # the label
  std::string file;
  std::string label;                                        // empty: the only curve of the file
  std::string fingerprint;                                  // of the file; empty where it cannot be read
  std::shared_ptr<const io::Measurement> measurement = {};  // kept where the file holds several curves
};

/// The curves of the files, see io::curve_labels; a file that cannot be read counts as one.
[[nodiscard]] std::vector<BatchCurve> curves_of(const std::vector<std::string>& files, const FitRequest& request);

/// The data of one curve; `note` is told what was assumed.
[[nodiscard]] io::FrequencyResponseFile read_curve(FitRequest request, const BatchCurve& curve,
                                                   const std::function<void(const std::string&)>& note);

/// What is done with each curve of a batch.
struct BatchTask {
  FitRequest request;                    // its data are set curve by curve
  std::vector<frac::NamedModel> models;  // with the constraints of the user; one is fitted, several are ranked
  std::vector<std::string> variables;    // entries of the file headers that become columns
  bool ranked = false;
  bool weight_is_told = false;  // else curves with deviations that were measured are weighed with these
};

/// Columns of the rows below.
/// @throws std::invalid_argument  a parameter has the name of another column.
[[nodiscard]] std::vector<std::string> batch_columns(const BatchTask& task);

/// Entries with a number in the headers of those curves that can be read, and the columns that a row has anyway; one
/// curve is enough where it has `wanted`.  Nothing where no curve can be read.
[[nodiscard]] std::vector<std::string> variables_of(const BatchTask& task, const std::vector<BatchCurve>& curves,
                                                    const std::string& wanted);

/// Why the options of the command fit none of the curves: a condition on a column that they do not have, or several
/// scenes in one file.  Empty if one curve can be read.
[[nodiscard]] std::string fault_of_command(const BatchTask& task, const std::vector<BatchCurve>& curves);

/// Answers at which the fits of other curves begin, see frac::fit_from(): the curves stand in blocks of 64, and each
/// begins at the answer of the first one of its block.  So rows depend on the data alone, and not on the order in which
/// threads, shards or a resumed run come to them; a shard fits the first curve of each block that it needs.
class BlockStarts {
 public:
  struct Answer {
    frac::ModelFit fit;
    frac::ScreenedData points;
  };
  /// @param curves  all of the batch, also where only a part of it is fitted
  BlockStarts(const BatchTask& task, const std::vector<BatchCurve>& curves);

  /// Of the first curve in the block of the curve at `index`; nullptr where that cannot be fitted, and in a ranking.
  /// Any thread may ask.
  [[nodiscard]] const Answer* operator[](std::size_t index);
  [[nodiscard]] static bool is_first(std::size_t index) { return index % block_size == 0; }

 private:
  static constexpr std::size_t block_size = 64;
  struct Block {
    std::once_flag searched;
    std::optional<Answer> answer;
  };
  const BatchTask& task_;
  const std::vector<BatchCurve>& curves_;
  std::unique_ptr<Block[]> blocks_;
};

/// One row, of the curve at `index`; a curve that cannot be read or fitted gives one that says why.
[[nodiscard]] BatchRow batch_row(const BatchTask& task, const std::vector<BatchCurve>& curves, std::size_t index,
                                 BlockStarts& starts);

}  // namespace fracfit
