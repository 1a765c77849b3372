#pragma once

#include <string>
#include <vector>

#include "batch_table.hpp"
#include "fit_request.hpp"
#include "frac/identification/identify.hpp"

namespace fracfit {

/// What is done with each file of a batch.
struct BatchTask {
  FitRequest request;  // its data are set file by file
  frac::FitOptions options;
  std::vector<frac::NamedModel> models;  // with the constraints of the user; one is fitted, several are ranked
  std::vector<std::string> variables;    // entries of the file headers that become columns
  bool ranked = false;
};

/// Columns of the rows below.
/// @throws std::invalid_argument  a parameter has the name of another column.
[[nodiscard]] std::vector<std::string> batch_columns(const BatchTask& task);

/// One row; a file that cannot be read or fitted gives one that says why.
[[nodiscard]] BatchRow batch_row(const BatchTask& task, const std::string& file);

}  // namespace fracfit
