// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <complex>
#include <string>
#include <vector>

#include "io/column_plan.hpp"

namespace io {

struct Points {
  std::vector<double> omega;
  std::vector<std::complex<double>> value;
  std::vector<double> sigma;
};

// Reads rows by the plan of their columns.
class RowReader {
 public:
  RowReader(const TextTable& table, const ColumnPlan& plan, const Planner& planner)
      : table_(table),
        plan_(plan),
        to_radians_per_second_(planner.meaning(plan.frequency).factor),
        to_radians_(planner.meaning(plan.second).factor),
        imaginary_sign_(planner.meaning(plan.second).quantity == Quantity::negative_imaginary ? -1 : 1),
        is_permittivity_(planner.meaning(plan.first).symbol == "eps"),
        decibel_(planner.meaning(plan.first).quantity == Quantity::magnitude_db) {}

  // False for a row at frequency 0.
  bool read(const TextTable::Row& row, Points& points) const;
  // The fields of frequency and value are empty, as where a step of another kind shares the table.
  [[nodiscard]] bool is_empty(const TextTable::Row& row) const {
    return row.fields[plan_.frequency].empty() && row.fields[plan_.first].empty() && row.fields[plan_.second].empty();
  }
  // Both parts of the value are nan.
  [[nodiscard]] bool has_no_value(const TextTable::Row& row) const;

 private:
  [[noreturn]] void fail(const TextTable::Row& row, std::size_t field, const std::string& expected) const;
  [[nodiscard]] double number(const TextTable::Row& row, std::size_t field) const;
  [[nodiscard]] std::complex<double> cartesian(const TextTable::Row& row) const;
  [[nodiscard]] std::complex<double> polar(const TextTable::Row& row) const;
  // 1 + j tan delta of a modulus, 1 - j tan delta of a permittivity.
  [[nodiscard]] std::complex<double> by_tangent(const TextTable::Row& row) const;

  const TextTable& table_;
  const ColumnPlan& plan_;
  double to_radians_per_second_;
  double to_radians_;
  double imaginary_sign_;
  bool is_permittivity_;
  bool decibel_;
};

// An imaginary part of the other sign than its name says: a column named Im that holds -Im.  A phase beside it may
// tell, and of an impedance or admittance that consumes energy Bode's relation does.
class SignsOfPhase {
 public:
  SignsOfPhase(const TextTable& table, const ColumnPlan& plan, const Planner& planner);
  void see(const TextTable::Row& row, std::complex<double> value);
  /// Turns the sign of points in rising frequency where it has to be turned, and says so.
  /// @throws DataError  every row that tells has the other sign than its phase, and the points do not tell which is
  /// meant.
  void settle(Points& points, std::vector<std::string>& notes) const;

 private:
  const TextTable& table_;
  const ColumnPlan& plan_;
  std::optional<std::size_t> phase_;
  double to_radians_ = 0;  // 0 where the unit is open
  bool is_one_port_ = false;
  std::size_t same_ = 0, opposite_ = 0;
};

[[nodiscard]] bool keeps(const std::vector<PointFilter>& where, double omega, std::complex<double> value);

void sort_by_frequency(Points& points, std::vector<std::string>& notes);

// Of points in rising frequency.  Where every repeat of a frequency has the same value, as in a file joined to itself,
// it is a copy and no second measurement, and would pass for noise that goes together.
void leave_out_copies(Points& points, std::vector<std::string>& notes);

}  // namespace io
