#pragma once

#include <string>
#include <vector>

namespace fracfit {

/// Columns set flush for people to read: the first to the left, the others to the right.
class AlignedTable {
 public:
  explicit AlignedTable(std::vector<std::string> heading);
  void add(std::vector<std::string> row);
  [[nodiscard]] std::string text() const;

 private:
  std::vector<std::vector<std::string>> rows_;
};

/// Six significant digits; "-" for what is not a number.
[[nodiscard]] std::string short_number(double value);

}  // namespace fracfit
